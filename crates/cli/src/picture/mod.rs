//! Pictures of strips and points: functions from values to bytes, no files.

mod camera;
mod layout;
mod palette;
mod preview;
mod raster;
mod svg;
#[cfg(test)]
mod tests;

pub(crate) use preview::{PreviewOptions, preview_png};
pub(crate) use svg::strips_svg;
