//! Files of glTF, good and bad.

use super::*;
use crate::mesh::{CheckOptions, SurfaceMesh};

fn no_files(uri: &str) -> Result<Vec<u8>, String> {
    Err(format!("there is no {uri}"))
}

fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + bin.len() as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((bin.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(bin);
    bytes
}

/// Four corners of a square in single precision, then six indices in 16 bits.
fn square() -> Vec<u8> {
    let corners: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]];
    let mut bin: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    bin.extend([0u16, 1, 2, 2, 1, 3].iter().flat_map(|i| i.to_le_bytes()));
    bin
}

/// A document about the square: `nodes` and what else there is, primitives of mesh 0.
fn document(top: &str, primitives: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, {top},
        "meshes": [{{"primitives": [{primitives}]}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0,0,0], "max": [1,1,0]}},
            {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}},
            {{"bufferView": 1, "byteOffset": 2, "componentType": 5123, "count": 3, "type": "SCALAR"}}],
        "bufferViews": [
            {{"buffer": 0, "byteLength": 48}},
            {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}],
        "buffers": [{{"byteLength": 60}}]}}"#
    )
}

const LIST: &str = r#"{"attributes": {"POSITION": 0}, "indices": 1}"#;
const ONE_NODE: &str = r#""nodes": [{"mesh": 0}]"#;

fn read_glb(json: &str) -> Result<PolygonSoup, ReadError> {
    read(&glb(json, &square()), &no_files)
}

fn message(json: &str) -> String {
    read_glb(json).unwrap_err().to_string()
}

#[test]
fn binary_embedded_and_external_buffers_are_the_same() {
    let json = document(ONE_NODE, LIST);
    let soup = read_glb(&json).unwrap();
    assert_eq!(soup.positions.len(), 4);
    assert_eq!(soup.corners, [0, 1, 2, 2, 1, 3]);
    assert_eq!(read_glb(&json.replace(r#", "min": [0,0,0], "max": [1,1,0]"#, "")).unwrap(), soup);

    let data = base64::engine::general_purpose::STANDARD.encode(square());
    use base64::Engine as _;
    let uri = format!(r#"{{"uri": "data:application/octet-stream;base64,{data}", "byteLength": 60"#);
    let embedded = json.replace(r#"{"byteLength": 60"#, &uri);
    assert_eq!(read(embedded.as_bytes(), &no_files).unwrap(), soup);

    let external = json.replace(r#"{"byteLength": 60"#, r#"{"uri": "a%20b.bin", "byteLength": 60"#);
    let resolver = |uri: &str| if uri == "a b.bin" { Ok(square()) } else { Err(format!("no {uri}")) };
    assert_eq!(read(external.as_bytes(), &resolver).unwrap(), soup);
    let error = read(external.as_bytes(), &no_files).unwrap_err();
    assert_eq!(
        error.to_string(),
        "glTF: \"a%20b.bin\" is needed too, but there is no a b.bin; keep it beside the file"
    );
}

#[test]
fn strips_fans_lists_and_what_is_no_triangle() {
    let with = |primitives: &str| read_glb(&document(ONE_NODE, primitives)).unwrap();
    assert_eq!(with(r#"{"attributes": {"POSITION": 0}, "mode": 5}"#).corners, [0, 1, 2, 2, 1, 3]);
    assert_eq!(with(r#"{"attributes": {"POSITION": 0}, "mode": 6}"#).corners, [0, 1, 2, 0, 2, 3]);
    // Index strip 0 1 2 2 1 3: the triangles with 2 2 only sew; the last is the fourth, turned.
    assert_eq!(
        with(r#"{"attributes": {"POSITION": 0}, "indices": 1, "mode": 5}"#).corners,
        [0, 1, 2, 1, 2, 3]
    );
    assert_eq!(with(r#"{"attributes": {"POSITION": 0}}"#).corners, [0, 1, 2]);
    assert_eq!(with(r#"{"attributes": {"POSITION": 0}, "mode": 1}"#), PolygonSoup::default());
    assert_eq!(with(r#"{"attributes": {"NORMAL": 0}}"#), PolygonSoup::default());
    // Two primitives on the same positions.
    let two = with(&format!(r#"{LIST}, {{"attributes": {{"POSITION": 0}}, "indices": 2}}"#));
    assert_eq!((two.positions.len(), two.corners.len()), (4, 9));
}

#[test]
fn transforms_place_and_mirrors_turn() {
    let nodes = r#""scene": 0, "scenes": [{"nodes": [0]}], "nodes": [
        {"children": [1, 2], "translation": [10, 0, 0], "scale": [2, 2, 2]},
        {"mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678]},
        {"mesh": 0, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]},
        {"mesh": 0}]"#;
    let soup = read_glb(&document(nodes, LIST)).unwrap();
    assert_eq!((soup.positions.len(), soup.polygon_count()), (8, 4));
    // (1, 0, 0) turned to y, doubled, moved.
    assert!(soup.positions[1].distance(DVec3::new(10.0, 2.0, 0.0)) < 1e-6);
    assert_eq!(soup.positions[4 + 1], DVec3::new(10.0 + 2.0 * 4.0, 0.0, 0.0));
    let (mesh, report) = SurfaceMesh::from_soup(&soup, &CheckOptions::default()).unwrap();
    assert!(report.is_clean());
    assert!((mesh.area() - 8.0).abs() < 1e-6);
    for face in mesh.topology().face_ids() {
        assert!(mesh.face_normal(face).z > 0.999);
    }
    // Without a scene the roots are the nodes that are nobody's children.
    let all = nodes.replace(r#""scene": 0, "scenes": [{"nodes": [0]}], "#, "");
    assert_eq!(read_glb(&document(&all, LIST)).unwrap().polygon_count(), 6);
}

#[test]
fn quantized_and_sparse_positions() {
    let json = document(ONE_NODE, r#"{"attributes": {"POSITION": 0}, "mode": 5}"#)
        .replace(r#""asset""#, r#""extensionsRequired": ["KHR_mesh_quantization"], "asset""#)
        .replace(
            r#"{"bufferView": 0, "componentType": 5126,"#,
            r#"{"bufferView": 0, "normalized": true, "componentType": 5122,"#,
        )
        .replace(r#""byteLength": 48}"#, r#""byteLength": 48, "byteStride": 8}"#);
    let mut bin: Vec<u8> = [[0i16, 0, 0, 9], [32767, 0, 0, 9], [0, 32767, 0, 9], [-32768, 16384, 0, 9]]
        .as_flattened()
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bin.resize(60, 0);
    let soup = read(&glb(&json, &bin), &no_files).unwrap();
    assert_eq!(soup.positions[1..3], [DVec3::X, DVec3::Y]);
    assert_eq!(soup.positions[3], DVec3::new(-1.0, 16384.0 / 32767.0, 0.0));

    // All zero but for vertices 1 and 2, whose numbers (the first two indices: 0 1 -> 1 2) lie behind.
    let sparse = document(ONE_NODE, r#"{"attributes": {"POSITION": 0}, "mode": 5}"#).replace(
        r#"{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "#,
        r#"{"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 2,
            "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5123},
            "values": {"bufferView": 0, "byteOffset": 12}}, "#,
    );
    let soup = read_glb(&sparse).unwrap();
    assert_eq!(soup.positions, [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO]);
    let huge = sparse.replace(r#""count": 4"#, r#""count": 99999999"#);
    assert!(message(&huge).contains("accessor 0: it has no data"));
}

#[test]
fn bad_documents_are_named() {
    let good = document(ONE_NODE, LIST);
    let replaced = |from: &str, to: &str| {
        assert!(good.contains(from));
        message(&good.replace(from, to))
    };
    assert!(
        replaced(r#""count": 4"#, r#""count": 5"#)
            .contains("mesh 0: accessor 0: it reaches beyond its buffer")
    );
    assert!(replaced(r#""count": 4"#, r#""count": 1152921504606846976"#).contains("mesh 0"));
    assert!(
        replaced(r#""count": 4"#, r#""count": 3"#)
            .contains("primitive 0: a corner is vertex 3, but there are 3")
    );
    assert!(
        replaced(r#""byteOffset": 48"#, r#""byteOffset": 18446744073709551610"#).contains("reaches beyond")
    );
    assert!(
        replaced(r#""byteLength": 60"#, r#""byteLength": 61"#)
            .contains("buffer 0: it should have 61 bytes, but has 60")
    );
    assert!(replaced(r#""indices": 1"#, r#""indices": 9"#).contains("out of bounds"));
    assert!(replaced(r#""indices": 1"#, r#""indices": 0"#).contains("indices must be unsigned integers"));
    assert!(replaced(r#""POSITION": 0"#, r#""POSITION": 1"#).contains("positions must be vectors"));
    assert!(
        replaced(r#""POSITION": 0"#, r#""POSITION": 7"#).contains("mesh 0: an attribute has no accessor")
    );
    assert!(replaced("5123", "1").starts_with("glTF, file: "));
    assert!(
        replaced(r#""asset""#, r#""extensionsRequired": ["KHR_draco_mesh_compression"], "asset""#).contains(
            "the required extension KHR_draco_mesh_compression cannot be read; write it without compression"
        )
    );
    assert!(
        replaced(ONE_NODE, r#""nodes": [{"children": [1]}, {"children": [0]}], "scenes": [{"nodes": [0]}]"#)
            .contains("node 0: it has two parents, or is its own ancestor")
    );
    assert!(
        replaced(ONE_NODE, r#""nodes": [{"mesh": 0}], "scenes": [{"nodes": [0, 0]}]"#)
            .contains("two parents")
    );
    assert!(message(&format!("{}{}", "[".repeat(100_000), "]".repeat(100_000))).starts_with("glTF, file: "));
    assert!(message("{}").starts_with("glTF, file: "));

    let bytes = glb(&good, &square());
    assert!(read(&bytes, &no_files).is_ok());
    for length in 0..bytes.len() {
        assert!(read(&bytes[..length], &no_files).is_err(), "{length}");
    }
    for length in [0u32, 11, 12, 19, u32::MAX] {
        let mut lying = bytes.clone();
        lying[8..12].copy_from_slice(&length.to_le_bytes());
        assert!(read(&lying, &no_files).is_err());
    }
}

#[test]
fn a_node_chain_as_deep_as_the_file_is_long() {
    let count = 100_000;
    let mut nodes: Vec<String> = (1..count).map(|i| format!(r#"{{"children": [{i}]}}"#)).collect();
    nodes.push(r#"{"mesh": 0}"#.into());
    let json = document(&format!(r#""nodes": [{}], "scenes": [{{"nodes": [0]}}]"#, nodes.join(",")), LIST);
    assert_eq!(read_glb(&json).unwrap().polygon_count(), 2);
}
