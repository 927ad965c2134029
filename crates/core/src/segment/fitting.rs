//! Beyond the paper: growth that looks at the plane. The triangle that opens the least border joins first, so that what
//! can lie together does, and cuts stay open only where the surface's curvature keeps them apart.

use glam::DVec2;

use super::frontier::{Cost, Frontier};
use super::planar::{Planar, Shapes, ends};
use super::{Attachment, Segment};
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::SurfaceMesh;

/// Of triangles that open equally little, which one joins first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tie {
    /// One that closes a cut, then the one behind the flattest edge: long flat fingers.
    Flattest,
    /// The one nearest in the plane to where the segment began: round strips.
    Nearest,
    /// The one that fits its other neighbours best.
    Tightest,
}

/// What is known of a face, in a byte.
#[derive(Clone, Copy, PartialEq, Eq)]
struct State(u8);

impl State {
    const FREE: Self = Self(0);
    const JOINED: Self = Self(1 << 7);

    #[inline]
    fn is_free(self) -> bool {
        self.0 < Self::JOINED.0
    }

    /// The sides of a free face whose neighbours have joined, a bit each.
    #[inline]
    fn beside(self) -> u8 {
        self.0 & 7
    }

    /// The corner at which the side starts across which a free face was laid last, for a try.
    #[inline]
    fn tried(self) -> usize {
        usize::from(self.0 >> 3)
    }

    /// One more neighbour has joined, across the side at `corner`, and the face is laid there for a try.
    #[inline]
    fn join_beside(self, corner: usize) -> Self {
        Self(self.beside() | 1 << corner | (corner as u8) << 3)
    }
}

/// A segment, and the length of its cuts that are open, in units of the shapes: each edge counts once.
pub(super) struct Fitted {
    /// For each face the side across which it joined; of the first face, its first side.
    pub(super) sides: Vec<HalfedgeId>,
    pub(super) open: f64,
}

impl Fitted {
    pub(super) fn segment(&self) -> Segment {
        let attachment = |(i, &side): (usize, &HalfedgeId)| Attachment {
            face: side.face(),
            across: (i > 0).then_some(side),
        };
        Segment { attachments: self.sides.iter().enumerate().map(attachment).collect() }
    }
}

struct Fitting<'a> {
    shapes: &'a Shapes,
    /// Gaps up to this stay closed, in units of the shapes.
    tolerance: f64,
    tie: Tie,
    state: Vec<State>,
    /// Faces that have joined, and free ones beside them where they were tried last.
    planar: Planar,
    frontier: Frontier,
}

/// The other two, in order.
fn other_corners(corner: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][corner]
}

/// A segment for each component, grown from the seeds, one in each; the tolerance in units of the shapes. O(F log F).
pub(super) fn fit(
    mesh: &SurfaceMesh,
    shapes: &Shapes,
    seeds: &[HalfedgeId],
    tolerance: f64,
    tie: Tie,
) -> Vec<Fitted> {
    let mut fitting = Fitting {
        shapes,
        tolerance,
        tie,
        state: vec![State::FREE; shapes.face_count()],
        planar: Planar::new(shapes.face_count()),
        frontier: Frontier::default(),
    };
    seeds.iter().map(|seed| fitting.grow(mesh, seed.face())).collect()
}

/// What it does to attach a free face.
struct Fit {
    cost: Cost,
    /// The length of its sides that open.
    open: f64,
}

impl Fitting<'_> {
    /// Grows a segment from a face until nothing is left beside it.
    fn grow(&mut self, mesh: &SurfaceMesh, seed: FaceId) -> Fitted {
        let mut fitted = Fitted { sides: vec![HalfedgeId::of(seed, 0)], open: 0.0 };
        self.planar.lay(seed, self.shapes.first(mesh, seed));
        self.join(seed, 0..3);
        while let Some((cost, across)) = self.frontier.pop() {
            let face = across.face();
            let state = self.state[face.index()];
            if !state.is_free() {
                continue;
            }
            self.frontier.soon(|side| self.fetch(side.face()));
            // What it costs stays true while nothing else is tried.
            let known = state.tried() == across.corner();
            if !known {
                let Some(corners) = self.planar.beside(self.shapes, across) else { continue };
                self.planar.lay(face, corners);
            }
            if !(known && cost.opens_nothing()) {
                let fit = self.fit(across, state.beside(), self.planar.corners(face));
                if fit.cost > cost {
                    // Others were laid beside it since: it may have to wait.
                    self.state[face.index()] = state.join_beside(across.corner());
                    self.frontier.push(fit.cost, across);
                    continue;
                }
                fitted.open += fit.open;
            }
            fitted.sides.push(across);
            self.join(face, other_corners(across.corner()));
        }
        fitted
    }

    /// A face joins where it is laid: its other sides are looked at, all three if it is the first.
    fn join(&mut self, face: FaceId, sides: impl IntoIterator<Item = usize> + Clone) {
        self.state[face.index()] = State::JOINED;
        let shape = &self.shapes.of(face).0;
        // What lies anywhere is fetched together.
        sides
            .clone()
            .into_iter()
            .filter_map(|corner| shape[corner].twin())
            .for_each(|across| self.fetch(across.face()));
        let corners = *self.planar.corners(face);
        for corner in sides {
            let side = &shape[corner];
            let Some(across) = side.twin() else { continue };
            let neighbour = across.face();
            let state = self.state[neighbour.index()];
            if !state.is_free() {
                continue;
            }
            let state = state.join_beside(across.corner());
            self.state[neighbour.index()] = state;
            let laid = side.behind(across, ends(&corners, corner));
            let cost = if state.beside().is_power_of_two() {
                // Nothing else lies beside it, so it opens nothing.
                Cost::new(0.0, self.tie_of(side.bend(), &laid, None))
            } else {
                self.fit(across, state.beside(), &laid).cost
            };
            self.planar.lay(neighbour, laid);
            self.frontier.push(cost, across);
        }
    }

    /// Asks for all that will be looked at of a face.
    #[inline]
    fn fetch(&self, face: FaceId) {
        self.shapes.fetch(face);
        self.planar.fetch(face);
    }

    fn tie_of(&self, bend: f64, corners: &[DVec2; 3], widest: Option<f64>) -> f64 {
        match (self.tie, widest) {
            (Tie::Flattest, Some(_)) => 0.0,
            (Tie::Flattest, None) => bend,
            (Tie::Nearest, _) => (corners[0] + corners[1] + corners[2]).length(),
            (Tie::Tightest, widest) => widest.unwrap_or(0.0),
        }
    }

    /// What it does to attach a face across a side, when it is laid there and neighbours across the sides `beside` have
    /// joined, that side among them.
    fn fit(&self, across: HalfedgeId, beside: u8, corners: &[DVec2; 3]) -> Fit {
        let sides = &self.shapes.of(across.face()).0;
        let first = &sides[across.corner()];
        let (mut open, mut closed) = (0.0, first.length());
        let mut widest: Option<f64> = None;
        let mut meet = |corner: usize| {
            let Some(twin) = sides[corner].twin() else { return };
            let gap = self.planar.gap(ends(corners, corner), twin);
            widest = Some(widest.map_or(gap, |w| w.max(gap)));
            let length = sides[corner].length();
            if gap > self.tolerance { open += length } else { closed += length }
        };
        let others = beside & !(1 << across.corner());
        if others.is_power_of_two() {
            meet(others.trailing_zeros() as usize);
        } else if others != 0 {
            meet(across.next().corner());
            meet(across.previous().corner());
        }
        Fit { cost: Cost::new(open / (open + closed), self.tie_of(first.bend(), corners, widest)), open }
    }
}
