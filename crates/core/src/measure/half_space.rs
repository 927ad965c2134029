//! Half-space discrepancy: planes of many directions and places.

use glam::DVec3;

use crate::measure::norms::{Norms, Shares, worst};
use crate::measure::profile::{Profile, Scene};
use crate::measure::testset;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::sample::SurfacePoint;

/// Planes across each direction from which the tried ones are chosen.
const PLANES: usize = 1024;

/// Keeps the directions apart from those of the energy measure.
const BLOCK: usize = 1 << 16;

/// Which half-spaces are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct HalfSpaceOptions {
    /// Directions. Default: 256.
    pub directions: usize,
    /// Half-spaces of each direction; their shares of area part [0, 1] evenly. Default: 16.
    pub offsets: usize,
}

impl Default for HalfSpaceOptions {
    fn default() -> Self {
        Self { directions: 256, offsets: 16 }
    }
}

/// The half-space `normal . x < offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HalfSpace {
    /// The unit normal that points out of it.
    pub normal: DVec3,
    /// Where its plane lies along the normal, in units of the mesh.
    pub offset: f64,
}

/// How the points' shares of half-spaces differ from the shares of area.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HalfSpaceReport {
    /// The norms over all half-spaces.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub norms: Norms,
    /// The half-space with the largest difference (the first of several); `None` without half-spaces or points.
    pub worst: Option<HalfSpace>,
}

/// The half-spaces of one mesh with their shares of area: made once, then any number of point sets are measured
/// by them.
///
/// The directions spread evenly over the sphere. Across each, planes are chosen among 1,024 equally distant ones so
/// that half-spaces of every share of area come equally often: planes through random places of the surface. The
/// shares of area are exact (triangles cut by planes). The directions are fixed in space, so turning mesh and
/// points together tries other half-spaces of the same family.
#[derive(Clone, Debug)]
pub struct HalfSpaces {
    directions: Vec<Direction>,
}

/// The half-spaces across one direction.
#[derive(Clone, Debug)]
struct Direction {
    normal: DVec3,
    profile: Profile,
    /// The planes that are tried.
    planes: Vec<usize>,
}

impl HalfSpaces {
    /// O(T) a direction. Progress: `half-space`, one step a direction.
    pub fn new(mesh: &SurfaceMesh, options: &HalfSpaceOptions, progress: &dyn Progress) -> Self {
        progress.begin("half-space", options.directions as u64);
        let scene = Scene::new(mesh);
        let normals = testset::directions(options.directions, BLOCK);
        let directions = parallel::map(normals.len(), |i| {
            if progress.is_cancelled() {
                return None;
            }
            let direction = Direction::new(&scene, normals[i], i as u32, options.offsets);
            progress.advance(1);
            direction
        });
        Self { directions: directions.into_iter().flatten().collect() }
    }

    /// Measures points; a point in the plane counts as inside. O(n) a direction.
    pub fn measure(&self, mesh: &SurfaceMesh, points: &[SurfacePoint]) -> HalfSpaceReport {
        let positions: Vec<DVec3> = points.iter().map(|p| mesh.locate(p)).collect();
        let shares = parallel::map(self.directions.len(), |i| self.directions[i].shares(&positions)).concat();
        let half_spaces = self.directions.iter().flat_map(Direction::half_spaces);
        HalfSpaceReport { norms: Norms::over(&shares, points.len()), worst: worst(&shares, half_spaces) }
    }
}

impl Direction {
    fn new(scene: &Scene, normal: DVec3, index: u32, offsets: usize) -> Option<Self> {
        let profile = scene.profile(normal, PLANES, 0.5)?;
        let shift = testset::radical_inverse(2, index);
        let planes = (0..offsets)
            .map(|k| {
                let share = (k as f64 + shift) / offsets as f64;
                profile.area.partition_point(|&area| area < share).min(PLANES - 1)
            })
            .collect();
        Some(Self { normal, profile, planes })
    }

    fn shares(&self, positions: &[DVec3]) -> Vec<Shares> {
        let points = self.profile.points_below(positions);
        let area = &self.profile.area;
        self.planes.iter().map(|&k| Shares { area: area[k].clamp(0.0, 1.0), points: points[k] }).collect()
    }

    fn half_spaces(&self) -> impl Iterator<Item = HalfSpace> + '_ {
        let half_space = |&k: &usize| HalfSpace { normal: self.normal, offset: self.profile.offset(k) };
        self.planes.iter().map(half_space)
    }
}

/// The norms of share of points - share of area over half-spaces: see [`HalfSpaces`], which measures several sets
/// on one mesh at the price of one.
pub fn half_space(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    options: &HalfSpaceOptions,
    progress: &dyn Progress,
) -> HalfSpaceReport {
    HalfSpaces::new(mesh, options, progress).measure(mesh, points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::testmesh::{self, on_square};
    use crate::progress::Silent;

    #[test]
    fn a_cube_from_below_by_hand() {
        let mesh = testmesh::cube();
        let profile = Scene::new(&mesh).profile(DVec3::Z, 10, 0.5).expect("a cube has a height");
        assert!((profile.offset(0) - 0.05).abs() < 1e-15 && (profile.width - 0.1).abs() < 1e-15);
        for (k, area) in profile.area.iter().enumerate() {
            // The bottom at once, then the four sides.
            let exact = 1.0 / 6.0 + 4.0 / 6.0 * (0.05 + 0.1 * k as f64);
            assert!((area - exact).abs() < 1e-15, "{k}: {area} {exact}");
        }
    }

    #[test]
    fn a_square_has_no_height() {
        let mesh = testmesh::square(2);
        assert!(Scene::new(&mesh).profile(DVec3::Z, 8, 0.5).is_none());
    }

    #[test]
    fn shares_of_area_part_the_unit_interval() {
        let scene = Scene::new(&testmesh::sphere(5));
        let direction =
            Direction::new(&scene, DVec3::new(0.6, 0.0, 0.8), 1, 8).expect("a sphere has a width");
        for (k, shares) in direction.shares(&[]).iter().enumerate() {
            assert!((shares.area - (k as f64 + 0.5) / 8.0).abs() < 2.0 / PLANES as f64, "{shares:?}");
        }
    }

    #[test]
    fn points_on_one_half_of_a_square_are_found_out() {
        let mesh = testmesh::square(1);
        let at = |k: u32| (f64::from(k) + 0.5) / 20.0;
        let points: Vec<_> = (0..400).map(|k| on_square(0.25 + 0.5 * at(k % 20), at(k / 20))).collect();
        let report = half_space(&mesh, &points, &HalfSpaceOptions::default(), &Silent);
        // The strips x < 0.2625 and x > 0.7375 hold no point.
        assert!((0.24..=0.2625).contains(&report.norms.linf), "{report:?}");
        let worst = report.worst.expect("half-spaces were tried");
        assert!(worst.normal.x.abs() > 0.5 * worst.normal.y.abs(), "{report:?}");
    }
}
