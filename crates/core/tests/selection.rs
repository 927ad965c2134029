//! Which points a run gives: regions, weights, extensible sets, orders.

use ldwrap::density::Density;
use ldwrap::pipeline::{Options, OptionsError, Request, SampleOrder, Selection, run, run_weighted};
use ldwrap::sequence::Sequence;
use ldwrap::shapes::{self, Shape};
use ldwrap::{CheckOptions, PolygonSoup, Sample, Silent, SurfaceMesh};

fn mesh(soup: &PolygonSoup) -> SurfaceMesh {
    SurfaceMesh::from_soup(soup, &CheckOptions::default()).expect("a shape is a surface").0
}

fn of_count(n: usize, selection: Selection) -> Options {
    Options { request: Request::Count(n), selection, ..Options::default() }
}

fn samples(mesh: &SurfaceMesh, density: &Density, options: &Options) -> Vec<Sample> {
    run_weighted(mesh, density, options, &Silent).expect("the options can be met").samples
}

/// How many of the samples lie where `inside` says.
fn count(mesh: &SurfaceMesh, samples: &[Sample], inside: impl Fn(glam::DVec3) -> bool) -> usize {
    samples.iter().filter(|s| inside(mesh.locate(&s.point))).count()
}

#[test]
fn every_part_of_a_body_has_its_share() {
    // The trefoil unfolds badly: the paper's selection leaves some of its octants far from their share.
    let mesh = mesh(&Shape::Trefoil.generate());
    let n = 400;
    let worst = |selection| {
        let found = samples(&mesh, &Density::UNIFORM, &of_count(n, selection));
        assert_eq!(found.len(), n);
        let exact = |inside: &dyn Fn(glam::DVec3) -> bool| {
            let area = mesh.topology().face_ids().filter(|f| {
                let [a, b, c] = mesh.triangle(*f);
                inside((a + b + c) / 3.0)
            });
            area.map(|f| mesh.face_area(f)).sum::<f64>() / mesh.area() * n as f64
        };
        (0..8u32)
            .map(|octant| {
                let inside = |p: glam::DVec3| {
                    (p.x > 0.0) == (octant & 1 > 0)
                        && (p.y > 0.0) == (octant & 2 > 0)
                        && (p.z > 0.0) == (octant & 4 > 0)
                };
                (count(&mesh, &found, inside) as f64 - exact(&inside)).abs()
            })
            .fold(0.0, f64::max)
    };
    let (regions, sequence) = (worst(Selection::Regions), worst(Selection::Sequence));
    assert!(regions <= 5.0 && regions <= sequence, "{regions} and {sequence} of {n}");
}

#[test]
fn weights_of_faces_are_met() {
    let mesh = mesh(&shapes::square(20));
    let (low, high) = mesh.bounds();
    let middle = 0.5 * (low.x + high.x);
    let weights: Vec<f64> = mesh
        .topology()
        .face_ids()
        .map(|f| {
            let [a, b, c] = mesh.triangle(f);
            if (a.x + b.x + c.x) / 3.0 < middle { 3.0 } else { 1.0 }
        })
        .collect();
    let density = Density::of_faces(&mesh, &weights).unwrap();
    for (selection, off) in [(Selection::Regions, 1), (Selection::Sequence, 25), (Selection::Extensible, 25)]
    {
        for sequence in [Sequence::Halton { bases: [2, 3] }, Sequence::R2, Sequence::Sobol { seed: 1 }] {
            let found = samples(&mesh, &density, &Options { sequence, ..of_count(1000, selection) });
            assert_eq!(found.len(), 1000);
            let left = count(&mesh, &found, |p| p.x < middle);
            assert!(left.abs_diff(750) <= off, "{selection:?} {sequence:?}: {left}");
        }
    }
}

#[test]
fn weights_of_vertices_are_met_and_zero_gets_nothing() {
    // Density proportional to x over the square of side 1, zero on its left tenth: P(x < t) = t^2 but for the start.
    let mesh = mesh(&shapes::square(20));
    let (low, high) = mesh.bounds();
    let along = |x: f64| (x - low.x) / (high.x - low.x);
    let weights: Vec<f64> = mesh.positions().iter().map(|p| (along(p.x) - 0.1).max(0.0)).collect();
    let density = Density::of_vertices(&mesh, &weights).unwrap();
    for selection in [Selection::Regions, Selection::Sequence] {
        let found = samples(&mesh, &density, &of_count(800, selection));
        assert_eq!(found.len(), 800);
        assert_eq!(count(&mesh, &found, |p| along(p.x) < 0.1 - 1e-9), 0, "{selection:?}");
        let half = count(&mesh, &found, |p| along(p.x) < 0.55);
        assert!(half.abs_diff(200) <= 20, "{selection:?}: {half}");
    }
}

#[test]
fn extreme_weights_still_give_the_count() {
    let mesh = mesh(&Shape::Cube.generate());
    let mut weights = vec![1.0; mesh.face_count()];
    weights[0] = 1e9;
    let density = Density::of_faces(&mesh, &weights).unwrap();
    for n in [1, 10, 1000] {
        assert_eq!(samples(&mesh, &density, &of_count(n, Selection::Regions)).len(), n);
    }
}

#[test]
fn weights_on_one_small_face_are_met() {
    let mesh = mesh(&shapes::uv_sphere(80, 80));
    let chosen = 6_000;
    let mut weights = vec![0.0; mesh.face_count()];
    weights[chosen] = 1.0;
    let density = Density::of_faces(&mesh, &weights).unwrap();
    for n in [1, 500] {
        let found = samples(&mesh, &density, &of_count(n, Selection::Regions));
        assert_eq!(found.len(), n);
        assert!(found.iter().all(|s| s.point.face.index() == chosen));
        // The share of the face's part nearer to its first corner.
        let near = found.iter().filter(|s| s.point.barycentric[0] > 0.5).count();
        assert!((near as f64 - n as f64 / 4.0).abs() <= 1.0, "{near} of {n}");
    }
}

#[test]
fn more_extensible_points_contain_fewer() {
    for shape in [Shape::Torus, Shape::Cup, Shape::Cube] {
        let mesh = mesh(&shape.generate());
        let weights: Vec<f64> = (0..mesh.face_count()).map(|f| 1.0 + (f % 3) as f64).collect();
        for density in [Density::UNIFORM, Density::of_faces(&mesh, &weights).unwrap()] {
            for sequence in [Sequence::Halton { bases: [2, 3] }, Sequence::Sobol { seed: 4 }, Sequence::R2] {
                let options = |n| Options { sequence, seed: 3, ..of_count(n, Selection::Extensible) };
                let all = samples(&mesh, &density, &options(700));
                for n in [1, 2, 50, 333, 699] {
                    // Bit by bit.
                    assert_eq!(samples(&mesh, &density, &options(n)), all[..n], "{sequence:?} {n}");
                }
            }
        }
    }
}

#[test]
fn what_cannot_be_extended_is_refused() {
    let mesh = mesh(&Shape::Cube.generate());
    let refused = |options: Options| run(&mesh, &options, &Silent).unwrap_err();
    let extensible = of_count(10, Selection::Extensible);
    for (sequence, name) in [(Sequence::default(), "Hammersley"), (Sequence::Fibonacci, "Fibonacci")] {
        let error = refused(Options { sequence, ..extensible });
        assert_eq!(error, OptionsError::NotExtensible { sequence: name });
        assert!(error.to_string().contains(name));
    }
    let halton = Options { sequence: Sequence::R2, ..extensible };
    let error = refused(Options { equalize: Some(Default::default()), ..halton });
    assert_eq!(error, OptionsError::Extensible { what: "equalized" });
    let error = refused(Options { order: SampleOrder::Progressive, ..halton });
    assert_eq!(error, OptionsError::Extensible { what: "put in another order" });
}

#[test]
fn the_progressive_order_changes_nothing_but_the_order() {
    let mesh = mesh(&Shape::Sphere.generate());
    let plain = samples(&mesh, &Density::UNIFORM, &of_count(300, Selection::Regions));
    let options = Options { order: SampleOrder::Progressive, ..of_count(300, Selection::Regions) };
    let ordered = samples(&mesh, &Density::UNIFORM, &options);
    assert_ne!(plain, ordered);
    let sorted = |mut samples: Vec<Sample>| {
        samples.sort_by(|a, b| a.place.x.total_cmp(&b.place.x).then(a.place.y.total_cmp(&b.place.y)));
        samples
    };
    assert_eq!(sorted(plain), sorted(ordered.clone()));
    // The first of eight parts is spread over all eight octants.
    for octant in 0..8u32 {
        let inside = |p: glam::DVec3| {
            (p.x > 0.0) == (octant & 1 > 0)
                && (p.y > 0.0) == (octant & 2 > 0)
                && (p.z > 0.0) == (octant & 4 > 0)
        };
        assert!((2..=8).contains(&count(&mesh, &ordered[..37], inside)), "{octant}");
    }
}
