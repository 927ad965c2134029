//! Things in the way of a camera.

use glam::DVec2;

use super::Place;
use super::camera::Viewpoint;
use crate::random::Random;

/// The smallest and largest radius of a disc in the image, in radii of the sphere around the box of the mesh.
const RADII: [f64; 2] = [0.1, 0.6];

/// The largest number of discs at a time.
const MOST: usize = 3;

/// Discs between the camera and the mesh, parallel to the image: all that matters is where they are in it.
#[derive(Clone, Debug)]
pub(super) struct Occluders {
    discs: Vec<Disc>,
}

#[derive(Clone, Copy, Debug)]
struct Disc {
    middle: DVec2,
    squared_radius: f64,
}

impl Occluders {
    /// One to three discs around the images of random places, their radii uniform in logarithm. `None` without
    /// places.
    pub(super) fn random(viewpoint: &Viewpoint, places: &[Place], random: &mut Random) -> Option<Self> {
        if places.is_empty() {
            return None;
        }
        let count = 1 + random.below(MOST);
        let discs = (0..count)
            .map(|_| {
                let (_, place) = places[random.below(places.len())];
                let radius = viewpoint.radius * RADII[0] * libm::pow(RADII[1] / RADII[0], random.unit());
                Disc { middle: viewpoint.image(place), squared_radius: radius * radius }
            })
            .collect();
        Some(Self { discs })
    }

    /// Whether one of them hides what appears at this place of the image.
    pub(super) fn hide(&self, image: DVec2) -> bool {
        self.discs.iter().any(|disc| disc.middle.distance_squared(image) < disc.squared_radius)
    }
}
