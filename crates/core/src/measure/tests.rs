//! What holds for every measure.

use glam::{DQuat, DVec3};

use crate::measure::testmesh::{self, random_points};
use crate::measure::{
    BallReport, ComponentReport, EnergyReport, HalfSpaceReport, IntegrationReport, Norms, SpacingReport,
    ball, components, energy, half_space, integration, patch, spacing, view,
};
use crate::mesh::SurfaceMesh;
use crate::progress::Silent;
use crate::sample::SurfacePoint;

/// The reports of all measures.
#[derive(Clone, Debug, PartialEq)]
struct All {
    energy: EnergyReport,
    half_space: HalfSpaceReport,
    ball: BallReport,
    patch: Norms,
    integration: IntegrationReport,
    spacing: SpacingReport,
    components: ComponentReport,
}

fn measure(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> All {
    All {
        energy: energy(mesh, points, &Default::default(), &Silent),
        half_space: half_space(mesh, points, &Default::default(), &Silent),
        ball: ball(mesh, points, &Default::default(), &Silent),
        patch: patch(mesh, points, &Default::default(), &Silent),
        integration: integration(mesh, points, &Default::default(), &Silent),
        spacing: spacing(mesh, points, &Default::default(), &Silent),
        components: components(mesh, points),
    }
}

fn close(x: f64, y: f64) -> bool {
    (x - y).abs() <= 1e-9 * x.abs().max(y.abs())
}

#[test]
#[cfg(feature = "parallel")]
fn same_bits_twice_and_with_any_number_of_threads() {
    use glam::DVec2;

    use crate::measure::decomposition::{Joints, part_discrepancy};
    use crate::measure::plane::{square_discrepancy, star_discrepancy};
    use crate::segment::{SegmentOptions, segment};
    use crate::sequence::Sequence;
    use crate::unfold::unfold;

    let mesh = testmesh::sphere(20);
    let points = random_points(&mesh, 3000, 1);
    let joints = Joints::of(&mesh, &unfold(&mesh, &segment(&mesh, &SegmentOptions::default())), 1e-3);
    let places: Vec<DVec2> = (0..3000).map(|i| Sequence::R2.point(i, 3000)).collect();
    let views = super::ViewOptions { views: 12, nodes: 4000, ..super::ViewOptions::default() };
    let patches = super::PatchOptions { seeds: 20, seed: 0 };
    let every = || {
        (
            measure(&mesh, &points),
            view(&mesh, &points, &views, &Silent),
            part_discrepancy(&mesh, &joints, &points, &patches, &Silent),
            star_discrepancy(&places),
            square_discrepancy(&places),
        )
    };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
        pool.install(every)
    };
    let once = run(1);
    assert_eq!(once, run(1));
    assert_eq!(once, run(2));
    assert_eq!(once, run(3));
}

#[test]
fn the_order_of_the_points_does_not_matter() {
    let mesh = testmesh::cube();
    let mut points = random_points(&mesh, 777, 2);
    let before = measure(&mesh, &points);
    points.reverse();
    points.rotate_left(100);
    let after = measure(&mesh, &points);
    assert_eq!(before.energy, after.energy);
    assert_eq!(before.half_space, after.half_space);
    assert_eq!(before.ball, after.ball);
    assert_eq!(before.patch, after.patch);
    assert_eq!(before.components, after.components);
    assert!(close(before.integration.rms, after.integration.rms));
    assert_eq!(before.spacing.min, after.spacing.min);
    assert_eq!(before.spacing.cover, after.spacing.cover);
    assert!(close(before.spacing.mean, after.spacing.mean));
}

#[test]
fn moving_turning_and_scaling_changes_nothing() {
    let mesh = testmesh::sphere(8);
    let points = random_points(&mesh, 500, 3);
    let before = measure(&mesh, &points);
    let turn = DQuat::from_xyzw(0.18, -0.5, 0.3, 0.7).normalize();
    let shift = DVec3::new(100.0, -2000.0, 30.0);
    let moved = testmesh::moved(&mesh, 37.5, turn, shift);
    let after = measure(&moved, &points);
    assert!(close(before.ball.norms.l2, after.ball.norms.l2), "{:?} {:?}", before.ball, after.ball);
    assert!(close(before.integration.rms, after.integration.rms));
    assert!(close(before.spacing.min, after.spacing.min) && close(before.spacing.mean, after.spacing.mean));
    assert!((before.spacing.cover / after.spacing.cover - 1.0).abs() <= 0.005);
    assert!(close(before.components.worst, after.components.worst));
    // Directions are fixed in space: other planes, the same mean within the stated error.
    let error = before.energy.relative_error.max(after.energy.relative_error) * 2.0f64.sqrt();
    assert!((before.energy.eta / after.energy.eta - 1.0).abs() < 4.0 * error);
    assert!((before.energy.discrepancy * 37.5 / after.energy.discrepancy - 1.0).abs() < 4.0 * error);
    assert!((before.half_space.norms.mc / after.half_space.norms.mc - 1.0).abs() < 0.05);
    // Scaling by a power of two and no turn is exact.
    let doubled = testmesh::moved(&mesh, 2.0, DQuat::IDENTITY, DVec3::ZERO);
    let doubled = measure(&doubled, &points);
    assert_eq!(doubled.energy.eta, before.energy.eta);
    assert_eq!(doubled.half_space.norms, before.half_space.norms);
    assert_eq!(doubled.ball.norms, before.ball.norms);
    assert_eq!(doubled.integration, before.integration);
}

/// The mean of squares, and the standard error of that mean.
fn mean_square(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let squares: Vec<f64> = values.map(|v| v * v).collect();
    let count = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / count;
    let variance = squares.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

#[test]
fn random_points_are_as_good_as_random() {
    for mesh in [testmesh::sphere(4), testmesh::cube()] {
        let reports: Vec<All> =
            (0..100).map(|seed| measure(&mesh, &random_points(&mesh, 150, 1000 + seed))).collect();
        let ratios = [
            ("energy", mean_square(reports.iter().map(|r| r.energy.mc))),
            ("half-space", mean_square(reports.iter().map(|r| r.half_space.norms.mc))),
            ("ball", mean_square(reports.iter().map(|r| r.ball.norms.mc))),
            ("patch", mean_square(reports.iter().map(|r| r.patch.mc))),
            ("integration", mean_square(reports.iter().map(|r| r.integration.mc))),
        ];
        for (name, (mean, error)) in ratios {
            assert!((mean - 1.0).abs() < 4.0 * error, "{name}: {mean} +- {error}");
            assert!(error < 0.1, "{name}: {error}");
        }
    }
}

#[test]
fn no_points_and_one_point_and_equal_points_are_no_trouble() {
    let mesh = testmesh::cube();
    let none = measure(&mesh, &[]);
    assert!(none.energy.eta.is_nan() && none.half_space.norms.l2.is_nan() && none.ball.norms.mc.is_nan());
    assert!(none.integration.rms.is_nan() && none.spacing.cover.is_nan());
    assert!(none.ball.worst.is_none() && none.half_space.worst.is_none());
    let one = random_points(&mesh, 1, 5);
    let single = measure(&mesh, &one);
    assert!(single.energy.mc.is_finite() && single.ball.norms.mc.is_finite());
    let equal = measure(&mesh, &vec![one[0]; 1000]);
    assert!(close(equal.energy.discrepancy, single.energy.discrepancy));
    assert_eq!(equal.ball.norms.l2, single.ball.norms.l2);
    assert!(equal.ball.norms.mc > 10.0);
}

#[test]
fn a_cancelled_measure_returns() {
    struct Cancelled;
    impl crate::Progress for Cancelled {
        fn begin(&self, _: &'static str, _: u64) {}
        fn advance(&self, _: u64) {}
        fn is_cancelled(&self) -> bool {
            true
        }
    }
    let mesh = testmesh::cube();
    let points = random_points(&mesh, 10, 5);
    energy(&mesh, &points, &Default::default(), &Cancelled);
    patch(&mesh, &points, &Default::default(), &Cancelled);
    view(&mesh, &points, &Default::default(), &Cancelled);
    half_space(&mesh, &points, &Default::default(), &Cancelled);
    ball(&mesh, &points, &Default::default(), &Cancelled);
    integration(&mesh, &points, &Default::default(), &Cancelled);
    spacing(&mesh, &points, &Default::default(), &Cancelled);
}

#[test]
#[cfg(feature = "json")]
fn reports_have_the_keys_that_users_read() {
    let mesh = testmesh::cube();
    let all = measure(&mesh, &random_points(&mesh, 20, 5));
    let json = |report: serde_json::Result<serde_json::Value>| report.expect("a report is plain data");
    let half_space = json(serde_json::to_value(all.half_space));
    let ball = json(serde_json::to_value(all.ball));
    for key in ["linf", "l1", "l2", "mc"] {
        assert!(half_space[key].is_f64() && ball[key].is_f64(), "{key}");
    }
    let energy = json(serde_json::to_value(all.energy));
    assert!(energy["eta"].is_f64() && energy["mc"].is_f64());
    let integration = json(serde_json::to_value(all.integration));
    assert!(integration["rms"].is_f64() && integration["mc"].is_f64());
    let spacing = json(serde_json::to_value(all.spacing));
    assert!(spacing["min"].is_f64() && spacing["mean"].is_f64() && spacing["cover"].is_f64());
}
