//! Spreads points over the surface of any polygon mesh so that every part of it holds its fair share of them.

pub mod baseline;
pub mod correct;
pub mod domain;
pub mod equalize;
pub mod geometry;
mod ids;
pub mod io;
pub mod irregularity;
pub mod measure;
mod mesh;
mod parallel;
pub mod pipeline;
#[cfg(test)]
mod planted;
mod progress;
mod random;
mod request;
mod sample;
pub mod segment;
pub mod sequence;
pub mod spatial;
pub mod unfold;
pub mod wrap;

pub use ids::{FaceId, HalfedgeId, PolygonId, StripId, VertexId};
pub use mesh::{
    CheckOptions, Components, FaceSource, MeshError, PolygonSoup, RepairReport, SurfaceMesh, Topology, shapes,
};
pub use progress::{Progress, Silent};
pub use sample::{Origin, Sample, SurfacePoint};
