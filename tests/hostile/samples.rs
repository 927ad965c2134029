//! A tetrahedron in every format, with places for lies.

use std::io::Write;

pub(crate) const POSITIONS: [[f32; 3]; 4] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
pub(crate) const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// The lines of the vertices, and of the faces counted from `first`.
pub(crate) fn lines(vertex: &str, face: &str, first: u32) -> String {
    let vertices = POSITIONS.iter().map(|[x, y, z]| format!("{vertex}{x} {y} {z}\n"));
    let faces = FACES.iter().map(|f| f.map(|i| i + first)).map(|[a, b, c]| format!("{face}{a} {b} {c}\n"));
    vertices.chain(faces).collect()
}

pub(crate) fn obj() -> String {
    lines("v ", "f ", 1)
}

pub(crate) fn off() -> String {
    format!("OFF\n4 4 6\n{}", lines("", "3 ", 0))
}

pub(crate) fn ply_head(format: &str, vertices: &str, list: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face 4\nproperty list {list} int vertex_indices\nend_header\n"
    )
}

pub(crate) fn ply() -> String {
    ply_head("ascii", "4", "uchar") + &lines("", "3 ", 0)
}

pub(crate) fn bytes_of(positions: &[[f32; 3]]) -> Vec<u8> {
    positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// Binary; `count` stands before the corners of the first face.
pub(crate) fn ply_binary(list: &str, count: &[u8], positions: &[[f32; 3]]) -> Vec<u8> {
    let mut bytes = ply_head("binary_little_endian", "4", list).into_bytes();
    bytes.extend(bytes_of(positions));
    for (i, face) in FACES.iter().enumerate() {
        let mut three = vec![0; count.len()];
        three[0] = 3;
        bytes.extend(if i == 0 { count } else { &three });
        bytes.extend(face.iter().flat_map(|i| i.to_le_bytes()));
    }
    bytes
}

pub(crate) fn stl() -> String {
    let vertex = |i: u32| {
        let [x, y, z] = POSITIONS[i as usize];
        format!("vertex {x} {y} {z}\n")
    };
    let facet = |face: [u32; 3]| {
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", face.map(vertex).concat())
    };
    format!("solid t\n{}endsolid t\n", FACES.map(facet).concat())
}

pub(crate) fn stl_binary(count: u32) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(count.to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        face.iter().for_each(|&i| bytes.extend(bytes_of(&[POSITIONS[i as usize]])));
        bytes.extend([0; 2]);
    }
    bytes
}

/// A document with these nodes and this accessor of positions; the buffer is the four positions.
pub(crate) fn gltf(nodes: &str, accessor: &str, rest: &str) -> String {
    let data: String = {
        use base64::Engine;
        base64::engine::general_purpose::STANDARD.encode(bytes_of(&POSITIONS))
    };
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":5}}]}}],
        "accessors":[{{"componentType":5126,"type":"VEC3","min":[0,0,0],"max":[1,1,1],{accessor}}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}}],
        "buffers":[{{"byteLength":48,"uri":"data:;base64,{data}"}}]{rest}}}"#
    )
}

pub(crate) const NODE: &str = r#"{"mesh":0}"#;
pub(crate) const ACCESSOR: &str = r#""bufferView":0,"count":4"#;

pub(crate) fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json[..]), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

pub(crate) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("memory takes all");
    encoder.finish().expect("memory takes all")
}
