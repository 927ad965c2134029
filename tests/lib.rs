//! What the tests of the whole project share: the meshes they run on, and the invariants of every stage's value.
//! Each file beside this one is one kind of test.

#[cfg(test)]
mod assets;
mod checks;

use std::path::PathBuf;

use ldwrap::domain::PlanarDomain;
use ldwrap::io::read_mesh;
use ldwrap::segment::{SegmentOptions, Segmentation, segment};
use ldwrap::shapes::Shape;
use ldwrap::unfold::{Strips, unfold};
use ldwrap::{CheckOptions, PolygonSoup, SurfaceMesh};

pub use checks::{check_samples, check_segmentation, check_strips};

/// A mesh and what it is called.
pub struct Named {
    /// The shape's name, or the file's.
    pub name: String,
    /// The mesh.
    pub mesh: SurfaceMesh,
}

/// The checked mesh of a soup.
///
/// # Panics
/// If it is not a surface.
pub fn mesh(soup: &PolygonSoup) -> SurfaceMesh {
    SurfaceMesh::from_soup(soup, &CheckOptions::default()).expect("the soup is a surface").0
}

/// All shapes, each with about `faces` triangles.
pub fn shapes_about(faces: u32) -> Vec<Named> {
    let named = |shape: Shape| Named { name: shape.name().into(), mesh: mesh(&shape.generate_about(faces)) };
    Shape::ALL.into_iter().map(named).collect()
}

/// A mesh of the folder that `LDWRAP_MESHES` names; `None`, said on stderr, where it names none.
///
/// # Panics
/// If the folder has no such mesh.
pub fn real_mesh(name: &str) -> Option<Named> {
    let Some(folder) = std::env::var_os("LDWRAP_MESHES") else {
        eprintln!("skipped: LDWRAP_MESHES does not name the folder of {name}");
        return None;
    };
    let bytes = std::fs::read(PathBuf::from(folder).join(name)).expect("the mesh is there");
    let soup = read_mesh(&bytes, None, &|uri| Err(format!("{uri} is not looked for"))).expect("it is a mesh");
    Some(Named { name: name.into(), mesh: mesh(&soup) })
}

/// All meshes of the folder that `LDWRAP_MESHES` names, by name; none, said on stderr, where it names none.
///
/// # Panics
/// If the folder cannot be read.
pub fn real_meshes() -> Vec<Named> {
    let Some(folder) = std::env::var_os("LDWRAP_MESHES") else {
        eprintln!("skipped: LDWRAP_MESHES names no folder of meshes");
        return Vec::new();
    };
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .expect("LDWRAP_MESHES names a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .filter(|name| !name.ends_with(".md"))
        .collect();
    names.sort();
    names.iter().filter_map(|name| real_mesh(name)).collect()
}

/// The values of the stages before any point.
pub struct Unfolded {
    /// The segments.
    pub segmentation: Segmentation,
    /// Their strips.
    pub strips: Strips,
    /// Where those lie.
    pub domain: PlanarDomain,
}

/// Segments and unfolds a mesh.
pub fn unfolded(mesh: &SurfaceMesh, options: &SegmentOptions) -> Unfolded {
    let segmentation = segment(mesh, options);
    let strips = unfold(mesh, &segmentation);
    let domain = PlanarDomain::lay_out(&strips);
    Unfolded { segmentation, strips, domain }
}
