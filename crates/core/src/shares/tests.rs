//! Regions of equal mass, by hand and by invariants.

use std::borrow::Cow;

use super::*;
use crate::correct::{Corrected, Keep, Picks};
use crate::domain::{DomainPoints, PlanarDomain};
use crate::planted;
use crate::segment::{SegmentOptions, segment};
use crate::sequence::Sequence;
use crate::shapes::{self, Shape};
use crate::unfold::{Strips, unfold};
use crate::wrap::wrap;

/// What `f` makes of `caught` points of a mesh.
fn with_caught<R>(mesh: &SurfaceMesh, caught: f64, f: impl FnOnce(&Caught<'_>) -> R) -> R {
    let strips: Strips = unfold(mesh, &segment(mesh, &SegmentOptions::default()));
    let domain = PlanarDomain::lay_out(&strips);
    let count = (caught * domain.room(mesh.area())) as u32;
    let points = DomainPoints::scatter(&domain, &Sequence::default(), count, glam::DVec2::ZERO);
    let wrapping = wrap(&strips, &domain, &points);
    let caught = Caught::new(mesh, &strips, &domain, Cow::Borrowed(&points), wrapping, 0.0);
    f(&caught)
}

/// What stays of `caught` points of a mesh when `n` are wanted.
fn chosen(mesh: &SurfaceMesh, caught: f64, n: usize) -> Option<Vec<Corrected>> {
    with_caught(mesh, caught, |caught| {
        let mended = caught.mended();
        let picks = Picks::new(mended, Regions::new(mesh, &Density::UNIFORM, n).choose(caught)?);
        let mut chosen = Vec::new();
        let blocks = picks.blocks(mended, Keep::All, |block| {
            chosen.extend(block.iter().map(|&pick| mended.corrected(pick)));
            Ok::<(), std::convert::Infallible>(())
        });
        blocks.ok().map(|()| chosen)
    })
}

#[test]
fn candidates_may_come_some_at_a_time() {
    let n = 40_000;
    // Few large faces, and many small ones.
    for mesh in [planted::mesh(&shapes::cube(1)), planted::mesh(&Shape::Sphere.generate())] {
        let regions = Regions::new(&mesh, &Density::UNIFORM, n);
        for (surplus, fewest) in [(2.0, 9000), (1.01, 40_000)] {
            with_caught(&mesh, surplus * n as f64, |caught| {
                let all = regions.choose_by(caught, usize::MAX).expect("enough");
                assert_eq!(all.iter().map(Vec::len).sum::<usize>(), n);
                for together in [fewest, 50_000] {
                    assert!(regions.choose_by(caught, together).is_none_or(|some| some == all));
                }
                assert!(surplus < 2.0 || regions.choose_by(caught, fewest).is_some());
            });
        }
        with_caught(&mesh, 0.99 * n as f64, |caught| assert!(regions.choose(caught).is_none()));
    }
}

#[test]
fn regions_of_a_square_are_quarters_of_quarters() {
    let mesh = planted::mesh(&shapes::square(16));
    let (low, high) = mesh.bounds();
    let regions = Regions::new(&mesh, &Density::UNIFORM, 16);
    let centroids = |range| regions.centroids(range, |at| regions.face(at));
    let mut expected: Vec<(i32, i32)> = Vec::new();
    let mut found: Vec<(i32, i32)> = Vec::new();
    for i in 0..4 {
        for j in 0..4 {
            expected.push((250 * i + 125, 250 * j + 125));
        }
    }
    for centroid in centroids(0..16) {
        let at = (centroid - low) / (high - low).max_element() * 1000.0;
        found.push((at.x.round() as i32, at.y.round() as i32));
    }
    found.sort_unstable();
    assert_eq!(found, expected);
    // Whatever part of the row is looked at.
    assert!(centroids(5..11).iter().zip(&centroids(0..16)[5..]).all(|(a, b)| a.distance(*b) < 1e-12));
}

/// Few regions of many faces: each face is looked at about once, not once for every piece of work; the middles are the same
/// as when pieces look for them.
#[test]
fn few_regions_look_at_each_face_once() {
    // One large face has most of the regions.
    let mut soup = shapes::square(1);
    planted::join(
        &mut soup,
        &planted::moved(Shape::Sphere.generate(), |p| p * 0.1 + DVec3::new(0.0, 0.0, 3.0)),
    );
    for mesh in [planted::mesh(&soup), planted::mesh(&shapes::cube(60))] {
        for n in [1, 2, 7, 11] {
            let regions = Regions::new(&mesh, &Density::UNIFORM, n);
            let looks = std::sync::atomic::AtomicUsize::new(0);
            let face = |at: usize| {
                looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                regions.face(at)
            };
            let one_by_one: Vec<DVec3> = (0..n).flat_map(|r| regions.centroids(r..r + 1, face)).collect();
            assert_eq!(one_by_one, regions.centroids(0..n, |at| regions.face(at)));
            // Faces between two regions are in both, and one behind each is seen to be beyond.
            assert!(looks.into_inner() <= mesh.face_count() + 2 * n);
            with_caught(&mesh, 2000.0, |caught| {
                let rows = 0..mesh.face_count();
                let known = regions.candidates(caught, rows.clone(), Some(&one_by_one));
                assert_eq!(known.len(), caught.count());
                assert!(known == regions.candidates(caught, rows, None));
            });
        }
    }
}

#[test]
fn one_point_stays_in_each_region_and_every_component_has_its_share() {
    let mut soup = Shape::Cube.generate();
    planted::join(
        &mut soup,
        &planted::moved(Shape::Sphere.generate(), |p| p * 1.3 + DVec3::new(5.0, 0.0, 0.0)),
    );
    planted::join(
        &mut soup,
        &planted::moved(Shape::Tetrahedron.generate(), |p| p * 0.1 - DVec3::new(5.0, 0.0, 0.0)),
    );
    let mesh = planted::mesh(&soup);
    let components = mesh.topology().components();
    let mut areas = vec![0.0; components.count];
    for face in mesh.topology().face_ids() {
        areas[components.of_face[face.index()] as usize] += mesh.face_area(face);
    }
    for n in [1, 2, 10, 77, 500, 9000] {
        let chosen = chosen(&mesh, 40.0 * n as f64 + 400.0, n).expect("enough points");
        assert_eq!(chosen.len(), n);
        assert!(chosen.windows(2).all(|w| w[0].index <= w[1].index), "in order of the sequence");
        let mut counts = vec![0.0; components.count];
        for c in &chosen {
            counts[components.of_face[c.sample.point.face.index()] as usize] += 1.0;
        }
        for (count, area) in counts.iter().zip(&areas) {
            let due = area / mesh.area() * n as f64;
            assert!((count - due).abs() <= 1.0 + 1e-9, "{n}: {counts:?} of {areas:?}");
        }
    }
}

#[test]
fn too_few_points_are_told() {
    let mesh = planted::mesh(&shapes::square(4));
    assert!(chosen(&mesh, 60.0, 100).is_none());
    assert_eq!(chosen(&mesh, 101.0, 100).map(|c| c.len()), Some(100));
}
