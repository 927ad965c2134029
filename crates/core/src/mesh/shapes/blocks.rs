//! Flat sides and sharp edges.

use std::collections::HashMap;

use glam::DVec3;

use crate::mesh::shapes::grid::Surface;
use crate::mesh::soup::PolygonSoup;

/// A box from the origin to `size`, each side of it cut into a grid of `cells` along x, y and z. Two triangles a cell of
/// the grid; area 2 (xy + yz + zx).
pub fn block(size: DVec3, cells: [u32; 3]) -> PolygonSoup {
    let cells = cells.map(|n| n.max(1));
    let mut surface = Surface::default();
    let mut known = HashMap::new();
    // For each pair of opposite sides: the axis across them, then the two along them, in right-handed order.
    for across in 0..3 {
        let (u, v) = ((across + 1) % 3, (across + 2) % 3);
        for level in [0, cells[across]] {
            let mut vertex = |i: u32, j: u32| {
                let mut place = [0; 3];
                (place[across], place[u], place[v]) = (level, i, j);
                *known.entry(place).or_insert_with(|| {
                    let along = |axis: usize| f64::from(place[axis]) / f64::from(cells[axis]) * size[axis];
                    surface.positions.push(DVec3::new(along(0), along(1), along(2)));
                    surface.positions.len() as u32 - 1
                })
            };
            let mut quads = Vec::with_capacity(cells[u] as usize * cells[v] as usize);
            for j in 0..cells[v] {
                for i in 0..cells[u] {
                    quads.push([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
                }
            }
            for [a, b, c, d] in quads {
                surface.quad(if level == 0 { [a, d, c, b] } else { [a, b, c, d] });
            }
        }
    }
    surface.into_soup()
}

/// The unit cube; 12 n^2 triangles for n subdivisions of an edge, area 6.
pub fn cube(subdivisions: u32) -> PolygonSoup {
    block(DVec3::ONE, [subdivisions; 3])
}

/// A closed plate of 1 x 1 x `thickness`: 4 n^2 + 8 n triangles for n subdivisions of a long edge.
pub fn plate(subdivisions: u32, thickness: f64) -> PolygonSoup {
    block(DVec3::new(1.0, 1.0, thickness), [subdivisions, subdivisions, 1])
}

/// The unit square in the plane z = 0, normal up, with a border: 2 n^2 triangles, area 1.
pub fn square(subdivisions: u32) -> PolygonSoup {
    let n = subdivisions.max(1);
    let mut surface = Surface::default();
    for j in 0..=n {
        for i in 0..=n {
            let along = |k: u32| f64::from(k) / f64::from(n);
            surface.positions.push(DVec3::new(along(i), along(j), 0.0));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            surface.quad([a, a + 1, a + n + 2, a + n + 1]);
        }
    }
    surface.into_soup()
}

/// The regular tetrahedron with edges of sqrt(8) in the cube from -1 to 1: area 8 sqrt(3).
pub fn tetrahedron() -> PolygonSoup {
    let positions = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
        .map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z)))
        .to_vec();
    Surface { positions, faces: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]] }.into_soup()
}
