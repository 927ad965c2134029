//! The power diagram of the sites on the surface, exact on every tile.
//!
//! On a tile the power of each site is a square plus a part that is affine, so cells are convex polygons: the tile
//! clipped by bisectors. Restricted power diagrams: Yan et al. 2009, DOI 10.1111/j.1467-8659.2009.01521.x; capacities
//! by weights: Aurenhammer, Hoffmann, Aronov 1998, DOI 10.1007/PL00009187.

use glam::DVec3;

use super::sites::{Candidates, Site};
use super::tiles::{Tile, Tiles};
use crate::parallel;

/// What a site owns.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cell {
    pub(super) mass: f64,
    /// Mass times centroid.
    pub(super) moment: DVec3,
    /// Mass times mean scaled normal.
    pub(super) normal: DVec3,
}

/// Neighbouring cells and how fast mass passes from one to the other as a weight rises: shared border length times
/// density over the slope of the difference of their powers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) flow: f64,
}

/// All cells and their shared borders; a pair of cells may occur once for every tile that it shares.
pub(super) struct Diagram {
    pub(super) cells: Vec<Cell>,
    pub(super) borders: Vec<Border>,
}

/// How many tiles are worked on together; fixed, so that sums come out the same with any number of threads.
const CHUNK: usize = 1 << 10;

/// Computes the cells. Linear in the tiles times their candidates.
pub(super) fn diagram(tiles: &Tiles, candidates: &Candidates, sites: &[Site]) -> Diagram {
    let pieces = parallel::map_chunks(tiles.tiles.len(), CHUNK, |range| {
        let mut clipper = Clipper::default();
        for index in range {
            clipper.share_out(&tiles.tiles[index], candidates.of_tile(index), sites);
        }
        (clipper.parts, clipper.borders)
    });
    let mut cells = vec![Cell::default(); sites.len()];
    let mut borders = Vec::new();
    for (parts, piece) in pieces {
        for (site, part) in parts {
            let cell = &mut cells[site as usize];
            cell.mass += part.mass;
            cell.moment += part.moment;
            cell.normal += part.normal;
        }
        borders.extend(piece);
    }
    Diagram { cells, borders }
}

/// A corner of a polygon in a tile, in coordinates along the tile's two sides, and the site (its place among the
/// candidates) behind the edge that starts there.
#[derive(Clone, Copy)]
struct Corner {
    u: f64,
    v: f64,
    behind: Option<usize>,
}

#[derive(Default)]
struct Clipper {
    parts: Vec<(u32, Cell)>,
    borders: Vec<Border>,
    /// The powers of the candidates at the tile's corners, and who they are.
    powers: Vec<([f64; 3], u32)>,
    polygon: Vec<Corner>,
    clipped: Vec<Corner>,
}

impl Clipper {
    fn share_out(&mut self, tile: &Tile, candidates: &[u32], sites: &[Site]) {
        if let &[only] = candidates {
            self.give_all(tile, only);
            return;
        }
        self.powers.clear();
        let mut least = [f64::INFINITY; 3];
        let mut owner = [0; 3];
        for (k, &i) in candidates.iter().enumerate() {
            let site = &sites[i as usize];
            let powers = std::array::from_fn(|c| site.power(tile.corners[c], tile.normals[c]));
            for c in 0..3 {
                if powers[c] < least[c] {
                    least[c] = powers[c];
                    owner[c] = k;
                }
            }
            self.powers.push((powers, i));
        }
        // A cell is convex, so a site that owns the three corners owns the tile.
        if owner[0] == owner[1] && owner[1] == owner[2] {
            self.give_all(tile, candidates[owner[0]]);
            return;
        }
        let (ab, ac) = (tile.corners[1] - tile.corners[0], tile.corners[2] - tile.corners[0]);
        let doubled = ab.cross(ac).length();
        let unit_normal = ab.cross(ac) / doubled;
        for k in 0..self.powers.len() {
            if !self.clip_to(k) {
                continue;
            }
            let (share, u, v) = measure(&self.polygon);
            if share <= 0.0 {
                continue;
            }
            let mass = tile.mass * share;
            let centroid = tile.corners[0] + ab * u + ac * v;
            let [na, nb, nc] = tile.normals;
            let normal = na + (nb - na) * u + (nc - na) * v;
            let (own, site) = self.powers[k];
            self.parts.push((site, Cell { mass, moment: centroid * mass, normal: normal * mass }));
            for e in 0..self.polygon.len() {
                let (p, q) = (self.polygon[e], self.polygon[(e + 1) % self.polygon.len()]);
                let Some((theirs, other)) = p.behind.map(|o| self.powers[o]).filter(|o| o.1 > site) else {
                    continue;
                };
                let length = (ab * (q.u - p.u) + ac * (q.v - p.v)).length();
                // How fast the difference of the two powers changes along the surface, across the border.
                let lead: [f64; 3] = std::array::from_fn(|c| theirs[c] - own[c]);
                let slope =
                    ac.cross(unit_normal) * (lead[1] - lead[0]) + unit_normal.cross(ab) * (lead[2] - lead[0]);
                let slope = slope.length() / doubled;
                if slope > 0.0 {
                    let flow = length / slope * (2.0 * tile.mass / doubled);
                    self.borders.push(Border { a: site, b: other, flow });
                }
            }
        }
    }

    fn give_all(&mut self, tile: &Tile, site: u32) {
        let moment = tile.centre() * tile.mass;
        let normal = tile.normal() * tile.mass;
        match self.parts.last_mut() {
            // Tiles that lie together mostly have the same owner.
            Some((last, part)) if *last == site => {
                part.mass += tile.mass;
                part.moment += moment;
                part.normal += normal;
            }
            _ => self.parts.push((site, Cell { mass: tile.mass, moment, normal })),
        }
    }

    /// Makes `polygon` the part of the tile that candidate `k` owns; false if there is none.
    fn clip_to(&mut self, k: usize) -> bool {
        let corner = |u, v| Corner { u, v, behind: None };
        self.polygon.clear();
        self.polygon.extend([corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]);
        let own = self.powers[k].0;
        for (j, (other, _)) in self.powers.iter().enumerate() {
            if j == k {
                continue;
            }
            // How much nearer this candidate is than the other, affine over the tile.
            let lead = [other[0] - own[0], other[1] - own[1], other[2] - own[2]];
            if lead.iter().all(|&l| l > 0.0) {
                continue;
            }
            // Of two equal sites the first owns all.
            let loses = |l: f64| l < 0.0 || (l == 0.0 && j < k);
            if lead.iter().all(|&l| loses(l)) {
                return false;
            }
            let at = |p: &Corner| lead[0] + p.u * (lead[1] - lead[0]) + p.v * (lead[2] - lead[0]);
            clip(&self.polygon, at, j, &mut self.clipped);
            std::mem::swap(&mut self.polygon, &mut self.clipped);
            if self.polygon.len() < 3 {
                return false;
            }
        }
        true
    }
}

/// Keeps the part of a convex polygon where the affine function is not negative.
fn clip(polygon: &[Corner], at: impl Fn(&Corner) -> f64, behind: usize, clipped: &mut Vec<Corner>) {
    clipped.clear();
    let Some(last) = polygon.last() else { return };
    let mut previous = *last;
    let mut before = at(&previous);
    for &next in polygon {
        let value = at(&next);
        if (before >= 0.0) != (value >= 0.0) {
            let t = before / (before - value);
            let (u, v) = (previous.u + (next.u - previous.u) * t, previous.v + (next.v - previous.v) * t);
            // Leaving the part that is kept, the new edge runs along the bisector; entering it, along the old edge.
            let behind = if before >= 0.0 { Some(behind) } else { previous.behind };
            clipped.push(Corner { u, v, behind });
        }
        if value >= 0.0 {
            clipped.push(next);
        }
        previous = next;
        before = value;
    }
}

/// The polygon's share of the tile and its centroid.
fn measure(polygon: &[Corner]) -> (f64, f64, f64) {
    let first = polygon[0];
    let (mut doubled, mut u, mut v) = (0.0, 0.0, 0.0);
    for pair in polygon[1..].windows(2) {
        let (du, dv) = (pair[0].u - first.u, pair[0].v - first.v);
        let (eu, ev) = (pair[1].u - first.u, pair[1].v - first.v);
        let cross = du * ev - dv * eu;
        doubled += cross;
        u += cross * (du + eu);
        v += cross * (dv + ev);
    }
    if doubled <= 0.0 {
        return (0.0, first.u, first.v);
    }
    // The tile itself has doubled area 1 in these coordinates.
    (doubled, first.u + u / (3.0 * doubled), first.v + v / (3.0 * doubled))
}

/// Which sites own a part of which tiles, in the order of the tiles.
pub(super) fn owned_tiles(tiles: &Tiles, candidates: &Candidates, sites: &[Site]) -> Vec<(u32, u32)> {
    parallel::map_chunks(tiles.tiles.len(), CHUNK, |range| {
        let mut clipper = Clipper::default();
        let mut owned = Vec::new();
        for index in range {
            clipper.parts.clear();
            clipper.share_out(&tiles.tiles[index], candidates.of_tile(index), sites);
            owned.extend(clipper.parts.iter().map(|(site, _)| (*site, index as u32)));
        }
        owned
    })
    .concat()
}
