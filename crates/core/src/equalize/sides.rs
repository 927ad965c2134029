//! Sides: what lies between creases. A cell that straddles a crease has its point on one side of it; which one is
//! rounded so that every side gets its share of the points to within one.

use glam::DVec3;

use super::holdings::Holdings;
use super::layout::Layout;
use crate::density::Density;
use crate::ids::{FaceId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// Neighbours whose normals are at least this far apart (squared distance; 4 sin^2(15 degrees)) meet in a crease.
const CREASE: f64 = 0.267_949_192_431_122_7;

/// Sides that are due fewer points than this are one side together.
const FEWEST: f64 = 0.5;

/// Which side each face belongs to; at least two.
pub(super) struct Sides {
    of_face: Vec<u32>,
    /// The mean normal of each side.
    normals: Vec<DVec3>,
}

impl Sides {
    /// Of `n` points; `None` where there is one side only.
    pub(super) fn new(
        mesh: &SurfaceMesh,
        strip_of_face: impl Fn(FaceId) -> StripId,
        density: &Density,
        n: usize,
    ) -> Option<Self> {
        let parts = mesh.topology().components_across(|side, twin| {
            let (face, near) = (side.face(), twin.face());
            strip_of_face(face) == strip_of_face(near)
                && mesh.face_normal(face).distance_squared(mesh.face_normal(near)) < CREASE
        });
        let mass = |face| density.face_mass(mesh, face);
        let each = mesh.topology().face_ids().map(mass).sum::<f64>() / n as f64;
        let mut due = vec![0.0; parts.count];
        for (part, face) in parts.of_face.iter().zip(mesh.topology().face_ids()) {
            due[*part as usize] += mass(face) / each;
        }
        // The first is that of all small ones.
        let mut count = 1;
        let mut number = vec![0; parts.count];
        for (number, _) in number.iter_mut().zip(&due).filter(|(_, due)| **due >= FEWEST) {
            *number = count;
            count += 1;
        }
        if count <= 2 && due.iter().filter(|&&due| due < FEWEST).sum::<f64>() < FEWEST {
            return None;
        }
        let mut of_face = parts.of_face;
        of_face.iter_mut().for_each(|part| *part = number[*part as usize]);
        let mut normals = vec![(DVec3::ZERO, 0.0); count as usize];
        for (side, face) in of_face.iter().zip(mesh.topology().face_ids()) {
            let (sum, mass): (DVec3, f64) = normals[*side as usize];
            let of_face = density.face_mass(mesh, face);
            normals[*side as usize] = (sum + mesh.face_normal(face) * of_face, mass + of_face);
        }
        let normals =
            normals.into_iter().map(|(sum, mass)| if mass > 0.0 { sum / mass } else { sum }).collect();
        Some(Self { of_face, normals })
    }

    pub(super) fn of(&self, face: FaceId) -> u32 {
        self.of_face[face.index()]
    }

    /// The side on which the point of each of so many sites stands; `None` where its cell is empty.
    pub(super) fn share_out(&self, layout: &Layout, holdings: &Holdings, sites: usize) -> Vec<Option<u32>> {
        let mut parts: Vec<Vec<Part>> = parallel::map(sites, |site| {
            let mut parts = Vec::new();
            for holding in holdings.of(site) {
                let side = self.of(layout.tiles[holding.tile as usize].face);
                add(&mut parts, Part { side, share: holding.mass });
            }
            let mass: f64 = parts.iter().map(|p| p.share).sum();
            parts.iter_mut().for_each(|p| p.share /= mass);
            parts.retain(|p| p.share > 0.0);
            parts
        });
        round(&mut parts, &self.normals);
        let largest =
            |parts: &Vec<Part>| parts.iter().max_by(|a, b| a.share.total_cmp(&b.share)).map(|part| part.side);
        parts.iter().map(largest).collect()
    }
}

/// What of a cell lies on a side: mass, later the share of the cell's mass, last 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    side: u32,
    share: f64,
}

fn add(parts: &mut Vec<Part>, part: Part) {
    match parts.iter_mut().find(|p| p.side == part.side) {
        Some(p) => p.share += part.share,
        None => parts.push(part),
    }
}

/// What sides have more than they are due.
struct Surplus<'a> {
    normals: &'a [DVec3],
    of_side: Vec<f64>,
    /// The sum of what sides have too much times their normals: how far a view from there sees too many points.
    tilt: DVec3,
}

/// Against the square of the tilt so much counts the sum of the squares of what sides have too much.
const EVEN: f64 = 0.25;

impl Surplus<'_> {
    /// How bad it would be to take that much from the second of two sides for the first.
    fn after(&self, [a, b]: [usize; 2], by: f64) -> f64 {
        let [more, less] = [self.of_side[a] + by, self.of_side[b] - by];
        let tilt = self.tilt + (self.normals[a] - self.normals[b]) * by;
        tilt.length_squared() + EVEN * (more * more + less * less)
    }

    fn shift(&mut self, [a, b]: [usize; 2], by: f64) {
        self.of_side[a] += by;
        self.of_side[b] -= by;
        self.tilt += (self.normals[a] - self.normals[b]) * by;
    }
}

/// Shares this near to 0 or 1 are that.
const WHOLE: f64 = 1e-9;

fn is_open(share: f64) -> bool {
    share > WHOLE && share < 1.0 - WHOLE
}

/// An open share: of which cell, at which place among its parts.
type Edge = (u32, u32);

/// Makes every share 0 or 1. Cells keep their sum, 1, and the sum of every side ends at a whole number beside it.
///
/// Cells and sides are the vertices of a graph, open shares its edges. Along a cycle, or a path between sides with one
/// open share each, shares are raised and lowered in turn until one is whole (pipage rounding: Ageev and Sviridenko
/// 2004, DOI 10.1023/B:JOCO.0000038913.96607.c2). The way that raises what is large already is taken. Returns how many cycles
/// and paths there were, at most one for each open share.
fn round(cells: &mut [Vec<Part>], normals: &[DVec3]) -> usize {
    let sides = normals.len();
    let mut at_side: Vec<Vec<Edge>> = vec![Vec::new(); sides];
    for (cell, parts) in (0..).zip(cells.iter()) {
        for (k, part) in (0..).zip(parts).filter(|(_, part)| is_open(part.share)) {
            at_side[part.side as usize].push((cell, k));
        }
    }
    // Sides from where to start: those with one open share as soon as there are some.
    let mut leaves: Vec<usize> = (0..sides).filter(|&side| at_side[side].len() == 1).collect();
    let mut position: Vec<Option<usize>> = vec![None; sides];
    let mut surplus = Surplus { normals, of_side: vec![0.0; sides], tilt: DVec3::ZERO };
    let (mut next, mut shifts) = (0, 0);
    loop {
        let start = loop {
            match leaves.pop() {
                Some(side) if at_side[side].len() == 1 => break Some(side),
                Some(_) => {}
                None => break None,
            }
        };
        let start = match start {
            Some(side) => side,
            None => {
                while next < sides && at_side[next].is_empty() {
                    next += 1;
                }
                if next == sides {
                    return shifts;
                }
                next
            }
        };
        // Edges in turn: into a cell, out of it into another side.
        let mut walk: Vec<Edge> = Vec::new();
        let mut passed = vec![start];
        position[start] = Some(0);
        let mut side = start;
        let mut first = loop {
            let came_by = walk.last().map(|edge| edge.0);
            let Some(&(cell, k)) = at_side[side].iter().find(|edge| Some(edge.0) != came_by) else {
                // The end of a path between two sides with one open share.
                break 0;
            };
            let parts = &cells[cell as usize];
            let out = (0..parts.len()).find(|&other| other != k as usize && is_open(parts[other].share));
            let Some(out) = out else {
                // Rounding errors left this share alone.
                walk.push((cell, k));
                break walk.len() - 1;
            };
            walk.extend([(cell, k), (cell, out as u32)]);
            side = parts[out].side as usize;
            if let Some(before) = position[side] {
                // A cycle; what led to it stays.
                break 2 * before;
            }
            position[side] = Some(passed.len());
            passed.push(side);
        };
        for side in &passed {
            position[*side] = None;
        }
        let turn = passed[first / 2];
        // A walk may have come into a cell by one share, out by a second, later in by a third and out by the first again: the
        // two passes cancel, and what lies between is a cycle by itself.
        if walk.len() > first + 2 && walk[first] == walk[walk.len() - 1] {
            walk.pop();
            first += 1;
        }
        // A path changes the sums of its ends, a cycle none.
        let ends = (side != turn).then_some([start, side]);
        shift(cells, &walk[first..], ends, &mut surplus);
        shifts += 1;
        for &(cell, k) in &walk[first..] {
            let part = cells[cell as usize][k as usize];
            if !is_open(part.share) {
                let edges = &mut at_side[part.side as usize];
                edges.retain(|edge| *edge != (cell, k));
                if edges.len() == 1 {
                    leaves.push(part.side as usize);
                }
            }
        }
        if at_side[start].len() == 1 {
            leaves.push(start);
        }
    }
}

/// Raises every other share and lowers those between until one is whole. The first is the first end's, the last the
/// second's.
fn shift(cells: &mut [Vec<Part>], walk: &[Edge], ends: Option<[usize; 2]>, surplus: &mut Surplus) {
    let share = |cells: &[Vec<Part>], (cell, k): Edge| cells[cell as usize][k as usize].share;
    if let [alone] = walk {
        let part = &mut cells[alone.0 as usize][alone.1 as usize];
        part.share = part.share.round();
        return;
    }
    let signed = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    let room = |way: f64, i: usize, share: f64| if way * signed(i) > 0.0 { 1.0 - share } else { share };
    let shares: Vec<f64> = walk.iter().map(|&edge| share(cells, edge)).collect();
    let by = |way: f64| {
        shares.iter().enumerate().map(|(i, &share)| room(way, i, share)).fold(f64::INFINITY, f64::min)
    };
    let [raised, lowered] =
        [1.0, -1.0].map(|way| ends.map_or(0.0, |ends| surplus.after(ends, way * by(way))));
    let large: f64 = shares.iter().enumerate().map(|(i, share)| signed(i) * share).sum();
    let raise = if (raised - lowered).abs() > WHOLE { raised < lowered } else { large >= 0.0 };
    let way = if raise { 1.0 } else { -1.0 };
    let by = by(way);
    if let Some(ends) = ends {
        surplus.shift(ends, way * by);
    }
    for (i, &(cell, k)) in walk.iter().enumerate() {
        let share = &mut cells[cell as usize][k as usize].share;
        let whole = room(way, i, *share) <= by + WHOLE;
        *share += way * signed(i) * by;
        if whole {
            *share = share.round();
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_side_gets_its_share_to_within_one(
            raw in prop::collection::vec(prop::collection::vec((0_u32..12, 0.01_f64..1.0), 1..5), 1..60)
        ) {
            let mut cells: Vec<Vec<Part>> = Vec::new();
            for parts in raw {
                let mut cell = Vec::new();
                parts.into_iter().for_each(|(side, share)| add(&mut cell, Part { side, share }));
                let sum: f64 = cell.iter().map(|p| p.share).sum();
                cell.iter_mut().for_each(|p| p.share /= sum);
                cells.push(cell);
            }
            let sums = |cells: &[Vec<Part>]| {
                let mut sums = [0.0; 12];
                cells.iter().flatten().for_each(|p| sums[p.side as usize] += p.share);
                sums
            };
            let due = sums(&cells);
            let open = cells.iter().flatten().filter(|p| is_open(p.share)).count();
            prop_assert!(round(&mut cells, &[DVec3::ZERO; 12]) <= open);
            for cell in &cells {
                prop_assert!(cell.iter().all(|p| p.share == 0.0 || p.share == 1.0));
                prop_assert_eq!(cell.iter().filter(|p| p.share == 1.0).count(), 1);
            }
            for (due, got) in due.iter().zip(sums(&cells)) {
                prop_assert!((due - got).abs() < 1.0 + 1e-6, "{} for {}", got, due);
            }
        }
    }

    /// A share that is hardly open, by which a walk comes into a cell and goes out of it again, does not set the pace.
    #[test]
    fn small_shares_do_not_make_many_steps() {
        let cell = |shares: &[(u32, f64)]| -> Vec<Part> {
            shares.iter().map(|&(side, share)| Part { side, share }).collect()
        };
        let mut cells = vec![
            cell(&[(0, 1e-6), (1, 0.5 - 1e-6), (2, 0.5)]),
            cell(&[(1, 0.3), (2, 0.7)]),
            cell(&[(0, 0.5), (1, 0.5)]),
        ];
        assert!(round(&mut cells, &[DVec3::ZERO; 3]) <= 7);
    }
}
