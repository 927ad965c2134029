//! Rays, sight and nearest points against planted answers and full searches.

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::geometry::triangle;
use crate::ids::FaceId;
use crate::mesh::{SurfaceMesh, shapes};
use crate::planted::{join, mesh, moved};

fn far(x: f64, y: f64, z: f64) -> Camera {
    Camera::Orthographic { toward: DVec3::new(x, y, z).normalize() }
}

/// The middle of each face.
fn middles(mesh: &SurfaceMesh) -> Vec<(FaceId, DVec3)> {
    mesh.topology()
        .face_ids()
        .map(|face| {
            let [a, b, c] = mesh.triangle(face);
            (face, (a + b + c) / 3.0)
        })
        .collect()
}

/// By looking at every face.
fn nearest_by_search(mesh: &SurfaceMesh, p: DVec3) -> f64 {
    mesh.topology()
        .face_ids()
        .map(|face| {
            let [a, b, c] = mesh.triangle(face);
            p.distance(triangle::at(a, b, c, triangle::nearest(a, b, c, p)))
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn a_cube_shows_the_faces_that_look_at_the_camera() {
    let cube = mesh(&shapes::cube(2));
    let caster = Caster::new(&cube);
    for (camera, sides) in [(far(0.0, 0.0, 1.0), 1), (far(1.0, 2.0, 0.0), 2), (far(-1.0, 2.0, 3.0), 3)] {
        let seen = middles(&cube).iter().filter(|(face, at)| caster.sees(&camera, *face, *at)).count();
        assert_eq!(seen * 6, sides * cube.face_count());
    }
    // An eye in front of one side sees that side alone, from the corner all three.
    for (eye, sides) in [(DVec3::new(0.5, 0.5, 9.0), 1), (DVec3::splat(1.5), 3)] {
        let camera = Camera::Perspective { eye };
        let seen = middles(&cube).iter().filter(|(face, at)| caster.sees(&camera, *face, *at)).count();
        assert_eq!(seen * 6, sides * cube.face_count());
    }
}

#[test]
fn a_plate_behind_a_plate_is_hidden() {
    let mut soup = shapes::square(3);
    join(&mut soup, &moved(shapes::square(3), |p| p + DVec3::new(0.0, 0.0, 1.0)));
    let plates = mesh(&soup);
    let caster = Caster::new(&plates);
    let seen = |camera: &Camera| -> Vec<bool> {
        middles(&plates).iter().map(|(face, at)| caster.sees(camera, *face, *at)).collect()
    };
    // Both plates are sheets: from above the upper one is seen, from below the lower one, from the side of the
    // light both in part.
    let from_above = seen(&far(0.0, 0.0, 1.0));
    let from_below = seen(&far(0.0, 0.0, -1.0));
    for (i, (face, at)) in middles(&plates).iter().enumerate() {
        assert!(caster.is_two_sided(*face));
        assert_eq!(from_above[i], at.z == 1.0);
        assert_eq!(from_below[i], at.z == 0.0);
    }
    // From (1, 0, 1) the upper plate covers the lower one from x = 1 on: nothing of it.
    assert!(seen(&far(1.0, 0.0, 1.0)).iter().all(|&s| s));
    // An eye between the plates sees both.
    assert!(seen(&Camera::Perspective { eye: DVec3::new(0.5, 0.5, 0.5) }).iter().all(|&s| s));
}

#[test]
fn sight_does_not_depend_on_units_and_far_origins() {
    let soup = shapes::torus(24, 12, 0.4);
    let plain = mesh(&soup);
    let caster = Caster::new(&plain);
    let camera = far(1.0, 0.3, 0.2);
    let seen: Vec<bool> = middles(&plain).iter().map(|(face, at)| caster.sees(&camera, *face, *at)).collect();
    assert!(seen.iter().any(|&s| s) && seen.iter().any(|&s| !s));
    for (scale, shift) in [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e6)] {
        let other = mesh(&moved(soup.clone(), |p| p * scale + shift));
        let caster = Caster::new(&other);
        let again: Vec<bool> =
            middles(&other).iter().map(|(face, at)| caster.sees(&camera, *face, *at)).collect();
        assert_eq!(seen, again, "{scale} {shift}");
    }
}

#[test]
fn the_tree_leaves_out_nothing() {
    // Every ray against every face, with arithmetic of its own: the side of each edge that the ray passes.
    let body = mesh(&shapes::scan_like(3, 600));
    let caster = Caster::new(&body);
    let pass = |a: DVec3, b: DVec3, from: DVec3, toward: DVec3| (a - from).cross(b - from).dot(toward);
    for camera in [far(1.0, 0.2, -0.4), far(-0.3, 1.0, 0.1), far(0.0, 0.0, 1.0), far(-0.0, -1.0, -1e-60)] {
        let Camera::Orthographic { toward } = camera else { unreachable!() };
        for (face, at) in middles(&body) {
            let blocked = body.topology().face_ids().filter(|&other| other != face).any(|other| {
                let [a, b, c] = body.triangle(other);
                let sides = [pass(a, b, at, toward), pass(b, c, at, toward), pass(c, a, at, toward)];
                let inside = sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0);
                let normal = body.face_normal(other);
                inside && (a - at).dot(normal) / toward.dot(normal) > 1e-6
            });
            assert_eq!(caster.is_clear(&camera, face, at), !blocked);
        }
    }
}

#[test]
fn many_places_at_once_are_seen_as_one_at_a_time() {
    let mut needles = shapes::uv_sphere(100, 6);
    join(&mut needles, &moved(shapes::block(DVec3::new(9.0, 0.01, 0.01), [1, 1, 1]), |p| p - 2.0));
    join(&mut needles, &moved(shapes::square(2), |p| p * 3.0 + DVec3::new(0.0, 0.0, 1.5)));
    let bodies =
        [needles, shapes::scan_like(8, 3000), shapes::trefoil(200, 8, 0.4), shapes::cube(1), shapes::cup(1)];
    for soup in bodies {
        let body = mesh(&soup);
        let caster = Caster::new(&body);
        let size = body.diagonal();
        let places: Vec<(FaceId, DVec3)> =
            crate::baseline::hilbert(&body, 20_000, 1).iter().map(|p| (p.face, body.locate(p))).collect();
        let eye = |x, y, z| Camera::Perspective { eye: DVec3::new(x, y, z) * size };
        let cameras = [
            far(0.0, 0.0, -1.0),
            far(1.0, 0.0, 0.0),
            far(0.3, -0.8, 0.4),
            eye(0.0, 0.0, 0.9),
            eye(1.0, -1.5, 0.7),
            eye(0.0, 0.1, 0.0),
        ];
        for camera in cameras {
            let at_once = caster.visible(&camera, &places);
            for (seen, (face, at)) in at_once.iter().zip(&places) {
                assert_eq!(*seen, caster.sees(&camera, *face, *at), "{camera:?} {face:?} {at}");
            }
            // From inside a closed body nothing is seen.
            let inside = matches!(camera, Camera::Perspective { eye } if eye.length() < 0.2 * size);
            assert!(inside || at_once.iter().any(|&seen| seen));
        }
    }
}

#[test]
fn rays_from_inside_meet_the_sphere_at_its_radius() {
    let ball = mesh(&shapes::uv_sphere(40, 40));
    let caster = Caster::new(&ball);
    for direction in crate::baseline::spherical_fibonacci(200) {
        let hit = caster.first_hit(DVec3::ZERO, direction * 3.0).expect("a closed body is hit");
        assert!(hit.distance > 0.99 && hit.distance <= 1.0 + 1e-12);
        assert!(ball.locate(&hit.point).distance(direction * hit.distance) < 1e-12);
    }
    assert_eq!(caster.first_hit(DVec3::new(0.0, 0.0, 2.0), DVec3::Z), None);
    let from_afar = caster.first_hit(DVec3::new(0.3, 0.2, 1e7), -DVec3::Z).expect("the ray comes down on it");
    let at = ball.locate(&from_afar.point);
    assert!(at.z > 0.9 && (at - DVec3::new(0.3, 0.2, at.z)).length() < 1e-6);
    assert!((from_afar.distance - (1e7 - at.z)).abs() < 1e-6);
}

#[test]
fn nearest_points_by_hand() {
    let cube = mesh(&shapes::cube(1));
    let places = [
        DVec3::new(0.25, 0.5, 3.0),
        DVec3::new(2.0, 2.0, 1.0),
        DVec3::new(0.9, 0.5, 0.5),
        DVec3::new(-1e9, 0.5, 0.5),
    ];
    let found = nearest(&cube, &places);
    let expected =
        [DVec3::new(0.25, 0.5, 1.0), DVec3::ONE, DVec3::new(1.0, 0.5, 0.5), DVec3::new(0.0, 0.5, 0.5)];
    for ((place, projected), expected) in places.iter().zip(&found).zip(expected) {
        // The exact distance of a place so far away is known to the rounding of its coordinates.
        let at = cube.locate(&projected.point);
        assert!(at.distance(expected) < 1e-6, "{place}: {at}");
        assert!((projected.distance - place.distance(expected)).abs() <= 1e-15 * (1.0 + place.length()));
    }
    let lost = nearest(&cube, &[DVec3::new(f64::NAN, 0.0, 0.0), DVec3::new(0.0, f64::INFINITY, 0.0)]);
    assert!(lost.iter().all(|p| !p.distance.is_finite()));
    assert!(nearest(&cube, &[]).is_empty());
}

#[test]
fn points_of_the_surface_stay_where_they_are() {
    let body = mesh(&shapes::scan_like(1, 500));
    let points = crate::baseline::random(&body, 500, 4);
    let places: Vec<DVec3> = points.iter().map(|p| body.locate(p)).collect();
    for (projected, place) in nearest(&body, &places).iter().zip(&places) {
        assert!(projected.distance < 1e-14);
        assert!(body.locate(&projected.point).distance(*place) < 1e-14);
    }
}

proptest! {
    #[test]
    fn nearest_is_what_a_full_search_finds(
        seed in 0u64..4,
        places in prop::collection::vec((-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64), 1..20),
        log_scale in -20i32..20,
    ) {
        let scale = f64::from(log_scale).exp2();
        let body = mesh(&moved(shapes::scan_like(seed, 200), |p| p * scale));
        let places: Vec<DVec3> = places.into_iter().map(|p| DVec3::from(p) * scale).collect();
        for (projected, place) in nearest(&body, &places).iter().zip(&places) {
            let slow = nearest_by_search(&body, *place);
            prop_assert!((projected.distance - slow).abs() <= 1e-12 * scale);
            prop_assert!((body.locate(&projected.point).distance(*place) - slow).abs() <= 1e-12 * scale);
        }
    }
}

#[test]
#[cfg(feature = "parallel")]
fn the_same_bits_on_any_number_of_threads() {
    let body = mesh(&shapes::scan_like(2, 900));
    let places: Vec<DVec3> = crate::baseline::random(&body, 2000, 1)
        .iter()
        .enumerate()
        .map(|(i, p)| body.locate(p) * (1.0 + 1e-3 * (i % 7) as f64))
        .collect();
    let [one, two] = crate::planted::with_threads(|| nearest(&body, &places));
    assert_eq!(one, two);
}
