//! What figures are compared with, and useful in themselves: independent random points, points in Hilbert order,
//! Poisson disk, and lattices on the sphere; on the unit square a lattice and random points. They import no stage.
//!
//! Every baseline gives exactly as many points as asked for, and the same bits for the same mesh, count and seed.

mod area;
mod hilbert;
mod poisson;
mod random;
mod sphere;
mod square;

use thiserror::Error;

use crate::mesh::SurfaceMesh;
use crate::sample::SurfacePoint;

pub(crate) use hilbert::HilbertOrder;
pub use hilbert::hilbert;
pub use poisson::poisson;
pub use random::random;
pub use sphere::{Sphere, hammersley_directions, spherical_fibonacci};
pub use square::{square_lattice, square_random};

/// A way to place points that needs no segmentation and no unfolding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Baseline {
    /// [`random`]: independent and uniform.
    Random,
    /// [`hilbert`]: triangles along a Hilbert curve, the area function inverted at equal steps.
    Hilbert,
    /// [`poisson`]: weighted sample elimination.
    Poisson,
    /// [`hammersley_directions`] on a mesh of a sphere: the paper's figure 4 a, b.
    SphereHammersley,
    /// [`spherical_fibonacci`] on a mesh of a sphere.
    SphereFibonacci,
}

/// A lattice on the sphere was asked for on a mesh that is not a sphere.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the mesh is not a sphere: its surface lies between {nearest} and {farthest} from its middle")]
pub struct NotASphere {
    /// The smallest distance of the surface from the middle of the box around the mesh, in its units.
    pub nearest: f64,
    /// The largest.
    pub farthest: f64,
}

impl Baseline {
    /// All of them, in a fixed order.
    pub const ALL: [Self; 5] =
        [Self::Random, Self::Hilbert, Self::Poisson, Self::SphereHammersley, Self::SphereFibonacci];

    /// Its name in lower case, words joined by hyphens.
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Hilbert => "hilbert",
            Self::Poisson => "poisson",
            Self::SphereHammersley => "sphere-hammersley",
            Self::SphereFibonacci => "sphere-fibonacci",
        }
    }

    /// Places `count` points. The lattices on the sphere turn with `seed` about the polar axis; seed 0 does not
    /// turn them.
    ///
    /// # Errors
    /// [`NotASphere`] when a lattice on the sphere is asked for and the mesh is no sphere.
    pub fn place(self, mesh: &SurfaceMesh, count: usize, seed: u64) -> Result<Vec<SurfacePoint>, NotASphere> {
        Ok(match self {
            Self::Random => random(mesh, count, seed),
            Self::Hilbert => hilbert(mesh, count, seed),
            Self::Poisson => poisson(mesh, count, seed),
            Self::SphereHammersley => {
                Sphere::of(mesh)?.wrap(mesh, &sphere::turned(hammersley_directions(count), seed))
            }
            Self::SphereFibonacci => {
                Sphere::of(mesh)?.wrap(mesh, &sphere::turned(spherical_fibonacci(count), seed))
            }
        })
    }
}

/// The purposes that keep the baselines' random streams apart.
mod purpose {
    pub(super) const RANDOM: u64 = 0x62_61_73_01;
    pub(super) const HILBERT: u64 = 0x62_61_73_02;
    pub(super) const POISSON: u64 = 0x62_61_73_03;
    pub(super) const SPHERE: u64 = 0x62_61_73_04;
    pub(super) const SQUARE: u64 = 0x62_61_73_05;
}

#[cfg(test)]
mod tests;
