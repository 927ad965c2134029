//! Places inside the cells of points, from which points may choose.

use glam::DVec3;

use super::layout::Layout;
use super::owners::{Piece, pieces};
use super::relax::Relaxed;
use crate::ids::FaceId;
use crate::parallel;
use crate::random::Random;

/// A place of the surface, relative to the middle of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) face: FaceId,
    pub(super) place: DVec3,
}

const PLACES: u64 = 0x70_6c_61_01;

/// What the sites that want it own, piece by piece.
pub(super) fn pieces_of(
    layout: &Layout,
    relaxed: &Relaxed,
    wants: impl Fn(usize) -> bool,
) -> Vec<Vec<Piece>> {
    let mut wanted = vec![false; layout.blocks.len()];
    for site in (0..relaxed.sites.len()).filter(|&site| wants(site)) {
        for holding in relaxed.holdings.of(site) {
            wanted[layout.block_of(holding.tile)] = true;
        }
    }
    let blocks: Vec<u32> = (0..).zip(wanted).filter(|(_, wanted)| *wanted).map(|(block, _)| block).collect();
    let mut pieces_of: Vec<Vec<Piece>> = vec![Vec::new(); relaxed.sites.len()];
    for piece in pieces(layout, &relaxed.near, &relaxed.sites, &blocks) {
        if wants(piece.site as usize) {
            pieces_of[piece.site as usize].push(piece);
        }
    }
    pieces_of
}

/// For each site that wants them `count` places of its cell, each standing for the same share of the cell's mass.
pub(super) fn spots(
    layout: &Layout,
    relaxed: &Relaxed,
    wants: impl Fn(usize) -> bool + Sync + Send,
    count: u32,
    seed: u64,
) -> Vec<Vec<Spot>> {
    let pieces_of = pieces_of(layout, relaxed, wants);
    parallel::map(pieces_of.len(), |site| {
        let mut random = Random::new(seed ^ site as u64, PLACES);
        let step = relaxed.cells[site].mass / f64::from(count);
        let (mut passed, mut next) = (0.0, step * random.unit());
        let mut spots = Vec::new();
        for piece in &pieces_of[site] {
            passed += piece.mass;
            while next < passed {
                next += step;
                let tile = &layout.tiles[piece.tile as usize];
                spots.push(Spot { face: tile.face, place: inside(layout.corners(tile), piece, &mut random) });
            }
        }
        spots
    })
}

/// A random place of a piece.
fn inside([a, b, c]: [DVec3; 3], piece: &Piece, random: &mut Random) -> DVec3 {
    let first = piece.polygon[0];
    let areas: Vec<f64> =
        piece.polygon[1..].windows(2).map(|p| (p[0] - first).perp_dot(p[1] - first)).collect();
    let mut left = random.unit() * areas.iter().sum::<f64>();
    let mut k = 0;
    while k + 1 < areas.len() && left >= areas[k] {
        left -= areas[k];
        k += 1;
    }
    let (mut u, mut v) = (random.unit(), random.unit());
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    let at = first + (piece.polygon[k + 1] - first) * u + (piece.polygon[k + 2] - first) * v;
    a + (b - a) * at.x + (c - a) * at.y
}
