//! Pictures of strips and points: functions from values to bytes, no files.

mod palette;
mod plot;
mod preview;
mod svg;

pub(crate) use plot::{Line, Panel, error_plot};
pub(crate) use preview::{PreviewOptions, preview_png};
pub(crate) use svg::strips_svg;
