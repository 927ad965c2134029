//! Remakes pictures only when what they show has changed, and times frames.

use std::sync::Arc;

use eframe::egui;
use glam::Vec3;

use super::Pictures;
use super::draw::{self, Colours, FaceData, Picture, PointVertex};
use super::theme::Palette;
use crate::engine::Slot;
use crate::judge::{Measure, Verdict};
use crate::model::{Colouring, Model};
use crate::pick::Pick;
use crate::scene::Layout;

/// What a picture was made from.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Drawn {
    geometry: (usize, Layout),
    points: (usize, Layout, bool),
    colours: Option<ColourKey>,
}

#[derive(Clone, Debug, PartialEq)]
struct ColourKey {
    run: usize,
    mesh: usize,
    colouring: Colouring,
    local: bool,
    strip: Option<u32>,
    figure: Option<(u32, u32)>,
    dark: bool,
}

/// The address of a shared value tells whether it is the same one; 0 for none.
fn address<T>(shared: Option<&Arc<T>>) -> usize {
    shared.map_or(0, |s| Arc::as_ptr(s) as usize)
}

fn colour_key(model: &Model, slot: Slot, palette: &Palette) -> ColourKey {
    ColourKey {
        run: address(model.runs[slot.index()].as_ref()),
        mesh: address(model.mesh.as_ref()),
        colouring: model.colouring,
        local: local(model, slot).is_some(),
        strip: if slot == Slot::A { strip(model, model.hover) } else { None },
        figure: model.figure.as_ref().filter(|_| slot == Slot::A).map(|f| (f.seed, f.rings)),
        dark: palette.is_dark(),
    }
}

fn local(model: &Model, slot: Slot) -> Option<&Verdict> {
    model.verdicts[slot.index()].iter().find(|(m, _)| *m == Measure::Local).map(|(_, v)| v)
}

fn strip(model: &Model, pick: Option<Pick>) -> Option<u32> {
    let run = model.runs[0].as_ref()?;
    run.strip_of.get(pick?.face as usize).copied()
}

fn faces(model: &Model, slot: Slot, palette: &Palette) -> Vec<FaceData> {
    let Some(mesh) = &model.mesh else { return Vec::new() };
    let colours = Colours {
        mesh,
        run: model.runs[slot.index()].as_deref(),
        colouring: model.colouring,
        local: local(model, slot),
        strip: if slot == Slot::A { strip(model, model.hover) } else { None },
        figure: model.figure.as_ref().filter(|_| slot == Slot::A),
        palette,
    };
    colours.faces()
}

/// Brings the picture of a slot's surface up to date.
pub(super) fn redraw_surface(pictures: &mut Pictures, model: &Model, slot: Slot, palette: &Palette) {
    let k = slot.index();
    let run = model.runs[k].as_ref();
    let layout = Layout::default();
    let now = Drawn {
        geometry: (address(model.mesh.as_ref()), layout),
        points: (address(run), layout, palette.is_dark()),
        colours: Some(colour_key(model, slot, palette)),
    };
    update(&mut pictures.surfaces[k], &mut pictures.drawn[k], now, |part| match part {
        Part::Triangles => {
            Made::Triangles(model.mesh.as_ref().map(|m| m.corners.clone()).unwrap_or_default(), None)
        }
        Part::Points => Made::Points(run.map(|r| draw::surface_points(r, palette)).unwrap_or_default()),
        Part::Faces => Made::Faces(faces(model, slot, palette)),
    });
}

/// Brings the picture of the plane up to date.
pub(super) fn redraw_plane(pictures: &mut Pictures, model: &Model, palette: &Palette) {
    let run = model.runs[0].as_ref();
    let layout = model.layout;
    let now = Drawn {
        geometry: (address(run), layout),
        points: (address(run), layout, palette.is_dark()),
        colours: Some(colour_key(model, Slot::A, palette)),
    };
    update(&mut pictures.plane, &mut pictures.drawn[2], now, |part| match (part, run) {
        (Part::Triangles, Some(r)) => {
            Made::Triangles(draw::plane_triangles(r, layout), Some(draw::band(r, layout)))
        }
        (Part::Triangles, None) => Made::Triangles(Vec::new(), None),
        (Part::Points, r) => {
            Made::Points(r.map(|r| draw::plane_points(r, layout, palette)).unwrap_or_default())
        }
        (Part::Faces, Some(_)) => Made::Faces(faces(model, Slot::A, palette)),
        (Part::Faces, None) => Made::Faces(Vec::new()),
    });
}

#[derive(Clone, Copy)]
enum Part {
    Triangles,
    Points,
    Faces,
}

enum Made {
    Triangles(Vec<Vec3>, Option<Vec<Vec3>>),
    Points(Vec<PointVertex>),
    Faces(Vec<FaceData>),
}

/// Remakes the parts whose key has changed.
fn update(picture: &mut Arc<Picture>, drawn: &mut Drawn, now: Drawn, make: impl Fn(Part) -> Made) {
    let stale = [
        (Part::Triangles, drawn.geometry != now.geometry),
        (Part::Points, drawn.points != now.points),
        (Part::Faces, drawn.colours != now.colours),
    ];
    for (part, _) in stale.into_iter().filter(|(_, stale)| *stale) {
        let picture = Arc::make_mut(picture);
        match make(part) {
            Made::Triangles(triangles, band) => {
                picture.set_triangles(triangles);
                picture.set_band(band.unwrap_or_default());
            }
            Made::Points(points) => picture.set_points(points),
            Made::Faces(faces) => picture.set_faces(faces),
        }
    }
    *drawn = now;
}

/// The time from frame to frame while something moves.
#[derive(Debug, Default)]
pub(super) struct Frames {
    last: f64,
    mean: f64,
    first: First,
}

/// How far the page has come.
#[derive(Clone, Copy, Debug, Default)]
enum First {
    /// No points yet.
    #[default]
    Empty,
    /// The frame with the first points is being drawn.
    Drawing,
    /// It was shown, this many seconds after the page was opened.
    Shown(f64),
}

impl Frames {
    /// Counts a frame.
    pub(super) fn count(&mut self, ctx: &egui::Context) {
        let now = ctx.input(|i| i.time);
        let step = 1000.0 * (now - self.last);
        self.last = now;
        // A long pause is a page at rest, not a slow frame.
        if step < 400.0 {
            self.mean += 0.1 * (step - self.mean);
        }
    }

    /// When the first points were shown, in seconds since the page was opened.
    pub(super) fn first_picture(&self) -> Option<f64> {
        match self.first {
            First::Shown(seconds) => Some(seconds),
            First::Empty | First::Drawing => None,
        }
    }

    /// Notes whether points are shown.
    pub(super) fn shown(&mut self, ctx: &egui::Context, points: bool) {
        match self.first {
            First::Empty if points => {
                self.first = First::Drawing;
                ctx.request_repaint();
            }
            // The next frame begins when this one was handed over.
            First::Drawing => self.first = First::Shown(ctx.input(|i| i.time)),
            First::Empty | First::Shown(_) => {}
        }
    }

    /// In milliseconds.
    pub(super) fn mean(&self) -> f64 {
        self.mean
    }
}
