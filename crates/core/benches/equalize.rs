//! How long equalizing takes, on a mesh of 97,000 triangles.

mod common;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ldwrap::density::Density;
use ldwrap::equalize::{EqualizeOptions, ForViews, equalize};
use ldwrap::{Silent, StripId};

fn benchmarks(criterion: &mut Criterion) {
    let mesh = common::mesh();
    let mut group = criterion.benchmark_group("equalize");
    for count in [335, 1_000, 10_000, 100_000] {
        let (wrapped, points) = common::wrapped(&mesh, count);
        let strips: Vec<StripId> = wrapped.strips.places.iter().map(|p| p.strip).collect();
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

criterion_group! { name = benches; config = common::quick(); targets = benchmarks }
criterion_main!(benches);
