//! A body like those that laser scanners give: smooth bumps, a little noise, unstructured triangles.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::mesh::shapes::grid::Surface;
use crate::mesh::shapes::unstructured::{in_disc, join_directions};
use crate::mesh::soup::PolygonSoup;
use crate::parallel;
use crate::random::Random;

/// Keeps these random numbers apart from others of the same seed.
const PURPOSE: u64 = 0x7363_616e;

/// A closed bumpy body of genus 0 about 2 units across with exactly `faces` triangles (at least 8, odd numbers one more)
/// of irregular shape and size; every seed gives another body. O(n log n); a million triangles take about two seconds.
pub fn scan_like(seed: u64, faces: u32) -> PolygonSoup {
    let count = (faces.max(8).div_ceil(2) + 2) as usize;
    let mut random = Random::new(seed, PURPOSE);
    let bumps: Vec<_> = (0..24).map(|k| Bump::new(&mut random, k)).collect();
    let directions = scattered_directions(count, &mut random);
    let spacing = (4.0 * PI / count as f64).sqrt();
    let noise: Vec<_> = (0..count).map(|_| 0.06 * spacing * (random.unit() - 0.5)).collect();
    let positions = parallel::map(count, |i| {
        let d = directions[i];
        let height: f64 = bumps.iter().map(|bump| bump.height(d)).sum();
        d * DVec3::new(1.0, 0.75, 1.2) * (1.0 + height + noise[i])
    });
    Surface { positions, faces: join_directions(&directions) }.into_soup()
}

/// A wave over the sphere.
struct Bump {
    wave: DVec3,
    phase: f64,
    amplitude: f64,
}

impl Bump {
    /// Later ones are shorter and lower.
    fn new(random: &mut Random, index: u32) -> Self {
        let length = 2.0 + 0.5 * f64::from(index);
        let z = 2.0 * random.unit() - 1.0;
        let (sin, cos) = libm::sincos(TAU * random.unit());
        let across = (1.0 - z * z).sqrt();
        let wave = DVec3::new(across * cos, across * sin, z) * length;
        Self { wave, phase: TAU * random.unit(), amplitude: 0.2 / length }
    }

    fn height(&self, direction: DVec3) -> f64 {
        self.amplitude * libm::cos(self.wave.dot(direction) + self.phase)
    }
}

/// Points of a Fibonacci spiral, each moved at random by up to 0.6 of the mean spacing.
fn scattered_directions(count: usize, random: &mut Random) -> Vec<DVec3> {
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let spacing = (4.0 * PI / count as f64).sqrt();
    (0..count)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / count as f64;
            let (sin, cos) = libm::sincos(golden_angle * i as f64);
            let across = (1.0 - z * z).sqrt();
            let d = DVec3::new(across * cos, across * sin, z);
            let (u, v) = d.any_orthonormal_pair();
            let (x, y) = in_disc(random);
            (d + (u * x + v * y) * (0.6 * spacing)).normalize()
        })
        .collect()
}
