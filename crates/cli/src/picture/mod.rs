//! Pictures of strips and points: functions from values to bytes, no files.

mod camera;
mod layout;
mod palette;
mod plot;
mod preview;
mod raster;
mod svg;
#[cfg(test)]
mod tests;

pub(crate) use plot::{Line, Panel, error_plot};
pub(crate) use preview::{PreviewOptions, preview_png};
pub(crate) use svg::strips_svg;
