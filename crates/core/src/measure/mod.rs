//! Measures of any point set on a surface, ours, a peer's or random ones; they import no stage.
//!
//! Every measure takes the mesh and the points and compares shares of points with exact shares of area. The test
//! sets are fixed by the options, so the same points give the same bits on every run and any number of threads.
//! With no points every number of a report is NaN, except those that do not depend on the points.

pub mod decomposition;
mod norms;
mod patch;
pub mod plane;
mod view;

pub use norms::{Norms, Shares};
pub use patch::{PatchOptions, patch};
pub use view::{ViewOptions, ViewReport, Views, cameras, view};
