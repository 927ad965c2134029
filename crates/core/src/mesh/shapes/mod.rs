//! Shapes with known counts and areas, for tests, demos and the assets. All are triangles, wound outward, with the same
//! bits on every platform. Parameters that are too small are raised to the smallest that give a surface.

mod blocks;
mod cup;
mod drink;
mod grid;
mod round;
mod scan;
mod tube;
mod unstructured;

use std::str::FromStr;

pub use blocks::{block, cube, plate, square, tetrahedron};
pub use cup::cup;
pub use drink::drink_like;
pub use round::{capsule, torus, uv_sphere};
pub use scan::scan_like;
pub use tube::trefoil;

use crate::mesh::soup::PolygonSoup;

/// The shapes by name, each with the parameters of the paper or ones that show well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Shape {
    /// The paper's sphere (figure 4): [`uv_sphere`].
    Sphere,
    /// The paper's cup (figure 5): [`cup`].
    Cup,
    /// A drink can as a laser scanner sees it, with the counts of the paper's "Fruit Drink" (figure 6): [`drink_like`].
    Drink,
    /// A bumpy body as a laser scanner sees it: [`scan_like`].
    Scan,
    /// A torus: [`torus`].
    Torus,
    /// A knotted tube: [`trefoil`].
    Trefoil,
    /// A cube: [`cube`].
    Cube,
    /// A thin plate with two sides: [`plate`].
    Plate,
    /// A cylinder between two half spheres: [`capsule`].
    Capsule,
    /// A flat square with a border: [`square`].
    Square,
    /// A regular tetrahedron: [`tetrahedron`].
    Tetrahedron,
}

/// A name that is not a shape's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no shape is called {0:?}: the shapes are {names}", names = Shape::ALL.map(Shape::name).join(", "))]
pub struct UnknownShape(pub String);

impl Shape {
    /// All shapes.
    pub const ALL: [Self; 11] = [
        Self::Sphere,
        Self::Cup,
        Self::Drink,
        Self::Scan,
        Self::Torus,
        Self::Trefoil,
        Self::Cube,
        Self::Plate,
        Self::Capsule,
        Self::Square,
        Self::Tetrahedron,
    ];

    /// The most triangles that [`generate_about`](Self::generate_about) makes.
    pub const MOST_FACES: u32 = 100_000_000;

    /// The name, as [`FromStr`] takes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Cup => "cup",
            Self::Drink => "drink",
            Self::Scan => "scan",
            Self::Torus => "torus",
            Self::Trefoil => "trefoil",
            Self::Cube => "cube",
            Self::Plate => "plate",
            Self::Capsule => "capsule",
            Self::Square => "square",
            Self::Tetrahedron => "tetrahedron",
        }
    }

    /// The shape with its own number of triangles.
    pub fn generate(self) -> PolygonSoup {
        self.generate_about(match self {
            Self::Sphere => 760,
            Self::Cup => 13_952,
            Self::Drink => 24_994,
            Self::Scan => 20_000,
            Self::Torus => 5_120,
            Self::Trefoil => 98_000,
            Self::Cube => 1_200,
            Self::Plate => 1_840,
            Self::Capsule => 1_600,
            Self::Square => 800,
            Self::Tetrahedron => 4,
        })
    }

    /// The shape with about this many triangles, as near as its grid allows, at most
    /// [`MOST_FACES`](Self::MOST_FACES). Drink and tetrahedron always have their own number; sphere, square, cube,
    /// cup, torus and trefoil keep the proportions of their grids.
    pub fn generate_about(self, faces: u32) -> PolygonSoup {
        let faces = faces.min(Self::MOST_FACES);
        let side = |per_square: f64| ((f64::from(faces) / per_square).sqrt().round() as u32).max(1);
        match self {
            // 2 n (n - 1) triangles.
            Self::Sphere => {
                let n = (0.5 + (0.25 + 0.5 * f64::from(faces)).sqrt()).round() as u32;
                uv_sphere(n, n)
            }
            Self::Cup => cup(side(13_952.0)),
            Self::Drink => drink_like(1),
            Self::Scan => scan_like(1, faces),
            Self::Torus => {
                let n = side(5.0);
                torus(n * 5 / 2, n, 0.4)
            }
            Self::Trefoil => {
                let n = side(20.0);
                trefoil(10 * n, n, 0.5)
            }
            Self::Cube => cube(side(12.0)),
            Self::Plate => plate(side(4.0).saturating_sub(1), 0.01),
            Self::Capsule => {
                // 2 s (3 s / 4 - 1) triangles with a quarter as many rings as segments.
                let segments = side(1.5);
                capsule(segments, segments.div_ceil(4), 2.0)
            }
            Self::Square => square(side(2.0)),
            Self::Tetrahedron => tetrahedron(),
        }
    }
}

impl FromStr for Shape {
    type Err = UnknownShape;

    fn from_str(name: &str) -> Result<Self, UnknownShape> {
        Self::ALL.into_iter().find(|s| s.name() == name).ok_or_else(|| UnknownShape(name.to_owned()))
    }
}

#[cfg(test)]
mod tests;
