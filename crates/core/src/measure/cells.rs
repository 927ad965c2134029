//! Cells: the area that each point stands for.

use crate::geometry::triangle;
use crate::measure::halving::halve;
use crate::measure::tree::Tree;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::SurfacePoint;
use glam::DVec3;

/// A piece of the surface is not larger than this part of a point's mean area.
const PIECE: f64 = 1.0 / 64.0;

/// A unit of normal counts as this many d_m, as in equalizing: the two sides of a thin sheet are apart.
const BEND: f64 = 0.4;

/// Faces a task takes at a time.
const CHUNK: usize = 64;

/// For each point the area of the surface that lies nearer to it than to the others, in squared units of the mesh.
/// The areas add up to that of the mesh. Nearness is that of equalizing: in space and in the directions of the normals.
///
/// The surface is halved into pieces of at most a 64th of the mean area, and each piece given as a whole to the
/// point nearest to its middle, which is off by a few percent for a single cell. O((F + 64 n) log n).
pub fn cell_areas(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> Vec<f64> {
    if points.is_empty() {
        return Vec::new();
    }
    let d_m = libm::sqrt(mesh.area() / points.len() as f64);
    let bend = BEND * d_m;
    let places: Vec<DVec3> = points.iter().map(|p| mesh.locate(p)).collect();
    let normals: Vec<DVec3> = points.iter().map(|p| mesh.face_normal(p.face) * bend).collect();
    let tree = Tree::of_points(&places);
    let largest = PIECE * d_m * d_m;
    let found = parallel::map_chunks(mesh.face_count(), CHUNK, |faces| {
        let mut found: Vec<(usize, f64)> = Vec::new();
        let mut stack = Vec::new();
        for face in faces.map(crate::ids::FaceId::new) {
            let normal = mesh.face_normal(face) * bend;
            // Halving halves the area exactly, so the pieces need not be measured.
            stack.push((mesh.triangle(face), mesh.face_area(face)));
            while let Some((piece, area)) = stack.pop() {
                if area > largest {
                    let (_, halves) = halve(piece);
                    stack.extend(halves.map(|half| (half, 0.5 * area)));
                    continue;
                }
                let [a, b, c] = piece;
                let middle = triangle::at(a, b, c, [1.0 / 3.0; 3]);
                let distance =
                    |i: usize| places[i].distance_squared(middle) + normals[i].distance_squared(normal);
                if let Some((nearest, _)) = tree.nearest(middle, distance, |_| false) {
                    match found.last_mut() {
                        Some((last, sum)) if *last == nearest => *sum += area,
                        _ => found.push((nearest, area)),
                    }
                }
            }
        }
        found
    });
    let mut areas = vec![0.0; points.len()];
    for (point, area) in found.into_iter().flatten() {
        areas[point] += area;
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::FaceId;
    use crate::mesh::{CheckOptions, PolygonSoup};

    /// A sheet of 2 x 1 with two sides that are `gap` apart.
    fn sheet(gap: f64) -> SurfaceMesh {
        let mut soup = PolygonSoup::default();
        for z in [0.0, gap] {
            soup.positions.extend([[0., 0.], [2., 0.], [2., 1.], [0., 1.]].map(|[x, y]| DVec3::new(x, y, z)));
        }
        soup.push_polygon(&[0, 3, 2, 1]);
        soup.push_polygon(&[4, 5, 6, 7]);
        SurfaceMesh::from_soup(&soup, &CheckOptions::default()).expect("a sheet").0
    }

    #[test]
    fn cells_of_a_thin_sheet() {
        let mesh = sheet(1e-3);
        let places = [
            // The upper side is parted in the middle between its points, the lower in halves.
            DVec3::new(0.5, 0.5, 1e-3),
            DVec3::new(2.0, 0.5, 1e-3),
            DVec3::new(0.5, 0.5, 0.0),
            DVec3::new(1.5, 0.5, 0.0),
        ];
        let faces: Vec<FaceId> = mesh.topology().face_ids().collect();
        let points = places.map(|place| {
            let on = |face: &FaceId| {
                let [a, b, c] = mesh.triangle(*face);
                let barycentric = triangle::nearest(a, b, c, place);
                (triangle::at(a, b, c, barycentric).distance(place) < 1e-12).then_some(barycentric)
            };
            let (face, barycentric) =
                faces.iter().find_map(|f| on(f).map(|b| (*f, b))).expect("a face holds the place");
            SurfacePoint { face, barycentric }
        });
        let areas = cell_areas(&mesh, &points);
        assert!((areas.iter().sum::<f64>() - 4.0).abs() < 1e-12);
        for (area, expected) in areas.iter().zip([1.25, 0.75, 1.0, 1.0]) {
            assert!((area - expected).abs() < 0.06, "{areas:?}");
        }
    }
}
