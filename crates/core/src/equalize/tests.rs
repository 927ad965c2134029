//! Planted answers for equalizing.

use glam::DVec3;

use super::{Cameras, EqualizeOptions, Equalized, ForViews, equalize};
use crate::baseline;
use crate::density::Density;
use crate::ids::StripId;
use crate::measure;
use crate::mesh::{CheckOptions, PolygonSoup, SurfaceMesh, shapes};
use crate::progress::Silent;
use crate::sample::SurfacePoint;

fn mesh(soup: &PolygonSoup) -> SurfaceMesh {
    SurfaceMesh::from_soup(soup, &CheckOptions::default()).expect("a shape is a surface").0
}

fn equalized(mesh: &SurfaceMesh, points: &[SurfacePoint], rounds: u32) -> Equalized {
    let strips = vec![StripId(0); mesh.face_count()];
    let options = EqualizeOptions { rounds, ..EqualizeOptions::default() };
    equalize(mesh, points, &strips, &Density::UNIFORM, &options, &Silent)
}

fn worst_share(cells: &[f64]) -> f64 {
    let mean = cells.iter().sum::<f64>() / cells.len() as f64;
    cells.iter().fold(0.0_f64, |m, c| m.max((c / mean - 1.0).abs()))
}

#[test]
fn cells_of_a_flat_square_are_equal() {
    for subdivisions in [1, 16] {
        let square = mesh(&shapes::square(subdivisions));
        for n in [1, 2, 7, 64, 500] {
            let result = equalized(&square, &baseline::random(&square, n, 1), 40);
            assert_eq!(result.points.len(), n);
            assert!((result.cells.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            assert!(worst_share(&result.cells) < 1e-3, "n {n}: {}", worst_share(&result.cells));
        }
    }
}

#[test]
fn one_and_two_points_find_their_optimum() {
    let square = mesh(&shapes::square(4));
    let one = equalized(&square, &baseline::random(&square, 1, 3), 40);
    assert!(square.locate(&one.points[0]).distance(DVec3::new(0.5, 0.5, 0.0)) < 1e-6);

    // Two equal cells of a 2 x 1 rectangle are its halves.
    let mut soup = shapes::square(8);
    for p in &mut soup.positions {
        p.x *= 2.0;
    }
    let rectangle = mesh(&soup);
    let two = equalized(&rectangle, &baseline::random(&rectangle, 2, 5), 60);
    let mut places: Vec<DVec3> = two.points.iter().map(|p| rectangle.locate(p)).collect();
    places.sort_by(|a, b| a.x.total_cmp(&b.x));
    for (place, x) in places.iter().zip([0.5, 1.5]) {
        assert!(place.distance(DVec3::new(x, 0.5, 0.0)) < 1e-2, "{place}");
    }
}

#[test]
fn both_sides_of_a_thin_plate_get_half() {
    let plate = mesh(&shapes::plate(12, 1e-3));
    for n in [20, 101, 400] {
        let result = equalized(&plate, &baseline::random(&plate, n, 2), 20);
        let above = result.points.iter().filter(|p| plate.face_normal(p.face).z > 0.5).count();
        let below = result.points.iter().filter(|p| plate.face_normal(p.face).z < -0.5).count();
        assert!(above.abs_diff(below) <= 1, "n {n}: {above} above, {below} below");
        assert!(above + below + 1 >= n);
    }
}

#[test]
fn two_points_of_a_thin_plate_stand_on_its_two_sides() {
    let plate = mesh(&shapes::plate(12, 1e-3));
    for seed in 0..5 {
        let result = equalized(&plate, &baseline::random(&plate, 2, seed), 5);
        let sum: f64 = result.points.iter().map(|p| plate.face_normal(p.face).z).sum();
        assert!(sum.abs() < 1e-9, "seed {seed}: {sum}");
    }
}

#[test]
fn planes_worth_few_points_get_their_share_to_within_one() {
    let stretched = |mut soup: PolygonSoup| {
        soup.positions.iter_mut().for_each(|p| *p *= DVec3::new(1.0, 5.0, 20.0));
        soup
    };
    let areas = [100.0, 20.0, 5.0];
    for k in [1, 4] {
        let bar = mesh(&stretched(shapes::cube(k)));
        for n in [3, 8, 20, 60, 150] {
            let result = equalized(&bar, &baseline::random(&bar, n, 4), 5);
            for (axis, area) in areas.iter().enumerate() {
                let due = n as f64 * area / 250.0;
                for side in [-1.0, 1.0] {
                    let is_there = |p: &&SurfacePoint| bar.face_normal(p.face)[axis] * side > 0.5;
                    let count = result.points.iter().filter(is_there).count();
                    // Planes that are due less than half a point share what they are due together.
                    assert!(
                        (count as f64 - due).abs() < 1.0 + 1e-3,
                        "n {n} axis {axis} side {side}: {count} for {due}"
                    );
                }
            }
        }
    }
}

/// Halved again and again across its longest side a needle would fall into millions of tiles.
#[test]
fn needles_are_cut_across() {
    for height in [1e-3, 1e-6, 1e-9, 1e-12] {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.3, height, 0.0)];
        let mut soup = PolygonSoup { positions, ..PolygonSoup::default() };
        soup.push_polygon(&[0, 1, 2]);
        let needle = mesh(&soup);
        let result = equalized(&needle, &baseline::random(&needle, 300, 1), 5);
        assert!(result.report.spread_after < 0.02, "height {height}: {:?}", result.report);
        // Along the needle a share x (x / 0.3) lies before x up to 0.3: half of the points lie before 0.4084.
        let before = result.points.iter().filter(|p| needle.locate(p).x < 1.0 - libm::sqrt(0.35)).count();
        assert!(before.abs_diff(150) <= 1, "height {height}: {before}");
    }
}

#[test]
fn every_plane_of_a_cube_gets_its_share() {
    let cube = mesh(&shapes::cube(3));
    for n in [50, 100, 601] {
        let result = equalized(&cube, &baseline::random(&cube, n, 4), 20);
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let count =
                    result.points.iter().filter(|p| cube.face_normal(p.face)[axis] * side > 0.5).count();
                assert!(
                    (count as f64 - n as f64 / 6.0).abs() <= 1.0,
                    "n {n} axis {axis} side {side}: {count}"
                );
            }
        }
    }
}

#[test]
fn components_get_their_share() {
    // Spheres of area ratio 1 : 4 : 9 apart from each other.
    let mut soup = PolygonSoup::default();
    for (k, radius) in [1.0, 2.0, 3.0].into_iter().enumerate() {
        let sphere = shapes::uv_sphere(16, 12);
        let base = soup.positions.len() as u32;
        soup.positions
            .extend(sphere.positions.iter().map(|p| *p * radius + DVec3::new(10.0 * k as f64, 0.0, 0.0)));
        for polygon in 0..sphere.polygon_count() {
            let corners: Vec<u32> = sphere.polygon(polygon).iter().map(|c| c + base).collect();
            soup.push_polygon(&corners);
        }
    }
    let spheres = mesh(&soup);
    for n in [1, 2, 13, 140] {
        let result = equalized(&spheres, &baseline::random(&spheres, n, 6), 10);
        for (k, share) in [1.0, 4.0, 9.0].into_iter().enumerate() {
            let count =
                result.points.iter().filter(|p| ((spheres.locate(p).x / 10.0).round() as usize) == k).count();
            let due = n as f64 * share / 14.0;
            assert!((count as f64 - due).abs() <= 1.0, "n {n}, sphere {k}: {count} of {due}");
        }
    }
}

#[test]
fn equal_points_and_any_number_are_taken() {
    let cup = mesh(&shapes::uv_sphere(20, 20));
    let same = vec![baseline::random(&cup, 1, 1)[0]; 50];
    let result = equalized(&cup, &same, 20);
    assert!(worst_share(&result.cells) < 0.05, "{}", worst_share(&result.cells));
    for point in &result.points {
        assert!((point.barycentric.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(point.barycentric.iter().all(|w| *w >= 0.0));
    }
    assert!(equalized(&cup, &[], 5).points.is_empty());
}

#[test]
fn a_plate_keeps_its_points_apart() {
    // 2% of a distance of the points thick: centroids of cells on the two sides may fall together.
    let plate = mesh(&shapes::plate(12, 1e-3));
    for seed in 1..8 {
        let result = equalized(&plate, &baseline::random(&plate, 400, seed), 6);
        let ideal = (2.0 * plate.area() / (3.0_f64.sqrt() * 400.0)).sqrt();
        let places: Vec<DVec3> = result.points.iter().map(|p| plate.locate(p)).collect();
        let nearest = |i: usize| {
            let others = (0..places.len()).filter(|&j| j != i);
            others.map(|j| places[i].distance(places[j])).fold(f64::INFINITY, f64::min)
        };
        let least = (0..places.len()).map(nearest).fold(f64::INFINITY, f64::min);
        assert!(least > 0.5 * ideal, "seed {seed}: {:.3}", least / ideal);
    }
}

#[test]
fn weights_are_met() {
    // Density 3 : 1 on the halves of a square; and linear from 0 to 2 across it.
    let square = mesh(&shapes::square(16));
    let at = |p: &SurfacePoint| square.locate(p).x;
    let points = baseline::random(&square, 400, 1);
    let strips = vec![StripId(0); square.face_count()];
    let run = |density: &Density| {
        equalize(&square, &points, &strips, density, &EqualizeOptions::default(), &Silent)
    };

    let of_face = |face| if square.triangle(face).iter().all(|c| c.x <= 0.5) { 3.0 } else { 1.0 };
    let weights: Vec<f64> = square.topology().face_ids().map(of_face).collect();
    let halves = run(&Density::of_faces(&square, &weights).expect("weights of faces"));
    assert!(worst_share(&halves.cells) < 1e-3, "{}", worst_share(&halves.cells));
    let left = halves.points.iter().filter(|p| at(p) < 0.5).count();
    assert!(left.abs_diff(300) <= 6, "{left} of 300");

    let weights: Vec<f64> = square.positions().iter().map(|p| p.x).collect();
    let ramp = run(&Density::of_vertices(&square, &weights).expect("weights of vertices"));
    assert!(worst_share(&ramp.cells) < 1e-3, "{}", worst_share(&ramp.cells));
    for x in [0.25, 0.5, 0.75] {
        let below = ramp.points.iter().filter(|p| at(p) < x).count() as f64;
        assert!((below - 400.0 * x * x).abs() <= 8.0, "{below} below {x}");
    }
}

/// Root mean square error of the visible share over views that took no part.
fn view_error(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> f64 {
    let options = measure::ViewOptions { views: 64, occlusions: 0, nodes: 40_000, seed: 9 };
    let views = measure::Views::new(mesh, &options, &Silent);
    views.measure(mesh, points, &Silent).view.l2
}

#[test]
fn places_for_views_serve_views_that_took_no_part() {
    let knot = mesh(&shapes::trefoil(96, 12, 0.3));
    let strips = vec![StripId(0); knot.face_count()];
    let (mut before, mut after) = (0.0, 0.0);
    for seed in 1..=12 {
        let points = baseline::random(&knot, 80, seed);
        let run = |for_views| {
            let options = EqualizeOptions { for_views, ..EqualizeOptions::default() };
            equalize(&knot, &points, &strips, &Density::UNIFORM, &options, &Silent)
        };
        let (plain, placed) = (run(None), run(Some(ForViews { stay: Some(0.2), ..ForViews::default() })));
        before += view_error(&knot, &plain.points);
        after += view_error(&knot, &placed.points);
        assert_eq!(placed.cells, plain.cells, "each point stays in its cell");
    }
    // Before, they already face every way as the surface does and stand where there is room.
    assert!(after < 0.9 * before, "{after} after {before}");
}

#[test]
fn places_serve_the_cameras_that_were_asked_for() {
    let sphere = mesh(&shapes::uv_sphere(24, 24));
    let strips = vec![StripId(0); sphere.face_count()];
    let points = baseline::random(&sphere, 60, 1);
    let toward = DVec3::new(0.0, 1.0, 1.0);
    let run = |for_views| {
        let options = EqualizeOptions { for_views, ..EqualizeOptions::default() };
        equalize(&sphere, &points, &strips, &Density::UNIFORM, &options, &Silent).points
    };
    // Half of a sphere is seen from far away, whatever the direction.
    let error = |points: &[SurfacePoint]| {
        let mut sum = 0.0;
        for k in 0..40 {
            let (sin, cos) = libm::sincos(f64::from(k));
            let tilt = 0.25 * f64::from(k) / 40.0;
            let (right, up) = toward.normalize().any_orthonormal_pair();
            let from = toward.normalize() + (right * cos + up * sin) * tilt;
            let seen = points.iter().filter(|p| sphere.face_normal(p.face).dot(from) > 0.0).count();
            let error = seen as f64 / points.len() as f64 - 0.5;
            sum += error * error;
        }
        (sum / 40.0).sqrt()
    };
    let cameras = Cameras::Cone { toward, angle: 0.3, distance: None };
    let placed = run(Some(ForViews { cameras, stay: Some(0.05), views: Some(256), ..ForViews::default() }));
    let (before, after) = (error(&run(None)), error(&placed));
    assert!(after < 0.7 * before, "{after} after {before}");
}

/// Few points stand where all of them together do best, not each in the middle of its cell.
#[test]
fn few_points_have_little_energy() {
    let knot = mesh(&shapes::trefoil(48, 8, 0.3));
    // Next to the centroids they would have an eta of 0.76 and 0.83.
    for (n, least) in [(40, 0.85), (120, 0.9)] {
        let mut sum = 0.0;
        for seed in 1..=4 {
            let points = equalized(&knot, &baseline::random(&knot, n, seed), 5).points;
            sum += measure::energy(&knot, &points, &measure::EnergyOptions::default(), &Silent).eta;
        }
        assert!(sum / 4.0 > least, "n {n}: {}", sum / 4.0);
    }
}

/// As many points face every way as the share of the surface that does asks for: nearer than equal cells alone would have it.
#[test]
fn points_face_every_way_as_the_surface_does() {
    let knot = mesh(&shapes::trefoil(192, 24, 0.3));
    let (mut square, mut views) = (0.0, 0.0);
    for seed in 1..=4 {
        let points = equalized(&knot, &baseline::random(&knot, 150, seed), 5).points;
        for view in baseline::spherical_fibonacci(200) {
            let faces = |face: crate::ids::FaceId| knot.face_normal(face).dot(view) > 0.0;
            let area: f64 = knot.topology().face_ids().filter(|&f| faces(f)).map(|f| knot.face_area(f)).sum();
            let count = points.iter().filter(|p| faces(p.face)).count() as f64;
            let excess = count - 150.0 * area / knot.area();
            square += excess * excess;
            views += 1.0;
        }
    }
    // Standing next to the centroids they would be off by 7.4 points squared, 150 random ones by 37.
    assert!(square / views < 4.5, "{}", square / views);
}
