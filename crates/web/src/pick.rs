//! What lies under the pointer: triangles by ray and in the plane, points by their distance on the screen.

use glam::{Mat4, Vec2, Vec3};

use crate::scene::{Layout, MeshScene, RunScene};

/// A thing that can be pointed at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pick {
    /// The triangle.
    pub face: u32,
    /// The point, when one is near.
    pub point: Option<u32>,
}

/// How near to a point the pointer must be, in shares of the view's height.
const REACH: f32 = 0.012;

/// The nearest triangle that a ray meets, and how far away. Linear in the triangles: 0.5 ms for 100,000.
pub fn triangle_on_ray(mesh: &MeshScene, origin: Vec3, direction: Vec3) -> Option<(u32, f32)> {
    let mut nearest: Option<(u32, f32)> = None;
    for (face, corners) in (0..).zip(mesh.corners.chunks_exact(3)) {
        let limit = nearest.map_or(f32::INFINITY, |(_, t)| t);
        if let Some(t) = meet(origin, direction, [corners[0], corners[1], corners[2]])
            && t < limit
        {
            nearest = Some((face, t));
        }
    }
    nearest
}

/// How far along a ray it meets a triangle (Moeller and Trumbore 1997, DOI 10.1080/10867651.1997.10487468).
fn meet(origin: Vec3, direction: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let s = (origin - a) / determinant;
    let u = s.dot(p);
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = s.cross(ab);
    let v = direction.dot(q);
    let t = ac.dot(q);
    (v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

/// A view and the place in it that is pointed at.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// From space, or from the plane, to clip space.
    pub matrix: Mat4,
    /// The view's width over its height.
    pub aspect: f32,
    /// The place, in clip space.
    pub clip: Vec2,
}

/// What a ray through the surface view points at.
pub fn on_surface(
    mesh: &MeshScene,
    run: Option<&RunScene>,
    eye: Vec3,
    direction: Vec3,
    seen: &Seen,
) -> Option<Pick> {
    let (face, distance) = triangle_on_ray(mesh, eye, direction)?;
    let hit = eye + distance * direction;
    // Points behind the surface under the pointer are out of sight: only those about as near as the hit count.
    let margin = 0.03 * mesh.radius;
    let near = |p: &Vec3| (*p - eye).length() <= (hit - eye).length() + margin;
    let point = run.and_then(|run| {
        let places = run
            .points
            .iter()
            .map(|p| near(&p.position).then(|| seen.matrix.project_point3(p.position).truncate()));
        nearest_point(places, seen.aspect, seen.clip)
    });
    let face = point.zip(run).map_or(face, |(point, run)| run.points[point as usize].face);
    Some(Pick { face, point })
}

/// What a place of the planar view points at.
pub fn in_plane(run: &RunScene, layout: Layout, place: Vec2, seen: &Seen) -> Option<Pick> {
    let places = (0..run.points.len())
        .map(|i| Some(seen.matrix.project_point3(run.planar_point(layout, i).extend(0.0)).truncate()));
    if let Some(point) = nearest_point(places, seen.aspect, seen.clip) {
        return Some(Pick { face: run.points[point as usize].face, point: Some(point) });
    }
    let face =
        (0..run.strip_of.len() as u32).find(|&face| holds(run.planar_triangle(layout, face), place))?;
    Some(Pick { face, point: None })
}

/// The nearest within reach of points given in clip space; hidden ones are `None`.
fn nearest_point(places: impl Iterator<Item = Option<Vec2>>, aspect: f32, clip: Vec2) -> Option<u32> {
    let mut nearest: Option<(u32, f32)> = None;
    for (index, place) in (0..).zip(places) {
        let Some(place) = place else { continue };
        let distance = (0.5 * (place - clip) * Vec2::new(aspect, 1.0)).length();
        if distance < nearest.map_or(REACH, |(_, d)| d) {
            nearest = Some((index, distance));
        }
    }
    nearest.map(|(index, _)| index)
}

/// Whether a triangle, wound either way, holds a place.
fn holds([a, b, c]: [Vec2; 3], place: Vec2) -> bool {
    let left = |p: Vec2, q: Vec2| (q - p).perp_dot(place - p);
    let sides = [left(a, b), left(b, c), left(c, a)];
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_a_triangle_only_inside_and_ahead() {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let down = Vec3::NEG_Z;
        assert_eq!(meet(Vec3::new(0.2, 0.2, 2.0), down, triangle), Some(2.0));
        assert_eq!(meet(Vec3::new(0.7, 0.7, 2.0), down, triangle), None);
        assert_eq!(meet(Vec3::new(0.2, 0.2, -2.0), down, triangle), None);
        assert_eq!(meet(Vec3::new(0.2, 0.2, 2.0), Vec3::X, triangle), None);
    }

    #[test]
    fn a_triangle_holds_its_inside_whichever_way_it_is_wound() {
        let [a, b, c] = [Vec2::ZERO, Vec2::X, Vec2::Y];
        for triangle in [[a, b, c], [a, c, b]] {
            assert!(holds(triangle, Vec2::splat(0.3)));
            assert!(!holds(triangle, Vec2::splat(0.6)));
        }
    }

    #[test]
    fn the_nearest_point_within_reach_is_taken() {
        let places =
            [Some(Vec2::new(0.5, 0.0)), None, Some(Vec2::new(0.01, 0.0)), Some(Vec2::new(0.004, 0.0))];
        assert_eq!(nearest_point(places.into_iter(), 1.0, Vec2::ZERO), Some(3));
        assert_eq!(nearest_point(places.into_iter(), 1.0, Vec2::new(-0.5, 0.0)), None);
    }
}
