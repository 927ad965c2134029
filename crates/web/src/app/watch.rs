//! Remakes pictures only when what they show has changed, and times frames.

use std::sync::Arc;

use eframe::egui;

use super::Pictures;
use super::draw::{self, Colours};
use super::theme::Palette;
use crate::engine::Slot;
use crate::judge::{Measure, Verdict};
use crate::model::{Colouring, Model};
use crate::pick::Pick;
use crate::scene::Layout;

/// What a picture was made from.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Drawn {
    geometry: Option<(usize, Layout)>,
    points: Option<(usize, Layout, bool)>,
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
        dark: palette == &Palette::new(true),
    }
}

fn local(model: &Model, slot: Slot) -> Option<&Verdict> {
    model.verdicts[slot.index()].iter().find(|(m, _)| *m == Measure::Local).map(|(_, v)| v)
}

fn strip(model: &Model, pick: Option<Pick>) -> Option<u32> {
    let run = model.runs[0].as_ref()?;
    run.strip_of.get(pick?.face as usize).copied()
}

fn faces(model: &Model, slot: Slot, palette: &Palette) -> Vec<draw::FaceData> {
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
    let picture = Arc::make_mut(&mut pictures.surfaces[k]);
    let drawn = &mut pictures.drawn[k];
    let run = model.runs[k].as_ref();
    let geometry = Some((address(model.mesh.as_ref()), Layout::default()));
    if drawn.geometry != geometry {
        drawn.geometry = geometry;
        picture.set_triangles(model.mesh.as_ref().map(|m| m.corners.clone()).unwrap_or_default());
    }
    let dark = palette == &Palette::new(true);
    let points = Some((address(run), Layout::default(), dark));
    if drawn.points != points {
        drawn.points = points;
        picture.set_points(run.map(|r| draw::surface_points(r, palette)).unwrap_or_default());
    }
    let key = Some(colour_key(model, slot, palette));
    if drawn.colours != key {
        drawn.colours = key;
        picture.set_faces(faces(model, slot, palette));
    }
}

/// Brings the picture of the plane up to date.
pub(super) fn redraw_plane(pictures: &mut Pictures, model: &Model, palette: &Palette) {
    let picture = Arc::make_mut(&mut pictures.plane);
    let drawn = &mut pictures.drawn[2];
    let run = model.runs[0].as_ref();
    let geometry = Some((address(run), model.layout));
    if drawn.geometry != geometry {
        drawn.geometry = geometry;
        picture.set_triangles(run.map(|r| draw::plane_triangles(r, model.layout)).unwrap_or_default());
        picture.set_band(run.map(|r| draw::band(r, model.layout)).unwrap_or_default());
    }
    let dark = palette == &Palette::new(true);
    let points = Some((address(run), model.layout, dark));
    if drawn.points != points {
        drawn.points = points;
        picture.set_points(run.map(|r| draw::plane_points(r, model.layout, palette)).unwrap_or_default());
    }
    let key = Some(colour_key(model, Slot::A, palette));
    if drawn.colours != key {
        drawn.colours = key;
        picture.set_faces(if run.is_some() { faces(model, Slot::A, palette) } else { Vec::new() });
    }
}

/// The time from frame to frame while something moves.
#[derive(Debug, Default)]
pub(super) struct Frames {
    last: f64,
    mean: f64,
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

    /// In milliseconds.
    pub(super) fn mean(&self) -> f64 {
        self.mean
    }
}
