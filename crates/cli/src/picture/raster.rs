//! Which face each pixel shows.

use glam::DVec3;
use ldwrap::FaceId;

/// A picture of faces with their depths.
pub(crate) struct FaceRaster {
    width: usize,
    height: usize,
    depths: Vec<f32>,
    faces: Vec<Option<FaceId>>,
}

impl FaceRaster {
    /// An empty picture.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            depths: vec![f32::NEG_INFINITY; width * height],
            faces: vec![None; width * height],
        }
    }

    /// Draws a face with these corners: x and y in pixels, larger z nearer. Pixels belong to the nearest face over
    /// their centre.
    pub(crate) fn draw(&mut self, face: FaceId, corners: [DVec3; 3]) {
        let [a, b, c] = corners;
        let doubled = (b - a).truncate().perp_dot((c - a).truncate());
        if doubled == 0.0 {
            return;
        }
        let low = a.min(b).min(c);
        let high = a.max(b).max(c);
        // The first and the one behind the last pixel whose centre lies in the box.
        let range = |low: f64, high: f64, end: usize| {
            let first = (low - 0.5).ceil().clamp(0.0, end as f64) as usize;
            let behind = ((high - 0.5).floor() + 1.0).clamp(0.0, end as f64) as usize;
            first..behind
        };
        // Barycentric weights of b and c and the depth change linearly from pixel to pixel.
        let weight_b = |x: f64, y: f64| ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / doubled;
        let weight_c = |x: f64, y: f64| ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / doubled;
        let (step_b, step_c) = ((c.y - a.y) / doubled, -(b.y - a.y) / doubled);
        let columns = range(low.x, high.x, self.width);
        for row in range(low.y, high.y, self.height) {
            let y = row as f64 + 0.5;
            let x = columns.start as f64 + 0.5;
            let (mut v, mut w) = (weight_b(x, y), weight_c(x, y));
            for pixel in row * self.width + columns.start..row * self.width + columns.end {
                if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
                    let depth = (a.z + v * (b.z - a.z) + w * (c.z - a.z)) as f32;
                    if depth > self.depths[pixel] {
                        self.depths[pixel] = depth;
                        self.faces[pixel] = Some(face);
                    }
                }
                v += step_b;
                w += step_c;
            }
        }
    }

    /// The face at each pixel, row after row from the top.
    pub(crate) fn faces(&self) -> &[Option<FaceId>] {
        &self.faces
    }

    /// The face and its depth at a place, if there is one.
    pub(crate) fn at(&self, x: f64, y: f64) -> Option<(FaceId, f64)> {
        let inside = x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64;
        let pixel = inside.then(|| y as usize * self.width + x as usize)?;
        self.faces[pixel].map(|face| (face, f64::from(self.depths[pixel])))
    }
}
