//! Readers and writers: bytes in, bytes out, one file a format.

#[cfg(feature = "io")]
pub mod mesh_out;
#[cfg(feature = "io")]
pub mod points;
