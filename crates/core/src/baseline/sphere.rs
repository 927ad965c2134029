//! Lattices on the sphere: the paper's figure 4 a, b, and the best one known.

use std::f64::consts::PI;

use glam::DVec3;

use super::{NotASphere, purpose};
use crate::geometry::triangle;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::random::Random;
use crate::sample::SurfacePoint;
use crate::sequence::radical_inverse;
use crate::spatial::{Caster, nearest};

/// The unit vector at height `z` and `turn` (1 is once around) about the polar axis.
fn direction(z: f64, turn: f64) -> DVec3 {
    let rim = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(2.0 * PI * turn);
    DVec3::new(rim * cos, rim * sin, z)
}

/// The Hammersley set in spherical coordinates: height 2 t - 1 with t the radical inverse of i in base 2, angle
/// 2 pi (i + 1/2) / count. Unit vectors. Wong, Luk and Heng, "Sampling with Hammersley and Halton points", Journal
/// of Graphics Tools 2(2), 1997, DOI 10.1080/10867651.1997.10487471: what the paper compares with in figure 4.
pub fn hammersley_directions(count: usize) -> Vec<DVec3> {
    (0..count)
        .map(|i| direction(2.0 * radical_inverse(i as u64, 2) - 1.0, (i as f64 + 0.5) / count as f64))
        .collect()
}

/// The spherical Fibonacci lattice: heights 1 - (2 i + 1) / count, each a golden section of a turn after the last.
/// Unit vectors. Swinbank and Purser, 2006, DOI 10.1256/qj.05.227.
pub fn spherical_fibonacci(count: usize) -> Vec<DVec3> {
    let golden = 0.5 * (5.0f64.sqrt() - 1.0);
    (0..count)
        .map(|i| {
            let turn = i as f64 * golden;
            direction(1.0 - (2 * i + 1) as f64 / count as f64, turn - turn.floor())
        })
        .collect()
}

/// The directions turned about the polar axis by an angle that `seed` gives; 0 turns them not at all.
pub(super) fn turned(mut directions: Vec<DVec3>, seed: u64) -> Vec<DVec3> {
    if seed != 0 {
        let (sin, cos) = libm::sincos(2.0 * PI * Random::new(seed, purpose::SPHERE).unit());
        for d in &mut directions {
            *d = DVec3::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y, d.z);
        }
    }
    directions
}

/// A sphere that a mesh stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its middle: that of the box around the mesh.
    pub middle: DVec3,
    /// The largest distance of a vertex from it, in units of the mesh.
    pub radius: f64,
}

impl Sphere {
    /// The sphere that the vertices of the mesh lie on, to a hundredth of the radius, and the faces between them to a
    /// tenth: the corners of a cube alone make no sphere.
    ///
    /// # Errors
    /// [`NotASphere`] when they do not.
    pub fn of(mesh: &SurfaceMesh) -> Result<Self, NotASphere> {
        let (low, high) = mesh.bounds();
        let middle = low * 0.5 + high * 0.5;
        let (mut nearest, mut nearest_vertex, mut farthest) = (f64::INFINITY, f64::INFINITY, 0.0f64);
        for face in mesh.topology().face_ids() {
            let [a, b, c] = mesh.triangle(face);
            for vertex in [a, b, c] {
                let distance = vertex.distance(middle);
                nearest_vertex = nearest_vertex.min(distance);
                farthest = farthest.max(distance);
            }
            let foot = triangle::at(a, b, c, triangle::nearest(a, b, c, middle));
            nearest = nearest.min(foot.distance(middle));
        }
        if nearest_vertex >= 0.99 * farthest && nearest >= 0.9 * farthest && farthest > 0.0 {
            Ok(Self { middle, radius: farthest })
        } else {
            Err(NotASphere { nearest, farthest })
        }
    }

    /// Projects unit vectors radially onto the faces of the mesh; one that meets no face (a hole) goes to the
    /// nearest point of the surface. Areas keep their shares as well as the mesh is round.
    pub fn wrap(&self, mesh: &SurfaceMesh, directions: &[DVec3]) -> Vec<SurfacePoint> {
        let caster = Caster::new(mesh);
        let met = parallel::map(directions.len(), |i| caster.first_hit(self.middle, directions[i]));
        let missed: Vec<DVec3> = met
            .iter()
            .zip(directions)
            .filter(|(hit, _)| hit.is_none())
            .map(|(_, &d)| self.middle + d * self.radius)
            .collect();
        let mut beside = nearest(mesh, &missed).into_iter();
        met.into_iter()
            .filter_map(|hit| hit.map(|h| h.point).or_else(|| beside.next().map(|p| p.point)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fibonacci_by_hand() {
        let two = spherical_fibonacci(2);
        assert_eq!([two[0].z, two[1].z], [0.5, -0.5]);
        assert!((two[0].x - 0.75f64.sqrt()).abs() < 1e-15 && two[0].y == 0.0);
        let many = spherical_fibonacci(1000);
        assert!(many.iter().all(|d| (d.length() - 1.0).abs() < 1e-15));
        assert!(many.iter().sum::<DVec3>().length() / 1000.0 < 1e-3);
    }

    #[test]
    fn hammersley_by_hand() {
        let four = hammersley_directions(4);
        let heights: Vec<f64> = four.iter().map(|d| d.z).collect();
        assert_eq!(heights, [-1.0, 0.0, -0.5, 0.5]);
        // Point 1: angle 2 pi 1.5 / 4 = 135 degrees.
        assert!((four[1].x + 0.5f64.sqrt()).abs() < 1e-15 && (four[1].y - 0.5f64.sqrt()).abs() < 1e-15);
    }
}
