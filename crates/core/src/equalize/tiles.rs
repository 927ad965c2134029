//! The surface cut into tiles: triangles no longer than the distance of the points, each with a mass to share out.

use std::ops::Range;

use glam::DVec3;

use super::layout::Place;
use super::normals::CornerNormals;
use super::patches::Patches;
use crate::density::Density;
use crate::geometry::triangle;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// A piece of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    /// Which places are its corners.
    pub(super) corners: [u32; 3],
    pub(super) face: FaceId,
    /// Its share of the mass (area times density) to be spread over the points.
    pub(super) mass: f64,
}

/// Tiles that lie close together.
#[derive(Clone, Copy, Debug)]
struct Clump {
    /// Where it ends among all tiles in order.
    end: u32,
    /// The patch that it belongs to.
    patch: u32,
}

/// The corners of tiles, relative to the middle of the mesh, so that squares of places lose no digits.
struct Corners<'a> {
    normals: CornerNormals<'a>,
    middle: DVec3,
    /// The length of a unit of normal.
    bend: f64,
    /// So many of them are those of faces.
    shared: u32,
    /// All others.
    places: Vec<Place>,
}

impl Corners<'_> {
    #[inline]
    fn at(&self, id: u32) -> Place {
        if id >= self.shared {
            return self.places[(id - self.shared) as usize];
        }
        Place { position: self.normals.position(id) - self.middle, normal: self.normals.at(id) * self.bend }
    }
}

/// Tiles in clumps.
pub(super) struct Tiles<'a> {
    corners: Corners<'a>,
    /// Clump by clump.
    tiles: Vec<Tile>,
    /// Ascending.
    clumps: Vec<Clump>,
}

impl Tiles<'_> {
    /// How many places tiles have as their corners.
    pub(super) fn place_count(&self) -> usize {
        self.corners.shared as usize + self.corners.places.len()
    }

    /// About how many places so many tiles have that lie together.
    pub(super) fn places_of(&self, tiles: usize) -> usize {
        if self.corners.shared == 0 {
            return 3 * tiles;
        }
        // A disc of many triangles has half as many corners, and those of its rim.
        tiles / 2 + (2.0 * (tiles as f64).sqrt()) as usize + 2
    }

    /// A corner of a tile.
    #[inline]
    pub(super) fn place(&self, id: u32) -> Place {
        self.corners.at(id)
    }

    /// How many clumps there are.
    pub(super) fn clump_count(&self) -> usize {
        self.clumps.len()
    }

    /// The patch that a clump belongs to.
    pub(super) fn patch_of(&self, clump: usize) -> u32 {
        self.clumps[clump].patch
    }

    /// The tiles of a clump.
    pub(super) fn clump(&self, clump: usize) -> &[Tile] {
        &self.tiles[self.range(clump)]
    }

    fn range(&self, clump: usize) -> Range<usize> {
        let start = if clump == 0 { 0 } else { self.clumps[clump - 1].end };
        start as usize..self.clumps[clump].end as usize
    }
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

/// No side of a tile is longer than this many distances of the points there, but for slender ones: see [`SLICE`].
const LONGEST: f64 = 1.5;

/// A slender face is cut into about this many tiles at most, and as many more for each point that is due on it: a needle 1e12
/// times as long as wide would make millions. None shorter than 32 distances of the points comes near it.
const MOST: f64 = 256.0;

/// A triangle whose longest side, squared, is more than so many times its area is slender.
const SLENDER: f64 = 32.0;

/// Slender faces are cut into slices of so many distances of the points: where points stand in a row there is nothing else
/// to balance them by.
const SLICE: f64 = 0.25;

/// Where few points are due, tiles and normals are scaled as if this share of the mean density were.
const SPARSEST: f64 = 0.1;

/// Clumps lie in cubes with sides of so many distances of the points, or down to half of that.
const CLUMP: f64 = 0.25;

/// What orders a tile: its patch, the size of its cube and the cube.
type Key = (u32, u32, u64);

/// The tiles of some faces.
#[derive(Default)]
struct Cut {
    /// Corners that the faces do not share with others.
    places: Vec<Place>,
    tiles: Vec<Tile>,
    /// The key of each tile.
    keys: Vec<Key>,
}

/// Cuts the faces whose patch is given into tiles; faces without mass have none. Clumps of tiles that lie close
/// together stand together, patch by patch.
pub(super) fn tiles<'a>(mesh: &'a SurfaceMesh, patches: &'a Patches, scale: &Scale<'_>) -> Tiles<'a> {
    const CHUNK: usize = 1 << 12;
    let normals = CornerNormals::new(mesh, patches);
    // Normals are scaled by the distance of the points, so faces share corners only where that is the same.
    let shared = if scale.density.is_uniform() { normals.count() as u32 } else { 0 };
    let bend = scale.bend * scale.d_m;
    let mut corners = Corners { normals, middle: scale.middle, bend, shared, places: Vec::new() };
    let (low, high) = mesh.bounds();
    let from_low = scale.middle - low;
    // On needles cubes of clumps are smaller than what keys tell apart.
    let smallest = (high - low).max_element() / KEYS;
    let pieces = parallel::map_chunks(mesh.face_count(), CHUNK, |range| {
        let mut cut = Cut {
            places: Vec::new(),
            tiles: Vec::with_capacity(range.len()),
            keys: Vec::with_capacity(range.len()),
        };
        for index in range {
            let face = FaceId::new(index);
            let Some(patch) = patches.of(face) else { continue };
            let density = scale.density.corners(face);
            let mean = (density[0] + density[1] + density[2]) / 3.0;
            if mean <= 0.0 {
                continue;
            }
            let distance = scale.d_m / libm::sqrt(mean.max(SPARSEST));
            let ids = corners.normals.ids(face);
            let whole: [Corner; 3] = if shared > 0 {
                [0, 1, 2].map(|c| Corner { id: ids[c], place: corners.at(ids[c]), density: density[c] })
            } else {
                let positions = mesh.triangle(face);
                [0, 1, 2].map(|c| {
                    let position = positions[c] - scale.middle;
                    let normal = corners.normals.at(ids[c]) * (scale.bend * distance);
                    cut.corner(shared, Place { position, normal }, density[c])
                })
            };
            cut.split(
                whole,
                longest_side(whole.map(|c| c.place.position), distance),
                &mut |corners: [Corner; 3]| {
                    let [a, b, c] = corners.map(|c| c.place.position);
                    let area = triangle::area(a, b, c);
                    let density = (corners[0].density + corners[1].density + corners[2].density) / 3.0;
                    let mass = area * density;
                    if mass <= 0.0 {
                        return None;
                    }
                    let halvings = halvings(density);
                    let side = CLUMP * scale.d_m * libm::exp2(-f64::from(halvings));
                    let cube = cell_key((a + b + c) / 3.0 + from_low, side.max(smallest));
                    let tile = Tile { corners: corners.map(|c| c.id), face, mass };
                    Some(((patch, halvings, cube), tile))
                },
                shared,
            );
        }
        cut
    });
    if shared == 0 {
        corners.normals.give_back();
    }
    // Corners of faces by themselves come after the shared ones, piece by piece.
    let count = pieces.iter().map(|piece| piece.tiles.len()).sum();
    let mut tiles: Vec<Tile> = Vec::with_capacity(count);
    let mut keys: Vec<(Key, u32)> = Vec::with_capacity(count);
    for piece in pieces {
        let before = corners.places.len() as u32;
        let moved = |id: u32| if id < shared { id } else { id + before };
        keys.extend(piece.keys.into_iter().zip(tiles.len() as u32..));
        tiles.extend(piece.tiles.into_iter().map(|tile| Tile { corners: tile.corners.map(moved), ..tile }));
        corners.places.extend(piece.places);
    }
    parallel::sort(&mut keys);
    let mut end = 0;
    let clumps = keys.chunk_by(|a, b| a.0 == b.0).map(|clump| {
        end += clump.len() as u32;
        let ((patch, ..), _) = clump[0];
        Clump { end, patch }
    });
    let clumps = clumps.collect();
    // The keys are given back before the tiles are put in order.
    let order: Vec<u32> = keys.into_iter().map(|(_, tile)| tile).collect();
    let tiles = parallel::map(order.len(), |i| tiles[order[i] as usize]);
    Tiles { corners, tiles, clumps }
}

/// How often the cubes of clumps are halved where the density is so many times the mean.
fn halvings(density: f64) -> u32 {
    if density > 1.0 { (libm::log2(density) * 0.5) as u32 } else { 0 }
}

#[derive(Clone, Copy)]
struct Corner {
    id: u32,
    place: Place,
    density: f64,
}

/// How long the sides of a face's tiles may be.
fn longest_side([a, b, c]: [DVec3; 3], distance: f64) -> f64 {
    let (_, squared) = triangle::longest_side([a, b, c]);
    let (length, area) = (libm::sqrt(squared), triangle::area(a, b, c));
    let due = area / (distance * distance);
    if squared > SLENDER * area {
        // Two tiles a slice.
        (SLICE * distance).max(2.0 * length / (MOST * (1.0 + due)))
    } else {
        LONGEST * distance
    }
}

impl Cut {
    /// A corner that these faces do not share with others; ids start at `first`.
    fn corner(&mut self, first: u32, place: Place, density: f64) -> Corner {
        let id = first + self.places.len() as u32;
        self.places.push(place);
        Corner { id, place, density }
    }

    fn push(&mut self, tile: Option<(Key, Tile)>) {
        if let Some((key, tile)) = tile {
            self.keys.push(key);
            self.tiles.push(tile);
        }
    }

    /// The corner so far on the way from one to another.
    fn between(&mut self, first: u32, [a, b]: [&Corner; 2], way: f64) -> Corner {
        let place = Place {
            position: a.place.position.lerp(b.place.position, way),
            normal: a.place.normal.lerp(b.place.normal, way),
        };
        self.corner(first, place, a.density + (b.density - a.density) * way)
    }

    /// Cuts a slender triangle across: halving would make 3^k tiles of a needle to make them 2^k times as short.
    fn slice(
        &mut self,
        [from, to, apex]: [Corner; 3],
        longest: f64,
        tile: &mut impl FnMut([Corner; 3]) -> Option<(Key, Tile)>,
        first: u32,
    ) {
        let along = to.place.position - from.place.position;
        let way = (apex.place.position - from.place.position).dot(along) / along.length_squared();
        let foot = self.between(first, [&from, &to], way.clamp(0.0, 1.0));
        for [tip, left, right] in [[from, foot, apex], [to, apex, foot]] {
            let length = (foot.place.position - tip.place.position).length();
            let slices = libm::ceil(length / longest);
            let mut last = [tip; 2];
            for k in 1..=slices as u32 {
                let way = f64::from(k) / slices;
                let next = [left, right].map(|end| self.between(first, [&tip, &end], way));
                self.push(tile([last[0], next[0], next[1]]));
                if k > 1 {
                    self.push(tile([last[0], next[1], last[1]]));
                }
                last = next;
            }
        }
    }

    /// Halves a triangle across its longest side until no side is longer than `longest`.
    fn split(
        &mut self,
        corners: [Corner; 3],
        longest: f64,
        tile: &mut impl FnMut([Corner; 3]) -> Option<(Key, Tile)>,
        first: u32,
    ) {
        let (start, squared) = triangle::longest_side(corners.map(|c| c.place.position));
        if squared <= longest * longest {
            self.push(tile(corners));
            return;
        }
        let [from, to, apex] = [0, 1, 2].map(|turn| corners[(start + turn) % 3]);
        let [a, b, c] = corners.map(|c| c.place.position);
        if squared > SLENDER * triangle::area(a, b, c) {
            self.slice([from, to, apex], longest, tile, first);
            return;
        }
        let middle = self.between(first, [&from, &to], 0.5);
        self.split([from, middle, apex], longest, tile, first);
        self.split([middle, to, apex], longest, tile, first);
    }
}

/// So many cubes along each axis are told apart, a few less than there are numbers.
const KEYS: f64 = 2_097_000.0;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubes_are_halved_where_it_is_four_times_as_dense() {
        let of = [0.0, 1.0, 3.999, 4.0, 15.999, 16.0, f64::NAN].map(halvings);
        assert_eq!(of, [0, 0, 0, 1, 1, 2, 0]);
        assert_eq!(halvings(f64::INFINITY), u32::MAX);
    }
}
