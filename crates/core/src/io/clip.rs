//! The part of a model that lies in a box.

use glam::DVec3;

use crate::attributes::Piece;
use crate::io::read::Model;
use crate::mesh::{PolygonSoup, SurfaceMesh};

/// Why a box cuts no model.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClipError {
    /// It has no inside.
    #[error("the box from {low} to {high} is none: give the smaller coordinates first")]
    NoBox {
        /// Its first corner.
        low: DVec3,
        /// Its second corner.
        high: DVec3,
    },
    /// No face reaches into it.
    #[error("no face lies in the box: the mesh reaches from {low} to {high}")]
    Outside {
        /// The smallest coordinates of the mesh.
        low: DVec3,
        /// The largest.
        high: DVec3,
    },
}

impl Model {
    /// Keeps what lies in the box between two corners, such as those of [`SurfaceMesh::bounds`]; its sides belong to it,
    /// and coordinates may be infinite. Faces that its sides cut are cut exactly there: what is left has the area inside,
    /// and at every place the normal, texture coordinates, colours and numbers that the whole model has there (smooth
    /// normals are those of the whole, also where the file has none).
    ///
    /// `mesh` must have been made from this model. The result is to be checked again, with
    /// [`turn_outward`](crate::CheckOptions::turn_outward) off: what was turned stays turned, and no winding can be told of
    /// a part. Each face gives one polygon; [`MeshAttributes::kept`](crate::attributes::MeshAttributes::kept) tells the
    /// numbers of the polygons in the file. Linear time.
    ///
    /// # Errors
    /// [`ClipError`]: the model is then unchanged.
    ///
    /// # Panics
    /// If the mesh was made from a model with more polygons or corners.
    pub fn clip(&mut self, mesh: &SurfaceMesh, (low, high): (DVec3, DVec3)) -> Result<(), ClipError> {
        if !(low.cmple(high)).all() {
            return Err(ClipError::NoBox { low, high });
        }
        let mut soup = PolygonSoup { positions: mesh.positions().to_vec(), ..PolygonSoup::default() };
        let mut pieces = Vec::new();
        let mut corners = Vec::new();
        for face in mesh.topology().face_ids() {
            let vertices = mesh.topology().corners(face);
            let triangle = mesh.triangle(face);
            corners.clear();
            if triangle.iter().all(|p| p.cmpge(low).all() && p.cmple(high).all()) {
                corners.extend(vertices.map(|v| v.0));
                pieces.push(Piece { face, corners: UNIT.to_vec() });
            } else {
                let inside = inside(triangle, low, high);
                if inside.len() < 3 {
                    continue;
                }
                corners.extend(inside.iter().map(|corner| {
                    soup.positions.push(corner.place);
                    (soup.positions.len() - 1) as u32
                }));
                pieces
                    .push(Piece { face, corners: inside.iter().map(|corner| corner.barycentric).collect() });
            }
            soup.push_polygon(&corners);
        }
        if pieces.is_empty() {
            let (low, high) = mesh.bounds();
            return Err(ClipError::Outside { low, high });
        }
        self.attributes.cut(mesh, &pieces);
        self.soup = soup;
        Ok(())
    }
}

/// The corners of a triangle in its barycentric coordinates.
const UNIT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

#[derive(Clone, Copy)]
struct Corner {
    place: DVec3,
    barycentric: [f64; 3],
}

/// What a box leaves of a triangle: side by side (Sutherland and Hodgman 1974, doi:10.1145/360767.360802). Neighbours
/// are cut at the same places to the bit, because those depend on their common edge alone.
fn inside(triangle: [DVec3; 3], low: DVec3, high: DVec3) -> Vec<Corner> {
    let mut corners: Vec<Corner> =
        triangle.into_iter().zip(UNIT).map(|(place, barycentric)| Corner { place, barycentric }).collect();
    let sides = (0..3).flat_map(|axis| [(axis, low[axis], 1.0), (axis, high[axis], -1.0)]);
    for (axis, at, sign) in sides {
        // Above zero inside.
        let height = |corner: &Corner| sign * (corner.place[axis] - at);
        let mut left = Vec::with_capacity(corners.len() + 1);
        for (i, corner) in corners.iter().enumerate() {
            let next = &corners[(i + 1) % corners.len()];
            if height(corner) >= 0.0 {
                left.push(*corner);
            }
            if (height(corner) > 0.0 && height(next) < 0.0) || (height(corner) < 0.0 && height(next) > 0.0) {
                let (inner, outer) = if height(corner) > 0.0 { (corner, next) } else { (next, corner) };
                let share = height(inner) / (height(inner) - height(outer));
                let mut place = inner.place + (outer.place - inner.place) * share;
                place[axis] = at;
                let [a, b, c] = [0, 1, 2]
                    .map(|k| inner.barycentric[k] + (outer.barycentric[k] - inner.barycentric[k]) * share);
                left.push(Corner { place, barycentric: [a, b, c] });
            }
        }
        corners = left;
    }
    corners
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::attributes::{CornerValues, Places};
    use crate::mesh::shapes::{self, Shape};
    use crate::mesh::{CheckOptions, SurfaceMesh};
    use crate::sample::SurfacePoint;
    use crate::spatial::nearest;

    fn checked(soup: &PolygonSoup, turn_outward: bool) -> SurfaceMesh {
        SurfaceMesh::from_soup(soup, &CheckOptions { turn_outward }).expect("a surface").0
    }

    fn clipped(soup: PolygonSoup, low: DVec3, high: DVec3) -> Result<SurfaceMesh, ClipError> {
        let mesh = checked(&soup, true);
        let mut model = Model::from(soup);
        model.clip(&mesh, (low, high))?;
        Ok(checked(&model.soup, false))
    }

    #[test]
    fn a_corner_of_a_cube_by_hand() {
        // The box holds the far corner of the unit cube with sides of 0.3, 0.4 and 0.5.
        let low = DVec3::new(0.7, 0.6, 0.5);
        let corner = clipped(shapes::cube(1), low, DVec3::splat(9.0)).unwrap();
        assert!((corner.area() - (0.3 * 0.4 + 0.4 * 0.5 + 0.5 * 0.3)).abs() < 1e-15, "{}", corner.area());
        assert_eq!(corner.bounds(), (low, DVec3::ONE));
        // Faces that were neighbours still are: the border is the rim alone, once around.
        assert_eq!(corner.topology().components().count, 1);
        let border: f64 = (0..3 * corner.face_count() as u32)
            .map(crate::HalfedgeId)
            .filter(|&h| corner.topology().twin(h).is_none())
            .map(|h| corner.edge_length(h))
            .sum();
        assert!((border - 2.0 * (0.3 + 0.4 + 0.5)).abs() < 1e-12, "{border}");
    }

    #[test]
    fn sides_belong_to_the_box_and_infinite_ones_cut_nothing() {
        let cube = checked(&shapes::cube(2), true);
        let (low, high) = cube.bounds();
        assert_eq!(clipped(shapes::cube(2), low, high).unwrap(), cube);
        let upper = clipped(shapes::cube(2), DVec3::NEG_INFINITY.with_z(1.0), DVec3::INFINITY).unwrap();
        assert_eq!((upper.area(), upper.bounds().0.z), (1.0, 1.0));
        let error = clipped(shapes::cube(2), DVec3::splat(2.0), DVec3::splat(3.0)).unwrap_err();
        assert_eq!(error, ClipError::Outside { low, high });
        for (from, to) in [(DVec3::ONE, DVec3::ZERO), (DVec3::NAN, DVec3::ONE)] {
            let error = clipped(shapes::cube(2), from, to).unwrap_err();
            assert!(error.to_string().contains("the smaller coordinates first"), "{error}");
        }
    }

    #[test]
    fn what_is_left_keeps_what_it_had() {
        let soup = Shape::Sphere.generate();
        // Wound inward: the check turns it, and the cut part must stay turned.
        let mut inward = PolygonSoup { positions: soup.positions.clone(), ..PolygonSoup::default() };
        for polygon in 0..soup.polygon_count() {
            inward.push_polygon(&soup.polygon(polygon).iter().rev().copied().collect::<Vec<_>>());
        }
        let whole = checked(&inward, true);
        let linear = |p: DVec3| 3.0 * p.x - 2.0 * p.y + p.z;
        let numbers = inward.positions.iter().map(|&p| linear(p)).collect();
        let mut model = Model::from(inward);
        let heat = CornerValues::by_vertex(numbers, &model.soup.corners);
        model.attributes.numbers.push(("heat".into(), heat));
        let names = &mut model.attributes.parts;
        for polygon in 0..model.soup.polygon_count() {
            let index = names.index_of(&format!("part {}", polygon % 7));
            names.set(polygon..polygon + 1, Some(index));
        }
        let before = model.attributes.clone();
        model.clip(&whole, (DVec3::splat(-0.31), DVec3::new(0.7, 0.83, 0.2))).unwrap();
        let part = checked(&model.soup, false);
        let (old, new) = (Places::new(&whole, &before), Places::new(&part, &model.attributes));
        for face in part.topology().face_ids() {
            let point = SurfacePoint { face, barycentric: [0.5, 0.2, 0.3] };
            let place = part.locate(&point);
            let found = nearest(&whole, &[place])[0];
            assert!(found.distance < 1e-12);
            assert!(part.face_normal(face).dot(whole.face_normal(found.point.face)) > 1.0 - 1e-9);
            assert!(new.normal(&part, &point).distance(old.normal(&whole, &found.point)) < 1e-9);
            let heat = new.number(&part, &point, 0).expect("heat");
            assert!((heat - linear(place)).abs() < 1e-12, "{heat}");
            let polygon = model.attributes.polygon_number(part.sources()[face.index()].polygon);
            assert_eq!(polygon, whole.sources()[found.point.face.index()].polygon.0);
            assert_eq!(new.part(&part, face), old.part(&whole, found.point.face));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// Boxes side by side share a surface out without a rest.
        #[test]
        fn halves_add_up(at in -0.9..0.9f64, axis in 0..3usize, shape in 0..3usize) {
            let soup = [Shape::Sphere, Shape::Torus, Shape::Cup][shape].generate();
            let whole = checked(&soup, true);
            let (low, high) = whole.bounds();
            let middle = (low + high) * 0.5 + (high - low) * 0.5 * at;
            let (mut below, mut above) = (high, low);
            below[axis] = middle[axis];
            above[axis] = middle[axis];
            let areas = [clipped(soup.clone(), low, below), clipped(soup, above, high)]
                .map(|half| half.map_or(0.0, |half| half.area()));
            prop_assert!(((areas[0] + areas[1]) / whole.area() - 1.0).abs() < 1e-9, "{areas:?}");
        }
    }
}
