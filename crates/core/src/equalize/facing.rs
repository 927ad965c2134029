//! Points that face every way as the surface does: each takes the face of its cell, near its home, that evens out
//! the normals of the points, over all of the mesh and over its parts.
//!
//! What is visible is first of all what faces the viewer. Cells are as wide as the distance of the points, and the surface
//! turns within them, so a small step changes much of what a point faces and little of where it stands. Parts count
//! besides the whole because some of them are hidden.

use glam::DVec3;

use super::harmonics::{Basis, COUNT, Harmonics, dot};
use super::layout::Layout;
use super::places::Spot;
use super::relax::Relaxed;
use super::settle::{Cells, nearest_on};
use crate::geometry::triangle;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// What it costs to stand the distance of the points away from home, against the mean square over all directions of
/// how many points too many face there.
const STAY: f64 = 32.0;

/// At most so many distances of the points farther from home than the place that is taken now.
const REACH: f64 = 0.2;

/// So many times each point chooses: after that hardly anything changes.
const SWEEPS: usize = 3;

/// From the place of a face that is nearest to its home a point steps so much of the way to the middle of its tile: where
/// faces meet, what one of them should see is hidden by the other.
const INWARD: f64 = 0.1;

/// Sites in a run of the finest level. Sites follow each other as the balanced regions do, so a run is a patch.
const FINEST: usize = 32;

/// Runs that make one of the next level.
const RUNS: usize = 4;

/// Sites of a piece of work.
const SITES: usize = 32;

/// A face of its cell that a point may take.
#[derive(Clone, Copy)]
struct Choice {
    tile: u32,
    normal: u16,
    cost: f32,
}

/// The choices of some sites in order.
struct Choices {
    /// Where those of each end.
    ends: Vec<u32>,
    all: Vec<Choice>,
}

/// Where a point stands.
#[derive(Clone, Copy)]
struct Stand {
    normal: u16,
    cost: f32,
    /// The tile that it has chosen.
    chosen: Option<u32>,
}

/// Moves points, one for each site where it has one, to other faces of their cells, each on its side. Linear in tiles.
pub(super) fn face_evenly(normals: &Normals, cells: &Cells<'_>, spots: &mut [Option<Spot>]) {
    let Cells { layout, relaxed, homes, .. } = cells;
    let choices = parallel::map_chunks(spots.len(), SITES, |sites| {
        let mut choices = Choices { ends: Vec::with_capacity(sites.len()), all: Vec::new() };
        for site in sites {
            if let Some(now) = &spots[site] {
                list(cells, normals, site, now, &mut choices.all);
            }
            choices.ends.push(choices.all.len() as u32);
        }
        choices
    });
    let mut stands = stands(relaxed, normals, homes, spots);
    let mut excess = Excess::new(layout, relaxed, normals, &stands);
    for _ in 0..SWEEPS {
        let mut changed = false;
        for (chunk, choices) in choices.iter().enumerate() {
            let mut start = 0;
            for (site, &end) in (chunk * SITES..).zip(&choices.ends) {
                let of_site = &choices.all[start..end as usize];
                start = end as usize;
                if let Some(stand) = &mut stands[site] {
                    changed |= excess.choose(site, stand, of_site, normals);
                }
            }
        }
        if !changed {
            break;
        }
    }
    for (site, (spot, stand)) in spots.iter_mut().zip(&stands).enumerate() {
        if let Some(tile) = stand.and_then(|stand| stand.chosen) {
            let tile = &layout.tiles[tile as usize];
            let place = place_on(layout.corners(tile), homes[site]);
            *spot = Some(Spot { face: tile.face, place });
        }
    }
}

/// What a site may choose: places near its home on faces with other normals.
fn list(cells: &Cells<'_>, normals: &Normals, site: usize, now: &Spot, choices: &mut Vec<Choice>) {
    let Cells { layout, relaxed, sides, ref homes } = *cells;
    let home = homes[site];
    let distance = relaxed.sites[site].distance;
    let farthest = now.place.distance(home) + REACH * distance;
    let normal_now = normals.of_face[now.face.index()];
    for holding in relaxed.holdings.of(site) {
        let tile = &layout.tiles[holding.tile as usize];
        let normal = normals.of_face[tile.face.index()];
        let is_beyond = sides.is_some_and(|sides| sides.of(tile.face) != sides.of(now.face));
        if normal == normal_now || is_beyond {
            continue;
        }
        let corners = layout.corners(tile);
        // Too far with all that it has.
        let (_, longest_square) = triangle::longest_side(corners);
        if corners[0].distance_squared(home) > 2.0 * (farthest * farthest + longest_square) {
            continue;
        }
        let away = place_on(corners, home).distance_squared(home);
        if away < farthest * farthest {
            let cost = (STAY * away / (distance * distance)) as f32;
            choices.push(Choice { tile: holding.tile, normal, cost });
        }
    }
}

/// The place on a tile that a point takes.
fn place_on(corners: [DVec3; 3], home: DVec3) -> DVec3 {
    nearest_on(corners, home).lerp(corners.iter().sum::<DVec3>() / 3.0, INWARD)
}

/// Where all points stand.
fn stands(
    relaxed: &Relaxed,
    normals: &Normals,
    homes: &[DVec3],
    spots: &[Option<Spot>],
) -> Vec<Option<Stand>> {
    let stand = |(site, spot): (usize, &Option<Spot>)| {
        let spot = spot.as_ref()?;
        let distance = relaxed.sites[site].distance;
        let away = spot.place.distance_squared(homes[site]);
        let cost = (STAY * away / (distance * distance)) as f32;
        Some(Stand { normal: normals.of_face[spot.face.index()], cost, chosen: None })
    };
    spots.iter().enumerate().map(stand).collect()
}

/// By how much the harmonics of points exceed those of the surface.
struct Excess {
    /// Of runs of [`FINEST`] sites; then of runs of as many runs as long as there are several; then of all.
    levels: Vec<Vec<Harmonics>>,
}

impl Excess {
    fn new(layout: &Layout, relaxed: &Relaxed, normals: &Normals, stands: &[Option<Stand>]) -> Self {
        let mass: f64 = relaxed.cells.iter().map(|cell| cell.mass).sum();
        let each = relaxed.cells.len() as f64 / mass;
        let mut finest = parallel::map_chunks(stands.len(), FINEST, |sites| {
            let mut sum = [0.0; COUNT];
            for site in sites {
                let Some(stand) = &stands[site] else { continue };
                add(&mut sum, normals.harmonics(stand.normal), 1.0);
                for holding in relaxed.holdings.of(site) {
                    let face = layout.tiles[holding.tile as usize].face;
                    add(
                        &mut sum,
                        normals.harmonics(normals.of_face[face.index()]),
                        -(holding.mass * each) as f32,
                    );
                }
            }
            sum
        });
        let mut levels = Vec::new();
        while finest.len() > 1 {
            let coarser = finest
                .chunks(RUNS)
                .map(|of| {
                    let mut sum = [0.0; COUNT];
                    of.iter().for_each(|one| add(&mut sum, one, 1.0));
                    sum
                })
                .collect();
            levels.push(std::mem::replace(&mut finest, coarser));
        }
        levels.push(finest);
        Self { levels }
    }

    /// The sum over all runs that a site belongs to.
    fn at(&self, site: usize) -> Harmonics {
        let mut sum = [0.0; COUNT];
        let mut run = site / FINEST;
        for level in &self.levels {
            add(&mut sum, &level[run], 1.0);
            run /= RUNS;
        }
        sum
    }

    fn change(&mut self, site: usize, by: &Harmonics) {
        let mut run = site / FINEST;
        for level in &mut self.levels {
            add(&mut level[run], by, 1.0);
            run /= RUNS;
        }
    }

    /// Lets a point take the best choice; whether that is another one.
    fn choose(&mut self, site: usize, stand: &mut Stand, choices: &[Choice], normals: &Normals) -> bool {
        if choices.is_empty() {
            return false;
        }
        let old = normals.harmonics(stand.normal);
        // Sums of squares with this point and without it differ by products alone: all normals have the same square.
        let mut slope = self.at(site);
        add(&mut slope, old, -(self.levels.len() as f32));
        let mut least = stand.cost + 2.0 * dot(old, &slope);
        let mut best = None;
        for choice in choices {
            let cost = choice.cost + 2.0 * dot(normals.harmonics(choice.normal), &slope);
            if cost < least {
                (least, best) = (cost, Some(choice));
            }
        }
        let Some(best) = best else { return false };
        let mut change = *normals.harmonics(best.normal);
        add(&mut change, old, -1.0);
        self.change(site, &change);
        *stand = Stand { normal: best.normal, cost: best.cost, chosen: Some(best.tile) };
        true
    }
}

fn add(sum: &mut Harmonics, more: &Harmonics, times: f32) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += times * more;
    }
}

/// The normals of a mesh, rounded.
pub(super) struct Normals {
    /// Which one each face has.
    of_face: Vec<u16>,
    all: Vec<Harmonics>,
}

/// Normals are rounded to a grid of so many squares on each side of the unfolded octahedron: by less than a degree in the mean.
const GRID: usize = 96;

impl Normals {
    fn harmonics(&self, normal: u16) -> &Harmonics {
        &self.all[normal as usize]
    }

    pub(super) fn new(mesh: &SurfaceMesh) -> Self {
        let mut of_face: Vec<u16> =
            parallel::map(mesh.face_count(), |face| square(mesh.face_normal(FaceId::new(face))));
        let mut is_there = vec![false; GRID * GRID];
        of_face.iter().for_each(|&square| is_there[square as usize] = true);
        let mut number = vec![0_u16; GRID * GRID];
        let mut there = Vec::new();
        for (square, number) in (0..).zip(&mut number) {
            if is_there[square as usize] {
                *number = there.len() as u16;
                there.push(square);
            }
        }
        of_face.iter_mut().for_each(|square| *square = number[*square as usize]);
        let basis = Basis::new();
        let harmonics = parallel::map(there.len(), |i| basis.of(middle(there[i])));
        Self { of_face, all: harmonics }
    }
}

/// The square of the grid in which a unit vector lies. Its half with z < 0 is folded out over the corners.
fn square(normal: DVec3) -> u16 {
    let flat = normal / normal.abs().element_sum().max(f64::MIN_POSITIVE);
    let (x, y) = if flat.z >= 0.0 {
        (flat.x, flat.y)
    } else {
        ((1.0 - flat.y.abs()).copysign(flat.x), (1.0 - flat.x.abs()).copysign(flat.y))
    };
    let [column, row] = [x, y].map(|v| (((v + 1.0) * 0.5 * GRID as f64) as usize).min(GRID - 1));
    (row * GRID + column) as u16
}

/// The unit vector in the middle of a square.
fn middle(square: u16) -> DVec3 {
    let square = square as usize;
    let [x, y] = [square % GRID, square / GRID].map(|k| (2 * k + 1) as f64 / GRID as f64 - 1.0);
    let z = 1.0 - x.abs() - y.abs();
    let folded = if z >= 0.0 {
        DVec3::new(x, y, z)
    } else {
        DVec3::new((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y), z)
    };
    folded.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// The middle of its square is near every unit vector, and lies in it.
    #[test]
    fn squares_hold_their_middles() {
        let mut random = Random::new(1, 1);
        for _ in 0..2000 {
            let normal = (random.rotation() * DVec3::X).normalize();
            let near = middle(square(normal));
            assert!(normal.distance(near) < 0.05, "{normal} {near}");
            assert_eq!(square(near), square(normal));
        }
        assert_eq!(square(DVec3::ZERO), square(middle(square(DVec3::ZERO))));
    }
}
