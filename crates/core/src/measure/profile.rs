//! The surface and points seen along a direction: their shares below parallel planes.

use glam::DVec3;

use crate::mesh::SurfaceMesh;

/// Triangles that reach over more cells than this are written as ramps, summed up once for all.
const SHORT: usize = 12;

/// The surface as all directions use it: the corners of its faces, around its middle.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    corners: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    shares: Vec<f64>,
    /// The middle of the mesh: far from it the last digits of the positions would be lost in the products.
    origin: DVec3,
}

/// The shares of area below the planes `low + k width`, `k` from 0, all between the ends of the mesh along the
/// direction.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    direction: DVec3,
    origin: DVec3,
    low: f64,
    /// From plane to plane.
    pub(super) width: f64,
    /// The share of area below each plane, exact up to rounding; faces in the plane do not count, as points do not.
    pub(super) area: Vec<f64>,
}

impl Scene {
    pub(super) fn new(mesh: &SurfaceMesh) -> Self {
        const UNUSED: u32 = u32::MAX;
        let (low, high) = mesh.bounds();
        let origin = (low + high) * 0.5;
        let mut place = vec![UNUSED; mesh.vertex_count()];
        let mut corners = Vec::new();
        let faces = mesh.topology().faces().iter().map(|face| {
            face.map(|vertex| {
                let slot = &mut place[vertex.index()];
                if *slot == UNUSED {
                    *slot = corners.len() as u32;
                    corners.push(mesh.position(vertex) - origin);
                }
                *slot
            })
        });
        Self {
            faces: faces.collect(),
            corners,
            shares: mesh.face_areas().iter().map(|a| a / mesh.area()).collect(),
            origin,
        }
    }

    pub(super) fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The shares below `planes` planes across `direction`, a unit vector; the first lies `shift` (0 to 1) of the
    /// distance between planes above the lowest corner. `None` when the mesh has no extent that way.
    ///
    /// O(vertices + triangles + planes), however many planes cut a triangle.
    pub(super) fn profile(&self, direction: DVec3, planes: usize, shift: f64) -> Option<Profile> {
        let mut along: Vec<f64> = self.corners.iter().map(|p| p.dot(direction)).collect();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for &t in &along {
            low = lesser(t, low);
            high = greater(t, high);
        }
        let width = (high - low) / planes as f64;
        let scale = 1.0 / width;
        if !(width > 0.0 && scale.is_finite()) {
            return None;
        }
        // In units of cells; plane k lies at k + 1, so cell k holds what lies between the planes k - 1 and k.
        for t in &mut along {
            *t = (*t - low) * scale + (1.0 - shift);
        }
        let mut mass = Mass::new(planes + 1);
        for (corners, &share) in self.faces.iter().zip(&self.shares) {
            mass.add_triangle(corners.map(|v| along[v as usize]), share);
        }
        let mut area = mass.finish();
        area.truncate(planes);
        Some(Profile { direction, origin: self.origin, low: low + shift * width, width, area })
    }
}

impl Profile {
    /// Where plane `plane` lies: the product of the direction with its places.
    pub(super) fn offset(&self, plane: usize) -> f64 {
        self.low + plane as f64 * self.width + self.origin.dot(self.direction)
    }

    /// The share of the points below each plane.
    pub(super) fn points_below(&self, points: &[DVec3]) -> Vec<f64> {
        let planes = self.area.len();
        let scale = 1.0 / self.width;
        let mut counts = vec![0u32; planes + 1];
        for p in points {
            let along = (*p - self.origin).dot(self.direction);
            // Below the first plane the cast gives 0; rounding may put a point above the last cell.
            counts[((((along - self.low) * scale) + 1.0) as u32 as usize).min(planes)] += 1;
        }
        let mut below = 0u32;
        counts[..planes]
            .iter()
            .map(|&count| {
                below += count;
                f64::from(below) / points.len() as f64
            })
            .collect()
    }
}

/// The lesser of two numbers; unlike `f64::min` one instruction, since neither is NaN.
#[inline]
fn lesser(x: f64, y: f64) -> f64 {
    if x < y { x } else { y }
}

/// The greater of two numbers, likewise.
#[inline]
fn greater(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

/// How much area falls into each cell of width 1.
struct Mass {
    cells: Vec<f64>,
    /// Long linear ramps: where their value, and their slope, jumps.
    value_jumps: Vec<f64>,
    slope_jumps: Vec<f64>,
}

impl Mass {
    fn new(cells: usize) -> Self {
        Self { cells: vec![0.0; cells], value_jumps: vec![0.0; cells + 1], slope_jumps: vec![0.0; cells + 1] }
    }

    /// Adds a triangle whose corners lie at `t`. Its density along the axis is a tent: it rises linearly from the
    /// lowest corner to the middle one and falls to the highest.
    #[inline]
    fn add_triangle(&mut self, t: [f64; 3], share: f64) {
        let (low, high) = (lesser(t[0], t[1]), greater(t[0], t[1]));
        let (a, b, c) = (lesser(low, t[2]), greater(low, lesser(high, t[2])), greater(high, t[2]));
        let last = self.cells.len() - 1;
        let (i, k) = ((a as u32 as usize).min(last), (c as u32 as usize).min(last));
        if i == k {
            self.cells[i] += share;
            return;
        }
        // The share below x is rising (x - a)^2 up to b, the share above it falling (c - x)^2 from there.
        let rising = share / ((b - a) * (c - a));
        let falling = share / ((c - b) * (c - a));
        if k - i > SHORT {
            self.add_long([a, b, c], share, rising, falling);
            return;
        }
        let mut before = 0.0;
        let mut plane = i as f64;
        for cell in &mut self.cells[i..k] {
            plane += 1.0;
            // A side without width is never chosen: a < plane <= c.
            let (up, down) = (plane - a, c - plane);
            let below = if plane <= b { rising * up * up } else { share - falling * down * down };
            *cell += below - before;
            before = below;
        }
        self.cells[k] += share - before;
    }

    /// Adds a triangle over many cells in constant time.
    fn add_long(&mut self, [a, b, c]: [f64; 3], share: f64, rising: f64, falling: f64) {
        let last = self.cells.len() - 1;
        let cell = |x: f64| (x as u32 as usize).min(last);
        let (i, j, k) = (cell(a), cell(b), cell(c));
        let left = share * (b - a) / (c - a);
        let right = share - left;
        if i == j {
            self.cells[i] += left;
        } else {
            let first = (i + 1) as f64 - a;
            let last = j as f64 - a;
            self.cells[i] += rising * first * first;
            self.add_ramp(i + 1, j, rising * (2.0 * first + 1.0), 2.0 * rising);
            self.cells[j] += left - rising * last * last;
        }
        if j == k {
            self.cells[j] += right;
        } else {
            let first = c - (j + 1) as f64;
            let last = c - k as f64;
            self.cells[j] += right - falling * first * first;
            self.add_ramp(j + 1, k, falling * (2.0 * first - 1.0), -2.0 * falling);
            self.cells[k] += falling * last * last;
        }
    }

    /// Adds `value` to cell `start`, `value + slope` to the next, and so on before `end`.
    #[inline]
    fn add_ramp(&mut self, start: usize, end: usize, value: f64, slope: f64) {
        if start < end {
            self.value_jumps[start] += value;
            self.slope_jumps[start + 1] += slope;
            self.value_jumps[end] -= value + slope * (end - start - 1) as f64;
            self.slope_jumps[end] -= slope;
        }
    }

    /// The mass up to the end of each cell.
    fn finish(self) -> Vec<f64> {
        let Self { mut cells, value_jumps, slope_jumps } = self;
        let (mut sum, mut value, mut slope) = (0.0, 0.0, 0.0);
        for ((cell, jump), bend) in cells.iter_mut().zip(&value_jumps).zip(&slope_jumps) {
            slope += bend;
            value += slope + jump;
            sum += *cell + value;
            *cell = sum;
        }
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// The share of a triangle with corners at `a <= b <= c` below `t`.
    fn below(a: f64, b: f64, c: f64, t: f64) -> f64 {
        if t <= a {
            0.0
        } else if t <= b {
            (t - a) * (t - a) / ((b - a) * (c - a))
        } else if t < c {
            1.0 - (c - t) * (c - t) / ((c - a) * (c - b))
        } else {
            1.0
        }
    }

    #[test]
    fn what_lies_in_a_plane_is_not_below_it() {
        // The base z = 0, the shelf z = 1/2 and the top z = 1 of equal areas; planes at 0, 1/4, 1/2 and 3/4.
        let corner = |z: f64| [DVec3::new(0.0, 0.0, z), DVec3::new(1.0, 0.0, z), DVec3::new(0.0, 1.0, z)];
        let positions = [corner(0.0), corner(0.5), corner(1.0)].concat();
        let mesh = crate::measure::testmesh::mesh(&positions, &[[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
        let profile = Scene::new(&mesh).profile(DVec3::Z, 4, 0.0).expect("the mesh has a height");
        let points = profile.points_below(&[positions[0], positions[3], positions[6]]);
        for (shares, name) in [(&profile.area, "area"), (&points, "points")] {
            for (share, below) in shares.iter().zip([0.0, 1.0, 1.0, 2.0]) {
                assert!((share - below / 3.0).abs() < 1e-15, "{name}: {shares:?}");
            }
        }
    }

    #[test]
    fn mass_of_triangles_is_exact_at_every_plane() {
        let mut random = Random::new(1, 2);
        for cells in [2usize, 5, 40, 1000] {
            let mut mass = Mass::new(cells);
            let mut expected = vec![0.0; cells];
            for k in 0..200 {
                let mut t = [random.unit(), random.unit(), random.unit()].map(|u| u * cells as f64 * 0.9999);
                if k % 4 == 0 {
                    t[1] = t[0];
                }
                if k % 5 == 0 {
                    t[2] = t[0].floor();
                }
                let share = random.unit();
                mass.add_triangle(t, share);
                t.sort_unstable_by(f64::total_cmp);
                for (cell, sum) in expected.iter_mut().enumerate() {
                    *sum += share * below(t[0], t[1], t[2], (cell + 1) as f64);
                }
            }
            for (got, want) in mass.finish().iter().zip(&expected) {
                assert!((got - want).abs() < 1e-12 * 200.0, "{got} {want} at {cells} cells");
            }
        }
    }
}
