//! Which parts of the square hold points at all: where points are few, most triangles catch none.

use glam::DVec2;

/// The square in cells, a bit for each.
#[derive(Clone, Debug)]
pub(super) struct Occupied {
    /// Cells along a side, at least 64.
    cells: usize,
    /// Cells for a unit of length.
    scale: f64,
    /// Row after row, 64 cells in each.
    words: Vec<u64>,
}

/// About so many cells for each point, or up to twice as many along each axis, so that few hold one.
const CELLS: u64 = 32;

/// Of more points it is not worth while to know: the bits would take more than 128 KiB of the cache.
const MOST: u64 = 1 << 15;

/// A box that reaches over more cells than this in x or in y is not looked at.
const WIDEST: usize = 8;

impl Occupied {
    /// Of points that lie in a square with this side; `None` where they are many.
    pub(super) fn new(side: f64, count: u64, place: impl Fn(u64) -> DVec2) -> Option<Self> {
        if count > MOST {
            return None;
        }
        let cells = (libm::sqrt((count * CELLS) as f64) as usize).next_power_of_two().max(64);
        let mut occupied = Self { cells, scale: cells as f64 / side, words: vec![0; cells * cells / 64] };
        for place in (0..count).map(place) {
            let [column, row] = place.to_array().map(|x| occupied.cell(x));
            occupied.words[(row * cells + column) / 64] |= 1 << (column % 64);
        }
        Some(occupied)
    }

    /// Into which column a place falls, or into which row. It does not fall as the coordinate rises.
    #[inline]
    fn cell(&self, x: f64) -> usize {
        // The cast saturates.
        ((x * self.scale) as usize).min(self.cells - 1)
    }

    /// Whether there may be points in a box.
    #[inline]
    pub(super) fn may_hold(&self, low: DVec2, high: DVec2) -> bool {
        let [left, right] = [low.x, high.x].map(|x| self.cell(x));
        let [bottom, top] = [low.y, high.y].map(|y| self.cell(y));
        if right - left > WIDEST || top - bottom > WIDEST {
            return true;
        }
        let bits = (2 << (right - left)) - 1;
        (bottom..=top).any(|row| {
            let first = row * self.cells + left;
            let (word, shift) = (first / 64, first % 64);
            let beyond =
                if shift > 0 { self.words.get(word + 1).map_or(0, |next| next << (64 - shift)) } else { 0 };
            (self.words[word] >> shift | beyond) & bits != 0
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// No box with a point in it is passed over, and small boxes far from all points are.
        #[test]
        fn boxes_with_points_may_hold_them(
            points in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 1..40),
            corner in (-0.1..1.1_f64, -0.1..1.1_f64),
            extent in (0.0..0.2_f64, 0.0..0.2_f64),
        ) {
            let side = 3.7;
            let points: Vec<DVec2> = points.into_iter().map(|(x, y)| DVec2::new(x, y) * side).collect();
            let occupied = Occupied::new(side, points.len() as u64, |i| points[i as usize]).unwrap();
            let low = DVec2::from(corner) * side;
            let high = low + DVec2::from(extent) * side;
            let is_in = |p: &DVec2| p.cmpge(low).all() && p.cmple(high).all();
            let cell = side / occupied.cells as f64;
            let is_near = |p: &DVec2| p.cmpge(low - cell).all() && p.cmple(high + cell).all();
            if points.iter().any(is_in) {
                prop_assert!(occupied.may_hold(low, high));
            }
            let is_inside = low.cmpge(DVec2::ZERO).all() && high.cmple(DVec2::splat(side)).all();
            if is_inside && (high - low).max_element() < cell && !points.iter().any(is_near) {
                prop_assert!(!occupied.may_hold(low, high));
            }
        }
    }
}
