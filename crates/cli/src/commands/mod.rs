//! One file a command: from its arguments to its outputs.

pub(crate) mod info;
pub(crate) mod shape;
pub(crate) mod strips;
pub(crate) mod wrap;
