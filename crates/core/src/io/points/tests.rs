//! Points written and read again, and files that lie.

use glam::{DVec2, DVec3};
use proptest::prelude::*;

use super::*;
use crate::ids::{FaceId, StripId};
use crate::sample::{Origin, SurfacePoint};

fn row(position: DVec3) -> PointRow {
    PointRow {
        position,
        normal: DVec3::new(0.0, 0.6, -0.8),
        sample: Sample {
            point: SurfacePoint { face: FaceId(7), barycentric: [0.5, 0.25, 0.25] },
            strip: StripId(3),
            place: DVec2::new(0.1, 2.0),
            origin: Origin::Projected,
        },
    }
}

fn written(format: PointFormat, rows: &[PointRow]) -> Vec<u8> {
    let mut out = Vec::new();
    write_points(format, rows, &mut out).expect("memory takes every byte");
    out
}

fn text(format: PointFormat) -> String {
    let rows = [row(DVec3::new(0.1, -2.0, 1e-7)), row(DVec3::new(1.0 / 3.0, 0.0, 3e20))];
    String::from_utf8(written(format, &rows)).expect("text")
}

#[test]
fn texts_by_hand() {
    assert_eq!(text(PointFormat::Xyz), "0.1 -2.0 1e-7\n0.3333333333333333 0.0 3e20\n");
    assert_eq!(
        text(PointFormat::Csv),
        "x,y,z,nx,ny,nz,face,b0,b1,b2,strip,place_x,place_y,origin\n\
         0.1,-2.0,1e-7,0.0,0.6,-0.8,7,0.5,0.25,0.25,3,0.1,2.0,projected\n\
         0.3333333333333333,0.0,3e20,0.0,0.6,-0.8,7,0.5,0.25,0.25,3,0.1,2.0,projected\n"
    );
    assert_eq!(
        text(PointFormat::Obj),
        "v 0.1 -2.0 1e-7\nv 0.3333333333333333 0.0 3e20\nvn 0.0 0.6 -0.8\nvn 0.0 0.6 -0.8\n"
    );
    let fields = r#""normal":[0.0,0.6,-0.8],"face":7,"barycentric":[0.5,0.25,0.25],"strip":3,"place":[0.1,2.0],"origin":"projected"}"#;
    let json = text(PointFormat::Json);
    assert!(json.starts_with(&format!("[\n{{\"position\":[0.1,-2.0,1e-7],{fields},\n")), "{json}");
    assert!(json.ends_with(&format!("{fields}\n]\n")), "{json}");
    let ply = text(PointFormat::PlyAscii);
    assert!(ply.contains("property float nz\nproperty int face\nproperty double b0\n"), "{ply}");
    assert!(ply.contains("end_header\n0.1 -2 0.0000001 0 0.6 -0.8 7 0.5 0.25 0.25 3 0.1 2 1\n"), "{ply}");
}

#[test]
fn npy_by_hand() {
    let bytes = written(PointFormat::Npy, &[row(DVec3::new(1.0, 2.0, 3.0))]);
    let head = "\u{1}\0v\0{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }";
    assert_eq!(&bytes[6..6 + head.len()], head.as_bytes());
    assert_eq!(bytes.len(), 128 + 24);
    assert_eq!(bytes[127], b'\n');
    assert_eq!(bytes[136..144], 2.0_f64.to_le_bytes());
}

#[test]
fn binary_ply_has_all_columns() {
    let bytes = written(PointFormat::Ply, &[row(DVec3::ONE), row(DVec3::ZERO)]);
    let end = b"end_header\n";
    let head = bytes.windows(end.len()).position(|w| w == end).expect("a head") + end.len();
    // 8 doubles, 3 floats, 2 ints, 1 uchar.
    assert_eq!(bytes.len() - head, 2 * (8 * 8 + 3 * 4 + 2 * 4 + 1));
    assert_eq!(bytes[bytes.len() - 1], 1);
}

#[test]
fn names() {
    for format in PointFormat::ALL {
        assert_eq!(PointFormat::from_name(format.name()), Some(format));
    }
    assert_eq!(PointFormat::from_name("a.b/points.NPY"), Some(PointFormat::Npy));
    assert_eq!(PointFormat::from_name("cloud.pts"), Some(PointFormat::Xyz));
    assert_eq!(PointFormat::from_name("points"), None);
    assert_eq!(PointFormat::from_name("points.ply.gz"), None);
}

fn read(name: &str, text: &str) -> Result<Vec<DVec3>, String> {
    read_points(text.as_bytes(), name).map_err(|error| error.to_string())
}

const TWO: [DVec3; 2] = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 0.5, 60.0)];

#[test]
fn texts_as_others_write_them() {
    for xyz in [
        "1 2 3\n-4 .5 6e1\n",
        "\u{feff}x y z\r\n1.0\t2.0\t3.0 0 0 1\r\n\r\n-4 0.5 60 9 9",
        "2\n1,2,3\n-4,0.5,60 # last\n",
        "//X,Y,Z,R\n# none\n1;2;3;255\n  -4 ; 0.5 ; +60\n",
    ] {
        assert_eq!(read("a.xyz", xyz), Ok(TWO.to_vec()), "{xyz}");
    }
    for csv in [
        "1,2,3\n-4,.5,60\n",
        "id,Z,X,Y\na,3,1,2\nb,60,-4,0.5\n",
        "\"first\",\"second\",\"third\"\r\n\"1\",\"2\",\"3\"\r\n-4,0.5,60,7\r\n",
        "\u{feff}x;y;z\n1;2;3\n-4;0.5;60\n",
        "//X,Y,Z\n1,2,3\n\n-4, 0.5 ,60\n",
    ] {
        assert_eq!(read("a.csv", csv), Ok(TWO.to_vec()), "{csv}");
    }
    for json in [
        "[[1,2,3],[-4,0.5,60]]",
        r#"[{"position":[1,2,3],"more":null},{"position":[-4,0.5,60]}]"#,
        r#"[{"x":1,"y":2,"z":3},{"z":60,"y":0.5,"x":-4,"w":1}]"#,
    ] {
        assert_eq!(read("a.json", json), Ok(TWO.to_vec()), "{json}");
    }
    let obj = "# cube\nmtllib a.mtl\nv 1 2 3\nvn 0 0 1\nv -4 0.5 60 1\nf 1 2 1\n";
    assert_eq!(read("a.obj", obj), Ok(TWO.to_vec()));
    let ply = "ply\nformat ascii 1.0\ncomment c\nelement camera 1\nproperty list uchar int pixels\nelement vertex 2\n\
               property uchar red\nproperty int x\nproperty float y\nproperty double z\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n2 7 7\n255 1 2 3\n0 -4 0.5 60\n3 0 1 0\n";
    assert_eq!(read("content decides.xyz", ply), Ok(TWO.to_vec()));
}

fn npy(version: u8, descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let head = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
    let mut bytes = [MAGIC, &[version, 0]].concat();
    match version {
        1 => bytes.extend_from_slice(&(head.len() as u16).to_le_bytes()),
        _ => bytes.extend_from_slice(&(head.len() as u32).to_le_bytes()),
    }
    [&bytes, head.as_bytes(), data].concat()
}

use super::npy::MAGIC;

#[test]
fn npy_of_every_kind() {
    let rows = [1.0, 2.0, 3.0, 9.0, -4.0, 0.5, 60.0, 9.0_f32];
    let columns = [1.0, -4.0, 2.0, 0.5, 3.0, 60.0, 9.0, 9.0_f64];
    let bytes = |little: bool| -> Vec<u8> {
        rows.iter().flat_map(|x| if little { x.to_le_bytes() } else { x.to_be_bytes() }).collect()
    };
    let doubles = |little: bool| -> Vec<u8> {
        columns.iter().flat_map(|x| if little { x.to_le_bytes() } else { x.to_be_bytes() }).collect()
    };
    for file in [
        npy(1, "<f4", "False", "(2, 4)", &bytes(true)),
        npy(2, ">f4", "False", "(2,4,)", &bytes(false)),
        npy(3, "<f8", "True", "(2, 4)", &doubles(true)),
        npy(1, ">f8", "True", "(2, 4)", &doubles(false)),
    ] {
        assert_eq!(read_points(&file, "x"), Ok(TWO.to_vec()));
    }
}

#[test]
fn broken_files_tell_where() {
    let cases = [
        ("a.xyz", "1 2 3\n\n4 5\n", "xyz, line 3: 2 of the 3 coordinates of a point"),
        ("a.xyz", "1 2 3\n4 5 six\n", "xyz, line 2: \"six\" is not a number"),
        ("a.xyz", "1 2 3\n4 inf 6\n", "xyz, line 2: the position [4, inf, 6] is not finite"),
        ("a.xyz", "x y z\nx y z\n", "xyz, line 2: \"x\" is not a number"),
        ("a.csv", "x,y,z\n1,2,3\n1,NaN,3\n", "csv, line 3: the position [1, NaN, 3] is not finite"),
        ("a.csv", "z,y\n1,2\n", "csv, line 2: 2 of the 3 coordinates of a point"),
        ("a.csv", "", "csv: there is no point in the file"),
        ("a.obj", "v 1 2 3\nv 1 2\n", "obj, line 2: 2 of the 3 coordinates of a point"),
        ("a.json", "[]", "json: there is no point in the file"),
        ("a.json", "[[1,2,3],\n[1,2]]", "json, line 2: "),
        (
            "a",
            "1 2 3",
            "\"a\" is not in a known point format: the formats are ply, xyz, csv, npy, json and obj",
        ),
        ("a.ply", "1 2 3", "ply, "),
        ("a.npy", "1 2 3", "npy, file: the head is cut off"),
    ];
    for (name, text, expected) in cases {
        let error = read(name, text).expect_err(text);
        assert!(error.starts_with(expected), "{text:?} gave {error:?}");
    }
}

#[test]
fn lying_heads_are_refused() {
    let announced =
        "npy, file: 1000000000000 x 3 numbers are announced, but the file ends after 24 bytes of them";
    let lying = npy(1, "<f8", "False", "(1000000000000, 3)", &[0; 24]);
    assert_eq!(read_points(&lying, "a").unwrap_err().to_string(), announced);
    let overflow = npy(1, "<f8", "False", "(18446744073709551615, 18446744073709551615)", &[0; 24]);
    let long_head = [MAGIC, &[2, 0, 255, 255, 255, 255], b"{'descr'"].concat();
    let flat = npy(1, "<f8", "False", "(3,)", &[0; 24]);
    let narrow = npy(1, "<f8", "False", "(2, 2)", &[0; 32]);
    let complex = npy(1, "<c16", "False", "(1, 3)", &[0; 48]);
    for bytes in [overflow, long_head, flat, narrow, complex] {
        assert!(matches!(read_points(&bytes, "a"), Err(PointsError::Malformed { .. })));
    }
    let head = "ply\nformat binary_little_endian 1.0\nelement vertex 18000000000000000000\n";
    for properties in
        ["", "property double x\nproperty double y\nproperty double z\n", "property list uint float x\n"]
    {
        let bytes = [head.as_bytes(), properties.as_bytes(), b"end_header\n", &[255; 40]].concat();
        assert!(matches!(read_points(&bytes, "a"), Err(PointsError::Malformed { .. })), "{properties}");
    }
    let flat =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n";
    assert_eq!(read("a", flat).unwrap_err(), "ply, file: a vertex has no number z");
    let none = "ply\nformat ascii 1.0\nelement face 1\nproperty float x\nend_header\n1\n";
    assert_eq!(read("a", none).unwrap_err(), "ply, file: there is no element called vertex");
}

fn finite() -> impl Strategy<Value = f64> {
    prop_oneof![
        proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO,
        -1e3..1e3
    ]
}

proptest! {
    #[test]
    fn positions_come_back_to_the_bit(xyz in prop::collection::vec([finite(), finite(), finite()], 1..20)) {
        let positions: Vec<_> = xyz.into_iter().map(DVec3::from_array).collect();
        let rows: Vec<_> = positions.iter().copied().map(row).collect();
        for format in PointFormat::ALL {
            let read = read_points(&written(format, &rows), format.name()).map_err(|e| TestCaseError::fail(e.to_string()))?;
            let bits = |points: &[DVec3]| points.iter().flat_map(|p| p.to_array()).map(f64::to_bits).collect::<Vec<_>>();
            prop_assert_eq!(bits(&read), bits(&positions), "{}", format);
        }
    }

    #[test]
    fn any_bytes_are_refused_or_read(mut bytes in prop::collection::vec(any::<u8>(), 0..200), start in 0..5usize) {
        let starts: [&[u8]; 5] = [
            b"", MAGIC, b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n",
            b"ply\nformat binary_big_endian 1.0\nelement vertex 9\nproperty list char int x\nend_header\n", b"[[1,2,3],",
        ];
        bytes.splice(0..0, starts[start].iter().copied());
        for format in PointFormat::ALL {
            if let Ok(points) = read_points(&bytes, format.name()) {
                prop_assert!(points.iter().all(|p| p.is_finite()));
            }
        }
    }

    #[test]
    fn cut_files_never_panic(cut in 0.0..1.0, flip in 0.0..1.0, to: u8) {
        let rows = [row(DVec3::ONE), row(DVec3::new(0.1, 0.2, 0.3))];
        for format in PointFormat::ALL {
            let bytes = written(format, &rows);
            let mut cut = bytes[..(bytes.len() as f64 * cut) as usize].to_vec();
            let _ = read_points(&cut, format.name());
            let place = (bytes.len() as f64 * flip) as usize;
            cut.clone_from(&bytes);
            cut[place] = to;
            let _ = read_points(&cut, format.name());
        }
    }
}
