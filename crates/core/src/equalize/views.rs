//! For views: inside its cell each point takes the place that best evens the visible share over many views.
//!
//! The mean squared error of the visible share is a sum over views; what a point adds to it by standing at one place
//! rather than another takes one look at each view, so points can choose in turn until none wants to move
//! (coordinate descent).

use std::f64::consts::PI;

use glam::DVec3;

use super::diagram::{Piece, pieces};
use super::layout::Layout;
use super::relax::Relaxed;
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
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
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
pub struct ForViews {
    /// Over how many views the error is made small. More views serve unseen ones better; the time is proportional.
    pub views: u32,
    /// How many places of its cell each point chooses from.
    pub places: u32,
    /// What it costs a point to leave the centroid of its cell: more keeps points evener. Default: 0.4.
    pub stay: f64,
    /// From where the surface will be looked at. Default: from everywhere.
    pub cameras: Cameras,
    /// Turns the cameras. Default: 0.
    pub seed: u64,
}

impl ForViews {
    /// Views and places for sets of `count` points that take some seconds on a mesh of 100,000 faces.
    pub fn for_count(count: usize) -> Self {
        let (views, places) = match count {
            0..=1_500 => (2_048, 32),
            1_501..=5_000 => (1_024, 12),
            5_001..=30_000 => (512, 8),
            _ => (192, 4),
        };
        Self { views, places, stay: 0.4, cameras: Cameras::Around, seed: 0 }
    }
}

/// At most so many times each point chooses.
const SWEEPS: usize = 30;

mod purpose {
    pub(super) const CAMERAS: u64 = 0x66_6f_72_01;
    pub(super) const PLACES: u64 = 0x66_6f_72_02;
}

/// Where a point may stand.
struct Choice {
    face: FaceId,
    place: DVec3,
    /// What standing there costs, besides the views.
    cost: f64,
}

/// The places chosen, site by site: face and place, in units of the mesh. `own` says where the sites stand now.
/// `None` when cancelled.
pub(super) fn choose(
    mesh: &SurfaceMesh,
    middle: DVec3,
    layout: &Layout,
    relaxed: &Relaxed,
    own: &[Option<(FaceId, DVec3)>],
    options: &ForViews,
    progress: &dyn Progress,
) -> Option<Vec<Option<(FaceId, DVec3)>>> {
    let choices = choices(middle, layout, relaxed, own, options);
    let all: Vec<(FaceId, DVec3)> = choices.iter().flatten().map(|c| (c.face, c.place)).collect();
    let caster = Caster::new(mesh);
    let cameras = cameras(mesh, options);
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
        return None;
    }
    let rows: Vec<u64> = (0..all.len()).flat_map(|i| seen.iter().map(move |word| word[i])).collect();
    let chosen = descend(&choices, &rows, words, cameras.len(), relaxed);
    Some(choices.iter().zip(chosen).map(|(c, k)| c.get(k).map(|c| (c.face, c.place))).collect())
}

/// For each site where it stands, then places of its cell, each for an equal share of the mass.
fn choices(
    middle: DVec3,
    layout: &Layout,
    relaxed: &Relaxed,
    own: &[Option<(FaceId, DVec3)>],
    options: &ForViews,
) -> Vec<Vec<Choice>> {
    let mut pieces_of: Vec<Vec<Piece>> = vec![Vec::new(); own.len()];
    for piece in pieces(layout, &relaxed.near, &relaxed.sites) {
        pieces_of[piece.site as usize].push(piece);
    }
    parallel::map(own.len(), |site| {
        let Some((face, place)) = own[site] else { return Vec::new() };
        let mut choices = vec![Choice { face, place, cost: 0.0 }];
        let cell = relaxed.diagram.cells[site];
        let (centroid, distance) = (cell.moment.position / cell.mass, relaxed.sites[site].distance);
        let mut random = Random::new(options.seed ^ site as u64, purpose::PLACES);
        let step = cell.mass / f64::from(options.places);
        let (mut passed, mut next) = (0.0, step * random.unit());
        for piece in &pieces_of[site] {
            passed += piece.mass;
            while next < passed {
                next += step;
                let tile = &layout.tiles[piece.tile as usize];
                let place = inside(tile.corners, piece, &mut random);
                let cost = options.stay * place.distance_squared(centroid) / (distance * distance);
                choices.push(Choice { face: tile.face, place: place + middle, cost });
            }
        }
        choices
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
    let mass: f64 = relaxed.diagram.cells.iter().map(|c| c.mass).sum();
    for (site, of_site) in choices.iter().enumerate() {
        if of_site.is_empty() {
            continue;
        }
        for_views(row(site, 0), |view| excess[view] += 1.0);
        // The first choice is where the point stands; the others stand for the cell.
        let samples = of_site.len().max(2) - 1;
        let share = relaxed.diagram.cells[site].mass / mass * choices.len() as f64 / samples as f64;
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

fn cameras(mesh: &SurfaceMesh, options: &ForViews) -> Vec<Camera> {
    let (low, high) = mesh.bounds();
    let (middle, radius) = ((low + high) * 0.5, 0.5 * low.distance(high));
    let count = options.views.max(1) as usize;
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
