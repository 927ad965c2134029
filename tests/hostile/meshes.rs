//! Meshes that are broken or extreme, whatever file they come from.

use glam::{DVec3, dvec3};
use ldwrap::PolygonSoup;
use ldwrap::shapes::Shape;

use crate::table::{Case, Expected};

const POINTS: Expected = Expected::Points;

fn soup(positions: &[[f64; 3]], polygons: &[&[u32]]) -> PolygonSoup {
    let mut soup =
        PolygonSoup { positions: positions.iter().map(|&p| p.into()).collect(), ..PolygonSoup::default() };
    polygons.iter().for_each(|polygon| soup.push_polygon(polygon));
    soup
}

/// A cube of 12 triangles.
fn cube() -> PolygonSoup {
    ldwrap::shapes::cube(1)
}

/// A cube with its corners moved.
fn moved(f: impl Fn(DVec3) -> DVec3) -> PolygonSoup {
    let mut soup = cube();
    soup.positions.iter_mut().for_each(|p| *p = f(*p));
    soup
}

/// A cube with more polygons of its vertices.
fn with(polygons: &[&[u32]]) -> PolygonSoup {
    let mut soup = cube();
    polygons.iter().for_each(|polygon| soup.push_polygon(polygon));
    soup
}

/// Two soups as one.
fn both(a: PolygonSoup, b: &PolygonSoup) -> PolygonSoup {
    let mut soup = a;
    let first = soup.positions.len() as u32;
    soup.positions.extend(&b.positions);
    for polygon in 0..b.polygon_count() {
        let corners: Vec<u32> = b.polygon(polygon).iter().map(|&corner| corner + first).collect();
        soup.push_polygon(&corners);
    }
    soup
}

/// Triangles that touch nowhere.
pub(crate) fn components(count: u32) -> Case {
    let mut soup = PolygonSoup::default();
    for i in 0..count {
        let at = dvec3(f64::from(i % 1000) * 3.0, f64::from(i / 1000) * 3.0, 0.0);
        soup.positions.extend([at, at + DVec3::X, at + DVec3::Y]);
        soup.push_polygon(&[3 * i, 3 * i + 1, 3 * i + 2]);
    }
    Case::soup(&format!("{count} components"), soup, POINTS)
}

/// A tetrahedron that is so many times as long as wide, in a direction that is no axis.
fn long(aspect: f64) -> PolygonSoup {
    let along = dvec3(0.6, 0.48, 0.64) * aspect;
    let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, along].map(|p| p.to_array());
    soup(&positions, &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]])
}

/// A strip of triangles that are so many times as long as wide.
fn slivers(aspect: f64) -> PolygonSoup {
    let count = 100;
    let positions: Vec<[f64; 3]> =
        (0..=count).flat_map(|i| [[f64::from(i), 0.0, 0.0], [f64::from(i), aspect, 0.0]]).collect();
    let mut soup = soup(&positions, &[]);
    for i in 0..count as u32 {
        soup.push_polygon(&[2 * i, 2 * i + 2, 2 * i + 1]);
        soup.push_polygon(&[2 * i + 1, 2 * i + 2, 2 * i + 3]);
    }
    soup
}

/// A polygon with its corners on a circle, every `step`-th after the other.
fn polygon(corners: u32, step: u32) -> PolygonSoup {
    let place = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(corners);
        [angle.cos(), angle.sin(), 0.0].map(|x| (x * 65536.0).round() / 65536.0)
    };
    let positions: Vec<[f64; 3]> = (0..corners).map(place).collect();
    let order: Vec<u32> = (0..corners).map(|i| i * step % corners).collect();
    soup(&positions, &[&order])
}

const TRIANGLE: [[f64; 3]; 3] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

pub(crate) fn cases() -> Vec<Case> {
    let case = Case::soup;
    let mut cases = vec![
        case("one triangle", soup(&TRIANGLE, &[&[0, 1, 2]]), POINTS),
        case("no vertex and no face", PolygonSoup::default(), Expected::Error("no face")),
        case("vertices without a face", soup(&TRIANGLE, &[]), Expected::Error("no face")),
        case("a face of two corners", soup(&TRIANGLE, &[&[0, 1]]), Expected::Error("has an area")),
        case("a face without corners", soup(&TRIANGLE, &[&[]]), Expected::Error("has an area")),
        case(
            "three corners on a line",
            soup(&[[0.0; 3], [1.0; 3], [2.0; 3]], &[&[0, 1, 2]]),
            Expected::Error("has an area"),
        ),
        case("a cube, and faces without area", with(&[&[0, 0, 1], &[0, 1], &[2, 2, 2], &[]]), POINTS),
        case(
            "a cube with NaN for a coordinate",
            moved(|p| p * if p.x > 0.0 { f64::NAN } else { 1.0 }),
            Expected::Error("finite"),
        ),
        case(
            "a cube with an infinite coordinate",
            moved(|p| if p.x > 0.0 { p.with_y(f64::NEG_INFINITY) } else { p }),
            Expected::Error("finite"),
        ),
        case("a corner that names no vertex", with(&[&[0, 1, 99]]), Expected::Error("vertex 99")),
        case(
            "a corner that names vertex 4,294,967,295",
            with(&[&[0, 1, u32::MAX]]),
            Expected::Error("vertex 4294967295"),
        ),
        case(
            "ends of polygons that do not ascend",
            PolygonSoup { ends: vec![3, 0], ..soup(&TRIANGLE, &[&[0, 1, 2]]) },
            Expected::Error("end before they start"),
        ),
        case("every face of a cube twice", both(cube(), &cube()), POINTS),
        case(
            "every face of a cube twice, the second time turned over",
            {
                let mut twice = cube();
                for polygon in 0..cube().polygon_count() {
                    let corners: Vec<u32> = cube().polygon(polygon).iter().rev().copied().collect();
                    twice.push_polygon(&corners);
                }
                twice
            },
            POINTS,
        ),
        case(
            "an edge of three triangles",
            soup(
                &[[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, -1.0, 0.0]],
                &[&[0, 1, 2], &[0, 1, 3], &[0, 1, 4]],
            ),
            POINTS,
        ),
        case(
            "a thousand triangles on one edge",
            {
                let mut fan = soup(&[[0.0; 3], [0.0, 0.0, 1.0]], &[]);
                for i in 0..1000u32 {
                    fan.positions.push(dvec3(f64::from(i) - 500.0, 10.0, 0.0));
                    fan.push_polygon(&[0, 1, i + 2]);
                }
                fan
            },
            POINTS,
        ),
        case("two cubes that share a corner only", both(cube(), &moved(|p| p + 1.0)), POINTS),
        case("two cubes that cross each other", both(cube(), &moved(|p| p + 0.3)), POINTS),
        case(
            "a polygon of four corners that crosses itself",
            soup(&[[0.0; 3], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]], &[&[0, 1, 2, 3]]),
            POINTS,
        ),
        case("a star of 101 corners that crosses itself", polygon(101, 50), POINTS),
        case("a polygon of 1,000 corners", polygon(1_000, 1), POINTS),
        case(
            "a polygon that comes back to a corner",
            soup(&[[0.0; 3], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 1.0]], &[&[0, 1, 2, 0, 3, 2]]),
            POINTS,
        ),
        case(
            "a cube with one face wound against the others",
            {
                let mut turned = cube();
                turned.corners[0..3].reverse();
                turned
            },
            POINTS,
        ),
        case("a cube wound inward", moved(|p| p.with_x(-p.x)), POINTS),
        case(
            "a cube, and 1,000 vertices of no face",
            {
                let mut more = cube();
                more.positions.extend((0..1000).map(|i| DVec3::splat(f64::from(i))));
                more
            },
            POINTS,
        ),
        case(
            "a triangle of 1 beside one of 1e-9",
            both(soup(&TRIANGLE, &[&[0, 1, 2]]), &{
                let mut small = soup(&TRIANGLE, &[&[0, 1, 2]]);
                small.positions.iter_mut().for_each(|p| *p = *p * 1e-9 + 2.0);
                small
            }),
            POINTS,
        ),
        case(
            "a triangle of 1e30 beside one of 1e-30",
            both(soup(&TRIANGLE.map(|p| p.map(|x| x * 1e30)), &[&[0, 1, 2]]), &{
                let mut small = soup(&TRIANGLE, &[&[0, 1, 2]]);
                small.positions.iter_mut().for_each(|p| *p *= 1e-30);
                small
            }),
            POINTS,
        ),
        components(100_000),
    ];
    for exponent in [-70, -59, -30, 30, 59, 70, 300] {
        let unit = format!("1e{exponent}").parse::<f64>().expect("a number");
        let expected = match exponent {
            -70 => Expected::Error("too small"),
            70.. => Expected::Error("too large"),
            _ => POINTS,
        };
        cases.push(case(&format!("a cube of 1e{exponent}"), moved(|p| p * unit), expected));
    }
    for distance in [1e6, 1e12, 1e14] {
        cases.push(case(&format!("a cube {distance:e} from the origin"), moved(|p| p + distance), POINTS));
    }
    cases.push(case("a cube 1e17 from the origin", moved(|p| p + 1e17), Expected::Error("has an area")));
    for aspect in [1e3, 1e6, 1e9, 1e12] {
        let needle = soup(&[[0.0; 3], [1.0, 0.0, 0.0], [0.3, 1.0 / aspect, 0.0]], &[&[0, 1, 2]]);
        cases.push(case(&format!("one triangle {aspect:e} times as long as wide"), needle, POINTS));
        cases.push(case(&format!("a tetrahedron {aspect:e} times as long as wide"), long(aspect), POINTS));
        // The domain is a square of the length of the longest part.
        let expected = if aspect < 1e12 { POINTS } else { Expected::Error("too many") };
        let what = format!("200 triangles side by side, {aspect:e} times as long as wide");
        cases.push(case(&what, slivers(aspect), expected));
    }
    cases.push(case(
        "a sphere with its poles drawn out to 1e6",
        {
            let mut drawn = Shape::Sphere.generate_about(2_000);
            drawn.positions.iter_mut().filter(|p| p.z.abs() > 0.999).for_each(|p| p.z *= 1e6);
            drawn
        },
        POINTS,
    ));
    cases
}
