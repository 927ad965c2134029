//! For views: inside its cell each point takes the place that best evens the visible share over many views.
//!
//! The mean squared error of the visible share is a sum over views; what a point adds to it by standing at one place
//! rather than another takes one look at each view, so points can choose in turn until none wants to move
//! (coordinate descent).

use std::f64::consts::PI;

use glam::DVec3;

use super::places::{Spot, spots};
use super::relax::Relaxed;
use super::settle::Cells;
use crate::baseline::spherical_fibonacci;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::random::Random;
use crate::spatial::{Camera, Caster};

/// From where the surface will be looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case", deny_unknown_fields))]
pub enum Cameras {
    /// From everywhere: half the cameras orthographic, half perspective at 1.3 to 4 radii of the sphere around the
    /// box of the mesh.
    Around,
    /// From directions within an angle of one.
    Cone {
        /// From the middle of the mesh to the middle of the range; of any length but 0.
        toward: DVec3,
        /// The largest angle to it, in radians, up to pi.
        angle: f64,
        /// How far perspective cameras stand from the middle of the mesh, in its units; `None` for orthographic ones.
        distance: Option<f64>,
    },
}

/// How points are placed for views.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ForViews {
    /// From where the surface will be looked at. Default: from everywhere.
    pub cameras: Cameras,
    /// What it costs a point to leave the middle of its cell: more keeps points evener and fits the views less closely.
    /// Default: `None`, 0.5 for up to 1,500 points, and more where fewer views are made for more points.
    pub stay: Option<f64>,
    /// Over how many views the error is made small: more serve unseen ones better, and the time is proportional.
    /// Default: `None`, 2,048 for 1,500 points and fewer for more points.
    pub views: Option<u32>,
    /// From how many places of its cell each point chooses; the time is proportional. Default: `None`, 32 for 1,500
    /// points and fewer for more points.
    pub places: Option<u32>,
    /// Turns the cameras. Default: 0.
    pub seed: u64,
}

impl Default for ForViews {
    fn default() -> Self {
        Self { cameras: Cameras::Around, stay: None, views: None, places: None, seed: 0 }
    }
}

impl ForViews {
    /// Views, places and the cost of leaving home for sets of `count` points: what takes some ten seconds on a mesh of
    /// 100,000 faces. The fewer views there are for the points, the less closely should they be fitted: others matter as well.
    fn effort(&self, count: usize) -> (u32, u32, f64) {
        let (views, places, stay) = match count {
            0..=1_500 => (2_048, 32, 0.5),
            1_501..=5_000 => (1_024, 16, 1.6),
            5_001..=30_000 => (512, 8, 2.0),
            _ => (192, 4, 6.0),
        };
        let (views, places) = (self.views.unwrap_or(views), self.places.unwrap_or(places));
        (views.max(1), places.max(1), self.stay.unwrap_or(stay))
    }

    /// What is wrong with it, if anything: the name of the option, its value and what it may be.
    pub(crate) fn fault(&self) -> Option<(&'static str, String, &'static str)> {
        if let Some(stay) = self.stay.filter(|stay| !(stay.is_finite() && *stay >= 0.0)) {
            return Some(("cost of leaving a cell's middle", stay.to_string(), "finite and from 0 up"));
        }
        let Cameras::Cone { toward, angle, distance } = self.cameras else { return None };
        if !(toward.is_finite() && toward.length_squared() > 0.0) {
            return Some(("direction of the views", toward.to_string(), "finite and not zero"));
        }
        if !(0.0..=PI).contains(&angle) {
            return Some(("angle of the views", angle.to_string(), "from 0 to pi radians"));
        }
        let distance = distance.filter(|d| !(d.is_finite() && *d > 0.0))?;
        Some(("distance of the views", distance.to_string(), "finite and above 0"))
    }
}

/// At most so many times each point chooses.
const SWEEPS: usize = 30;

mod purpose {
    pub(super) const CAMERAS: u64 = 0x66_6f_72_01;
}

/// Where a point may stand.
struct Choice {
    spot: Spot,
    /// What standing there costs, besides the views.
    cost: f64,
}

/// Moves the points of `own`, one for each site, to the places that serve views best; not when cancelled. `middle` is
/// that of the mesh.
pub(super) fn choose(
    mesh: &SurfaceMesh,
    middle: DVec3,
    cells: &Cells<'_>,
    own: &mut [Option<Spot>],
    options: &ForViews,
    progress: &dyn Progress,
) {
    let (views, places, stay) = options.effort(own.len());
    let choices = choices(cells, own, places, stay, options.seed);
    let all: Vec<(FaceId, DVec3)> =
        choices.iter().flatten().map(|c| (c.spot.face, c.spot.place + middle)).collect();
    let caster = Caster::new(mesh);
    let cameras = cameras(mesh, views as usize, options);
    let words = cameras.chunks(64).count();
    progress.begin("views", cameras.len() as u64);
    // One word of views after the other, each for all places.
    let seen: Vec<Vec<u64>> = parallel::map(words, |w| {
        let mut seen = vec![0u64; all.len()];
        for (bit, camera) in cameras[w * 64..].iter().take(64).enumerate() {
            if progress.is_cancelled() {
                break;
            }
            for (word, visible) in seen.iter_mut().zip(caster.visible(camera, &all)) {
                *word |= u64::from(visible) << bit;
            }
            progress.advance(1);
        }
        seen
    });
    if progress.is_cancelled() {
        return;
    }
    let rows: Vec<u64> = (0..all.len()).flat_map(|i| seen.iter().map(move |word| word[i])).collect();
    let chosen = descend(&choices, &rows, words, cameras.len(), cells.relaxed);
    for ((own, choices), k) in own.iter_mut().zip(&choices).zip(chosen) {
        *own = choices.get(k).map(|c| c.spot);
    }
}

/// For each site where it stands, then places of its cell; without any where there is no cell.
fn choices(cells: &Cells<'_>, own: &[Option<Spot>], places: u32, stay: f64, seed: u64) -> Vec<Vec<Choice>> {
    let Cells { layout, relaxed, homes, .. } = cells;
    let spots = spots(layout, relaxed, |site| own[site].is_some(), places, seed);
    parallel::map(own.len(), |site| {
        let Some(own) = own[site] else { return Vec::new() };
        let distance = relaxed.sites[site].distance;
        let choice = |spot: &Spot| {
            let away = spot.place.distance_squared(homes[site]) / (distance * distance);
            Choice { spot: *spot, cost: stay * away }
        };
        std::iter::once(&own).chain(&spots[site]).map(choice).collect()
    })
}

/// Which choice each site takes.
fn descend(
    choices: &[Vec<Choice>],
    rows: &[u64],
    words: usize,
    views: usize,
    relaxed: &Relaxed,
) -> Vec<usize> {
    let starts: Vec<usize> = choices
        .iter()
        .scan(0, |next, c| {
            let start = *next;
            *next += c.len();
            Some(start)
        })
        .collect();
    let row = |site: usize, choice: usize| &rows[(starts[site] + choice) * words..][..words];
    // How many points too many each view sees, were every cell looked at as a whole.
    let mut excess = vec![0.0; words * 64];
    let mass: f64 = relaxed.cells.iter().map(|c| c.mass).sum();
    for (site, of_site) in choices.iter().enumerate() {
        if of_site.is_empty() {
            continue;
        }
        for_views(row(site, 0), |view| excess[view] += 1.0);
        // The first choice is where the point stands; the others stand for the cell.
        let samples = of_site.len().max(2) - 1;
        let share = relaxed.cells[site].mass / mass * choices.len() as f64 / samples as f64;
        for choice in of_site.len() - samples..of_site.len() {
            for_views(row(site, choice), |view| excess[view] -= share);
        }
    }
    let mut chosen = vec![0; choices.len()];
    for _ in 0..SWEEPS {
        let mut changed = false;
        for (site, of_site) in choices.iter().enumerate() {
            if of_site.is_empty() {
                continue;
            }
            for_views(row(site, chosen[site]), |view| excess[view] -= 1.0);
            let cost = |choice: usize| {
                let mut cost = 0.0;
                for_views(row(site, choice), |view| cost += 2.0 * excess[view] + 1.0);
                cost / views as f64 + of_site[choice].cost
            };
            let costs: Vec<f64> = (0..of_site.len()).map(cost).collect();
            // Of equal choices the old one, so that this ends.
            let best = (0..costs.len()).fold(chosen[site], |b, k| if costs[k] < costs[b] { k } else { b });
            changed |= best != chosen[site];
            chosen[site] = best;
            for_views(row(site, best), |view| excess[view] += 1.0);
        }
        if !changed {
            break;
        }
    }
    chosen
}

/// Calls with each view whose bit is set.
#[inline]
fn for_views(row: &[u64], mut call: impl FnMut(usize)) {
    for (w, &word) in row.iter().enumerate() {
        let mut left = word;
        while left != 0 {
            call(w * 64 + left.trailing_zeros() as usize);
            left &= left - 1;
        }
    }
}

fn cameras(mesh: &SurfaceMesh, count: usize, options: &ForViews) -> Vec<Camera> {
    let (low, high) = mesh.bounds();
    let (middle, radius) = ((low + high) * 0.5, 0.5 * low.distance(high));
    let mut random = Random::new(options.seed, purpose::CAMERAS);
    let camera = |toward: DVec3, distance: Option<f64>| match distance {
        None => Camera::Orthographic { toward },
        Some(distance) => Camera::Perspective { eye: middle + toward * distance },
    };
    match options.cameras {
        Cameras::Around => {
            let turn = random.rotation();
            let directions = spherical_fibonacci(count).into_iter().enumerate();
            directions
                .map(|(i, direction)| {
                    let distance = radius * (1.3 + 2.7 * random.unit());
                    camera((turn * direction).normalize(), (i % 2 == 1).then_some(distance))
                })
                .collect()
        }
        Cameras::Cone { toward, angle, distance } => {
            let turn = random.unit() * 2.0 * PI;
            let axis = toward.normalize();
            let (right, up) = axis.any_orthonormal_pair();
            // A spherical Fibonacci lattice on the cap around the axis.
            let golden = PI * (3.0 - 5.0_f64.sqrt());
            let depth = 1.0 - libm::cos(angle);
            (0..count)
                .map(|i| {
                    let z = 1.0 - depth * (i as f64 + 0.5) / count as f64;
                    let (sin, cos) = libm::sincos(turn + golden * i as f64);
                    let r = (1.0 - z * z).max(0.0).sqrt();
                    camera((axis * z + right * (r * cos) + up * (r * sin)).normalize(), distance)
                })
                .collect()
        }
    }
}
