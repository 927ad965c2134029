//! Grids bent into surfaces.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::mesh::soup::PolygonSoup;

/// A surface of triangles under construction.
#[derive(Default)]
pub(super) struct Surface {
    pub(super) positions: Vec<DVec3>,
    pub(super) faces: Vec<[u32; 3]>,
}

impl Surface {
    /// Adds the quad with these corners, counterclockwise seen from outside, as two triangles.
    pub(super) fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.faces.push([a, b, c]);
        self.faces.push([a, c, d]);
    }

    /// Adds another surface beside this one.
    pub(super) fn append(&mut self, other: &Self) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.faces.extend(other.faces.iter().map(|f| f.map(|v| v + first)));
    }

    /// Drops the vertices that no face has.
    pub(super) fn compact(&mut self) {
        let mut used = vec![false; self.positions.len()];
        self.faces.iter().flatten().for_each(|&v| used[v as usize] = true);
        let mut place = Vec::with_capacity(used.len());
        let mut count = 0;
        for &used in &used {
            place.push(count);
            count += u32::from(used);
        }
        self.faces.iter_mut().flatten().for_each(|v| *v = place[*v as usize]);
        let mut used = used.into_iter();
        self.positions.retain(|_| used.next().unwrap_or(false));
    }

    pub(super) fn into_soup(self) -> PolygonSoup {
        let mut soup = PolygonSoup { positions: self.positions, ..PolygonSoup::default() };
        soup.corners.reserve_exact(3 * self.faces.len());
        soup.ends.reserve_exact(self.faces.len());
        for face in &self.faces {
            soup.push_polygon(face);
        }
        soup
    }
}

/// The point `part / whole` of the way around the unit circle.
pub(super) fn on_circle(part: u32, whole: u32) -> DVec2 {
    let (sin, cos) = libm::sincos(TAU * f64::from(part) / f64::from(whole));
    DVec2::new(cos, sin)
}

/// A closed surface of rings between two poles. Ring 0 lies next to `bottom`, `point(ring, segment)` goes
/// counterclockwise seen from above `top`. Vertices: bottom, the rings, top.
pub(super) fn between_poles(
    bottom: DVec3,
    top: DVec3,
    rings: u32,
    segments: u32,
    point: impl Fn(u32, u32) -> DVec3,
) -> Surface {
    let mut surface = Surface::default();
    surface.positions.push(bottom);
    for ring in 0..rings {
        surface.positions.extend((0..segments).map(|segment| point(ring, segment)));
    }
    surface.positions.push(top);
    let at = |ring: u32, segment: u32| 1 + ring * segments + segment % segments;
    let last = 1 + rings * segments;
    for s in 0..segments {
        surface.faces.push([0, at(0, s + 1), at(0, s)]);
    }
    for ring in 1..rings {
        for s in 0..segments {
            surface.quad([at(ring - 1, s), at(ring - 1, s + 1), at(ring, s + 1), at(ring, s)]);
        }
    }
    for s in 0..segments {
        surface.faces.push([last, at(rings - 1, s), at(rings - 1, s + 1)]);
    }
    surface
}

/// A tube of rings, the last joined to the first. `point(ring, segment)` goes counterclockwise around the direction
/// in which the rings advance.
pub(super) fn closed_tube(rings: u32, segments: u32, point: impl Fn(u32, u32) -> DVec3) -> Surface {
    let mut surface = open_tube(rings, segments, point);
    let last = (rings - 1) * segments;
    for s in 0..segments {
        let t = (s + 1) % segments;
        surface.quad([last + s, last + t, t, s]);
    }
    surface
}

/// A tube of rings with a border at each end; see [`closed_tube`].
pub(super) fn open_tube(rings: u32, segments: u32, point: impl Fn(u32, u32) -> DVec3) -> Surface {
    let mut surface = Surface::default();
    for ring in 0..rings {
        surface.positions.extend((0..segments).map(|segment| point(ring, segment)));
    }
    for ring in 1..rings {
        let (low, high) = ((ring - 1) * segments, ring * segments);
        for s in 0..segments {
            let t = (s + 1) % segments;
            surface.quad([low + s, low + t, high + t, high + s]);
        }
    }
    surface
}
