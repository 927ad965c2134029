//! The planar domain: strips, points, cuts, overlaps and the band where the distribution is broken.

use std::sync::{Arc, Mutex};

use eframe::egui::{self, Align2, Color32, FontId, Rect, Sense, Stroke, StrokeKind};
use eframe::egui_glow::CallbackFn;
use egui::accesskit::Role;
use glam::{Mat4, Vec2, Vec3};

use super::draw::{Covers, Gpu, Picture, Shot};
use super::keys;
use super::surface::{in_clip, on_screen, on_view};
use super::theme::Palette;
use crate::camera::PlaneView;
use crate::model::Model;
use crate::pick::{self, Pick};
use crate::scene::{Layout, RunScene};

/// The place of the plane's data on the graphics card.
const PLACE: usize = 2;

/// Shows the plane of A.
pub(super) fn show(
    ui: &mut egui::Ui,
    rect: Rect,
    model: &mut Model,
    gpu: &Arc<Mutex<Gpu>>,
    picture: &Arc<Picture>,
    palette: &Palette,
) {
    let response = ui.interact(rect, egui::Id::unique(keys::CANVASES[2]), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(Role::Canvas, true, "Planar domain"));
    keys::take_arrows(ui, &response);
    ui.painter().rect_filled(rect, 4.0, palette.background);
    let painter = ui.painter_at(rect);
    let ink = ui.visuals().text_color();
    let Some(run) = model.runs[0].clone() else { return };
    let aspect = rect.width() / rect.height().max(1.0);
    let mut view = model.plane.unwrap_or_else(|| PlaneView::fit(run.extent(model.layout), aspect));
    steer(ui, rect, model, &mut view, aspect, &response);
    let matrix = view.matrix(aspect);
    if let Some(at) = response.hover_pos().filter(|_| !response.dragged())
        && (super::pointer_moved(ui) || response.clicked())
    {
        let clip = in_clip(rect, at);
        let seen = pick::Seen { matrix, aspect, clip };
        model.hover = pick::in_plane(&run, model.layout, view.place(aspect, clip), &seen);
    }
    if response.clicked() {
        model.pin(model.hover);
    }

    if model.layout == Layout::Domain {
        let side = run.side;
        let square = Rect::from_two_pos(
            on_screen(rect, matrix.project_point3(Vec3::ZERO).truncate()),
            on_screen(rect, matrix.project_point3(Vec3::new(side, side, 0.0)).truncate()),
        );
        painter.rect_stroke(square, 0.0, Stroke::new(1.0, ink.gamma_multiply(0.6)), StrokeKind::Outside);
    }
    let scale = ui.ctx().pixels_per_point();
    let band = model.shown.band.then_some([0.85, 0.1, 0.1, 0.38]);
    let (seen, to_seen) = on_view(ui, rect).unwrap_or((rect, Mat4::IDENTITY));
    let shot = Shot {
        matrix: to_seen * matrix,
        eye: Vec3::ZERO,
        light: None,
        lift: 0.0,
        hover: model.hover.map(|p| p.face),
        wireframe: model.shown.wireframe,
        borders: model.shown.borders,
        points: model.shown.points.then(|| point_size(&run, 0.5 * rect.height() / view.half_height) * scale),
        ink: palette.ink,
        rim: palette.rim,
        // In the domain strips lie over each other on purpose: only side by side is an overlap one.
        covers: (model.layout == Layout::Apart).then_some(Covers { overlap: [0.35, 0.0, 0.45, 0.42], band }),
        scale,
    };
    let (gpu, picture) = (Arc::clone(gpu), Arc::clone(picture));
    let callback = CallbackFn::new(move |_, painter| {
        if let Ok(mut gpu) = gpu.lock() {
            gpu.draw(painter.gl(), PLACE, &picture, &shot);
        }
    });
    ui.painter().add(egui::PaintCallback { rect: seen, callback: Arc::new(callback) });

    for (picked, colour) in [(model.pinned, Color32::from_rgb(255, 200, 0)), (model.hover, Color32::WHITE)] {
        if let Some(place) = picked.and_then(|p| place(&run, model.layout, p)) {
            let at = on_screen(rect, matrix.project_point3(place.extend(0.0)).truncate());
            painter.circle_stroke(at, 8.0, Stroke::new(3.0, Color32::BLACK));
            painter.circle_stroke(at, 8.0, Stroke::new(1.5, colour));
        }
    }
    let corner = rect.left_top() + egui::vec2(8.0, 6.0);
    painter.text(corner, Align2::LEFT_TOP, "Plane", FontId::proportional(13.0), ink);
    if response.has_focus() {
        painter.rect_stroke(rect, 4.0, ui.visuals().selection.stroke, StrokeKind::Inside);
    }
}

/// How wide points are, in egui's units, where `unit` of them show one unit of the mesh: a part of their distance.
pub(super) fn point_size(run: &RunScene, unit: f32) -> f32 {
    (0.5 * run.d_m as f32 * unit).clamp(1.7, 9.0)
}

fn place(run: &RunScene, layout: Layout, pick: Pick) -> Option<Vec2> {
    if let Some(point) = pick.point {
        return ((point as usize) < run.points.len()).then(|| run.planar_point(layout, point as usize));
    }
    let [a, b, c] = run.planar_triangle(layout, pick.face);
    Some((a + b + c) / 3.0)
}

fn steer(
    ui: &egui::Ui,
    rect: Rect,
    model: &mut Model,
    view: &mut PlaneView,
    aspect: f32,
    response: &egui::Response,
) {
    let before = *view;
    let height = rect.height().max(1.0);
    let touch = ui.input(|i| i.multi_touch()).filter(|_| response.contains_pointer() || response.dragged());
    if let Some(touch) = touch {
        view.zoom(aspect, in_clip(rect, touch.center_pos), touch.zoom_delta);
        view.pan(Vec2::new(touch.translation_delta.x, touch.translation_delta.y) / height);
    } else if response.dragged() {
        view.pan(Vec2::new(response.drag_delta().x, response.drag_delta().y) / height);
    } else if let Some(at) = response.hover_pos() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        view.zoom(aspect, in_clip(rect, at), (scroll * 0.005).exp() * pinch);
    }
    if response.has_focus() {
        keys::steer_plane(ui.ctx(), view, aspect);
    }
    if *view != before {
        model.plane = Some(*view);
    }
    if response.double_clicked() {
        model.plane = None;
    }
}
