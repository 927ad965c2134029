//! Patches: parts of the surface that get a whole number of points each, so that the shares of components, segments
//! and planes come out right.
//!
//! A cell that straddles a crease gives its point to one side by chance; over a plane's border these chances add up.
//! So a plane or a smooth part that holds enough points is equalized by itself.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::tiles::cell_key;
use crate::ids::{FaceId, HalfedgeId, StripId};
use crate::mesh::SurfaceMesh;
use crate::sets::Sets;

/// Neighbours whose normals are at least this far apart (squared distance; 4 sin^2(15 degrees)) meet in a crease.
const CREASE: f64 = 0.267_949_192_431_122_7;

/// A curved patch worth fewer points than this joins a neighbour: rounding its number would change its density too
/// much.
const FEWEST: f64 = 40.0;

/// The same for a plane, whose share views and counts tell more about.
const FEWEST_OF_PLANE: f64 = 6.0;

/// Normals no farther apart than this (squared distance) are those of one plane.
const FLAT: f64 = 1e-8;

/// What has at most this share of the mass of a plane may join it and leave it one.
const RIM: f64 = 0.1;

/// Which patch each face belongs to and how many points each patch gets.
pub(super) struct Patches {
    /// `None` for the faces of components whose share came out as no point.
    pub(super) of_face: Vec<Option<u32>>,
    /// At least 1 for every patch.
    pub(super) counts: Vec<usize>,
}

impl Patches {
    /// Cuts the surface along creases, components and strips and shares out `n` points by mass: every run of patches
    /// in their order (components along a Morton curve, in them strips, in them patches) gets its share to within one.
    pub(super) fn new(mesh: &SurfaceMesh, strip_of_face: &[StripId], mass: &[f64], n: usize) -> Self {
        let total: f64 = mass.iter().sum();
        let components = mesh.topology().components();
        let mut sets = Sets::new(mesh.face_count());
        for face in mesh.topology().face_ids() {
            for (neighbour, bend) in neighbours(mesh, face) {
                if bend < CREASE && strip_of_face[face.index()] == strip_of_face[neighbour.index()] {
                    sets.join(face.0, neighbour.0);
                }
            }
        }
        merge_small(mesh, strip_of_face, mass, total / n as f64, &mut sets);

        // Order: components along a curve through space, so that neighbours share the rounding.
        let mut moments = vec![(DVec3::ZERO, 0.0); components.count];
        for face in mesh.topology().face_ids() {
            let [a, b, c] = mesh.triangle(face);
            let m = &mut moments[components.of_face[face.index()] as usize];
            m.0 += (a + b + c) / 3.0 * mesh.face_area(face);
            m.1 += mesh.face_area(face);
        }
        let (low, high) = mesh.bounds();
        let cell = (high - low).max_element() / 1024.0;
        let curve: Vec<u64> = moments
            .iter()
            .map(|(moment, area)| cell_key(*moment / *area - low, cell.max(f64::MIN_POSITIVE)))
            .collect();
        let mut roots: Vec<u32> = (0..mesh.face_count() as u32).filter(|&f| sets.root(f) == f).collect();
        roots.sort_by_key(|&f| {
            let component = components.of_face[f as usize];
            (curve[component as usize], component, strip_of_face[f as usize], f)
        });
        let mut patch_mass = vec![0.0; mesh.face_count()];
        for f in 0..mesh.face_count() as u32 {
            patch_mass[sets.root(f) as usize] += mass[f as usize];
        }
        let mut counts = Vec::new();
        let mut number = vec![None; mesh.face_count()];
        let (mut passed, mut given) = (0.0, 0);
        for (k, &root) in roots.iter().enumerate() {
            passed += patch_mass[root as usize];
            let due =
                if k + 1 == roots.len() { n } else { ((passed / total * n as f64).round() as usize).min(n) };
            if due > given {
                number[root as usize] = Some(counts.len() as u32);
                counts.push(due - given);
                given = due;
            }
        }
        let of_face = (0..mesh.face_count() as u32).map(|f| number[sets.root(f) as usize]).collect();
        Self { of_face, counts }
    }
}

/// The faces beside a face, with the squared distance of the normals.
fn neighbours(mesh: &SurfaceMesh, face: FaceId) -> impl Iterator<Item = (FaceId, f64)> + use<'_> {
    (0..3).filter_map(move |c| {
        let neighbour = mesh.topology().twin(HalfedgeId::of(face, c))?.face();
        Some((neighbour, mesh.face_normal(face).distance_squared(mesh.face_normal(neighbour))))
    })
}

/// Joins every set worth too few points (`each` is the mass for a point) to a neighbour, the lightest first: one of
/// its own strip if there is one, then the one with the longest common border.
fn merge_small(mesh: &SurfaceMesh, strip_of_face: &[StripId], mass: &[f64], each: f64, sets: &mut Sets) {
    let count = mesh.face_count();
    let mut weight = vec![0.0; count];
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); count];
    for f in 0..count as u32 {
        let root = sets.root(f) as usize;
        weight[root] += mass[f as usize];
        members[root].push(f);
    }
    let far =
        |a: u32, b: u32| mesh.face_normal(FaceId(a)).distance_squared(mesh.face_normal(FaceId(b))) > FLAT;
    let mut curved = vec![false; count];
    for f in 0..count as u32 {
        let root = sets.root(f);
        curved[root as usize] |= far(f, root);
    }
    let least = |curved: bool| each * if curved { FEWEST } else { FEWEST_OF_PLANE };
    let mut light: BinaryHeap<Reverse<(u64, u32)>> = (0..count as u32)
        .filter(|&f| !members[f as usize].is_empty() && weight[f as usize] < least(curved[f as usize]))
        .map(|f| Reverse((weight[f as usize].to_bits(), f)))
        .collect();
    while let Some(Reverse((bits, set))) = light.pop() {
        if sets.root(set) != set || weight[set as usize].to_bits() != bits {
            continue;
        }
        // (other set, own strip, border length)
        let mut borders: Vec<(u32, bool, f64)> = Vec::new();
        for &f in &members[set as usize] {
            let face = FaceId(f);
            for c in 0..3 {
                let halfedge = HalfedgeId::of(face, c);
                let Some(twin) = mesh.topology().twin(halfedge) else { continue };
                let other = sets.root(twin.face().0);
                if other == set {
                    continue;
                }
                let own = strip_of_face[twin.face().index()] == strip_of_face[face.index()];
                let length = mesh.edge_length(halfedge);
                match borders.iter_mut().find(|b| b.0 == other && b.1 == own) {
                    Some(border) => border.2 += length,
                    None => borders.push((other, own, length)),
                }
            }
        }
        let best = borders.iter().max_by(|a, b| a.1.cmp(&b.1).then(a.2.total_cmp(&b.2)).then(b.0.cmp(&a.0)));
        let Some(&(other, _, _)) = best else { continue };
        let [light_one, heavy_one] =
            if weight[set as usize] <= weight[other as usize] { [set, other] } else { [other, set] };
        // A rim makes no curved patch of a plane.
        let rim = weight[light_one as usize] <= RIM * weight[heavy_one as usize];
        let bent = curved[light_one as usize] || curved[heavy_one as usize] || far(set, other);
        let is_curved = if rim { curved[heavy_one as usize] } else { bent };
        let joined = sets.join(set, other);
        let gone = if joined == set { other } else { set };
        curved[joined as usize] = is_curved;
        let moved = std::mem::take(&mut members[gone as usize]);
        members[joined as usize].extend(moved);
        weight[joined as usize] += weight[gone as usize];
        if weight[joined as usize] < least(curved[joined as usize]) {
            light.push(Reverse((weight[joined as usize].to_bits(), joined)));
        }
    }
}
