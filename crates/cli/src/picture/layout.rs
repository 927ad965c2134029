//! Boxes side by side.

use glam::DVec2;

/// Where boxes lie, none over another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    /// The upper left corner of each box; y grows downwards.
    pub(crate) corners: Vec<DVec2>,
    /// The size of all together.
    pub(crate) size: DVec2,
}

struct Shelf {
    top: f64,
    filled: f64,
}

/// Puts boxes on shelves, the highest first, each on the first shelf with room (first fit, decreasing height).
/// The gap between boxes is the share `gap` of the width. The whole comes out about square.
pub(crate) fn shelves(sizes: &[DVec2], gap: f64) -> Layout {
    let area: f64 = sizes.iter().map(|s| s.x * s.y).sum();
    let widest = sizes.iter().map(|s| s.x).fold(0.0, f64::max);
    // Shelves waste some room; a little more than the square root of the area keeps the whole about square.
    let width = widest.max(1.2 * area.sqrt());
    let gap = gap * width;
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by(|&a, &b| sizes[b].y.total_cmp(&sizes[a].y));
    let mut shelves: Vec<Shelf> = Vec::new();
    let mut corners = vec![DVec2::ZERO; sizes.len()];
    let mut size = DVec2::ZERO;
    for i in order {
        let found = shelves.iter().position(|shelf| shelf.filled + sizes[i].x <= width);
        let shelf = match found {
            Some(at) => &mut shelves[at],
            None => {
                let top = if shelves.is_empty() { 0.0 } else { size.y + gap };
                shelves.push(Shelf { top, filled: 0.0 });
                shelves.last_mut().expect("just pushed")
            }
        };
        corners[i] = DVec2::new(shelf.filled, shelf.top);
        size = size.max(corners[i] + sizes[i]);
        shelf.filled += sizes[i].x + gap;
    }
    Layout { corners, size }
}
