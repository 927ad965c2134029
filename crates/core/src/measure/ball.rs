//! Ball discrepancy: balls centred on the surface, over a range of sizes.

use glam::DVec3;

use crate::ids::FaceId;
use crate::measure::norms::{Norms, Shares, worst};
use crate::measure::testset;
use crate::measure::tree::Tree;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::sample::SurfacePoint;

/// Balls that one step of the work takes.
const STEP: usize = 32;

/// Which balls are tried.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct BallOptions {
    /// How many. Default: 2,048.
    pub balls: usize,
    /// The smallest size: the share of area that the ball would hold on a plane. Default: 0.001.
    pub smallest: f64,
    /// The largest size, likewise. Default: 0.5.
    pub largest: f64,
}

impl Default for BallOptions {
    fn default() -> Self {
        Self { balls: 2048, smallest: 0.001, largest: 0.5 }
    }
}

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ball {
    /// Its centre, a place of the surface.
    pub centre: DVec3,
    /// Its radius, in units of the mesh.
    pub radius: f64,
}

/// How the points' shares of balls differ from the shares of area.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BallReport {
    /// The norms over all balls.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub norms: Norms,
    /// The ball with the largest difference (the first of several); `None` without balls or points.
    pub worst: Option<Ball>,
}

/// The balls of one mesh with their shares of area: made once, then any number of point sets are measured by them.
///
/// The centres lie evenly over the area; the radius is sqrt(s A / pi) with log s even between
/// [`smallest`](BallOptions::smallest) and [`largest`](BallOptions::largest). The shares of area are exact:
/// triangles cut by a sphere in closed form, whole branches of a tree of boxes where they lie inside. The balls
/// depend on the mesh and the options only, and move and scale with the mesh.
#[derive(Clone, Debug)]
pub struct Balls {
    balls: Vec<Ball>,
    /// The share of area of each.
    areas: Vec<f64>,
}

impl Balls {
    /// O(T log T), and O(triangles near the sphere) a ball. Progress: `ball`, one step a ball.
    pub fn new(mesh: &SurfaceMesh, options: &BallOptions, progress: &dyn Progress) -> Self {
        progress.begin("ball", options.balls as u64);
        let faces =
            Tree::of_triangles(mesh.face_count(), |i| mesh.triangle(FaceId::new(i)), mesh.face_areas());
        let balls = test_balls(mesh, options);
        let areas = parallel::map_chunks(balls.len(), STEP, |range| {
            if progress.is_cancelled() {
                return vec![f64::NAN; range.len()];
            }
            let steps = range.len() as u64;
            let areas: Vec<f64> = balls[range]
                .iter()
                .map(|&Ball { centre, radius }| {
                    let area = faces.weight_in_ball(centre, radius, |i| {
                        let face = FaceId::new(i);
                        let corners = mesh.triangle(face).map(|p| p - centre);
                        triangle_in_ball(corners, mesh.face_normal(face), mesh.face_area(face), radius)
                    });
                    (area / mesh.area()).min(1.0)
                })
                .collect();
            progress.advance(steps);
            areas
        })
        .concat();
        Self { balls, areas }
    }

    /// Measures points; a point on the sphere counts as inside. O(n log n), and O(points near the sphere) a ball.
    pub fn measure(&self, mesh: &SurfaceMesh, points: &[SurfacePoint]) -> BallReport {
        let positions: Vec<DVec3> = points.iter().map(|p| mesh.locate(p)).collect();
        let cloud = Tree::of_points(&positions);
        let shares = parallel::map_chunks(self.balls.len(), STEP, |range| {
            range
                .map(|k| {
                    let Ball { centre, radius } = self.balls[k];
                    let count = cloud.weight_in_ball(centre, radius, |i| {
                        f64::from(u8::from(positions[i].distance_squared(centre) <= radius * radius))
                    });
                    Shares { area: self.areas[k], points: count / points.len() as f64 }
                })
                .collect::<Vec<_>>()
        })
        .concat();
        let worst = worst(&shares, self.balls.iter().copied());
        BallReport { norms: Norms::over(&shares, points.len()), worst }
    }
}

/// The norms of share of points - share of area over balls: see [`Balls`], which measures several sets on one mesh
/// at the price of one.
pub fn ball(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    options: &BallOptions,
    progress: &dyn Progress,
) -> BallReport {
    Balls::new(mesh, options, progress).measure(mesh, points)
}

/// The balls that are tried.
fn test_balls(mesh: &SurfaceMesh, options: &BallOptions) -> Vec<Ball> {
    let (low, high) = (libm::log(options.smallest), libm::log(options.largest));
    testset::places(mesh, options.balls, 1)
        .iter()
        .enumerate()
        .map(|(i, place)| {
            // Base 3: independent of the places, whose index runs along the faces and whose base is 2.
            let even = (testset::radical_inverse(3, i as u32) + 0.5 / options.balls as f64).min(1.0);
            let share = libm::exp(low + (high - low) * even);
            let radius = (share * mesh.area() / std::f64::consts::PI).sqrt();
            Ball { centre: mesh.locate(place), radius }
        })
        .collect()
}

/// The area of the part of a triangle inside the ball of this radius around the origin, in closed form. `normal`
/// is the triangle's unit normal, `area` its area.
pub(super) fn triangle_in_ball(corners: [DVec3; 3], normal: DVec3, area: f64, radius: f64) -> f64 {
    let squared = radius * radius;
    if corners.iter().all(|p| p.length_squared() <= squared) {
        return area;
    }
    let height = corners[0].dot(normal);
    let disk = squared - height * height;
    if disk <= 0.0 {
        return 0.0;
    }
    // The sphere cuts the plane in a disk around the foot of the origin.
    let [a, b, c] = corners.map(|p| p - normal * height);
    let sum = wedge(a, b, normal, disk) + wedge(b, c, normal, disk) + wedge(c, a, normal, disk);
    sum.clamp(0.0, area)
}

/// The signed area that the disk around the origin with squared radius `disk` shares with the triangle of the
/// origin, `p` and `q`.
fn wedge(p: DVec3, q: DVec3, normal: DVec3, disk: f64) -> f64 {
    let cross = |u: DVec3, v: DVec3| u.cross(v).dot(normal);
    let sector = |u: DVec3, v: DVec3| 0.5 * disk * libm::atan2(cross(u, v), u.dot(v));
    let d = q - p;
    let (a, b, c) = (d.length_squared(), p.dot(d), p.length_squared() - disk);
    let discriminant = b * b - a * c;
    if discriminant <= 0.0 {
        return sector(p, q);
    }
    let root = discriminant.sqrt();
    let (enter, leave) = ((-b - root) / a, (-b + root) / a);
    if enter >= 1.0 || leave <= 0.0 {
        return sector(p, q);
    }
    let mut area = 0.0;
    let (mut u, mut v) = (p, q);
    if enter > 0.0 {
        u = p + d * enter;
        area += sector(p, u);
    }
    if leave < 1.0 {
        v = p + d * leave;
        area += sector(v, q);
    }
    area + 0.5 * cross(u, v)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::triangle;
    use crate::measure::halving::halve;
    use crate::measure::testmesh::{self, on_square};
    use crate::progress::Silent;

    fn area_in_ball(mesh: &SurfaceMesh, centre: DVec3, radius: f64) -> f64 {
        (0..mesh.face_count())
            .map(|i| {
                let face = FaceId::new(i);
                let corners = mesh.triangle(face).map(|p| p - centre);
                triangle_in_ball(corners, mesh.face_normal(face), mesh.face_area(face), radius)
            })
            .sum()
    }

    #[test]
    fn disks_on_a_square_by_hand() {
        let pi = std::f64::consts::PI;
        for mesh in [testmesh::square(1), testmesh::square(7)] {
            let cases = [
                // Inside; at a corner; at the middle of a side; above the middle; the whole square; beside it; out of reach.
                (DVec3::new(0.5, 0.5, 0.0), 0.3, pi * 0.09),
                (DVec3::ZERO, 0.5, pi * 0.0625),
                (DVec3::new(0.5, 0.0, 0.0), 0.25, pi * 0.03125),
                (DVec3::new(0.5, 0.5, 0.3), 0.5, pi * 0.16),
                (DVec3::new(0.5, 0.5, 0.0), 0.8, 1.0),
                (DVec3::new(2.0, 0.5, 0.0), 0.9, 0.0),
                (DVec3::new(0.5, 0.5, 0.4), 0.3, 0.0),
                // Four caps beyond the sides.
                (DVec3::new(0.5, 0.5, 0.0), 0.6, {
                    let cap = 0.36 * libm::acos(0.5 / 0.6) - 0.5 * (0.36f64 - 0.25).sqrt();
                    pi * 0.36 - 4.0 * cap
                }),
            ];
            for (centre, radius, exact) in cases {
                let area = area_in_ball(&mesh, centre, radius);
                assert!((area - exact).abs() < 1e-14, "{centre} {radius}: {area} {exact}");
            }
        }
    }

    proptest! {
        #[test]
        fn the_closed_form_agrees_with_halving(
            corners in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64)),
            radius in 0.05..1.5f64,
        ) {
            let [a, b, c] = corners.map(DVec3::from_array);
            let vector = triangle::area_vector(a, b, c);
            prop_assume!(vector.length() > 1e-3);
            let area = 0.5 * vector.length();
            let exact = triangle_in_ball([a, b, c], vector.normalize(), area, radius);
            let mut pieces = vec![[a, b, c]];
            for _ in 0..12 {
                pieces = pieces.into_iter().flat_map(|p| halve(p).1).collect();
            }
            let inside =
                pieces.iter().filter(|[a, b, c]| ((*a + *b + *c) / 3.0).length() <= radius).count() as f64;
            let counted = area * inside / pieces.len() as f64;
            prop_assert!((exact - counted).abs() < 0.03 * area, "{exact} {counted} of {area}");
        }
    }

    #[test]
    fn the_tree_changes_nothing() {
        let mesh = testmesh::sphere(9);
        let tree =
            Tree::of_triangles(mesh.face_count(), |i| mesh.triangle(FaceId::new(i)), mesh.face_areas());
        for ball in test_balls(&mesh, &BallOptions { balls: 50, ..Default::default() }) {
            let area = tree.weight_in_ball(ball.centre, ball.radius, |i| {
                let face = FaceId::new(i);
                let corners = mesh.triangle(face).map(|p| p - ball.centre);
                triangle_in_ball(corners, mesh.face_normal(face), mesh.face_area(face), ball.radius)
            });
            assert!((area - area_in_ball(&mesh, ball.centre, ball.radius)).abs() < 1e-12);
        }
    }

    #[test]
    fn one_point_misses_every_ball_that_does_not_hold_it() {
        let mesh = testmesh::square(1);
        let options = BallOptions { balls: 200, smallest: 0.01, largest: 0.2 };
        let report = ball(&mesh, &[on_square(0.0, 0.0)], &options, &Silent);
        // The ball that differs most is a small one around the only point, if there is one.
        let worst = report.worst.expect("balls were tried");
        assert!(worst.centre.length() <= worst.radius);
        assert!(report.norms.linf > 0.9 && report.norms.linf < 1.0, "{report:?}");
    }
}
