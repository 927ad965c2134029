//! Independent uniform points: what every measure counts as 1.

use super::area::{AreaRow, square_to_triangle};
use super::purpose;
use crate::mesh::SurfaceMesh;
use crate::random::Random;
use crate::sample::SurfacePoint;

/// `count` independent points, uniform by area. None on a mesh without faces. O(faces + count log faces).
pub fn random(mesh: &SurfaceMesh, count: usize, seed: u64) -> Vec<SurfacePoint> {
    draw(mesh, count, &mut Random::new(seed, purpose::RANDOM))
}

/// `count` independent points from this stream.
pub(super) fn draw(mesh: &SurfaceMesh, count: usize, random: &mut Random) -> Vec<SurfacePoint> {
    let row = AreaRow::new(mesh, mesh.topology().face_ids().collect());
    (0..count)
        .filter_map(|_| {
            let (face, _) = row.at(random.unit())?;
            Some(SurfacePoint { face, barycentric: square_to_triangle(random.unit(), random.unit()) })
        })
        .collect()
}
