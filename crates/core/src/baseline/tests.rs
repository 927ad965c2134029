//! Baselines against planted answers.

use glam::DVec3;

use super::*;
use crate::measure::{PatchOptions, patch};
use crate::mesh::shapes;
use crate::planted::mesh;
use crate::progress::Silent;

fn places(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> Vec<DVec3> {
    points.iter().map(|p| mesh.locate(p)).collect()
}

fn smallest_distance(places: &[DVec3]) -> f64 {
    let mut smallest = f64::INFINITY;
    for (i, p) in places.iter().enumerate() {
        for q in &places[..i] {
            smallest = smallest.min(p.distance(*q));
        }
    }
    smallest
}

#[test]
fn counts_are_exact_and_points_lie_on_their_faces() {
    let sphere = mesh(&shapes::uv_sphere(20, 20));
    for method in Baseline::ALL {
        for count in [0, 1, 2, 17, 333] {
            for seed in [0, 1] {
                let points = method.place(&sphere, count, seed).expect("a sphere takes all of them");
                assert_eq!(points.len(), count, "{}", method.name());
                for point in points {
                    assert!(point.face.index() < sphere.face_count());
                    assert!(point.barycentric.iter().all(|&w| w >= 0.0), "{point:?}");
                    assert!((point.barycentric.iter().sum::<f64>() - 1.0).abs() < 1e-15);
                }
            }
        }
    }
}

#[test]
fn seeds_give_other_points_and_the_same_seed_the_same() {
    let sphere = mesh(&shapes::uv_sphere(12, 12));
    for method in Baseline::ALL {
        let place = |seed| method.place(&sphere, 50, seed).expect("a sphere takes all of them");
        assert_eq!(place(7), place(7));
        assert_ne!(place(7), place(8), "{}", method.name());
    }
}

#[test]
fn lattices_on_the_sphere_want_a_sphere() {
    let cube = mesh(&shapes::cube(4));
    for method in [Baseline::SphereHammersley, Baseline::SphereFibonacci] {
        let error = method.place(&cube, 10, 0).expect_err("a cube is no sphere");
        assert!((error.farthest - 0.75f64.sqrt()).abs() < 1e-15 && (error.nearest - 0.5).abs() < 1e-15);
    }
    // The corners of a cube alone lie on a sphere, and so do those of any triangle.
    for flat in [shapes::cube(1), shapes::square(1)] {
        assert!(Baseline::SphereFibonacci.place(&mesh(&flat), 10, 0).is_err());
    }
}

#[test]
fn lattices_are_projected_radially() {
    let sphere = mesh(&shapes::uv_sphere(40, 40));
    let directions = spherical_fibonacci(500);
    let points = Baseline::SphereFibonacci.place(&sphere, 500, 0).expect("a sphere");
    for (place, direction) in places(&sphere, &points).iter().zip(directions) {
        assert!(place.normalize().distance(direction) < 1e-12);
    }
}

#[test]
fn hilbert_points_fill_every_piece_of_the_row() {
    // One point for each of n equal pieces of the area: each face holds its share to within one point.
    let body = mesh(&shapes::scan_like(5, 400));
    let count = 2000;
    let mut held = vec![0.0; body.face_count()];
    for point in hilbert(&body, count, 3) {
        held[point.face.index()] += 1.0;
    }
    for (face, held) in body.topology().face_ids().zip(held) {
        let share = body.face_area(face) / body.area() * count as f64;
        assert!((held - share).abs() <= 1.0 + 1e-9, "{held} {share}");
    }
}

#[test]
fn hilbert_is_far_better_than_random() {
    let body = mesh(&shapes::scan_like(5, 4000));
    let patches = |points: &[SurfacePoint]| patch(&body, points, &PatchOptions::default(), &Silent).mc;
    assert!(patches(&hilbert(&body, 1000, 0)) < 0.4);
    // The root mean square over patches that share their points scatters widely from set to set: the mean of 40
    // squares is within 0.35 of 1 (three of its standard errors).
    let mean = (0..40).map(|seed| patches(&random(&body, 300, seed))).map(|mc| mc * mc).sum::<f64>() / 40.0;
    assert!((mean - 1.0).abs() < 0.35, "{mean}");
}

#[test]
fn poisson_points_keep_their_distance() {
    let square = mesh(&shapes::square(8));
    let count = 400;
    let hexagonal = (2.0 / (3.0f64.sqrt() * count as f64)).sqrt();
    for seed in 0..3 {
        let points = poisson(&square, count, seed);
        // Yuksel's figures lie between 0.65 and 0.75 of the largest possible radius.
        let relative = smallest_distance(&places(&square, &points)) / hexagonal;
        assert!(relative > 0.6, "{relative}");
    }
}

#[test]
#[cfg(feature = "parallel")]
fn the_same_bits_on_any_number_of_threads() {
    let sphere = mesh(&shapes::uv_sphere(16, 16));
    for method in Baseline::ALL {
        let [one, two] = crate::planted::with_threads(|| method.place(&sphere, 700, 5));
        assert_eq!(one, two);
    }
}
