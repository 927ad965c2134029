//! Places with weights that stand for a cell where it is seen from nearby.

use glam::{DMat3, DVec2, DVec3};

use super::clip;
use super::diagram::{Owners, Power, walk_some};
use super::field::{outer, trace};
use super::holdings::Holding;
use super::layout::{Layout, Place};
use super::relax::Relaxed;
use super::sources::LANES;
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
    let coarse = Coarse::find(layout, relaxed, sites);
    parallel::map(sites.len(), |i| {
        let site = sites[i] as usize;
        let cut = coarse.of(site);
        let atoms = if cut.is_empty() {
            let atom = |holding: &Holding| Atom { place: holding.centroid(layout), mass: holding.mass };
            evenly(relaxed.holdings.of(site).iter().map(atom))
        } else {
            evenly(cut.iter().map(|(_, atom)| *atom))
        };
        Quadrature::new(relaxed.cells[site].centroid(), &atoms, unit)
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

/// The pieces of cells on coarse tiles, site by site.
struct Coarse(Vec<(u32, Atom)>);

impl Coarse {
    fn find(layout: &Layout, relaxed: &Relaxed, sites: &[u32]) -> Self {
        let Relaxed { near, cells, holdings, .. } = relaxed;
        let mut masses = vec![0.0; cells.len()];
        let mut wanted = vec![false; layout.blocks.len()];
        for &site in sites {
            let (mass, own) = (cells[site as usize].mass, holdings.of(site as usize));
            if own.iter().any(|holding| holding.mass > COARSE * mass) {
                masses[site as usize] = mass;
                own.iter().for_each(|holding| wanted[layout.block_of(holding.tile)] = true);
            }
        }
        let blocks: Vec<u32> =
            (0..).zip(wanted).filter(|(_, wanted)| *wanted).map(|(block, _)| block).collect();
        let new = || Cuts { layout, masses: &masses, sites: Vec::new(), atoms: Vec::new() };
        let heard = walk_some(layout, near, &relaxed.sites, &blocks, new);
        let mut atoms: Vec<(u32, Atom)> = heard.into_iter().flat_map(|cuts| cuts.atoms).collect();
        // Stable: those of a site keep their order.
        atoms.sort_by_key(|(site, _)| *site);
        Self(atoms)
    }

    fn of(&self, site: usize) -> &[(u32, Atom)] {
        let site = site as u32;
        let start = self.0.partition_point(|(other, _)| *other < site);
        let end = self.0.partition_point(|(other, _)| *other <= site);
        &self.0[start..end]
    }
}

/// How much mass an atom of a piece may have. Of what rounding leaves of a cell nothing is a small share.
fn most(of_cell: f64, piece: f64) -> f64 {
    (SHARE * of_cell).max(piece / ATOMS as f64)
}

/// Hears what sites own, cut into atoms.
struct Cuts<'a> {
    layout: &'a Layout,
    /// Of the cells that are wanted; 0 for the others.
    masses: &'a [f64],
    sites: Vec<u32>,
    atoms: Vec<(u32, Atom)>,
}

impl Cuts<'_> {
    /// Adds a triangle, in halves across its longest side until they are light enough.
    fn add(&mut self, site: u32, [a, b, c]: [DVec3; 3], mass: f64, most: f64) {
        if mass <= most {
            self.atoms.push((site, Atom { place: (a + b + c) / 3.0, mass }));
            return;
        }
        let squares = [b.distance_squared(c), c.distance_squared(a), a.distance_squared(b)];
        let (a, b, c) = if squares[0] >= squares[1] && squares[0] >= squares[2] {
            (a, b, c)
        } else if squares[1] >= squares[2] {
            (b, c, a)
        } else {
            (c, a, b)
        };
        let middle = b.midpoint(c);
        self.add(site, [a, b, middle], 0.5 * mass, most);
        self.add(site, [a, middle, c], 0.5 * mass, most);
    }
}

impl Owners for Cuts<'_> {
    const POLYGONS: bool = true;

    fn begin(&mut self, contenders: &[Power]) {
        self.sites.clear();
        self.sites.extend(contenders.iter().map(|power| power.site));
    }

    fn whole(&mut self, site: usize, tile: usize, mass: f64) {
        let site = self.sites[site];
        let of_cell = self.masses[site as usize];
        if of_cell > 0.0 {
            self.add(site, self.layout.corners(&self.layout.tiles[tile]), mass, most(of_cell, mass));
        }
    }

    fn part(&mut self, site: usize, tile: usize, mass: f64, _: [f64; 2], polygon: &[clip::Corner]) {
        let site = self.sites[site];
        let of_cell = self.masses[site as usize];
        if of_cell <= 0.0 {
            return;
        }
        let [a, b, c] = self.layout.corners(&self.layout.tiles[tile]);
        let at = |p: &clip::Corner| a + (b - a) * p.u + (c - a) * p.v;
        let first = DVec2::new(polygon[0].u, polygon[0].v);
        let from_first = |p: &clip::Corner| DVec2::new(p.u, p.v) - first;
        let doubled = |p: &[clip::Corner]| from_first(&p[0]).perp_dot(from_first(&p[1]));
        let all: f64 = polygon[1..].windows(2).map(doubled).sum();
        for pair in polygon[1..].windows(2) {
            let share = mass * (doubled(pair) / all);
            if share > 0.0 {
                self.add(site, [at(&polygon[0]), at(&pair[0]), at(&pair[1])], share, most(of_cell, mass));
            }
        }
    }

    fn moment(&mut self, _: usize, _: Place) {}

    fn border(&mut self, _: [usize; 2], _: f64) {}

    fn end(&mut self, _: &[Power]) {}
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
