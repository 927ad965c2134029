//! Everything that can be wrong with a soup: what was repaired, and what cannot be.

/// What checking changed; all zero for a clean mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct RepairReport {}

/// Why a soup is not a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// No face is left.
    #[error("the mesh has no face with an area")]
    NoFace,
}
