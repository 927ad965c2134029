//! How long equalizing takes, and wrapping before it, on a scan of 97,000 triangles, the size of the paper's horse.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ldwrap::density::Density;
use ldwrap::equalize::{EqualizeOptions, ForViews, equalize};
use ldwrap::pipeline::{Options, Request, run};
use ldwrap::{CheckOptions, Silent, StripId, SurfaceMesh, SurfacePoint, shapes};

fn benchmarks(criterion: &mut Criterion) {
    let soup = shapes::scan_like(1, 97_000);
    let mesh = SurfaceMesh::from_soup(&soup, &CheckOptions::default()).expect("the shape is clean").0;
    let mut group = criterion.benchmark_group("equalize");
    group.sample_size(10);
    for count in [335, 1_000, 10_000, 100_000] {
        let options = Options { request: Request::Count(count), ..Options::default() };
        let wrapped = run(&mesh, &options, &Silent).expect("the options can be met");
        let points: Vec<SurfacePoint> = wrapped.samples.iter().map(|s| s.point).collect();
        let strips: Vec<StripId> = wrapped.strips.places.iter().map(|p| p.strip).collect();
        group.bench_with_input(BenchmarkId::new("wrap", count), &options, |b, options| {
            b.iter(|| black_box(run(&mesh, options, &Silent)));
        });
        let equalized = |options: EqualizeOptions| {
            equalize(&mesh, &points, &strips, &Density::UNIFORM, &options, &Silent)
        };
        group.bench_function(BenchmarkId::new("equalize", count), |b| {
            b.iter(|| black_box(equalized(EqualizeOptions::default())));
        });
        if count <= 1_000 {
            let for_views = Some(ForViews { views: Some(256), ..ForViews::default() });
            group.bench_function(BenchmarkId::new("for 256 views", count), |b| {
                b.iter(|| black_box(equalized(EqualizeOptions { for_views, ..EqualizeOptions::default() })));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, benchmarks);
criterion_main!(benches);
