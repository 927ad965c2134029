//! Every written format of points, read back by code that is not ours: the crates `serde-ply`, `csv`, `serde_json`, `gltf` and
//! `obj`. NPY and NPZ are compared byte by byte with NumPy's specification where they are written, and read by NumPy itself
//! in `peers.py`, with all the others by Open3D, trimesh and MeshLab.

use std::collections::BTreeMap;

use ldwrap::io::points::{Attribute, Field, FieldData, PointFormat, gather, write_fields};
use ldwrap::io::{Detail, read_model};
use ldwrap::{CheckOptions, SurfaceMesh};
use serde::Deserialize;

const COUNT: usize = 50;

/// A bent sheet whose vertices have colours, texture coordinates and a temperature.
const SHEET: &str = "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float s\nproperty float t\n\
    property float heat\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 255 0 0 0 0 20.5\n1 0 0 0 255 0 0.5 0 -3\n1 2 0 0 0 255 0.5 1 7\n0 2 0 9 99 199 0 1 1e-3\n\
    2 0 1 0 0 0 1 0 0\n2 2 1 255 255 255 1 1 1\n4 0 1 2 3\n4 1 4 5 2\n";

/// The points of the sheet with all that there is.
fn fields(attributes: &[Attribute]) -> Vec<Field> {
    let model = read_model(SHEET.as_bytes(), None, Detail::Textures, &|_| Err(String::new())).expect("PLY");
    let (mesh, _) = SurfaceMesh::from_soup(&model.soup, &CheckOptions::default()).expect("a surface");
    let samples = ldwrap::sample(&mesh, COUNT).expect("points");
    gather(&mesh, &model.attributes, &samples, attributes).expect("all attributes are there")
}

fn everything() -> Vec<Attribute> {
    [
        Attribute::SmoothNormal,
        Attribute::Uv,
        Attribute::Color,
        Attribute::Face,
        Attribute::Barycentric,
        Attribute::Origin,
        Attribute::CellArea,
        Attribute::Number("heat".into()),
    ]
    .into()
}

fn written(format: PointFormat, fields: &[Field]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_fields(format, fields, &mut bytes).expect("memory takes every byte");
    bytes
}

/// What a field's columns hold at a point, as numbers.
fn numbers(fields: &[Field], key: &str, point: usize) -> Vec<f64> {
    let field = fields.iter().find(|field| field.key == key).unwrap_or_else(|| panic!("no field {key}"));
    let columns = field.columns.len();
    let at = point * columns..(point + 1) * columns;
    match &field.data {
        FieldData::Real(values, _) => values[at].to_vec(),
        FieldData::Id(ids) => ids[at].iter().map(|&id| id.into()).collect(),
        FieldData::Byte(bytes) => bytes[at].iter().map(|&byte| byte.into()).collect(),
        other => panic!("{key} holds {other:?}"),
    }
}

#[derive(Deserialize)]
struct Cloud {
    vertex: Vec<PlyPoint>,
}

#[derive(Deserialize)]
struct PlyPoint {
    x: f64,
    y: f64,
    z: f64,
    nx: f32,
    ny: f32,
    nz: f32,
    s: f32,
    t: f32,
    red: u8,
    green: u8,
    blue: u8,
    alpha: u8,
    face: i32,
    b0: f64,
    b1: f64,
    b2: f64,
    origin: u8,
    cell_area: f64,
    heat: f64,
}

#[test]
fn ply_by_serde_ply() {
    let fields = fields(&everything());
    for format in [PointFormat::Ply, PointFormat::PlyAscii] {
        let cloud: Cloud = serde_ply::from_reader(&*written(format, &fields)).expect("a PLY file");
        assert_eq!(cloud.vertex.len(), COUNT);
        for (i, p) in cloud.vertex.iter().enumerate() {
            let found: BTreeMap<&str, Vec<f64>> = BTreeMap::from([
                ("position", vec![p.x, p.y, p.z]),
                ("normal", [p.nx, p.ny, p.nz].map(f64::from).into()),
                ("uv", [p.s, p.t].map(f64::from).into()),
                ("color", [p.red, p.green, p.blue, p.alpha].map(f64::from).into()),
                ("face", vec![p.face.into()]),
                ("barycentric", vec![p.b0, p.b1, p.b2]),
                ("cell_area", vec![p.cell_area]),
                ("heat", vec![p.heat]),
            ]);
            for (key, values) in found {
                // Properties of type float are singles.
                let single = ["normal", "uv"].contains(&key);
                let expected = numbers(&fields, key, i)
                    .into_iter()
                    .map(|x| if single { f64::from(x as f32) } else { x })
                    .collect::<Vec<f64>>();
                assert_eq!(values, expected, "{format}: {key} of point {i}");
            }
            assert_eq!(p.origin, 2);
        }
    }
}

#[test]
fn csv_by_csv() {
    let fields = fields(&everything());
    let bytes = written(PointFormat::Csv, &fields);
    let mut reader = csv::Reader::from_reader(&*bytes);
    let rows: Vec<BTreeMap<String, String>> =
        reader.deserialize().collect::<Result<_, _>>().expect("a CSV file");
    assert_eq!(rows.len(), COUNT);
    for (i, row) in rows.iter().enumerate() {
        for field in fields.iter().filter(|field| field.key != "origin") {
            let found: Vec<f64> =
                field.columns.iter().map(|column| row[column].parse().expect("a number")).collect();
            assert_eq!(found, numbers(&fields, &field.key, i), "{} of point {i}", field.key);
        }
        assert_eq!(row["origin"], "equalized");
    }
}

#[test]
fn json_by_serde_json() {
    let fields = fields(&everything());
    let rows: Vec<BTreeMap<String, serde_json::Value>> =
        serde_json::from_slice(&written(PointFormat::Json, &fields)).expect("a JSON file");
    assert_eq!(rows.len(), COUNT);
    for (i, row) in rows.iter().enumerate() {
        for field in fields.iter().filter(|field| field.key != "origin") {
            let found: Vec<f64> = match &row[&field.key] {
                serde_json::Value::Array(values) => values.iter().filter_map(|v| v.as_f64()).collect(),
                value => vec![value.as_f64().expect("a number")],
            };
            assert_eq!(found, numbers(&fields, &field.key, i), "{} of point {i}", field.key);
        }
        assert_eq!(row["origin"], "equalized");
    }
}

#[test]
fn glb_by_gltf() {
    let fields = fields(&everything());
    let bytes = written(PointFormat::Glb, &fields);
    // Validates against the specification's schema; then the crate's own accessors read the buffer.
    let gltf = gltf::Gltf::from_slice(&bytes).expect("a valid GLB file");
    let blob = gltf.blob.clone().expect("a binary chunk");
    let mesh = gltf.meshes().next().expect("a mesh");
    let primitive = mesh.primitives().next().expect("a primitive");
    assert_eq!(primitive.mode(), gltf::mesh::Mode::Points);
    let reader = primitive.reader(|_| Some(&blob[..]));
    let positions: Vec<[f32; 3]> = reader.read_positions().expect("positions").collect();
    let normals: Vec<[f32; 3]> = reader.read_normals().expect("normals").collect();
    let uv: Vec<[f32; 2]> = reader.read_tex_coords(0).expect("coordinates").into_f32().collect();
    let colors: Vec<[u8; 4]> = reader.read_colors(0).expect("colours").into_rgba_u8().collect();
    assert_eq!([positions.len(), normals.len(), uv.len(), colors.len()], [COUNT; 4]);
    let single = |key: &str, i: usize| -> Vec<f32> {
        numbers(&fields, key, i).into_iter().map(|x| x as f32).collect()
    };
    for i in 0..COUNT {
        assert_eq!(positions[i].to_vec(), single("position", i));
        assert_eq!(normals[i].to_vec(), single("normal", i));
        // The origin of glTF is the upper left corner.
        let expected = numbers(&fields, "uv", i);
        assert_eq!(uv[i], [expected[0] as f32, (1.0 - expected[1]) as f32]);
        // Its colours are linear.
        let linear = |srgb: f64| 255.0 * ldwrap::attributes::from_srgb(srgb / 255.0);
        let expected = numbers(&fields, "color", i);
        for channel in 0..3 {
            let (found, expected) = (f64::from(colors[i][channel]), linear(expected[channel]));
            assert!((found - expected).abs() < 1.01, "{found} is not {expected}");
        }
    }
}

#[test]
fn obj_by_obj() {
    let fields = fields(&[Attribute::FlatNormal, Attribute::Uv, Attribute::Color]);
    let read = obj::ObjData::load_buf(&*written(PointFormat::Obj, &fields)).expect("an OBJ file");
    assert_eq!([read.position.len(), read.normal.len(), read.texture.len()], [COUNT; 3]);
    for i in 0..COUNT {
        let single =
            |key: &str| -> Vec<f32> { numbers(&fields, key, i).into_iter().map(|x| x as f32).collect() };
        assert_eq!(read.position[i].to_vec(), single("position"));
        assert_eq!(read.normal[i].to_vec(), single("normal"));
        assert_eq!(read.texture[i].to_vec(), single("uv"));
    }
}
