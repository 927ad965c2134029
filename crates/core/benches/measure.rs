//! How long each measure takes: 10,000 and 100,000 evenly placed points on a scan of 97,000 triangles, the size of
//! the paper's horse.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ldwrap::{CheckOptions, FaceId, Silent, SurfaceMesh, SurfacePoint, measure, shapes};

/// One point in each of `count` equal parts of the faces laid end to end by area.
fn spread(mesh: &SurfaceMesh, count: usize) -> Vec<SurfacePoint> {
    let (mut face, mut before) = (0, 0.0);
    (0..count)
        .map(|i| {
            let target = (i as f64 + 0.5) / count as f64 * mesh.area();
            while face + 1 < mesh.face_count() && before + mesh.face_areas()[face] < target {
                before += mesh.face_areas()[face];
                face += 1;
            }
            let along = (target - before) / mesh.face_areas()[face];
            let across = (i as f64 * 0.618_033_988_749_894_9).fract();
            let root = along.clamp(0.0, 1.0).sqrt();
            SurfacePoint {
                face: FaceId::new(face),
                barycentric: [1.0 - root, root * (1.0 - across), root * across],
            }
        })
        .collect()
}

fn measures(criterion: &mut Criterion) {
    let soup = shapes::scan_like(1, 97_000);
    let mesh = SurfaceMesh::from_soup(&soup, &CheckOptions::default()).expect("the shape is clean").0;
    let mut group = criterion.benchmark_group("measure");
    group.sample_size(10);
    for count in [10_000, 100_000] {
        let points = spread(&mesh, count);
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
    }
    group.finish();
}

criterion_group!(benches, measures);
criterion_main!(benches);
