//! How small the errors over balls and half-spaces can be on a mesh:
//! `cargo run --release -p ldwrap --example limit -- horse.ply 56 335 1000 10000`
//!
//! What points are off in a figure happens along its border. For the most even points of the plane, the hexagonal lattice,
//! one to a unit of area and shifted at random, the variance of the number in a large disc is 0.0716 of its circumference (Kendall 1948);
//! independent points have n v (1 - v), with v the share of area. So over figures whose borders on the surface are L long
//! in the mean, n points that are as even as that lattice err by sqrt(0.0716 L / (sqrt(n A) mean v (1 - v))) in units of
//! random points. L follows from how often the ends of short segments in the surface lie on two sides (Buffon's needle).
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::{PI, TAU};

use glam::DVec3;
use ldwrap::baseline::{random, spherical_fibonacci};
use ldwrap::io::read_mesh;
use ldwrap::measure::BallOptions;
use ldwrap::{CheckOptions, SurfaceMesh};

/// How often the surface is asked in a round.
const TRIALS: usize = 500_000;

const ROUNDS: u64 = 20;

/// The length of a segment over the root of the area.
const SHORT: f64 = 0.002;

const GOLDEN: f64 = 0.618_033_988_749_894_9;
const SILVER: f64 = 0.414_213_562_373_095_1;
/// The lattice of directions goes by the golden section, so what should not depend on it goes by this.
const BRONZE: f64 = 0.302_775_637_731_994_6;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: limit MESH N...")?;
    let counts = arguments.map(|text| text.parse()).collect::<Result<Vec<f64>, _>>()?;
    let soup = read_mesh(&std::fs::read(&path)?, Some(&path), &|_| Err("one file only".into()))?;
    let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default())?;
    let lattice = lattice();
    println!("hexagonal lattice: variance {lattice:.4} of the circumference");
    for (name, Figures { border, variance }) in ["ball", "half-space"].into_iter().zip(figures(&mesh, ROUNDS))
    {
        println!("{name}: border {border:.3} sqrt(A), v (1 - v) {variance:.4} in the mean");
        for count in &counts {
            let least = (lattice * border / (count.sqrt() * variance)).sqrt();
            println!("  n = {count}: {least:.3} of the error of random points");
        }
    }
    Ok(())
}

/// A fraction that differs from one number to the next as evenly as can be.
fn part(i: usize, step: f64) -> f64 {
    (i as f64 * step).fract()
}

/// The variance of the number of lattice points in a disc over its circumference.
pub(crate) fn lattice() -> f64 {
    let side = (2.0 / 3.0_f64.sqrt()).sqrt();
    let height = side * 0.75_f64.sqrt();
    let (mut squares, mut circumferences) = (0.0, 0.0);
    for i in 0..40_000 {
        let radius = 6.0 + 10.0 * part(i, 0.324_717_957_244_746);
        let (u, v) = (part(i, GOLDEN), part(i, SILVER));
        let (x, y) = (side * (u + 0.5 * v), height * v);
        let rows = (radius / height) as i64 + 2;
        let in_row = |row: i64| {
            let up = height * row as f64 - y;
            let half = (radius * radius - up * up).max(0.0).sqrt();
            let [first, last] = [x - half, x + half].map(|end| end / side - 0.5 * row as f64);
            if half > 0.0 { last.floor() - first.ceil() + 1.0 } else { 0.0 }
        };
        let excess = (-rows..=rows).map(in_row).sum::<f64>() - PI * radius * radius;
        squares += excess * excess;
        circumferences += TAU * radius;
    }
    squares / circumferences
}

/// Means over the figures of a measure.
pub(crate) struct Figures {
    /// The length of the border over the root of the area.
    pub(crate) border: f64,
    /// v (1 - v), with v the share of area.
    pub(crate) variance: f64,
}

/// Of the balls and of the half-spaces that the measures try.
pub(crate) fn figures(mesh: &SurfaceMesh, rounds: u64) -> [Figures; 2] {
    let BallOptions { smallest, largest, .. } = BallOptions::default();
    let directions = spherical_fibonacci(TRIALS);
    let (mut apart, mut between) = ([0.0; 2], [0.0; 2]);
    for round in 0..rounds {
        // Where a segment begins, another place, and where the figure is.
        let [starts, others, figures] = [0, 1, 2].map(|k| random(mesh, TRIALS, 3 * round + k));
        for i in 0..TRIALS {
            let start = mesh.locate(&starts[i]);
            let normal = mesh.face_normal(starts[i].face);
            let (sin, cos) = libm::sincos(TAU * part(i, BRONZE));
            let right = normal.any_orthonormal_vector();
            let end = start + (right * cos + normal.cross(right) * sin) * (SHORT * mesh.area().sqrt());
            let (other, figure) = (mesh.locate(&others[i]), mesh.locate(&figures[i]));
            let share = smallest * libm::pow(largest / smallest, part(i, SILVER));
            let in_ball = |place: DVec3| PI * place.distance_squared(figure) <= share * mesh.area();
            let in_half_space = |place: DVec3| (place - figure).dot(directions[i]) < 0.0;
            for (k, is_in) in [&in_ball as &dyn Fn(DVec3) -> bool, &in_half_space].into_iter().enumerate() {
                let begins = is_in(start);
                apart[k] += f64::from(u8::from(begins != is_in(end)));
                between[k] += f64::from(u8::from(begins && !is_in(other)));
            }
        }
    }
    let trials = TRIALS as f64 * rounds as f64;
    [0, 1].map(|k| Figures { border: apart[k] / trials * PI / (2.0 * SHORT), variance: between[k] / trials })
}
