//! How long each stage takes: check, segment and unfold by the number of triangles; scatter, wrap, correct and the
//! irregularity by the number of points.

mod common;

use std::hint::black_box;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec2;
use ldwrap::correct::correct;
use ldwrap::domain::{DomainPoints, PlanarDomain};
use ldwrap::irregularity::irregularity;
use ldwrap::segment::segment;
use ldwrap::sequence::Sequence;
use ldwrap::unfold::unfold;
use ldwrap::wrap::wrap;
use ldwrap::{CheckOptions, SurfaceMesh};

fn of_triangles(criterion: &mut Criterion) {
    for (name, soup) in common::soups() {
        let mesh = common::checked(&soup);
        let segmentation = segment(&mesh, &Default::default());
        let strips = unfold(&mesh, &segmentation);
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(mesh.face_count() as u64));
        group.bench_function("check", |b| {
            b.iter(|| black_box(SurfaceMesh::from_soup(&soup, &CheckOptions::default())));
        });
        group.bench_function("segment", |b| b.iter(|| black_box(segment(&mesh, &Default::default()))));
        group.bench_function("unfold", |b| b.iter(|| black_box(unfold(&mesh, &segmentation))));
        group.bench_function("lay out", |b| b.iter(|| black_box(PlanarDomain::lay_out(&strips))));
        group.finish();
    }
}

fn of_points(criterion: &mut Criterion) {
    let mesh = common::mesh();
    let strips = unfold(&mesh, &segment(&mesh, &Default::default()));
    let domain = PlanarDomain::lay_out(&strips);
    let mut group = criterion.benchmark_group("points");
    for count in [1_000_u32, 10_000, 100_000, 1_000_000] {
        let d_m = (mesh.area() / f64::from(count)).sqrt();
        let scattered = (f64::from(count) * domain.room(mesh.area())) as u32;
        let sequence = Sequence::default();
        let scatter = || DomainPoints::scatter(&domain, &sequence, scattered, DVec2::ZERO);
        let points = scatter();
        let wrapping = wrap(&strips, &domain, &points);
        group.throughput(Throughput::Elements(u64::from(count)));
        group.bench_function(BenchmarkId::new("scatter", count), |b| b.iter(|| black_box(scatter())));
        group.bench_function(BenchmarkId::new("wrap", count), |b| {
            b.iter(|| black_box(wrap(&strips, &domain, &points)));
        });
        group.bench_function(BenchmarkId::new("correct", count), |b| {
            b.iter_batched(
                || wrapping.clone(),
                |wrapping| black_box(correct(&mesh, &strips, &domain, &points, wrapping, 0.1 * d_m)),
                BatchSize::LargeInput,
            );
        });
        group.bench_function(BenchmarkId::new("irregularity", count), |b| {
            b.iter(|| black_box(irregularity(&strips, d_m, 0.1 * d_m)));
        });
    }
    group.finish();
}

criterion_group! { name = stages; config = common::quick(); targets = of_triangles, of_points }
criterion_main!(stages);
