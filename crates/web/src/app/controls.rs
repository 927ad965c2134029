//! The controls: mesh, points, segmentation, method, what is drawn, files to take away.

use eframe::egui::{self, ComboBox, DragValue, RichText, Slider, ThemePreference};
use ldwrap::pipeline::Request;
use ldwrap::segment::GrowthOrder;
use ldwrap::sequence::Sequence;
use ldwrap::shapes::Shape;

use super::files::{self, Inbox};
use super::keys::KEYS;
use crate::camera::Up;
use crate::engine::Slot;
use crate::export::Export;
use crate::model::{Colouring, MOST_RINGS, Model, Notice};
use crate::scene::Layout;
use crate::settings::{Method, Settings};
use crate::source::Source;

/// The list of shapes and the file button.
pub(super) fn mesh_chooser(ui: &mut egui::Ui, model: &mut Model, inbox: &Inbox) {
    let shown = model.shape();
    let name = match (shown, &model.mesh) {
        (Some(shape), _) => shape.name().to_owned(),
        (None, Some(mesh)) => mesh.name.clone(),
        (None, None) => String::new(),
    };
    let chosen = ComboBox::from_id_salt("shape").selected_text(name).show_ui(ui, |ui| {
        let mut chosen = None;
        for shape in Shape::ALL {
            if ui.selectable_label(shown == Some(shape), shape.name()).clicked() {
                chosen = Some(shape);
            }
        }
        chosen
    });
    label(&chosen.response, "Mesh");
    if let Some(shape) = chosen.inner.flatten() {
        model.load(Source::Shape(shape));
    }
    let open = ui
        .button("Open a file")
        .on_hover_text("OBJ, GLB, PLY, STL or OFF; or drop it anywhere. It stays on this machine.");
    if open.clicked() {
        inbox.ask();
    }
}

/// The menu of files to take away.
pub(super) fn take_away(ui: &mut egui::Ui, model: &mut Model) {
    ui.menu_button("Take away", |ui| {
        for what in Export::ALL {
            if ui.button(what.name()).clicked() {
                model.export(what);
            }
        }
        if ui.button("Picture, PNG").clicked() {
            model.picture_wanted = true;
        }
        if ui.button("Link with these settings").clicked() {
            ui.ctx().copy_text(files::address(&model.link()));
            model.notice = Some(Notice::Done("the link is in the clipboard".into()));
        }
    });
}

/// Dark, light, or as the system has it.
pub(super) fn theme(ui: &mut egui::Ui) {
    let mut theme = ui.ctx().options(|o| o.theme_preference);
    let all = [ThemePreference::System, ThemePreference::Light, ThemePreference::Dark];
    let names = ["as the system", "light", "dark"];
    let shown = all.iter().position(|t| *t == theme).map_or("", |k| names[k]);
    let chosen = ComboBox::from_id_salt("theme").selected_text(shown).width(100.0).show_ui(ui, |ui| {
        for (value, name) in all.into_iter().zip(names) {
            ui.selectable_value(&mut theme, value, name);
        }
    });
    label(&chosen.response, "Colours of the page");
    ui.ctx().set_theme(theme);
}

/// All other controls.
pub(super) fn show(ui: &mut egui::Ui, model: &mut Model) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        ui.heading("Points");
        ui.checkbox(&mut model.comparing, "compare A and B");
    });
    if model.comparing {
        for slot in Slot::ALL {
            egui::CollapsingHeader::new(format!("{} of the two", slot.name())).default_open(true).show(
                ui,
                |ui| {
                    settings(ui, &mut model.settings[slot.index()], slot);
                },
            );
        }
    } else {
        settings(ui, &mut model.settings[0], Slot::A);
    }
    ui.separator();
    ui.heading("View");
    ui.horizontal_wrapped(|ui| {
        ui.checkbox(&mut model.shown.points, "points");
        ui.checkbox(&mut model.shown.wireframe, "wireframe");
        ui.checkbox(&mut model.shown.borders, "cuts");
        ui.checkbox(&mut model.shown.band, "irregular band");
    });
    ui.horizontal_wrapped(|ui| {
        ui.label("Colour by");
        ui.radio_value(&mut model.colouring, Colouring::Strip, "strip");
        ui.radio_value(&mut model.colouring, Colouring::Local, "local surplus")
            .on_hover_text("Blue: points too thin here. Orange: too dense.");
    });
    ui.horizontal_wrapped(|ui| {
        ui.label("Strips");
        let before = model.layout;
        ui.radio_value(&mut model.layout, Layout::Apart, "side by side");
        ui.radio_value(&mut model.layout, Layout::Domain, "in the domain").on_hover_text(
            "Where the points were scattered. Strips may cover each other: each catches its own points.",
        );
        if model.layout != before {
            model.plane = None;
        }
    });
    ui.horizontal_wrapped(|ui| {
        let mut obstacle = model.occluder.is_some();
        if ui
            .checkbox(&mut obstacle, "obstacle")
            .on_hover_text("Something in the way: drag it over the surface.")
            .changed()
        {
            model.toggle_occluder();
        }
        if ui.button("Show all").clicked() {
            model.reset_views();
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.label("Up");
        ui.radio_value(&mut model.orbit.up, Up::Y, "y");
        ui.radio_value(&mut model.orbit.up, Up::Z, "z");
        if let Some(mesh) = model.mesh.as_ref().filter(|m| m.up.0 == model.orbit.up) {
            ui.label(RichText::new(mesh.up.1.words()).weak());
        }
    });
    let mut rings = model.rings;
    if slider(ui, "Sample figure, rings", Slider::new(&mut rings, 0..=MOST_RINGS)) {
        model.rings = rings;
        model.grow();
    }
    ui.separator();
    egui::CollapsingHeader::new("Keys").show(ui, |ui| {
        egui::Grid::new("keys").show(ui, |ui| {
            for (key, what) in KEYS {
                ui.strong(key);
                ui.label(what);
                ui.end_row();
            }
        });
    });
}

fn settings(ui: &mut egui::Ui, settings: &mut Settings, slot: Slot) {
    ui.push_id(slot.index(), |ui| {
        choose(ui, "Method", &mut settings.method, &Method::ALL.map(|m| (m, m.name())));
        request(ui, &mut settings.request);
        let wraps = settings.method == Method::Wrap;
        ui.add_enabled_ui(wraps, |ui| ui.checkbox(&mut settings.equalize, "equalize"));
        sequence(ui, &mut settings.sequence);
        number(ui, "Seed", DragValue::new(&mut settings.seed).speed(0.1));
        slider(ui, "Flatness angle", Slider::new(&mut settings.flatness_angle, 0.0..=180.0).suffix("°"));
        ui.add_enabled_ui(wraps, |ui| {
            let orders = [
                (GrowthOrder::LeastOpen, "least open border"),
                (GrowthOrder::Rehung, "least open border, rehung"),
                (GrowthOrder::FlattestFirst, "flattest first"),
                (GrowthOrder::BoundaryWalk, "along the boundary"),
                (GrowthOrder::LongestFirst, "longest first"),
            ];
            choose(ui, "Growth", &mut settings.growth, &orders);
        });
        slider(
            ui,
            "Smallest strip",
            Slider::new(&mut settings.smallest_share, 0.0..=0.1)
                .custom_formatter(|v, _| format!("{:.1} %", 100.0 * v)),
        );
        slider(ui, "Tolerance", Slider::new(&mut settings.tolerance, 0.0..=1.0).suffix(" d_m"));
        if ui.button("Defaults").clicked() {
            *settings = Settings { method: settings.method, ..Settings::default() };
        }
    });
}

fn request(ui: &mut egui::Ui, request: &mut Request) {
    let kinds = ["number", "density", "spacing", "irregularity"];
    let kind = match request {
        Request::Count(_) => 0,
        Request::Density(_) => 1,
        Request::Spacing(_) => 2,
        Request::Irregularity(_) => 3,
    };
    let mut wanted = kind;
    choose(ui, "Ask for", &mut wanted, &[(0, kinds[0]), (1, kinds[1]), (2, kinds[2]), (3, kinds[3])]);
    if wanted != kind {
        *request = match wanted {
            0 => Request::Count(1000),
            1 => Request::Density(100.0),
            2 => Request::Spacing(0.1),
            _ => Request::Irregularity(0.5),
        };
    }
    match request {
        Request::Count(n) => {
            slider(ui, "Number of points", Slider::new(n, 1..=200_000).logarithmic(true));
        }
        Request::Density(d) => number(ui, "Points per area", DragValue::new(d).range(1e-9..=1e9).speed(1.0)),
        Request::Spacing(s) => number(ui, "Mean distance", DragValue::new(s).range(1e-6..=1e9).speed(0.001)),
        Request::Irregularity(r) => {
            slider(ui, "Largest R", Slider::new(r, 0.05..=2.0).logarithmic(true));
        }
    }
}

fn sequence(ui: &mut egui::Ui, sequence: &mut Sequence) {
    let all = [
        (Sequence::Hammersley { base: 2 }, "Hammersley"),
        (Sequence::Halton { bases: [2, 3] }, "Halton"),
        (Sequence::Sobol { seed: 0 }, "Sobol, scrambled"),
        (Sequence::R2, "R2"),
        (Sequence::Fibonacci, "Fibonacci"),
    ];
    choose(ui, "Sequence", sequence, &all);
}

fn choose<T: PartialEq + Copy>(ui: &mut egui::Ui, name: &str, value: &mut T, all: &[(T, &str)]) {
    ui.horizontal(|ui| {
        let text = ui.label(name).id;
        let shown = all.iter().find(|(v, _)| v == value).map_or("", |(_, n)| n);
        let combo = ComboBox::from_id_salt(name).selected_text(shown).show_ui(ui, |ui| {
            for (v, n) in all {
                ui.selectable_value(value, *v, *n);
            }
        });
        combo.response.labelled_by(text);
    });
}

/// A slider with its name; whether it changed.
fn slider(ui: &mut egui::Ui, name: &str, slider: Slider<'_>) -> bool {
    let text = ui.label(name).id;
    ui.add(slider).labelled_by(text).changed()
}

fn number(ui: &mut egui::Ui, name: &str, value: DragValue<'_>) {
    ui.horizontal(|ui| {
        let text = ui.label(name).id;
        ui.add(value).labelled_by(text);
    });
}

/// Names a control that has no visible name.
fn label(response: &egui::Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}
