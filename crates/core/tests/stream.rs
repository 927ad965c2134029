//! Points handed on in blocks are those that a run gives all at once.

use glam::DVec3;
use ldwrap::density::Density;
use ldwrap::equalize::EqualizeOptions;
use ldwrap::pipeline::{
    Options, OptionsError, Request, Run, SampleOrder, Selection, StreamError, run_into, run_weighted,
};
use ldwrap::sequence::Sequence;
use ldwrap::shapes::Shape;
use ldwrap::{CheckOptions, Progress, Sample, Silent, SurfaceMesh};

fn mesh(shape: Shape) -> SurfaceMesh {
    SurfaceMesh::from_soup(&shape.generate(), &CheckOptions::default()).expect("a surface").0
}

/// What was handed on, as a run, and how many blocks it were.
fn streamed(mesh: &SurfaceMesh, density: &Density, options: &Options) -> (Run, usize) {
    let mut samples: Vec<Sample> = Vec::new();
    let mut blocks = 0;
    let made = run_into(mesh, density, options, &Silent, |block| {
        blocks += 1;
        assert!(!block.samples.is_empty());
        samples.extend(block.samples);
        if samples.len() <= block.count { Ok(()) } else { Err(block.count) }
    })
    .expect("points");
    assert_eq!(made.samples, samples.len());
    let run = Run {
        segmentation: made.segmentation,
        strips: made.strips,
        domain: made.domain,
        correction: made.correction,
        equalize: made.equalize,
        d_m: made.d_m,
        tolerance: made.tolerance,
        samples,
    };
    (run, blocks)
}

#[track_caller]
fn same(mesh: &SurfaceMesh, density: &Density, options: &Options) -> usize {
    let (found, blocks) = streamed(mesh, density, options);
    let expected = run_weighted(mesh, density, options, &Silent).expect("points");
    assert!(found.samples == expected.samples, "{options:?}");
    assert_eq!(found.correction, expected.correction);
    assert_eq!((found.d_m, found.tolerance), (expected.d_m, expected.tolerance));
    assert_eq!(found.equalize, expected.equalize);
    // What is projected can be counted by itself.
    let projected = found.samples.iter().filter(|s| s.origin == ldwrap::Origin::Projected).count();
    assert_eq!(projected, found.correction.projected);
    blocks
}

#[test]
fn blocks_are_the_points_of_a_run() {
    let mesh = mesh(Shape::Cup);
    let weights: Vec<f64> = (0..mesh.face_count()).map(|f| (f % 5) as f64).collect();
    let weighted = Density::of_faces(&mesh, &weights).expect("weights");
    let extensible = Sequence::Halton { bases: [2, 3] };
    for selection in [Selection::Regions, Selection::Sequence, Selection::Extensible] {
        let sequence = if selection == Selection::Extensible { extensible } else { Sequence::default() };
        for density in [&Density::UNIFORM, &weighted] {
            for request in [Request::Count(1), Request::Count(300_000), Request::Spacing(0.01)] {
                let options = Options { request, selection, sequence, seed: 5, ..Options::default() };
                let blocks = same(&mesh, density, &options);
                assert_eq!(blocks > 1, request == Request::Count(300_000), "{options:?}");
            }
        }
    }
}

#[test]
fn what_needs_all_points_hands_them_on_too() {
    let mesh = mesh(Shape::Torus);
    let equalize = Some(EqualizeOptions::default());
    for order in [SampleOrder::Sequence, SampleOrder::Progressive] {
        same(&mesh, &Density::UNIFORM, &Options { equalize, order, ..Options::for_count(700) });
        same(&mesh, &Density::UNIFORM, &Options { equalize: None, order, ..Options::for_count(700) });
    }
    // Weights that leave almost nothing: points along a curve.
    let mut weights = vec![0.0; mesh.face_count()];
    weights[7] = 1.0;
    let speck = Density::of_faces(&mesh, &weights).expect("weights");
    same(&mesh, &speck, &Options { request: Request::Count(200_000), ..Options::default() });
}

#[test]
fn blocks_are_in_the_order_of_the_sequence() {
    let mesh = mesh(Shape::Sphere);
    let sequence = Sequence::Hammersley { base: 2 };
    let options = Options { request: Request::Count(400_000), sequence, ..Options::default() };
    let mut last = f64::NEG_INFINITY;
    let mut blocks = Vec::new();
    run_into(&mesh, &Density::UNIFORM, &options, &Silent, |block| {
        // The first coordinate of a Hammersley point is its number over all.
        let all_rise = block.samples.iter().all(|s| {
            let rises = s.place.x >= last;
            last = s.place.x;
            rises
        });
        blocks.push(block.samples.len());
        if all_rise { Ok(()) } else { Err("a point before its turn") }
    })
    .expect("in order");
    assert_eq!(blocks.iter().sum::<usize>(), 400_000);
    assert!(blocks.len() >= 3 && blocks.iter().all(|&b| b < 140_000), "{blocks:?}");
}

#[test]
fn no_points_are_one_empty_block() {
    let mesh = mesh(Shape::Cube);
    let far = mesh.diagonal() * 1e3;
    let options = Options { request: Request::Spacing(far), ..Options::default() };
    let expected = run_weighted(&mesh, &Density::UNIFORM, &options, &Silent).expect("a run").samples.len();
    let mut heard = Vec::new();
    let made = run_into(&mesh, &Density::UNIFORM, &options, &Silent, |block| {
        heard.push((block.samples.len(), block.count));
        Ok::<(), ()>(())
    });
    assert_eq!(made.expect("a run").samples, expected);
    assert_eq!(heard, [(expected, expected)]);
}

#[test]
fn a_sink_that_fails_stops_the_run_with_its_error() {
    let mesh = mesh(Shape::Cube);
    let equalized = Options { order: SampleOrder::Progressive, ..Options::for_count(200) };
    for (options, most) in [
        (Options { request: Request::Count(500_000), ..Options::default() }, 2),
        (Options { request: Request::Count(500_000), ..Options::default() }, 0),
        (equalized, 0),
    ] {
        let mut calls = 0;
        let failed = run_into(&mesh, &Density::UNIFORM, &options, &Silent, |_| {
            calls += 1;
            if calls > most { Err("the disk is full") } else { Ok(()) }
        });
        assert_eq!(failed.map(|made| made.samples), Err(StreamError::Sink("the disk is full")));
        assert_eq!(calls, most + 1);
    }
}

#[test]
fn errors_come_before_any_block() {
    let mesh = mesh(Shape::Cube);
    let options = Options { tolerance: -1.0, ..Options::default() };
    let refused = run_into(&mesh, &Density::UNIFORM, &options, &Silent, |_| -> Result<(), DVec3> {
        panic!("a block of points that cannot be made")
    });
    let expected = run_weighted(&mesh, &Density::UNIFORM, &options, &Silent).expect_err("refused");
    assert_eq!(refused.map(|made| made.samples), Err(StreamError::Options(expected)));
}

/// Cancels once a block was taken.
struct Once(std::sync::atomic::AtomicBool);

impl Progress for Once {
    fn begin(&self, _: &'static str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn is_cancelled(&self) -> bool {
        self.0.load(std::sync::atomic::Ordering::Relaxed)
    }
}

#[test]
fn a_run_can_be_cancelled_between_blocks() {
    let mesh = mesh(Shape::Cube);
    let options = Options { request: Request::Count(500_000), ..Options::default() };
    let progress = Once(false.into());
    let mut calls = 0;
    let cancelled = run_into(&mesh, &Density::UNIFORM, &options, &progress, |_| {
        calls += 1;
        progress.0.store(true, std::sync::atomic::Ordering::Relaxed);
        Ok::<(), ()>(())
    });
    assert_eq!(cancelled.map(|made| made.samples), Err(StreamError::Options(OptionsError::Cancelled)));
    assert_eq!(calls, 1);
}
