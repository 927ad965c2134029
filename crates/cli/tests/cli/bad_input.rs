//! Meshes that cannot be used: exit code 1, one line that names the file and what is wrong, and no output.

use crate::common::{Folder, OCTAHEDRON};

/// Wraps a file with this content and expects a failure that names the file and `words`.
#[track_caller]
fn rejected(name: &str, content: impl AsRef<[u8]>, words: &[&str]) {
    let folder = Folder::new();
    folder.write(name, content);
    folder.run(&format!("wrap {name} -n 10 -o points.xyz --report report.json")).failed(&[name]).says(words);
    assert_eq!(folder.names(), [name]);
    folder.run(&format!("info {name}")).failed(&[name]).says(words);
}

#[test]
fn a_missing_file() {
    let folder = Folder::new();
    folder.run("wrap horse.ply -o p.xyz").failed(&["horse.ply", "No such file"]);
    folder.run("info horse.ply").failed(&["horse.ply", "No such file"]);
    folder.run("strips horse.ply -o s.svg").failed(&["horse.ply", "No such file"]);
}

#[test]
fn a_folder() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("meshes.obj")).expect("a folder");
    folder.run("wrap meshes.obj -o p.xyz").failed(&["meshes.obj", "is a folder"]);
}

#[test]
fn an_empty_file() {
    for name in ["a.obj", "a.ply", "a.stl", "a.gltf", "a.glb"] {
        rejected(name, "", &["empty"]);
    }
}

/// What has no length ends at the limit too.
#[cfg(target_os = "linux")]
#[test]
fn an_endless_file() {
    let folder = Folder::new();
    folder.run("info /dev/zero --max-memory 4M").failed(&["/dev/zero", "1048576 bytes", "--max-memory"]);
}

#[test]
fn text_in_utf_16() {
    let bytes: Vec<u8> = OCTAHEDRON.encode_utf16().flat_map(u16::to_le_bytes).collect();
    rejected("a.obj", [&b"\xff\xfe"[..], &bytes].concat(), &["UTF-16", "save it as UTF-8"]);
}

#[test]
fn an_unknown_format() {
    rejected("a.docx", "PK\x03\x04 a letter", &["known format", "PLY"]);
}

#[test]
fn another_format_than_it_is_said_to_be() {
    let folder = Folder::with_octahedron();
    for format in ["ply", "stl", "gltf", "off"] {
        folder.run(&format!("wrap octahedron.obj --mesh-format {format}")).failed(&["octahedron.obj"]);
    }
    folder.run("wrap octahedron.obj --mesh-format nonsense").refused(&["--mesh-format"]);
}

#[test]
fn the_content_counts_more_than_the_name() {
    let folder = Folder::new();
    folder.write("a.ply", OCTAHEDRON);
    folder.run("info a.ply").ok();
}

#[test]
fn a_buffer_outside_the_folder_is_not_read() {
    let gltf = |uri: &str| {
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 36, "uri": "{uri}"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0]}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}], "scene": 0}}"#
        )
    };
    let corners = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    let folder = Folder::new();
    std::fs::create_dir(folder.path("sub")).expect("a folder");
    folder.write("out.bin", &bytes);
    folder.write("sub/in.bin", &bytes);
    folder.write("good.gltf", gltf("sub/in.bin"));
    let good = folder.run("info good.gltf --json").ok().json();
    assert_eq!([&good["format"], &good["unit"], &good["up"]], ["gltf", "metre", "+Y"]);
    assert_eq!(good["faces"], 1);
    folder.write("missing.gltf", gltf("sub/none.bin"));
    folder.run("info missing.gltf").failed(&["missing.gltf", "sub/none.bin"]);
    folder.write("sub/bad.gltf", gltf("../out.bin"));
    folder.run("info sub/bad.gltf").failed(&["sub/bad.gltf", "../out.bin", "outside"]);
}

#[test]
fn not_text_at_all() {
    let noise: Vec<u8> = (0..2000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for name in ["a.obj", "a.ply", "a.stl", "a.gltf", "a.glb"] {
        rejected(name, &noise, &[]);
    }
}

#[test]
fn a_coordinate_that_is_no_number() {
    rejected("a.obj", OCTAHEDRON.replace("v 0 1 0", "v 0 nan 0"), &[]);
    rejected("a.obj", OCTAHEDRON.replace("v 0 1 0", "v 0 inf 0"), &[]);
    rejected("a.obj", OCTAHEDRON.replace("v 0 1 0", "v 0 one 0"), &[]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n";
    rejected("a.ply", ply, &[]);
}

#[test]
fn an_index_out_of_range() {
    rejected("a.obj", OCTAHEDRON.replace("f 1 4 6", "f 1 4 77"), &[]);
    rejected("a.obj", OCTAHEDRON.replace("f 1 4 6", "f 1 4 0"), &[]);
}

#[test]
fn no_face_and_no_area() {
    rejected("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", &["face"]);
    rejected("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", &["area"]);
}

#[test]
fn a_truncated_file() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let mut ply = header.as_bytes().to_vec();
    for x in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        ply.extend(x.to_le_bytes());
    }
    rejected("short.ply", &ply[..ply.len() - 5], &[]);
    rejected("no-face.ply", &ply, &[]);
    rejected("header.ply", &header.as_bytes()[..60], &[]);
    rejected("short.stl", [&[0u8; 80][..], &7u32.to_le_bytes(), &[0; 60]].concat(), &[]);
    rejected("short.glb", b"glTF\x02\0\0\0\xff\0\0\0", &[]);
}

#[test]
fn a_header_that_promises_too_much() {
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
        property float z\nelement face 4000000000\nproperty list uchar int vertex_indices\nend_header\n";
    rejected("huge.ply", ply, &[]);
    rejected("huge.stl", [&[0u8; 80][..], &u32::MAX.to_le_bytes(), &[0; 100]].concat(), &[]);
}

#[test]
fn quiet_still_tells_errors() {
    Folder::new().run("wrap horse.ply --quiet").failed(&["horse.ply"]);
}

#[test]
fn more_than_the_memory_allowed() {
    let folder = Folder::with_octahedron();
    let run = |arguments: &str| folder.run(&format!("wrap octahedron.obj {arguments} -o p.xyz"));
    run("-n 1000000 --max-memory 1G").failed(&["--max-memory", "fewer points", "--no-equalize"]);
    // Points that are written while they are made take less; those of other sequences are listed.
    run("-n 1000000 --no-equalize --max-memory 50M").failed(&["--max-memory", "fewer points"]);
    run("-n 1000000 --no-equalize --max-memory 100M").ok();
    for options in ["--sequence r2", "--format npz", "--format ply --attributes cell-area", "--strips s.svg"]
    {
        run(&format!("-n 1000000 --no-equalize --max-memory 100M {options}"))
            .failed(&["fewer points, raise"]);
    }
    run("-n 10 --max-memory 40").failed(&["octahedron.obj", "--max-memory"]);
    run("-n 10 --max-memory 600").failed(&["octahedron.obj", "more than 4 vertices"]);
    run("-n 10 --max-memory 1M").ok();
    run("-n 10 --max-memory 1Q").refused(&["--max-memory"]);
    run("-n 10 --max-memory 0").refused(&["--max-memory"]);
    // No machine has 31 TB.
    run("-n 4294967295").failed(&["4294967295 points", "without --max-memory", "raise --max-memory"]);
    run("--per-component 4294967295").failed(&["without --max-memory"]);
    run("--density 1e12").failed(&["without --max-memory"]);
}

/// Refused in words, not by an abort.
#[cfg(target_os = "linux")]
#[test]
fn more_than_the_shell_allows() {
    let folder = Folder::with_octahedron();
    let wrap = format!(
        "ulimit -v 3000000; exec '{}' wrap octahedron.obj --threads 1 -o p.xyz -n",
        env!("CARGO_BIN_EXE_ldwrap-cli")
    );
    let run = |count: &str| {
        let mut shell = std::process::Command::new("sh");
        let output = shell.args(["-c", &format!("{wrap} {count}")]).current_dir(folder.path("")).output();
        let output = output.expect("the shell runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, told) = run("300000000");
    assert!(code == Some(1) && told.contains("no more are taken than 2304: ask"), "{told}");
    assert_eq!(run("100").0, Some(0));
}
