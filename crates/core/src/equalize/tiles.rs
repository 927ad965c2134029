//! The surface cut into tiles: triangles no longer than the distance of the points, each with a mass to share out.

use glam::DVec3;

use super::normals::CornerNormals;
use crate::density::Density;
use crate::geometry::triangle;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// A piece of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    /// Relative to the middle of the mesh, so that squares of places lose no digits.
    pub(super) corners: [DVec3; 3],
    /// The scaled normals at the corners.
    pub(super) normals: [DVec3; 3],
    pub(super) face: FaceId,
    /// The patch that it belongs to.
    pub(super) patch: u32,
    /// Its share of the mass (area times density) to be spread over the points.
    pub(super) mass: f64,
    pub(super) area: f64,
}

impl Tile {
    pub(super) fn centre(&self) -> DVec3 {
        (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0
    }

    /// The mean scaled normal.
    pub(super) fn normal(&self) -> DVec3 {
        (self.normals[0] + self.normals[1] + self.normals[2]) / 3.0
    }
}

/// Tiles in clumps.
pub(super) struct Tiles {
    pub(super) tiles: Vec<Tile>,
    /// Where each clump ends; ascending.
    pub(super) clump_ends: Vec<u32>,
}

/// What the surface is cut into tiles by.
pub(super) struct Scale<'a> {
    pub(super) density: &'a Density,
    /// sqrt(area / number of points).
    pub(super) d_m: f64,
    /// The length of a unit of normal, in units of the distance of the points.
    pub(super) bend: f64,
    /// The middle of the mesh.
    pub(super) middle: DVec3,
}

/// No side of a tile is longer than this many distances of the points there, but for needles: see [`MOST`].
const LONGEST: f64 = 0.7;

/// A face is cut into about this many tiles at most, and as many more for each point that is due on it: a needle 1e12 times
/// as long as wide would make millions. No face shorter than 22 distances of the points comes near it.
const MOST: f64 = 64.0;

/// Where few points are due, tiles and normals are scaled as if this share of the mean density were.
const SPARSEST: f64 = 0.1;

/// Clumps lie in cubes with sides of so many distances of the points, or down to half of that.
const CLUMP: f64 = 0.25;

/// Cuts the faces whose patch is given into tiles; faces without mass have none. Clumps of tiles that lie close
/// together stand together, patch by patch.
pub(super) fn tiles(mesh: &SurfaceMesh, patch_of_face: &[Option<u32>], scale: &Scale) -> Tiles {
    const CHUNK: usize = 1 << 12;
    let normals = CornerNormals::new(mesh, patch_of_face);
    let (low, _) = mesh.bounds();
    let pieces = parallel::map_chunks(mesh.face_count(), CHUNK, |range| {
        let mut tiles = Vec::with_capacity(range.len());
        for index in range {
            let face = FaceId::new(index);
            let Some(patch) = patch_of_face[index] else { continue };
            let density = scale.density.corners(face);
            let mean = (density[0] + density[1] + density[2]) / 3.0;
            if mean <= 0.0 {
                continue;
            }
            let distance = scale.d_m / libm::sqrt(mean.max(SPARSEST));
            let places = mesh.triangle(face).map(|p| p - scale.middle);
            let normals = normals.of(face).map(|n| n * (scale.bend * distance));
            let whole =
                std::array::from_fn(|c| Corner { place: places[c], normal: normals[c], density: density[c] });
            split(whole, longest_side(places, distance), &mut |corners: [Corner; 3]| {
                let places = corners.map(|c| c.place);
                let area = triangle::area(places[0], places[1], places[2]);
                let mass = area * (corners[0].density + corners[1].density + corners[2].density) / 3.0;
                if mass > 0.0 {
                    let normals = corners.map(|c| c.normal);
                    tiles.push(Tile { corners: places, normals, face, patch, mass, area });
                }
            });
        }
        tiles
    });
    // (patch, size of the cube, cube, (piece, tile))
    let mut keys: Vec<(u32, u32, u64, (u32, u32))> = parallel::map(pieces.len(), |p| {
        let key = |(i, tile): (u32, &Tile)| {
            let halvings = libm::log2((tile.mass / tile.area).max(1.0)) * 0.5;
            let side = CLUMP * scale.d_m * libm::exp2(-libm::floor(halvings));
            let cube = cell_key(tile.centre() + (scale.middle - low), side);
            (tile.patch, halvings as u32, cube, (p as u32, i))
        };
        (0..).zip(&pieces[p]).map(key).collect::<Vec<_>>()
    })
    .concat();
    sort(&mut keys);
    let mut clump_ends = Vec::new();
    for (i, pair) in keys.windows(2).enumerate() {
        if (pair[0].0, pair[0].1, pair[0].2) != (pair[1].0, pair[1].1, pair[1].2) {
            clump_ends.push(i as u32 + 1);
        }
    }
    clump_ends.push(keys.len() as u32);
    let tiles = parallel::map(keys.len(), |i| {
        let (piece, tile) = keys[i].3;
        pieces[piece as usize][tile as usize]
    });
    Tiles { tiles, clump_ends }
}

fn sort<K: Ord + Send>(keys: &mut [K]) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        keys.par_sort_unstable();
    }
    #[cfg(not(feature = "parallel"))]
    keys.sort_unstable();
}

#[derive(Clone, Copy)]
struct Corner {
    place: DVec3,
    normal: DVec3,
    density: f64,
}

impl Corner {
    fn middle(self, other: Self) -> Self {
        Self {
            place: (self.place + other.place) * 0.5,
            normal: (self.normal + other.normal) * 0.5,
            density: (self.density + other.density) * 0.5,
        }
    }
}

/// How long the sides of a face's tiles may be.
fn longest_side([a, b, c]: [DVec3; 3], distance: f64) -> f64 {
    let length = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let due = triangle::area(a, b, c) / (distance * distance);
    // Halving makes tiles half as long as they may be.
    (LONGEST * distance).max(2.0 * length / (MOST * (1.0 + due)))
}

/// Halves a triangle across its longest side until no side is longer than `longest`.
fn split(corners: [Corner; 3], longest: f64, emit: &mut impl FnMut([Corner; 3])) {
    let [a, b, c] = corners.map(|c| c.place);
    let sides = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
    let long = (0..3).max_by(|&i, &j| sides[i].total_cmp(&sides[j])).unwrap_or(0);
    if sides[long] <= longest * longest {
        emit(corners);
        return;
    }
    let (from, to, apex) = (corners[long], corners[(long + 1) % 3], corners[(long + 2) % 3]);
    let middle = from.middle(to);
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
