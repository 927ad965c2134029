//! Patches: components get a whole number of points each, so that their shares come out right.

use std::num::NonZero;

use glam::DVec3;

use super::tiles::cell_key;
use crate::density::Density;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;

/// Which patch each face belongs to and how many points each patch gets.
pub(super) struct Patches {
    /// For each face one more than its patch, where there are several.
    of_face: Option<Vec<Option<NonZero<u32>>>>,
    /// At least 1 for every patch.
    pub(super) counts: Vec<usize>,
}

impl Patches {
    /// Shares out `n` points by mass: every run of components along a Morton curve gets its share to within one, so that
    /// neighbours share the rounding.
    pub(super) fn new(mesh: &SurfaceMesh, density: &Density, n: usize) -> Self {
        let components = mesh.topology().components();
        if components.count == 1 {
            return Self { of_face: None, counts: vec![n] };
        }
        let mut moments = vec![(DVec3::ZERO, 0.0); components.count];
        let mut masses = vec![0.0; components.count];
        for face in mesh.topology().face_ids() {
            let component = components.of_face[face.index()] as usize;
            let [a, b, c] = mesh.triangle(face);
            let (moment, area) = &mut moments[component];
            *moment += (a + b + c) / 3.0 * mesh.face_area(face);
            *area += mesh.face_area(face);
            masses[component] += density.face_mass(mesh, face);
        }
        let (low, high) = mesh.bounds();
        let cell = (high - low).max_element() / 1024.0;
        let mut order: Vec<usize> = (0..components.count).collect();
        order.sort_by_cached_key(|&component| {
            let (moment, area) = moments[component];
            (cell_key(moment / area - low, cell.max(f64::MIN_POSITIVE)), component)
        });
        let total: f64 = masses.iter().sum();
        let mut counts = Vec::new();
        let mut number = vec![None; components.count];
        let (mut passed, mut given) = (0.0, 0);
        for (k, &component) in order.iter().enumerate() {
            passed += masses[component];
            let is_last = k + 1 == order.len();
            let due = if is_last { n } else { ((passed / total * n as f64).round() as usize).min(n) };
            if due > given {
                counts.push(due - given);
                number[component] = NonZero::new(counts.len() as u32);
                given = due;
            }
        }
        let of_face = components.of_face.iter().map(|&component| number[component as usize]).collect();
        Self { of_face: Some(of_face), counts }
    }

    /// The patch of a face; `None` for those of components whose share came out as no point.
    #[inline]
    pub(super) fn of(&self, face: FaceId) -> Option<u32> {
        match &self.of_face {
            None => Some(0),
            Some(of_face) => of_face[face.index()].map(|number| number.get() - 1),
        }
    }

    /// Whether all faces belong to the same.
    pub(super) fn is_one(&self) -> bool {
        self.of_face.is_none()
    }
}
