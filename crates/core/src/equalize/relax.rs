//! Capacity-constrained relaxation: cells of equal mass, points to their cells' centroids, repeated.
//!
//! Capacity-constrained centroidal diagrams: Balzer, Schlömer, Deussen 2009, DOI 10.1145/1531326.1531392; weights by
//! Newton's method: de Goes et al. 2012, DOI 10.1145/2366145.2366190.

use glam::DVec3;

use super::capacity::weight_steps;
use super::diagram::{Cell, Diagram, diagram};
use super::layout::Layout;
use super::near::{Near, SLACK, Site};
use crate::progress::Progress;

/// How far a point is moved beyond its cell's centroid; speeds up the approach to equal, round cells.
const OVERSHOOT: f64 = 1.5;

/// The largest change of a weight in one round, in squared distances of the points; keeps cells from vanishing.
const MOST_STEP: f64 = 1.0;

/// At most this many rounds at the end in which only weights change.
const SETTLING: u32 = 8;

/// Weights are settled when no cell's mass is off by more than this share.
const CLOSE: f64 = 1e-3;

/// The points after relaxation, with their cells.
pub(super) struct Relaxed {
    pub(super) sites: Vec<Site>,
    pub(super) diagram: Diagram,
    pub(super) near: Near,
}

/// Moves the sites for a number of rounds; `wanted` is the mass for each of them.
pub(super) fn relax(
    layout: &Layout,
    mut sites: Vec<Site>,
    wanted: &[f64],
    rounds: u32,
    progress: &dyn Progress,
) -> Relaxed {
    let mut near = Near::find(layout, &sites);
    // How far the farthest site may have moved since, in distances of the points.
    let mut drift = 0.0;
    let mut round = 0;
    loop {
        if drift > SLACK {
            near = Near::find(layout, &sites);
            drift = 0.0;
        }
        let diagram = diagram(layout, &near, &sites);
        let settled = round >= rounds && worst_error(&diagram, wanted) < CLOSE;
        if settled || round == rounds + SETTLING || progress.is_cancelled() {
            return Relaxed { sites, diagram, near };
        }
        // The last rounds only fit the weights to where the points are.
        let step = match round + 1 {
            r if r < rounds => OVERSHOOT,
            r if r == rounds => 1.0,
            _ => 0.0,
        };
        let moves: Vec<DVec3> =
            sites.iter().zip(&diagram.cells).map(|(s, c)| to_centroid(s, c) * step).collect();
        let steps = weight_steps(&diagram, &sites, &moves, wanted);
        let mut farthest = 0.0_f64;
        for (((site, cell), by), step) in sites.iter_mut().zip(&diagram.cells).zip(&moves).zip(&steps) {
            let most = MOST_STEP * site.distance * site.distance;
            site.place.position += *by;
            site.weight += step.clamp(-most, most);
            if round < rounds && cell.mass > 0.0 {
                site.place.normal = cell.moment.normal / cell.mass;
            }
            farthest = farthest.max(by.length() / site.distance);
        }
        drift += farthest;
        if round < rounds && rescue(&mut sites, &diagram, wanted) {
            drift = f64::INFINITY;
        }
        round += 1;
        progress.advance(1);
    }
}

fn worst_error(diagram: &Diagram, wanted: &[f64]) -> f64 {
    diagram.cells.iter().zip(wanted).fold(0.0_f64, |m, (c, w)| m.max((c.mass / w - 1.0).abs()))
}

fn to_centroid(site: &Site, cell: &Cell) -> DVec3 {
    if cell.mass > 0.0 { cell.moment.position / cell.mass - site.place.position } else { DVec3::ZERO }
}

/// A cell with less than this share of its wanted mass is lost: its slope says nothing about how to regain it.
const LOST: f64 = 0.1;

/// A cell with more than this share of its wanted mass can take in the site of a lost one.
const HEAVY: f64 = 1.1;

/// Puts the sites of lost cells into heavy cells nearby, which they then halve. What a lost cell should have had its
/// neighbours hold, so going farther would take points from where they are due. Whether there was any to put.
fn rescue(sites: &mut [Site], diagram: &Diagram, wanted: &[f64]) -> bool {
    let share = |i: usize| diagram.cells[i].mass / wanted[i];
    let lost: Vec<usize> = (0..sites.len()).filter(|&i| share(i) < LOST).collect();
    if lost.is_empty() {
        return false;
    }
    let mut heavy: Vec<usize> = (0..sites.len()).filter(|&i| share(i) > HEAVY).collect();
    for i in lost {
        let from = sites[i];
        let nearest = (0..heavy.len()).filter(|&h| sites[heavy[h]].patch == from.patch).min_by(|&a, &b| {
            let distance = |h: usize| sites[heavy[h]].place.position.distance_squared(from.place.position);
            distance(a).total_cmp(&distance(b))
        });
        let Some(nearest) = nearest else { continue };
        let heavy = heavy.swap_remove(nearest);
        let cell = &diagram.cells[heavy];
        let (centroid, normal) = (cell.moment.position / cell.mass, cell.moment.normal / cell.mass);
        let aside = normal.try_normalize().unwrap_or(DVec3::Z).any_orthonormal_vector();
        let aside = aside * (0.3 * sites[heavy].distance);
        sites[i] = sites[heavy];
        sites[i].place.position = centroid + aside;
        sites[heavy].place.position = centroid - aside;
    }
    true
}
