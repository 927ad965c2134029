//! Faces in a row, each as long as its area: from a share of the area to a face, and from the unit square to a
//! triangle.

use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;

/// The faces in some order with the running sum of their areas.
#[derive(Clone, Debug)]
pub(crate) struct AreaRow {
    faces: Vec<FaceId>,
    /// Where each face ends; the last entry is the total.
    ends: Vec<f64>,
}

impl AreaRow {
    /// Lays the faces in this order. The order must name every face once.
    pub(crate) fn new(mesh: &SurfaceMesh, faces: Vec<FaceId>) -> Self {
        Self::by_mass(mesh.face_areas(), faces)
    }

    /// The same, each face as long as its mass.
    pub(crate) fn by_mass(masses: &[f64], faces: Vec<FaceId>) -> Self {
        let mut sum = 0.0;
        let ends = faces
            .iter()
            .map(|&face| {
                sum += masses[face.index()];
                sum
            })
            .collect();
        Self { faces, ends }
    }

    /// The face at `share` (0 to 1) of the way along the row, and how far inside it that is, 0 to 1.
    /// `None` without faces.
    pub(crate) fn at(&self, share: f64) -> Option<(FaceId, f64)> {
        let target = share * self.ends.last()?;
        let slot = self.ends.partition_point(|&end| end <= target).min(self.faces.len() - 1);
        let start = if slot == 0 { 0.0 } else { self.ends[slot - 1] };
        let inside = ((target - start) / (self.ends[slot] - start)).clamp(0.0, 1.0);
        Some((self.faces[slot], inside))
    }
}

/// The barycentric coordinates of a point of the unit square mapped to a triangle so that areas keep their share:
/// the square root map, which sends the side `u = 0` to the first corner.
#[inline]
pub(crate) fn square_to_triangle(u: f64, v: f64) -> [f64; 3] {
    let root = u.sqrt();
    [1.0 - root, root * (1.0 - v), root * v]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_keeps_areas() {
        // Of the square [0, a) x [0, b) the image is a triangle with share a b of the area.
        let area = |p: [f64; 3], q: [f64; 3], r: [f64; 3]| {
            let d = |s: [f64; 3]| [s[1] - p[1], s[2] - p[2]];
            let (q, r) = (d(q), d(r));
            (q[0] * r[1] - q[1] * r[0]).abs()
        };
        for (a, b) in [(1.0, 1.0), (0.25, 1.0), (0.3, 0.7), (0.9, 0.1)] {
            let image =
                area(square_to_triangle(0.0, 0.0), square_to_triangle(a, 0.0), square_to_triangle(a, b));
            assert!((image - a * b).abs() < 1e-15, "{a} {b}: {image}");
        }
    }
}
