//! What the fuzz targets call. `tests/hostile.rs` of the workspace replays the corpus through the same functions.

#[path = "../../../../tests/checks.rs"]
mod checks;
pub mod readers;
pub mod soups;
