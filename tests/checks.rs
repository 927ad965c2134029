//! The invariants of every stage's value.

use glam::DVec2;
use ldwrap::domain::PlanarDomain;
use ldwrap::segment::Segmentation;
use ldwrap::unfold::{Strip, Strips, Twin};
use ldwrap::{FaceId, HalfedgeId, Origin, Sample, StripId, SurfaceMesh};

/// Every face is in exactly one segment, and each segment is a tree: all but its first face hang on an earlier one,
/// across an edge that both share.
///
/// # Panics
/// If that does not hold.
pub fn check_segmentation(name: &str, mesh: &SurfaceMesh, segmentation: &Segmentation) {
    const NOWHERE: usize = usize::MAX;
    let mut owner = vec![NOWHERE; mesh.face_count()];
    for (s, segment) in segmentation.segments.iter().enumerate() {
        assert!(!segment.attachments.is_empty(), "{name}: segment {s} is empty");
        for (i, attachment) in segment.attachments.iter().enumerate() {
            let face = attachment.face;
            assert_eq!(owner[face.index()], NOWHERE, "{name}: {face:?} is in two segments, or twice in one");
            assert_eq!(attachment.across.is_none(), i == 0, "{name}: only the first face hangs on none");
            if let Some(across) = attachment.across {
                assert_eq!(across.face(), face, "{name}: the edge is the face's own");
                let parent = mesh.topology().twin(across).expect("a face behind the edge").face();
                assert_eq!(
                    owner[parent.index()],
                    s,
                    "{name}: {face:?} hangs on {parent:?}, which is not earlier"
                );
            }
            owner[face.index()] = s;
        }
    }
    assert!(owner.iter().all(|&s| s != NOWHERE), "{name}: a face is in no segment");
}

/// Each strip is its segment laid congruently in the plane: every triangle keeps its sides to 1e-9 of the mesh's size
/// and its orientation, the tree's edges join, the border's loops close, and every side of a face is inside or in the
/// border once.
///
/// # Panics
/// If that does not hold.
pub fn check_strips(name: &str, mesh: &SurfaceMesh, segmentation: &Segmentation, strips: &Strips) {
    let tolerance = 1e-9 * mesh.diagonal();
    assert_eq!(strips.strips.len(), segmentation.segments.len(), "{name}");
    for (s, (strip, segment)) in strips.strips.iter().zip(&segmentation.segments).enumerate() {
        let faces: Vec<FaceId> = segment.attachments.iter().map(|a| a.face).collect();
        assert_eq!(strip.faces, faces, "{name}: strip {s} is its segment");
        for (i, &face) in faces.iter().enumerate() {
            let place = strips.places[face.index()];
            assert_eq!((place.strip.index(), place.index as usize), (s, i), "{name}: {face:?}");
            check_congruent(name, mesh, strip, i, tolerance);
        }
        for across in segment.attachments.iter().filter_map(|a| a.across) {
            let twin = mesh.topology().twin(across).expect("a face behind the edge");
            let (from, to) = planar_ends(strips, across);
            assert_eq!(planar_ends(strips, twin), (to, from), "{name}: the edges of the tree join");
        }
        check_border(name, mesh, strips, s);
        let area: f64 = faces.iter().map(|&f| mesh.face_area(f)).sum();
        assert!((strip.area - area).abs() <= 1e-12 * area, "{name}");
        let used = || strip.corners.iter().flatten().map(|&v| strip.vertices[v as usize]);
        let low = used().fold(DVec2::INFINITY, DVec2::min);
        let high = used().fold(DVec2::NEG_INFINITY, DVec2::max);
        assert!(low.distance(DVec2::ZERO) <= tolerance, "{name}: the box of strip {s} starts at {low}");
        assert!(high.distance(strip.extent) <= tolerance, "{name}: the box of strip {s} ends at {high}");
    }
}

fn check_congruent(name: &str, mesh: &SurfaceMesh, strip: &Strip, index: usize, tolerance: f64) {
    let [a, b, c] = strip.triangle(index);
    let face = strip.faces[index];
    let lengths = [a.distance(b), b.distance(c), c.distance(a)];
    for (corner, length) in lengths.into_iter().enumerate() {
        let error = (length - mesh.edge_length(HalfedgeId::of(face, corner))).abs();
        assert!(error <= tolerance, "{name}: {face:?} side {corner} is off by {error:e}");
    }
    let area = 0.5 * (b - a).perp_dot(c - a);
    let longest = lengths.into_iter().fold(0.0, f64::max);
    assert!((area - mesh.face_area(face)).abs() <= tolerance * longest, "{name}: {face:?} is turned over");
}

/// The planar vertices of a side of a face.
fn planar_ends(strips: &Strips, halfedge: HalfedgeId) -> (u32, u32) {
    let place = strips.places[halfedge.face().index()];
    let corners = strips.strips[place.strip.index()].corners[place.index as usize];
    (corners[halfedge.corner()], corners[halfedge.next().corner()])
}

fn check_border(name: &str, mesh: &SurfaceMesh, strips: &Strips, s: usize) {
    let strip = &strips.strips[s];
    let mut end = 0;
    for range in &strip.loops {
        assert_eq!(range.start, end, "{name}: the loops follow each other");
        assert!(!range.is_empty(), "{name}: a loop has edges");
        end = range.end;
        for i in range.clone() {
            let next = if i + 1 == range.end { range.start } else { i + 1 };
            assert_eq!(strip.border[i].to, strip.border[next].from, "{name}: strip {s}: the loop is closed");
        }
    }
    assert_eq!(end, strip.border.len(), "{name}");
    let mut in_border = std::collections::BTreeSet::new();
    for edge in &strip.border {
        assert!(in_border.insert(edge.halfedge), "{name}: {:?} is twice in the border", edge.halfedge);
        assert_eq!((edge.from, edge.to), planar_ends(strips, edge.halfedge), "{name}");
    }
    for &face in &strip.faces {
        for halfedge in (0..3).map(|c| HalfedgeId::of(face, c)) {
            let own = planar_ends(strips, halfedge);
            let expected = mesh.topology().twin(halfedge).map_or(Some(Twin::MeshBorder), |twin| {
                let other = strips.places[twin.face().index()].strip;
                let (to, from) = planar_ends(strips, twin);
                if other != StripId::new(s) {
                    Some(Twin::OtherStrip(other))
                } else {
                    (own != (from, to)).then_some(Twin::SameStrip { from, to })
                }
            });
            assert_eq!(in_border.contains(&halfedge), expected.is_some(), "{name}: {halfedge:?}");
        }
    }
    for edge in &strip.border {
        let Twin::SameStrip { from, to } = edge.twin else { continue };
        let twin = mesh.topology().twin(edge.halfedge).expect("a cut edge has two sides");
        assert_eq!(planar_ends(strips, twin), (to, from), "{name}: where the cut edge lies again");
    }
}

/// Every sample lies on its face, in the strip of that face and, unless it was projected, at its place in the plane.
///
/// # Panics
/// If that does not hold.
pub fn check_samples(
    name: &str,
    mesh: &SurfaceMesh,
    strips: &Strips,
    domain: &PlanarDomain,
    samples: &[Sample],
) {
    let places: Vec<_> = samples.iter().map(|s| mesh.locate(&s.point)).collect();
    let nearest = ldwrap::spatial::nearest(mesh, &places);
    for ((sample, nearest), place) in samples.iter().zip(nearest).zip(places) {
        let weights = sample.point.barycentric;
        assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{name}: {weights:?}");
        assert!((weights.iter().sum::<f64>() - 1.0).abs() <= 1e-12, "{name}: {weights:?}");
        let off = mesh.locate(&nearest.point).distance(place);
        assert!(off <= 1e-6 * mesh.diagonal(), "{name}: {off:e} off the surface");
        let (strip, laid) = strips.lay_point(&sample.point);
        assert_eq!(sample.strip, strip, "{name}");
        if sample.origin != Origin::Projected {
            let off = (laid + domain.offsets[strip.index()]).distance(sample.place);
            assert!(off <= 1e-9 * domain.side, "{name}: {off:e} off its place in the plane");
        }
    }
}
