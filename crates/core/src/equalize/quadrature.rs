//! Places with weights that stand for a cell where it is seen from nearby.

use glam::{DMat3, DVec2, DVec3};

use super::holdings::Holding;
use super::layout::Layout;
use super::owners::Piece;
use super::places::pieces_of;
use super::relax::Relaxed;
use super::sources::LANES;
use crate::geometry::triangle::longest_side;
use crate::parallel;

/// At most so many places for a cell; a multiple of the lanes.
const ATOMS: usize = 4 * LANES;

/// Cells that have more than this share of their mass on one tile are cut finer than tiles.
const COARSE: f64 = 0.2;

/// Into pieces of at most this share.
const SHARE: f64 = 2.0 / ATOMS as f64;

/// A place that stands for a cell is as wide as this share of the cell.
const GRAIN: f64 = 0.25;

/// A cell of mass 1 as places with weights.
pub(super) struct Quadrature {
    pub(super) centroid: DVec3,
    /// From the centroid, coordinate by coordinate.
    away: [[f32; ATOMS]; 3],
    weights: [f32; ATOMS],
    /// The square of how wide each place is.
    grain: f32,
}

/// A place with mass.
#[derive(Clone, Copy, Debug, Default)]
struct Atom {
    place: DVec3,
    mass: f64,
}

/// For some sites, in order; lengths times `unit`. Linear in tiles.
pub(super) fn quadratures(layout: &Layout, relaxed: &Relaxed, sites: &[u32], unit: f64) -> Vec<Quadrature> {
    let mut coarse = vec![false; relaxed.sites.len()];
    for site in sites.iter().map(|&site| site as usize) {
        let most = COARSE * relaxed.cells[site].mass;
        coarse[site] = relaxed.holdings.of(site).iter().any(|holding| holding.mass > most);
    }
    let pieces = pieces_of(layout, relaxed, |site| coarse[site]);
    parallel::map(sites.len(), |i| {
        let site = sites[i] as usize;
        let cell = &relaxed.cells[site];
        let atoms = if pieces[site].is_empty() {
            let atom = |holding: &Holding| Atom { place: holding.centroid(layout), mass: holding.mass };
            evenly(relaxed.holdings.of(site).iter().map(atom))
        } else {
            evenly(cut(layout, &pieces[site], SHARE * cell.mass).into_iter())
        };
        Quadrature::new(cell.centroid(), &atoms, unit)
    })
}

impl Quadrature {
    fn new(centroid: DVec3, atoms: &[Atom], unit: f64) -> Self {
        let mass: f64 = atoms.iter().map(|atom| atom.mass).sum();
        // Rounded, and some of many: off by a little.
        let mean = atoms.iter().map(|atom| atom.place * atom.mass).sum::<DVec3>() / mass;
        let mut it =
            Self { centroid: centroid * unit, away: [[0.0; ATOMS]; 3], weights: [0.0; ATOMS], grain: 0.0 };
        for (k, atom) in atoms.iter().enumerate() {
            let away = (atom.place - mean) * unit;
            (0..3).for_each(|axis| it.away[axis][k] = away[axis] as f32);
            it.weights[k] = (atom.mass / mass) as f32;
        }
        // Never zero: a place is at no distance from itself.
        it.grain = ((GRAIN * GRAIN * trace(&it.covariance())) as f32).max(f32::MIN_POSITIVE);
        it
    }

    /// Of places that stand for the same share each.
    #[cfg(test)]
    pub(super) fn of_places(centroid: DVec3, places: &[DVec3]) -> Self {
        let atoms: Vec<Atom> = places.iter().map(|&place| Atom { place, mass: 1.0 }).collect();
        Self::new(centroid, &atoms, 1.0)
    }

    pub(super) fn covariance(&self) -> DMat3 {
        let of = |k: usize| {
            let away = DVec3::from_array([0, 1, 2].map(|axis| f64::from(self.away[axis][k])));
            outer(away) * f64::from(self.weights[k])
        };
        (0..ATOMS).map(of).fold(DMat3::ZERO, |sum, one| sum + one)
    }

    /// The slope of the mean distance to the cell.
    pub(super) fn slope(&self, from: DVec3) -> DVec3 {
        let from = (from - self.centroid).as_vec3();
        let [ax, ay, az] = &self.away;
        let mut sum = [[0.0_f32; LANES]; 3];
        let [right, up, out] = &mut sum;
        for start in (0..ATOMS).step_by(LANES) {
            for lane in 0..LANES {
                let k = start + lane;
                let (x, y, z) = (from.x - ax[k], from.y - ay[k], from.z - az[k]);
                let inverse = self.weights[k] / (x * x + y * y + z * z + self.grain).sqrt();
                right[lane] += x * inverse;
                up[lane] += y * inverse;
                out[lane] += z * inverse;
            }
        }
        DVec3::from_array(sum.map(|lanes| f64::from(lanes.iter().sum::<f32>())))
    }
}

/// The matrix that a vector makes with itself.
pub(super) fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

pub(super) fn trace(matrix: &DMat3) -> f64 {
    matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z
}

/// Of more than [`ATOMS`] atoms as many, evenly by mass; all of fewer.
fn evenly(atoms: impl Iterator<Item = Atom> + Clone) -> Vec<Atom> {
    if atoms.clone().nth(ATOMS).is_none() {
        return atoms.collect();
    }
    let mass = atoms.clone().map(|atom| atom.mass).sum::<f64>() / ATOMS as f64;
    let (mut passed, mut chosen) = (0.0, Vec::with_capacity(ATOMS));
    for atom in atoms {
        passed += atom.mass;
        while passed > (chosen.len() as f64 + 0.5) * mass && chosen.len() < ATOMS {
            chosen.push(Atom { place: atom.place, mass });
        }
    }
    chosen
}

/// Pieces cut into atoms of at most so much mass.
fn cut(layout: &Layout, pieces: &[Piece], most: f64) -> Vec<Atom> {
    let mut atoms = Vec::new();
    for piece in pieces {
        let [a, b, c] = layout.corners(&layout.tiles[piece.tile as usize]);
        let at = |p: DVec2| a + (b - a) * p.x + (c - a) * p.y;
        let first = piece.polygon[0];
        let doubled = |p: &[DVec2]| (p[0] - first).perp_dot(p[1] - first);
        let all: f64 = piece.polygon[1..].windows(2).map(doubled).sum();
        // Of what rounding leaves of a cell everything would be heavy.
        let most = most.max(piece.mass / ATOMS as f64);
        for pair in piece.polygon[1..].windows(2) {
            let mass = piece.mass * (doubled(pair) / all);
            if mass > 0.0 {
                halve([at(first), at(pair[0]), at(pair[1])], mass, most, &mut atoms);
            }
        }
    }
    atoms
}

/// Adds a triangle, in halves across its longest side until they are light enough.
fn halve(corners: [DVec3; 3], mass: f64, most: f64, atoms: &mut Vec<Atom>) {
    if mass <= most {
        atoms.push(Atom { place: corners.iter().sum::<DVec3>() / 3.0, mass });
        return;
    }
    let (longest, _) = longest_side(corners);
    let [from, to, across] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
    let middle = from.midpoint(to);
    halve([across, from, middle], 0.5 * mass, most, atoms);
    halve([across, middle, to], 0.5 * mass, most, atoms);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of many atoms as many stay as there is room for, with the same mass, from the whole row.
    #[test]
    fn atoms_are_chosen_evenly() {
        let atom = |k: usize| Atom { place: DVec3::X * k as f64, mass: if k < 100 { 1.0 } else { 3.0 } };
        let chosen = evenly((0..200).map(atom));
        assert_eq!(chosen.len(), ATOMS);
        let mass: f64 = chosen.iter().map(|atom| atom.mass).sum();
        assert!((mass - 400.0).abs() < 1e-9, "{mass}");
        let light = chosen.iter().filter(|atom| atom.place.x < 100.0).count();
        assert_eq!(light, ATOMS / 4);
        assert_eq!(evenly((0..ATOMS).map(atom)).len(), ATOMS);
    }
}
