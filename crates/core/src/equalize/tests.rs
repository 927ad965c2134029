//! Planted answers for equalizing.

use glam::DVec3;

use super::{EqualizeOptions, Equalized, equalize};
use crate::baseline;
use crate::density::Density;
use crate::ids::StripId;
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
