//! Where a mesh comes from: a built-in shape, or the bytes of a person's file.

use ldwrap::{CheckOptions, PolygonSoup, RepairReport, SurfaceMesh};
use serde::{Deserialize, Serialize};

/// A shape that needs no file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shape {
    /// The paper's sphere: 760 triangles.
    #[default]
    Sphere,
}

impl Shape {
    /// All, in the order in which they are offered.
    pub const ALL: [Self; 1] = [Self::Sphere];

    /// What it is called in links and lists.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
        }
    }

    /// The shape with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }

    fn soup(self) -> PolygonSoup {
        match self {
            Self::Sphere => interim(),
        }
    }
}

/// A mesh to load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Source {
    /// A built-in shape.
    Shape(Shape),
    /// A file: its name says the format.
    File {
        /// Its name, with the extension.
        name: String,
        /// Its bytes.
        bytes: Vec<u8>,
    },
}

impl Source {
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
            Self::Shape(shape) => shape.soup(),
            Self::File { name, bytes } => read(name, bytes)?,
        };
        SurfaceMesh::from_soup(&soup, &CheckOptions::default()).map_err(|e| format!("{}: {e}", self.name()))
    }
}

/// Reads the bytes of a mesh file; the name's extension says the format.
///
/// # Errors
/// What is wrong, for a person.
pub fn read(name: &str, bytes: &[u8]) -> Result<PolygonSoup, String> {
    let _ = bytes;
    Err(format!("{name}: no reader yet"))
}

fn interim() -> PolygonSoup {
    let mut soup = PolygonSoup::default();
    let n = 20u32;
    soup.positions.push(glam::DVec3::Y);
    for i in 1..n {
        for j in 0..n {
            let (s, c) = (std::f64::consts::PI * f64::from(i) / f64::from(n)).sin_cos();
            let (t, u) = (std::f64::consts::TAU * f64::from(j) / f64::from(n)).sin_cos();
            soup.positions.push(glam::DVec3::new(s * u, c, -s * t));
        }
    }
    soup.positions.push(glam::DVec3::NEG_Y);
    let last = soup.positions.len() as u32 - 1;
    for j in 0..n {
        let k = (j + 1) % n;
        soup.push_polygon(&[0, 1 + j, 1 + k]);
        for i in 0..n - 2 {
            let (a, b) = (1 + i * n, 1 + (i + 1) * n);
            soup.push_polygon(&[a + j, b + j, b + k]);
            soup.push_polygon(&[a + j, b + k, a + k]);
        }
        soup.push_polygon(&[last, 1 + (n - 2) * n + k, 1 + (n - 2) * n + j]);
    }
    soup
}
