//! Spacing: how far the points keep from each other, and how much of the surface they leave uncovered.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use crate::ids::FaceId;
use crate::measure::halving::halve;
use crate::measure::tree::Tree;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::sample::SurfacePoint;

/// Points or triangles that one step of the work takes.
const STEP: usize = 256;

/// The tightest tolerance of the covering radius; below it rounding would decide.
const TIGHTEST: f64 = 1e-9;

/// How closely the covering radius is found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SpacingOptions {
    /// The covering radius may be too small by this part of itself. Default: 0.005.
    pub tolerance: f64,
}

impl Default for SpacingOptions {
    fn default() -> Self {
        Self { tolerance: 0.005 }
    }
}

/// Distances in space over `ideal`, the distance of neighbours in the hexagonal lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpacingReport {
    /// The smallest distance of two points; 1 in the hexagonal lattice, NaN for a single point.
    pub min: f64,
    /// The mean distance from a point to its nearest neighbour; NaN for a single point.
    pub mean: f64,
    /// The standard deviation of that distance over its mean; NaN for a single point.
    pub variation: f64,
    /// The covering radius: the largest distance from a place of the surface to its nearest point; 0.577 in the
    /// hexagonal lattice. The true value is at most `cover (1 + tolerance)` and not less than `cover`.
    pub cover: f64,
    /// sqrt(2 A / (sqrt(3) n)), in units of the mesh.
    pub ideal: f64,
}

/// Measures nearest neighbours and the covering radius. Distances are straight lines through space: on a thin
/// sheet the nearest point may lie on the other side.
///
/// The covering radius is found by branch and bound: a triangle is halved as long as the farthest of its corners
/// from the point nearest to its middle would allow more than what was found. O((n + T) log n), and O(n log n)
/// pieces near the farthest places. Progress: `spacing`, one step each 256 points or triangles.
pub fn spacing(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    options: &SpacingOptions,
    progress: &dyn Progress,
) -> SpacingReport {
    let steps = points.len().div_ceil(STEP) + mesh.face_count().div_ceil(STEP);
    progress.begin("spacing", steps as u64);
    let positions: Vec<DVec3> = points.iter().map(|p| mesh.locate(p)).collect();
    let n = points.len() as f64;
    let ideal = (2.0 * mesh.area() / (3.0f64.sqrt() * n)).sqrt();
    let cloud = Cloud { tree: Tree::of_points(&positions), positions: &positions };
    let neighbours: Vec<f64> = parallel::map_chunks(points.len(), STEP, |range| {
        if progress.is_cancelled() {
            return Vec::new();
        }
        let distances: Vec<f64> = range.filter_map(|i| cloud.nearest_other(i)).collect();
        progress.advance(1);
        distances
    })
    .concat();
    let (mut min, mut mean, mut variation) = (f64::NAN, f64::NAN, f64::NAN);
    if !neighbours.is_empty() {
        let count = neighbours.len() as f64;
        min = neighbours.iter().copied().fold(f64::INFINITY, f64::min);
        mean = neighbours.iter().sum::<f64>() / count;
        let squared = neighbours.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / count;
        variation = squared.sqrt() / mean;
    }
    let cover = if points.is_empty() || progress.is_cancelled() {
        f64::NAN
    } else {
        cover(mesh, &cloud, options.tolerance.max(TIGHTEST), progress)
    };
    SpacingReport { min: min / ideal, mean: mean / ideal, variation, cover: cover / ideal, ideal }
}

/// The points, and the tree that finds the nearest.
struct Cloud<'a> {
    tree: Tree,
    positions: &'a [DVec3],
}

impl Cloud<'_> {
    /// The distance from point `i` to the nearest other.
    fn nearest_other(&self, i: usize) -> Option<f64> {
        let p = self.positions[i];
        let squared = |j: usize| self.positions[j].distance_squared(p);
        self.tree.nearest(p, squared, |j| j == i).map(|(_, squared)| squared.sqrt())
    }

    /// The point nearest to `p`; there is at least one point.
    fn nearest(&self, p: DVec3) -> DVec3 {
        let squared = |j: usize| self.positions[j].distance_squared(p);
        self.tree.nearest(p, squared, |_| false).map_or(p, |(j, _)| self.positions[j])
    }
}

/// A triangle, a distance that one of its places has from all points, and one that none exceeds.
struct Piece {
    corners: [DVec3; 3],
    reached: f64,
    bound: f64,
}

impl Piece {
    fn new(corners: [DVec3; 3], cloud: &Cloud) -> Self {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let nearest = cloud.nearest(middle);
        // The distance to one point is convex: largest at a corner.
        let bound = corners.iter().map(|p| p.distance(nearest)).fold(0.0, f64::max);
        Self { corners, reached: middle.distance(nearest), bound }
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// The covering radius, too small by at most `tolerance` of itself.
fn cover(mesh: &SurfaceMesh, cloud: &Cloud, tolerance: f64, progress: &dyn Progress) -> f64 {
    let faces: Vec<Piece> = parallel::map_chunks(mesh.face_count(), STEP, |range| {
        let pieces: Vec<Piece> = range.map(|i| Piece::new(mesh.triangle(FaceId::new(i)), cloud)).collect();
        progress.advance(1);
        pieces
    })
    .into_iter()
    .flatten()
    .collect();
    let reached = faces.iter().map(|piece| piece.reached).fold(0.0, f64::max);
    let open: Vec<[DVec3; 3]> =
        faces.iter().filter(|piece| piece.bound > reached * (1.0 + tolerance)).map(|p| p.corners).collect();
    // Few triangles may hold all the work: one at a time.
    let found = parallel::map(open.len(), |i| {
        let mut heap = BinaryHeap::from([Piece::new(open[i], cloud)]);
        let mut best = reached;
        while let Some(piece) = heap.pop() {
            if piece.bound <= best * (1.0 + tolerance) || progress.is_cancelled() {
                break;
            }
            for half in halve(piece.corners).1.map(|corners| Piece::new(corners, cloud)) {
                best = best.max(half.reached);
                if half.bound > best * (1.0 + tolerance) {
                    heap.push(half);
                }
            }
        }
        best
    });
    found.into_iter().fold(reached, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::testmesh::{self, on_square};
    use crate::progress::Silent;

    fn measure(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> SpacingReport {
        spacing(mesh, points, &SpacingOptions::default(), &Silent)
    }

    #[test]
    fn a_square_lattice_by_hand() {
        let mesh = testmesh::square(1);
        let side = 12u32;
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
        let points: Vec<_> = (0..side * side).map(|k| on_square(at(k % side), at(k / side))).collect();
        let report = measure(&mesh, &points);
        // The hexagonal lattice of the same density is wider by sqrt(2 / sqrt 3).
        let step = (3.0f64.sqrt() / 2.0).sqrt();
        assert!((report.min - step).abs() < 1e-12, "{report:?}");
        assert!((report.mean - step).abs() < 1e-12, "{report:?}");
        assert!(report.variation < 1e-12, "{report:?}");
        // The corners of the lattice's squares are farthest.
        let farthest = step * std::f64::consts::FRAC_1_SQRT_2;
        assert!(report.cover <= farthest && farthest <= report.cover * 1.005, "{report:?}");
    }

    #[test]
    fn the_octahedron_covers_the_sphere_to_its_face_centres() {
        let mesh = testmesh::sphere(32);
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let places: Vec<DVec3> = axes.iter().flat_map(|&a| [a, -a]).collect();
        let report = measure(&mesh, &testmesh::project(&mesh, &places));
        let exact = (2.0 - 2.0 / 3.0f64.sqrt()).sqrt();
        assert!((report.cover * report.ideal - exact).abs() < 0.005, "{report:?}");
        assert!((report.min * report.ideal - std::f64::consts::SQRT_2).abs() < 1e-12, "{report:?}");
    }

    #[test]
    fn a_tighter_tolerance_stays_within_the_looser_bound() {
        let mesh = testmesh::cube();
        let points = testmesh::random_points(&mesh, 50, 3);
        let tight = spacing(&mesh, &points, &SpacingOptions { tolerance: 1e-6 }, &Silent);
        for tolerance in [0.5, 0.1, 0.01] {
            let loose = spacing(&mesh, &points, &SpacingOptions { tolerance }, &Silent);
            assert!(loose.cover <= tight.cover * (1.0 + 1e-6), "{loose:?} {tight:?}");
            assert!(tight.cover <= loose.cover * (1.0 + tolerance), "{loose:?} {tight:?}");
        }
    }

    #[test]
    fn a_thousand_equal_points_are_no_trouble() {
        let report = measure(&testmesh::square(1), &vec![on_square(0.5, 0.5); 1000]);
        assert_eq!((report.min, report.mean), (0.0, 0.0));
        assert!((report.cover * report.ideal - 0.5f64.sqrt()).abs() < 0.004, "{report:?}");
    }

    #[test]
    fn a_single_point_has_no_neighbour() {
        let report = measure(&testmesh::square(1), &[on_square(0.0, 0.0)]);
        assert!(report.min.is_nan() && report.mean.is_nan() && report.variation.is_nan());
        assert!((report.cover * report.ideal - std::f64::consts::SQRT_2).abs() < 0.008, "{report:?}");
    }
}
