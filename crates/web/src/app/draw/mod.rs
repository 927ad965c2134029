//! Pictures: what is sent to the graphics card, made from scenes without a graphics card.

mod gpu;
mod shaders;

pub(crate) use gpu::{Covers, Gpu, Shot};

use glam::{Vec2, Vec3};
use ldwrap::Origin;

use super::theme::Palette;
use crate::export::strip_colour;
use crate::figure::Figure;
use crate::judge::Verdict;
use crate::model::Colouring;
use crate::scene::{Layout, MeshScene, RunScene, Side, sides_of};

/// A triangle's colour, and in the fourth byte two bits for each side and one for "part of the sample figure".
pub(crate) type FaceData = [u8; 4];

/// A point with its colour.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::NoUninit)]
#[repr(C)]
pub(crate) struct PointVertex {
    pub(crate) position: [f32; 3],
    pub(crate) colour: [u8; 4],
}

/// One view's vertices and colours; each version number grows with its part.
#[derive(Clone, Debug, Default)]
pub(crate) struct Picture {
    pub(crate) version: [u64; 4],
    pub(crate) triangles: Vec<Vec3>,
    pub(crate) faces: Vec<FaceData>,
    pub(crate) points: Vec<PointVertex>,
    pub(crate) band: Vec<Vec3>,
}

impl Picture {
    /// Replaces the triangles.
    pub(crate) fn set_triangles(&mut self, triangles: Vec<Vec3>) {
        self.triangles = triangles;
        self.version[0] += 1;
    }

    /// Replaces the triangles' colours.
    pub(crate) fn set_faces(&mut self, faces: Vec<FaceData>) {
        self.faces = faces;
        self.version[1] += 1;
    }

    /// Replaces the points.
    pub(crate) fn set_points(&mut self, points: Vec<PointVertex>) {
        self.points = points;
        self.version[2] += 1;
    }

    /// Replaces the band.
    pub(crate) fn set_band(&mut self, band: Vec<Vec3>) {
        self.band = band;
        self.version[3] += 1;
    }
}

/// What decides the colours of the triangles.
pub(crate) struct Colours<'a> {
    pub(crate) mesh: &'a MeshScene,
    pub(crate) run: Option<&'a RunScene>,
    pub(crate) colouring: Colouring,
    pub(crate) local: Option<&'a Verdict>,
    pub(crate) strip: Option<u32>,
    pub(crate) figure: Option<&'a Figure>,
    pub(crate) palette: &'a Palette,
}

impl Colours<'_> {
    /// The data of all triangles.
    pub(crate) fn faces(&self) -> Vec<FaceData> {
        let count = self.mesh.face_count();
        let Some(run) = self.run else {
            let [r, g, b] = self.palette.plain;
            return vec![[r, g, b, 0]; count];
        };
        let local = self.local.filter(|v| self.colouring == Colouring::Local && v.local.len() == count);
        let mut faces: Vec<FaceData> = (0..count)
            .map(|face| {
                let strip = run.strip_of[face];
                let mut colour = match local {
                    Some(verdict) => self.palette.surplus(verdict.local[face]),
                    None => strip_colour(strip),
                };
                if self.strip == Some(strip) && local.is_none() {
                    colour = colour.map(|c| c.saturating_add((255 - c) / 3));
                }
                let sides = run.sides[sides_of(face as u32)].iter().enumerate();
                let bits = sides.fold(0, |bits, (k, side)| bits | side_bits(*side) << (2 * k));
                [colour[0], colour[1], colour[2], bits]
            })
            .collect();
        if let Some(figure) = self.figure {
            for (face, part) in &figure.faces {
                let data = &mut faces[*face as usize];
                let [r, g, b] = strip_colour(*part);
                *data = [r, g, b, data[3] | 1 << 6];
            }
        }
        faces
    }
}

fn side_bits(side: Side) -> u8 {
    match side {
        Side::Joined => 0,
        Side::Closed => 1,
        Side::Open => 2,
    }
}

/// The triangles of the plane. Each gets a depth of its own, between -0.9 and 0.9.
pub(crate) fn plane_triangles(run: &RunScene, layout: Layout) -> Vec<Vec3> {
    let count = run.strip_of.len() as u32;
    (0..count)
        .flat_map(|face| {
            let depth = 1.8 * face as f32 / count as f32 - 0.9;
            run.planar_triangle(layout, face).map(|p| p.extend(depth))
        })
        .collect()
}

/// The band along the open border where the distribution is broken, as wide as the points' distance: for each open
/// side a box on its inner side, behind all triangles.
pub(crate) fn band(run: &RunScene, layout: Layout) -> Vec<Vec3> {
    const DEPTH: f32 = 0.95;
    let width = run.d_m as f32;
    let mut band = Vec::new();
    for face in 0..run.strip_of.len() as u32 {
        let corners = run.planar_triangle(layout, face);
        for (k, side) in run.sides[sides_of(face)].iter().enumerate() {
            if *side != Side::Open {
                continue;
            }
            let (a, b, opposite) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let along = (b - a).normalize_or_zero();
            let across = along.perp();
            let inward = if across.dot(opposite - a) < 0.0 { -across } else { across };
            quad(&mut band, [a, b, b + width * inward, a + width * inward], DEPTH);
            // A disc around the end covers what lies beyond the boxes at corners that bend outward.
            disc(&mut band, a, width, DEPTH);
        }
    }
    band
}

fn quad(to: &mut Vec<Vec3>, [a, b, c, d]: [Vec2; 4], depth: f32) {
    to.extend([a, b, c, a, c, d].map(|p| p.extend(depth)));
}

fn disc(to: &mut Vec<Vec3>, centre: Vec2, radius: f32, depth: f32) {
    const CORNERS: usize = 8;
    let at = |k: usize| centre + radius * Vec2::from_angle(k as f32 / CORNERS as f32 * std::f32::consts::TAU);
    for k in 0..CORNERS {
        to.extend([centre, at(k), at(k + 1)].map(|p| p.extend(depth)));
    }
}

/// The colour of a point by what put it there.
pub(crate) fn point_colour(origin: Origin, palette: &Palette) -> [u8; 4] {
    let [r, g, b] = match origin {
        Origin::Projected => palette.corrected,
        Origin::Wrapped | Origin::Equalized => palette.point,
    };
    [r, g, b, 255]
}

/// The points in space.
pub(crate) fn surface_points(run: &RunScene, palette: &Palette) -> Vec<PointVertex> {
    let vertex = |position: Vec3, origin| PointVertex {
        position: position.into(),
        colour: point_colour(origin, palette),
    };
    run.points.iter().map(|p| vertex(p.position, p.origin)).collect()
}

/// The points in the plane, before all triangles.
pub(crate) fn plane_points(run: &RunScene, layout: Layout, palette: &Palette) -> Vec<PointVertex> {
    (0..run.points.len())
        .map(|i| PointVertex {
            position: run.planar_point(layout, i).extend(-0.95).into(),
            colour: point_colour(run.points[i].origin, palette),
        })
        .collect()
}
