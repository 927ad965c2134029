//! The examples of the library, run on small meshes: what they print and write is right.

use ldwrap::io::points::{Field, FieldData};
use ldwrap::shapes::{Shape, torus};
use ldwrap::{CheckOptions, PolygonSoup, SurfaceMesh};

#[allow(dead_code)]
#[path = "../crates/core/examples/integral.rs"]
mod integral;
#[allow(dead_code)]
#[path = "../crates/core/examples/limit.rs"]
mod limit;
#[allow(dead_code)]
#[path = "../crates/core/examples/point_cloud.rs"]
mod point_cloud;
#[allow(dead_code)]
#[path = "../crates/core/examples/stipple.rs"]
mod stipple;
#[allow(dead_code)]
#[path = "../crates/core/examples/surfels.rs"]
mod surfels;
#[allow(dead_code)]
#[path = "../crates/core/examples/visibility.rs"]
mod visibility;

fn mesh(soup: &PolygonSoup) -> SurfaceMesh {
    SurfaceMesh::from_soup(soup, &CheckOptions::default()).expect("a surface").0
}

fn reals<'a>(fields: &'a [Field], key: &str) -> &'a [f64] {
    match fields.iter().find(|field| field.key == key).map(|field| &field.data) {
        Some(FieldData::Real(values, _)) => values,
        _ => panic!("no field {key}"),
    }
}

#[test]
fn visible_shares_are_nearer_than_random_points_would_be() {
    let mesh = mesh(&torus(40, 16, 0.4));
    let count = 400;
    let seen = visibility::visible_shares(&mesh, count).expect("shares");
    assert_eq!(seen.len(), 16);
    let (mut square, mut random) = (0.0, 0.0);
    for visibility::Seen { points, area } in seen {
        // A closed surface shows at most half of itself to a camera far away, and the torus hides some of that.
        assert!((0.15..0.5).contains(&area), "{area}");
        square += (points - area).powi(2);
        random += area * (1.0 - area) / count as f64;
    }
    assert!(square < 0.25 * random, "{square} against {random}");
}

#[test]
fn the_integral_lies_within_its_error_bar() {
    let mesh = mesh(&Shape::Drink.generate());
    let function = |p: glam::DVec3| p.x * p.x + p.y * p.y;
    let exact = integral::integral_of_quadratic(&mesh, function);
    let found = integral::integrate(&mesh, 300, 8, function).expect("points");
    // Student's t with 7 degrees of freedom stays below 5.4 in 999 of 1,000 cases.
    assert!((found.mean - exact).abs() < 5.4 * found.standard_error);
    assert!((found.value - exact).abs() < found.scatter);
    assert!(found.scatter < 0.01 * exact, "{} of {exact}", found.scatter);
    // The integral of 1 is the area, whatever the points.
    let area = integral::integrate(&mesh, 50, 2, |_| 1.0).expect("points");
    assert!((area.value / mesh.area() - 1.0).abs() < 1e-12 && area.scatter < 1e-12 * mesh.area());
}

#[test]
fn clouds_fill_the_unit_ball_and_differ_by_seed() {
    let mesh = mesh(&torus(40, 16, 0.4));
    let clouds = [1, 2].map(|seed| point_cloud::cloud(&mesh, 256, seed).expect("a cloud"));
    assert_ne!(clouds[0], clouds[1]);
    for fields in &clouds {
        let (positions, normals) = (reals(fields, "position"), reals(fields, "normal"));
        assert_eq!((positions.len(), normals.len()), (3 * 256, 3 * 256));
        let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let farthest = positions.chunks(3).map(length).fold(0.0, f64::max);
        assert!((farthest - 1.0).abs() < 1e-12, "{farthest}");
        assert!(normals.chunks(3).all(|n| (length(n) - 1.0).abs() < 1e-12));
        for axis in 0..3 {
            let mean = positions.iter().skip(axis).step_by(3).sum::<f64>() / 256.0;
            assert!(mean.abs() < 1e-12, "{mean}");
        }
    }
}

#[test]
fn shadows_get_more_dots_than_light() {
    let dots = stipple::dots(&mesh(&Shape::Sphere.generate()), 2000).expect("dots");
    // Nothing hides what is turned towards the camera; facets at the rim are a little.
    assert!((1900..=2000).contains(&dots.len()), "{}", dots.len());
    // The light comes from the left of the camera: its half of the disc is the brighter one.
    let left = dots.iter().filter(|dot| dot.x < 0.0).count();
    assert!(3 * left < 2 * (dots.len() - left), "{left} of {}", dots.len());
}

#[test]
fn surfels_have_the_area_of_the_surface() {
    let mesh = mesh(&Shape::Cup.generate());
    let fields = surfels::surfels(&mesh, 500).expect("surfels");
    let radii = reals(&fields, "radius");
    let area: f64 = radii.iter().map(|r| std::f64::consts::PI * r * r).sum();
    assert!((area / mesh.area() - 1.0).abs() < 1e-9, "{area}");
    // Equalized points stand for about the same area each.
    let mean = (mesh.area() / 500.0 / std::f64::consts::PI).sqrt();
    assert!(radii.iter().all(|r| (0.7..1.3).contains(&(r / mean))));
}

/// Kendall's constant for the hexagonal lattice; and planes cut a sphere, at heights that are even, in circles of pi^2 / 2 in
/// the mean.
#[test]
fn limits_are_those_of_lattice_and_sphere() {
    use std::f64::consts::PI;

    assert!((limit::lattice() - 0.0717).abs() < 5e-4, "{}", limit::lattice());
    let sphere = mesh(&Shape::Sphere.generate());
    let [_, half_space] = limit::figures(&sphere, 4);
    let border = PI * PI / 2.0 / (4.0 * PI).sqrt();
    assert!((half_space.border / border - 1.0).abs() < 0.05, "{}", half_space.border);
    assert!((half_space.variance - 1.0 / 6.0).abs() < 0.002, "{}", half_space.variance);
}
