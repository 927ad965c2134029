//! Counts and areas of the shapes.

use std::f64::consts::PI;

use glam::DVec3;

use super::*;
use crate::geometry::triangle;
use crate::ids::VertexId;
use crate::mesh::topology::Topology;

struct Facts {
    vertices: usize,
    edges: usize,
    faces: usize,
    border: usize,
    components: usize,
    area: f64,
    volume: f64,
}

impl Facts {
    fn euler(&self) -> i64 {
        self.vertices as i64 - self.edges as i64 + self.faces as i64
    }
}

/// Measures a shape and checks what holds for all: every vertex used, no degenerate triangle, every edge between at
/// most two triangles that agree on their winding.
fn facts(soup: &PolygonSoup) -> Facts {
    let faces: Vec<[u32; 3]> =
        (0..soup.polygon_count()).map(|p| soup.polygon(p).try_into().expect("a triangle")).collect();
    let mut used = vec![false; soup.positions.len()];
    faces.iter().flatten().for_each(|&v| used[v as usize] = true);
    assert!(used.iter().all(|&u| u), "a vertex without a face");
    let (topology, split) =
        Topology::new(soup.positions.len(), faces.iter().map(|f| f.map(VertexId)).collect());
    assert_eq!((split.non_manifold, split.inconsistent), (0, 0));
    let (mut area, mut volume) = (0.0, 0.0);
    let mean_area = |area: f64| area / faces.len() as f64;
    let corners = |f: &[u32; 3]| f.map(|v| soup.positions[v as usize]);
    for f in &faces {
        let [a, b, c] = corners(f);
        area += triangle::area(a, b, c);
        volume += a.dot(b.cross(c)) / 6.0;
    }
    for f in &faces {
        let [a, b, c] = corners(f);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let smallest_height = 2.0 * triangle::area(a, b, c) / longest;
        assert!(smallest_height > 1e-3 * mean_area(area).sqrt(), "a triangle of height {smallest_height}");
    }
    Facts {
        vertices: soup.positions.len(),
        edges: topology.edge_count(),
        faces: faces.len(),
        border: topology.border_edge_count(),
        components: topology.components().count,
        area,
        volume,
    }
}

fn near(value: f64, expected: f64, relative: f64) -> bool {
    (value / expected - 1.0).abs() <= relative
}

#[test]
fn sphere_of_the_paper() {
    let f = facts(&uv_sphere(20, 20));
    assert_eq!((f.vertices, f.edges, f.faces, f.border), (382, 1140, 760, 0));
    assert_eq!(f.euler(), 2);
    // The volume of the polyhedron: pyramids over the bands, each a prismatoid of regular polygons.
    let polygon = |k: usize| {
        let radius = libm::sin(PI * k as f64 / 20.0);
        10.0 * radius * radius * libm::sin(2.0 * PI / 20.0)
    };
    let volume: f64 = (0..20)
        .map(|k| {
            let height = libm::cos(PI * k as f64 / 20.0) - libm::cos(PI * (k + 1) as f64 / 20.0);
            let (low, high) = (polygon(k), polygon(k + 1));
            height / 3.0 * (low + high + (low * high).sqrt())
        })
        .sum();
    assert!(near(f.volume, volume, 1e-12), "{} {volume}", f.volume);
    let fine = facts(&uv_sphere(300, 300));
    assert!(near(fine.area, 4.0 * PI, 2e-4) && near(fine.volume, 4.0 / 3.0 * PI, 3e-4));
}

#[test]
fn cup_of_the_paper() {
    let soup = cup(1);
    let f = facts(&soup);
    assert_eq!((f.vertices, f.edges, f.faces, f.border), (7024, 20976, 13952, 96));
    assert_eq!((f.euler(), f.components), (0, 2));
    assert!(f.volume > 0.0);
    // Twice as fine: 160 segments and 156 rings, two holes of 12 x 12 cells, 48 segments and 74 rings.
    let fine = facts(&cup(2));
    let faces = 2 * (160 * 155 - 2 * 12 * 12 + 48 * 74);
    assert_eq!((fine.faces, fine.border, fine.euler()), (faces, 2 * f.border, 0));
    assert!(near(fine.area, f.area, 5e-3), "{} {}", fine.area, f.area);
}

#[test]
fn cup_has_its_handle_wound_outward() {
    let soup = cup(1);
    // The handle comes last: 37 rings of 24 quads. Seen from the wall its open ends hide almost no volume.
    let first = soup.polygon_count() - 2 * 24 * 37;
    let from = DVec3::new(0.37, 0.0, 0.5);
    let volume: f64 = (first..soup.polygon_count())
        .map(|p| {
            let corners: [u32; 3] = soup.polygon(p).try_into().expect("a triangle");
            let [a, b, c] = corners.map(|v| soup.positions[v as usize] - from);
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    let length = 0.9;
    assert!(near(volume, PI * 0.075 * 0.075 * length, 0.2), "{volume}");
}

#[test]
fn cup_has_no_folded_grid() {
    // Around the holes the grid gives way to the handle: no two neighbours may fold over.
    let soup = cup(1);
    let faces = (0..soup.polygon_count()).map(|p| {
        let corners: [u32; 3] = soup.polygon(p).try_into().expect("a triangle");
        corners.map(VertexId)
    });
    let (topology, _) = Topology::new(soup.positions.len(), faces.collect());
    let normal = |f: crate::FaceId| {
        let [a, b, c] = topology.corners(f).map(|v| soup.positions[v.index()]);
        triangle::area_vector(a, b, c).normalize()
    };
    for face in topology.face_ids() {
        for corner in 0..3 {
            if let Some(twin) = topology.twin(crate::HalfedgeId::of(face, corner)) {
                // The rim, a half circle of a few cells, is the sharpest bend.
                assert!(normal(face).dot(normal(twin.face())) > -0.1);
            }
        }
    }
}

#[test]
fn drink_of_the_paper() {
    let f = facts(&drink_like(1));
    assert_eq!((f.vertices, f.edges, f.faces, f.border), (12487, 37495, 24994, 8));
    assert_eq!((f.euler(), f.components), (-14, 1));
    assert!(near(f.area, 10.0 * PI, 0.1) && near(f.volume, 4.0 * PI, 0.15), "{} {}", f.area, f.volume);
    for seed in [2, 3, 99] {
        assert_eq!(facts(&drink_like(seed)).euler(), -14, "seed {seed}");
    }
}

#[test]
fn scan_has_the_faces_asked_for() {
    for (faces, made) in [(0, 8), (8, 8), (9, 10), (100, 100), (20_001, 20_002)] {
        for seed in [0, 1, 7] {
            let f = facts(&scan_like(seed, faces));
            assert_eq!(
                (f.faces, f.euler(), f.border, f.components),
                (made, 2, 0, 1),
                "{faces} faces, seed {seed}"
            );
            assert!(f.volume > 0.0);
        }
    }
    assert_eq!(scan_like(5, 500), scan_like(5, 500));
    assert_ne!(scan_like(5, 500), scan_like(6, 500));
}

#[test]
fn scan_is_unstructured() {
    let soup = scan_like(1, 10_000);
    let mut degree = vec![0; soup.positions.len()];
    soup.corners.iter().for_each(|&v| degree[v as usize] += 1);
    let six = degree.iter().filter(|&&d| d == 6).count();
    assert!(six < degree.len() / 2, "{six} of {} vertices have six neighbours", degree.len());
}

#[test]
fn torus_by_pappus() {
    let f = facts(&torus(50, 20, 0.4));
    assert_eq!((f.faces, f.euler(), f.border), (2000, 0, 0));
    let fine = facts(&torus(500, 200, 0.4));
    assert!(near(fine.area, 4.0 * PI * PI * 0.4, 1e-3) && near(fine.volume, 2.0 * PI * PI * 0.16, 1e-3));
}

#[test]
fn trefoil_by_pappus() {
    let f = facts(&trefoil(700, 70, 0.5));
    assert_eq!((f.vertices, f.faces, f.euler(), f.border), (49_000, 98_000, 0, 0));
    // The length of the knot by 10,000 chords.
    let at = |i: usize| {
        let t = 2.0 * PI * i as f64 / 10_000.0;
        let (s, c) = (libm::sin, libm::cos);
        DVec3::new(s(t) + 2.0 * s(2.0 * t), c(t) - 2.0 * c(2.0 * t), -s(3.0 * t))
    };
    let length: f64 = (0..10_000).map(|i| at(i).distance(at(i + 1))).sum();
    assert!(near(length, 28.8263, 1e-5), "{length}");
    assert!(near(f.area, PI * length, 1e-3), "{} {}", f.area, PI * length);
    assert!(near(f.volume, 0.25 * PI * length, 2e-3), "{} {}", f.volume, 0.25 * PI * length);
}

#[test]
fn blocks_are_exact() {
    let f = facts(&cube(5));
    assert_eq!((f.vertices, f.edges, f.faces, f.border), (152, 450, 300, 0));
    assert!(near(f.area, 6.0, 1e-14) && near(f.volume, 1.0, 1e-14));
    let f = facts(&block(DVec3::new(1.0, 2.0, 3.0), [1, 3, 2]));
    assert_eq!((f.faces, f.euler()), (4 * (3 + 6 + 2), 2));
    assert!(near(f.area, 22.0, 1e-14) && near(f.volume, 6.0, 1e-14));
    let f = facts(&plate(10, 0.02));
    assert_eq!((f.faces, f.euler()), (480, 2));
    assert!(near(f.area, 2.08, 1e-14) && near(f.volume, 0.02, 1e-13));
    let f = facts(&square(4));
    assert_eq!((f.vertices, f.edges, f.faces, f.border), (25, 56, 32, 16));
    assert!(near(f.area, 1.0, 1e-15));
    let f = facts(&tetrahedron());
    assert_eq!((f.vertices, f.edges, f.faces, f.border), (4, 6, 4, 0));
    assert!(near(f.area, 8.0 * 3.0_f64.sqrt(), 1e-15) && near(f.volume, 8.0 / 3.0, 1e-15));
}

#[test]
fn capsule_is_a_sphere_pulled_apart() {
    let f = facts(&capsule(12, 3, 2.0));
    assert_eq!((f.faces, f.euler(), f.border), (2 * 12 * 8, 2, 0));
    let fine = facts(&capsule(300, 80, 2.0));
    assert!(near(fine.area, 8.0 * PI, 1e-3) && near(fine.volume, (4.0 / 3.0 + 2.0) * PI, 1e-3));
}

#[test]
fn shapes_have_names() {
    for shape in Shape::ALL {
        assert_eq!(shape.name().parse(), Ok(shape));
        let f = facts(&shape.generate());
        assert!(f.volume > 0.0 || shape == Shape::Square, "{shape:?} is wound inward");
        let about = shape.generate_about(3_000).polygon_count();
        let fixed = matches!(shape, Shape::Cup | Shape::Drink | Shape::Tetrahedron);
        assert!(fixed || (2_500..3_500).contains(&about), "{shape:?}: {about}");
        assert!(shape.generate_about(0).polygon_count() > 0);
    }
    let own = |shape: Shape| shape.generate().polygon_count();
    assert_eq!(
        [Shape::Sphere, Shape::Cup, Shape::Drink, Shape::Trefoil].map(own),
        [760, 13_952, 24_994, 98_000]
    );
    let unknown = "teapot".parse::<Shape>().unwrap_err();
    assert!(unknown.to_string().starts_with("no shape is called \"teapot\": the shapes are sphere, cup, "));
}
