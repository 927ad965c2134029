//! Beyond the paper: parts of a strip hung elsewhere, where that leaves less border open.
//!
//! A segment is a tree of faces. Cut above a face, all that hangs there can be turned as a whole so that one of its open
//! sides meets its twin: another unfolding of the same faces, in which that side and others along it close, and what was
//! joined or closed before may gape. A local search takes such moves as long as they gain.

use glam::DVec2;

use super::planar::{Planar, Shapes, ends};
use super::{Attachment, Segment, Segmentation};
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::SurfaceMesh;

/// At most so many faces are hung elsewhere at once. In two passes over the horse 100 took away 25% of the open border and 300
/// took away 31%, for three times the work.
const MOST: usize = 300;

/// How often all open sides are looked at, at most.
const PASSES: usize = 4;

/// So many faces are looked at for each face of a component, then its search ends wherever it is: a bound for crumpled
/// surfaces, on which nearly all sides are open. Two passes over scans took 40 to 60.
const WORK: usize = 100;

/// Of a pass that gains less than this share of the open border it is the last.
const LEAST: f64 = 1e-3;

/// Smaller gains, in units of the shapes, are not worth a move.
const NOTHING: f64 = 1e-7;

/// Hangs parts of segments elsewhere while that shortens the border that is wider open than `tolerance`, in units of the
/// mesh, component by component. Segments may join. O(F).
pub(super) fn rehang(mesh: &SurfaceMesh, segmentation: Segmentation, tolerance: f64) -> Segmentation {
    let shapes = &Shapes::new(mesh);
    let count = shapes.face_count();
    let mut across = vec![None; count];
    for attachment in segmentation.segments.iter().flat_map(|s| &s.attachments) {
        across[attachment.face.index()] = attachment.across;
    }
    let mut hanging = Hanging {
        shapes,
        tolerance: shapes.relative(tolerance),
        across,
        segment: segmentation.segment_of_face(count).iter().map(|s| s.0).collect(),
        planar: Planar::of(mesh, shapes, &segmentation),
        seen: vec![0; count],
        search: 0,
        stack: Vec::new(),
        left: 0,
    };
    let component = &mesh.topology().components().of_face;
    let mut faces: Vec<u32> = (0..count as u32).collect();
    faces.sort_by_key(|&face| component[face as usize]);
    let mut is_other = false;
    for own in faces.chunk_by(|&a, &b| component[a as usize] == component[b as usize]) {
        is_other |= hanging.improve(own);
    }
    if is_other { hanging.segmentation() } else { segmentation }
}

/// A turn and a shift of the plane.
struct Motion {
    from: DVec2,
    to: DVec2,
    turn: DVec2,
}

impl Motion {
    /// What brings the side `a b` onto `c d`, which is as long: middle onto middle. `None` where rounding leaves no length.
    fn onto((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> Option<Self> {
        let (own, other) = (b - a, d - c);
        let turn = DVec2::new(own.dot(other), own.perp_dot(other)).try_normalize()?;
        Some(Self { from: a.midpoint(b), to: c.midpoint(d), turn })
    }

    #[inline]
    fn of(&self, place: DVec2) -> DVec2 {
        self.to + self.turn.rotate(place - self.from)
    }
}

/// All that hangs at `top` can be hung elsewhere.
struct Move {
    top: FaceId,
    /// By how much the open border gets shorter.
    gain: f64,
}

struct Hanging<'a> {
    shapes: &'a Shapes,
    tolerance: f64,
    /// For each face the side across which it hangs; `None` for the first of a segment.
    across: Vec<Option<HalfedgeId>>,
    segment: Vec<u32>,
    planar: Planar,
    /// In which search a face was last seen.
    seen: Vec<u32>,
    search: u32,
    stack: Vec<FaceId>,
    /// How many faces may still be looked at.
    left: usize,
}

impl Hanging<'_> {
    fn ends(&self, side: HalfedgeId) -> (DVec2, DVec2) {
        ends(self.planar.corners(side.face()), side.corner())
    }

    fn is_open(&self, side: HalfedgeId, twin: HalfedgeId) -> bool {
        self.segment[side.face().index()] != self.segment[twin.face().index()]
            || self.planar.gap(self.ends(side), twin) > self.tolerance
    }

    /// By how much more border is open when the face of `side` is moved into a segment and that of `twin` is not.
    fn change(&self, motion: &Motion, into: u32, side: HalfedgeId, twin: HalfedgeId) -> f64 {
        let (from, to) = self.ends(side);
        let moved = (motion.of(from), motion.of(to));
        let opens =
            into != self.segment[twin.face().index()] || self.planar.gap(moved, twin) > self.tolerance;
        match (self.is_open(side, twin), opens) {
            (false, true) => self.shapes.side(side).length(),
            (true, false) => -self.shapes.side(side).length(),
            _ => 0.0,
        }
    }

    /// Goes through the faces of a component until little is gained. Whether any were hung elsewhere.
    fn improve(&mut self, faces: &[u32]) -> bool {
        self.left = WORK * faces.len();
        let mut is_other = false;
        for _ in 0..PASSES {
            let (mut open, mut gained) = (0.0, 0.0);
            for &face in faces {
                for side in (0..3).map(|corner| HalfedgeId::of(FaceId(face), corner)) {
                    let Some(twin) = self.shapes.side(side).twin() else { continue };
                    if !self.is_open(side, twin) {
                        continue;
                    }
                    // Each is met from both sides.
                    open += 0.5 * self.shapes.side(side).length();
                    if let Some(found) = self.best_move(side, twin).filter(|found| found.gain > NOTHING) {
                        self.hang(side, twin, found.top);
                        gained += found.gain;
                        is_other = true;
                    }
                }
            }
            if gained < LEAST * open || self.left == 0 {
                break;
            }
        }
        is_other
    }

    /// Of all that hangs at the face of `side`, at the face that it hangs on, and so on, what gains most when it is hung
    /// across `side` to the face of `twin`.
    fn best_move(&mut self, side: HalfedgeId, twin: HalfedgeId) -> Option<Move> {
        let (from, to) = self.ends(twin);
        let motion = Motion::onto(self.ends(side), (to, from))?;
        let into = self.segment[twin.face().index()];
        self.search += 1;
        let (mut faces, mut border) = (0, 0.0);
        let mut best: Option<Move> = None;
        let mut top = side.face();
        loop {
            let Some(more) = self.add(&motion, into, top, &mut faces) else { return best };
            border += more;
            if self.seen[twin.face().index()] == self.search {
                return best;
            }
            let above = self.across[top.index()].and_then(|up| Some((up, self.shapes.side(up).twin()?)));
            let cut = above.map_or(0.0, |(up, twin)| self.change(&motion, into, up, twin));
            let gain = -(border + cut);
            if best.as_ref().is_none_or(|best| gain > best.gain) {
                best = Some(Move { top, gain });
            }
            match above {
                Some((_, twin)) if faces < MOST && self.left > 0 => top = twin.face(),
                _ => return best,
            }
        }
    }

    /// Sees what hangs at a face and was not seen yet. By how much more border along what was seen is open then, not
    /// counting the side across which the face hangs; `None` where that is too much to move.
    fn add(&mut self, motion: &Motion, into: u32, top: FaceId, faces: &mut usize) -> Option<f64> {
        let mut border = 0.0;
        self.stack.clear();
        self.stack.push(top);
        while let Some(face) = self.stack.pop() {
            if *faces == MOST || self.left == 0 {
                return None;
            }
            *faces += 1;
            self.left -= 1;
            self.seen[face.index()] = self.search;
            for side in (0..3).map(|corner| HalfedgeId::of(face, corner)) {
                let Some(twin) = self.shapes.side(side).twin() else { continue };
                let other = twin.face();
                let is_seen = self.seen[other.index()] == self.search;
                if self.across[face.index()] == Some(side) {
                    // The way up.
                } else if self.across[other.index()] == Some(twin) {
                    if !is_seen {
                        self.stack.push(other);
                    }
                } else if is_seen {
                    // Both move: it was counted when the other one moved alone.
                    border -= self.change(motion, into, twin, side);
                } else {
                    border += self.change(motion, into, side, twin);
                }
            }
        }
        Some(border)
    }

    /// Hangs all that hangs at `top`, the face of `side` among it, across that side to the face of `twin`.
    fn hang(&mut self, side: HalfedgeId, twin: HalfedgeId, top: FaceId) {
        // From there up to the top what hung on the next one holds it now.
        let mut next = Some(side);
        while let Some(now) = next {
            let face = now.face();
            let before = self.across[face.index()].replace(now);
            next = before.filter(|_| face != top).and_then(|up| self.shapes.side(up).twin());
        }
        let into = self.segment[twin.face().index()];
        self.stack.clear();
        self.stack.push(side.face());
        while let Some(face) = self.stack.pop() {
            let across = self.across[face.index()];
            if let Some(corners) = across.and_then(|across| self.planar.beside(self.shapes, across)) {
                self.planar.lay(face, corners);
            }
            self.segment[face.index()] = into;
            self.push_hanging(face);
        }
    }

    /// Puts the faces that hang on a face on the stack.
    fn push_hanging(&mut self, face: FaceId) {
        for side in (0..3).map(|corner| HalfedgeId::of(face, corner)) {
            let Some(twin) = self.shapes.side(side).twin() else { continue };
            if self.across[twin.face().index()] == Some(twin) {
                self.stack.push(twin.face());
            }
        }
    }

    /// The segments as they hang now, each from its first face on.
    fn segmentation(mut self) -> Segmentation {
        let mut segments = Vec::new();
        self.stack.clear();
        for first in (0..self.across.len()).map(FaceId::new) {
            if self.across[first.index()].is_some() {
                continue;
            }
            let mut attachments = Vec::new();
            self.stack.push(first);
            while let Some(face) = self.stack.pop() {
                attachments.push(Attachment { face, across: self.across[face.index()] });
                self.push_hanging(face);
            }
            segments.push(Segment { attachments });
        }
        Segmentation { segments }
    }
}
