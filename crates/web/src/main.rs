//! The page in a window: `ldwrap-web [MESH | #SETTINGS]`.

use std::path::Path;
use std::process::ExitCode;

use eframe::egui;
use ldwrap_web::app::App;
use ldwrap_web::settings::Link;
use ldwrap_web::source::Source;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (link, file) = match arguments.as_slice() {
        [] => (None, None),
        [settings] if settings.starts_with('#') => (Link::from_fragment(settings), None),
        [path] if !path.starts_with('-') => match Source::open(Path::new(path)) {
            Ok(source) => (None, Some(source)),
            Err(reason) => {
                eprintln!("ldwrap-web: {reason}");
                return ExitCode::FAILURE;
            }
        },
        _ => {
            eprintln!(
                "usage: ldwrap-web [MESH]\nOpens a window with the mesh: its strips, points and what a view sees."
            );
            return ExitCode::from(2);
        }
    };
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_title("ldwrap").with_inner_size([1400.0, 860.0]),
        depth_buffer: 24,
        multisampling: 4,
        ..Default::default()
    };
    let created =
        eframe::run_native("ldwrap", options, Box::new(|cc| Ok(Box::new(App::new(cc, link, file)?))));
    match created {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("ldwrap-web: {error}");
            ExitCode::FAILURE
        }
    }
}
