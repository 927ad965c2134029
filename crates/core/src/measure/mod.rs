//! Measures of any point set on a surface, ours, a peer's or random ones; they import no stage.
//!
//! Every measure takes the mesh and the points and compares shares of points with exact shares of area. The test
//! sets are fixed by the options, so the same points give the same bits on every run and any number of threads.
//! With no points every number of a report is NaN, except those that do not depend on the points. A measure that
//! is cancelled returns early with a report that is not to be used.

mod ball;
mod cells;
mod component;
pub mod decomposition;
mod energy;
mod half_space;
mod halving;
mod integration;
mod norms;
mod patch;
pub mod plane;
mod profile;
mod spacing;
mod testset;
mod tree;
mod view;

#[cfg(test)]
mod testmesh;
#[cfg(test)]
mod tests;

pub use ball::{Ball, BallOptions, BallReport, Balls, ball};
pub use cells::cell_areas;
pub use component::{ComponentReport, ComponentShare, components};
pub use energy::{EnergyOptions, EnergyPlanes, EnergyReport, energy};
pub use half_space::{HalfSpace, HalfSpaceOptions, HalfSpaceReport, HalfSpaces, half_space};
pub use integration::{IntegrationOptions, IntegrationReport, TestFunctions, integration};
pub use norms::{Norms, Shares};
pub use patch::{PatchOptions, patch};
pub use spacing::{SpacingOptions, SpacingReport, spacing};
pub use view::{ViewOptions, ViewReport, Views, cameras, view};
