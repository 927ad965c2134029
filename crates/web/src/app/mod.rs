//! Draws the model with egui and turns gestures into calls on it. Holds no state of its own but what drawing needs.

mod controls;
mod draw;
mod files;
mod keys;
mod link;
#[cfg(target_arch = "wasm32")]
mod mirror;
mod plane;
mod readouts;
mod surface;
mod theme;
mod watch;

use std::sync::{Arc, Mutex};

use eframe::egui::{self, Align2, FontId, RichText};

use crate::engine::{Job, Slot};
use crate::model::{Desk, Model, NamedFile, Notice};
use crate::settings::Link;
use crate::source::Source;
use draw::{Gpu, Picture};
use files::Inbox;
use link::EngineLink;
use theme::Palette;
use watch::Frames;

/// Below this width everything stands in one column.
const NARROW: f32 = 760.0;

/// The app: the model, its engines, and what is drawn.
pub struct App {
    /// The state.
    pub model: Model,
    maker: EngineLink,
    looker: EngineLink,
    judge: EngineLink,
    inbox: Inbox,
    gpu: Arc<Mutex<Gpu>>,
    pictures: Pictures,
    /// The time that frames take.
    frames: Frames,
    /// Pictures that were taken and wait to be saved.
    taken: Arc<Mutex<Vec<NamedFile>>>,
    saved: Vec<(String, usize)>,
}

/// What the graphics card is to show: the surface of A and of B, and the plane of A.
#[derive(Default)]
struct Pictures {
    surfaces: [Arc<Picture>; 2],
    plane: Arc<Picture>,
    drawn: [watch::Drawn; 3],
}

impl App {
    /// Opens the page with a link's settings or, in a window, with a person's file.
    ///
    /// # Errors
    /// When the graphics cannot draw it.
    pub fn new(
        context: &eframe::CreationContext<'_>,
        link: Option<Link>,
        file: Option<Source>,
    ) -> Result<Self, String> {
        let gl = context.gl.as_ref().ok_or("no OpenGL")?;
        let gpu = Arc::new(Mutex::new(Gpu::new(gl)?));
        let mut model = Model::open(link);
        if let Some(file) = file {
            model.load(file);
        }
        let repaint = context.egui_ctx.clone();
        let wake = move || repaint.request_repaint();
        context.egui_ctx.all_styles_mut(|style| {
            style.interaction.tooltip_delay = 0.3;
            style.spacing.slider_width = 130.0;
            // Weak text too has the contrast of WCAG's level AA, 4.5 to 1, on both grounds.
            style.visuals.weak_text_alpha = 0.92;
        });
        #[cfg(target_arch = "wasm32")]
        mirror::install(&context.egui_ctx);
        let mut app = Self {
            model,
            maker: EngineLink::new(wake.clone()),
            looker: EngineLink::new(wake.clone()),
            judge: EngineLink::new(wake),
            inbox: Inbox::new(context.egui_ctx.clone()),
            gpu,
            pictures: Pictures::default(),
            frames: Frames::default(),
            taken: Arc::default(),
            saved: Vec::new(),
        };
        // The maker loads and wraps while the first frame is drawn.
        app.post();
        Ok(app)
    }

    /// The state as JSON, for tests of the page.
    pub fn inspect(&self) -> serde_json::Value {
        let mut state = self.model.inspect();
        state["saved"] = self.saved.iter().map(|(name, size)| serde_json::json!([name, size])).collect();
        state["frameMilliseconds"] = self.frames.mean().into();
        state["firstPictureSeconds"] = self.frames.first_picture().into();
        state
    }

    /// Carries jobs to the engines, answers and files to the model.
    fn exchange(&mut self, ctx: &egui::Context) {
        for answer in self.maker.take() {
            self.model.receive(answer);
        }
        for answer in self.judge.take() {
            self.model.receive_verdict(answer);
        }
        for answer in self.looker.take() {
            self.model.receive_look(answer);
        }
        for arrived in self.inbox.take() {
            match arrived {
                Ok(source) => self.model.load(source),
                Err(reason) => self.model.notice = Some(Notice::Problem(reason)),
            }
        }
        self.inbox.take_dropped(ctx);
        if std::mem::take(&mut self.model.picture_wanted) {
            self.take_picture(ctx);
        }
        if let Ok(mut taken) = self.taken.lock() {
            self.model.files.append(&mut taken);
        }
        for (name, bytes) in self.model.files.drain(..) {
            self.saved.push((name.clone(), bytes.len()));
            if let Err(reason) = files::save(&name, bytes) {
                self.model.notice = Some(Notice::Problem(reason));
            }
        }
        // Settings are taken over when the pointer lets go, not at every step of a slider.
        if !ctx.input(|i| i.pointer.any_down()) {
            self.model.settle();
        }
        for desk in self.model.take_cancels() {
            match desk {
                Desk::Maker => self.maker.cancel(),
                Desk::Judge => self.judge.cancel(),
                Desk::Looker => self.looker.cancel(),
            }
        }
        if self.post() {
            ctx.request_repaint();
        }
    }

    /// Posts the jobs that wait, each to its engine; whether a mesh is among them.
    fn post(&mut self) -> bool {
        let mut loads = false;
        for (desk, job) in self.model.take_jobs() {
            loads |= matches!(job, Job::Load(_));
            match desk {
                Desk::Maker => self.maker.post(job),
                Desk::Judge => self.judge.post(job),
                Desk::Looker => self.looker.post(job),
            }
        }
        loads
    }

    /// Asks for a picture of the page; it arrives a frame or two later.
    fn take_picture(&self, ctx: &egui::Context) {
        let name =
            self.model.mesh.as_ref().map_or("ldwrap", |m| m.name.split('.').next().unwrap_or("ldwrap"));
        let name = format!("{name}.png");
        let (taken, repaint) = (Arc::clone(&self.taken), ctx.clone());
        let callback = egui::ScreenshotCallback::new(move |image| {
            if let (Ok(bytes), Ok(mut taken)) = (files::png(&image), taken.lock()) {
                taken.push((name, bytes));
            }
            repaint.request_repaint();
        });
        ctx.send_viewport_cmd(egui::ViewportCommand::Screenshot(callback));
    }

    fn top_bar(&mut self, ui: &mut egui::Ui, narrow: bool) {
        egui::Panel::top("top").show(ui, |ui| {
            let row = |ui: &mut egui::Ui, app: &mut Self| {
                ui.heading("ldwrap");
                controls::mesh_chooser(ui, &mut app.model, &app.inbox);
                controls::take_away(ui, &mut app.model);
                controls::theme(ui);
                if app.model.is_busy() {
                    if ui.button("Stop").clicked() {
                        app.model.cancel();
                    }
                    let (stage, share) = app.model.stage.clone().unwrap_or_default();
                    ui.label(share.map_or(stage.clone(), |s| format!("{stage} {:.0}%", 100.0 * s)));
                } else {
                    ui.label(RichText::new("Your mesh stays on this machine.").weak());
                }
            };
            if narrow {
                ui.horizontal_wrapped(|ui| row(ui, self));
            } else {
                ui.horizontal(|ui| row(ui, self));
            }
            let notice = self.model.notice.clone();
            if let Some(notice) = notice {
                ui.horizontal_wrapped(|ui| {
                    match &notice {
                        Notice::Done(text) => ui.label(text),
                        Notice::Problem(text) => ui.colored_label(ui.visuals().error_fg_color, text),
                    };
                    if ui.small_button("Dismiss").clicked() {
                        self.model.notice = None;
                    }
                });
            }
        });
    }

    fn wide(&mut self, ui: &mut egui::Ui, frame: &eframe::Frame) {
        egui::Panel::left("controls").default_size(270.0).show(ui, |ui| {
            egui::ScrollArea::vertical().show(ui, |ui| controls::show(ui, &mut self.model));
        });
        egui::Panel::right("readouts").default_size(290.0).show(ui, |ui| {
            egui::ScrollArea::vertical()
                .show(ui, |ui| readouts::show(ui, &mut self.model, self.frames.mean()));
        });
        egui::CentralPanel::default().frame(egui::Frame::NONE.fill(ui.visuals().panel_fill)).show(ui, |ui| {
            let area = ui.available_rect_before_wrap();
            let (plane, surface) = area.split_left_right_at_fraction(0.45);
            self.plane_view(ui, plane.shrink(2.0), frame);
            self.surface_views(ui, surface.shrink(2.0), frame);
        });
    }

    fn narrow(&mut self, ui: &mut egui::Ui, frame: &eframe::Frame) {
        egui::CentralPanel::default().show(ui, |ui| {
            egui::ScrollArea::vertical().show(ui, |ui| {
                let width = ui.available_width();
                for surface in [true, false] {
                    // A view never fills the screen: there must be room to scroll past it.
                    let most = 0.72 * ui.ctx().content_rect().height();
                    let height = (if surface { 0.9 * width } else { 0.7 * width }).min(most);
                    let (rect, _) = ui.allocate_exact_size(egui::vec2(width, height), egui::Sense::empty());
                    if surface {
                        self.surface_views(ui, rect, frame);
                    } else {
                        self.plane_view(ui, rect, frame);
                    }
                    ui.add_space(6.0);
                }
                readouts::show(ui, &mut self.model, self.frames.mean());
                ui.separator();
                controls::show(ui, &mut self.model);
            });
        });
    }

    fn plane_view(&mut self, ui: &mut egui::Ui, rect: egui::Rect, frame: &eframe::Frame) {
        let palette = Palette::new(ui.visuals().dark_mode);
        watch::redraw_plane(&mut self.pictures, &self.model, &palette);
        plane::show(ui, rect, &mut self.model, &self.gpu, &self.pictures.plane, &palette);
        let _ = frame;
    }

    fn surface_views(&mut self, ui: &mut egui::Ui, rect: egui::Rect, frame: &eframe::Frame) {
        let palette = Palette::new(ui.visuals().dark_mode);
        let slots: Vec<Slot> = self.model.slots().collect();
        let width = rect.width() / slots.len() as f32;
        for (k, slot) in slots.iter().enumerate() {
            watch::redraw_surface(&mut self.pictures, &self.model, *slot, &palette);
            let left = rect.left() + width * k as f32;
            let part =
                egui::Rect::from_min_size(egui::pos2(left, rect.top()), egui::vec2(width, rect.height()));
            surface::show(
                ui,
                part.shrink(1.0),
                &mut self.model,
                *slot,
                &self.gpu,
                &self.pictures.surfaces[slot.index()],
                &palette,
            );
        }
        self.model.watch(width / rect.height());
        let _ = frame;
    }
}

/// Whether the pointer was moved since the last frame.
fn pointer_moved(ui: &egui::Ui) -> bool {
    ui.input(|i| i.events.iter().any(|e| matches!(e, egui::Event::PointerMoved(_))))
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.frames.count(&ctx);
        self.frames.shown(&ctx, self.model.runs[0].is_some());
        self.exchange(&ctx);
        let narrow = ui.available_width() < NARROW;
        self.top_bar(ui, narrow);
        if narrow {
            self.narrow(ui, frame);
        } else {
            self.wide(ui, frame);
        }
        if ctx.input(|i| !i.raw.hovered_files.is_empty()) {
            let painter =
                ctx.layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
            let rect = ctx.content_rect();
            painter.rect_filled(rect, 0.0, egui::Color32::from_black_alpha(160));
            let text = "Drop an OBJ, GLB, PLY, STL or OFF file: it stays on this machine";
            painter.text(
                rect.center(),
                Align2::CENTER_CENTER,
                text,
                FontId::proportional(20.0),
                egui::Color32::WHITE,
            );
        }
        // Last, because only now a view that was clicked in this frame has the focus.
        keys::handle(&ctx, &mut self.model);
        // What the frame changed is posted at once, not when the next one happens to come.
        self.exchange(&ctx);
        #[cfg(target_arch = "wasm32")]
        mirror::tell(&self.model.status());
    }

    fn on_exit(&mut self, gl: Option<&eframe::glow::Context>) {
        if let (Some(gl), Ok(mut gpu)) = (gl, self.gpu.lock()) {
            gpu.free(gl);
        }
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}
