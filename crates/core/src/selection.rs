//! Which of the wrapped points are the result.

/// How the points of a request are chosen among those that wrapping puts on the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Selection {
    /// For an exact count: twice as many points are wrapped, the surface is cut into as many regions of equal mass as
    /// points are wanted, and the most central point of each stays. So open borders do not put too many or too few
    /// points in any part. Other requests: as `Sequence`. Equalizing puts whole numbers of points into all parts by
    /// itself: before it, if there are no weights, points wrapped in one go are
    /// thinned out evenly along the sequence.
    #[default]
    Regions,
    /// The paper's: about as many points are wrapped as are wanted; for an exact count the few too many are left out
    /// evenly along the sequence.
    Sequence,
    /// The first points of the sequence that fall on the surface, in its order: n + m points contain the n. The
    /// sequence must not depend on their number ([`Sequence::is_extensible`](crate::sequence::Sequence::is_extensible)),
    /// nothing is corrected or equalized, and the surface is cut as for 1,000 points.
    Extensible,
}

/// How an exact count is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    /// See [`Selection::Regions`].
    Regions,
    /// See [`Selection::Sequence`].
    Sequence,
    /// See [`Selection::Extensible`].
    First,
    /// Any that are spread over the surface, in the least time.
    Any,
}

impl Selection {
    pub(crate) fn choice(self, equalized: bool) -> Choice {
        match self {
            Self::Regions if equalized => Choice::Any,
            Self::Regions => Choice::Regions,
            Self::Sequence => Choice::Sequence,
            Self::Extensible => Choice::First,
        }
    }
}

/// In which order the points are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum SampleOrder {
    /// That of the sequence.
    #[default]
    Sequence,
    /// One in which the first k are well spread for every k: [`progressive`](crate::progressive::progressive).
    Progressive,
}
