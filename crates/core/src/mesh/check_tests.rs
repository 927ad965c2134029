//! Soups with known faults.

use glam::{DVec3, dvec3};
use proptest::prelude::*;

use super::*;
use crate::ids::FaceId;

fn soup(positions: &[[f64; 3]], polygons: &[&[u32]]) -> PolygonSoup {
    let mut soup =
        PolygonSoup { positions: positions.iter().map(|&p| p.into()).collect(), ..Default::default() };
    for polygon in polygons {
        soup.push_polygon(polygon);
    }
    soup
}

fn check(soup: &PolygonSoup) -> Result<(SurfaceMesh, RepairReport), MeshError> {
    let result = SurfaceMesh::from_soup(soup, &CheckOptions::default());
    if let Ok((mesh, report)) = &result {
        assert_sane(soup, mesh, report);
    }
    result
}

/// What holds for every checked mesh.
fn assert_sane(soup: &PolygonSoup, mesh: &SurfaceMesh, report: &RepairReport) {
    assert!(mesh.face_count() > 0 && mesh.area().is_normal() && mesh.area() > 0.0);
    assert_eq!(soup.positions.len(), mesh.vertex_count() + report.welded_vertices + report.isolated_vertices);
    for face in mesh.topology().face_ids() {
        assert!(mesh.face_area(face) > 0.0 && mesh.face_area(face).is_finite());
        assert!((mesh.face_normal(face).length() - 1.0).abs() < 1e-14, "{:?}", mesh.face_normal(face));
        let source = mesh.sources()[face.index()];
        let range = soup.corner_range(source.polygon.index());
        for (vertex, place) in mesh.topology().corners(face).into_iter().zip(source.corners) {
            assert!(range.contains(&(place as usize)));
            assert_eq!(mesh.position(vertex), soup.positions[soup.corners[place as usize] as usize]);
        }
    }
}

const TETRAHEDRON: [[f64; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
const OUTWARD: [&[u32]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]];
const INWARD: [&[u32]; 4] = [&[0, 1, 2], &[0, 3, 1], &[1, 3, 2], &[0, 2, 3]];

#[test]
fn a_clean_mesh_keeps_its_numbers() {
    let soup = soup(&TETRAHEDRON, &OUTWARD);
    let (mesh, report) = check(&soup).unwrap();
    assert!(report.is_clean());
    assert_eq!(mesh.positions(), soup.positions);
    let faces: Vec<u32> = mesh.topology().faces().iter().flatten().map(|v| v.0).collect();
    assert_eq!(faces, soup.corners);
    assert_eq!(mesh.topology().border_edge_count(), 0);
}

#[test]
fn inward_components_are_turned_with_their_sources_unless_told_not_to() {
    for far in [0.0, 1e9] {
        let mut soup = soup(&TETRAHEDRON, &INWARD);
        soup.positions.iter_mut().for_each(|p| *p += far);
        let (mesh, report) = check(&soup).unwrap();
        assert_eq!(report, RepairReport { turned_components: 1, ..Default::default() });
        let centre = soup.positions.iter().sum::<DVec3>() / 4.0;
        for face in mesh.topology().face_ids() {
            assert!(mesh.face_normal(face).dot(mesh.triangle(face)[0] - centre) > 0.0);
        }
        let (mesh, report) = SurfaceMesh::from_soup(&soup, &CheckOptions { turn_outward: false }).unwrap();
        assert!(report.is_clean());
        assert!(mesh.face_normal(FaceId(0)).z > 0.0);
    }
}

#[test]
fn open_and_flat_components_are_not_turned() {
    let open = soup(&TETRAHEDRON, &INWARD[..3]);
    assert_eq!(check(&open).unwrap().1, RepairReport::default());
    // Two squares back to back, diagonals crossed so that no triangle is repeated: closed, no volume.
    let square = [[0., 0., 5.], [1., 0., 5.], [1., 1., 5.], [0., 1., 5.]];
    let pillow = soup(&square, &[&[0, 1, 2], &[0, 2, 3], &[1, 0, 3], &[1, 3, 2]]);
    let (mesh, report) = check(&pillow).unwrap();
    assert_eq!(mesh.topology().border_edge_count(), 0);
    assert!(report.is_clean());
}

#[test]
fn equal_positions_are_welded_and_zeros_of_either_sign_are_equal() {
    let mut triangles = PolygonSoup::default();
    for polygon in OUTWARD {
        for &v in polygon {
            let sign = if triangles.positions.len() % 2 == 0 { 1.0 } else { -1.0 };
            let p = TETRAHEDRON[v as usize].map(|x| if x == 0.0 { 0.0 * sign } else { x });
            triangles.positions.push(p.into());
        }
        let n = triangles.positions.len() as u32;
        triangles.push_polygon(&[n - 3, n - 2, n - 1]);
    }
    let (mesh, report) = check(&triangles).unwrap();
    assert_eq!(report, RepairReport { welded_vertices: 8, ..Default::default() });
    assert_eq!((mesh.vertex_count(), mesh.topology().edge_count()), (4, 6));
}

#[test]
fn vertices_that_differ_in_the_last_bit_are_not_welded() {
    let mut positions = TETRAHEDRON.to_vec();
    positions.push([0.0, 0.0, f64::from_bits(1.0f64.to_bits() + 1)]);
    let (mesh, report) = check(&soup(&positions, &[&[0, 1, 3], &[1, 2, 4]])).unwrap();
    assert_eq!(mesh.vertex_count(), 5);
    assert!(report.is_clean());
}

#[test]
fn defects_are_dropped_and_counted() {
    let positions =
        [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [9., 9., 9.], [2., 0., 0.], [0., 0., 0.]];
    let soup = soup(
        &positions,
        &[
            &[0, 1, 2],    // kept
            &[2, 1, 0],    // the same turned over
            &[1, 2, 6],    // the same through a welded vertex
            &[0, 1, 5],    // no area
            &[0, 1, 1],    // two corners
            &[0, 1, 0, 1], // two corners, twice
            &[0, 6, 0],    // one corner
            &[],           // none
            &[0, 2, 2, 3], // a triangle with a corner repeated
        ],
    );
    let (mesh, report) = check(&soup).unwrap();
    let expected = RepairReport {
        welded_vertices: 1,
        isolated_vertices: 2,
        degenerate_polygons: 4,
        zero_area_faces: 1,
        duplicate_faces: 2,
        ..Default::default()
    };
    assert_eq!(report, expected);
    assert_eq!((mesh.face_count(), mesh.vertex_count()), (2, 4));
    assert!(!report.is_clean());
}

#[test]
fn edges_of_three_triangles_are_borders() {
    let positions = [[0., 0., 0.], [0., 0., 1.], [1., 0., 0.], [-1., 1., 0.], [-1., -1., 0.]];
    let (mesh, report) = check(&soup(&positions, &[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4]])).unwrap();
    assert_eq!(report, RepairReport { non_manifold_edges: 1, ..Default::default() });
    assert_eq!(mesh.topology().border_edge_count(), 9);
}

#[test]
fn bad_soups_are_named() {
    let error = |soup: &PolygonSoup| check(soup).unwrap_err();
    assert_eq!(error(&PolygonSoup::default()), MeshError::NoFace);
    assert_eq!(error(&soup(&TETRAHEDRON, &[])), MeshError::NoFace);
    assert_eq!(error(&soup(&[], &[&[]])), MeshError::NoArea { polygons: 1 });
    assert_eq!(
        error(&soup(&[], &[&[0, 1, 2]])),
        MeshError::IndexOutOfRange { polygon: 0, corner: 0, index: 0, vertices: 0 }
    );
    assert_eq!(error(&soup(&TETRAHEDRON, &[&[0, 0, 1], &[2, 2, 2]])), MeshError::NoArea { polygons: 2 });
    assert_eq!(
        error(&soup(&TETRAHEDRON, &[&[0, 1, 2], &[0, 1, 4]])),
        MeshError::IndexOutOfRange { polygon: 1, corner: 2, index: 4, vertices: 4 }
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut positions = TETRAHEDRON;
        positions[2][1] = bad;
        let MeshError::NotFinite { vertex: 2, position } = error(&soup(&positions, &OUTWARD)) else {
            panic!()
        };
        assert!(!position[1].is_finite());
    }
    let mut positions = TETRAHEDRON;
    positions[3][0] = -1e200;
    assert_eq!(error(&soup(&positions, &OUTWARD)), MeshError::TooLarge { vertex: 3, coordinate: 1e200 });
    let tiny = TETRAHEDRON.map(|p| p.map(|x| x * 1e-100));
    assert_eq!(error(&soup(&tiny, &OUTWARD)), MeshError::TooSmall { size: 1e-100 });

    let mut broken = soup(&TETRAHEDRON, &OUTWARD);
    broken.ends[1] = 2;
    assert_eq!(error(&broken), MeshError::BrokenEnds { polygon: 1 });
    broken.ends = vec![3, 99];
    assert_eq!(error(&broken), MeshError::BrokenEnds { polygon: 1 });
    broken.ends = vec![3, 6];
    assert_eq!(error(&broken), MeshError::BrokenEnds { polygon: 2 });
}

#[test]
fn one_triangle_of_any_size_anywhere() {
    for scale in [1e-60, 1e-30, 1e-3, 1.0, 1e7, 1e30, 1e59] {
        let positions = [[0., 0., 0.], [3., 0., 0.], [0., 4., 0.]].map(|p| p.map(|x| x * scale));
        let (mesh, report) = check(&soup(&positions, &[&[0, 1, 2]])).unwrap();
        assert!(report.is_clean());
        assert!((mesh.area() / (6.0 * scale * scale) - 1.0).abs() < 1e-15);
        assert_eq!(mesh.face_normal(FaceId(0)), DVec3::Z);
    }
    let far = [[0., 0., 0.], [3., 0., 0.], [0., 4., 0.]].map(|p| p.map(|x| x + 1e12));
    assert_eq!(check(&soup(&far, &[&[0, 1, 2]])).unwrap().0.area(), 6.0);
}

#[test]
fn needles_survive_down_to_rounding() {
    let needle = |height: f64, offset: f64| {
        let positions = [[0., 0., 0.], [1., 0., 0.], [0.5, height, 0.]].map(|p| p.map(|x| x + offset));
        check(&soup(&positions, &[&[0, 1, 2]]))
    };
    for height in [1e-6, 1e-12, 1e-14] {
        let (mesh, report) = needle(height, 0.0).unwrap();
        assert!(report.is_clean());
        assert_eq!(mesh.area(), 0.5 * height);
    }
    assert_eq!(needle(1e-16, 0.0).unwrap_err(), MeshError::NoArea { polygons: 1 });
    assert_eq!(needle(1e-12, 1e6).unwrap_err(), MeshError::NoArea { polygons: 1 });
}

#[test]
fn polygons_are_cut_and_joined() {
    // A cube of quadrangles around the origin, its last face as an L of five corners and a triangle.
    let mut positions: Vec<[f64; 3]> =
        (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| f64::from(2 * bit) - 1.0)).collect();
    positions.push([0.0, 0.0, 1.0]);
    let soup = soup(
        &positions,
        &[
            &[0, 2, 3, 1],
            &[0, 1, 5, 4],
            &[1, 3, 7, 5],
            &[3, 2, 6, 7],
            &[2, 0, 4, 6],
            &[4, 8, 7, 6],
            &[4, 5, 8],
            &[5, 7, 8],
        ],
    );
    let (mesh, report) = check(&soup).unwrap();
    assert_eq!(report, RepairReport { polygons_triangulated: 6, ..Default::default() });
    assert_eq!((mesh.vertex_count(), mesh.face_count(), mesh.topology().border_edge_count()), (9, 14, 0));
    assert!((mesh.area() - 24.0).abs() < 1e-13);
}

#[test]
fn a_million_components_take_linear_time() {
    let count = 1_000_000;
    let mut soup = PolygonSoup::default();
    for i in 0..count {
        let (x, y) = (f64::from(i % 1000), f64::from(i / 1000));
        soup.positions.extend([dvec3(x, y, 0.0), dvec3(x + 0.5, y, 0.0), dvec3(x, y + 0.5, 0.0)]);
        soup.push_polygon(&[3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let (mesh, report) = SurfaceMesh::from_soup(&soup, &CheckOptions::default()).unwrap();
    assert!(report.is_clean());
    assert_eq!(mesh.topology().components().count, count as usize);
    assert_eq!(mesh.area(), f64::from(count) / 8.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Any soup is checked or refused, never a panic, and what comes out is sane.
    #[test]
    fn arbitrary_soups(
        grid in prop::collection::vec((-2i8..3, -2i8..3, -1i8..2), 0..12),
        scale in prop::sample::select(vec![1e-30, 1.0, 1e30]),
        polygons in prop::collection::vec(prop::collection::vec(0u32..12, 0..7), 0..12),
    ) {
        let positions = grid.iter().map(|&(x, y, z)| dvec3(x.into(), y.into(), z.into()) * scale).collect();
        let mut soup = PolygonSoup { positions, ..Default::default() };
        for polygon in &polygons {
            soup.push_polygon(polygon);
        }
        let _ = check(&soup);
    }

    /// The order of the vertices and the place of the first corner change neither area nor counts.
    #[test]
    fn renumbering_changes_nothing(shift in 0u32..4, turn in 0usize..3) {
        let positions: Vec<[f64; 3]> = (0..4).map(|v| TETRAHEDRON[((v + shift) % 4) as usize]).collect();
        let polygons: Vec<Vec<u32>> = OUTWARD
            .iter()
            .map(|p| (0..3).map(|c| (p[(c + turn) % 3] + 4 - shift) % 4).collect())
            .collect();
        let polygons: Vec<&[u32]> = polygons.iter().map(Vec::as_slice).collect();
        let (mesh, report) = check(&soup(&positions, &polygons)).unwrap();
        prop_assert!(report.is_clean());
        prop_assert_eq!(mesh.topology().edge_count(), 6);
        prop_assert!((mesh.area() - (1.5 + 0.75f64.sqrt())).abs() < 1e-15);
    }
}
