//! Strips laid by hand, whose zones are known.

use std::f64::consts::PI;

use glam::{DVec2, dvec2};
use proptest::prelude::*;

use super::{Irregularity, bound, irregularity};
use crate::geometry::plane::{segment_distance, triangle_holds};
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::{CheckOptions, SurfaceMesh, shapes};
use crate::segment::{SegmentOptions, segment};
use crate::unfold::{BorderEdge, Strip, Strips, Twin, unfold};

/// A strip of these triangles. `cuts` pairs the directed border edges that are the two copies of an edge; all
/// others are mesh borders.
fn strip(vertices: &[DVec2], corners: &[[u32; 3]], cuts: &[([u32; 2], [u32; 2])]) -> Strip {
    let sides: Vec<(usize, [u32; 2])> = (0..corners.len() * 3)
        .map(|h| (h, [corners[h / 3][h % 3], corners[h / 3][(h % 3 + 1) % 3]]))
        .collect();
    let mut rest: Vec<_> =
        sides.iter().filter(|(_, [a, b])| !sides.iter().any(|(_, s)| s == &[*b, *a])).copied().collect();
    let mut border = Vec::new();
    let mut loops = Vec::new();
    while !rest.is_empty() {
        let start = border.len();
        let mut edge = rest.remove(0);
        loop {
            let (h, [from, to]) = edge;
            let twin = cuts
                .iter()
                .flat_map(|&(a, b)| [(a, b), (b, a)])
                .find(|(a, _)| *a == [from, to])
                .map_or(Twin::MeshBorder, |(_, b)| Twin::SameStrip { from: b[1], to: b[0] });
            border.push(BorderEdge { halfedge: HalfedgeId::new(h), from, to, twin });
            let Some(i) = rest.iter().position(|(_, side)| side[0] == to) else { break };
            edge = rest.remove(i);
        }
        loops.push(start..border.len());
    }
    let area = corners
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| vertices[v as usize]);
            0.5 * (b - a).perp_dot(c - a)
        })
        .sum();
    Strip {
        faces: (0..corners.len()).map(FaceId::new).collect(),
        corners: corners.to_vec(),
        vertices: vertices.to_vec(),
        border,
        loops,
        area,
        extent: vertices.iter().copied().fold(DVec2::ZERO, DVec2::max),
    }
}

fn alone(strip: Strip) -> Strips {
    Strips { strips: vec![strip], places: Vec::new() }
}

fn rectangle(width: f64, height: f64) -> Strip {
    let vertices = [dvec2(0.0, 0.0), dvec2(width, 0.0), dvec2(width, height), dvec2(0.0, height)];
    strip(&vertices, &[[0, 1, 2], [0, 2, 3]], &[])
}

/// `count` equilateral triangles around a point, cut open along the first one's first side.
fn fan(count: u32) -> Strip {
    let mut vertices = vec![DVec2::ZERO];
    vertices.extend((0..=count).map(|i| {
        let (sin, cos) = libm::sincos(f64::from(i) * PI / 3.0);
        dvec2(cos, sin)
    }));
    let corners: Vec<_> = (1..=count).map(|i| [0, i, i + 1]).collect();
    strip(&vertices, &corners, &[([0, 1], [count + 1, 0])])
}

/// The share of the strip's points nearer than `d_m` to its open edges, by very many of them.
fn counted(strip: &Strip, d_m: f64, tolerance: f64) -> f64 {
    const SIDE: usize = 64;
    let open: Vec<_> = strip.border.iter().filter(|e| strip.is_open(e, tolerance)).collect();
    let mut covered = 0.0;
    for index in 0..strip.corners.len() {
        let [a, b, c] = strip.triangle(index);
        let mut near = 0usize;
        for i in 0..SIDE {
            for j in 0..SIDE {
                let (mut u, mut v) = ((i as f64 + 0.5) / SIDE as f64, (j as f64 + 0.3) / SIDE as f64);
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let p = a + (b - a) * u + (c - a) * v;
                near += usize::from(open.iter().any(|e| {
                    let [from, to] = [e.from, e.to].map(|v| strip.vertices[v as usize]);
                    segment_distance(from, to, p) < d_m
                }));
            }
        }
        covered += 0.5 * (b - a).perp_dot(c - a) * near as f64 / (SIDE * SIDE) as f64;
    }
    covered / strip.area
}

fn assert_near(found: f64, known: f64) {
    assert!((found - known).abs() < 1e-9, "{found}, not {known}");
}

/// The exact share may be off by half of what stays undecided.
fn assert_exact(found: Irregularity, known: f64) {
    assert!((found.exact - known).abs() <= 0.5e-4 + 1e-9, "{}, not {known}", found.exact);
}

#[test]
fn the_unit_square_has_a_frame() {
    let strips = alone(rectangle(1.0, 1.0));
    for d_m in [0.01, 0.1, 0.25, 0.4, 0.499] {
        let found = irregularity(&strips, d_m, 0.0);
        let frame = 1.0 - (1.0 - 2.0 * d_m) * (1.0 - 2.0 * d_m);
        assert_near(found.bound, 4.0 * d_m);
        assert_near(bound(&strips, d_m, 0.0), 4.0 * d_m);
        assert_near(found.refined, frame);
        assert_exact(found, frame);
    }
}

#[test]
fn beyond_half_the_side_a_square_is_four_triangles() {
    let found = irregularity(&alone(rectangle(1.0, 1.0)), 0.8, 0.0);
    assert_near(found.bound, 3.2);
    assert_near(found.refined, 1.0);
    assert_near(found.exact, 1.0);
}

#[test]
fn strips_add_up_over_the_total_area() {
    let strips = Strips { strips: vec![rectangle(1.0, 1.0), rectangle(2.0, 2.0)], places: Vec::new() };
    let found = irregularity(&strips, 0.25, 0.0);
    let frames = (1.0 - 0.25) + (4.0 - 1.5 * 1.5);
    assert_near(found.bound, 12.0 * 0.25 / 5.0);
    assert_near(found.refined, frames / 5.0);
    assert_exact(found, frames / 5.0);
}

#[test]
fn an_l_has_a_sector_at_its_concave_corner() {
    let vertices = [
        dvec2(0.0, 0.0),
        dvec2(2.0, 0.0),
        dvec2(2.0, 1.0),
        dvec2(1.0, 1.0),
        dvec2(1.0, 2.0),
        dvec2(0.0, 2.0),
    ];
    let strips = alone(strip(&vertices, &[[3, 0, 1], [3, 1, 2], [3, 5, 0], [3, 4, 5]], &[]));
    let d_m = 0.25;
    let found = irregularity(&strips, d_m, 0.0);
    let square = d_m * d_m;
    // Perimeter 8; each of the five convex corners is shared, the concave one adds a quarter disc.
    let zone = 8.0 * d_m - 5.0 * square + 0.25 * PI * square;
    assert_near(found.bound, (8.0 * d_m + 2.0 * square) / 3.0);
    assert_near(found.refined, zone / 3.0);
    assert_exact(found, zone / 3.0);
}

#[test]
fn a_thin_finger_counts_twice_but_not_exactly() {
    let found = irregularity(&alone(rectangle(10.0, 0.1)), 1.0, 0.0);
    assert_near(found.bound, 20.2);
    // Two long trapezoids, and at the ends two triangles up to where the half-angle lines meet.
    assert_near(found.refined, 2.0 * 9.0 + 2.0 * 0.1 * 0.05 / 2.0);
    assert_near(found.exact, 1.0);
}

#[test]
fn a_closed_cut_is_no_border() {
    // Six triangles lie flat: both copies of the cut coincide.
    let strips = alone(fan(6));
    let d_m = 0.3;
    let hexagon = 6.0 * 3f64.sqrt() / 4.0;
    let found = irregularity(&strips, d_m, 1e-9);
    // Half-angles of 60 degrees at all corners, also at the one that the cut splits.
    let ring = 6.0 * d_m * (1.0 - d_m / 3f64.sqrt());
    assert_near(found.bound, 6.0 * d_m / hexagon);
    assert_near(found.refined, ring / hexagon);
    assert_exact(found, ring / hexagon);
}

#[test]
fn an_open_cut_is_a_border_with_a_concave_tip() {
    // Five triangles leave a wedge of 60 degrees whose tip has 300 degrees inside.
    let strips = alone(fan(5));
    let d_m = 0.2;
    let area = 5.0 * 3f64.sqrt() / 4.0;
    let square = d_m * d_m;
    let root = 3f64.sqrt();
    let found = irregularity(&strips, d_m, 1e-9);
    // Four corners of 120 degrees, two of 60, and the tip.
    let zone = 7.0 * d_m - square * (4.0 / root + 2.0 * root) + square * (2.0 * PI / 3.0) / 2.0;
    assert_near(found.bound, (7.0 * d_m + 2.0 * square) / area);
    assert_near(found.refined, zone / area);
    assert_exact(found, zone / area);
    // With a tolerance wider than the gap, which is 1 at the rim, only the rim is left, and its corner at the cut
    // has twice 60 degrees.
    let found = irregularity(&strips, d_m, 1.01);
    assert_near(found.bound, 5.0 * d_m / area);
    assert_near(found.refined, 5.0 * d_m * (1.0 - d_m / root) / area);
}

#[test]
fn the_tip_of_an_overlap_has_more_than_a_full_turn() {
    // Seven triangles overlap by one: 420 degrees inside at the tip, which the plane shows as 60.
    let d_m = 0.2;
    let area = 7.0 * 3f64.sqrt() / 4.0;
    let square = d_m * d_m;
    let root = 3f64.sqrt();
    let found = irregularity(&alone(fan(7)), d_m, 1e-9);
    let tip = square * (7.0 * PI / 3.0 - PI) / 2.0;
    assert_near(found.bound, (9.0 * d_m + 2.0 * square) / area);
    assert_near(found.refined, (9.0 * d_m - square * (6.0 / root + 2.0 * root) + tip) / area);
    assert_exact(found, (9.0 * d_m - square * (6.0 / root + 2.0 * root) + tip) / area);
}

#[test]
fn an_edge_over_another_sheet_does_not_count_there() {
    // Ten triangles wind around by 600 degrees: the cut's copies lie over the inside of the other turn.
    let d_m = 0.2;
    let found = irregularity(&alone(fan(10)), d_m, 1e-9);
    let area = 10.0 * 3f64.sqrt() / 4.0;
    let square = d_m * d_m;
    let root = 3f64.sqrt();
    // The two perpendiculars at the tip leave 420 degrees of a disc between them.
    let zone = 12.0 * d_m - square * (9.0 / root + 2.0 * root) + square * (7.0 * PI / 3.0) / 2.0;
    assert_near(found.refined, zone / area);
    assert_exact(found, zone / area);
}

/// A box with a slit that is open as far as its middle and closed from there to its end.
fn half_closed_slit() -> Strip {
    let vertices = [
        dvec2(0.0, 2.0), // 0 to 3: the box
        dvec2(3.0, 2.0),
        dvec2(3.0, 0.0),
        dvec2(0.0, 0.0),
        dvec2(0.0, 1.2), // 4, 5: the mouth
        dvec2(0.0, 0.8),
        dvec2(1.0, 1.0), // 6, 7: the middle, twice
        dvec2(1.0, 1.0),
        dvec2(2.0, 1.0), // 8: the end
    ];
    let corners = [[4, 6, 0], [6, 8, 0], [8, 1, 0], [8, 2, 1], [8, 3, 2], [8, 7, 3], [7, 5, 3]];
    strip(&vertices, &corners, &[([4, 6], [7, 5]), ([6, 8], [8, 7])])
}

#[test]
fn a_slit_ends_where_it_closes() {
    let strip = half_closed_slit();
    let d_m = 0.3;
    let slit = 2.0 * (1.0 + 0.04f64).sqrt();
    let length = 3.0 * 2.0 + 2.0 + 2.0 * 0.8 + slit;
    let strips = alone(strip);
    let found = irregularity(&strips, d_m, 0.1);
    // One concave corner: the tip at the middle, of both copies together.
    assert_near(found.bound, (length * d_m + 2.0 * d_m * d_m) / strips.strips[0].area);
    // With no tolerance the closed part is still closed: its gap is exactly 0.
    assert_eq!(irregularity(&strips, d_m, 0.0), found);
    // With the whole slit closed both corners of its mouth become one, of a little more than 180 degrees.
    let wide = irregularity(&strips, d_m, 0.5);
    assert_near(wide.bound, ((length - slit) * d_m + 2.0 * d_m * d_m) / strips.strips[0].area);
    for (tolerance, exact) in [(0.1, found.exact), (0.5, wide.exact)] {
        let counted = counted(&strips.strips[0], d_m, tolerance);
        assert!((exact - counted).abs() < 5e-3, "{exact}, counted {counted}");
    }
}

#[test]
fn where_the_border_touches_itself_each_corner_has_its_own_angle() {
    // Two squares that share one planar vertex.
    let vertices = [
        dvec2(0.0, 0.0),
        dvec2(1.0, 0.0),
        dvec2(1.0, 1.0),
        dvec2(0.0, 1.0),
        dvec2(2.0, 1.0),
        dvec2(2.0, 2.0),
        dvec2(1.0, 2.0),
    ];
    let strips = alone(strip(&vertices, &[[0, 1, 2], [0, 2, 3], [2, 4, 5], [2, 5, 6]], &[]));
    let found = irregularity(&strips, 0.25, 0.0);
    assert_near(found.bound, 1.0);
    assert_near(found.refined, 0.75);
}

#[test]
fn nothing_is_open_or_there_is_nothing() {
    let none = Irregularity { bound: 0.0, refined: 0.0, exact: 0.0, undecided: 0.0 };
    assert_eq!(irregularity(&Strips { strips: Vec::new(), places: Vec::new() }, 1.0, 0.0), none);
    assert_eq!(irregularity(&alone(rectangle(1.0, 1.0)), 1.0, f64::INFINITY), none);
}

#[test]
fn copies_that_differ_by_rounding_do_not_stall_the_subdivision() {
    // Both copies of the cut count as open although they coincide up to rounding.
    let mut strip = fan(6);
    strip.vertices[7] += dvec2(0.0, 1e-15);
    let counted = counted(&strip, 0.1, 0.0);
    let found = irregularity(&alone(strip), 0.1, 0.0);
    assert!((found.exact - counted).abs() < 5e-3, "{}, counted {counted}", found.exact);
}

#[test]
fn on_unfolded_shapes_the_three_agree_for_dense_points_and_keep_their_order() {
    for soup in [shapes::uv_sphere(20, 20), shapes::cup(1), shapes::torus(24, 12, 0.3)] {
        let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default()).expect("a valid shape");
        let strips = unfold(&mesh, &segment(&mesh, &SegmentOptions::default()));
        for points in [50.0, 500.0, 5e3, 5e4, 5e7] {
            let d_m = (mesh.area() / points).sqrt();
            let found = irregularity(&strips, d_m, 0.1 * d_m);
            assert!(found.exact <= found.bound.min(1.0) + 0.5e-4, "{points}: {found:?}");
            assert!(found.refined <= found.bound, "{points}: {found:?}");
        }
        // Far below the length of an edge the zones of edges meet at corners only, where they share.
        let d_m = (mesh.area() / 5e7).sqrt();
        let found = irregularity(&strips, d_m, 0.1 * d_m);
        assert!((found.exact / found.refined - 1.0).abs() < 0.02, "{found:?}");
    }
}

/// A polygon around (2, 2) with its corners in all directions at these distances; (2, 2) is a planar vertex.
fn star(radii: &[f64]) -> Strip {
    let centre = dvec2(2.0, 2.0);
    let count = radii.len() as u32;
    let mut vertices = vec![centre];
    vertices.extend(radii.iter().enumerate().map(|(i, r)| {
        let (sin, cos) = libm::sincos(2.0 * PI * i as f64 / radii.len() as f64);
        centre + dvec2(cos, sin) * *r
    }));
    let corners: Vec<_> = (0..count).map(|i| [0, i + 1, (i + 1) % count + 1]).collect();
    strip(&vertices, &corners, &[])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn exact_agrees_with_counting(radii in prop::collection::vec(0.1f64..2.0, 3..14), d_m in 0.01f64..1.5) {
        let strip = star(&radii);
        let counted = counted(&strip, d_m, 0.0);
        let found = irregularity(&alone(strip), d_m, 0.0);
        prop_assert!((found.exact - counted).abs() < 1e-2, "{} counted {counted}", found.exact);
    }

    #[test]
    fn eq_8_bounds_the_others(radii in prop::collection::vec(0.1f64..2.0, 3..14), d_m in 0.01f64..1.5) {
        let found = irregularity(&alone(star(&radii)), d_m, 0.0);
        prop_assert!(found.refined <= found.bound * (1.0 + 1e-12));
        prop_assert!(found.exact <= found.bound + 0.5e-4);
        prop_assert!(found.exact > 0.0 && found.exact <= 1.0);
    }

    #[test]
    fn the_covered_part_of_a_triangle_is_found(
        points in prop::array::uniform5((-2.0f64..2.0, -2.0f64..2.0)),
        radius in 0.05f64..2.0,
    ) {
        let [a, b, c, from, to] = points.map(|(x, y)| dvec2(x, y));
        let triangle = if (b - a).perp_dot(c - a) > 0.0 { [a, b, c] } else { [a, c, b] };
        let segment = super::capsule::Segment { from, to };
        let found = super::capsule::covered_area(&triangle, &segment, radius);
        let side = 300;
        let mut count = 0usize;
        for i in 0..side {
            for j in 0..side {
                let p = dvec2(i as f64 + 0.5, j as f64 + 0.5) * 4.0 / side as f64 - 2.0;
                let [a, b, c] = triangle;
                count += usize::from(triangle_holds(a, b, c, p) && segment.distance(p) <= radius);
            }
        }
        let counted = count as f64 * 16.0 / (side * side) as f64;
        prop_assert!((found - counted).abs() < 0.06, "{found} counted {counted}");
    }
}
