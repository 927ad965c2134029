//! Per-component counts: does every connected part of the surface get its share of the points?

use crate::mesh::SurfaceMesh;
use crate::sample::SurfacePoint;

/// One connected component.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ComponentShare {
    /// How many points it holds.
    pub points: usize,
    /// How many it should hold: all points times its share of the area.
    pub expected: f64,
}

/// The components in the order of [`Components`](crate::Components).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ComponentReport {
    /// Each component.
    pub components: Vec<ComponentShare>,
    /// The largest |points - expected|, in points. Below 1 is possible for all components at once (largest
    /// remainder).
    pub worst: f64,
}

/// Counts the points of each connected component. Linear time.
pub fn components(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> ComponentReport {
    let components = mesh.topology().components();
    let mut shares = vec![ComponentShare { points: 0, expected: 0.0 }; components.count];
    for (&component, area) in components.of_face.iter().zip(mesh.face_areas()) {
        shares[component as usize].expected += area;
    }
    for share in &mut shares {
        share.expected *= points.len() as f64 / mesh.area();
    }
    for point in points {
        shares[components.of_face[point.face.index()] as usize].points += 1;
    }
    let worst = shares.iter().map(|s| (s.points as f64 - s.expected).abs()).fold(0.0, f64::max);
    ComponentReport { components: shares, worst }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::ids::FaceId;
    use crate::measure::testmesh;

    #[test]
    fn two_triangles_by_hand() {
        let corner =
            |x: f64, side: f64| [DVec3::X * x, DVec3::new(x + side, 0.0, 0.0), DVec3::new(x, side, 0.0)];
        // Areas 1/2 and 2: one and four fifths.
        let positions = [corner(0.0, 1.0), corner(5.0, 2.0)].concat();
        let mesh = testmesh::mesh(&positions, &[[0, 1, 2], [3, 4, 5]]);
        let point = |face| SurfacePoint { face: FaceId(face), barycentric: [1.0, 0.0, 0.0] };
        let report = components(&mesh, &[point(0), point(1), point(0), point(1)]);
        let counts: Vec<usize> = report.components.iter().map(|c| c.points).collect();
        assert_eq!(counts, [2, 2]);
        assert!((report.components[0].expected - 0.8).abs() < 1e-15);
        assert!((report.components[1].expected - 3.2).abs() < 1e-15);
        assert!((report.worst - 1.2).abs() < 1e-15);
    }
}
