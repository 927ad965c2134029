//! Whole runs: every mesh and shape, every kind of request, what cannot be met, progress and cancelling.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec3, dvec3};
use ldwrap::equalize::EqualizeOptions;
use ldwrap::pipeline::{Options, OptionsError, Request, Run, run};
use ldwrap::segment::SegmentOptions;
use ldwrap::sequence::Sequence;
use ldwrap::shapes::{self, Shape};
use ldwrap::{Origin, PolygonSoup, Progress, Silent, SurfaceMesh};
use ldwrap_tests::{Named, check_samples, check_segmentation, check_strips, mesh, real_meshes, shapes_about};

fn found(mesh: &SurfaceMesh, options: &Options) -> Run {
    run(mesh, options, &Silent).expect("the options can be met")
}

fn of_count(n: usize) -> Options {
    Options { request: Request::Count(n), ..Options::default() }
}

/// Runs with and without equalizing, and checks every stage's value.
fn check_whole(name: &str, mesh: &SurfaceMesh, n: usize) {
    let wrapped = found(mesh, &of_count(n));
    check_segmentation(name, mesh, &wrapped.segmentation);
    check_strips(name, mesh, &wrapped.segmentation, &wrapped.strips);
    check_samples(name, mesh, &wrapped.strips, &wrapped.domain, &wrapped.samples);
    assert_eq!(wrapped.samples.len(), n, "{name}");
    assert!((wrapped.d_m - (mesh.area() / n as f64).sqrt()).abs() <= 1e-12 * wrapped.d_m, "{name}");
    assert!(
        wrapped.equalize.is_none() && wrapped.samples.iter().all(|s| s.origin != Origin::Equalized),
        "{name}"
    );

    let options = EqualizeOptions { rounds: 3, spread_before: true, ..EqualizeOptions::default() };
    let equalized = found(mesh, &Options { equalize: Some(options), ..of_count(n) });
    check_samples(name, mesh, &equalized.strips, &equalized.domain, &equalized.samples);
    assert_eq!(equalized.samples.len(), n, "{name}");
    let projected = |run: &Run| run.samples.iter().filter(|s| s.origin == Origin::Projected).count();
    assert_eq!(
        [&wrapped, &equalized].map(projected),
        [&wrapped, &equalized].map(|r| r.correction.projected),
        "{name}"
    );
    let report = equalized.equalize.expect("it was asked for");
    assert!(report.moved.is_finite() && report.spread_after.is_finite(), "{name}: {report:?}");
    let before = report.spread_before.expect("it was asked for");
    assert!(report.spread_after <= before + 1e-9, "{name}: {report:?}");
}

/// What equalizing promises, on every mesh at hand and for several seeds: cells of the same area.
#[test]
fn cells_of_real_meshes_are_equal() {
    let meshes = real_meshes();
    for Named { name, mesh } in &meshes {
        for (n, seed) in [(335, 1), (335, 2), (335, 3), (335, 4), (335, 5), (1000, 1), (1000, 2)] {
            let options = Options { seed, equalize: Some(EqualizeOptions::default()), ..of_count(n) };
            let report = found(mesh, &options).equalize.expect("it was asked for");
            // Whole points for components do not fit their areas exactly.
            let components = mesh.topology().components().count;
            let most = if components == 1 { 1e-3 } else { 0.15 };
            assert!(report.spread_after <= most, "{name}, n {n}, seed {seed}: {report:?}");
        }
    }
}

/// Cells as large as limbs: a step of Newton's method for their weights is too long now and then, and must be halved.
#[test]
fn large_cells_of_real_meshes_are_equal() {
    for Named { name, mesh } in &real_meshes() {
        if mesh.topology().components().count > 1 {
            continue;
        }
        for seed in 1..=12 {
            let options = Options { seed, equalize: Some(EqualizeOptions::default()), ..of_count(56) };
            let report = found(mesh, &options).equalize.expect("it was asked for");
            assert!(report.spread_after <= 0.002, "{name}, seed {seed}: {report:?}");
        }
    }
}

#[test]
fn all_shapes() {
    for Named { name, mesh } in shapes_about(3_000) {
        for n in [1, 50, 400] {
            check_whole(&name, &mesh, n);
        }
    }
}

#[test]
fn all_meshes() {
    for Named { name, mesh } in real_meshes() {
        check_whole(&name, &mesh, 335);
    }
}

#[test]
fn all_sequences() {
    let mesh = mesh(&Shape::Drink.generate());
    let sequences = [
        Sequence::Hammersley { base: 2 },
        Sequence::Hammersley { base: 3 },
        Sequence::Halton { bases: [2, 3] },
        Sequence::Halton { bases: [5, 7] },
        Sequence::Sobol { seed: 1 },
        Sequence::R2,
        Sequence::Fibonacci,
    ];
    for sequence in sequences {
        let made = found(&mesh, &Options { sequence, seed: 9, ..of_count(200) });
        assert_eq!(made.samples.len(), 200, "{sequence:?}");
        check_samples("drink", &mesh, &made.strips, &made.domain, &made.samples);
    }
}

#[test]
fn density_and_spacing_ask_for_the_same() {
    for Named { name, mesh } in shapes_about(1_000) {
        let d_m = (mesh.area() / 2_000.0).sqrt();
        let spacing = found(&mesh, &Options { request: Request::Spacing(d_m), ..Options::default() });
        let density = Request::Density(1.0 / (d_m * d_m));
        let density = found(&mesh, &Options { request: density, ..Options::default() });
        assert!((density.d_m - d_m).abs() <= 1e-12 * d_m && spacing.d_m == d_m, "{name}");
        // The number is met as far as strips in the plane can: not exactly.
        let (a, b) = (spacing.samples.len() as f64, density.samples.len() as f64);
        assert!((a - b).abs() <= 20.0 && (a - 2_000.0).abs() <= 100.0, "{name}: {a}, {b}");
    }
}

#[test]
fn irregularity_is_met() {
    for Named { name, mesh } in shapes_about(1_000) {
        for most in [2.0, 0.5] {
            let made = found(&mesh, &Options { request: Request::Irregularity(most), ..Options::default() });
            let r = made.irregularity();
            assert!(r.bound <= most, "{name}: {r:?}");
            assert!(!made.samples.is_empty(), "{name}");
        }
    }
}

#[test]
fn what_cannot_be_met_is_refused() {
    let mesh = mesh(&Shape::Cube.generate());
    let refused = |options: Options, name: &str| match run(&mesh, &options, &Silent) {
        Err(OptionsError::OutOfRange { name: found, .. }) => assert_eq!(found, name),
        other => panic!("{name}: {:?}", other.map(|r| r.samples.len())),
    };
    let asking = |request| Options { request, ..Options::default() };
    refused(asking(Request::Count(0)), "count");
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused(asking(Request::Density(value)), "density");
        refused(asking(Request::Spacing(value)), "spacing");
        refused(asking(Request::Irregularity(value)), "irregularity");
    }
    for value in [-0.1, 1.1, f64::NAN] {
        refused(Options { tolerance: value, ..Options::default() }, "tolerance");
        let segment = SegmentOptions { smallest_share: value, ..SegmentOptions::default() };
        refused(Options { segment, ..Options::default() }, "smallest share");
    }
    for value in [-0.1, 3.2, f64::NAN] {
        let segment = SegmentOptions { flatness_angle: value, ..SegmentOptions::default() };
        refused(Options { segment, ..Options::default() }, "flatness angle");
    }
    let sequence = Sequence::Halton { bases: [2, 4] };
    let error = run(&mesh, &Options { sequence, ..Options::default() }, &Silent).map(|r| r.d_m);
    assert!(matches!(error, Err(OptionsError::Sequence(_))), "{error:?}");
    for request in [Request::Count(1 << 40), Request::Density(1e30), Request::Spacing(1e-30)] {
        let error = run(&mesh, &asking(request), &Silent).map(|r| r.d_m);
        assert!(matches!(error, Err(OptionsError::TooMany { .. })), "{request:?}: {error:?}");
    }
}

/// Writes down the stages and cancels when so many have begun.
struct Diary {
    stages: Mutex<Vec<&'static str>>,
    left: AtomicUsize,
}

impl Diary {
    fn until(stages: usize) -> Self {
        Self { stages: Mutex::new(Vec::new()), left: AtomicUsize::new(stages) }
    }
}

impl Progress for Diary {
    fn begin(&self, stage: &'static str, _: u64) {
        self.stages.lock().expect("a lock").push(stage);
        self.left.fetch_sub(1, Ordering::SeqCst);
    }

    fn advance(&self, _: u64) {}

    fn is_cancelled(&self) -> bool {
        self.left.load(Ordering::SeqCst) == 0
    }
}

#[test]
fn stages_are_told_and_each_can_be_cancelled() {
    let mesh = mesh(&Shape::Sphere.generate());
    let options = Options { equalize: Some(EqualizeOptions::default()), ..of_count(50) };
    let all = Diary::until(usize::MAX);
    assert!(run(&mesh, &options, &all).is_ok());
    let mut told = all.stages.into_inner().expect("a lock");
    told.dedup();
    assert_eq!(told, ["segment", "unfold", "wrap", "equalize"]);
    for stages in 1..=told.len() {
        let diary = Diary::until(stages);
        let error = run(&mesh, &options, &diary).map(|r| r.d_m);
        assert_eq!(error, Err(OptionsError::Cancelled), "while {}", told[stages - 1]);
        assert_eq!(diary.stages.into_inner().expect("a lock").len(), stages, "nothing begins after that");
    }
}

fn join(soup: &mut PolygonSoup, other: &PolygonSoup, at: DVec3, scale: f64) {
    let first = soup.positions.len() as u32;
    soup.positions.extend(other.positions.iter().map(|&p| p * scale + at));
    for polygon in 0..other.polygon_count() {
        let corners: Vec<u32> = other.polygon(polygon).iter().map(|c| c + first).collect();
        soup.push_polygon(&corners);
    }
}

#[test]
fn hundreds_of_components() {
    let mut soup = PolygonSoup::default();
    for i in 0..300u32 {
        let at = dvec3(f64::from(i % 20), f64::from(i / 20), 0.0) * 4.0;
        join(&mut soup, &shapes::tetrahedron(), at, 1.0);
    }
    let mesh = mesh(&soup);
    for n in [1, 10, 1_000] {
        check_whole("tetrahedra", &mesh, n);
    }
}

#[test]
fn a_grain_beside_a_mountain() {
    let mut soup = shapes::scan_like(3, 2_000);
    join(&mut soup, &shapes::cube(2), dvec3(3.0, 0.0, 0.0), 1e-7);
    check_whole("grain", &mesh(&soup), 100);
}

#[test]
fn far_from_the_origin_and_in_any_unit() {
    let soup = shapes::scan_like(4, 1_000);
    for (scale, at) in [(1e-50, 0.0), (1e50, 0.0), (1.0, 1e6), (1e-3, 1e3)] {
        let mut there = PolygonSoup::default();
        join(&mut there, &soup, DVec3::splat(at), scale);
        check_whole(&format!("times {scale} at {at}"), &mesh(&there), 60);
    }
}

#[test]
fn needles_and_one_triangle() {
    let mut soup = PolygonSoup::default();
    soup.positions.extend([dvec3(0.0, 0.0, 0.0), dvec3(1.0, 0.0, 0.0), dvec3(0.5, 1e-3, 0.0)]);
    soup.push_polygon(&[0, 1, 2]);
    check_whole("one needle", &mesh(&soup), 20);
    // A strip of needles as long as 1,000 times their width, folded in zigzag.
    let mut soup = PolygonSoup::default();
    for i in 0..20u32 {
        let (y, z) = (f64::from(i) * 1e-3, if i % 2 == 0 { 0.0 } else { 1e-3 });
        soup.positions.extend([dvec3(0.0, y, z), dvec3(1.0, y, z)]);
    }
    for i in 0..19u32 {
        soup.push_polygon(&[2 * i, 2 * i + 1, 2 * i + 3]);
        soup.push_polygon(&[2 * i, 2 * i + 3, 2 * i + 2]);
    }
    check_whole("needles", &mesh(&soup), 30);
}

#[test]
fn a_moebius_band() {
    let mut soup = PolygonSoup::default();
    let segments = 60u32;
    for i in 0..segments {
        let angle = f64::from(i) / f64::from(segments) * std::f64::consts::TAU;
        for side in [-0.3, 0.3] {
            let out = 1.0 + side * (0.5 * angle).cos();
            soup.positions.push(dvec3(out * angle.cos(), out * angle.sin(), side * (0.5 * angle).sin()));
        }
    }
    for i in 0..segments {
        let (a, b) = (2 * i, 2 * i + 1);
        // The band closes with its sides exchanged.
        let (c, d) = if i + 1 == segments { (1, 0) } else { (2 * i + 2, 2 * i + 3) };
        soup.push_polygon(&[a, c, d, b]);
    }
    check_whole("moebius", &mesh(&soup), 100);
}

#[test]
fn large_faces_are_spread_over_as_small_ones_are() {
    for shape in [Shape::Tetrahedron, Shape::Cube] {
        let mesh = mesh(&shape.generate());
        for n in [100, 1_000] {
            let points: Vec<_> = found(&mesh, &of_count(n)).points().collect();
            let eta = ldwrap::measure::energy(&mesh, &points, &Default::default(), &Silent).eta;
            assert!(eta > 0.3, "{shape:?}, n = {n}: {eta}");
        }
    }
}

#[test]
fn a_jump_of_the_density_keeps_the_points_on_its_sides() {
    let mesh = mesh(&shapes::square(10));
    let weights: Vec<f64> = mesh
        .topology()
        .face_ids()
        .map(|face| mesh.triangle(face).iter().map(|p| p.x).sum::<f64>())
        .map(|x| if x > 1.5 * (mesh.bounds().0.x + mesh.bounds().1.x) { 100.0 } else { 1.0 })
        .collect();
    let density = ldwrap::density::Density::of_faces(&mesh, &weights).unwrap();
    let masses = density.face_masses(&mesh);
    let light = |face: ldwrap::FaceId| weights[face.index()] == 1.0;
    let share: f64 = mesh.topology().face_ids().filter(|f| light(*f)).map(|f| masses[f.index()]).sum::<f64>()
        / masses.iter().sum::<f64>();
    for n in [50, 335, 1_000] {
        let options = Options { equalize: Some(EqualizeOptions::default()), ..of_count(n) };
        let run = ldwrap::pipeline::run_weighted(&mesh, &density, &options, &Silent).unwrap();
        let count = run.samples.iter().filter(|s| light(s.point.face)).count() as f64;
        let due = share * n as f64;
        assert!((count - due).abs() <= 2.0 + 0.5 * due, "n = {n}: {count} of {due}");
    }
}
