//! From polygon soup, as files give it, to a checked, immutable surface.

mod check;
mod defect;
mod polygon;
pub mod shapes;
mod soup;
mod surface;
mod topology;
mod weld;

pub use check::CheckOptions;
pub use defect::{MeshError, RepairReport};
pub use soup::PolygonSoup;
pub use surface::{FaceSource, SurfaceMesh};
pub use topology::{Components, Topology};
