//! Bytes that lie: no reader may panic, allocate by what a header says, or let through what checking cannot take.
#![cfg(feature = "io")]

use ldwrap::io::{self, ReadError};
use ldwrap::{CheckOptions, PolygonSoup, SurfaceMesh};
use proptest::prelude::*;

fn no_files(uri: &str) -> Result<Vec<u8>, String> {
    Err(format!("{uri} is not there"))
}

type Reader = fn(&[u8]) -> Result<PolygonSoup, ReadError>;

const READERS: [(&str, Reader); 6] = [
    ("obj", io::obj::read),
    ("gltf", |bytes| io::gltf::read(bytes, &no_files)),
    ("ply", io::ply::read),
    ("stl", io::stl::read),
    ("off", io::off::read),
    ("detected", |bytes| io::read_mesh(bytes, None, &no_files)),
];

/// Reads with every reader and checks what comes out; gives what the reader for the format said.
fn survive(bytes: &[u8]) {
    for (name, read) in READERS {
        match read(bytes) {
            Ok(soup) => {
                if let Ok((mesh, _)) = SurfaceMesh::from_soup(&soup, &CheckOptions::default()) {
                    assert!(mesh.area().is_finite() && mesh.area() > 0.0, "{name}");
                }
            }
            Err(error) => {
                let message = error.to_string();
                assert!(
                    !message.is_empty() && message.len() < 1000 && !message.contains('\n'),
                    "{name}: {message}"
                );
            }
        }
    }
}

/// A small good file of each kind.
fn good() -> Vec<Vec<u8>> {
    let tetrahedron = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
    let faces = ["0 2 1", "0 1 3", "1 2 3", "0 3 2"];
    let rows =
        |prefix: &str, rows: &[&str]| rows.iter().map(|r| format!("{prefix}{r}\n")).collect::<String>();
    let ply_head = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let number = |word: &str| word.parse::<f32>().unwrap();
    let mut positions = Vec::new();
    tetrahedron.iter().for_each(|r| positions.extend(r.split(' ').flat_map(|w| number(w).to_le_bytes())));
    let mut ply = ply_head("binary_little_endian").into_bytes();
    ply.extend(&positions);
    let mut stl = vec![b' '; 80];
    stl.extend(4u32.to_le_bytes());
    let mut stl_text = String::from("solid t\n");
    for face in faces {
        ply.push(3);
        stl.extend([0; 12]);
        stl_text += "facet normal 0 0 0\nouter loop\n";
        for corner in face.split(' ').map(|w| w.parse::<usize>().unwrap()) {
            ply.extend((corner as u32).to_le_bytes());
            stl.extend(&positions[12 * corner..12 * corner + 12]);
            stl_text += &format!("vertex {}\n", tetrahedron[corner]);
        }
        stl.extend([0; 2]);
        stl_text += "endloop\nendfacet\n";
    }
    stl_text += "endsolid t\n";
    let json = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[2,1,1]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":5}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}],
        "bufferViews":[{"buffer":0,"byteLength":48}],"buffers":[{"byteLength":48}]}"#;
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((12 + 8 + json.len() as u32 + 8 + 48).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend(48u32.to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(&positions);
    vec![
        (rows("v ", &tetrahedron) + "f 1 3 2\nf 1 2 4\nf 2//1 3/1 4/1/1\nf -4 -1 -2\n").into_bytes(),
        (ply_head("ascii") + &rows("", &tetrahedron) + &rows("3 ", &faces)).into_bytes(),
        ply,
        stl,
        stl_text.into_bytes(),
        (String::from("OFF\n4 4 6\n") + &rows("", &tetrahedron) + &rows("3 ", &faces)).into_bytes(),
        glb,
    ]
}

#[test]
fn good_files_are_good() {
    for bytes in good() {
        let soup = io::read_mesh(&bytes, None, &no_files).unwrap();
        let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default()).unwrap();
        assert_eq!(mesh.vertex_count(), 4);
        survive(&bytes);
    }
}

#[test]
fn files_cut_off_anywhere() {
    for bytes in good() {
        (0..bytes.len()).for_each(|length| survive(&bytes[..length]));
    }
}

#[test]
fn numbers_replaced_by_large_ones() {
    for bytes in good() {
        let Ok(text) = String::from_utf8(bytes) else { continue };
        let digits = text.char_indices().filter(|(_, c)| c.is_ascii_digit()).map(|(i, _)| i);
        for place in digits {
            for value in
                ["-1", "4294967295", "4294967296", "1000000000000", "18446744073709551615", "1e400", "nan"]
            {
                survive([&text[..place], value, &text[place + 1..]].concat().as_bytes());
            }
        }
    }
}

#[test]
fn words_repeated_a_million_times() {
    for word in [
        "v ",
        "f 1 ",
        "\\\n",
        "ply\n",
        "comment\n",
        "solid\n",
        "OFF\n",
        "[",
        "{\"a\":",
        "#",
        "\n",
        "0 ",
        "\u{feff}",
    ] {
        survive(word.repeat(1_000_000 / word.len()).as_bytes());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn bytes_changed_inserted_and_removed(
        kind in 0usize..7,
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0u8..3), 1..6),
    ) {
        let mut bytes = good().swap_remove(kind);
        for (place, value, edit) in edits {
            let place = place.index(bytes.len());
            match edit {
                0 => bytes[place] = value,
                1 => bytes.insert(place, value),
                _ => {
                    bytes.remove(place);
                }
            }
        }
        survive(&bytes);
    }

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300), kind in 0usize..7, keep in 0usize..200) {
        survive(&bytes);
        let mut start = good().swap_remove(kind);
        start.truncate(keep);
        start.extend(bytes);
        survive(&start);
    }
}
