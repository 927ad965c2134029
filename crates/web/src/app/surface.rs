//! The surface in space: orbit, pan, zoom, point at things, and an obstacle that can be dragged.

use std::sync::{Arc, Mutex};

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, StrokeKind};
use eframe::egui_glow::CallbackFn;
use egui::accesskit::Role;
use glam::{Mat4, Vec2, Vec3};

use super::draw::{Gpu, Picture, Shot};
use super::keys;
use super::theme::Palette;
use crate::engine::Slot;
use crate::model::Model;
use crate::pick::{self, Pick};

/// Shows a slot's surface.
pub(super) fn show(
    ui: &mut egui::Ui,
    rect: Rect,
    model: &mut Model,
    slot: Slot,
    gpu: &Arc<Mutex<Gpu>>,
    picture: &Arc<Picture>,
    palette: &Palette,
) {
    let name = if model.comparing { format!("Surface {}", slot.name()) } else { "Surface".to_owned() };
    let response = ui.interact(rect, egui::Id::unique(keys::CANVASES[slot.index()]), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(Role::Canvas, true, &name));
    keys::take_arrows(ui, &response);
    ui.painter().rect_filled(rect, 4.0, palette.background);
    let aspect = rect.width() / rect.height().max(1.0);
    let on_obstacle = slot == Slot::A && drag_obstacle(ui, rect, model);
    if !on_obstacle {
        steer(ui, rect, model, &response);
    }
    let matrix = model.orbit.matrix(aspect);
    point_at(ui, rect, model, slot, &response, aspect);
    if response.clicked() {
        model.pin(model.hover);
    }

    let backward = model.orbit.backward();
    let (right, up) = model.orbit.axes();
    let scale = ui.ctx().pixels_per_point();
    let shorter = rect.height().min(rect.width());
    let size = model.runs[slot.index()].as_ref().filter(|_| model.shown.points);
    let size = size.map(|run| super::plane::point_size(run, shorter / model.orbit.height()) * scale);
    let (seen, to_seen) = on_view(ui, rect).unwrap_or((rect, Mat4::IDENTITY));
    let shot = Shot {
        matrix: to_seen * matrix,
        eye: model.orbit.eye(),
        light: Some((backward + 0.35 * up - 0.25 * right).normalize_or(Vec3::Z)),
        lift: 0.012 * model.orbit.radius,
        hover: model.hover.map(|p| p.face),
        wireframe: model.shown.wireframe,
        borders: model.shown.borders && model.runs[slot.index()].is_some(),
        points: size,
        ink: palette.ink,
        rim: palette.rim,
        covers: None,
        scale,
    };
    let place = slot.index();
    let (gpu, picture) = (Arc::clone(gpu), Arc::clone(picture));
    let callback = CallbackFn::new(move |_, painter| {
        if let Ok(mut gpu) = gpu.lock() {
            gpu.draw(painter.gl(), place, &picture, &shot);
        }
    });
    ui.painter().add(egui::PaintCallback { rect: seen, callback: Arc::new(callback) });

    let painter = ui.painter_at(rect);
    for (picked, colour) in [(model.pinned, Color32::from_rgb(255, 200, 0)), (model.hover, Color32::WHITE)] {
        if let Some(position) = picked.filter(|_| slot == Slot::A).and_then(|p| position(model, p)) {
            let at = on_screen(rect, matrix.project_point3(position).truncate());
            painter.circle_stroke(at, 8.0, Stroke::new(3.0, Color32::BLACK));
            painter.circle_stroke(at, 8.0, Stroke::new(1.5, colour));
        }
    }
    if let Some(obstacle) = model.occluder {
        let area = Rect::from_two_pos(on_screen(rect, obstacle.low), on_screen(rect, obstacle.high));
        painter.rect(
            area,
            2.0,
            Color32::from_rgba_unmultiplied(90, 90, 100, 210),
            Stroke::new(1.5, Color32::GRAY),
            StrokeKind::Inside,
        );
        painter.text(
            area.center(),
            Align2::CENTER_CENTER,
            "obstacle",
            FontId::proportional(13.0),
            Color32::WHITE,
        );
    }
    let method = model.settings[slot.index()].method.name();
    let title = if model.comparing { format!("{}: {method}", slot.name()) } else { "Surface".into() };
    painter.text(
        rect.left_top() + egui::vec2(8.0, 6.0),
        Align2::LEFT_TOP,
        title,
        FontId::proportional(13.0),
        ui.visuals().text_color(),
    );
    if response.has_focus() {
        painter.rect_stroke(rect, 4.0, ui.visuals().selection.stroke, StrokeKind::Inside);
    }
}

/// From clip space to the screen.
pub(super) fn on_screen(rect: Rect, clip: Vec2) -> Pos2 {
    rect.center() + egui::vec2(0.5 * rect.width() * clip.x, -0.5 * rect.height() * clip.y)
}

/// The part of a view that is on the screen, and what takes the view's clip space to that part's: a graphics card's
/// viewport ends at the screen, a view that is scrolled does not. `None` when nothing is to be seen.
pub(super) fn on_view(ui: &egui::Ui, rect: Rect) -> Option<(Rect, Mat4)> {
    let seen = rect.intersect(ui.ctx().content_rect());
    if !seen.is_positive() {
        return None;
    }
    let scale = Vec2::new(rect.width() / seen.width(), rect.height() / seen.height());
    let aside = rect.center() - seen.center();
    let shift = Vec2::new(2.0 * aside.x / seen.width(), -2.0 * aside.y / seen.height());
    Some((seen, Mat4::from_translation(shift.extend(0.0)) * Mat4::from_scale(scale.extend(1.0))))
}

/// From the screen to clip space.
pub(super) fn in_clip(rect: Rect, at: Pos2) -> Vec2 {
    let from = at - rect.center();
    Vec2::new(2.0 * from.x / rect.width(), -2.0 * from.y / rect.height())
}

/// Where a picked thing is: the point, or the middle of the triangle.
fn position(model: &Model, pick: Pick) -> Option<Vec3> {
    if let Some(point) = pick.point {
        return Some(model.runs[0].as_ref()?.points.get(point as usize)?.position);
    }
    let [a, b, c] = model.mesh.as_ref()?.triangle(pick.face);
    Some((a + b + c) / 3.0)
}

fn steer(ui: &egui::Ui, rect: Rect, model: &mut Model, response: &egui::Response) {
    // In a view higher than wide it is the width that shows what the camera's height says.
    let height = rect.height().min(rect.width()).max(1.0);
    let drag = response.drag_delta() / height;
    let drag = Vec2::new(drag.x, drag.y);
    let panning = ui.input(|i| i.modifiers.shift || i.pointer.secondary_down() || i.pointer.middle_down());
    let touch = ui.input(|i| i.multi_touch()).filter(|_| response.contains_pointer() || response.dragged());
    if let Some(touch) = touch {
        model.orbit.zoom(touch.zoom_delta);
        model.orbit.pan(Vec2::new(touch.translation_delta.x, touch.translation_delta.y) / height);
    } else if response.dragged() {
        if panning { model.orbit.pan(drag) } else { model.orbit.turn(drag) }
    } else if response.contains_pointer() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        model.orbit.zoom((scroll * 0.004).exp() * pinch);
    }
    if response.double_clicked() {
        model.reset_views();
    }
}

fn point_at(
    ui: &egui::Ui,
    rect: Rect,
    model: &mut Model,
    slot: Slot,
    response: &egui::Response,
    aspect: f32,
) {
    let moved = super::pointer_moved(ui) || response.clicked();
    if slot != Slot::A || !moved || response.dragged() {
        return;
    }
    let Some(at) = response.hover_pos() else { return };
    let Some(mesh) = model.mesh.clone() else { return };
    let clip = in_clip(rect, at);
    let (eye, direction) = model.orbit.ray(aspect, clip);
    let seen = pick::Seen { matrix: model.orbit.matrix(aspect), aspect, clip };
    model.hover = pick::on_surface(&mesh, model.runs[0].as_deref(), eye, direction, &seen);
}

/// Moves the obstacle with the pointer; whether it has the pointer.
fn drag_obstacle(ui: &mut egui::Ui, rect: Rect, model: &mut Model) -> bool {
    let Some(obstacle) = &mut model.occluder else { return false };
    let area =
        Rect::from_two_pos(on_screen(rect, obstacle.low), on_screen(rect, obstacle.high)).intersect(rect);
    let response = ui.interact(area, egui::Id::unique("obstacle"), Sense::drag());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(Role::Button, true, "Obstacle: drag it, or move it with I, J, K, L")
    });
    let drag = response.drag_delta();
    let step = Vec2::new(2.0 * drag.x / rect.width(), -2.0 * drag.y / rect.height());
    obstacle.low += step;
    obstacle.high += step;
    response.hovered() || response.dragged()
}
