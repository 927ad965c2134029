//! The correction (paper, 4.2 step 5): thin interstices and thin overlaps.

/// What the correction did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Correction {
    /// Points in thin interstices that were projected onto the closest edge.
    pub projected: usize,
    /// Copies in thin overlaps that were removed.
    pub removed: usize,
}
