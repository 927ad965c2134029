//! A drink can as a laser scanner sees it: dents, wrinkles, noise, torn edges, two holes.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::mesh::shapes::grid::Surface;
use crate::mesh::shapes::unstructured::{in_disc, join_directions};
use crate::mesh::soup::PolygonSoup;
use crate::random::Random;

/// Keeps these random numbers apart from others of the same seed.
const PURPOSE: u64 = 0x0064_7269_6e6b;
const RADIUS: f64 = 1.0;
const HALF_HEIGHT: f64 = 2.0;
/// Tears through the upper and lower edge; each adds 1 to the genus.
const TEARS: u32 = 7;
/// Rings of quads in a tear.
const TEAR_RINGS: u32 = 3;
/// Vertices of the body, such that the whole has the counts of the paper's mesh.
const BODY: usize = 12_431;

/// A dented can of radius 1 and height 4 with the counts of the paper's "Fruit Drink" (figure 6): 12,487 vertices,
/// 37,495 edges, 24,994 triangles; genus 7, two holes of four edges each. Every seed gives other dents.
pub fn drink_like(seed: u64) -> PolygonSoup {
    let mut random = Random::new(seed, PURPOSE);
    let places = on_cylinder(BODY, &mut random);
    let dents: Vec<_> = (0..9).map(|_| Dent::new(&mut random)).collect();
    let directions: Vec<_> = places.iter().map(|p| p.normalize()).collect();
    let positions = places
        .iter()
        .map(|&p| {
            let noise = 0.004 * (random.unit() - 0.5);
            let depth: f64 = dents.iter().map(|dent| dent.depth(p)).sum();
            rounded(p) * (1.0 - depth + noise)
        })
        .collect();
    let mut surface = Surface { positions, faces: join_directions(&directions) };
    for tear in 0..TEARS {
        let (sin, cos) = libm::sincos(TAU * f64::from(tear) / f64::from(TEARS));
        let end = if tear % 2 == 0 { HALF_HEIGHT } else { -HALF_HEIGHT };
        let wall = DVec3::new(cos, sin, 0.9 * end);
        let lid = DVec3::new(0.8 * cos, 0.8 * sin, end);
        let (from, to) = (cut_quad(&mut surface, wall), cut_quad(&mut surface, lid));
        join_quads(&mut surface, from, to);
    }
    cut_quad(&mut surface, DVec3::new(0.0, 0.3, HALF_HEIGHT));
    cut_quad(&mut surface, DVec3::new(0.0, 0.0, -HALF_HEIGHT));
    surface.into_soup()
}

/// Points on the cylinder with lids, the same number for the same area, moved at random.
fn on_cylinder(count: usize, random: &mut Random) -> Vec<DVec3> {
    let lid = PI * RADIUS * RADIUS;
    let wall = 2.0 * PI * RADIUS * 2.0 * HALF_HEIGHT;
    let lid_count = (count as f64 * lid / (2.0 * lid + wall)).round() as usize;
    let wall_count = count - 2 * lid_count;
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let spacing = ((2.0 * lid + wall) / count as f64).sqrt();
    let mut places = Vec::with_capacity(count);
    for i in 0..wall_count {
        let (x, y) = in_disc(random);
        let angle = golden_angle * i as f64 + 0.5 * spacing * x;
        let z = HALF_HEIGHT * (1.0 - (2 * i + 1) as f64 / wall_count as f64) + 0.5 * spacing * y;
        let (sin, cos) = libm::sincos(angle);
        places.push(DVec3::new(cos, sin, z.clamp(-HALF_HEIGHT, HALF_HEIGHT)));
    }
    for end in [HALF_HEIGHT, -HALF_HEIGHT] {
        for i in 0..lid_count {
            let (x, y) = in_disc(random);
            let radius = ((i as f64 + 0.5) / lid_count as f64).sqrt();
            let (sin, cos) = libm::sincos(golden_angle * i as f64);
            let p = DVec3::new(radius * cos + 0.4 * spacing * x, radius * sin + 0.4 * spacing * y, 0.0);
            places.push(p.clamp_length_max(0.999 * RADIUS) + DVec3::Z * end);
        }
    }
    places
}

/// Pulls the sharp edges of the cylinder in: the surface where (rho / radius)^16 + (z / half height)^16 = 1.
fn rounded(p: DVec3) -> DVec3 {
    let sixteenth_power = |x: f64| {
        let fourth = (x * x) * (x * x);
        (fourth * fourth) * (fourth * fourth)
    };
    let rho = p.truncate().length();
    let sum = sixteenth_power(rho / RADIUS) + sixteenth_power(p.z / HALF_HEIGHT);
    p / sum.sqrt().sqrt().sqrt().sqrt()
}

/// A dent in the wall with wrinkles around it.
struct Dent {
    centre: DVec3,
    depth: f64,
    /// 1 / radius^2.
    narrowness: f64,
    wrinkles: f64,
}

impl Dent {
    fn new(random: &mut Random) -> Self {
        let (sin, cos) = libm::sincos(TAU * random.unit());
        let z = HALF_HEIGHT * (1.6 * random.unit() - 0.8);
        let radius = 0.25 + 0.35 * random.unit();
        Self {
            centre: DVec3::new(cos, sin, z),
            depth: 0.04 + 0.1 * random.unit(),
            narrowness: 1.0 / (radius * radius),
            wrinkles: 4.0 + 6.0 * random.unit(),
        }
    }

    /// The share of its distance from the centre by which a point is pushed in.
    fn depth(&self, p: DVec3) -> f64 {
        let from = p - self.centre;
        let reach = from.length_squared() * self.narrowness;
        self.depth * libm::exp(-reach) * (1.0 + 0.35 * libm::cos(self.wrinkles * from.z) * reach.min(2.0))
    }
}

/// Removes the two triangles beside the edge nearest to `place` and returns the four corners of the hole in the order in
/// which the triangles had them. An edge beside another hole is not taken.
fn cut_quad(surface: &mut Surface, place: DVec3) -> [u32; 4] {
    let centre = |face: &[u32; 3]| face.iter().map(|&v| surface.positions[v as usize]).sum::<DVec3>() / 3.0;
    let distances: Vec<_> = surface.faces.iter().map(|face| centre(face).distance_squared(place)).collect();
    let first = (0..distances.len()).min_by(|&i, &j| distances[i].total_cmp(&distances[j])).unwrap_or(0);
    let [a, b, c] = surface.faces[first];
    // The neighbour across the side whose own centre lies nearest to the place.
    let mut best: Option<(usize, [u32; 4])> = None;
    for (from, to, far) in [(a, b, c), (b, c, a), (c, a, b)] {
        for (index, face) in surface.faces.iter().enumerate() {
            for corner in 0..3 {
                if face[corner] == to && face[(corner + 1) % 3] == from {
                    let quad = [far, from, face[(corner + 2) % 3], to];
                    if best.is_none_or(|(other, _)| distances[index] < distances[other]) {
                        best = Some((index, quad));
                    }
                }
            }
        }
    }
    let Some((second, quad)) = best else {
        return [a, b, c, c];
    };
    surface.faces.swap_remove(first.max(second));
    surface.faces.swap_remove(first.min(second));
    quad
}

/// Joins two holes by a tube through the body.
fn join_quads(surface: &mut Surface, from: [u32; 4], to: [u32; 4]) {
    let at = |v: u32| surface.positions[v as usize];
    // Opposite ends of a tube see the same turn in opposite directions.
    let partner = |turn: usize, i: usize| to[(turn + 4 - i) % 4];
    let length =
        |turn: usize| (0..4).map(|i| at(from[i]).distance_squared(at(partner(turn, i)))).sum::<f64>();
    let turn = (0..4).min_by(|&s, &t| length(s).total_cmp(&length(t))).unwrap_or(0);
    let end: [u32; 4] = std::array::from_fn(|i| partner(turn, i));
    let mut low = from;
    for ring in 1..=TEAR_RINGS {
        let high = if ring == TEAR_RINGS {
            end
        } else {
            let along = f64::from(ring) / f64::from(TEAR_RINGS);
            std::array::from_fn(|i| {
                let p = surface.positions[from[i] as usize].lerp(surface.positions[end[i] as usize], along);
                surface.positions.push(p);
                surface.positions.len() as u32 - 1
            })
        };
        for i in 0..4 {
            let j = (i + 1) % 4;
            surface.quad([low[i], low[j], high[j], high[i]]);
        }
        low = high;
    }
}
