//! Integration error: how well the mean over the points stands for the mean over the surface.

use glam::DVec3;

use crate::geometry::triangle;
use crate::ids::FaceId;
use crate::measure::halving::halve;
use crate::measure::testset;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::sample::SurfacePoint;

/// Triangles or points that one piece of the work takes.
const STEP: usize = 1024;

/// Longest edge, over the shortest length on which a test function changes, that the cubature takes in one piece.
const PIECE: f64 = 0.5;

/// Which functions are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct IntegrationOptions {
    /// How many. Default: 64.
    pub functions: usize,
}

impl Default for IntegrationOptions {
    fn default() -> Self {
        Self { functions: 64 }
    }
}

/// How far means over the points lie from means over the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct IntegrationReport {
    /// Root mean square, over the functions, of the error of the mean; each function scaled to standard deviation
    /// 1 over the surface.
    pub rms: f64,
    /// `rms` over its root mean square for independent uniform points, 1/sqrt(n): 1 is as good as random, smaller
    /// is better.
    pub mc: f64,
}

/// The test functions of one mesh with their means over it: made once, then any number of point sets are measured
/// by them.
///
/// They take turns: bumps exp(-|x - c|^2 / (2 s^2)) with s = r, r/2 and r/4, and waves cos(k.(x - g) + p) with k
/// towards c and |k| at most 4/r. Here g is the centre of the surface, r its root mean squared distance from g, and
/// the places c spread evenly over its area: the functions depend on the mesh only, and move and scale with it.
/// Means and deviations over the surface come from Radon's cubature of degree 5 (7 nodes a triangle), triangles
/// halved until it errs by less than 1e-9 of a standard deviation.
#[derive(Clone, Debug)]
pub struct TestFunctions {
    frame: Frame,
    family: Vec<Function>,
    moments: Vec<Moment>,
}

impl TestFunctions {
    /// O(7 T) a function. Progress: `integration`, one step each 1,024 triangles.
    pub fn new(mesh: &SurfaceMesh, options: &IntegrationOptions, progress: &dyn Progress) -> Self {
        progress.begin("integration", mesh.face_count().div_ceil(STEP) as u64);
        let frame = Frame::of(mesh);
        let family = family(mesh, &frame, options.functions);
        let moments = surface_moments(mesh, &frame, &family, PIECE, progress);
        Self { frame, family, moments }
    }

    /// Measures points. O(n) a function.
    pub fn measure(&self, mesh: &SurfaceMesh, points: &[SurfacePoint]) -> IntegrationReport {
        let sums = parallel::map_chunks(points.len(), STEP, |range| {
            let mut sums = vec![0.0; self.family.len()];
            for point in &points[range] {
                let x = mesh.locate(point) - self.frame.centre;
                for (sum, function) in sums.iter_mut().zip(&self.family) {
                    *sum += function.at(x);
                }
            }
            sums
        });
        let n = points.len() as f64;
        let (mut squared, mut counted) = (0.0, 0.0);
        for (k, moment) in self.moments.iter().enumerate() {
            let variance = moment.square - moment.mean * moment.mean;
            // A function that is constant on this surface has no scale to measure its error by.
            if variance > 1e-12 {
                let error = sums.iter().map(|s| s[k]).sum::<f64>() / n - moment.mean;
                squared += error * error / variance;
                counted += 1.0;
            }
        }
        let rms = (squared / counted).sqrt();
        IntegrationReport { rms, mc: rms * n.sqrt() }
    }
}

/// The error of means over the points of smooth functions: see [`TestFunctions`], which measures several sets on
/// one mesh at the price of one.
pub fn integration(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    options: &IntegrationOptions,
    progress: &dyn Progress,
) -> IntegrationReport {
    TestFunctions::new(mesh, options, progress).measure(mesh, points)
}

/// Where the surface lies and how large it is, by exact moments.
#[derive(Clone, Copy, Debug)]
struct Frame {
    centre: DVec3,
    radius: f64,
}

impl Frame {
    fn of(mesh: &SurfaceMesh) -> Self {
        let (low, high) = mesh.bounds();
        let origin = (low + high) * 0.5;
        let weighted = |f: &dyn Fn([DVec3; 3]) -> DVec3| {
            mesh.topology().face_ids().fold(DVec3::ZERO, |sum, face| {
                sum + f(mesh.triangle(face).map(|p| p - origin)) * (mesh.face_area(face) / mesh.area())
            })
        };
        let centre = origin + weighted(&|[a, b, c]| (a + b + c) / 3.0);
        let shift = origin - centre;
        let squared = weighted(&|corners| {
            let [a, b, c] = corners.map(|p| p + shift);
            let sum = a * a + b * b + c * c + (a + b + c) * (a + b + c);
            sum / 12.0
        });
        Self { centre, radius: squared.element_sum().sqrt() }
    }
}

/// A smooth function of the place relative to the centre.
#[derive(Clone, Copy, Debug)]
enum Function {
    Bump { centre: DVec3, rate: f64 },
    Wave { wave: DVec3, phase: f64 },
}

impl Function {
    #[inline]
    fn at(&self, x: DVec3) -> f64 {
        match *self {
            Self::Bump { centre, rate } => libm::exp(-rate * x.distance_squared(centre)),
            Self::Wave { wave, phase } => libm::cos(wave.dot(x) + phase),
        }
    }
}

/// The test functions; none changes on a length shorter than a quarter of the radius.
fn family(mesh: &SurfaceMesh, frame: &Frame, count: usize) -> Vec<Function> {
    testset::places(mesh, count, 2)
        .iter()
        .enumerate()
        .map(|(k, place)| {
            let centre = mesh.locate(place) - frame.centre;
            let bump = |width: f64| Function::Bump { centre, rate: 0.5 / (width * width) };
            match k % 4 {
                0 => bump(frame.radius),
                1 => bump(frame.radius * 0.5),
                2 => bump(frame.radius * 0.25),
                _ => Function::Wave {
                    wave: centre * (4.0 / (frame.radius * centre.length().max(frame.radius))),
                    phase: std::f64::consts::TAU * testset::radical_inverse(3, k as u32),
                },
            }
        })
        .collect()
}

/// Means over the surface of a function and of its square.
#[derive(Clone, Copy, Debug, Default)]
struct Moment {
    mean: f64,
    square: f64,
}

/// The means over the surface, triangles longer than `piece` quarters of the radius halved.
fn surface_moments(
    mesh: &SurfaceMesh,
    frame: &Frame,
    family: &[Function],
    piece: f64,
    progress: &dyn Progress,
) -> Vec<Moment> {
    let longest = piece * 0.25 * frame.radius;
    let nodes = radon();
    let parts = parallel::map_chunks(mesh.face_count(), STEP, |range| {
        let mut moments = vec![Moment::default(); family.len()];
        if progress.is_cancelled() {
            return moments;
        }
        let mut stack = Vec::new();
        for index in range {
            let face = FaceId::new(index);
            let share = mesh.face_area(face) / mesh.area();
            stack.push((mesh.triangle(face).map(|p| p - frame.centre), share));
            while let Some(([a, b, c], share)) = stack.pop() {
                let (squared, halves) = halve([a, b, c]);
                if squared > longest * longest {
                    stack.extend(halves.map(|half| (half, 0.5 * share)));
                    continue;
                }
                for (barycentric, weight) in nodes {
                    let x = triangle::at(a, b, c, barycentric);
                    for (moment, function) in moments.iter_mut().zip(family) {
                        let value = function.at(x);
                        let weighted = value * (weight * share);
                        moment.mean += weighted;
                        moment.square += weighted * value;
                    }
                }
            }
        }
        progress.advance(1);
        moments
    });
    let mut total = vec![Moment::default(); family.len()];
    for part in parts {
        for (sum, moment) in total.iter_mut().zip(part) {
            sum.mean += moment.mean;
            sum.square += moment.square;
        }
    }
    total
}

/// Nodes and weights of Radon's cubature of degree 5 on a triangle (1948; Stroud T2:5-1).
fn radon() -> [([f64; 3], f64); 7] {
    let root = 15.0f64.sqrt();
    let (near, far) = ((6.0 - root) / 21.0, (6.0 + root) / 21.0);
    let (light, heavy) = ((155.0 - root) / 1200.0, (155.0 + root) / 1200.0);
    let third = 1.0 / 3.0;
    [
        ([third; 3], 9.0 / 40.0),
        ([near, near, 1.0 - 2.0 * near], light),
        ([near, 1.0 - 2.0 * near, near], light),
        ([1.0 - 2.0 * near, near, near], light),
        ([far, far, 1.0 - 2.0 * far], heavy),
        ([far, 1.0 - 2.0 * far, far], heavy),
        ([1.0 - 2.0 * far, far, far], heavy),
    ]
}
#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::testmesh::{self, on_square};
    use crate::progress::Silent;

    #[test]
    fn cubature_is_exact_to_degree_five() {
        let factorial = |k: u32| (1..=k).map(f64::from).product::<f64>();
        let power = |x: f64, k: u32| (0..k).map(|_| x).product::<f64>();
        for i in 0..=5 {
            for j in 0..=5 - i {
                let sum: f64 = radon().iter().map(|(b, w)| w * power(b[1], i) * power(b[2], j)).sum();
                let exact = 2.0 * factorial(i) * factorial(j) / factorial(i + j + 2);
                assert!((sum - exact).abs() < 1e-15, "x^{i} y^{j}: {sum} {exact}");
            }
        }
    }

    #[test]
    fn smaller_pieces_change_nothing_that_is_measured() {
        for mesh in [testmesh::cube(), testmesh::square(1), testmesh::sphere(6)] {
            let frame = Frame::of(&mesh);
            let family = family(&mesh, &frame, 64);
            let coarse = surface_moments(&mesh, &frame, &family, PIECE, &Silent);
            let fine = surface_moments(&mesh, &frame, &family, PIECE / 4.0, &Silent);
            for (c, f) in coarse.iter().zip(&fine) {
                let deviation = (f.square - f.mean * f.mean).sqrt();
                assert!((c.mean - f.mean).abs() < 1e-9 * deviation);
                assert!((c.square - f.square).abs() < 1e-8 * deviation);
            }
        }
    }

    #[test]
    fn the_frame_of_a_cube_by_hand() {
        // Of the faces x = 0 and 1 the mean of (x - 1/2)^2 is 1/4, of the other four 1/12: 3 (2/4 + 4/12) / 6.
        let frame = Frame::of(&testmesh::cube());
        assert!((frame.centre - DVec3::splat(0.5)).length() < 1e-15);
        assert!((frame.radius * frame.radius - 5.0 / 12.0).abs() < 1e-15);
    }

    #[test]
    fn a_lattice_integrates_smooth_functions_and_a_clump_does_not() {
        let mesh = testmesh::square(1);
        let lattice = |side: u32, scale: f64| -> Vec<SurfacePoint> {
            let at = |i: u32| 0.5 + scale * ((f64::from(i) + 0.5) / f64::from(side) - 0.5);
            (0..side * side).map(|k| on_square(at(k % side), at(k / side))).collect()
        };
        let measure =
            |points: &[SurfacePoint]| integration(&mesh, points, &IntegrationOptions::default(), &Silent);
        // The midpoint rule errs like the squared distance of the points.
        let (coarse, fine) = (measure(&lattice(16, 1.0)), measure(&lattice(32, 1.0)));
        assert!(fine.mc < 0.1, "{fine:?}");
        assert!((coarse.rms / fine.rms - 4.0).abs() < 0.3, "{coarse:?} {fine:?}");
        assert!(measure(&lattice(16, 0.1)).mc > 5.0);
    }
}
