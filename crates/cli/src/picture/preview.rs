//! The preview picture: the paper's figures 5 to 7, mesh by strip and points, from one side.

use glam::{DVec2, DVec3};
use ldwrap::unfold::Strips;
use ldwrap::{FaceId, Origin, Sample, SurfaceMesh};

use super::camera::Camera;
use super::palette::{INK, MOVED, PAPER, Rgb, strip_colours};
use super::raster::FaceRaster;

/// Drawn this many times larger in both directions, then averaged, for smooth outlines.
const FINER: usize = 2;

/// How large the preview is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PreviewOptions {
    /// Pixels across. Default: 1,200; 0 is taken as 1.
    pub(crate) width: u32,
    /// Pixels down. Default: 1,200; 0 is taken as 1.
    pub(crate) height: u32,
}

impl Default for PreviewOptions {
    fn default() -> Self {
        Self { width: 1200, height: 1200 }
    }
}

/// The mesh coloured by strip with its visible points, as a PNG file: seen from the front, right and above, where y
/// is up unless the mesh clearly stands along z. Insides of open surfaces are greyed. Points that the correction moved are pink, all others white.
///
/// Needs some 50 bytes a pixel while it works.
pub(crate) fn preview_png(
    mesh: &SurfaceMesh,
    strips: &Strips,
    samples: &[Sample],
    options: &PreviewOptions,
) -> Vec<u8> {
    let (width, height) = (options.width.max(1) as usize, options.height.max(1) as usize);
    let (fine_width, fine_height) = (width * FINER, height * FINER);
    let camera = Camera::three_quarter(mesh, DVec2::new(fine_width as f64, fine_height as f64));
    let mut raster = FaceRaster::new(fine_width, fine_height);
    for face in mesh.topology().face_ids() {
        raster.draw(face, mesh.triangle(face).map(|p| camera.project(p)));
    }
    let shades = face_shades(mesh, strips, &camera);
    let pixels = raster.faces().iter().map(|face| face.map_or(PAPER, |f| shades[f.index()])).collect();
    let mut image = Image { width: fine_width, height: fine_height, pixels };
    draw_points(&mut image, mesh, samples, &camera, &raster);
    encode(width, height, &image.averaged(width, height))
}

struct Image {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
}

/// The colour of each face: its strip's, lit.
fn face_shades(mesh: &SurfaceMesh, strips: &Strips, camera: &Camera) -> Vec<Rgb> {
    let colours = strip_colours(strips);
    let black = Rgb([0; 3]);
    mesh.topology()
        .face_ids()
        .map(|face| {
            let place = strips.places.get(face.index());
            let colour = place.and_then(|p| colours.get(p.strip.index())).copied().unwrap_or(PAPER);
            let normal = mesh.face_normal(face);
            let inside = normal.dot(camera.toward()) < 0.0;
            let colour = if inside { colour.mix(Rgb([0x80; 3]), 0.6) } else { colour };
            colour.mix(black, 1.0 - camera.brightness(normal))
        })
        .collect()
}

/// Discs for the visible samples, the nearest last.
fn draw_points(
    image: &mut Image,
    mesh: &SurfaceMesh,
    samples: &[Sample],
    camera: &Camera,
    raster: &FaceRaster,
) {
    let d_m = (mesh.area() / samples.len().max(1) as f64).sqrt() * camera.scale();
    let largest = image.width.min(image.height) as f64 / 110.0;
    let radius = (0.2 * d_m).min(largest).max(1.4 * FINER as f64);
    let mut visible: Vec<(DVec3, Rgb)> = samples
        .iter()
        .filter_map(|sample| {
            let place = camera.project(mesh.locate(&sample.point));
            let moved = sample.origin == Origin::Projected;
            is_visible(mesh, sample.point.face, place, camera, raster)
                .then_some((place, if moved { MOVED } else { PAPER }))
        })
        .collect();
    visible.sort_by(|a, b| a.0.z.total_cmp(&b.0.z));
    for (place, colour) in visible {
        image.disc(place.truncate(), radius, colour);
    }
}

/// Whether a point of `face` at this place of the picture is in front.
fn is_visible(mesh: &SurfaceMesh, face: FaceId, place: DVec3, camera: &Camera, raster: &FaceRaster) -> bool {
    let Some((shown, depth)) = raster.at(place.x, place.y) else { return false };
    if shown == face {
        return true;
    }
    let facing = mesh.face_normal(face).dot(camera.toward());
    let shown_facing = mesh.face_normal(shown).dot(camera.toward());
    // The two sides of a thin sheet are nearly as deep as each other.
    if (facing >= 0.0) != (shown_facing >= 0.0) {
        return false;
    }
    // The depth is that of the pixel's centre, up to 0.7 pixels away; a steep face is that much deeper there.
    let steepest = facing.abs().min(shown_facing.abs()).max(0.1);
    place.z >= depth - 1.0 / steepest
}

impl Image {
    /// A disc with a dark outline.
    fn disc(&mut self, centre: DVec2, radius: f64, colour: Rgb) {
        let outline = (0.3 * radius).max(0.5 * FINER as f64);
        let range = |middle: f64, end: usize| {
            let first = (middle - radius).floor().clamp(0.0, end as f64) as usize;
            let behind = (middle + radius).ceil().clamp(0.0, end as f64) as usize;
            first..behind
        };
        for row in range(centre.y, self.height) {
            for column in range(centre.x, self.width) {
                let distance = centre.distance(DVec2::new(column as f64 + 0.5, row as f64 + 0.5));
                if distance <= radius {
                    let ink = if distance > radius - outline { INK } else { colour };
                    self.pixels[row * self.width + column] = ink;
                }
            }
        }
    }

    /// The picture at its final size: red, green and blue of each pixel.
    fn averaged(&self, width: usize, height: usize) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(width * height * 3);
        for row in 0..height {
            for column in 0..width {
                let mut sum = [0u32; 3];
                for fine in 0..FINER * FINER {
                    let (y, x) = (row * FINER + fine / FINER, column * FINER + fine % FINER);
                    for (total, part) in sum.iter_mut().zip(self.pixels[y * self.width + x].0) {
                        *total += u32::from(part);
                    }
                }
                bytes.extend(sum.map(|total| (total as usize / (FINER * FINER)) as u8));
            }
        }
        bytes
    }
}

fn encode(width: usize, height: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(bytes)?;
        writer.finish()
    });
    // Sizes agree and are not zero, and a vector takes every byte: nothing is left that could fail.
    written.expect("a picture in memory can be written");
    file
}
