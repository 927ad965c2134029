//! Where a mesh comes from: a built-in shape, or the bytes of a person's file.

use ldwrap::io::{Limits, ReadError, ReadOptions, read_model_with};
use ldwrap::shapes::Shape;
use ldwrap::{CheckOptions, PolygonSoup, RepairReport, SurfaceMesh};
use serde::{Deserialize, Serialize};

/// The most that a file may take: in a page half of the 4 GiB that its memory can have, for a page that runs out of
/// memory is gone without a word.
fn limits() -> Limits {
    if cfg!(target_arch = "wasm32") { Limits::for_memory(2 << 30) } else { Limits::default() }
}

/// A mesh to load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Source {
    /// A built-in shape.
    #[serde(with = "by_name")]
    Shape(Shape),
    /// A file: its name says the format.
    File {
        /// Its name, with the extension.
        name: String,
        /// Its bytes.
        bytes: Vec<u8>,
        /// The files that it names.
        beside: Beside,
    },
}

/// The files that a mesh file names: the buffers of a `.gltf`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Beside {
    /// Nobody can look: in a browser a page gets only the file that a person gives it.
    OutOfReach,
    /// What was found, by address: the bytes, or why they cannot be had.
    Found(Vec<(String, Result<Vec<u8>, String>)>),
}

impl Source {
    /// A file by its name and bytes alone.
    pub fn alone(name: String, bytes: Vec<u8>) -> Self {
        Self::File { name, bytes, beside: Beside::OutOfReach }
    }

    /// A file of this machine, with the files that it names.
    ///
    /// # Errors
    /// When it cannot be read.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open(path: &std::path::Path) -> Result<Self, String> {
        let bytes = std::fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let folder = path.parent().unwrap_or(std::path::Path::new(""));
        let found = std::cell::RefCell::new(Vec::new());
        if name.to_lowercase().ends_with(".gltf") {
            // Only the reader knows what a document needs. What is wrong with it is told when it is loaded.
            let options = ReadOptions { name: Some(&name), limits: limits(), ..ReadOptions::default() };
            let _ = read_model_with(&bytes, &options, &|address| {
                let read = read_beside(folder, address);
                found.borrow_mut().push((address.to_owned(), read.clone()));
                read
            });
        }
        Ok(Self::File { name, bytes, beside: Beside::Found(found.into_inner()) })
    }

    /// What a person calls it.
    pub fn name(&self) -> &str {
        match self {
            Self::Shape(shape) => shape.name(),
            Self::File { name, .. } => name,
        }
    }

    /// Reads and checks it.
    ///
    /// # Errors
    /// What is wrong with it, for a person.
    pub fn load(&self) -> Result<(SurfaceMesh, RepairReport), String> {
        let soup = match self {
            Self::Shape(shape) => shape.generate(),
            Self::File { name, bytes, beside } => read(name, bytes, beside)?,
        };
        SurfaceMesh::from_soup(&soup, &CheckOptions::default()).map_err(|e| format!("{}: {e}", self.name()))
    }
}

/// A file that a mesh names: only one in the mesh's own folder or below it, whatever the mesh says.
#[cfg(not(target_arch = "wasm32"))]
fn read_beside(folder: &std::path::Path, address: &str) -> Result<Vec<u8>, String> {
    use std::path::{Component, Path};
    let inside =
        Path::new(address).components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    if !inside {
        return Err("it lies outside the mesh's folder".to_owned());
    }
    std::fs::read(folder.join(address)).map_err(|error| format!("it cannot be read ({error})"))
}

/// Reads the bytes of a mesh file; the name's extension says the format.
fn read(name: &str, bytes: &[u8], beside: &Beside) -> Result<PolygonSoup, String> {
    let resolver = |address: &str| match beside {
        Beside::OutOfReach => Err(String::new()),
        Beside::Found(files) => match files.iter().find(|(named, _)| named == address) {
            Some((_, read)) => read.clone(),
            None => Err("it was not found".to_owned()),
        },
    };
    let options = ReadOptions { name: Some(name), limits: limits(), ..ReadOptions::default() };
    let model = read_model_with(bytes, &options, &resolver).map_err(|error| match error {
        ReadError::Missing { uri, .. } if *beside == Beside::OutOfReach => format!(
            "{name}: it needs {uri:?} too, but only one file can be opened here: save the mesh as GLB, one file with \
             everything in it"
        ),
        other => format!("{name}: {other}"),
    })?;
    Ok(model.soup)
}

/// Shapes are sent by their names.
mod by_name {
    use ldwrap::shapes::Shape;
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::ser::Serializer;

    pub(super) fn serialize<S: Serializer>(shape: &Shape, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(shape.name())
    }

    pub(super) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Shape, D::Error> {
        String::deserialize(from)?.parse().map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A document with one triangle, whose corners are in a file beside it.
    fn document(address: &str) -> String {
        serde_json::json!({
            "asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri": address}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                "min": [0, 0, 0], "max": [1, 1, 0]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0
        })
        .to_string()
    }

    fn corners() -> Vec<u8> {
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect()
    }

    #[test]
    fn buffers_beside_a_file_are_read_and_go_with_it() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("sub")).unwrap();
        std::fs::write(folder.path().join("sub/the corners.bin"), corners()).unwrap();
        std::fs::write(folder.path().join("out.bin"), corners()).unwrap();
        let path = folder.path().join("mesh.gltf");
        std::fs::write(&path, document("sub/the%20corners.bin")).unwrap();
        let source = Source::open(&path).unwrap();
        let missing = folder.path().join("missing.gltf");
        std::fs::write(&missing, document("none.bin")).unwrap();
        let told = Source::open(&missing).unwrap().load().unwrap_err();
        assert!(told.contains("missing.gltf") && told.contains("none.bin"), "{told}");
        let outside = folder.path().join("sub/outside.gltf");
        std::fs::write(&outside, document("../out.bin")).unwrap();
        let told = Source::open(&outside).unwrap().load().unwrap_err();
        assert!(told.contains("outside the mesh's folder"), "{told}");
        // The engines load it from what was read then, whatever happens to the folder.
        drop(folder);
        let (mesh, _) = source.load().unwrap();
        assert_eq!((mesh.face_count(), mesh.area()), (1, 0.5));
    }

    #[test]
    fn where_nobody_can_look_beside_a_file_it_says_to_use_one_that_holds_everything() {
        let told = Source::alone("mesh.gltf".into(), document("a.bin").into_bytes()).load().unwrap_err();
        assert!(told.contains("a.bin") && told.contains("GLB"), "{told}");
    }
}
