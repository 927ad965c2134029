//! Meshes and points for the tests of the measures.

use glam::{DQuat, DVec3};

use crate::ids::FaceId;
use crate::mesh::{CheckOptions, PolygonSoup, SurfaceMesh};
use crate::random::Random;
use crate::sample::SurfacePoint;

/// Checks triangles into a mesh.
pub(super) fn mesh(positions: &[DVec3], faces: &[[u32; 3]]) -> SurfaceMesh {
    let mut soup = PolygonSoup { positions: positions.to_vec(), ..Default::default() };
    for face in faces {
        soup.push_polygon(face);
    }
    SurfaceMesh::from_soup(&soup, &CheckOptions::default()).expect("a clean mesh").0
}

/// The unit square in the plane z = 0, cut into `cells` x `cells` squares of two triangles each.
pub(super) fn square(cells: u32) -> SurfaceMesh {
    let at = |i: u32, j: u32| j * (cells + 1) + i;
    let side = f64::from(cells);
    let positions: Vec<DVec3> = (0..=cells)
        .flat_map(|j| (0..=cells).map(move |i| DVec3::new(f64::from(i) / side, f64::from(j) / side, 0.0)))
        .collect();
    let faces: Vec<[u32; 3]> = (0..cells)
        .flat_map(|j| (0..cells).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    mesh(&positions, &faces)
}

/// The axis-parallel unit cube, 12 triangles.
pub(super) fn cube() -> SurfaceMesh {
    let positions: Vec<DVec3> =
        (0..8u32).map(|k| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh(&positions, &faces)
}

/// The unit sphere: an octahedron whose faces are cut into `cells`^2 triangles each, corners on the sphere.
pub(super) fn sphere(cells: u32) -> SurfaceMesh {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    let side = f64::from(cells);
    for octant in 0..8u32 {
        let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let first = positions.len() as u32;
        let row = |i: u32| first + i * (i + 1) / 2;
        for i in 0..=cells {
            for j in 0..=i {
                let p = DVec3::new(f64::from(i - j), f64::from(j), f64::from(cells - i)) / side;
                positions.push(DVec3::new(sign(0) * p.x, sign(1) * p.y, sign(2) * p.z).normalize());
            }
        }
        let mut push = |a: u32, b: u32, c: u32| {
            faces.push(if octant.count_ones().is_multiple_of(2) { [a, b, c] } else { [a, c, b] });
        };
        for i in 0..cells {
            for j in 0..=i {
                push(row(i) + j, row(i + 1) + j, row(i + 1) + j + 1);
                if j < i {
                    push(row(i) + j, row(i + 1) + j + 1, row(i) + j + 1);
                }
            }
        }
    }
    mesh(&positions, &faces)
}

/// The mesh turned, scaled and moved; faces and corners keep their order.
pub(super) fn moved(mesh: &SurfaceMesh, scale: f64, turn: DQuat, shift: DVec3) -> SurfaceMesh {
    let positions: Vec<DVec3> = mesh.positions().iter().map(|&p| turn * p * scale + shift).collect();
    let faces: Vec<[u32; 3]> = mesh.topology().faces().iter().map(|f| f.map(|v| v.0)).collect();
    self::mesh(&positions, &faces)
}

/// Independent uniform points.
pub(super) fn random_points(mesh: &SurfaceMesh, count: usize, seed: u64) -> Vec<SurfacePoint> {
    let mut random = Random::new(seed, 0x7465_7374);
    let mut sums: Vec<f64> = Vec::with_capacity(mesh.face_count());
    let mut sum = 0.0;
    for area in mesh.face_areas() {
        sum += area;
        sums.push(sum);
    }
    (0..count)
        .map(|_| {
            let target = random.unit() * sum;
            let face = sums.partition_point(|&s| s <= target).min(sums.len() - 1);
            let (root, across) = (random.unit().sqrt(), random.unit());
            let barycentric = [1.0 - root, root * (1.0 - across), root * across];
            SurfacePoint { face: FaceId::new(face), barycentric }
        })
        .collect()
}

/// The point of the flat mesh `square(1)` at (x, y).
pub(super) fn on_square(x: f64, y: f64) -> SurfacePoint {
    if x >= y {
        SurfacePoint { face: FaceId(0), barycentric: [1.0 - x, x - y, y] }
    } else {
        SurfacePoint { face: FaceId(1), barycentric: [1.0 - y, x, y - x] }
    }
}

/// The points of the mesh nearest to these places, by brute force over the faces.
pub(super) fn project(mesh: &SurfaceMesh, places: &[DVec3]) -> Vec<SurfacePoint> {
    places
        .iter()
        .map(|&p| {
            mesh.topology()
                .face_ids()
                .map(|face| {
                    let [a, b, c] = mesh.triangle(face);
                    let barycentric = crate::geometry::triangle::nearest(a, b, c, p);
                    SurfacePoint { face, barycentric }
                })
                .min_by(|s, t| {
                    mesh.locate(s).distance_squared(p).total_cmp(&mesh.locate(t).distance_squared(p))
                })
                .expect("a mesh has faces")
        })
        .collect()
}

/// The spherical Fibonacci lattice.
pub(super) fn fibonacci(count: usize) -> Vec<DVec3> {
    (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
            let (sin, cos) = libm::sincos(i as f64 * std::f64::consts::PI * (3.0 - 5.0f64.sqrt()));
            let radius = (1.0 - z * z).sqrt();
            DVec3::new(radius * cos, radius * sin, z)
        })
        .collect()
}
