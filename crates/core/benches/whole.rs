//! How long the whole takes, from a file's bytes and from a checked mesh, at several numbers of triangles and points.

mod common;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ldwrap::equalize::EqualizeOptions;
use ldwrap::pipeline::{Options, Request, run};
use ldwrap::{PolygonSoup, Silent, io};

/// Nothing in memory yet: reading, checking, all stages and equalizing, for 1,000 points.
fn from_bytes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("bytes to 1,000 points");
    let count = 1_000;
    let options = Options {
        request: Request::Count(count),
        equalize: Some(EqualizeOptions::default()),
        ..Options::default()
    };
    for (name, soup) in common::soups().into_iter().filter(|(_, soup)| soup.polygon_count() < 500_000) {
        let bytes = off(&soup);
        group.bench_function(name, |b| {
            b.iter(|| {
                let soup = io::read_mesh(&bytes, None, &|_| Err("no other file".into())).expect("a mesh");
                black_box(run(&common::checked(&soup), &options, &Silent))
            });
        });
    }
    group.finish();
}

/// A checked mesh of 97,000 triangles.
fn from_mesh(criterion: &mut Criterion) {
    let mesh = common::mesh();
    let mut group = criterion.benchmark_group("mesh to points");
    for (name, equalize, counts) in [
        ("wrap", None, &[335, 1_000, 10_000, 100_000, 1_000_000][..]),
        ("wrap and equalize", Some(EqualizeOptions::default()), &[335, 1_000, 10_000, 100_000][..]),
    ] {
        for &count in counts {
            let options = Options { request: Request::Count(count), equalize, ..Options::default() };
            group.bench_function(BenchmarkId::new(name, count), |b| {
                b.iter(|| black_box(run(&mesh, &options, &Silent)));
            });
        }
    }
    group.finish();
}

/// OFF, which needs no feature to be read.
fn off(soup: &PolygonSoup) -> Vec<u8> {
    let mut text = format!("OFF\n{} {} 0\n", soup.positions.len(), soup.polygon_count());
    for p in &soup.positions {
        text.push_str(&format!("{} {} {}\n", p.x, p.y, p.z));
    }
    for polygon in 0..soup.polygon_count() {
        let corners = soup.polygon(polygon);
        let words: Vec<_> = corners.iter().map(u32::to_string).collect();
        text.push_str(&format!("{} {}\n", corners.len(), words.join(" ")));
    }
    text.into_bytes()
}

criterion_group! { name = whole; config = common::quick(); targets = from_bytes, from_mesh }
criterion_main!(whole);
