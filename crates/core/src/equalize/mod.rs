//! Equalizing: beyond the paper, every point ends up standing for the same area.

/// How points are equalized.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EqualizeOptions {
    /// Rounds of relaxation. More come closer to equal cells; the time is proportional. Default: 20.
    pub rounds: u32,
}

impl Default for EqualizeOptions {
    fn default() -> Self {
        Self { rounds: 20 }
    }
}

/// What equalizing did. The spread of cell areas is their standard deviation over their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EqualizeReport {
    /// The spread of the cells' areas before.
    pub spread_before: f64,
    /// The spread of the cells' areas after.
    pub spread_after: f64,
    /// How far points moved, root mean square, in units of d_m.
    pub moved: f64,
}
