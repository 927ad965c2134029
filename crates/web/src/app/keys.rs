//! Every action by the keyboard.

use eframe::egui::{self, Key};
use glam::Vec2;

use crate::camera::{PlaneView, Up};
use crate::model::{Colouring, MOST_RINGS, Model};
use crate::scene::Layout;

/// What a key does, for the list that a person can open.
pub(super) const KEYS: [(&str, &str); 13] = [
    ("Arrows", "turn the surface; with Shift, move it"),
    ("+ and -", "come nearer, go away"),
    ("Tab", "to the next view or control; in the plane the keys above move the plane"),
    ("Home", "show all"),
    ("N and P", "pin the next, the previous point"),
    ("[ and ]", "smaller, larger sample figure"),
    ("W, B, D", "wireframe, band, points"),
    ("C", "colour by strip or by local surplus"),
    ("S", "strips side by side or in the domain"),
    ("A", "compare A and B"),
    ("U", "turn another axis up"),
    ("O; I J K L", "obstacle on and off; move it"),
    ("Escape", "stop the work, or unpin"),
];

/// The names of the views: surface A, surface B, plane.
pub(super) const CANVASES: [&str; 3] = ["surface A", "surface B", "plane"];

/// Takes the keys, unless a text is being typed.
pub(super) fn handle(ctx: &egui::Context, model: &mut Model) {
    if ctx.text_edit_focused() {
        return;
    }
    let pressed = |key| ctx.input(|i| i.modifiers.is_none() && i.key_pressed(key));
    // A slider that has the focus takes the arrows for itself.
    let free =
        ctx.memory(egui::Memory::focused).is_none_or(|id| CANVASES.map(egui::Id::unique).contains(&id));
    let (arrows, shift) = ctx.input(|i| (if free { arrows(i) } else { Vec2::ZERO }, i.modifiers.shift));
    let in_plane = ctx.memory(egui::Memory::focused) == Some(egui::Id::unique(CANVASES[2]));
    if arrows != Vec2::ZERO && !in_plane {
        if shift { model.orbit.pan(0.05 * arrows) } else { model.orbit.turn(0.05 * arrows) }
    }
    if !in_plane {
        model.orbit.zoom(nearer(ctx));
    }
    if pressed(Key::Home) {
        model.reset_views();
    }
    if pressed(Key::N) {
        model.pin_neighbour(1);
    }
    if pressed(Key::P) {
        model.pin_neighbour(-1);
    }
    if pressed(Key::OpenBracket) && model.rings > 0 {
        model.rings -= 1;
        model.grow();
    }
    if pressed(Key::CloseBracket) && model.rings < MOST_RINGS {
        model.rings += 1;
        model.grow();
    }
    for (key, flag) in [
        (Key::W, &mut model.shown.wireframe),
        (Key::B, &mut model.shown.band),
        (Key::D, &mut model.shown.points),
        (Key::A, &mut model.comparing),
    ] {
        *flag ^= pressed(key);
    }
    if pressed(Key::C) {
        model.colouring = match model.colouring {
            Colouring::Strip => Colouring::Local,
            Colouring::Local => Colouring::Strip,
        };
    }
    if pressed(Key::S) {
        model.layout = match model.layout {
            Layout::Apart => Layout::Domain,
            Layout::Domain => Layout::Apart,
        };
        model.plane = None;
    }
    if pressed(Key::U) {
        model.orbit.up = match model.orbit.up {
            Up::Y => Up::Z,
            Up::Z => Up::Y,
        };
    }
    if pressed(Key::O) {
        model.toggle_occluder();
    }
    if let Some(obstacle) = &mut model.occluder {
        for (key, step) in
            [(Key::I, Vec2::Y), (Key::K, Vec2::NEG_Y), (Key::J, Vec2::NEG_X), (Key::L, Vec2::X)]
        {
            if pressed(key) {
                obstacle.low += 0.05 * step;
                obstacle.high += 0.05 * step;
            }
        }
    }
    if pressed(Key::Escape) {
        if model.is_busy() { model.cancel() } else { model.pin(None) }
    }
}

/// The factor by which the keys come nearer.
fn nearer(ctx: &egui::Context) -> f32 {
    const STEP: f32 = 1.15;
    let presses = |key| ctx.input(|i| i.num_presses(key)) as i32;
    STEP.powi(presses(Key::Plus) + presses(Key::Equals) - presses(Key::Minus))
}

/// Moves the plane by the keyboard while it has the focus.
pub(super) fn steer_plane(ctx: &egui::Context, view: &mut PlaneView, aspect: f32) {
    view.pan(-0.05 * ctx.input(arrows));
    view.zoom(aspect, Vec2::ZERO, nearer(ctx));
}

fn arrows(input: &egui::InputState) -> Vec2 {
    let axis = |less, more| input.num_presses(more) as f32 - input.num_presses(less) as f32;
    Vec2::new(axis(Key::ArrowLeft, Key::ArrowRight), axis(Key::ArrowUp, Key::ArrowDown))
}

/// Gives a view that is clicked the focus, and lets it take the arrows as long as it has it.
pub(super) fn take_arrows(ui: &egui::Ui, view: &egui::Response) {
    if view.clicked() && !view.has_focus() {
        view.request_focus();
    }
    if view.gained_focus() {
        // Only from its second frame on can a view keep the arrows; that frame must not wait for an arrow.
        ui.ctx().request_repaint();
    }
    if view.has_focus() {
        // An arrow that came before the filter held would still move the focus.
        if ui.input(arrows) != Vec2::ZERO {
            ui.memory_mut(|m| m.move_focus(egui::FocusDirection::None));
        }
        let filter =
            egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
        ui.memory_mut(|m| m.set_focus_lock_filter(view.id, filter));
    }
}
