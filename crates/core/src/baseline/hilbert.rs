//! Points in Hilbert order: a low-discrepancy set on any mesh without unfolding it, the rival to beat.

use glam::DVec3;

use super::area::{AreaRow, square_to_triangle};
use super::purpose;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::random::Random;
use crate::sample::SurfacePoint;
use crate::sequence::radical_inverse;

/// Bits a coordinate of a face's middle is rounded to: three of them fill 63 bits of a key.
const BITS: u32 = 21;

/// `count` points: the faces are put in the order in which a Hilbert curve through space meets their middles, and
/// point i lies where the running sum of their areas reaches (i + 1/2) / count of the total. What is left of the
/// sum inside that face gives one of its coordinates, the van der Corput sequence, shifted by `seed` modulo 1, the
/// other. Seed 0 does not shift. None on a mesh without faces.
///
/// After He and Owen, "Extensible grids: uniform sampling on a space filling curve", DOI 10.1111/rssb.12132.
/// O(faces log faces + count log faces).
pub fn hilbert(mesh: &SurfaceMesh, count: usize, seed: u64) -> Vec<SurfacePoint> {
    let shift = if seed == 0 { 0.0 } else { Random::new(seed, purpose::HILBERT).unit() };
    HilbertOrder::new(mesh).points(count, 0.5, shift)
}

/// The faces in Hilbert order, kept for placing several sets.
#[derive(Clone, Debug)]
pub(crate) struct HilbertOrder(AreaRow);

impl HilbertOrder {
    /// Puts the faces in order.
    pub(crate) fn new(mesh: &SurfaceMesh) -> Self {
        Self::by_mass(mesh, mesh.face_areas())
    }

    /// The same for points by mass instead of area.
    pub(crate) fn by_mass(mesh: &SurfaceMesh, masses: &[f64]) -> Self {
        let (low, high) = mesh.bounds();
        let extent = (high - low).max_element();
        let scale = if extent > 0.0 { ((1u64 << BITS) - 1) as f64 / extent } else { 0.0 };
        let mut keyed = parallel::map(mesh.face_count(), |f| {
            let face = FaceId::new(f);
            let [a, b, c] = mesh.triangle(face);
            // Thirds first: the sum of three large coordinates may overflow.
            let middle = a / 3.0 + b / 3.0 + c / 3.0;
            (key((middle - low) * scale), face)
        });
        keyed.sort_unstable();
        Self(AreaRow::by_mass(masses, keyed.into_iter().map(|(_, face)| face).collect()))
    }

    /// `count` points at the shares (i + `along`) / count of the area, the other coordinate shifted by `across`;
    /// both in [0, 1). When both are uniform and independent, so is each point (systematic sampling).
    pub(crate) fn points(&self, count: usize, along: f64, across: f64) -> Vec<SurfacePoint> {
        (0..count)
            .filter_map(|i| {
                let (face, u) = self.0.at((i as f64 + along) / count as f64)?;
                let v = radical_inverse(i as u64, 2) + across;
                let v = if v >= 1.0 { v - 1.0 } else { v };
                Some(SurfacePoint { face, barycentric: square_to_triangle(u, v) })
            })
            .collect()
    }
}

/// The place along the Hilbert curve of the cell that holds `p`, whose coordinates lie in [0, 2^BITS).
/// Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707 (2004), DOI 10.1063/1.1751381.
fn key(p: DVec3) -> u64 {
    // A cast of a float saturates, so a rounding error at the rim cannot leave the cube.
    let mut x = [p.x as u32, p.y as u32, p.z as u32].map(|c| c.min((1 << BITS) - 1));
    let mut bit = 1u32 << (BITS - 1);
    while bit > 1 {
        let mask = bit - 1;
        for i in 0..3 {
            if x[i] & bit != 0 {
                x[0] ^= mask;
            } else {
                let swap = (x[0] ^ x[i]) & mask;
                x[0] ^= swap;
                x[i] ^= swap;
            }
        }
        bit >>= 1;
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    let mut fold = 0;
    let mut bit = 1u32 << (BITS - 1);
    while bit > 1 {
        if x[2] & bit != 0 {
            fold ^= bit - 1;
        }
        bit >>= 1;
    }
    for c in &mut x {
        *c ^= fold;
    }
    let mut key = 0u64;
    for bit in (0..BITS).rev() {
        for c in x {
            key = key << 1 | u64::from(c >> bit & 1);
        }
    }
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_space() {
        // The 512 cells of the coarsest 8 x 8 x 8 grid, in the order of their keys, touch each in turn.
        let step = 1u32 << (BITS - 3);
        let mut cells: Vec<(u64, [i32; 3])> = Vec::new();
        for x in 0..8u32 {
            for y in 0..8u32 {
                for z in 0..8u32 {
                    let at = |c: u32| f64::from(c * step + step / 2);
                    cells.push((key(DVec3::new(at(x), at(y), at(z))), [x as i32, y as i32, z as i32]));
                }
            }
        }
        cells.sort_unstable();
        for pair in cells.windows(2) {
            let steps: i32 = (0..3).map(|i| (pair[0].1[i] - pair[1].1[i]).abs()).sum();
            assert_eq!(steps, 1, "{pair:?}");
        }
        assert_eq!(cells[0].1, [0, 0, 0]);
    }
}
