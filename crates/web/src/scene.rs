//! What the engine tells the page about a mesh and a run: plain numbers, ready to draw and small to send.

use std::ops::Range;

use glam::{Vec2, Vec3};
use ldwrap::irregularity::Irregularity;
use ldwrap::pipeline::Run;
use ldwrap::unfold::{Strip, Strips};
use ldwrap::{FaceId, Origin, RepairReport, SurfaceMesh};
use serde::{Deserialize, Serialize};

use crate::camera::Up;
use crate::report::MeshReport;
use crate::source::Source;
use crate::upright::{self, Because};

/// A checked mesh to draw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshScene {
    /// What a person calls it.
    pub name: String,
    /// The corners of all triangles, three a triangle, in units of the mesh.
    pub corners: Vec<Vec3>,
    /// The middle of the box around it.
    pub centre: Vec3,
    /// The radius of the ball around that middle that holds it.
    pub radius: f32,
    /// Which axis points up, and why that is thought.
    pub up: (Up, Because),
    /// Counts and area.
    pub report: MeshReport,
    /// What the check repaired, in words; empty for a clean mesh.
    pub repaired: Vec<String>,
}

/// What lies on the other side of a triangle's side in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Side {
    /// The neighbour on the surface.
    Joined,
    /// A cut whose two copies lie within the correction's tolerance.
    Closed,
    /// A cut that breaks the distribution, or the border of the mesh.
    Open,
}

/// A point to draw.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PointScene {
    /// The triangle that holds it.
    pub face: u32,
    /// The weights of the triangle's corners, exact as the engine made them.
    pub barycentric: [f64; 3],
    /// Where it is in space.
    pub position: Vec3,
    /// Where it is in the plane, relative to its strip's origin.
    pub place: Vec2,
    /// Its strip.
    pub strip: u32,
    /// What put it there.
    pub origin: Origin,
}

/// A strip to draw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StripScene {
    /// How many triangles it has.
    pub faces: u32,
    /// Its area.
    pub area: f64,
    /// The length of its border.
    pub border_length: f64,
    /// The length of its border that breaks the distribution.
    pub open_border_length: f64,
    /// The size of the box around it.
    pub extent: Vec2,
    /// Where its origin lies in the planar domain; strips may cover each other there, each catches its own points.
    pub in_domain: Vec2,
    /// Where its origin lies when the strips are laid out side by side.
    pub apart: Vec2,
}

/// A run to draw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunScene {
    /// The strips.
    pub strips: Vec<StripScene>,
    /// For each triangle its strip.
    pub strip_of: Vec<u32>,
    /// For each triangle its corners in the plane, relative to its strip's origin.
    pub plane: Vec<Vec2>,
    /// For each triangle its sides: the side from corner k to the next at `3 face + k`.
    pub sides: Vec<Side>,
    /// The side of the planar domain.
    pub side: f32,
    /// The size of the box around the strips side by side.
    pub apart_extent: Vec2,
    /// The points.
    pub points: Vec<PointScene>,
    /// The mean distance between neighbours.
    pub d_m: f64,
    /// The three irregularity ratios: by eq. 8, refined, exact.
    pub irregularity: [f64; 3],
    /// Points the correction projected.
    pub projected: u32,
    /// Copies the correction removed.
    pub removed: u32,
    /// How long it took, in seconds.
    pub seconds: f64,
    /// The report as JSON.
    pub report: String,
}

impl MeshScene {
    /// The picture of a mesh.
    pub fn new(source: &Source, mesh: &SurfaceMesh, repaired: &RepairReport) -> Self {
        let (low, high) = mesh.bounds();
        let corners: Vec<Vec3> =
            (0..mesh.face_count()).flat_map(|f| mesh.triangle(FaceId::new(f)).map(|p| p.as_vec3())).collect();
        let centre = (0.5 * (low + high)).as_vec3();
        let up = match source {
            Source::Shape(_) => (Up::Z, Because::Made),
            Source::File { name, .. } => upright::guess(name, &corners),
        };
        let radius = corners.iter().fold(0.0_f32, |m, p| m.max(p.distance(centre)));
        Self {
            name: source.name().to_owned(),
            up,
            corners,
            centre,
            radius,
            report: MeshReport::new(mesh),
            repaired: crate::report::repaired_in_words(repaired),
        }
    }

    /// How many triangles it has.
    pub fn face_count(&self) -> usize {
        self.corners.len() / 3
    }

    /// The corners of a triangle.
    pub fn triangle(&self, face: u32) -> [Vec3; 3] {
        let start = 3 * face as usize;
        [self.corners[start], self.corners[start + 1], self.corners[start + 2]]
    }
}

/// The layout of the planar view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Layout {
    /// Side by side: nothing hides anything.
    #[default]
    Apart,
    /// Where the points were scattered: strips may cover each other.
    Domain,
}

impl RunScene {
    /// The picture of a run.
    pub fn new(
        mesh: &SurfaceMesh,
        run: &Run,
        irregularity: Irregularity,
        seconds: f64,
        report: String,
    ) -> Self {
        let faces = mesh.face_count();
        let mut plane = vec![Vec2::ZERO; 3 * faces];
        let mut sides = vec![Side::Joined; 3 * faces];
        let mut strip_of = vec![0; faces];
        let gap = run.tolerance;
        for (number, strip) in (0..).zip(&run.strips.strips) {
            for (index, face) in strip.faces.iter().enumerate() {
                strip_of[face.index()] = number;
                for (corner, place) in strip.triangle(index).into_iter().enumerate() {
                    plane[3 * face.index() + corner] = place.as_vec2();
                }
            }
            for edge in &strip.border {
                sides[edge.halfedge.0 as usize] =
                    if strip.is_open(edge, gap) { Side::Open } else { Side::Closed };
            }
        }
        let (apart, apart_extent) = lay_apart(&run.strips);
        let strips = run.strips.strips.iter().zip(&run.domain.offsets).zip(apart);
        let strips = strips.map(|((strip, offset), apart)| strip_scene(strip, gap, offset.as_vec2(), apart));
        let points = run.samples.iter().map(|sample| PointScene {
            face: sample.point.face.0,
            barycentric: sample.point.barycentric,
            position: mesh.locate(&sample.point).as_vec3(),
            place: (sample.place - run.domain.offsets[sample.strip.index()]).as_vec2(),
            strip: sample.strip.0,
            origin: sample.origin,
        });
        Self {
            strips: strips.collect(),
            strip_of,
            plane,
            sides,
            side: run.domain.side as f32,
            apart_extent,
            points: points.collect(),
            d_m: run.d_m,
            irregularity: [irregularity.bound, irregularity.refined, irregularity.exact],
            projected: run.correction.projected as u32,
            removed: run.correction.removed as u32,
            seconds,
            report,
        }
    }

    /// Where a strip's origin lies in a layout.
    pub fn offset(&self, layout: Layout, strip: u32) -> Vec2 {
        let strip = &self.strips[strip as usize];
        match layout {
            Layout::Apart => strip.apart,
            Layout::Domain => strip.in_domain,
        }
    }

    /// The size of the box around a layout, from (0, 0).
    pub fn extent(&self, layout: Layout) -> Vec2 {
        match layout {
            Layout::Apart => self.apart_extent,
            Layout::Domain => Vec2::splat(self.side),
        }
    }

    /// A triangle's corners in a layout.
    pub fn planar_triangle(&self, layout: Layout, face: u32) -> [Vec2; 3] {
        let offset = self.offset(layout, self.strip_of[face as usize]);
        let start = 3 * face as usize;
        [self.plane[start] + offset, self.plane[start + 1] + offset, self.plane[start + 2] + offset]
    }

    /// A point's place in a layout.
    pub fn planar_point(&self, layout: Layout, point: usize) -> Vec2 {
        let point = &self.points[point];
        point.place + self.offset(layout, point.strip)
    }
}

fn strip_scene(strip: &Strip, gap: f64, in_domain: Vec2, apart: Vec2) -> StripScene {
    let length = |open_only: bool| {
        strip
            .border
            .iter()
            .filter(|e| !open_only || strip.is_open(e, gap))
            .map(|e| strip.border_length(e))
            .sum()
    };
    StripScene {
        faces: strip.faces.len() as u32,
        area: strip.area,
        border_length: length(false),
        open_border_length: length(true),
        extent: strip.extent.as_vec2(),
        in_domain,
        apart,
    }
}

/// Lays the strips side by side on shelves, the highest first, about as wide as high. Returns where each lies and
/// the size of all.
fn lay_apart(strips: &Strips) -> (Vec<Vec2>, Vec2) {
    let extents: Vec<Vec2> = strips.strips.iter().map(|s| s.extent.as_vec2()).collect();
    let boxes: f32 = extents.iter().map(|e| e.x * e.y).sum();
    let widest = extents.iter().fold(0.0_f32, |m, e| m.max(e.x));
    let width = widest.max(1.2 * boxes.sqrt());
    let gap = 0.02 * width;
    let mut order: Vec<usize> = (0..extents.len()).collect();
    order.sort_by(|&a, &b| extents[b].y.total_cmp(&extents[a].y).then(a.cmp(&b)));
    let mut places = vec![Vec2::ZERO; extents.len()];
    let (mut cursor, mut shelf, mut used) = (Vec2::ZERO, 0.0_f32, Vec2::ZERO);
    for strip in order {
        let extent = extents[strip];
        if cursor.x > 0.0 && cursor.x + extent.x > width {
            cursor = Vec2::new(0.0, cursor.y + shelf + gap);
            shelf = 0.0;
        }
        places[strip] = cursor;
        used = used.max(cursor + extent);
        shelf = shelf.max(extent.y);
        cursor.x += extent.x + gap;
    }
    (places, used)
}

/// The places of the sides of a triangle in [`RunScene::sides`].
pub fn sides_of(face: u32) -> Range<usize> {
    3 * face as usize..3 * face as usize + 3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{Answer, Engine, Job, Slot};
    use crate::settings::Settings;
    use ldwrap::Silent;
    use ldwrap::shapes::Shape;

    #[test]
    fn strips_side_by_side_do_not_cover_each_other() {
        let mut engine = Engine::default();
        engine.handle(Job::Load(Source::Shape(Shape::Cup)), &Silent, &|| 0.0);
        let Answer::Wrapped(_, run) =
            engine.handle(Job::Wrap(Slot::A, Settings::default()), &Silent, &|| 0.0)
        else {
            panic!("not wrapped")
        };
        assert!(run.strips.len() > 1);
        for (k, a) in run.strips.iter().enumerate() {
            for b in &run.strips[k + 1..] {
                let apart =
                    (a.apart + a.extent).cmple(b.apart).any() || (b.apart + b.extent).cmple(a.apart).any();
                assert!(apart, "{a:?} {b:?}");
            }
        }
        let slack = Vec2::splat(1e-4 * run.apart_extent.max_element());
        for face in 0..run.strip_of.len() as u32 {
            let strip = &run.strips[run.strip_of[face as usize] as usize];
            for corner in run.planar_triangle(Layout::Apart, face) {
                let inside = corner.cmpge(strip.apart - slack).all()
                    && corner.cmple(strip.apart + strip.extent + slack).all();
                assert!(inside, "triangle {face} of {strip:?} at {corner}");
            }
        }
    }
}
