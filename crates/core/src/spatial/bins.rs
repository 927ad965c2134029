//! Many places against one camera: the image is cut into cells, and a place is held against the triangles of its
//! cell. Gives the same answers as one ray at a time, and faster when there are many places.

use glam::{DVec2, DVec3};

use super::caster::{Camera, Caster};
use crate::ids::FaceId;

/// Cells are worth making from this many faces for each place on: below, walking the tree is faster.
const FACES_PER_PLACE: usize = 6;

/// How far triangles reach beyond their rim, in cells: far more than rounding moves them.
const MARGIN: f64 = 1e-6;

/// Perspective cameras nearer than this to the middle of the cube, in half diagonals of the box, walk the tree:
/// the image of what lies beside or behind them is not finite.
const CLEAR: f64 = 1.2;

impl Caster {
    /// Which of these places the camera sees: the same as [`sees`](Self::sees) for each. About 0.1 microseconds
    /// each when there are more of them than faces.
    pub fn visible(&self, camera: &Camera, places: &[(FaceId, DVec3)]) -> Vec<bool> {
        let image =
            (places.len() * FACES_PER_PLACE > self.face_count()).then(|| Image::of(self, camera)).flatten();
        match image {
            Some(image) => {
                let bins = Bins::new(self, camera, image);
                places
                    .iter()
                    .map(|&(face, at)| {
                        self.is_facing(camera, face, at) && bins.is_clear(self, camera, face, at)
                    })
                    .collect()
            }
            None => places.iter().map(|&(face, at)| self.sees(camera, face, at)).collect(),
        }
    }
}

/// The projection of a camera, in the cube: every ray to the camera is one point of the image, and climbs.
#[derive(Clone, Copy)]
struct Image {
    right: DVec3,
    up: DVec3,
    toward: DVec3,
    /// The height of a perspective camera.
    eye: Option<f64>,
}

impl Image {
    /// `None` for a camera that does not lie clear of the mesh.
    fn of(caster: &Caster, camera: &Camera) -> Option<Self> {
        let (toward, eye) = match *camera {
            Camera::Orthographic { toward } => (toward, None),
            Camera::Perspective { eye } => {
                let eye = caster.enter(eye);
                let height = eye.length();
                if !(height > CLEAR * caster.reach() && height.is_finite()) {
                    return None;
                }
                (eye / height, Some(height))
            }
        };
        let toward = toward.try_normalize()?;
        let (right, up) = toward.any_orthonormal_pair();
        Some(Self { right, up, toward, eye })
    }

    /// Where a place of the cube appears, and how high it lies.
    #[inline]
    fn project(&self, p: DVec3) -> (DVec2, f64) {
        let flat = DVec2::new(p.dot(self.right), p.dot(self.up));
        let height = p.dot(self.toward);
        match self.eye {
            None => (flat, height),
            Some(eye) => (flat / (1.0 - height / eye), height),
        }
    }
}

struct Bins {
    image: Image,
    low: DVec2,
    /// Cells per unit of the image.
    scale: f64,
    columns: usize,
    rows: usize,
    /// Where each cell, row after row, starts in `slots`; one more at the end.
    starts: Vec<u32>,
    /// Slots of triangles of the caster.
    slots: Vec<u32>,
    /// For each slot how high its triangle reaches.
    tops: Vec<f64>,
}

impl Bins {
    fn new(caster: &Caster, camera: &Camera, image: Image) -> Self {
        // A ray that leaves a closed component does so through a face turned towards the camera: the others need
        // not be looked at, as no camera is inside.
        let mut shown = Vec::new();
        let mut tops = vec![f64::NEG_INFINITY; caster.face_count()];
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (slot, top) in tops.iter_mut().enumerate() {
            if !caster.is_slot_facing(camera, slot) {
                continue;
            }
            let corners = caster.slot_corners(slot).map(|corner| {
                let (at, height) = image.project(corner);
                *top = top.max(height);
                low = low.min(at);
                high = high.max(at);
                at
            });
            shown.push((slot as u32, corners));
        }
        // About as many cells as triangles.
        let extent = (high - low).max(DVec2::ZERO);
        let wanted = shown.len().max(1) as f64;
        let largest = extent.max_element();
        let side = (extent.x * extent.y / wanted).sqrt().max(largest / wanted).max(f64::MIN_POSITIVE);
        let scale = 1.0 / side;
        let count = |length: f64| ((length * scale) as usize + 1).min(1 << 14);
        let (columns, rows) = (count(extent.x), count(extent.y));
        let mut bins = Self {
            image,
            low,
            scale,
            columns,
            rows,
            starts: vec![0; columns * rows + 1],
            slots: Vec::new(),
            tops,
        };
        for (_, corners) in &mut shown {
            *corners = corners.map(|at| (at - low) * scale);
        }
        let mut starts = std::mem::take(&mut bins.starts);
        for (_, corners) in &shown {
            bins.cells_of(corners, |cell| starts[cell + 1] += 1);
        }
        for cell in 0..columns * rows {
            starts[cell + 1] += starts[cell];
        }
        let mut cursors = starts.clone();
        let mut slots = vec![0; starts[columns * rows] as usize];
        for (slot, corners) in &shown {
            bins.cells_of(corners, |cell| {
                slots[cursors[cell] as usize] = *slot;
                cursors[cell] += 1;
            });
        }
        (bins.starts, bins.slots) = (starts, slots);
        bins
    }

    /// Calls `f` with every cell that the triangle touches, its corners given in cells.
    fn cells_of(&self, corners: &[DVec2; 3], mut f: impl FnMut(usize)) {
        let [a, b, c] = *corners;
        let (first, last) = (
            index(a.y.min(b.y).min(c.y) - MARGIN, self.rows),
            index(a.y.max(b.y).max(c.y) + MARGIN, self.rows),
        );
        for row in first..=last {
            let (low, high) = if first == last {
                (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x))
            } else {
                span(corners, row as f64 - MARGIN, (row + 1) as f64 + MARGIN)
            };
            if low > high {
                continue;
            }
            for column in index(low - MARGIN, self.columns)..=index(high + MARGIN, self.columns) {
                f(row * self.columns + column);
            }
        }
    }

    #[inline]
    fn is_clear(&self, caster: &Caster, camera: &Camera, face: FaceId, at: DVec3) -> bool {
        let origin = caster.enter(at);
        let (place, height) = self.image.project(origin);
        let place = (place - self.low) * self.scale;
        let cell = index(place.y, self.rows) * self.columns + index(place.x, self.columns);
        let (direction, length) = caster.aim(camera, origin);
        self.slots[self.starts[cell] as usize..self.starts[cell + 1] as usize].iter().all(|&slot| {
            let slot = slot as usize;
            self.tops[slot] <= height || !caster.blocks(slot, face, origin, direction, length)
        })
    }
}

/// The cell that holds a coordinate; what lies beyond the rim belongs to the last.
#[inline]
fn index(coordinate: f64, count: usize) -> usize {
    // The cast of a negative number is zero.
    (coordinate as usize).min(count - 1)
}

/// From where to where along x the triangle reaches between two heights; low > high when it does not lie there.
fn span(corners: &[DVec2; 3], from: f64, to: f64) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a.y.max(b.y) < from || a.y.min(b.y) > to {
            continue;
        }
        let rise = b.y - a.y;
        for y in [a.y.clamp(from, to), b.y.clamp(from, to)] {
            let t = if rise == 0.0 { 0.0 } else { ((y - a.y) / rise).clamp(0.0, 1.0) };
            let x = a.x + (b.x - a.x) * t;
            low = low.min(x);
            high = high.max(x);
        }
        if rise == 0.0 {
            low = low.min(b.x);
            high = high.max(b.x);
        }
    }
    (low, high)
}
