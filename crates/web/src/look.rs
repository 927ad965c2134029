//! What a camera sees: the visible share of the surface against the visible share of the points, the paper's purpose.

use glam::{DVec3, Mat4, Vec2, Vec3};
use ldwrap::baseline::hilbert;
use ldwrap::spatial::{Camera, Caster};
use ldwrap::{FaceId, SurfaceMesh, SurfacePoint};
use serde::{Deserialize, Serialize};

/// An obstacle before the camera: a box of the picture, in clip space (-1 to 1, y up).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Occluder {
    /// Its lower left corner.
    pub low: Vec2,
    /// Its upper right corner.
    pub high: Vec2,
}

impl Occluder {
    fn hides(&self, clip: Vec2) -> bool {
        clip.cmpge(self.low).all() && clip.cmple(self.high).all()
    }
}

/// A camera and an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Looking {
    /// Where the eye is.
    pub eye: Vec3,
    /// From space to clip space.
    pub matrix: Mat4,
    /// What stands in the way.
    pub occluder: Option<Occluder>,
}

/// What was seen, in shares from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Look {
    /// The visible share of the surface.
    pub surface: f64,
    /// The visible share of the points of A and of B, where they hold points.
    pub points: [Option<f64>; 2],
}

/// The places that stand for the surface: enough for an error of about 0.1 %, few enough for thirty looks a second.
const PLACES: usize = 20_000;

/// Casts rays on a mesh.
pub struct Looker {
    caster: Caster,
    places: Vec<(FaceId, DVec3)>,
}

impl Looker {
    /// Prepares a mesh.
    pub fn new(mesh: &SurfaceMesh) -> Self {
        let places = hilbert(mesh, PLACES, 1).iter().map(|p| (p.face, mesh.locate(p))).collect();
        Self { caster: Caster::new(mesh), places }
    }

    /// Finds what a camera sees.
    pub fn look(&self, mesh: &SurfaceMesh, points: [Option<&[SurfacePoint]>; 2], looking: &Looking) -> Look {
        let camera = Camera::Perspective { eye: looking.eye.as_dvec3() };
        let is_visible = |face: FaceId, at: DVec3| {
            let hidden = looking
                .occluder
                .is_some_and(|o| o.hides(looking.matrix.project_point3(at.as_vec3()).truncate()));
            !hidden && self.caster.sees(&camera, face, at)
        };
        let share = |seen: usize, all: usize| seen as f64 / all.max(1) as f64;
        let seen = self.places.iter().filter(|(face, at)| is_visible(*face, *at)).count();
        let points = points.map(|points| {
            let points = points?;
            let seen = points.iter().filter(|p| is_visible(p.face, mesh.locate(p))).count();
            Some(share(seen, points.len()))
        });
        Look { surface: share(seen, self.places.len()), points }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Orbit, Up};
    use crate::source::Source;
    use ldwrap::shapes::Shape;

    #[test]
    fn a_far_camera_sees_half_a_sphere_and_an_obstacle_hides_the_rest() {
        let (mesh, _) = Source::Shape(Shape::Sphere).load().unwrap();
        let looker = Looker::new(&mesh);
        let (low, high) = mesh.bounds();
        let mut orbit =
            Orbit::around((0.5 * (low + high)).as_vec3(), (0.5 * low.distance(high)) as f32, Up::Y);
        orbit.zoom(0.02);
        let points = hilbert(&mesh, 500, 2);
        let mut looking = Looking { eye: orbit.eye(), matrix: orbit.matrix(1.0), occluder: None };
        let look = looker.look(&mesh, [Some(&points), None], &looking);
        assert!((look.surface - 0.5).abs() < 0.03, "{}", look.surface);
        assert!((look.points[0].unwrap() - look.surface).abs() < 0.05);
        assert_eq!(look.points[1], None);
        looking.occluder = Some(Occluder { low: Vec2::splat(-1.0), high: Vec2::splat(1.0) });
        let look = looker.look(&mesh, [Some(&points), None], &looking);
        assert_eq!((look.surface, look.points[0]), (0.0, Some(0.0)));
    }
}
