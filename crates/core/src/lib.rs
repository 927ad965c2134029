//! Spreads points over the surface of any polygon mesh so that every part of it, every view of it and every piece
//! left visible behind an obstacle holds its fair share of them.
//!
//! The method is that of the paper "Low-Discrepancy Distribution of Points on Arbitrary Polygonal 3D-surfaces";
//! section numbers here and below are its. Each stage takes a value and makes another; [`pipeline::run`] chains them
//! and keeps every value.
//!
//! | stage | from | to | paper |
//! |---|---|---|---|
//! | [`io::read_mesh`] | bytes of a file | [`PolygonSoup`] | |
//! | [`SurfaceMesh::from_soup`] | [`PolygonSoup`] | [`SurfaceMesh`], [`RepairReport`] | |
//! | [`segment::segment`] | [`SurfaceMesh`] | [`segment::Segmentation`] | 4.1 |
//! | [`unfold::unfold`] | [`segment::Segmentation`] | [`unfold::Strips`] | 4.1 |
//! | [`domain::PlanarDomain::lay_out`] | [`unfold::Strips`] | [`domain::PlanarDomain`] | 4.2, 1 and 3 |
//! | [`domain::DomainPoints::scatter`] | [`domain::PlanarDomain`], [`sequence::Sequence`] | [`domain::DomainPoints`] | 3; 4.2, 2 |
//! | [`wrap::wrap`] | [`domain::DomainPoints`], [`unfold::Strips`] | [`wrap::Wrapping`] | 4.2, 4 |
//! | [`correct::correct`] | [`wrap::Wrapping`] | [`Sample`]s | 4.2, 5 |
//! | [`equalize::equalize`] | [`SurfacePoint`]s of any origin | [`SurfacePoint`]s | beyond it |
//!
//! [`irregularity`] says how much of the surface lies beside torn borders (4.3). [`measure`] judges any points on a
//! surface, whoever made them, and [`baseline`] makes others to compare with. A [`density`] makes points denser in places,
//! inside large faces after [`refine`]; [`quota`] gives each connected component its number of points; [`io::Model::clip`] keeps
//! what lies in a box, [`io::Model::retain`] some polygons. [`shapes`] generates meshes, [`spatial`] answers
//! what can be seen and what is nearest, and the readers and writers of `io` take and give bytes.
//!
//! The short path, with nothing to decide but the number of points, is [`sample`]; the long one keeps every value:
//!
//! ```
//! use ldwrap::pipeline::{Options, run};
//! use ldwrap::shapes::Shape;
//! use ldwrap::{CheckOptions, Silent, SurfaceMesh};
//!
//! // A mesh: here the paper's sphere; io::read_mesh makes a soup of a file's bytes.
//! let (mesh, repairs) = SurfaceMesh::from_soup(&Shape::Sphere.generate(), &CheckOptions::default())?;
//! assert!(repairs.is_clean());
//!
//! // Points: exactly as many as asked for.
//! let options = Options { seed: 7, ..Options::for_count(192) };
//! let run = run(&mesh, &options, &Silent)?;
//! assert_eq!(run.samples.len(), 192);
//!
//! // What the stages made.
//! assert_eq!(run.strips.strips.len(), 1);
//! assert!(run.irregularity().exact <= 1.0);
//! for place in run.places(&mesh) {
//!     assert!((0.97..=1.0 + 1e-12).contains(&place.length()));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The same mesh, options and seed give the same bits on every run, with any number of threads, natively and in wasm.
//! Errors arise where bytes become a mesh and where options cannot be met; a stage on a checked mesh does not fail.
//!
//! Features: `io` (default; one feature a format: `obj`, `gltf`, `ply`, `stl`, `csv`,
//! `json`, `npz`, `gz`, `textures`), `parallel` (default; uses
//! every core; also called `rayon`), `serde` (options, reports and samples as data: fields that are left out have their
//! default, unknown ones are refused). With none of them the library compiles for wasm.

pub mod attributes;
pub mod baseline;
mod buckets;
pub mod correct;
pub mod density;
pub mod domain;
pub mod equalize;
pub mod geometry;
mod halves;
mod ids;
pub mod io;
pub mod irregularity;
mod lanes;
pub mod measure;
mod mesh;
mod parallel;
pub mod pipeline;
#[cfg(test)]
mod planted;
mod progress;
pub mod progressive;
pub mod quota;
mod random;
pub mod refine;
mod request;
mod sample;
pub mod segment;
mod selection;
pub mod sequence;
mod sets;
mod shares;
mod short;
pub mod spatial;
pub mod unfold;
pub mod wrap;

pub use ids::{FaceId, HalfedgeId, PolygonId, StripId, VertexId};
pub use mesh::{
    CheckOptions, Components, FaceSource, MeshError, PolygonSoup, RepairReport, SurfaceMesh, Topology, shapes,
};
pub use progress::{Progress, Silent};
pub use sample::{Origin, Sample, SurfacePoint};
pub use short::sample;

/// Runs the example of the README.
#[cfg(all(doctest, feature = "io"))]
#[doc = include_str!("../README.md")]
struct Readme;
