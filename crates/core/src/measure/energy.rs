//! Energy discrepancy and eta: how near the points come to the best that is possible on any surface.

use glam::DVec3;

use crate::measure::profile::{Profile, Scene};
use crate::measure::testset;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::sample::SurfacePoint;

/// The leading-order constant of the least energy discrepancy, kappa sqrt(A) n^(-3/2): minus the Epstein zeta
/// function of the hexagonal lattice of unit area at -1 (Brauchart, Hardin, Saff, DOI 10.1090/conm/578/11483).
const KAPPA: f64 = 0.225_255_864_850_463;

/// Sets of directions, each turned at random against the others; their spread gives the standard error.
const BLOCKS: usize = 16;

/// Directions of each set at the start.
const PILOT: usize = 32;

/// How many planes are tried.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct EnergyOptions {
    /// The standard error of D^2 to reach, over D^2. Default: 0.01.
    pub tolerance: f64,
    /// The most work: directions times triangles, points and planes across a direction. 512 directions are tried
    /// in any case; when more would be needed than this allows, the error stays above `tolerance`.
    /// Default: 1e8, about three seconds of one core.
    pub work: f64,
}

impl Default for EnergyOptions {
    fn default() -> Self {
        Self { tolerance: 0.01, work: 1e8 }
    }
}

/// The energy discrepancy of points on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyReport {
    /// The floor 0.2253 sqrt(A) n^(-3/2) over `discrepancy`: 1 is the best of any point set on any smooth surface
    /// to leading order in n. Few points, borders, corners and thin parts may lie above or below.
    pub eta: f64,
    /// The root of `discrepancy` over its mean for independent uniform points: 1 is as good as random, smaller is
    /// better.
    pub mc: f64,
    /// D^2 = 2/n sum_i E|x_i - Y| - 1/n^2 sum_ij |x_i - x_j| - E|Y - Y'|, with Y and Y' uniform on the surface; in
    /// units of the mesh.
    pub discrepancy: f64,
    /// The standard error of `discrepancy` that comes from the finite number of directions, over `discrepancy`;
    /// estimated from the spread of sixteen sets of directions.
    pub relative_error: f64,
    /// How many directions were tried.
    pub directions: usize,
    /// E|Y - Y'|, the mean distance of two random places, in units of the mesh.
    pub mean_distance: f64,
    /// The standard error of `mean_distance`, over `mean_distance`; found like `relative_error`. `mc` errs by half the
    /// root of the sum of the squares of both.
    pub mean_distance_error: f64,
}

/// The planes of one mesh with their shares of area: made once, then any number of point sets are measured by them.
///
/// The energy discrepancy is the mean squared half-space discrepancy: with F(t) the share of area and F_n(t) the
/// share of points below the plane w.x = t, D^2 = 4 E_w of the integral of (F_n - F)^2 over t (Crofton:
/// |r| = 2 E_w |w.r| over uniform directions w), and E|Y - Y'| = 4 E_w of the integral of F (1 - F). Every term is
/// positive, so nothing cancels; F is exact up to rounding; what is left is the error of the finite number of
/// planes, which is reported and kept below `tolerance` within the limit of `work`.
#[derive(Clone, Debug)]
pub struct EnergyPlanes {
    scene: Scene,
    options: EnergyOptions,
    planes: usize,
    pilot: Vec<Option<Profile>>,
}

impl EnergyPlanes {
    /// Planes fine enough for sets of up to `count` points. O(T) a direction, 512 directions. Progress: `energy`,
    /// one step a direction.
    pub fn new(mesh: &SurfaceMesh, count: usize, options: &EnergyOptions, progress: &dyn Progress) -> Self {
        let scene = Scene::new(mesh);
        let planes = planes_per_direction(count);
        let pilot =
            each_direction(PILOT, progress, |direction, shift| scene.profile(direction, planes, shift));
        let pilot = pilot.into_iter().map(Option::flatten).collect();
        Self { scene, options: *options, planes, pilot }
    }

    /// Measures points. O(n) a direction; when 512 directions do not suffice, O(T + n) for each of more.
    /// Progress: `energy`, one step a direction, only in that case.
    pub fn measure(
        &self,
        mesh: &SurfaceMesh,
        points: &[SurfacePoint],
        progress: &dyn Progress,
    ) -> EnergyReport {
        let positions: Vec<DVec3> = points.iter().map(|p| mesh.locate(p)).collect();
        let pilot = |i: usize| self.pilot[i].as_ref().map_or([0.0; 2], |p| integrate(p, &positions));
        let mut integrals = Integrals::of(&parallel::map(self.pilot.len(), pilot));
        let error = integrals.relative_errors()[0];
        if error > self.options.tolerance {
            let work = self.scene.face_count() + points.len() + self.planes;
            let most = self.options.work / work as f64 / BLOCKS as f64;
            // A tenth more, because the error itself is only estimated.
            let wanted =
                1.1 * PILOT as f64 * (error / self.options.tolerance) * (error / self.options.tolerance);
            let directions = wanted.min(most) as usize;
            if directions > PILOT {
                let all = each_direction(directions, progress, |direction, shift| {
                    let profile = self.scene.profile(direction, self.planes, shift);
                    profile.map_or([0.0; 2], |profile| integrate(&profile, &positions))
                });
                let all: Vec<[f64; 2]> = all.into_iter().map(|x| x.unwrap_or([f64::NAN; 2])).collect();
                integrals = Integrals::of(&all);
            }
        }
        let n = points.len() as f64;
        let [discrepancy, mean_distance] = integrals.means;
        let [relative_error, mean_distance_error] = integrals.relative_errors();
        EnergyReport {
            eta: KAPPA * mesh.area().sqrt() / (n * n.sqrt()) / discrepancy,
            mc: (discrepancy * n / mean_distance).sqrt(),
            discrepancy,
            relative_error,
            directions: integrals.directions,
            mean_distance,
            mean_distance_error,
        }
    }
}

/// The energy discrepancy and eta: see [`EnergyPlanes`], which measures several sets on one mesh at the price of
/// one.
pub fn energy(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    options: &EnergyOptions,
    progress: &dyn Progress,
) -> EnergyReport {
    EnergyPlanes::new(mesh, points.len(), options, progress).measure(mesh, points, progress)
}

/// `f` of each direction of all blocks and of a shift of the planes that is even in [0, 1); `None` where cancelled.
fn each_direction<R: Send>(
    directions: usize,
    progress: &dyn Progress,
    f: impl Fn(DVec3, f64) -> R + Sync + Send,
) -> Vec<Option<R>> {
    progress.begin("energy", (BLOCKS * directions) as u64);
    let sets: Vec<_> = (0..BLOCKS).map(|block| testset::directions(directions, block)).collect();
    parallel::map(BLOCKS * directions, |i| {
        if progress.is_cancelled() {
            return None;
        }
        let result = f(sets[i / directions][i % directions], testset::radical_inverse(2, i as u32));
        progress.advance(1);
        Some(result)
    })
}

/// D^2 and E|Y - Y'|, from each block of directions and from all.
struct Integrals {
    blocks: Vec<[f64; 2]>,
    means: [f64; 2],
    directions: usize,
}

impl Integrals {
    /// From the integrals of each direction, block after block.
    fn of(integrals: &[[f64; 2]]) -> Self {
        let size = integrals.len() / BLOCKS;
        let blocks: Vec<[f64; 2]> =
            integrals.chunks(size).map(|block| mean(block).map(|m| 4.0 * m)).collect();
        Self { means: mean(&blocks), blocks, directions: integrals.len() }
    }

    /// The standard errors of D^2 and E|Y - Y'|, each over its value.
    fn relative_errors(&self) -> [f64; 2] {
        std::array::from_fn(|k| {
            let mean = self.means[k];
            let squares: f64 = self.blocks.iter().map(|b| (b[k] - mean) * (b[k] - mean)).sum();
            (squares / (BLOCKS * (BLOCKS - 1)) as f64).sqrt() / mean
        })
    }
}

fn mean(values: &[[f64; 2]]) -> [f64; 2] {
    values.iter().fold([0.0; 2], |s, v| [s[0] + v[0], s[1] + v[1]]).map(|s| s / values.len() as f64)
}

/// The integrals over t of (F_n - F)^2 and F (1 - F).
fn integrate(profile: &Profile, positions: &[DVec3]) -> [f64; 2] {
    let (mut squared, mut spread) = (0.0, 0.0);
    for (&area, points) in profile.area.iter().zip(profile.points_below(positions)) {
        squared += (points - area) * (points - area);
        spread += area * (1.0 - area);
    }
    [squared * profile.width, spread * profile.width]
}

/// How many planes are tried across each direction for `count` points: eight times sqrt(count), a fraction of the
/// distance over which the discrepancy of evenly spread points keeps its sign, and at least 256.
fn planes_per_direction(count: usize) -> usize {
    ((8.0 * (count as f64).sqrt()) as usize).clamp(256, 1 << 17)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::triangle;
    use crate::ids::FaceId;
    use crate::measure::testmesh::{self, on_square, random_points};
    use crate::progress::Silent;

    fn measure(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> EnergyReport {
        energy(mesh, points, &EnergyOptions::default(), &Silent)
    }

    /// The integral of sqrt(x^2 + y^2) over [0, a] x [0, b].
    fn corner_integral(a: f64, b: f64) -> f64 {
        if a == 0.0 || b == 0.0 {
            return 0.0;
        }
        let d = (a * a + b * b).sqrt();
        (2.0 * a * b * d + a * a * a * libm::log((b + d) / a) + b * b * b * libm::log((a + d) / b)) / 6.0
    }

    /// The energy discrepancy of points on the unit square by pair sums and closed forms.
    fn exact_on_square(points: &[(f64, f64)]) -> f64 {
        let n = points.len() as f64;
        let root = std::f64::consts::SQRT_2;
        let mean_distance = (2.0 + root + 5.0 * libm::log(1.0 + root)) / 15.0;
        let (mut potential, mut pairs) = (0.0, 0.0);
        for &(x, y) in points {
            for a in [x, 1.0 - x] {
                for b in [y, 1.0 - y] {
                    potential += corner_integral(a, b);
                }
            }
            for &(u, v) in points {
                pairs += ((x - u) * (x - u) + (y - v) * (y - v)).sqrt();
            }
        }
        2.0 * potential / n - pairs / (n * n) - mean_distance
    }

    fn assert_on_square(points: &[(f64, f64)]) -> EnergyReport {
        let placed: Vec<_> = points.iter().map(|&(x, y)| on_square(x, y)).collect();
        let report = measure(&testmesh::square(1), &placed);
        let error = report.discrepancy / exact_on_square(points) - 1.0;
        assert!(report.relative_error < 0.011, "{report:?}");
        assert!(error.abs() < 4.0 * report.relative_error, "off by {error}: {report:?}");
        let error = report.mean_distance / 0.521_405_433 - 1.0;
        assert!(report.mean_distance_error < 0.005, "{report:?}");
        assert!(error.abs() < 4.0 * report.mean_distance_error + 1e-6, "off by {error}: {report:?}");
        report
    }

    #[test]
    fn one_point_on_a_square_by_hand() {
        // E|centre - Y| = (sqrt 2 + ln(1 + sqrt 2)) / 6, twice that from a corner.
        assert!((exact_on_square(&[(0.5, 0.5)]) - 0.243_790_283).abs() < 1e-9);
        assert!((exact_on_square(&[(0.0, 0.0)]) - 1.008_986_000).abs() < 1e-9);
        assert_on_square(&[(0.5, 0.5)]);
        assert_on_square(&[(0.0, 0.0)]);
        assert_on_square(&[(0.2, 0.9), (0.2, 0.9), (0.7, 0.1)]);
    }

    fn lattice(side: u32) -> Vec<(f64, f64)> {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
        (0..side).flat_map(|i| (0..side).map(move |j| (at(i), at(j)))).collect()
    }

    #[test]
    fn a_square_lattice_is_nearly_perfect_and_a_clump_is_not() {
        for side in [3, 10, 32] {
            let report = assert_on_square(&lattice(side));
            // 0.2253 / 0.2288 = 0.985 on an endless plane, less at borders.
            assert!((0.93..1.0).contains(&report.eta), "{report:?}");
        }
        let clump: Vec<_> = lattice(10).iter().map(|&(x, y)| (0.3 + 0.01 * x, 0.4 + 0.01 * y)).collect();
        let report = assert_on_square(&clump);
        assert!(report.mc > 5.0 && report.eta < 0.01, "{report:?}");
    }

    /// The energy discrepancy by pair sums, the surface replaced by midpoints of its halved faces.
    fn by_pair_sums(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> f64 {
        let mut nodes: Vec<(DVec3, f64)> = Vec::new();
        for (i, area) in mesh.face_areas().iter().enumerate() {
            let mut pieces = vec![mesh.triangle(FaceId::new(i))];
            while pieces.len() * mesh.face_count() < 8000 {
                pieces = pieces.into_iter().flat_map(|p| crate::measure::halving::halve(p).1).collect();
            }
            let weight = area / mesh.area() / pieces.len() as f64;
            nodes.extend(pieces.iter().map(|&[a, b, c]| (triangle::at(a, b, c, [1.0 / 3.0; 3]), weight)));
        }
        let x: Vec<DVec3> = points.iter().map(|p| mesh.locate(p)).collect();
        let n = x.len() as f64;
        let to_surface = |p: DVec3| nodes.iter().map(|(y, w)| w * p.distance(*y)).sum::<f64>();
        let potential: f64 = x.iter().map(|&p| to_surface(p)).sum();
        let pairs: f64 = x.iter().map(|p| x.iter().map(|q| p.distance(*q)).sum::<f64>()).sum();
        let own: f64 = nodes.iter().map(|(y, w)| w * to_surface(*y)).sum();
        2.0 * potential / n - pairs / (n * n) - own
    }

    #[test]
    fn agrees_with_pair_sums_in_space() {
        for mesh in [testmesh::cube(), testmesh::sphere(6)] {
            let points = random_points(&mesh, 60, 7);
            let report = measure(&mesh, &points);
            let error = report.discrepancy / by_pair_sums(&mesh, &points) - 1.0;
            assert!(error.abs() < 4.0 * report.relative_error + 1e-3, "off by {error}: {report:?}");
        }
        let sphere = measure(&testmesh::sphere(30), &random_points(&testmesh::sphere(30), 5, 1));
        assert!((sphere.mean_distance - 4.0 / 3.0).abs() < 2e-3, "{sphere:?}");
    }

    #[test]
    fn halving_the_error_changes_nothing_that_is_measured() {
        let mesh = testmesh::sphere(12);
        let points = random_points(&mesh, 300, 2);
        let rough = measure(&mesh, &points);
        let options = EnergyOptions { tolerance: 0.5 * rough.relative_error, work: 1e9 };
        let fine = energy(&mesh, &points, &options, &Silent);
        assert!(fine.relative_error < 0.6 * rough.relative_error, "{rough:?} {fine:?}");
        assert!((fine.discrepancy / rough.discrepancy - 1.0).abs() < 4.0 * rough.relative_error);
        assert!((fine.mean_distance / rough.mean_distance - 1.0).abs() < 4.0 * rough.mean_distance_error);
        // More planes across a direction than are taken for this many points.
        let more = EnergyPlanes::new(&mesh, 100_000, &EnergyOptions::default(), &Silent);
        let more = more.measure(&mesh, &points, &Silent);
        assert!((more.discrepancy / rough.discrepancy - 1.0).abs() < rough.relative_error, "{more:?}");
    }

    #[test]
    fn spherical_fibonacci_reaches_the_floor() {
        let mesh = testmesh::sphere(40);
        let points = testmesh::project(&mesh, &testmesh::fibonacci(770));
        let report = measure(&mesh, &points);
        assert!((report.eta - 0.98).abs() < 0.03, "{report:?}");
    }
}
