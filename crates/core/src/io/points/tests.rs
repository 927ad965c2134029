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

/// Two points with every kind of field.
pub(super) fn fields() -> Vec<Field> {
    let real = |key: &str, columns: &[&str], values: &[f64], precision| {
        Field::new(key, columns, FieldData::Real(values.to_vec(), precision))
    };
    let (single, double) = (Precision::Single, Precision::Double);
    vec![
        real("position", &["x", "y", "z"], &[1.0, 2.0, 3.0, -4.0, 0.5, 60.0], double),
        real("normal", &["nx", "ny", "nz"], &[0.0, 0.0, 1.0, 1.0, 0.0, 0.0], single),
        real("uv", &["u", "v"], &[0.25, 0.75, f64::NAN, f64::NAN], single),
        Field::new(
            "color",
            &["red", "green", "blue", "alpha"],
            FieldData::Byte(vec![255, 0, 188, 255, 0, 0, 0, 0]),
        ),
        Field::new(
            "material",
            &["material"],
            FieldData::Name { names: vec!["a, \"b\"".into(), "caf\u{e9}".into()], ids: vec![Some(1), None] },
        ),
        Field::new("face", &["face"], FieldData::Id(vec![7, 16_777_215])),
        Field::new("origin", &["origin"], FieldData::Origin(vec![Origin::Wrapped, Origin::Equalized])),
        real("cell_area", &["cell_area"], &[0.1, 1e-7], double),
    ]
}

fn fields_as(format: PointFormat) -> Vec<u8> {
    let mut out = Vec::new();
    write_fields(format, &fields(), &mut out).expect("memory takes every byte");
    out
}

#[test]
fn fields_in_text() {
    let text = |format| String::from_utf8(fields_as(format)).expect("text");
    assert_eq!(
        text(PointFormat::Csv),
        "x,y,z,nx,ny,nz,u,v,red,green,blue,alpha,material,face,origin,cell_area\n\
         1.0,2.0,3.0,0.0,0.0,1.0,0.25,0.75,255,0,188,255,caf\u{e9},7,wrapped,0.1\n\
         -4.0,0.5,60.0,1.0,0.0,0.0,,,0,0,0,0,,16777215,equalized,1e-7\n"
    );
    assert_eq!(
        text(PointFormat::Json),
        "[\n{\"position\":[1.0,2.0,3.0],\"normal\":[0.0,0.0,1.0],\"uv\":[0.25,0.75],\"color\":[255,0,188,255],\
         \"material\":\"caf\u{e9}\",\"face\":7,\"origin\":\"wrapped\",\"cell_area\":0.1},\n\
         {\"position\":[-4.0,0.5,60.0],\"normal\":[1.0,0.0,0.0],\"uv\":[null,null],\"color\":[0,0,0,0],\
         \"material\":null,\"face\":16777215,\"origin\":\"equalized\",\"cell_area\":1e-7}\n]\n"
    );
    assert_eq!(
        text(PointFormat::Xyz),
        "# x y z nx ny nz u v red green blue alpha face cell_area\n\
         1.0 2.0 3.0 0.0 0.0 1.0 0.25 0.75 255 0 188 255 7 0.1\n\
         -4.0 0.5 60.0 1.0 0.0 0.0 nan nan 0 0 0 0 16777215 1e-7\n"
    );
    assert_eq!(
        text(PointFormat::Obj),
        "v 1.0 2.0 3.0 1.0 0.0 0.7372549019607844\nv -4.0 0.5 60.0 0.0 0.0 0.0\nvt 0.25 0.75\nvt 0.0 0.0\n\
         vn 0.0 0.0 1.0\nvn 1.0 0.0 0.0\n"
    );
    let ply = text(PointFormat::PlyAscii);
    for line in [
        "comment material 0 a, \"b\"\ncomment material 1 caf\u{e9}\n",
        "property float s\nproperty float t\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n",
        "property int material\nproperty int face\nproperty uchar origin\nproperty double cell_area\nend_header\n",
        "\n1 2 3 0 0 1 0.25 0.75 255 0 188 255 1 7 0 0.1\n-4 0.5 60 1 0 0 NaN NaN 0 0 0 0 -1 16777215 2 0.0000001\n",
    ] {
        assert!(ply.contains(line), "no {line:?} in {ply}");
    }
    // The library that reads PLY takes no NaN in text.
    for format in PointFormat::ALL.into_iter().filter(|&format| format != PointFormat::PlyAscii) {
        assert_eq!(read_points(&fields_as(format), format.name()), Ok(TWO.to_vec()), "{format}");
    }
}

#[test]
fn fields_in_an_npz_archive() {
    let bytes = fields_as(PointFormat::Npz);
    let mut archive = zip::ZipArchive::new(io::Cursor::new(&bytes[..])).expect("an archive");
    let mut array = |name: &str| {
        let mut bytes = Vec::new();
        io::Read::read_to_end(&mut archive.by_name(name).expect(name), &mut bytes).expect("an array");
        let data = bytes.iter().position(|&b| b == b'\n').expect("a head") + 1;
        assert_eq!(data % 64, 0);
        (String::from_utf8_lossy(&bytes[10..data]).trim_end().to_owned(), bytes[data..].to_vec())
    };
    let head = |descr: &str, shape: &str| {
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}")
    };
    assert_eq!(array("position.npy").0, head("<f8", "(2, 3)"));
    assert_eq!(array("normal.npy").0, head("<f4", "(2, 3)"));
    assert_eq!(array("color.npy"), (head("|u1", "(2, 4)"), vec![255, 0, 188, 255, 0, 0, 0, 0]));
    assert_eq!(array("material.npy"), (head("<i4", "(2,)"), [1i32, -1].map(i32::to_le_bytes).concat()));
    let (names, letters) = array("material_names.npy");
    assert_eq!((names, letters.len()), (head("<U6", "(2,)"), 48));
    assert_eq!(letters[36..40], 0xe9u32.to_le_bytes());
    assert_eq!(array("face.npy").1, [7u32, 16_777_215].map(u32::to_le_bytes).concat());
    assert_eq!(array("origin_names.npy").0, head("<U9", "(3,)"));
    assert_eq!(bytes, fields_as(PointFormat::Npz), "no clock in it");
}

#[test]
fn fields_in_glb() {
    let bytes = fields_as(PointFormat::Glb);
    assert_eq!(bytes[8..12], (bytes.len() as u32).to_le_bytes());
    let gltf = gltf::Gltf::from_slice(&bytes).expect("valid glTF");
    let primitive = gltf.meshes().next().expect("a mesh").primitives().next().expect("a primitive");
    assert_eq!(primitive.mode(), gltf::mesh::Mode::Points);
    let blob = gltf.blob.as_deref().expect("a chunk");
    let numbers = |semantic: gltf::Semantic| -> Vec<f32> {
        let accessor = primitive.get(&semantic).unwrap_or_else(|| panic!("{semantic:?}"));
        assert_eq!(accessor.count(), 2);
        let view = accessor.view().expect("a view");
        let bytes = &blob[view.offset()..view.offset() + view.length()];
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
    };
    use gltf::Semantic::{Colors, Extras, Normals, Positions, TexCoords};
    assert_eq!(numbers(Positions), [1.0, 2.0, 3.0, -4.0, 0.5, 60.0]);
    assert_eq!(numbers(Normals), [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
    assert_eq!(numbers(TexCoords(0)), [0.25, 0.25, 0.0, 0.0]);
    assert_eq!(numbers(Extras("FACE".into())), [7.0, 16_777_215.0]);
    assert_eq!(numbers(Extras("MATERIAL".into())), [1.0, -1.0]);
    let color = numbers(Colors(0));
    assert!((color[2] - 0.502_886_5).abs() < 1e-6 && color[..2] == [1.0, 0.0], "{color:?}");
    let bounds = primitive.bounding_box();
    assert_eq!((bounds.min, bounds.max), ([-4.0, 0.5, 3.0], [1.0, 2.0, 60.0]));
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
fn npy_of_integers() {
    let wide = [i64::from(i32::MIN), -1, 7].map(i64::to_be_bytes).concat();
    for (descr, data, expected) in [
        ("|u1", vec![0, 128, 255], [0.0, 128.0, 255.0]),
        ("|i1", vec![0, 128, 255], [0.0, -128.0, -1.0]),
        ("<i2", vec![254, 255, 0, 1, 2, 0], [-2.0, 256.0, 2.0]),
        (">u4", vec![0, 0, 0, 1, 255, 255, 255, 255, 0, 1, 0, 0], [1.0, 4_294_967_295.0, 65536.0]),
        (">i8", wide, [-2_147_483_648.0, -1.0, 7.0]),
    ] {
        let file = npy(1, descr, "False", "(1, 3)", &data);
        assert_eq!(read_points(&file, "x"), Ok(vec![DVec3::from(expected)]), "{descr}");
    }
    for descr in ["<f2", "<i3", "=i4", "<i", "<c16", "|O", "<i44"] {
        let refused = read_points(&npy(1, descr, "False", "(1, 3)", &[0; 48]), "x").unwrap_err().to_string();
        assert!(refused.contains("save them as float64"), "{descr}: {refused}");
    }
}

#[test]
fn broken_files_tell_where() {
    let cases = [
        ("a.xyz", "1 2 3\n\n4 5\n", "xyz, line 3: 2 of the 3 coordinates of a point"),
        ("a.xyz", "1 2 3\n4 5 six\n", "xyz, line 2: \"six\" is not a number"),
        ("a.xyz", "1 2 3\n4 inf 6\n", "xyz, line 2: the position (4.0, inf, 6.0) is not finite"),
        ("a.xyz", "x y z\nx y z\n", "xyz, line 2: \"x\" is not a number"),
        ("a.csv", "x,y,z\n1,2,3\n1,NaN,3\n", "csv, line 3: the position (1.0, NaN, 3.0) is not finite"),
        ("a.csv", "z,y\n1,2\n", "csv, line 2: 2 of the 3 coordinates of a point"),
        ("a.csv", "", "csv: there is no point in the file"),
        ("a.obj", "v 1 2 3\nv 1 2\n", "obj, line 2: 2 of the 3 coordinates of a point"),
        ("a.json", "[]", "json: there is no point in the file"),
        ("a.json", "[[1,2,3],\n[1,2]]", "json, line 2: "),
        (
            "a",
            "1 2 3",
            "\"a\" is not in a known point format: the formats are ply, xyz, csv, npy, npz, json, obj and glb",
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
        // GLB has single precision.
        for format in PointFormat::ALL.into_iter().filter(|&format| format != PointFormat::Glb) {
            let read = read_points(&written(format, &rows), format.name()).map_err(|e| TestCaseError::fail(e.to_string()))?;
            let bits = |points: &[DVec3]| points.iter().flat_map(|p| p.to_array()).map(f64::to_bits).collect::<Vec<_>>();
            prop_assert_eq!(bits(&read), bits(&positions), "{}", format);
        }
    }

    #[test]
    fn glb_holds_single_precision(xyz in prop::collection::vec([finite(), finite(), finite()], 1..3)) {
        let positions: Vec<_> = xyz.into_iter().map(DVec3::from_array).collect();
        let rows: Vec<_> = positions.iter().copied().map(row).collect();
        let mut bytes = Vec::new();
        let result = write_points(PointFormat::Glb, &rows, &mut bytes);
        if positions.iter().any(|p| !p.as_vec3().is_finite()) {
            prop_assert!(result.is_err_and(|error| error.to_string().contains("beyond single precision")));
        } else {
            let single: Vec<_> = positions.iter().map(|p| p.as_vec3().as_dvec3()).collect();
            prop_assert_eq!(read_points(&bytes, "a"), Ok(single));
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
