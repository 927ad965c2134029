//! Readers and writers: bytes in, bytes out, one file a format.

mod clip;
mod detect;
#[cfg(feature = "gltf")]
pub mod gltf;
mod limits;
#[cfg(feature = "io")]
pub mod mesh_out;
#[cfg(feature = "obj")]
pub mod obj;
pub mod off;
#[cfg(feature = "ply")]
pub mod ply;
#[cfg(feature = "io")]
pub mod points;
mod read;
mod select;
#[cfg(feature = "stl")]
pub mod stl;
mod text;

pub use clip::ClipError;
pub use detect::{MeshFormat, detect};
pub use limits::Limits;
pub use read::{
    Detail, Model, Place, ReadError, ReadOptions, Resolver, read_mesh, read_model, read_model_as,
    read_model_with,
};
