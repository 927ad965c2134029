//! Which axis of a mesh points up: files seldom say, so it is guessed, said, and easily turned.

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::camera::Up;

/// Why an axis is taken to point up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Because {
    /// The built-in shapes are made so.
    Made,
    /// The format says so.
    Format,
    /// The mesh stands more firmly on that side.
    Stands,
    /// Nothing tells; most files of that format have it so.
    Usual,
}

impl Because {
    /// What a person reads.
    pub fn words(self) -> &'static str {
        match self {
            Self::Made => "as the shape is made",
            Self::Format => "as the format has it",
            Self::Stands => "a guess: it stands best so",
            Self::Usual => "a guess: most such files have it so",
        }
    }
}

/// What lies at most this share of the height above the lowest corner is what a mesh stands on.
const FOOT: f32 = 0.05;
/// How many times as firmly it must stand on one side as on the other.
const FIRMER: f32 = 1.5;

/// Guesses from a file's name and the corners of its triangles. glTF says that y is up. Otherwise a body is taken to
/// stand: its foot should fill much of its outline seen from above and carry its middle. Where both axes do that
/// about as well, STL is taken to have z up and all others y.
pub fn guess(name: &str, corners: &[Vec3]) -> (Up, Because) {
    let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase()).unwrap_or_default();
    if matches!(ending.as_str(), "gltf" | "glb") {
        return (Up::Y, Because::Format);
    }
    let [y, z] = [Up::Y, Up::Z].map(|up| firmness(corners, up));
    if z > FIRMER * y {
        (Up::Z, Because::Stands)
    } else if y > FIRMER * z {
        (Up::Y, Because::Stands)
    } else {
        (if ending == "stl" { Up::Z } else { Up::Y }, Because::Usual)
    }
}

/// How firmly a body stands with an axis up: the area of the convex hull of its foot over that of the box around it,
/// both seen from above; 0 when its middle is not above its foot.
fn firmness(corners: &[Vec3], up: Up) -> f32 {
    let flat = |p: Vec3| match up {
        Up::Y => Vec2::new(p.z, p.x),
        Up::Z => Vec2::new(p.x, p.y),
    };
    let height = |p: Vec3| p.dot(up.axis());
    let low = corners.iter().fold(f32::INFINITY, |m, p| m.min(height(*p)));
    let high = corners.iter().fold(f32::NEG_INFINITY, |m, p| m.max(height(*p)));
    let foot = hull(corners.iter().filter(|p| height(**p) <= low + FOOT * (high - low)).map(|p| flat(*p)));
    let (from, to) = corners
        .iter()
        .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(from, to), p| (from.min(flat(*p)), to.max(flat(*p))));
    let outline = (to - from).element_product();
    let sides = || foot.iter().zip(foot.iter().cycle().skip(1));
    let middle = middle(corners, flat);
    if outline <= 0.0 || foot.len() < 3 || sides().any(|(a, b)| (b - a).perp_dot(middle - a) < 0.0) {
        return 0.0;
    }
    0.5 * sides().map(|(a, b)| (a - from).perp_dot(b - from)).sum::<f32>() / outline
}

/// The middle of the surface, seen from above.
fn middle(corners: &[Vec3], flat: impl Fn(Vec3) -> Vec2) -> Vec2 {
    let (mut sum, mut area) = (Vec2::ZERO, 0.0);
    for triangle in corners.chunks_exact(3) {
        let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
        let weight = (b - a).cross(c - a).length();
        sum += weight * flat((a + b + c) / 3.0);
        area += weight;
    }
    sum / area.max(f32::MIN_POSITIVE)
}

/// The convex hull, counterclockwise (Andrew 1979, DOI 10.1016/0020-0190(79)90072-3).
fn hull(points: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
    let mut points: Vec<Vec2> = points.collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - a) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter().copied());
    all.extend(half(&mut points.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use ldwrap::FaceId;
    use ldwrap::shapes::Shape;

    fn corners(source: &Source) -> Vec<Vec3> {
        let (mesh, _) = source.load().unwrap();
        (0..mesh.face_count()).flat_map(|f| mesh.triangle(FaceId::new(f)).map(|p| p.as_vec3())).collect()
    }

    #[test]
    fn the_hull_of_a_square_with_points_inside_is_the_square() {
        let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]].map(Vec2::from);
        let inside = [[0.5, 0.5], [0.5, 0.0], [0.2, 0.9], [1.0, 1.0]].map(Vec2::from);
        assert_eq!(hull(square.into_iter().chain(inside)), square);
        assert!(hull([Vec2::ONE; 3].into_iter()).len() < 3);
    }

    #[test]
    fn a_cup_stands_on_its_bottom_whichever_way_its_file_turns_it() {
        let upright = corners(&Source::Shape(Shape::Cup));
        assert_eq!(guess("cup.obj", &upright), (Up::Z, Because::Stands));
        let turned: Vec<Vec3> = upright.iter().map(|p| Vec3::new(p.x, p.z, -p.y)).collect();
        assert_eq!(guess("cup.stl", &turned), (Up::Y, Because::Stands));
        assert_eq!(guess("cup.GLB", &upright), (Up::Y, Because::Format));
    }

    #[test]
    fn a_ball_lies_as_the_format_usually_has_it() {
        let ball = corners(&Source::Shape(Shape::Cube));
        assert_eq!(guess("cube.stl", &ball), (Up::Z, Because::Usual));
        assert_eq!(guess("cube.obj", &ball), (Up::Y, Because::Usual));
        assert_eq!(guess("none", &[]), (Up::Y, Because::Usual));
    }

    #[test]
    fn scanned_and_modelled_bodies_stand() {
        let Some(folder) = std::env::var_os("LDWRAP_MESHES").map(std::path::PathBuf::from) else {
            eprintln!("SKIPPED: LDWRAP_MESHES is not set");
            return;
        };
        for (name, up) in [
            ("horse.ply", Up::Z),
            ("stanford-bunny.obj", Up::Y),
            ("teapot.obj", Up::Y),
            ("suzanne.obj", Up::Y),
            ("fruit-drink-800.obj", Up::Z),
        ] {
            let bytes = std::fs::read(folder.join(name)).unwrap();
            let corners = corners(&Source::alone(name.into(), bytes));
            let firm = [Up::Y, Up::Z].map(|up| firmness(&corners, up));
            assert_eq!(guess(name, &corners).0, up, "{name}: {firm:?}");
        }
    }
}
