//! Lays the triangles of a segment side by side in the plane.

use std::hint::select_unpredictable;
use std::num::NonZero;
use std::ops::Range;

use glam::{DMat2, DVec2};
use prefetch_index::prefetch_index;

use super::FacePlace;
use crate::geometry::triangle;
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::segment::{Attachment, Segment};

/// What lies anywhere is asked for so many steps before it is looked at.
pub(super) const AHEAD: usize = 8;

/// The corner after each of a triangle.
pub(super) const NEXT: [usize; 3] = [1, 2, 0];

/// The triangles of a strip in the plane. Side `c` of its `i`-th face is `3 i + c`.
pub(super) struct Planar {
    pub(super) faces: Vec<FaceId>,
    pub(super) corners: Vec<[u32; 3]>,
    pub(super) vertices: Vec<DVec2>,
    /// The area: that of its faces.
    pub(super) area: f64,
}

impl Planar {
    /// The planar vertices at the ends of a side: start, end.
    #[inline]
    pub(super) fn ends(&self, side: u32) -> (u32, u32) {
        let corners = &self.corners[side as usize / 3];
        let corner = side as usize % 3;
        (corners[corner], corners[NEXT[corner]])
    }

    /// Calls the vertices by other names.
    pub(super) fn rename(&mut self, names: &[u32]) {
        parallel::change_chunks(&mut self.corners, BLOCK, |_, corners| {
            for v in corners.as_flattened_mut() {
                *v = names[*v as usize];
            }
        });
    }
}

/// For each triangle of a segment the side of the strip's faces that it is attached to; none for the first one.
pub(super) struct Links(Vec<Option<NonZero<u32>>>);

impl Links {
    pub(super) fn new(mesh: &SurfaceMesh, segment: &Segment, places: &[FacePlace]) -> Self {
        let attachments = &segment.attachments[..];
        let across = |i: usize| attachments.get(i)?.across;
        let link = |i: usize| {
            across(i + 2 * AHEAD).into_iter().for_each(|side| mesh.topology().fetch_twin(side));
            if let Some(twin) = across(i + AHEAD).and_then(|side| mesh.topology().twin(side)) {
                prefetch_index(places, twin.face().index());
            }
            let twin = mesh.topology().twin(attachments[i].across?)?;
            // One more than its number, which needs no room to say that there is none.
            NonZero::new(3 * places[twin.face().index()].index + twin.corner() as u32 + 1)
        };
        Self(parallel::map(attachments.len(), link))
    }

    #[inline]
    pub(super) fn of(&self, i: usize) -> Option<u32> {
        self.0[i].map(|number| number.get() - 1)
    }
}

/// The corner at which the side of a face starts that is attached.
#[inline]
pub(super) fn first_corner(attachment: &Attachment) -> usize {
    attachment.across.map_or(0, HalfedgeId::corner)
}

/// A triangle by itself.
struct Shape {
    /// Where its third corner lies when the side that is attached starts at the origin and runs along the x-axis, and
    /// that side's length.
    apex: DVec2,
    length: f64,
    area: f64,
}

impl Shape {
    fn new(mesh: &SurfaceMesh, attachment: &Attachment) -> Self {
        let (face, first) = (attachment.face, first_corner(attachment));
        let corners = mesh.topology().corners(face);
        let at = |corner: usize| mesh.position(corners[corner]);
        let (length, x, y) = triangle::flatten(at(first), at(NEXT[first]), at(NEXT[NEXT[first]]));
        Self { apex: DVec2::new(x, y), length, area: mesh.face_area(face) }
    }
}

/// Lays the triangles along the segment's spanning tree.
pub(super) fn lay(mesh: &SurfaceMesh, segment: &Segment, links: &Links) -> Planar {
    let attachments = &segment.attachments[..];
    let count = attachments.len();
    let mut planar = Planar {
        faces: attachments.iter().map(|attachment| attachment.face).collect(),
        corners: Vec::with_capacity(count),
        vertices: Vec::with_capacity(count + 2),
        area: 0.0,
    };
    // Shapes do not depend on each other, only places do: pieces that are small enough to stay in the cache, the next one
    // made while one is laid.
    const PIECE: usize = 1 << 13;
    let piece = |start: usize| start..(start + PIECE).min(count);
    let shapes = |piece: Range<usize>| {
        let shape = |i: usize| {
            let i = piece.start + i;
            // Triangles of a segment follow each other as they joined, so they lie anywhere.
            attachments.get(i + 2 * AHEAD).into_iter().for_each(|a| mesh.topology().fetch_corners(a.face));
            attachments.get(i + AHEAD).into_iter().for_each(|a| mesh.fetch(a.face));
            Shape::new(mesh, &attachments[i])
        };
        parallel::map(piece.len(), shape)
    };
    let mut next = shapes(piece(0));
    for start in (0..count).step_by(PIECE) {
        let ready = std::mem::take(&mut next);
        let lay = || planar.extend(&attachments[piece(start)], links, ready);
        ((), next) = parallel::join(lay, || shapes(piece((start + PIECE).min(count))));
    }
    planar
}

impl Planar {
    /// Lays the next triangles.
    fn extend(&mut self, attachments: &[Attachment], links: &Links, shapes: Vec<Shape>) {
        let mut sum = self.area;
        for (attachment, Shape { apex, length, area }) in attachments.iter().zip(shapes) {
            let third = self.vertices.len() as u32;
            let corners = match links.of(self.corners.len()) {
                Some(on) => {
                    // The side runs the other way.
                    let (to, from) = self.ends(on);
                    let a = self.vertices[from as usize];
                    let along = (self.vertices[to as usize] - a).try_normalize().unwrap_or(DVec2::X);
                    self.vertices.push(a + along * apex.x + along.perp() * apex.y);
                    turned([from, to, third], first_corner(attachment))
                }
                None => {
                    self.vertices.extend([DVec2::ZERO, DVec2::new(length, 0.0), apex]);
                    [third, third + 1, third + 2]
                }
            };
            self.corners.push(corners);
            sum += area;
        }
        self.area = sum;
    }
}

/// Three in order, so turned that the first is at `corner`. Chosen without jumps, which could not be foreseen.
#[inline]
fn turned([a, b, c]: [u32; 3], corner: usize) -> [u32; 3] {
    let (at_1, at_2) = (corner == 1, corner == 2);
    let turned = |a, b, c| select_unpredictable(at_2, c, select_unpredictable(at_1, b, a));
    [turned(a, c, b), turned(b, a, c), turned(c, b, a)]
}

/// How many ways to turn a strip are tried.
const TURNS: usize = 12;

/// So many turns are tried at a time: as many as the registers hold.
const GROUP: usize = 4;

/// So many vertices stay in the cache.
const BLOCK: usize = 1 << 10;

/// The boxes around turned vertices, one a turn.
#[derive(Clone, Copy)]
struct Boxes {
    low: [[f64; GROUP]; 2],
    high: [[f64; GROUP]; 2],
}

impl Boxes {
    const NONE: Self = Self { low: [[f64::INFINITY; GROUP]; 2], high: [[f64::NEG_INFINITY; GROUP]; 2] };

    fn around(vertices: &[DVec2], turns: &[DMat2; GROUP]) -> Self {
        let mut boxes = Self::NONE;
        for &v in vertices {
            let turned = turns.map(|turn| turn * v);
            boxes
                .hold([turned.map(|v| v.x), turned.map(|v| v.y)], [turned.map(|v| v.x), turned.map(|v| v.y)]);
        }
        boxes
    }

    /// Grows so that each holds another one.
    #[inline]
    fn hold(&mut self, low: [[f64; GROUP]; 2], high: [[f64; GROUP]; 2]) {
        for axis in 0..2 {
            for lane in 0..GROUP {
                let (least, greatest) = (&mut self.low[axis][lane], &mut self.high[axis][lane]);
                *least = if *least < low[axis][lane] { *least } else { low[axis][lane] };
                *greatest = if *greatest > high[axis][lane] { *greatest } else { high[axis][lane] };
            }
        }
    }

    fn of(&self, lane: usize) -> (DVec2, DVec2) {
        let corner = |of: &[[f64; GROUP]; 2]| DVec2::new(of[0][lane], of[1][lane]);
        (corner(&self.low), corner(&self.high))
    }
}

/// Turns the strip so that the square around it is small and moves it so that the box around it starts at (0, 0). Gives
/// the upper right corner of that box.
pub(super) fn settle(vertices: &mut [DVec2]) -> DVec2 {
    let turns: [[DMat2; GROUP]; TURNS / GROUP] = std::array::from_fn(|group| {
        std::array::from_fn(|lane| {
            let turn = (GROUP * group + lane) as f64;
            let (sin, cos) = libm::sincos(turn * std::f64::consts::FRAC_PI_2 / TURNS as f64);
            DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos))
        })
    });
    let blocks = parallel::map_chunks(vertices.len(), BLOCK, |block| {
        turns.each_ref().map(|turns| Boxes::around(&vertices[block.clone()], turns))
    });
    let mut boxes = [Boxes::NONE; TURNS / GROUP];
    for block in blocks {
        for (all, part) in boxes.iter_mut().zip(block) {
            all.hold(part.low, part.high);
        }
    }
    let mut best = (f64::INFINITY, DMat2::IDENTITY, DVec2::ZERO, DVec2::ZERO);
    for (turn, (low, high)) in
        turns.into_iter().flatten().zip(boxes.iter().flat_map(|boxes| (0..GROUP).map(|lane| boxes.of(lane))))
    {
        let extent = high - low;
        // A turn must pay: for a plane figure drawn along the axes, staying put keeps its coordinates exact.
        if extent.max_element() < best.0 * (1.0 - 1e-6) {
            best = (extent.max_element(), turn, low, extent);
        }
    }
    let (_, turn, low, extent) = best;
    parallel::change_chunks(vertices, BLOCK, |_, block| {
        for v in block {
            *v = turn * *v - low;
        }
    });
    extent
}
