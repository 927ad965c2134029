//! Files of PLY, good and bad.

use super::*;

const HEAD: &str = "ply\nformat FORMAT 1.0\ncomment caf\u{e9}\nobj_info x\nelement vertex 4\nproperty double x\n\
                    property float y\nproperty uchar quality\nproperty short z\nelement empty 7\n\
                    element face 2\nproperty uchar flags\nproperty list uchar INDEX vertex_indices\n\
                    property list uchar float texcoord\nelement edge 1\nproperty int vertex1\nend_header\n";

const POSITIONS: [(f64, f32, i16); 4] = [(0.0, 0.0, 0), (1.0, 0.5, -3), (1e-3, 1e10, 7), (-2.5, 0.25, 300)];
const FACES: [&[u8]; 2] = [&[0, 1, 2], &[3, 2, 1, 0]];

fn expected() -> PolygonSoup {
    let positions = POSITIONS.map(|(x, y, z)| DVec3::new(x, y.into(), z.into())).to_vec();
    let mut soup = PolygonSoup { positions, ..Default::default() };
    for face in FACES {
        soup.push_polygon(&face.iter().map(|&v| v.into()).collect::<Vec<u32>>());
    }
    soup
}

fn ascii(index: &str) -> String {
    let mut text = HEAD.replace("FORMAT", "ascii").replace("INDEX", index);
    for (x, y, z) in POSITIONS {
        text += &format!("{x:e} {y} 200 {z}\n");
    }
    text += &"\n".repeat(7);
    text += "0 3 0 1 2 2 0.5 0.25\n9 4 3 2 1 0 0\n8\n";
    text
}

fn binary(big: bool, index: &str) -> Vec<u8> {
    let format = if big { "binary_big_endian" } else { "binary_little_endian" };
    let head = HEAD
        .replace("FORMAT", format)
        .replace("INDEX", index)
        .replace("element empty 7", "element empty 999999999999");
    let mut bytes = head.into_bytes();
    let mut put = |little: &[u8]| {
        if big { bytes.extend(little.iter().rev()) } else { bytes.extend(little) }
    };
    for (x, y, z) in POSITIONS {
        put(&x.to_le_bytes());
        put(&y.to_le_bytes());
        put(&[200]);
        put(&z.to_le_bytes());
    }
    for face in FACES {
        put(&[0]);
        put(&[face.len() as u8]);
        for &v in face {
            match index {
                "char" | "uchar" => put(&[v]),
                "short" | "ushort" => put(&u16::from(v).to_le_bytes()),
                _ => put(&u32::from(v).to_le_bytes()),
            }
        }
        put(&[1]);
        put(&0.5f32.to_le_bytes());
    }
    put(&8i32.to_le_bytes());
    bytes
}

#[test]
fn every_encoding_and_type_of_index() {
    for index in ["char", "uchar", "short", "ushort", "int", "uint"] {
        assert_eq!(read(ascii(index).as_bytes()).unwrap(), expected(), "{index}");
        assert_eq!(read(&binary(false, index)).unwrap(), expected(), "{index}");
        assert_eq!(read(&binary(true, index)).unwrap(), expected(), "{index}");
    }
    let other_name = ascii("int").replace("vertex_indices", "vertex_index");
    assert_eq!(read(other_name.as_bytes()).unwrap(), expected());
    let text = ascii("int");
    let (head, data) = text.split_once("end_header\n").unwrap();
    for same in [
        text.replace('\n', "\r\n"),
        text.replace('\n', "\r"),
        format!("{head}end_header\n{}", data.replace('\n', "\n \n")),
        format!(
            "{head}end_header\n{}",
            data.replace("0e0 0 200 0", "0. .0 200 0").replace("0.5 200", ".5 200")
        ),
    ] {
        assert_eq!(read(same.as_bytes()).unwrap(), expected(), "{same}");
    }
}

#[test]
fn every_truncation_is_an_error() {
    let text = ascii("int");
    let whole = [text.trim_end().as_bytes().to_vec(), binary(false, "int"), binary(true, "uchar")];
    for bytes in &whole {
        assert_eq!(read(bytes).unwrap(), expected());
        for length in 0..bytes.len() {
            let result = read(&bytes[..length]);
            // A cut through the last number of a text leaves a number.
            assert!(result.is_err(), "{length} of {}", bytes.len());
        }
    }
}

#[test]
fn strips() {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n11 0 1 2 3 3 -1 2 3 4 -1 0\n";
    let soup = read(text.as_bytes()).unwrap();
    assert_eq!(soup.corners, [0, 1, 2, 2, 1, 3, 2, 3, 4]);
    assert!(read(text.replace("-1", "-2").as_bytes()).unwrap_err().to_string().contains("PLY, strip 0"));
}

#[test]
fn bad_files_are_named() {
    let message = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
    let good = ascii("int");
    assert!(message("ply\nformat ascii 1.0\n").contains("no line `end_header`"));
    assert!(message(&good.replace("ascii", "utf16")).starts_with("PLY, line 2: Couldn't parse line."));
    assert!(message(&good.replace("uchar quality", "float x")).contains("declared twice"));
    assert!(message(&good.replace("element edge", "element face")).contains("declared twice"));
    assert!(
        message(&good.replace("float y", "float v")).contains("element `vertex` has no fitting property `y`")
    );
    assert!(message(&good.replace("float y", "list uchar float y")).contains("no fitting property `y`"));
    assert!(
        message(&good.replace("vertex_indices", "corners")).contains("no fitting property `vertex_indices`")
    );
    for count in ["1000000000000", "18446744073709551615", "3000000000"] {
        assert!(
            message(&good.replace("vertex 4", &format!("vertex {count}"))).contains("are announced"),
            "{count}"
        );
        assert!(
            message(&good.replace("face 2", &format!("face {count}"))).contains("are announced"),
            "{count}"
        );
    }
    assert!(message(&good.replace("vertex 4", "vertex 99999999999999999999")).contains("line 5"));
    assert!(message(&good.replace("0 3 0 1 2", "0 3 0 -1 2")).contains("face 0: a corner is vertex -1"));
    let line = good.lines().position(|l| l.starts_with("9 4")).unwrap() + 1;
    let error = message(&good.replace("9 4 3", "9 400000000 3"));
    assert!(error.starts_with(&format!("PLY, line {line}: ")), "{error}");
    assert!(message(&good.replace("-2.5", "two")).contains("line"));
    assert!(message(&good.replace("list uchar int v", "list uchar float v")).contains("unsupported"));

    let mut lying = binary(false, "uint");
    let start = lying.len() - 4 - 5 - 16 - 1;
    assert_eq!(lying[start], 4);
    lying[start] = 255;
    assert!(matches!(read(&lying), Err(ReadError::Truncated { .. })));
}

/// What is not finite is told as in binary files, where it is asked for; a position must be finite.
#[test]
fn numbers_that_are_not_finite() {
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                property float nx\nproperty float ny\nproperty float nz\nproperty double heat\n\
                element face 1\nproperty list uchar int vertex_indices\nproperty float quality\nend_header\n";
    let text =
        format!("{head}0 0 0 0 0 1 nan\n1 0 0 -nan(ind) 0 1 -inf\n0 1 0 0 0 1 -1.#IND\n3 0 1 2 1.#INF\n");
    assert_eq!(read(text.as_bytes()).unwrap().polygon_count(), 1);
    let model = read_model(text.as_bytes(), Detail::Attributes, &|_| Err(String::new())).unwrap();
    let (name, heat) = model.attributes.numbers.last().unwrap();
    assert_eq!(name, "heat");
    let heat = [0, 1, 2].map(|corner| heat.get(corner).unwrap());
    assert!(heat[0].is_nan() && heat[1] == f64::NEG_INFINITY && heat[2].is_nan(), "{heat:?}");
    assert_eq!(model.attributes.normals.get(1), Some(DVec3::ZERO));
    assert_eq!(model.attributes.normals.get(0), Some(DVec3::Z));
    // The check of the soup tells the vertex.
    let soup = read(text.replace("\n0 1 0", "\n0 nan 0").as_bytes()).unwrap();
    assert!(soup.positions[2].y.is_nan());
}
