//! Points near the strips against the list of all, and strips that are very narrow.

use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::ids::StripId;
use crate::mesh::{PolygonSoup, SurfaceMesh};
use crate::planted;
use crate::segment::{SegmentOptions, segment};
use crate::unfold::unfold;
use crate::wrap::{WrappedPoint, wrap};

const SEQUENCES: [Sequence; 6] = [
    Sequence::Hammersley { base: 2 },
    Sequence::Hammersley { base: 5 },
    Sequence::Halton { bases: [2, 3] },
    Sequence::Sobol { seed: 5 },
    Sequence::R2,
    Sequence::Fibonacci,
];

/// A flat band of this length and of width 1, cut into rectangles of two triangles each.
fn band(length: f64, pieces: u32) -> SurfaceMesh {
    let mut soup = PolygonSoup::default();
    for i in 0..=pieces {
        let x = length * f64::from(i) / f64::from(pieces);
        soup.positions.extend([DVec3::new(x, 0.0, 0.0), DVec3::new(x, 1.0, 0.0)]);
    }
    for i in 0..pieces {
        let a = 2 * i;
        soup.push_polygon(&[a, a + 2, a + 3]);
        soup.push_polygon(&[a, a + 3, a + 1]);
    }
    planted::mesh(&soup)
}

fn unfolded(mesh: &SurfaceMesh) -> (Strips, PlanarDomain) {
    let strips = unfold(mesh, &segment(mesh, &SegmentOptions::default()));
    let domain = PlanarDomain::lay_out(&strips);
    (strips, domain)
}

/// What the strips catch of all points, and of those looked for.
fn both(mesh: &SurfaceMesh, sequence: Sequence, count: u32, shift: DVec2) -> [Vec<WrappedPoint>; 2] {
    let (strips, domain) = unfolded(mesh);
    let all = DomainPoints::list(&domain, &sequence, count, shift);
    let near = DomainPoints::scatter_near(&domain, &strips, &sequence, u64::from(count), shift, 0.0).unwrap();
    assert_eq!(all.count(), u64::from(count));
    let listed = !matches!(sequence, Sequence::Hammersley { .. });
    if listed && domain.room(mesh.area()) > 16.0 && count > 1000 {
        assert!(near.count() < all.count() / 2, "{} of {count}", near.count());
    }
    [all, near].map(|points| {
        let wrapping = wrap(&strips, &domain, &points);
        let caught = (0..strips.strips.len())
            .flat_map(|s| wrapping.points_of(&strips, &domain, &points, StripId::new(s)).collect::<Vec<_>>());
        let mut caught: Vec<WrappedPoint> = caught.collect();
        assert_eq!(caught.len(), wrapping.count());
        caught.sort_by_key(|c| (c.point.face, c.index));
        caught
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Bit by bit the same points, whether all of the square are listed or those near the strips are looked for.
    #[test]
    fn found_points_are_those_of_the_list(which in 0..SEQUENCES.len(), length in 1.0..200.0, pieces in 1..20u32,
        count in 1..20_000u32, x in 0.0..1.0, y in 0.0..1.0, moved: bool) {
        let shift = if moved { DVec2::new(x, y) } else { DVec2::ZERO };
        let [all, near] = both(&band(length, pieces), SEQUENCES[which], count, shift);
        prop_assert_eq!(all, near);
    }
}

#[test]
fn places_within_reach_are_kept() {
    let mesh = band(100.0, 3);
    let (strips, domain) = unfolded(&mesh);
    let reach = 2.0;
    let middle = [DVec2::new(0.0, 0.5), DVec2::new(1.0, 0.5)].map(|end| end * domain.side);
    for sequence in SEQUENCES {
        let all = DomainPoints::list(&domain, &sequence, 5000, DVec2::splat(0.3));
        let near =
            DomainPoints::scatter_near(&domain, &strips, &sequence, 5000, DVec2::splat(0.3), reach).unwrap();
        let mut kept = std::collections::BTreeSet::new();
        near.along(middle, domain.side, |slot, _| assert!(kept.insert(near.at(slot).1)));
        for slot in 0..all.count() {
            let (place, index) = all.at(slot);
            let close = strips.strips[0].border.iter().any(|e| {
                let at = |v: u32| strips.strips[0].vertices[v as usize] + domain.offsets[0];
                crate::geometry::plane::segment_distance(at(e.from), at(e.to), place) < reach
            });
            assert!(!close || kept.contains(&index), "{sequence:?}: {index} at {place}");
        }
    }
}

#[test]
fn a_needle_gets_its_points() {
    use crate::pipeline::{Options, Request, run};
    let mesh = band(1e5, 1);
    for sequence in SEQUENCES {
        let options = Options { request: Request::Count(335), sequence, seed: 1, ..Options::default() };
        let run = run(&mesh, &options, &crate::Silent).unwrap();
        assert_eq!(run.samples.len(), 335, "{sequence:?}");
        // Each tenth of the needle has its tenth of the points, give or take what chance would allow.
        let mut tenths = [0; 10];
        for sample in &run.samples {
            tenths[(mesh.locate(&sample.point).x * 1e-4) as usize] += 1;
        }
        assert!(tenths.iter().all(|t| (14..=56).contains(t)), "{sequence:?}: {tenths:?}");
    }
}
