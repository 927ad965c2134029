//! Many meshes, one after the other or at a time: which, where their points go, what became of each.
//!
//! Nothing is lost and nothing half when a run is killed at any moment: the points of a mesh go to a temporary file that
//! is complete on the disk before it gets its name, and only then is a line added to the journal. Without that line, or
//! without that file, the mesh is worked on again.

pub(crate) mod begun;
pub(crate) mod inputs;
pub(crate) mod journal;
pub(crate) mod names;
pub(crate) mod past;
pub(crate) mod pattern;
pub(crate) mod record;
pub(crate) mod summary;
pub(crate) mod work;
pub(crate) mod workers;

use crate::batch::record::Trouble;

/// A mesh to work on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Task {
    /// The path of the mesh, or of a folder that cannot be listed.
    pub(crate) input: std::path::PathBuf,
    /// Where its points go: a path below OUT_DIR with `/` between its parts. Or why there is nothing to work on.
    pub(crate) output: Result<String, Trouble>,
}
