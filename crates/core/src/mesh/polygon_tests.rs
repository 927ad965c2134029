//! Polygons cut into triangles.

use glam::{DMat3, DVec3, dvec3};
use proptest::prelude::*;

use super::*;
use crate::geometry::triangle;

/// Cuts the polygon through these points and checks what holds for every cut; gives how, and the area.
fn cut_with(positions: &[DVec3], corners: &[u32]) -> (Cut, Vec<[usize; 3]>, f64) {
    let corners: Vec<VertexId> = corners.iter().map(|&v| VertexId(v)).collect();
    let mut triangles = Vec::new();
    let cut = triangulate(positions, &corners, &mut triangles);
    let area = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| positions[corners[i].index()]);
            triangle::area(a, b, c)
        })
        .sum();
    (cut, triangles, area)
}

fn cut(points: &[[f64; 2]]) -> (Cut, Vec<[usize; 3]>, f64) {
    let corners: Vec<u32> = (0..points.len() as u32).collect();
    let flat: Vec<DVec3> = points.iter().map(|&[x, y]| dvec3(x, y, 0.0)).collect();
    let result = cut_with(&flat, &corners);
    // Wound as the polygon, in its own plane and in every other.
    if result.0 == Cut::Delaunay {
        assert_eq!(result.1.len(), points.len() - 2);
        let normal: DVec3 = flat.iter().zip(flat.iter().cycle().skip(1)).map(|(a, b)| a.cross(*b)).sum();
        for t in &result.1 {
            let [a, b, c] = t.map(|i| flat[i]);
            assert!(triangle::area_vector(a, b, c).dot(normal) > 0.0);
        }
    }
    for turn in [DMat3::from_cols_array(&[0., 1., 0., 0., 0., 1., 1., 0., 0.]), DMat3::from_rotation_x(0.7)] {
        let turned: Vec<DVec3> = flat.iter().map(|&p| turn * p * 1e-30).collect();
        let (how, _, area) = cut_with(&turned, &corners);
        assert_eq!(how, result.0);
        assert!((area * 1e60 - result.2).abs() <= 1e-12 * result.2);
    }
    result
}

fn shoelace(points: &[[f64; 2]]) -> f64 {
    points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>()
        / 2.0
}

#[test]
fn square_and_dart() {
    let (how, triangles, area) = cut(&[[0., 0.], [1., 0.], [1., 1.], [0., 1.]]);
    assert_eq!((how, triangles, area), (Cut::Delaunay, vec![[0, 1, 2], [0, 2, 3]], 1.0));
    // The short diagonal of a kite is Delaunay.
    let (_, triangles, _) = cut(&[[-5., 0.], [0., -1.], [5., 0.], [0., 1.]]);
    assert_eq!(triangles, [[1, 2, 3], [1, 3, 0]]);
    // Only the diagonal through the notch lies inside, wherever the polygon starts.
    for start in 0..4 {
        let mut dart = [[0., 0.], [2., -1.], [0.5, 0.], [2., 1.]];
        dart.rotate_left(start);
        let (how, triangles, area) = cut(&dart);
        assert_eq!((how, area), (Cut::Delaunay, 0.5));
        let notch = (2 + 4 - start) % 4;
        assert!(triangles.iter().all(|t| t.contains(&notch)));
    }
}

#[test]
fn concave_polygons_keep_their_area() {
    let l_shape = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
    let (how, _, area) = cut(&l_shape);
    assert_eq!((how, area), (Cut::Delaunay, 3.0));

    let star: Vec<[f64; 2]> = (0..10)
        .map(|i| {
            let (s, c) = libm::sincos(f64::from(i) * std::f64::consts::PI / 5.0);
            let r = if i % 2 == 0 { 1.0 } else { 0.4 };
            [r * c, r * s]
        })
        .collect();
    let (how, _, area) = cut(&star);
    assert_eq!(how, Cut::Delaunay);
    assert!((area - 10.0 * 0.5 * 0.4 * libm::sin(std::f64::consts::PI / 5.0)).abs() < 1e-14);

    // Three turns of a corridor of width 1.
    let spiral = [
        [0., 0.],
        [7., 0.],
        [7., 7.],
        [0., 7.],
        [0., 2.],
        [5., 2.],
        [5., 5.],
        [2., 5.],
        [2., 4.],
        [4., 4.],
        [4., 3.],
        [1., 3.],
        [1., 6.],
        [6., 6.],
        [6., 1.],
        [0., 1.],
    ];
    let (how, _, area) = cut(&spiral);
    assert_eq!((how, area), (Cut::Delaunay, shoelace(&spiral)));
}

#[test]
fn clockwise_in_the_file_is_counterclockwise_from_behind() {
    let (how, triangles, area) = cut(&[[0., 2.], [1., 2.], [1., 1.], [2., 1.], [2., 0.], [0., 0.]]);
    assert_eq!((how, triangles.len(), area), (Cut::Delaunay, 4, 3.0));
}

#[test]
fn collinear_corners_are_kept() {
    let (how, triangles, area) = cut(&[[0., 0.], [0.125, 0.], [0.25, 0.], [1., 0.], [0., 1.], [0., 0.75]]);
    assert_eq!((how, area), (Cut::Delaunay, 0.5));
    assert_eq!(triangles.len(), 4);
}

#[test]
fn non_planar_quadrangle() {
    // A saddle: both cuts have the same area, half of it on each side.
    let saddle = [dvec3(0., 0., 0.), dvec3(1., 0., 1.), dvec3(1., 1., 0.), dvec3(0., 1., 1.)];
    let (how, triangles, area) = cut_with(&saddle, &[0, 1, 2, 3]);
    assert_eq!((how, triangles.len()), (Cut::Delaunay, 2));
    assert!((area - 3f64.sqrt()).abs() < 1e-15);
}

#[test]
fn a_hole_behind_a_bridge_stays_open() {
    let positions = [[0., 0.], [4., 0.], [4., 4.], [0., 4.], [1., 1.], [3., 1.], [3., 3.], [1., 3.]]
        .map(|[x, y]: [f64; 2]| dvec3(x, y, 0.0));
    let (how, triangles, area) = cut_with(&positions, &[0, 1, 2, 3, 0, 4, 7, 6, 5, 4]);
    assert_eq!((how, triangles.len(), area), (Cut::Delaunay, 8, 12.0));
    // A spike out of the border and back adds nothing.
    let (how, triangles, area) = cut_with(&positions, &[0, 1, 2, 3, 7, 3]);
    assert_eq!((how, area), (Cut::Delaunay, 16.0));
    assert_eq!(triangles.len(), 4);
}

#[test]
fn polygons_that_cross_themselves_are_fanned() {
    let (how, triangles, _) = cut(&[[0., 0.], [3., 3.], [3., 0.], [0., 2.]]);
    assert_eq!((how, triangles), (Cut::Fan, vec![[0, 1, 2], [0, 2, 3]]));
    let pentagram: Vec<[f64; 2]> = (0..5)
        .map(|i| libm::sincos(f64::from(i) * 0.8 * std::f64::consts::PI))
        .map(|(s, c)| [c, s])
        .collect();
    assert_eq!(cut(&pentagram).0, Cut::Fan);
    // Twice around the same square.
    let twice = [0, 1, 2, 3, 0, 1, 2, 3];
    let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]].map(|[x, y]: [f64; 2]| dvec3(x, y, 0.0));
    assert_eq!(cut_with(&square, &twice).0, Cut::Fan);
    // All on a line.
    assert_eq!(cut(&[[0., 0.], [1., 0.], [2., 0.], [3., 0.]]).0, Cut::Fan);
}

#[test]
fn a_large_polygon() {
    // A comb of 20,000 corners.
    let teeth = 5_000;
    let mut comb = Vec::new();
    for i in 0..teeth {
        let x = f64::from(i);
        comb.extend([[x, 0.], [x + 0.5, 0.], [x + 0.5, 100.], [x + 1.0, 100.]]);
    }
    comb.extend([[f64::from(teeth), -1.0], [0.0, -1.0]]);
    comb.reverse();
    let expected = shoelace(&comb).abs();
    let corners: Vec<u32> = (0..comb.len() as u32).collect();
    let flat: Vec<DVec3> = comb.iter().map(|&[x, y]| dvec3(x, y, 0.0)).collect();
    let (how, triangles, area) = cut_with(&flat, &corners);
    assert_eq!((how, triangles.len()), (Cut::Delaunay, comb.len() - 2));
    assert!((area - expected).abs() < 1e-9 * expected);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Random simple polygons (sorted by angle around the origin): the area is the shoelace formula's.
    #[test]
    fn area_is_the_shoelace_formula(
        radii in prop::collection::vec(0.05f64..1.0, 3..60),
        jitter in prop::collection::vec(0.0f64..0.9, 60),
        start in 0usize..60,
        clockwise in any::<bool>(),
    ) {
        let n = radii.len();
        let mut points: Vec<[f64; 2]> = radii
            .iter()
            .zip(&jitter)
            .enumerate()
            .map(|(i, (r, j))| {
                let (s, c) = libm::sincos(std::f64::consts::TAU * (i as f64 + j) / n as f64);
                [r * c, r * s]
            })
            .collect();
        points.rotate_left(start % n);
        if clockwise {
            points.reverse();
        }
        // Around fewer than four corners the origin may lie outside; the polygon is simple all the same.
        let (how, _, area) = cut(&points);
        prop_assert_eq!(how, Cut::Delaunay);
        let expected = shoelace(&points).abs();
        prop_assert!((area - expected).abs() <= 1e-12 * expected.max(0.1), "{area} {expected}");
    }

    /// Any closed path through any points, crossing, touching and repeating itself: the triangles have the path as
    /// their boundary, so their area vectors sum up to the path's.
    #[test]
    fn area_vectors_sum_up_to_the_polygon(
        points in prop::collection::vec((0i8..5, 0i8..5, 0i8..2), 8),
        shake in prop::sample::select(vec![0.0, 1e-15, 0.1]),
        offsets in prop::collection::vec(-1.0f64..1.0, 24),
        path in prop::collection::vec(0u32..8, 4..14),
    ) {
        let positions: Vec<DVec3> = points
            .iter()
            .zip(offsets.chunks_exact(3))
            .map(|(&(x, y, z), o)| dvec3(x.into(), y.into(), z.into()) + DVec3::from_slice(o) * shake)
            .collect();
        let mut path = path;
        path.dedup();
        while path.len() > 1 && path.first() == path.last() {
            path.pop();
        }
        if path.len() < 4 {
            return Ok(());
        }
        let (_, triangles, _) = cut_with(&positions, &path);
        let at = |i: usize| positions[path[i % path.len()] as usize];
        let sum: DVec3 = triangles.iter().map(|t| triangle::area_vector(at(t[0]), at(t[1]), at(t[2]))).sum();
        let expected: DVec3 = (0..path.len()).map(|i| at(i).cross(at(i + 1))).sum();
        prop_assert!(sum.distance(expected) < 1e-8, "{sum} {expected} {triangles:?} {path:?}");
    }
}
