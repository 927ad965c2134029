//! Files that are cut off, lie or are something else.

use ldwrap::io::Limits;

use crate::samples::{
    ACCESSOR, NODE, POSITIONS, glb, gltf, gzip, lines, obj, off, ply, ply_binary, ply_head, stl, stl_binary,
};
use crate::table::{Case, Expected, Input};

const POINTS: Expected = Expected::Points;

fn error(words: &'static str) -> Expected {
    Expected::Error(words)
}

fn cut(bytes: impl AsRef<[u8]>, share: f64) -> Vec<u8> {
    let bytes = bytes.as_ref();
    bytes[..(bytes.len() as f64 * share) as usize].to_vec()
}

/// As the case, with less allowed.
fn limited(case: Case, limits: Limits) -> Case {
    let Case { what, input, expected } = case;
    let input = match input {
        Input::File { name, bytes, options } => {
            Input::File { name, bytes, options: ldwrap::io::ReadOptions { limits, ..options } }
        }
        Input::Soup(soup) => Input::Soup(soup),
    };
    Case { what, input, expected }
}

pub(crate) fn cases() -> Vec<Case> {
    [whole(), broken_off(), ply_lies(), obj_lies(), stl_lies(), off_lies(), gltf_lies(), other_files()]
        .into_iter()
        .flatten()
        .collect()
}

/// The good ones that the others are made of.
fn whole() -> Vec<Case> {
    let plain = gltf(NODE, ACCESSOR, "");
    vec![
        Case::file("a good OBJ file, for comparison", "a.obj", obj(), POINTS),
        Case::file("a good PLY file", "a.ply", ply(), POINTS),
        Case::file("a good binary PLY file", "a.ply", ply_binary("uchar", &[3], &POSITIONS), POINTS),
        Case::file("a good STL file", "a.stl", stl(), POINTS),
        Case::file("a good binary STL file", "a.stl", stl_binary(4), POINTS),
        Case::file("a good OFF file", "a.off", off(), POINTS),
        Case::file("a good glTF file", "a.gltf", plain, POINTS),
        Case::file("a good PLY file, compressed", "a.ply.gz", gzip(ply().as_bytes()), POINTS),
        Case::file("a good PLY file called .obj", "a.obj", ply(), POINTS),
    ]
}

/// Without their ends.
fn broken_off() -> Vec<Case> {
    vec![
        Case::file("OBJ cut off between two faces", "a.obj", cut(obj(), 0.86), POINTS),
        Case::file("OBJ cut off in a vertex", "a.obj", cut(obj(), 0.45), error("line 4")),
        Case::file("PLY cut off in its head", "a.ply", cut(ply(), 0.5), error("end_header")),
        Case::file("PLY cut off in the faces", "a.ply", cut(ply(), 0.9), error("PLY")),
        Case::file(
            "binary PLY cut off",
            "a.ply",
            cut(ply_binary("uchar", &[3], &POSITIONS), 0.9),
            error("cut off"),
        ),
        Case::file("STL cut off", "a.stl", cut(stl(), 0.5), error("STL, triangle")),
        Case::file("binary STL cut off", "a.stl", cut(stl_binary(4), 0.7), error("284 bytes")),
        Case::file("OFF cut off", "a.off", cut(off(), 0.6), error("OFF, line 7")),
        Case::file("glTF cut off", "a.gltf", cut(gltf(NODE, ACCESSOR, ""), 0.7), error("glTF")),
        Case::file(
            "GLB cut off",
            "a.glb",
            cut(glb(&gltf(NODE, ACCESSOR, ""), &[]), 0.7),
            error("does not fit"),
        ),
        Case::file("gzip cut off", "a.ply.gz", cut(gzip(ply().as_bytes()), 0.7), error("gzip")),
    ]
}

fn ply_lies() -> Vec<Case> {
    let ascii = |vertices: &str| ply_head("ascii", vertices, "uchar") + &lines("", "3 ", 0);
    let mut nan = POSITIONS;
    nan[2][1] = f32::NAN;
    let mut infinite = POSITIONS;
    infinite[0][0] = f32::NEG_INFINITY;
    vec![
        Case::file(
            "PLY that announces 4,294,967,295 vertices",
            "a.ply",
            ascii("4294967295"),
            error("4294967295"),
        ),
        Case::file(
            "PLY that announces 10^30 vertices",
            "a.ply",
            ascii("1000000000000000000000000000000"),
            error("PLY"),
        ),
        Case::file("PLY that announces -1 vertices", "a.ply", ascii("-1"), error("PLY")),
        Case::file(
            "PLY that announces fewer vertices than there are",
            "a.ply",
            ascii("3"),
            error("vertex 3"),
        ),
        Case::file(
            "PLY with a list of 4,294,967,295 corners",
            "a.ply",
            ply_binary("uint", &[255; 4], &POSITIONS),
            error("PLY"),
        ),
        Case::file(
            "PLY with a list of -1 corners",
            "a.ply",
            ply_binary("int", &[255; 4], &POSITIONS),
            error("PLY"),
        ),
        Case::file(
            "PLY of text with a list of 10^18 corners",
            "a.ply",
            ply().replacen("\n3 0", "\n1000000000000000000 0", 1),
            error("line 14"),
        ),
        Case::file(
            "PLY of text with NaN",
            "a.ply",
            ply().replacen("0 1 0\n", "0 nan 0\n", 1),
            error("vertex 2"),
        ),
        Case::file(
            "PLY of text with 1e999",
            "a.ply",
            ply().replacen("0 1 0\n", "0 1e999 0\n", 1),
            error("finite"),
        ),
        Case::file(
            "PLY of text with NaN in a property that is no position",
            "a.ply",
            ply()
                .replacen("element face", "property float heat\nelement face", 1)
                .replacen("0 1 0\n", "0 1 0 -nan(ind)\n", 1)
                .replacen("0 0 0\n", "0 0 0 inf\n", 1)
                .replacen("1 0 0\n", "1 0 0 1.#QNAN\n", 1)
                .replacen("0 0 1\n", "0 0 1 0.\n", 1),
            POINTS,
        ),
        Case::file(
            "PLY of text with carriage returns for the ends of lines",
            "a.ply",
            ply().replace('\n', "\r"),
            POINTS,
        ),
        Case::file("binary PLY with NaN", "a.ply", ply_binary("uchar", &[3], &nan), error("vertex 2")),
        Case::file(
            "binary PLY with an infinite coordinate",
            "a.ply",
            ply_binary("uchar", &[3], &infinite),
            error("vertex 0"),
        ),
        Case::file(
            "PLY with a corner that names vertex 99",
            "a.ply",
            ply().replacen("3 0 2 1", "3 0 2 99", 1),
            error("vertex 99"),
        ),
        Case::file(
            "PLY with a corner that names vertex -7",
            "a.ply",
            ply().replacen("3 0 2 1", "3 0 2 -7", 1),
            error("face 0"),
        ),
        Case::file(
            "PLY that says it is binary and is text",
            "a.ply",
            ply().replace("ascii", "binary_little_endian"),
            error("PLY"),
        ),
        Case::file(
            "PLY without a vertex",
            "a.ply",
            "ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n",
            error("no face"),
        ),
        Case::file(
            "PLY with one element twice",
            "a.ply",
            ply().replacen("element face", "element vertex 0\nelement face", 1),
            error("twice"),
        ),
    ]
}

fn obj_lies() -> Vec<Case> {
    let with = |line: &str| obj() + line + "\n";
    vec![
        Case::file(
            "OBJ with vertex 99999999999 as a corner",
            "a.obj",
            with("f 1 2 99999999999"),
            error("line 9"),
        ),
        Case::file(
            "OBJ with a corner that 64 bits cannot hold",
            "a.obj",
            with("f 1 2 99999999999999999999"),
            error("line 9"),
        ),
        Case::file("OBJ with corner -5 of 4 vertices", "a.obj", with("f -1 -2 -5"), error("line 9")),
        Case::file("OBJ with vertex 0 as a corner", "a.obj", with("f 0 1 2"), error("line 9")),
        Case::file("OBJ with a word for a coordinate", "a.obj", with("v 1 two 3"), error("line 9")),
        Case::file("OBJ with two coordinates", "a.obj", with("v 1 2"), error("line 9")),
        Case::file("OBJ with NaN", "a.obj", obj().replacen("v 0 1 0", "v 0 nan 0", 1), error("vertex 2")),
        Case::file("OBJ with 1e999", "a.obj", obj().replacen("v 0 1 0", "v 0 1e999 0", 1), error("vertex 2")),
        Case::file(
            "OBJ with texture coordinates that are not there",
            "a.obj",
            with("f 1/7 2/8 3/9"),
            error("line 9"),
        ),
        Case::file(
            "OBJ of one line without an end",
            "a.obj",
            with(&"f 1 2 3 \\\n".repeat(10_000)),
            error("line 9"),
        ),
        Case::file(
            "OBJ with a material library that is not there",
            "a.obj",
            with("mtllib wood.mtl"),
            error("wood.mtl"),
        ),
    ]
}

fn stl_lies() -> Vec<Case> {
    let mut nan = stl_binary(4);
    nan[84 + 12..84 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    vec![
        Case::file(
            "binary STL that announces 4,294,967,295 triangles",
            "a.stl",
            stl_binary(u32::MAX),
            error("214748364834"),
        ),
        Case::file(
            "binary STL that announces fewer triangles than there are",
            "a.stl",
            stl_binary(2),
            POINTS,
        ),
        Case::file("binary STL that announces no triangle", "a.stl", stl_binary(0), error("no face")),
        Case::file("binary STL with NaN", "a.stl", nan, error("finite")),
        Case::file(
            "STL with NaN",
            "a.stl",
            stl().replacen("vertex 0 0 0", "vertex 0 nan 0", 1),
            error("triangle 0"),
        ),
        Case::file("STL without an end", "a.stl", stl().replace("endsolid t\n", ""), error("STL")),
        Case::file(
            "binary STL that starts with solid",
            "a.stl",
            [b"solid".as_slice(), &stl_binary(4)[5..]].concat(),
            POINTS,
        ),
    ]
}

fn off_lies() -> Vec<Case> {
    vec![
        Case::file(
            "OFF that announces 10^18 vertices",
            "a.off",
            off().replacen("4 4", "1000000000000000000 4", 1),
            error("OFF, line 2"),
        ),
        Case::file(
            "OFF that announces 10^18 faces",
            "a.off",
            off().replacen("4 4", "4 1000000000000000000", 1),
            error("OFF, line 10"),
        ),
        Case::file(
            "OFF with a face of 10^18 corners",
            "a.off",
            off().replacen("3 0", "1000000000000000000 0", 1),
            error("line 7"),
        ),
        Case::file(
            "OFF with a corner that names vertex 99",
            "a.off",
            off().replacen("3 0 2 1", "3 0 2 99", 1),
            error("vertex 99"),
        ),
        Case::file(
            "OFF with a corner that names vertex -1",
            "a.off",
            off().replacen("3 0 2 1", "3 0 2 -1", 1),
            error("line 7"),
        ),
        Case::file("OFF with NaN", "a.off", off().replacen("0 1 0\n", "0 nan 0\n", 1), error("vertex 2")),
    ]
}

fn gltf_lies() -> Vec<Case> {
    let chain: Vec<String> = (1..10_000).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
    let many: Vec<String> = (1..=100_000).map(|i| i.to_string()).collect();
    let shown = format!(r#"{{"children":[{}]}}{}"#, many.join(","), r#",{"mesh":0}"#.repeat(100_000));
    let document = |what: &str, nodes: &str, accessor: &str, rest: &str, expected| {
        Case::file(what, "a.gltf", gltf(nodes, accessor, rest), expected)
    };
    let limits = Limits { vertices: 100_000, ..Limits::default() };
    vec![
        Case::file(
            "JSON of 100,000 brackets",
            "a.gltf",
            format!(r#"{{"asset":{{"version":"2.0"}},"extras":{}"#, "[".repeat(100_000)),
            error("line 1 column 100036"),
        ),
        document("a chain of 10,000 nodes", &format!("{},{NODE}", chain.join(",")), ACCESSOR, "", POINTS),
        document(
            "nodes that are their own ancestors",
            r#"{"children":[1]},{"mesh":0,"children":[0]}"#,
            ACCESSOR,
            "",
            error("node 0"),
        ),
        document(
            "a node with two parents",
            r#"{"children":[1,2]},{"children":[3]},{"children":[3]},{"mesh":0}"#,
            ACCESSOR,
            "",
            error("node 3"),
        ),
        document(
            "a node that names a node that is not there",
            r#"{"children":[7]}"#,
            ACCESSOR,
            "",
            error("glTF"),
        ),
        limited(
            document(
                "a mesh shown 100,000 times, where 100,000 vertices are allowed",
                &shown,
                ACCESSOR,
                "",
                error("more than 100000 vertices"),
            ),
            limits,
        ),
        document(
            "an accessor of 10^18 vectors",
            NODE,
            r#""bufferView":0,"count":1000000000000000000"#,
            "",
            error("more than 268435456 vertices"),
        ),
        document(
            "an accessor of 10^18 vectors without data",
            NODE,
            r#""count":1000000000000000000"#,
            "",
            error("glTF"),
        ),
        document(
            "an accessor that starts behind its buffer",
            NODE,
            r#""bufferView":0,"count":4,"byteOffset":44"#,
            "",
            error("beyond its buffer"),
        ),
        document(
            "a required extension that is not understood",
            NODE,
            ACCESSOR,
            r#","extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"]"#,
            error("KHR_draco_mesh_compression"),
        ),
        Case::file(
            "a buffer for what meshopt unpacks",
            "a.gltf",
            gltf(NODE, ACCESSOR, r#","extensionsUsed":["EXT_meshopt_compression"]"#)
                .replace(r#","uri":"data:;base64,"#, r#","name":""#),
            error("EXT_meshopt_compression"),
        ),
        Case::file(
            "a buffer that is not there",
            "a.gltf",
            gltf(NODE, ACCESSOR, "").replace("data:;base64,", "b.bin?"),
            error("b.bin"),
        ),
        Case::file(
            "a buffer shorter than it says",
            "a.gltf",
            gltf(NODE, ACCESSOR, "").replace(r#""byteLength":48,"uri""#, r#""byteLength":4800,"uri""#),
            error("buffer 0"),
        ),
        Case::file(
            "GLB that says it is longer than it is",
            "a.glb",
            [&b"glTF\x02\0\0\0\xff\xff\xff\xff"[..], &[0; 40]].concat(),
            error("byte 8"),
        ),
        document(
            "a scale of 1e30, and one of 1e-30 above it",
            r#"{"children":[1],"scale":[1e-30,1e-30,1e-30]},{"mesh":0,"scale":[1e30,1e30,1e30]}"#,
            ACCESSOR,
            "",
            POINTS,
        ),
        document("a scale of 0", r#"{"mesh":0,"scale":[0,0,0]}"#, ACCESSOR, "", error("has an area")),
    ]
}

fn other_files() -> Vec<Case> {
    let limits = Limits { bytes: 1 << 20, ..Limits::default() };
    let small = Limits { vertices: 3, ..Limits::default() };
    let thin = Limits { corners: 11, ..Limits::default() };
    vec![
        Case::file("an empty file", "a.obj", "", error("known format")),
        Case::file(
            "OBJ in UTF-16",
            "a.obj",
            [0xfeff].into_iter().chain(obj().encode_utf16()).flat_map(u16::to_le_bytes).collect::<Vec<u8>>(),
            error("UTF-16"),
        ),
        Case::file("a file of zeros", "a.dat", vec![0; 1000], error("known format")),
        Case::file("a PNG picture", "a.png", b"\x89PNG\r\n\x1a\n", error("PNG")),
        Case::file("a ZIP archive", "a.zip", "PK\x03\x04", error("ZIP")),
        Case::file("a page of HTML", "a.dat", "<!DOCTYPE html><html></html>", error("known format")),
        limited(
            Case::file(
                "a gzip bomb: 16 MiB of blanks in 70 kB, where 1 MiB is allowed",
                "a.obj.gz",
                gzip(&vec![b' '; 16 << 20]),
                error("more than 1048576 bytes"),
            ),
            limits,
        ),
        limited(
            Case::file(
                "a file of 2 MiB, where 1 MiB is allowed",
                "a.obj",
                obj() + &"#".repeat(2 << 20),
                error("more than 1048576 bytes"),
            ),
            limits,
        ),
        Case::file("gzip in gzip", "a.obj.gz", gzip(&gzip(obj().as_bytes())), error("twice")),
        limited(
            Case::file(
                "OBJ of 4 vertices, where 3 are allowed",
                "a.obj",
                obj(),
                error("more than 3 vertices"),
            ),
            small,
        ),
        limited(
            Case::file(
                "PLY of 4 vertices, where 3 are allowed",
                "a.ply",
                ply(),
                error("more than 3 vertices"),
            ),
            small,
        ),
        limited(
            Case::file(
                "OFF of 4 vertices, where 3 are allowed",
                "a.off",
                off(),
                error("more than 3 vertices"),
            ),
            small,
        ),
        limited(
            Case::file(
                "STL of 12 vertices, where 3 are allowed",
                "a.stl",
                stl(),
                error("more than 3 vertices"),
            ),
            small,
        ),
        limited(
            Case::file(
                "glTF of 4 vertices, where 3 are allowed",
                "a.gltf",
                gltf(NODE, ACCESSOR, ""),
                error("more than 3 vertices"),
            ),
            small,
        ),
        limited(
            Case::file(
                "OBJ of 12 corners, where 11 are allowed",
                "a.obj",
                obj(),
                error("more than 11 corners"),
            ),
            thin,
        ),
    ]
}
