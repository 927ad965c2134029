//! The numbers: what is shown, irregularity, measures against random points, what the camera sees.

use eframe::egui::{self, Color32, RichText, Stroke, pos2, vec2};
use egui::accesskit::Role;

use super::theme;
use crate::judge::Measure;
use crate::model::Model;

/// Shows all numbers. `frame` is the time that a frame takes, in milliseconds.
pub(super) fn show(ui: &mut egui::Ui, model: &mut Model, frame: f64) {
    ui.add_space(4.0);
    ui.heading("What this view sees");
    view(ui, model);
    ui.separator();
    // Near the top: what is pointed at must be read without scrolling.
    ui.heading("Under the pointer");
    pointer(ui, model);
    ui.separator();
    ui.heading("This mesh");
    mesh(ui, model);
    ui.separator();
    ui.heading("Measures");
    measures(ui, model);
    ui.separator();
    ui.label(RichText::new(format!("{frame:.0} ms a frame while moving")).weak());
}

fn view(ui: &mut egui::Ui, model: &Model) {
    let Some(look) = model.look else {
        ui.label("not looked yet");
        return;
    };
    egui::Grid::new("view").num_columns(3).show(ui, |ui| {
        ui.label("visible surface");
        ui.strong(percent(look.surface));
        ui.label("");
        ui.end_row();
        for slot in model.slots() {
            let Some(points) = look.points[slot.index()] else { continue };
            let name =
                if model.comparing { format!("points of {}", slot.name()) } else { "visible points".into() };
            ui.label(name);
            ui.strong(percent(points));
            // Adding zero makes -0 a 0.
            let tenths = (1000.0 * (points - look.surface)).round() + 0.0;
            ui.label(format!("{:+.1} %", 0.1 * tenths));
            ui.end_row();
        }
    });
    trail(ui, model);
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// The error of the last views as a plot around zero.
fn trail(ui: &mut egui::Ui, model: &Model) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 70.0), egui::Sense::hover());
    let worst = model.trail.iter().flatten().flatten().fold(0.02_f64, |m, e| m.max(e.abs()));
    response.widget_info(|| {
        let name = format!(
            "Error of the visible share over the last {} views, at most {}",
            model.trail.len(),
            percent(worst)
        );
        egui::WidgetInfo::labeled(Role::Image, true, name)
    });
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let middle = rect.center().y;
    painter.hline(rect.x_range(), middle, Stroke::new(1.0, ui.visuals().weak_text_color()));
    let at = |k: usize, error: f64| {
        let x = rect.left() + rect.width() * (k as f32 + 0.5) / model.trail.len().max(40) as f32;
        pos2(x, middle - 0.46 * rect.height() * (error / worst) as f32)
    };
    for slot in model.slots() {
        let line: Vec<_> =
            model.trail.iter().enumerate().filter_map(|(k, step)| Some(at(k, step[slot.index()]?))).collect();
        let colour = theme::slot_colour(ui, slot.index());
        if let Some(last) = line.last() {
            painter.circle_filled(*last, 3.0, colour);
        }
        painter.line(line, Stroke::new(1.6, colour));
    }
    let text = format!("error, ±{}", percent(worst));
    let font = egui::FontId::proportional(11.0);
    painter.text(
        rect.left_top() + vec2(4.0, 2.0),
        egui::Align2::LEFT_TOP,
        text,
        font,
        ui.visuals().weak_text_color(),
    );
}

fn mesh(ui: &mut egui::Ui, model: &Model) {
    let (Some(mesh), Some(run)) = (&model.mesh, &model.runs[0]) else {
        ui.spinner();
        return;
    };
    let row = |ui: &mut egui::Ui, name: &str, value: String| {
        ui.label(name);
        ui.label(value);
        ui.end_row();
    };
    egui::Grid::new("mesh").num_columns(2).show(ui, |ui| {
        let r = &mesh.report;
        row(ui, "vertices", r.vertices.to_string());
        row(ui, "triangles", r.faces.to_string());
        row(ui, "components", r.components.to_string());
        row(ui, "border edges", r.border_edges.to_string());
        row(ui, "area", format!("{:.5}", r.area));
        row(ui, "strips", run.strips.len().to_string());
        let largest = run.strips.iter().map(|s| s.faces).max().unwrap_or(0);
        row(ui, "largest strip", format!("{largest} triangles"));
        row(ui, "points", run.points.len().to_string());
        row(ui, "mean distance d_m", format!("{:.5}", run.d_m));
        row(ui, "corrected", format!("{} moved, {} removed", run.projected, run.removed));
        let [bound, refined, exact] = run.irregularity;
        row(ui, "irregularity, eq. 8", format!("{bound:.3}"));
        row(ui, "refined", format!("{refined:.3}"));
        row(ui, "exact band", format!("{exact:.3}"));
        row(ui, "time", format!("{:.2} s", run.seconds));
    });
}

fn measures(ui: &mut egui::Ui, model: &Model) {
    ui.label(RichText::new("error, where 1 is that of random points").weak());
    // A and B next to each other, measure by measure.
    for measure in Measure::ALL {
        for slot in model.slots() {
            let mut verdicts = model.verdicts[slot.index()].iter();
            let Some((_, verdict)) = verdicts.find(|(of, _)| *of == measure) else { continue };
            let name = if model.comparing {
                format!("{} {}", slot.name(), measure.name())
            } else {
                measure.name().into()
            };
            if let Some(error) = verdict.error {
                bar(ui, &name, error, theme::slot_colour(ui, slot.index())).on_hover_text(measure.meaning());
            } else if !verdict.note.is_empty() {
                ui.label(name).on_hover_text(measure.meaning());
            }
            if !verdict.note.is_empty() {
                ui.label(RichText::new(&verdict.note).size(11.5).weak());
            }
        }
    }
}

/// A bar from 0 to 1 = random.
fn bar(ui: &mut egui::Ui, name: &str, error: f64, colour: Color32) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), egui::Sense::hover());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(Role::Meter, true, format!("{name}: {error:.3} of random"))
    });
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let mut filled = rect;
    filled.set_width(rect.width() * (error as f32).clamp(0.0, 1.0));
    painter.rect_filled(filled, 3.0, colour.gamma_multiply(0.55));
    let font = egui::FontId::proportional(12.5);
    let ink = ui.visuals().strong_text_color();
    painter.text(rect.left_center() + vec2(5.0, 0.0), egui::Align2::LEFT_CENTER, name, font.clone(), ink);
    painter.text(
        rect.right_center() - vec2(5.0, 0.0),
        egui::Align2::RIGHT_CENTER,
        format!("{error:.3}"),
        font,
        ink,
    );
    response
}

fn pointer(ui: &mut egui::Ui, model: &Model) {
    let shown = [("pinned", model.pinned), ("under the pointer", model.hover)];
    for (name, pick) in shown {
        if let Some(pick) = pick {
            ui.strong(name);
            for line in model.describe(pick) {
                ui.label(line);
            }
        }
    }
    if let Some(figure) = &model.figure {
        ui.strong("sample figure");
        ui.label(format!("{} rings, {} triangles", figure.rings, figure.faces.len()));
        ui.label(format!("falls into f_d = {} parts when unfolded", figure.degree));
        ui.label(format!("area {}, points {}", percent(figure.area_share), percent(figure.point_share)));
    }
    if model.pinned.is_none() && model.hover.is_none() {
        ui.label("Point at a strip, a triangle or a point; click to pin it and grow a sample figure.");
    }
}
