//! Every reader on any bytes: a model that holds together, or an error that says where and what to do.

use ldwrap::io::points::{Attribute, PointFormat, gather, read_points};
use ldwrap::io::{Detail, MeshFormat, Model, ReadError, read_model, read_model_as};
use ldwrap::{CheckOptions, FaceId, PolygonSoup, Sample, StripId, SurfaceMesh, SurfacePoint};

/// Larger models are read, but not checked and looked at: that has its own target.
const MOST_CORNERS: usize = 3_000;

/// The details, each a superset of the one before.
const DETAILS: [Detail; 3] = [Detail::Shape, Detail::Attributes, Detail::Textures];

/// A picture of one texel.
const PICTURE: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\x02\0\0\0\x90wS\xde\0\0\0\x0cIDATx\x9cc``\xf8\x0f\0\x01\x05\x01\x01'\xe0\x87?\0\0\0\0IEND\xaeB`\x82";

/// What lies beside the file.
fn beside(address: &str) -> Result<Vec<u8>, String> {
    match address.rsplit_once('.') {
        Some((_, "mtl")) => {
            Ok(b"newmtl a\nKd 0.5 nan 2\nmap_Kd -s 2 -o 1 1 a.png\nnewmtl b\nd 0.5\n".to_vec())
        }
        Some((_, "png")) => Ok(PICTURE.to_vec()),
        Some((_, "bin")) => Ok((0..=255).cycle().take(1024).collect()),
        Some((_, "jpg")) => Ok(b"\xff\xd8\xff\xe0 no picture".to_vec()),
        _ => Err("it is not there".to_owned()),
    }
}

/// Bytes as a mesh of one format.
///
/// # Panics
/// If the reader breaks a promise.
pub fn mesh(format: MeshFormat, bytes: &[u8]) {
    check(|detail| read_model_as(format, bytes, detail, &beside));
}

/// Bytes as a mesh whose content tells the format, compressed or not.
///
/// # Panics
/// If the reader breaks a promise.
pub fn any(bytes: &[u8]) {
    check(|detail| read_model(bytes, Some("a.stl"), detail, &beside));
}

fn check(read: impl Fn(Detail) -> Result<Model, ReadError>) {
    let mut before: Option<Result<Model, ReadError>> = None;
    for detail in DETAILS {
        let now = read(detail);
        match &now {
            Ok(model) => {
                check_soup(&model.soup);
                match before {
                    Some(Err(error)) => panic!("{detail:?} reads what less does not: {error}"),
                    Some(Ok(less)) => {
                        assert!(bits(&less.soup) == bits(&model.soup), "{detail:?}: another shape")
                    }
                    None => {}
                }
                look(model);
            }
            Err(error) => check_message(&error.to_string()),
        }
        before = Some(now);
    }
}

fn bits(soup: &PolygonSoup) -> (Vec<[u64; 3]>, &[u32], &[u32]) {
    let positions = soup.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect();
    (positions, &soup.corners, &soup.ends)
}

fn check_soup(soup: &PolygonSoup) {
    assert!(soup.ends.is_sorted(), "the ends ascend");
    assert_eq!(
        soup.ends.last().map_or(0, |&end| end as usize),
        soup.corners.len(),
        "all corners are in a polygon"
    );
}

/// A message is one line that a person can read, with what is wrong and what to do.
fn check_message(message: &str) {
    assert!(message.len() > 10 && message.len() < 700, "{message:?}");
    assert!(!message.contains(|c: char| c.is_control()), "{message:?}");
}

/// Checks the mesh and looks up everything that it carries in the middle of its faces.
fn look(model: &Model) {
    if model.soup.corners.len() > MOST_CORNERS {
        return;
    }
    let mesh = match SurfaceMesh::from_soup(&model.soup, &CheckOptions::default()) {
        Ok((mesh, _)) => mesh,
        Err(error) => return check_message(&error.to_string()),
    };
    assert!(mesh.face_count() > 0 && mesh.area() > 0.0 && mesh.area().is_finite());
    let middle = |face| SurfacePoint { face, barycentric: [0.25, 0.25, 0.5] };
    let samples: Vec<Sample> = (0..mesh.face_count())
        .map(|face| Sample {
            point: middle(FaceId(face as u32)),
            strip: StripId(0),
            place: glam::DVec2::ZERO,
            origin: ldwrap::Origin::Wrapped,
        })
        .collect();
    for attribute in [
        Attribute::SmoothNormal,
        Attribute::Uv,
        Attribute::VertexColor,
        Attribute::Color,
        Attribute::Material,
        Attribute::Part,
    ] {
        if attribute.is_in(&model.attributes) {
            let fields = gather(&mesh, &model.attributes, &samples, &[attribute]).expect("it is there");
            assert!(fields.iter().all(|field| field.point_count() == samples.len()));
        }
    }
}

/// The first byte chooses the format, the others are the file.
///
/// # Panics
/// If the reader breaks a promise.
pub fn points(bytes: &[u8]) {
    let [choice, rest @ ..] = bytes else { return };
    let format = PointFormat::ALL[*choice as usize % PointFormat::ALL.len()];
    match read_points(rest, format.name()) {
        Ok(points) => {
            assert!(!points.is_empty() && points.iter().all(|p| p.is_finite()));
        }
        Err(error) => check_message(&error.to_string()),
    }
}
