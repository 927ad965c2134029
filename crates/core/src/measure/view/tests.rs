//! Views whose visible shares are known.

use glam::DVec3;

use super::*;
use crate::baseline::{Baseline, hilbert, random};
use crate::mesh::shapes;
use crate::planted::{join, mesh, moved, turn};
use crate::progress::Silent;

fn options(views: usize, nodes: usize) -> ViewOptions {
    ViewOptions { views, nodes, ..ViewOptions::default() }
}

/// The visible shares of the area from the orthographic and from the perspective cameras.
fn shares(views: &Views) -> (Vec<f64>, Vec<f64>) {
    let (mut orthographic, mut perspective) = (Vec::new(), Vec::new());
    for (camera, share) in views.cameras().zip(views.visible_areas()) {
        match camera {
            Camera::Orthographic { .. } => orthographic.push(share),
            Camera::Perspective { .. } => perspective.push(share),
        }
    }
    (orthographic, perspective)
}

#[test]
fn half_of_a_centrally_symmetric_convex_body_is_seen_from_afar() {
    for soup in
        [shapes::uv_sphere(20, 20), shapes::cube(3), shapes::block(DVec3::new(1.0, 5.0, 0.1), [1, 2, 1])]
    {
        let body = mesh(&soup);
        let views = Views::new(&body, &options(40, 2000), &Silent);
        let (orthographic, perspective) = shares(&views);
        assert_eq!((orthographic.len(), perspective.len()), (20, 20));
        for share in orthographic {
            assert!((share - 0.5).abs() < 1e-12, "{share}");
        }
        assert!(perspective.iter().all(|&share| share > 0.0 && share < 0.5 + 1e-12));
        // Nothing of a convex body is hidden: the visible area is exact.
        assert_eq!(views.measure(&body, &[], &Silent).reference_error, 0.0);
    }
}

#[test]
fn near_eyes_see_a_cap_of_the_sphere() {
    // From the distance k radii an eye sees the share (1 - 1/k) / 2; here k is 1.5, 2.5 or 4 times the radius of the
    // sphere around the box, sqrt(3).
    let body = mesh(&shapes::uv_sphere(120, 120));
    let (_, perspective) = shares(&Views::new(&body, &options(12, 100), &Silent));
    for (i, share) in perspective.iter().enumerate() {
        let distance = [1.5, 2.5, 4.0][i % 3] * 3.0f64.sqrt();
        assert!((share - 0.5 * (1.0 - 1.0 / distance)).abs() < 0.01, "{share} at {distance}");
    }
}

#[test]
fn sheets_are_seen_from_both_sides() {
    let sheet = mesh(&shapes::square(4));
    let (orthographic, perspective) = shares(&Views::new(&sheet, &options(10, 1000), &Silent));
    assert!(orthographic.iter().chain(&perspective).all(|&share| share == 1.0));
}

#[test]
fn two_spheres_in_line_hide_what_they_should() {
    // Two far spheres: seen from a random direction nothing is hidden; the mean over directions of the share of the
    // farther one's disc that is covered is known only to be small. In line, one hides the other.
    let mut soup = shapes::uv_sphere(24, 24);
    join(&mut soup, &moved(shapes::uv_sphere(24, 24), |p| p + DVec3::new(0.0, 0.0, 50.0)));
    let pair = mesh(&soup);
    let caster = Caster::new(&pair);
    let camera = Camera::Orthographic { toward: DVec3::Z };
    let seen = |points: &[SurfacePoint]| {
        points.iter().filter(|p| caster.sees(&camera, p.face, pair.locate(p))).count() as f64
            / points.len() as f64
    };
    // Of the lower sphere nothing, of the upper one half.
    assert!((seen(&hilbert(&pair, 20_000, 0)) - 0.25).abs() < 2e-3);
}

#[test]
fn the_reference_error_is_what_it_says() {
    // The same views with twenty times as many nodes are the truth.
    let body = mesh(&shapes::torus(60, 30, 0.4));
    let rough = Views::new(&body, &options(60, 2000), &Silent);
    let fine = Views::new(&body, &options(60, 60_000), &Silent);
    let errors = rough.visible_areas().zip(fine.visible_areas()).map(|(a, b)| a - b);
    let actual = root_mean_square(errors);
    let (stated, fine_stated) = (
        rough.measure(&body, &[], &Silent).reference_error,
        fine.measure(&body, &[], &Silent).reference_error,
    );
    assert!(actual > 0.6 * stated && actual < 1.6 * stated, "{actual} {stated}");
    assert!(fine_stated < 0.2 * stated);
    // And a finer reference changes what is measured by no more than it says.
    let points = random(&body, 200, 1);
    let (a, b) = (rough.measure(&body, &points, &Silent), fine.measure(&body, &points, &Silent));
    assert!(a.reference_error < 0.1 * a.view.l2);
    assert!((a.view.l2 / b.view.l2 - 1.0).abs() < 0.02, "{a:?} {b:?}");
    assert!((a.view_occluded.l2 / b.view_occluded.l2 - 1.0).abs() < 0.02);
}

#[test]
fn more_points_get_more_nodes_within_bounds() {
    let nodes = |count| ViewOptions::for_count(count).nodes;
    assert_eq!([0, 1, 1000, 10_000].map(nodes), [64_000, 64_000, 128_000, 800_000]);
    assert_eq!([50_000, 100_000, usize::MAX].map(nodes), [2_000_000, 4_000_000, 4_000_000]);
    let counts = (0..60).map(|k| 1usize << (k / 2) | 1 << (k / 3));
    assert!(counts.clone().zip(counts.skip(1)).all(|(a, b)| a > b || nodes(a) <= nodes(b)));
}

#[test]
fn a_blunt_reference_is_told() {
    let body = mesh(&shapes::torus(30, 15, 0.4));
    let points = hilbert(&body, 4000, 0);
    let sharp =
        |nodes| Views::new(&body, &options(32, nodes), &Silent).measure(&body, &points, &Silent).is_sharp();
    assert_eq!(sharp(500), [false, false]);
    assert_eq!(sharp(400_000), [true, true]);
}

#[test]
fn random_points_measure_as_random() {
    let body = mesh(&shapes::torus(40, 20, 0.4));
    let views = Views::new(&body, &options(64, 20_000), &Silent);
    let (mut plain, mut occluded) = (0.0, 0.0);
    for seed in 0..60 {
        let report = views.measure(&body, &random(&body, 100, seed), &Silent);
        plain += report.view.mc * report.view.mc / 60.0;
        occluded += report.view_occluded.mc * report.view_occluded.mc / 60.0;
    }
    // The views of one set hang together; the mean of 60 sets is within 0.25 of 1 (three standard errors).
    assert!((plain - 1.0).abs() < 0.25, "{plain}");
    assert!((occluded - 1.0).abs() < 0.25, "{occluded}");
}

#[test]
fn better_points_measure_better_and_clumped_ones_worse() {
    let ball = mesh(&shapes::uv_sphere(40, 40));
    let views = Views::new(&ball, &options(64, 20_000), &Silent);
    let fibonacci = Baseline::SphereFibonacci.place(&ball, 500, 0).expect("a sphere");
    assert!(views.measure(&ball, &fibonacci, &Silent).view.mc < 0.2);
    assert!(views.measure(&ball, &fibonacci, &Silent).view_occluded.mc < 0.35);
    let clumped = vec![fibonacci[3]; 500];
    let report = views.measure(&ball, &clumped, &Silent);
    // A single place is seen in whole or not at all.
    assert!(report.view.mc > 15.0 && report.view.linf > 0.4, "{report:?}");
}

#[test]
fn occluders_hide_and_never_reveal() {
    let ball = mesh(&shapes::uv_sphere(30, 30));
    let views = Views::new(&ball, &options(32, 20_000), &Silent);
    let mut hidden = 0;
    for view in &views.views {
        assert_eq!(view.occluded_areas.len(), 2);
        for area in &view.occluded_areas {
            assert!(area.share <= view.area.share + 4.0 * area.error + 1e-3);
            hidden += usize::from(area.share < 0.9 * view.area.share);
        }
    }
    assert!(hidden > 16, "{hidden} of 64 views are hidden in part");
}

#[test]
fn scale_shift_and_order_do_not_matter() {
    let soup = shapes::torus(30, 15, 0.3);
    let body = mesh(&soup);
    let mut points = random(&body, 300, 2);
    let options = options(16, 3000);
    let report = view(&body, &points, &options, &Silent);
    points.reverse();
    assert_eq!(report, view(&body, &points, &options, &Silent));
    // A power of two moves no bit of a coordinate's digits.
    let large = mesh(&moved(soup.clone(), |p| p * 1024.0));
    let same = view(&large, &points, &options, &Silent);
    assert!((same.view.l2 - report.view.l2).abs() < 1e-12);
    assert!((same.view_occluded.l2 - report.view_occluded.l2).abs() < 1e-12);
    // A turn changes which directions are looked from, so only the mean over many of them stays.
    let turned = mesh(&moved(soup, |p| turn() * p + 3.0));
    let many = ViewOptions { views: 200, nodes: 3000, ..options };
    let (a, b) = (view(&body, &points, &many, &Silent), view(&turned, &points, &many, &Silent));
    assert!((a.view.l2 / b.view.l2 - 1.0).abs() < 0.2, "{} {}", a.view.l2, b.view.l2);
}

#[test]
#[cfg(feature = "parallel")]
fn the_same_bits_on_any_number_of_threads() {
    let body = mesh(&shapes::scan_like(1, 800));
    let points = random(&body, 200, 1);
    let [one, two] = crate::planted::with_threads(|| view(&body, &points, &options(16, 3000), &Silent));
    assert_eq!(one, two);
}
