//! The program's own pictures, and the strips as pixels for meshes whose borders are too long for a small SVG.
#![allow(dead_code, reason = "the program uses more of these modules than this example")]

#[path = "../../src/picture/camera.rs"]
mod camera;
#[path = "../../src/picture/layout.rs"]
mod layout;
#[path = "../../src/picture/palette.rs"]
mod palette;
#[path = "../../src/picture/preview.rs"]
mod preview;
#[path = "../../src/picture/raster.rs"]
mod raster;
#[path = "../../src/picture/svg.rs"]
mod svg;

use glam::{DVec2, DVec3};
use ldwrap::pipeline::Run;
use ldwrap::{Origin, SurfaceMesh};

pub(crate) use preview::{PreviewOptions, preview_png};
pub(crate) use svg::strips_svg;

use layout::shelves;
use palette::{INK, MOVED, PAPER, Rgb, strip_colours};
use raster::FaceRaster;

/// Pixels across the picture of the strips.
const WIDTH: usize = 680;
/// Drawn this many times finer, then averaged.
const FINER: usize = 2;

/// The strips side by side with their open borders and points, as PNG.
pub(crate) fn strips_png(mesh: &SurfaceMesh, run: &Run, tolerance: f64) -> Vec<u8> {
    let strips = &run.strips;
    let extents: Vec<DVec2> = strips.strips.iter().map(|s| s.extent).collect();
    let layout = shelves(&extents, 0.015);
    let width = WIDTH * FINER;
    let margin = 8.0 * FINER as f64;
    let scale = (width as f64 - 2.0 * margin) / layout.size.x;
    let height = ((layout.size.y * scale + 2.0 * margin) / FINER as f64).ceil() as usize * FINER;
    let at = |strip: usize, p: DVec2| {
        let corner = layout.corners[strip];
        let top = corner.y + strips.strips[strip].extent.y;
        DVec2::new(margin + (corner.x + p.x) * scale, margin + (top - p.y) * scale)
    };
    let mut raster = FaceRaster::new(width, height);
    for (s, strip) in strips.strips.iter().enumerate() {
        for (i, &face) in strip.faces.iter().enumerate() {
            let depth = i as f64 / mesh.face_count() as f64;
            raster.draw(face, strip.triangle(i).map(|p| at(s, p).extend(depth)));
        }
    }
    let colours = strip_colours(strips);
    let colour_of = |face: ldwrap::FaceId| colours[strips.places[face.index()].strip.index()];
    let mut pixels: Vec<Rgb> = raster.faces().iter().map(|face| face.map_or(PAPER, colour_of)).collect();
    let mut disc = |centre: DVec2, radius: f64, colour: Rgb, share: f64| {
        let reach = radius.ceil() as i64;
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let (x, y) = (centre.x as i64 + dx, centre.y as i64 + dy);
                let inside = x >= 0 && y >= 0 && x < width as i64 && y < height as i64;
                let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                if inside && middle.distance(centre) <= radius {
                    let pixel = &mut pixels[y as usize * width + x as usize];
                    *pixel = pixel.mix(colour, share);
                }
            }
        }
    };
    for (s, strip) in strips.strips.iter().enumerate() {
        for edge in strip.border.iter().filter(|edge| strip.is_open(edge, tolerance)) {
            let [a, b] = [edge.from, edge.to].map(|v| at(s, strip.vertices[v as usize]));
            let steps = a.distance(b).ceil().max(1.0);
            for k in 0..=steps as usize {
                disc(a.lerp(b, k as f64 / steps), 0.75, INK, 0.7);
            }
        }
    }
    let d_m = run.d_m * scale;
    let radius = (0.16 * d_m).clamp(1.4 * FINER as f64, 5.0 * FINER as f64);
    for sample in &run.samples {
        let s = sample.strip.index();
        let place = at(s, sample.place - run.domain.offsets[s]);
        disc(place, radius + 1.0, PAPER, 1.0);
        disc(place, radius, if sample.origin == Origin::Projected { MOVED } else { INK }, 1.0);
    }
    png(&pixels, width, height)
}

/// Averages groups of fine pixels and writes them with at most 32 levels a channel, which keeps files small.
fn png(pixels: &[Rgb], width: usize, height: usize) -> Vec<u8> {
    let (across, down) = (width / FINER, height / FINER);
    let mut bytes = Vec::with_capacity(across * down * 3);
    for y in 0..down {
        for x in 0..across {
            for channel in 0..3 {
                let fine = (0..FINER * FINER)
                    .map(|k| (y * FINER + k / FINER) * width + x * FINER + k % FINER)
                    .map(|k| u32::from(pixels[k].0[channel]));
                let mean = fine.sum::<u32>() / (FINER * FINER) as u32;
                bytes.push((mean as u8 & 0xf8) | (mean as u8 >> 5));
            }
        }
    }
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, across as u32, down as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().expect("the sizes are not zero");
    writer.write_image_data(&bytes).expect("the sizes agree");
    writer.finish().expect("a vector takes every byte");
    file
}

/// Towards the viewer of a panel of [`parts`](crate::parts), and across.
pub(crate) fn axes(toward: DVec3) -> [DVec3; 3] {
    let aside = if toward.y.abs() < 0.9 { DVec3::Y } else { DVec3::X };
    let right = aside.cross(toward).normalize();
    [right, toward.cross(right), toward]
}
