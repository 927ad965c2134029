//! Capacity-constrained relaxation: cells of equal mass, points to their cells' centroids, repeated.
//!
//! Capacity-constrained centroidal diagrams: Balzer, Schlömer, Deussen 2009, DOI 10.1145/1531326.1531392; weights by
//! Newton's method: de Goes et al. 2012, DOI 10.1145/2366145.2366190.

use glam::DVec3;

use super::capacity::{Reach, weight_steps};
use super::holdings::{Holdings, holdings};
use super::layout::{Layout, Place};
use super::near::{Near, Runs, Site};
use super::owners::{Cell, Diagram, diagram};
use crate::parallel;
use crate::progress::Progress;

/// How far a point is moved beyond its cell's centroid; speeds up the approach to equal, round cells.
const OVERSHOOT: f64 = 1.8;

/// By how much the change of a weight in one round may differ from those beside it, in squared distances of the points;
/// keeps cells from vanishing. Long waves may be higher.
const MOST_STEP: f64 = 1.0;

/// At most this many rounds at the end in which only weights change.
const SETTLING: u32 = 8;

/// Where cells spread by more than this share then, points move again from where they are. That happens to few points that
/// lie far from where they are due.
const ASTRAY: f64 = 0.1;

/// At most so many times.
const AGAIN: u32 = 1;

/// Weights are settled by one more step when the cells' masses spread by at most this share of the mean, and none is off
/// by more than [`CLOSEST`]: a step squares errors, and what is left of these makes no difference to what points are for.
const CLOSE: f64 = 0.015;

/// See [`CLOSE`].
const CLOSEST: f64 = 0.2;

/// So many sites are moved by one thread.
const CHUNK: usize = 1 << 12;

/// The points after relaxation, with their cells.
pub(super) struct Relaxed {
    pub(super) sites: Vec<Site>,
    pub(super) near: Near,
    pub(super) cells: Vec<Cell>,
    pub(super) holdings: Holdings,
}

/// Moves the sites for a number of rounds. `near` lists them about where they are, `wanted` is the mass for each of them,
/// `homes` says where they are due.
pub(super) fn relax(
    layout: &Layout,
    mut near: Near,
    mut sites: Vec<Site>,
    homes: &[Place],
    wanted: &[f64],
    rounds: u32,
    progress: &dyn Progress,
) -> Relaxed {
    let mut settled = false;
    let mut last: Option<Fit> = None;
    let (mut again, mut spread) = (AGAIN, 0.0);
    // Points move in the rounds before this one.
    let (each, mut rounds) = (rounds, rounds);
    for round in 0.. {
        near.follow(layout, &sites);
        if round == rounds + SETTLING && spread > ASTRAY && again > 0 {
            again -= 1;
            rounds = round + each;
            last = None;
        }
        if settled || round == rounds + SETTLING || progress.is_cancelled() {
            break;
        }
        let diagram = diagram(layout, &near, &sites);
        // The last rounds only fit the weights to where the points are; the very last needs no look at what it did,
        // because errors are squared in each.
        let worst;
        (spread, worst) = errors(&diagram, wanted);
        settled = round >= rounds && spread <= CLOSE && worst <= CLOSEST;
        if let Some(last) = last.as_ref().filter(|last| !settled && spread > last.spread) {
            last.halve_step(&mut sites);
            progress.advance(1);
            continue;
        }
        last = (round >= rounds).then(|| Fit::new(&sites, spread));
        let step = match round + 1 {
            r if r < rounds => OVERSHOOT,
            r if r == rounds => 1.0,
            _ => 0.0,
        };
        let reach =
            if round + 1 < rounds { Reach::Near } else { Reach::Far { round: round.saturating_sub(rounds) } };
        let moves: Vec<DVec3> =
            parallel::map(sites.len(), |i| to_centroid(&sites[i], &diagram.cells[i]) * step);
        let steps = weight_steps(&diagram, &sites, &moves, wanted, reach);
        parallel::change_chunks(&mut sites, CHUNK, |first, chunk| {
            for (i, site) in (first..).zip(chunk) {
                let (cell, step) = (&diagram.cells[i], &steps[i]);
                let most = MOST_STEP * site.distance * site.distance;
                site.place.position += moves[i];
                site.weight += step.beside + (step.value - step.beside).clamp(-most, most);
                if round < rounds && cell.mass > 0.0 {
                    site.place.normal = cell.moment.normal / cell.mass;
                }
            }
        });
        regain(&mut sites, homes, &diagram, wanted, round < rounds);
        progress.advance(1);
    }
    let (cells, holdings) = holdings(layout, &near, &sites);
    Relaxed { sites, near, cells, holdings }
}

/// Weights, and how the masses of their cells spread.
struct Fit {
    weights: Vec<f64>,
    spread: f64,
}

impl Fit {
    fn new(sites: &[Site], spread: f64) -> Self {
        Self { weights: sites.iter().map(|site| site.weight).collect(), spread }
    }

    /// Takes half of what was done to these weights back: a step of Newton's method that is too long makes a worse fit.
    fn halve_step(&self, sites: &mut [Site]) {
        for (site, weight) in sites.iter_mut().zip(&self.weights) {
            site.weight = 0.5 * (site.weight + weight);
        }
    }
}

/// By how much the masses of cells are off what is wanted, as shares of it: in the root mean square, and at most.
fn errors(diagram: &Diagram, wanted: &[f64]) -> (f64, f64) {
    let errors = diagram.cells.iter().zip(wanted).map(|(c, w)| (c.mass / w - 1.0).abs());
    let (squares, worst) = errors.fold((0.0, 0.0_f64), |(s, m), e| (s + e * e, m.max(e)));
    (libm::sqrt(squares / wanted.len() as f64), worst)
}

fn to_centroid(site: &Site, cell: &Cell) -> DVec3 {
    if cell.mass > 0.0 { cell.centroid() - site.place.position } else { DVec3::ZERO }
}

/// A cell with less than this share of its wanted mass is lost: its slope says nothing about how to regain it.
const LOST: f64 = 0.1;

/// With less than this share it hardly has borders through which weights could give it more.
const GONE: f64 = 0.01;

/// A cell with more than this share of its wanted mass can take in the site of a lost one.
const HEAVY: f64 = 1.1;

/// Above the weight with which it just owns its own place the site of a cell that is gone gets this share of the squared
/// distance of the points.
const FOOTHOLD: f64 = 0.3;

/// Only where points have the same distance, up to this factor, may a site go over: beside a jump of the density all
/// cells on one side are heavy for a while, and must not draw the points of the other.
const ALIKE: f64 = 1.5;

/// What is farther away than this many distances of the points has nothing to do with a cell.
const SIGHT: f64 = 3.0;

/// Gives lost cells a part of the surface again. If sites `may_move`, a lost one goes into a heavy cell in sight, which
/// the two then halve: what it should have had its neighbours hold, and from farther away mass would have to pass
/// through many cells. Others go back to where they are due, with the weight for a foothold.
fn regain(sites: &mut [Site], homes: &[Place], diagram: &Diagram, wanted: &[f64], may_move: bool) {
    let share = |i: usize| diagram.cells[i].mass / wanted[i];
    let lost: Vec<usize> = (0..sites.len()).filter(|&i| share(i) < LOST).collect();
    if lost.is_empty() {
        return;
    }
    let places: Vec<DVec3> = sites.iter().map(|site| site.place.position).collect();
    let runs = Runs::new(&places);
    let mut halved = vec![false; sites.len()];
    let mut near = Vec::new();
    for i in lost {
        let own = sites[i];
        near.clear();
        runs.within(places[i], SIGHT * own.distance, |j| sites[j].patch == own.patch, &mut near);
        let alike = |j: usize| {
            let ratio = sites[j].distance / own.distance;
            (1.0 / ALIKE..=ALIKE).contains(&ratio)
        };
        let heavy = near.iter().map(|&j| j as usize).filter(|&j| share(j) > HEAVY && !halved[j] && alike(j));
        let nearest = heavy.min_by(|&a, &b| {
            places[a].distance_squared(places[i]).total_cmp(&places[b].distance_squared(places[i]))
        });
        if let Some(heavy) = nearest.filter(|_| may_move) {
            halve(sites, i, heavy, &diagram.cells[heavy]);
            halved[heavy] = true;
        } else if share(i) < GONE {
            let own = Site { place: if may_move { homes[i] } else { own.place }, ..own };
            near.clear();
            runs.within(own.place.position, SIGHT * own.distance, |j| sites[j].patch == own.patch, &mut near);
            let lead = |&j: &u32| {
                let other = &sites[j as usize];
                other.weight - other.place.minus(&own.place).length_squared()
            };
            let least = near.iter().map(lead).fold(own.weight, f64::max);
            sites[i] = Site { weight: least + FOOTHOLD * own.distance * own.distance, ..own };
        }
    }
}

/// Puts a lost site into a heavy one's cell, on two sides of the centroid.
fn halve(sites: &mut [Site], lost: usize, heavy: usize, cell: &Cell) {
    let (centroid, normal) = (cell.centroid(), cell.moment.normal / cell.mass);
    let aside = normal.try_normalize().unwrap_or(DVec3::Z).any_orthonormal_vector();
    let aside = aside * (0.3 * sites[heavy].distance);
    sites[lost] = sites[heavy];
    sites[lost].place.position = centroid + aside;
    sites[heavy].place.position = centroid - aside;
}
