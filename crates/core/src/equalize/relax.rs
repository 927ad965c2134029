//! Capacity-constrained relaxation: cells of equal mass, points to their cells' centroids, repeated.
//!
//! Capacity-constrained centroidal diagrams: Balzer, Schlömer, Deussen 2009, DOI 10.1145/1531326.1531392; weights by
//! Newton's method: de Goes et al. 2012, DOI 10.1145/2366145.2366190.

use glam::DVec3;

use super::capacity::weight_steps;
use super::diagram::{Cell, Diagram, diagram};
use super::sites::{Candidates, Site};
use super::tiles::Tiles;
use crate::progress::Progress;

/// How far a point is moved beyond its cell's centroid; speeds up the approach to equal, round cells.
const OVERSHOOT: f64 = 1.5;

/// The largest change of a weight in one round, in squared d_m; keeps cells from vanishing.
const MOST_STEP: f64 = 0.3;

/// A site is a candidate for a tile when its power is within this much, in squared d_m, of what could matter.
const SKIN: f64 = 0.35;

/// Candidates are sought anew when powers have changed by this much, in squared d_m and root mean square: single sites
/// change by more than the mean.
const DRIFT: f64 = 0.2;

/// At most this many rounds at the end in which only weights change.
const SETTLING: u32 = 8;

/// Weights are settled when no cell's mass is off by more than this share.
const CLOSE: f64 = 3e-4;

/// The points after relaxation, with their cells.
pub(super) struct Relaxed {
    pub(super) sites: Vec<Site>,
    pub(super) diagram: Diagram,
    pub(super) candidates: Candidates,
}

/// Moves the sites for a number of rounds; `wanted` is the mass for each of them.
pub(super) fn relax(
    tiles: &Tiles,
    mut sites: Vec<Site>,
    wanted: &[f64],
    d_m: f64,
    rounds: u32,
    progress: &dyn Progress,
) -> Relaxed {
    let unit = d_m * d_m;
    let mut candidates = Candidates::find(tiles, &sites, d_m, SKIN * unit);
    let mut drift = 0.0;
    for round in 0..rounds + SETTLING {
        if progress.is_cancelled() {
            break;
        }
        // The weights are fitted at last to cells that miss no candidate.
        if drift > DRIFT || round == rounds {
            candidates = Candidates::find(tiles, &sites, d_m, SKIN * unit);
            drift = 0.0;
        }
        let diagram = diagram(tiles, &candidates, &sites);
        if round >= rounds && worst_error(&diagram, wanted) < CLOSE {
            break;
        }
        // The last rounds only fit the weights to where the points are.
        let step = match round + 1 {
            r if r < rounds => OVERSHOOT,
            r if r == rounds => 1.0,
            _ => 0.0,
        };
        let moves: Vec<DVec3> =
            sites.iter().zip(&diagram.cells).map(|(s, c)| to_centroid(s, c) * step).collect();
        let steps = weight_steps(&diagram, &sites, &moves, wanted, MOST_STEP * unit);
        let mut squares = 0.0;
        for (((site, cell), by), step) in sites.iter_mut().zip(&diagram.cells).zip(&moves).zip(&steps) {
            site.position += *by;
            site.weight += step;
            if cell.mass > 0.0 {
                site.normal = cell.normal / cell.mass;
            }
            let change = step.abs() + by.length() * d_m;
            squares += change * change;
        }
        if round < rounds {
            rescue(&mut sites, &diagram, wanted, d_m);
        }
        drift += libm::sqrt(squares / sites.len() as f64) / unit;
        progress.advance(1);
    }
    candidates = Candidates::find(tiles, &sites, d_m, 0.0);
    let diagram = diagram(tiles, &candidates, &sites);
    Relaxed { sites, diagram, candidates }
}

fn worst_error(diagram: &Diagram, wanted: &[f64]) -> f64 {
    diagram.cells.iter().zip(wanted).fold(0.0_f64, |m, (c, w)| m.max((c.mass / w - 1.0).abs()))
}

fn to_centroid(site: &Site, cell: &Cell) -> DVec3 {
    if cell.mass > 0.0 { cell.moment / cell.mass - site.position } else { DVec3::ZERO }
}

/// A cell with less than this share of its wanted mass is lost: its slope says nothing about how to regain it.
const LOST: f64 = 0.1;

/// A cell with more than this share of its wanted mass can take in the site of a lost one.
const HEAVY: f64 = 1.1;

/// Puts the sites of lost cells into heavy cells nearby, which they then halve. What a lost cell should have had its
/// neighbours hold, so going farther would take points from where they are due.
fn rescue(sites: &mut [Site], diagram: &Diagram, wanted: &[f64], d_m: f64) {
    let share = |i: usize| diagram.cells[i].mass / wanted[i];
    let lost: Vec<usize> = (0..sites.len()).filter(|&i| share(i) < LOST).collect();
    if lost.is_empty() {
        return;
    }
    let mut heavy: Vec<usize> = (0..sites.len()).filter(|&i| share(i) > HEAVY).collect();
    for i in lost {
        let from = sites[i];
        let nearest = (0..heavy.len()).filter(|&h| sites[heavy[h]].patch == from.patch).min_by(|&a, &b| {
            let distance = |h: usize| sites[heavy[h]].position.distance_squared(from.position);
            distance(a).total_cmp(&distance(b))
        });
        let Some(nearest) = nearest else { continue };
        let heavy = heavy.swap_remove(nearest);
        let cell = &diagram.cells[heavy];
        let (centroid, normal) = (cell.moment / cell.mass, cell.normal / cell.mass);
        let aside = normal.try_normalize().unwrap_or(DVec3::Z).any_orthonormal_vector() * (0.3 * d_m);
        sites[i] = Site { position: centroid + aside, ..sites[heavy] };
        sites[heavy].position = centroid - aside;
    }
}
