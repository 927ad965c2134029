//! Fixed, evenly spread test sets: directions, and places on a surface. The same on every run.

use glam::{DQuat, DVec3};

use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::random::Random;
use crate::sample::SurfacePoint;

/// Keeps the streams of this module apart from those of the stages.
const PURPOSE: u64 = 0x6d65_6173_7572_6501;

/// The conjugate of the golden ratio: multiples of it fill [0, 1) evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The digits of `index` in `base`, mirrored at the point: the radical inverse, in [0, 1).
pub(super) fn radical_inverse(base: u32, index: u32) -> f64 {
    let scale = 1.0 / f64::from(base);
    let (mut rest, mut weight, mut value) = (index, scale, 0.0);
    while rest > 0 {
        value += f64::from(rest % base) * weight;
        rest /= base;
        weight *= scale;
    }
    value
}

/// The fractional part of a number that is not negative.
pub(super) fn fraction(x: f64) -> f64 {
    x - x.floor()
}

/// `count` unit vectors, one of each pair of opposite directions, evenly spread: a spherical Fibonacci lattice on
/// the half sphere, turned by a uniform random rotation that depends on `block` alone.
pub(super) fn directions(count: usize, block: usize) -> Vec<DVec3> {
    let mut random = Random::new(block as u64, PURPOSE);
    let rotation = random_rotation(&mut random);
    (0..count)
        .map(|i| {
            let z = (i as f64 + 0.5) / count as f64;
            let azimuth = std::f64::consts::TAU * fraction(i as f64 * GOLDEN);
            let (sin, cos) = libm::sincos(azimuth);
            let radius = (1.0 - z * z).sqrt();
            rotation * DVec3::new(radius * cos, radius * sin, z)
        })
        .collect()
}

/// A uniform random rotation (Shoemake, Graphics Gems III, 1992).
fn random_rotation(random: &mut Random) -> DQuat {
    let (u, v, w) = (random.unit(), random.unit(), random.unit());
    let (s, c) = libm::sincos(std::f64::consts::TAU * v);
    let (t, d) = libm::sincos(std::f64::consts::TAU * w);
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    DQuat::from_xyzw(a * s, a * c, b * t, b * d)
}

/// `count` places spread evenly over the area: the faces in their order laid end to end by area, cut into `count`
/// equal parts, one place in each. `stream` turns them all, so that sets of different streams differ.
pub(super) fn places(mesh: &SurfaceMesh, count: usize, stream: u64) -> Vec<SurfacePoint> {
    let mut random = Random::new(stream, PURPOSE);
    let (along_shift, across_shift) = (random.unit(), random.unit());
    let areas = mesh.face_areas();
    let mut places = Vec::with_capacity(count);
    let (mut face, mut before) = (0, 0.0);
    for i in 0..count {
        let target = (i as f64 + along_shift) / count as f64 * mesh.area();
        while face + 1 < areas.len() && before + areas[face] < target {
            before += areas[face];
            face += 1;
        }
        let along = ((target - before) / areas[face]).clamp(0.0, 1.0);
        let across = fraction(radical_inverse(2, i as u32) + across_shift);
        let root = along.sqrt();
        places.push(SurfacePoint {
            face: FaceId::new(face),
            barycentric: [1.0 - root, root * (1.0 - across), root * across],
        });
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radical_inverse_by_hand() {
        assert_eq!(radical_inverse(2, 6), 0.375);
        assert!((radical_inverse(3, 5) - (2.0 / 3.0 + 1.0 / 9.0)).abs() < 1e-15);
        assert_eq!(radical_inverse(5, 0), 0.0);
    }

    #[test]
    fn directions_are_unit_vectors_and_balanced() {
        let all = directions(200, 3);
        let mut moment = [0.0; 3];
        for w in &all {
            assert!((w.length() - 1.0).abs() < 1e-14);
            for (m, x) in moment.iter_mut().zip(w.to_array()) {
                *m += x * x / 200.0;
            }
        }
        for m in moment {
            assert!((m - 1.0 / 3.0).abs() < 2e-3, "{moment:?}");
        }
    }
}
