//! The surface cut into tiles: triangles small against the distance of the points, each with a mass to share out.

use glam::DVec3;

use super::normals::CornerNormals;
use crate::geometry::triangle;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// A piece of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    pub(super) corners: [DVec3; 3],
    /// The scaled normals at the corners.
    pub(super) normals: [DVec3; 3],
    pub(super) face: FaceId,
    /// The patch that it belongs to.
    pub(super) patch: u32,
    /// Its share of the mass (area times density) to be spread over the points.
    pub(super) mass: f64,
}

impl Tile {
    pub(super) fn centre(&self) -> DVec3 {
        (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0
    }

    /// The mean scaled normal.
    pub(super) fn normal(&self) -> DVec3 {
        (self.normals[0] + self.normals[1] + self.normals[2]) / 3.0
    }

    /// The distance from the centre to the farthest corner.
    pub(super) fn radius(&self) -> f64 {
        let centre = self.centre();
        libm::sqrt(self.corners.iter().fold(0.0_f64, |m, c| m.max(c.distance_squared(centre))))
    }
}

/// Tiles in runs that lie close together.
pub(super) struct Tiles {
    pub(super) tiles: Vec<Tile>,
    /// Where each run of tiles of one cell and patch ends; ascending.
    pub(super) group_ends: Vec<u32>,
}

impl Tiles {
    /// The run of tiles of a group.
    pub(super) fn group(&self, group: usize) -> std::ops::Range<usize> {
        let start = if group == 0 { 0 } else { self.group_ends[group - 1] as usize };
        start..self.group_ends[group] as usize
    }

    /// Cuts the faces whose patch is given into tiles with no side longer than `longest`, and sorts them so that
    /// tiles of one cube of side `cell` stand together. `density` is the mass per area of each face, `bend` the length
    /// of a unit of normal.
    pub(super) fn cut(
        mesh: &SurfaceMesh,
        patch_of_face: &[Option<u32>],
        density: impl Fn(FaceId) -> f64 + Sync + Send,
        bend: f64,
        longest: f64,
        cell: f64,
    ) -> Self {
        const CHUNK: usize = 1 << 12;
        let (low, _) = mesh.bounds();
        let normals = CornerNormals::new(mesh, patch_of_face);
        let mut keyed: Vec<(u32, u64, Tile)> = parallel::map_chunks(mesh.face_count(), CHUNK, |range| {
            let mut tiles = Vec::with_capacity(range.len());
            for index in range {
                let face = FaceId::new(index);
                let Some(patch) = patch_of_face[index] else { continue };
                let (places, scaled) = (mesh.triangle(face), normals.of(face).map(|n| n * bend));
                let whole = std::array::from_fn(|c| (places[c], scaled[c]));
                split(whole, longest, &mut |split: [(DVec3, DVec3); 3]| {
                    let (corners, normals) = (split.map(|c| c.0), split.map(|c| c.1));
                    let mass = triangle::area(corners[0], corners[1], corners[2]) * density(face);
                    if mass > 0.0 {
                        let tile = Tile { corners, normals, face, patch, mass };
                        tiles.push((patch, cell_key(tile.centre() - low, cell), tile));
                    }
                });
            }
            tiles
        })
        .concat();
        sort(&mut keyed);
        let mut group_ends = Vec::new();
        for i in 1..keyed.len() {
            if (keyed[i].0, keyed[i].1) != (keyed[i - 1].0, keyed[i - 1].1) {
                group_ends.push(i as u32);
            }
        }
        group_ends.push(keyed.len() as u32);
        Self { tiles: keyed.into_iter().map(|(_, _, tile)| tile).collect(), group_ends }
    }
}

/// Stable: within a cell tiles keep the order of the faces.
fn sort(keyed: &mut [(u32, u64, Tile)]) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        keyed.par_sort_by_key(|k| (k.0, k.1));
    }
    #[cfg(not(feature = "parallel"))]
    keyed.sort_by_key(|k| (k.0, k.1));
}

/// Halves a triangle of places and normals across its longest side until no side is longer than `longest`.
fn split(corners: [(DVec3, DVec3); 3], longest: f64, emit: &mut impl FnMut([(DVec3, DVec3); 3])) {
    let [a, b, c] = corners.map(|c| c.0);
    let sides = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
    let long = (0..3).max_by(|&i, &j| sides[i].total_cmp(&sides[j])).unwrap_or(0);
    if sides[long] <= longest * longest {
        emit(corners);
        return;
    }
    let (from, to, apex) = (corners[long], corners[(long + 1) % 3], corners[(long + 2) % 3]);
    let middle = ((from.0 + to.0) * 0.5, (from.1 + to.1) * 0.5);
    split([from, middle, apex], longest, emit);
    split([middle, to, apex], longest, emit);
}

/// The cube of side `cell` that holds `p` (coordinates not negative), numbered along a Morton curve.
pub(super) fn cell_key(p: DVec3, cell: f64) -> u64 {
    let spread = |x: f64| {
        // 21 bits for each axis; the cast saturates.
        let mut v = ((x / cell) as u64).min((1 << 21) - 1);
        v = (v | (v << 32)) & 0x001f_0000_0000_ffff;
        v = (v | (v << 16)) & 0x001f_0000_ff00_00ff;
        v = (v | (v << 8)) & 0x100f_00f0_0f00_f00f;
        v = (v | (v << 4)) & 0x10c3_0c30_c30c_30c3;
        (v | (v << 2)) & 0x1249_2492_4924_9249
    };
    spread(p.x) | (spread(p.y) << 1) | (spread(p.z) << 2)
}
