//! Cameras of the two views, as plain mathematics: what is seen, and how gestures move it.

use glam::camera::rh::proj::opengl;
use glam::camera::rh::view::look_at_mat4;
use glam::{Mat4, Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// Which axis of the mesh points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Up {
    /// As in glTF and most scans.
    #[default]
    Y,
    /// As in the built-in shapes and most programs for construction.
    Z,
}

impl Up {
    /// The axis.
    pub fn axis(self) -> Vec3 {
        match self {
            Self::Y => Vec3::Y,
            Self::Z => Vec3::Z,
        }
    }

    /// The horizontal axis that looks at the viewer when not turned.
    fn front(self) -> Vec3 {
        match self {
            Self::Y => Vec3::Z,
            Self::Z => Vec3::NEG_Y,
        }
    }
}

/// A perspective camera that circles a target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orbit {
    /// What it looks at.
    pub target: Vec3,
    /// How far away it is.
    pub distance: f32,
    /// The angle around the vertical axis, in radians.
    pub yaw: f32,
    /// The angle above the horizon, in radians.
    pub pitch: f32,
    /// The radius of what is looked at: sets the near and far planes.
    pub radius: f32,
    /// What points up.
    pub up: Up,
}

/// The height of the field of view, in radians.
const FIELD: f32 = 0.6;
/// Just short of straight up and down, where "up" would be lost.
const STEEPEST: f32 = 1.55;

impl Orbit {
    /// Looks at a ball so that it fills the view.
    pub fn around(target: Vec3, radius: f32, up: Up) -> Self {
        let radius = radius.max(f32::MIN_POSITIVE);
        Self { target, distance: 1.08 * radius / (0.5 * FIELD).sin(), yaw: 0.6, pitch: 0.35, radius, up }
    }

    /// The direction from the target to the eye.
    pub fn backward(&self) -> Vec3 {
        let (sp, cp) = self.pitch.sin_cos();
        let (sy, cy) = self.yaw.sin_cos();
        cp * sy * Vec3::X + sp * self.up.axis() + cp * cy * self.up.front()
    }

    /// Where the eye is.
    pub fn eye(&self) -> Vec3 {
        self.target + self.distance * self.backward()
    }

    /// The view's axes: right and up.
    pub fn axes(&self) -> (Vec3, Vec3) {
        let back = self.backward();
        let right = self.up.axis().cross(back).normalize_or(Vec3::X);
        (right, back.cross(right))
    }

    /// From the units of the mesh to the clip space of a view `aspect` times as wide as high.
    pub fn matrix(&self, aspect: f32) -> Mat4 {
        let near = (self.distance - 2.0 * self.radius).max(0.01 * self.radius);
        let far = self.distance + 2.0 * self.radius;
        // In a view higher than wide the width is what must hold the object.
        let field = if aspect < 1.0 { 2.0 * ((0.5 * FIELD).tan() / aspect).atan() } else { FIELD };
        let eye = self.eye();
        opengl::perspective(field, aspect, near, far) * look_at_mat4(eye, self.target, self.axes().1)
    }

    /// The ray through a place of the view, given in clip space (-1 to 1, y up): origin and direction.
    pub fn ray(&self, aspect: f32, clip: Vec2) -> (Vec3, Vec3) {
        let inverse = self.matrix(aspect).inverse();
        let far = inverse.project_point3(clip.extend(1.0));
        let eye = self.eye();
        (eye, (far - eye).normalize_or(-self.backward()))
    }

    /// How much of the plane through the target the view shows from top to bottom, in units of the mesh.
    pub fn height(&self) -> f32 {
        2.0 * self.distance * (0.5 * FIELD).tan()
    }

    /// Turns by a drag, in shares of the view's height.
    pub fn turn(&mut self, drag: Vec2) {
        self.yaw -= 4.0 * drag.x;
        self.pitch = (self.pitch + 4.0 * drag.y).clamp(-STEEPEST, STEEPEST);
    }

    /// Shifts what is looked at by a drag, in shares of the view's height.
    pub fn pan(&mut self, drag: Vec2) {
        let (right, up) = self.axes();
        self.target += self.height() * (drag.y * up - drag.x * right);
    }

    /// Comes nearer (factor above 1) or goes away.
    pub fn zoom(&mut self, factor: f32) {
        self.distance = (self.distance / factor).clamp(0.05 * self.radius, 50.0 * self.radius);
    }
}

/// The view of the plane: a place of the plane in the middle, and a scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneView {
    /// The place of the plane in the middle of the view.
    pub centre: Vec2,
    /// Half the height of what is seen, in units of the mesh.
    pub half_height: f32,
}

impl PlaneView {
    /// Shows the box from (0, 0) to `extent` in a view `aspect` times as wide as high.
    pub fn fit(extent: Vec2, aspect: f32) -> Self {
        let half_height = 0.53 * extent.y.max(extent.x / aspect.max(0.01));
        Self { centre: 0.5 * extent, half_height: half_height.max(f32::MIN_POSITIVE) }
    }

    /// From the plane to clip space; z is left as it is.
    pub fn matrix(&self, aspect: f32) -> Mat4 {
        let scale = Vec2::new(1.0 / (self.half_height * aspect), 1.0 / self.half_height);
        Mat4::from_scale(scale.extend(1.0)) * Mat4::from_translation((-self.centre).extend(0.0))
    }

    /// The place of the plane at a place of the view in clip space.
    pub fn place(&self, aspect: f32, clip: Vec2) -> Vec2 {
        self.centre + self.half_height * clip * Vec2::new(aspect, 1.0)
    }

    /// Shifts by a drag, in shares of the view's height.
    pub fn pan(&mut self, drag: Vec2) {
        self.centre += 2.0 * self.half_height * Vec2::new(-drag.x, drag.y);
    }

    /// Zooms so that the place under the cursor (in clip space) stays there.
    pub fn zoom(&mut self, aspect: f32, clip: Vec2, factor: f32) {
        let fixed = self.place(aspect, clip);
        self.half_height /= factor;
        self.centre += fixed - self.place(aspect, clip);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_target_is_in_the_middle_and_the_ball_in_the_view() {
        let orbit = Orbit::around(Vec3::new(1.0, 2.0, 3.0), 2.0, Up::Z);
        for aspect in [0.5, 1.0, 2.0] {
            let matrix = orbit.matrix(aspect);
            let clip = matrix.project_point3(orbit.target);
            assert!(clip.truncate().length() < 1e-5, "{clip}");
            let (right, up) = orbit.axes();
            for side in [right, -right, up, -up] {
                let edge = matrix.project_point3(orbit.target + 2.0 * side);
                assert!(edge.abs().max_element() <= 1.0, "{aspect}: {edge}");
            }
        }
    }

    #[test]
    fn a_ray_goes_through_what_is_seen_there() {
        let orbit = Orbit { yaw: 2.0, pitch: -0.7, ..Orbit::around(Vec3::ONE, 3.0, Up::Y) };
        let point = Vec3::new(1.5, 0.2, 2.0);
        let clip = orbit.matrix(1.5).project_point3(point);
        let (eye, direction) = orbit.ray(1.5, clip.truncate());
        assert!((point - eye).cross(direction).length() < 1e-3);
    }

    #[test]
    fn zooming_keeps_the_place_under_the_cursor() {
        let mut view = PlaneView::fit(Vec2::new(4.0, 2.0), 1.5);
        let clip = Vec2::new(0.3, -0.8);
        let before = view.place(1.5, clip);
        view.zoom(1.5, clip, 1.7);
        assert!((view.place(1.5, clip) - before).length() < 1e-5);
        let back = view.matrix(1.5).project_point3(before.extend(0.0));
        assert!((back.truncate() - clip).length() < 1e-5);
    }
}
