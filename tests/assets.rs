//! The files in `assets/` are what the generators make, byte for byte.

use std::path::Path;

#[allow(dead_code)]
#[path = "../crates/core/examples/assets.rs"]
mod generator;

#[test]
fn assets_are_up_to_date() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets");
    let files = generator::files().expect("the shapes are surfaces");
    for (name, bytes) in &files {
        let on_disk =
            std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("assets/{name}: {error}"));
        assert!(on_disk == *bytes, "assets/{name} is out of date: cargo run -p ldwrap --example assets");
    }
    let meshes = std::fs::read_dir(&folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| ["obj", "ply", "off", "stl"].iter().any(|x| e == *x)))
        .count();
    assert_eq!(meshes, files.len() - 1, "a mesh in assets/ that nothing makes");
}
