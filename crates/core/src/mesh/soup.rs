//! Polygons as files give them: nothing is checked yet.

use glam::DVec3;

/// Positions and polygons, unchecked: indices may be out of range, coordinates may not be finite.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolygonSoup {
    /// Vertex positions, in the file's units and axes.
    pub positions: Vec<DVec3>,
    /// The corners of all polygons, one polygon after the other: indices into `positions`.
    pub corners: Vec<u32>,
    /// Where each polygon's corners end in `corners`; one entry a polygon, ascending.
    pub ends: Vec<u32>,
}

impl PolygonSoup {
    /// Appends a polygon with these corners, counterclockwise seen from outside.
    pub fn push_polygon(&mut self, corners: &[u32]) {
        self.corners.extend_from_slice(corners);
        self.ends.push(u32::try_from(self.corners.len()).expect("corner count fits in 32 bits"));
    }

    /// How many polygons there are.
    pub fn polygon_count(&self) -> usize {
        self.ends.len()
    }

    /// The place of polygon `polygon`'s corners in `corners`.
    pub fn corner_range(&self, polygon: usize) -> std::ops::Range<usize> {
        let start = if polygon == 0 { 0 } else { self.ends[polygon - 1] as usize };
        start..self.ends[polygon] as usize
    }

    /// The corners of polygon `polygon`.
    pub fn polygon(&self, polygon: usize) -> &[u32] {
        &self.corners[self.corner_range(polygon)]
    }
}
