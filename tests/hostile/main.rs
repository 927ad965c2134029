//! Hostile and broken input: the inputs that fuzzing kept, and a table of everything that files do wrong.

#[allow(unreachable_pub)]
#[path = "../checks.rs"]
mod checks;
// The fuzz targets call them from another crate.
#[allow(unreachable_pub)]
#[path = "../../crates/core/fuzz/src/readers.rs"]
mod readers;
#[allow(unreachable_pub)]
#[path = "../../crates/core/fuzz/src/soups.rs"]
mod soups;

mod files;
mod meshes;
mod samples;
mod table;

use std::fs;
use std::path::{Path, PathBuf};

use arbitrary::{Arbitrary, Unstructured};
use ldwrap::io::MeshFormat;

/// The committed inputs of a fuzz target, by name.
fn corpus(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/core/fuzz/corpus").join(target);
    let mut inputs: Vec<_> = fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("an entry").path())
        .map(|path| (path.clone(), fs::read(path).expect("readable")))
        .collect();
    inputs.sort();
    assert!(!inputs.is_empty(), "{target} has a corpus");
    inputs
}

fn replay(target: &str, run: impl Fn(&[u8])) {
    for (path, bytes) in corpus(target) {
        eprintln!("{}", path.display());
        run(&bytes);
    }
}

#[test]
fn corpus_of_the_mesh_readers() {
    for (target, format) in [
        ("ply", MeshFormat::Ply),
        ("obj", MeshFormat::Obj),
        ("stl", MeshFormat::Stl),
        ("off", MeshFormat::Off),
        ("gltf", MeshFormat::Gltf),
    ] {
        replay(target, |bytes| readers::mesh(format, bytes));
    }
    replay("any", readers::any);
}

#[test]
fn corpus_of_the_point_readers() {
    replay("points", readers::points);
}

#[test]
fn corpus_of_the_pipeline() {
    replay("soup", |bytes| {
        let case = soups::Case::arbitrary_take_rest(Unstructured::new(bytes)).expect("any bytes are a case");
        soups::pipeline(&case);
    });
}
