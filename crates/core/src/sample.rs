//! Points on a surface: what the stages make and every measure takes.

use glam::DVec2;

use crate::ids::{FaceId, StripId};

/// A point of a surface: a face and barycentric coordinates in it (not negative, sum 1).
/// Its position is [`SurfaceMesh::locate`](crate::SurfaceMesh::locate).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SurfacePoint {
    /// The face that holds it.
    pub face: FaceId,
    /// The weights of the face's three corners.
    pub barycentric: [f64; 3],
}

/// What put a sample where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Origin {
    /// A point of the planar domain inside a strip, mapped back (paper, 4.2 step 4).
    Wrapped,
    /// A point inside a thin interstice, projected onto the closest edge (paper, 4.2 step 5 b); equalizing may have
    /// moved it on from there.
    Projected,
    /// A wrapped point moved along the surface by equalizing.
    Equalized,
}

/// A sample: a surface point with where it came from.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// Where it is on the surface.
    pub point: SurfacePoint,
    /// The strip that holds its face.
    pub strip: StripId,
    /// Where it lies in the planar domain, in units of the mesh.
    pub place: DVec2,
    /// What put it there.
    pub origin: Origin,
}
