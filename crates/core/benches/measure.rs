//! How long each measure takes: 1,000 and 10,000 wrapped points on a mesh of 97,000 triangles.

mod common;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ldwrap::{Silent, measure};

fn measures(criterion: &mut Criterion) {
    let mesh = common::mesh();
    let mut group = criterion.benchmark_group("measure");
    for count in [1_000, 10_000] {
        let (_, points) = common::wrapped(&mesh, count);
        group.bench_with_input(BenchmarkId::new("energy", count), &points, |b, points| {
            b.iter(|| black_box(measure::energy(&mesh, points, &Default::default(), &Silent)));
        });
        group.bench_with_input(BenchmarkId::new("half_space", count), &points, |b, points| {
            b.iter(|| black_box(measure::half_space(&mesh, points, &Default::default(), &Silent)));
        });
        group.bench_with_input(BenchmarkId::new("ball", count), &points, |b, points| {
            b.iter(|| black_box(measure::ball(&mesh, points, &Default::default(), &Silent)));
        });
        group.bench_with_input(BenchmarkId::new("integration", count), &points, |b, points| {
            b.iter(|| black_box(measure::integration(&mesh, points, &Default::default(), &Silent)));
        });
        group.bench_with_input(BenchmarkId::new("patch", count), &points, |b, points| {
            b.iter(|| black_box(measure::patch(&mesh, points, &Default::default(), &Silent)));
        });
        let options = measure::ViewOptions::for_count(count);
        let views = measure::Views::new(&mesh, &options, &Silent);
        group.bench_with_input(BenchmarkId::new("view", count), &points, |b, points| {
            b.iter(|| black_box(views.measure(&mesh, points, &Silent)));
        });
        group.bench_with_input(BenchmarkId::new("spacing", count), &points, |b, points| {
            b.iter(|| black_box(measure::spacing(&mesh, points, &Default::default(), &Silent)));
        });
        group.bench_with_input(BenchmarkId::new("cell_areas", count), &points, |b, points| {
            b.iter(|| black_box(measure::cell_areas(&mesh, points)));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = common::quick(); targets = measures }
criterion_main!(benches);
