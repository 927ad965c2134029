//! Weights of the surface: how many points a place is to get, relative to others.
//!
//! A density is linear over each face, so the mass of a face, its area times the mean of its corners, is exact.

use crate::ids::FaceId;
use crate::mesh::{PolygonSoup, SurfaceMesh};
use crate::sample::SurfacePoint;

/// How densely points are to lie, place by place: the same everywhere, or linear over each face of one mesh.
///
/// Only the proportions of weights matter. They are scaled so that the mass of the whole surface is its area, so the
/// density is 1 on average and sqrt(A / n) stays the mean distance d_m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Density {
    /// For each face the density at its corners; `None` where it is 1 everywhere.
    corners: Option<Vec<[f64; 3]>>,
}

/// Weights that are no density of the mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DensityError {
    /// There is not one weight for each element.
    #[error("{found} weights for {expected} {elements}: there must be one for each")]
    Length {
        /// How many weights there are.
        found: usize,
        /// How many elements there are.
        expected: usize,
        /// What they are.
        elements: &'static str,
    },
    /// A weight is not a finite number from 0 up.
    #[error("weight {value} of {element} {index} is not a finite number from 0 up")]
    Weight {
        /// The weight.
        value: f64,
        /// What it belongs to.
        element: &'static str,
        /// Which of them, from 0.
        index: usize,
    },
    /// A connected component is to get points, but has no weight.
    #[error("connected component {component} is to get points, but has no weight")]
    NoWeight {
        /// Which, from 0.
        component: usize,
    },
    /// No place would get points.
    #[error("all weights of the surface are zero: no place would get points")]
    Zero,
}

impl Density {
    /// The same everywhere.
    pub const UNIFORM: Self = Self { corners: None };

    /// A weight for each face of the mesh, constant on it. Linear time.
    ///
    /// # Errors
    /// [`DensityError`] when there is not one finite weight from 0 up for each face, or all are zero.
    pub fn of_faces(mesh: &SurfaceMesh, weights: &[f64]) -> Result<Self, DensityError> {
        check(weights, mesh.face_count(), ["face", "faces"])?;
        Self::scaled(mesh, weights.iter().map(|&w| [w; 3]).collect())
    }

    /// A weight for each vertex of the mesh, linear between them. Linear time.
    ///
    /// # Errors
    /// [`DensityError`] when there is not one finite weight from 0 up for each vertex, or all that faces use are zero.
    pub fn of_vertices(mesh: &SurfaceMesh, weights: &[f64]) -> Result<Self, DensityError> {
        check(weights, mesh.vertex_count(), ["vertex", "vertices"])?;
        let corners = mesh.topology().faces().iter().map(|f| f.map(|v| weights[v.index()])).collect();
        Self::scaled(mesh, corners)
    }

    /// A weight for each polygon of the soup that the mesh was made from, constant on it. Linear time.
    ///
    /// # Errors
    /// As [`of_faces`](Self::of_faces).
    pub fn of_polygons(
        mesh: &SurfaceMesh,
        soup: &PolygonSoup,
        weights: &[f64],
    ) -> Result<Self, DensityError> {
        check(weights, soup.polygon_count(), ["polygon", "polygons"])?;
        Self::scaled(mesh, mesh.sources().iter().map(|s| [weights[s.polygon.index()]; 3]).collect())
    }

    /// A weight for each vertex of the soup that the mesh was made from, linear on each triangle. Vertices that the
    /// check welded keep their own weights, each on its own faces. Linear time.
    ///
    /// # Errors
    /// As [`of_vertices`](Self::of_vertices).
    pub fn of_positions(
        mesh: &SurfaceMesh,
        soup: &PolygonSoup,
        weights: &[f64],
    ) -> Result<Self, DensityError> {
        check(weights, soup.positions.len(), ["vertex", "vertices"])?;
        let weight = |place: u32| weights[soup.corners[place as usize] as usize];
        Self::scaled(mesh, mesh.sources().iter().map(|s| s.corners.map(weight)).collect())
    }

    /// A weight for each corner of each face of the mesh, linear between them; neighbours need not agree. Linear time.
    ///
    /// # Errors
    /// As [`of_faces`](Self::of_faces).
    pub fn of_corners(mesh: &SurfaceMesh, weights: &[[f64; 3]]) -> Result<Self, DensityError> {
        check(weights.as_flattened(), 3 * mesh.face_count(), ["corner", "corners"])?;
        Self::scaled(mesh, weights.to_vec())
    }

    fn scaled(mesh: &SurfaceMesh, mut corners: Vec<[f64; 3]>) -> Result<Self, DensityError> {
        let largest = corners.iter().flatten().fold(0.0_f64, |m, &w| m.max(w));
        if largest == 0.0 {
            return Err(DensityError::Zero);
        }
        // First to at most 1, so that no sum overflows; a quotient, because the reciprocal may overflow.
        for weight in corners.iter_mut().flatten() {
            *weight /= largest;
        }
        let mass: f64 = mesh.face_areas().iter().zip(&corners).map(|(a, c)| a * mean(c)).sum();
        let scale = mesh.area() / mass;
        if !scale.is_finite() {
            return Err(DensityError::Zero);
        }
        for weight in corners.iter_mut().flatten() {
            *weight *= scale;
        }
        Ok(Self { corners: Some(corners) })
    }

    /// Whether it is the same everywhere because no weights were given.
    pub fn is_uniform(&self) -> bool {
        self.corners.is_none()
    }

    /// The density at the corners of a face of its mesh; linear between them.
    ///
    /// # Panics
    /// If the density was made for a mesh with fewer faces.
    #[inline]
    pub fn corners(&self, face: FaceId) -> [f64; 3] {
        self.corners.as_ref().map_or([1.0; 3], |corners| corners[face.index()])
    }

    /// The density at a point of its mesh.
    ///
    /// # Panics
    /// As [`corners`](Self::corners).
    #[inline]
    pub fn at(&self, point: &SurfacePoint) -> f64 {
        let ([a, b, c], [u, v, w]) = (self.corners(point.face), point.barycentric);
        a * u + b * v + c * w
    }

    /// The integral of the density over a face: its area where the density is uniform. The masses of all faces add up
    /// to the area of the mesh.
    ///
    /// # Panics
    /// As [`corners`](Self::corners).
    #[inline]
    pub fn face_mass(&self, mesh: &SurfaceMesh, face: FaceId) -> f64 {
        let area = mesh.face_area(face);
        self.corners.as_ref().map_or(area, |corners| area * mean(&corners[face.index()]))
    }

    /// The masses of all faces.
    pub fn face_masses(&self, mesh: &SurfaceMesh) -> Vec<f64> {
        mesh.topology().face_ids().map(|face| self.face_mass(mesh, face)).collect()
    }

    /// The largest density anywhere.
    pub fn largest(&self) -> f64 {
        self.corners.as_ref().map_or(1.0, |corners| corners.iter().flatten().fold(0.0, |m, &w| m.max(w)))
    }
}

fn mean(corners: &[f64; 3]) -> f64 {
    (corners[0] + corners[1] + corners[2]) / 3.0
}

/// Checks number and range of weights; `names` are those of one element and of several.
fn check(
    weights: &[f64],
    expected: usize,
    [element, elements]: [&'static str; 2],
) -> Result<(), DensityError> {
    if weights.len() != expected {
        return Err(DensityError::Length { found: weights.len(), expected, elements });
    }
    match weights.iter().position(|w| !(w.is_finite() && *w >= 0.0)) {
        Some(index) => Err(DensityError::Weight { value: weights[index], element, index }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::planted;
    use crate::shapes::Shape;

    /// The unit square: two triangles, the first with the corners 0 1 2, the second 0 2 3.
    fn square() -> (PolygonSoup, SurfaceMesh) {
        let mut soup = PolygonSoup {
            positions: [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
                .map(|(x, y)| DVec3::new(x, y, 0.0))
                .to_vec(),
            ..PolygonSoup::default()
        };
        soup.push_polygon(&[0, 1, 2]);
        soup.push_polygon(&[0, 2, 3]);
        let mesh = planted::mesh(&soup);
        (soup, mesh)
    }

    #[test]
    fn uniform_is_one() {
        let (_, mesh) = square();
        let density = Density::UNIFORM;
        assert!(density.is_uniform() && density == Density::default());
        assert_eq!(density.face_masses(&mesh), mesh.face_areas());
        assert_eq!(density.at(&SurfacePoint { face: FaceId(1), barycentric: [0.5, 0.25, 0.25] }), 1.0);
        assert_eq!(density.largest(), 1.0);
    }

    #[test]
    fn faces_by_hand() {
        let (soup, mesh) = square();
        // Masses 1 : 3 of an area of 1.
        let density = Density::of_faces(&mesh, &[2.0, 6.0]).unwrap();
        assert_eq!(density.face_masses(&mesh), [0.25, 0.75]);
        assert_eq!(density.corners(FaceId(0)), [0.5; 3]);
        assert_eq!(density.largest(), 1.5);
        assert_eq!(Density::of_polygons(&mesh, &soup, &[1.0, 3.0]), Ok(density));
    }

    #[test]
    fn vertices_by_hand() {
        let (soup, mesh) = square();
        // Means 2 and 4 thirds of 3: the whole weighs 1, so nothing is scaled but by 1.
        let density = Density::of_vertices(&mesh, &[0.0, 0.0, 2.0, 2.0]).unwrap();
        let masses = density.face_masses(&mesh);
        assert!((masses[0] - 1.0 / 3.0).abs() < 1e-15 && (masses[1] - 2.0 / 3.0).abs() < 1e-15);
        let middle = SurfacePoint { face: FaceId(1), barycentric: [0.5, 0.25, 0.25] };
        assert!((density.at(&middle) - 1.0).abs() < 1e-15);
        assert_eq!(Density::of_positions(&mesh, &soup, &[0.0, 0.0, 2.0, 2.0]), Ok(density));
    }

    #[test]
    fn corners_by_hand() {
        let (_, mesh) = square();
        // Corners 0 and 2 lie on both triangles and need not agree: means 1 and 3 of areas of a half, so all is halved.
        let density = Density::of_corners(&mesh, &[[0.0, 3.0, 0.0], [6.0, 0.0, 3.0]]).unwrap();
        assert_eq!(density.face_masses(&mesh), [0.25, 0.75]);
        assert_eq!(density.corners(FaceId(0)), [0.0, 1.5, 0.0]);
        assert_eq!(density.at(&SurfacePoint { face: FaceId(1), barycentric: [0.5, 0.25, 0.25] }), 1.875);
        // At the same place from the other side.
        assert_eq!(density.at(&SurfacePoint { face: FaceId(0), barycentric: [0.5, 0.0, 0.5] }), 0.0);
        assert_eq!(density.at(&SurfacePoint { face: FaceId(1), barycentric: [0.5, 0.5, 0.0] }), 1.5);
        assert_eq!(density.largest(), 3.0);
        let length = DensityError::Length { found: 3, expected: 6, elements: "corners" };
        assert_eq!(Density::of_corners(&mesh, &[[1.0; 3]]), Err(length));
        let refused = Density::of_corners(&mesh, &[[1.0; 3], [1.0, -1.0, 1.0]]).unwrap_err();
        assert!(matches!(refused, DensityError::Weight { element: "corner", index: 4, .. }), "{refused}");
    }

    #[test]
    fn polygons_cut_into_triangles_keep_their_weight() {
        let mut soup = PolygonSoup {
            positions: [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (2.0, 0.0)]
                .map(|(x, y)| DVec3::new(x, y, 0.0))
                .to_vec(),
            ..PolygonSoup::default()
        };
        soup.push_polygon(&[0, 1, 2, 3]);
        soup.push_polygon(&[1, 4, 2]);
        let mesh = planted::mesh(&soup);
        let density = Density::of_polygons(&mesh, &soup, &[0.0, 5.0]).unwrap();
        assert_eq!(density.face_masses(&mesh), [0.0, 0.0, 1.5]);
    }

    #[test]
    fn what_is_no_density_is_refused() {
        let (_, mesh) = square();
        let length = DensityError::Length { found: 1, expected: 2, elements: "faces" };
        assert_eq!(Density::of_faces(&mesh, &[1.0]), Err(length));
        let length = DensityError::Length { found: 2, expected: 4, elements: "vertices" };
        assert_eq!(Density::of_vertices(&mesh, &[1.0, 1.0]), Err(length));
        for value in [-1.0, f64::INFINITY, f64::NAN] {
            let refused = Density::of_faces(&mesh, &[1.0, value]).unwrap_err();
            assert!(matches!(refused, DensityError::Weight { element: "face", index: 1, .. }), "{refused}");
        }
        assert_eq!(Density::of_faces(&mesh, &[0.0, 0.0]), Err(DensityError::Zero));
    }

    #[test]
    fn extreme_weights_do_not_overflow() {
        let (_, mesh) = square();
        for w in [1e-320, 1e-300, 1e300, f64::MAX] {
            let masses = Density::of_faces(&mesh, &[w, w]).unwrap().face_masses(&mesh);
            assert!(masses.iter().all(|m| (m - 0.5).abs() < 1e-12), "{w}: {masses:?}");
        }
    }

    proptest! {
        #[test]
        fn masses_add_up_to_the_area(weights in prop::collection::vec(0.0..10.0, 4)) {
            let mesh = planted::mesh(&Shape::Tetrahedron.generate());
            prop_assume!(weights.iter().any(|w| *w > 1e-3));
            let mass: f64 = Density::of_vertices(&mesh, &weights).unwrap().face_masses(&mesh).iter().sum();
            prop_assert!((mass / mesh.area() - 1.0).abs() < 1e-12);
        }
    }
}
