//! Finer faces on the same surface, for weights that vary inside faces, as those of a texture do.
//!
//! A [`Density`] is linear over each face: a square of two triangles under a picture would know its four corners alone.
//! Cut into faces as small as texels, it knows them all. The points are then those of the fine mesh; [`Refined::lift`] tells
//! where they are on the coarse one, with all that belongs to its faces.

use glam::DVec2;

use crate::density::{Density, DensityError};
use crate::geometry::triangle;
use crate::ids::{FaceId, VertexId};
use crate::mesh::{SurfaceMesh, Topology};
use crate::parallel;
use crate::sample::SurfacePoint;

/// A part of a face: its corners in barycentric coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    face: FaceId,
    corners: [[f64; 3]; 3],
}

impl Part {
    /// The whole face.
    fn whole(face: FaceId) -> Self {
        Self { face, corners: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }

    fn at(&self, [u, v, w]: [f64; 3]) -> SurfacePoint {
        let [a, b, c] = self.corners;
        let barycentric = [0, 1, 2].map(|k| a[k] * u + b[k] * v + c[k] * w);
        SurfacePoint { face: self.face, barycentric }
    }
}

/// A mesh whose faces are parts of the faces of another.
#[derive(Clone, Debug)]
pub struct Refined {
    mesh: SurfaceMesh,
    parts: Vec<Part>,
    longest: f64,
}

/// Cuts faces until no edge is longer than `longest`, measured where `lay` says the corners of a face lie (for textures, in
/// texels: [`Places::texels`](crate::attributes::Places::texels)); faces that lie nowhere are only cut where their neighbours
/// are, so that the mesh stays whole. The longest edges are halved first, and no more once there would be more than `most`
/// faces. The area, the components and the borders stay. O(F log F) for F fine faces.
pub fn refine(
    mesh: &SurfaceMesh,
    lay: impl Fn(FaceId) -> Option<[DVec2; 3]>,
    longest: f64,
    most: usize,
) -> Refined {
    let charts: Vec<Option<[DVec2; 3]>> = mesh.topology().face_ids().map(lay).collect();
    let mut cutting = Cutting {
        charts,
        positions: mesh.positions().to_vec(),
        faces: mesh.topology().faces().to_vec(),
        parts: mesh.topology().face_ids().map(Part::whole).collect(),
    };
    let mut reached = cutting.longest();
    while reached > longest {
        let next = (0.5 * reached).max(longest);
        // Halves of the edges at hand may be longer still, as may the new edges inside faces.
        while cutting.longest() > next {
            if !cutting.halve(next, most) {
                return cutting.finish(mesh, reached);
            }
        }
        reached = next;
    }
    cutting.finish(mesh, reached)
}

struct Cutting {
    /// Where the corners of each coarse face lie.
    charts: Vec<Option<[DVec2; 3]>>,
    positions: Vec<glam::DVec3>,
    faces: Vec<[VertexId; 3]>,
    parts: Vec<Part>,
}

impl Cutting {
    /// The lengths of the sides of a face, from each corner to the next; 0 where it lies nowhere.
    fn sides(&self, part: &Part) -> [f64; 3] {
        let Some([a, b, c]) = self.charts[part.face.index()] else { return [0.0; 3] };
        let corners = part.corners.map(|[u, v, w]| a * u + b * v + c * w);
        [0, 1, 2].map(|i| {
            let length = corners[i].distance(corners[(i + 1) % 3]);
            if length.is_finite() { length } else { 0.0 }
        })
    }

    fn longest(&self) -> f64 {
        self.parts.iter().flat_map(|part| self.sides(part)).fold(0.0, f64::max)
    }

    /// Halves the edges longer than this; false, and nothing done, if that would be too many faces or too small ones.
    fn halve(&mut self, longest: f64, most: usize) -> bool {
        let key = |face: &[VertexId; 3], i: usize| {
            let (a, b) = (face[i], face[(i + 1) % 3]);
            (a.min(b), a.max(b))
        };
        let mut halved: Vec<(VertexId, VertexId)> = Vec::new();
        for (face, part) in self.faces.iter().zip(&self.parts) {
            let sides = self.sides(part);
            halved.extend((0..3).filter(|&i| sides[i] > longest).map(|i| key(face, i)));
        }
        halved.sort_unstable();
        halved.dedup();
        if self.positions.len() + halved.len() > u32::MAX as usize / 3 {
            return false;
        }
        let first = self.positions.len();
        let mut positions = self.positions.clone();
        positions.extend(
            halved.iter().map(|&(a, b)| self.positions[a.index()] * 0.5 + self.positions[b.index()] * 0.5),
        );
        let (mut faces, mut parts) = (Vec::new(), Vec::new());
        for (face, part) in self.faces.iter().zip(&self.parts) {
            let middles = [0, 1, 2]
                .map(|i| halved.binary_search(&key(face, i)).ok().map(|found| VertexId::new(first + found)));
            let corner = |vertex: VertexId, at: [f64; 3]| (vertex, at);
            let corners = [0, 1, 2].map(|i| corner(face[i], part.corners[i]));
            let middle = |i: usize| {
                let (p, q) = (part.corners[i], part.corners[(i + 1) % 3]);
                middles[i].map(|vertex| corner(vertex, [0, 1, 2].map(|k| 0.5 * (p[k] + q[k]))))
            };
            let before = faces.len();
            for triangle in cut(corners, [middle(0), middle(1), middle(2)]) {
                faces.push(triangle.map(|(vertex, _)| vertex));
                parts.push(Part { face: part.face, corners: triangle.map(|(_, at)| at) });
            }
            let area = |face: &[VertexId; 3]| {
                let [a, b, c] = face.map(|v| positions[v.index()]);
                triangle::area(a, b, c)
            };
            // Parts are a quarter at least; rounding makes less of the thinnest needles.
            let whole = area(face);
            if faces.len() > most
                || (faces.len() > before + 1 && faces[before..].iter().any(|f| area(f) < 0.2 * whole))
            {
                return false;
            }
        }
        (self.positions, self.faces, self.parts) = (positions, faces, parts);
        true
    }

    fn finish(self, coarse: &SurfaceMesh, longest: f64) -> Refined {
        let sources = self.parts.iter().map(|part| coarse.sources()[part.face.index()]).collect();
        let (topology, _) = Topology::new(self.positions.len(), self.faces);
        Refined { mesh: SurfaceMesh::assemble(self.positions, topology, sources), parts: self.parts, longest }
    }
}

/// A corner and where it lies in the coarse face.
type Corner = (VertexId, [f64; 3]);

/// A triangle cut at the middles of some of its sides.
fn cut([a, b, c]: [Corner; 3], middles: [Option<Corner>; 3]) -> Vec<[Corner; 3]> {
    match middles {
        [None, None, None] => vec![[a, b, c]],
        [Some(p), Some(q), Some(r)] => vec![[a, p, r], [p, b, q], [r, q, c], [p, q, r]],
        [Some(p), None, None] => vec![[a, p, c], [p, b, c]],
        [Some(p), Some(q), None] => vec![[p, b, q], [a, p, q], [a, q, c]],
        // The others by turning.
        [None, q, r] => cut([b, c, a], [q, r, None]),
        [p, None, r] => cut([c, a, b], [r, p, None]),
    }
}

impl Refined {
    /// The fine mesh. Its faces name the polygons they came from; what else the file has at them is had through
    /// [`lift`](Self::lift).
    pub fn mesh(&self) -> &SurfaceMesh {
        &self.mesh
    }

    /// The place on the coarse mesh of a point of the fine one.
    pub fn lift(&self, point: &SurfacePoint) -> SurfacePoint {
        self.parts[point.face.index()].at(point.barycentric)
    }

    /// The density on the fine mesh of weights that vary inside coarse faces: on faces that were cut the mean, over places
    /// about one unit of the chart apart; on others linear between the corners. `weight` gets points of the coarse mesh.
    ///
    /// # Errors
    /// [`DensityError`] when a weight is not finite and from 0 up, or all are zero.
    pub fn density(
        &self,
        weight: impl Fn(&SurfacePoint) -> f64 + Sync + Send,
    ) -> Result<Density, DensityError> {
        const MOST: f64 = 16.0;
        const CHUNK: usize = 1 << 10;
        let rows = self.longest.ceil().clamp(2.0, MOST) as u32;
        let weights = parallel::map_chunks(self.parts.len(), CHUNK, |range| {
            let corners = |part: &Part| {
                if *part == Part::whole(part.face) {
                    Part::whole(part.face).corners.map(|corner| weight(&part.at(corner)))
                } else {
                    let places = middles(rows);
                    let sum: f64 = places.iter().map(|&place| weight(&part.at(place))).sum();
                    [sum / places.len() as f64; 3]
                }
            };
            self.parts[range].iter().map(corners).collect::<Vec<_>>()
        });
        Density::of_corners(&self.mesh, &weights.concat())
    }
}

/// The middles of the `rows` squared equal parts of a triangle.
fn middles(rows: u32) -> Vec<[f64; 3]> {
    let unit = 1.0 / (3.0 * f64::from(rows));
    let mut middles = Vec::new();
    for i in 0..rows {
        for j in 0..rows - i {
            let at = |i: u32, j: u32, add: u32| {
                let (u, v) = (f64::from(3 * i + add) * unit, f64::from(3 * j + add) * unit);
                [u, v, 1.0 - u - v]
            };
            middles.push(at(i, j, 1));
            if i + j + 1 < rows {
                middles.push(at(i, j, 2));
            }
        }
    }
    middles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{Options, run_weighted};
    use crate::planted;
    use crate::progress::Silent;
    use crate::shapes::{self, Shape};

    #[test]
    fn middles_are_in_their_parts() {
        for rows in [1, 2, 5] {
            let middles = middles(rows);
            assert_eq!(middles.len() as u32, rows * rows);
            for k in 0..3 {
                let mean = middles.iter().map(|m| m[k]).sum::<f64>() / middles.len() as f64;
                assert!((mean - 1.0 / 3.0).abs() < 1e-12);
            }
            assert!(middles.iter().flatten().all(|&x| x > 0.0 && x < 1.0));
        }
    }

    #[test]
    fn the_surface_stays_whatever_is_cut() {
        for shape in [Shape::Sphere, Shape::Cup, Shape::Cube, Shape::Square] {
            let mesh = planted::mesh(&shape.generate());
            // Every third face lies somewhere; sizes differ by far.
            let lay = |face: FaceId| {
                let size = f64::from(face.0 % 11) * 10.0;
                (face.0.is_multiple_of(3)).then_some([DVec2::ZERO, DVec2::X * size, DVec2::Y * size])
            };
            let fine = refine(&mesh, lay, 30.0, 1 << 20);
            let (old, new) = (mesh.topology(), fine.mesh().topology());
            assert!(new.face_count() > old.face_count());
            assert!((fine.mesh().area() / mesh.area() - 1.0).abs() < 1e-12);
            assert_eq!(new.components().count, old.components().count);
            // No crack: borders stay as long as they were.
            let border = |mesh: &SurfaceMesh| -> f64 {
                (0..3 * mesh.face_count() as u32)
                    .map(crate::HalfedgeId)
                    .filter(|&h| mesh.topology().twin(h).is_none())
                    .map(|h| mesh.edge_length(h))
                    .sum()
            };
            assert!((border(fine.mesh()) - border(&mesh)).abs() < 1e-9);
            for face in new.face_ids() {
                let point = SurfacePoint { face, barycentric: [0.2, 0.3, 0.5] };
                let lifted = fine.lift(&point);
                assert!(mesh.locate(&lifted).distance(fine.mesh().locate(&point)) < 1e-12);
                assert!(fine.mesh().face_normal(face).dot(mesh.face_normal(lifted.face)) > 1.0 - 1e-9);
            }
        }
    }

    #[test]
    fn no_edge_stays_too_long_unless_there_are_too_many_faces() {
        let mesh = planted::mesh(&shapes::square(1));
        let texels = |face: FaceId| Some(mesh.triangle(face).map(|p| p.truncate() * 64.0));
        let side = |fine: &Refined| {
            let mesh = fine.mesh();
            (0..3 * mesh.face_count() as u32)
                .map(|h| mesh.edge_length(crate::HalfedgeId(h)) * 64.0)
                .fold(0.0, f64::max)
        };
        assert!(side(&refine(&mesh, texels, 3.0, usize::MAX)) <= 3.0 + 1e-9);
        let few = refine(&mesh, texels, 3.0, 100);
        assert!(
            few.mesh().face_count() <= 100 && side(&few) < 32.0,
            "{} {}",
            few.mesh().face_count(),
            side(&few)
        );
        // Nothing to do, and nowhere to look.
        assert_eq!(refine(&mesh, texels, 1e3, usize::MAX).mesh(), &mesh);
        assert_eq!(refine(&mesh, |_| None, 0.1, usize::MAX).mesh(), &mesh);
        assert_eq!(refine(&mesh, |_| Some([DVec2::NAN; 3]), 0.1, usize::MAX).mesh(), &mesh);
    }

    #[test]
    fn points_follow_what_varies_inside_faces() {
        // Two triangles; a disc and the rest of the square weigh 9 : 1.
        let mesh = planted::mesh(&shapes::square(1));
        let inside = |p: glam::DVec3| p.truncate().distance(DVec2::new(0.3, 0.6)) < 0.25;
        let fine = refine(&mesh, |face| Some(mesh.triangle(face).map(|p| p.truncate() * 64.0)), 2.0, 1 << 20);
        let density = fine.density(|point| if inside(mesh.locate(point)) { 9.0 } else { 1.0 }).unwrap();
        let count = 1000;
        let run = run_weighted(fine.mesh(), &density, &Options::for_count(count), &Silent).unwrap();
        let found = run.points().filter(|point| inside(mesh.locate(&fine.lift(point)))).count() as f64;
        let disc = std::f64::consts::PI * 0.25 * 0.25;
        let due = 9.0 * disc / (9.0 * disc + 1.0 - disc) * count as f64;
        assert!((found - due).abs() < 0.02 * due, "{found} of {due}");
    }
}
