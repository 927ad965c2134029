//! What a person sets: the library's options in a person's units, with a method; as JSON and as a link.

use ldwrap::equalize::EqualizeOptions;
use ldwrap::pipeline::{Options, Request, Selection};
use ldwrap::segment::{GrowthOrder, SegmentOptions};
use ldwrap::sequence::Sequence;
use serde::{Deserialize, Serialize};

/// What places the points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Wrapping with the growth order that was set, equalized if that was set.
    #[default]
    Wrap,
    /// Exactly the paper's: growth along the boundary, no equalizing.
    Paper,
    /// Independent random points: what every measure is compared with.
    Random,
    /// Triangles along a Hilbert curve, no unfolding.
    Hilbert,
    /// Sample elimination.
    Poisson,
}

impl Method {
    /// Every method, in the order in which they are offered.
    pub const ALL: [Self; 5] = [Self::Wrap, Self::Paper, Self::Random, Self::Hilbert, Self::Poisson];

    /// What a person reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wrap => "Wrap (ours)",
            Self::Paper => "The paper's",
            Self::Random => "Random",
            Self::Hilbert => "Hilbert curve",
            Self::Poisson => "Poisson disks",
        }
    }
}

/// Everything that decides the points, besides the mesh. As JSON all keys may be left out; unknown ones are errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "camelCase")]
pub struct Settings {
    /// How many points. Default: exactly 1,000.
    pub request: Request,
    /// What places them.
    pub method: Method,
    /// The point set on the planar domain.
    pub sequence: Sequence,
    /// Shifts the point set; 0 leaves it as it is.
    pub seed: u64,
    /// The largest angle between neighbours that counts as almost flat, in degrees.
    pub flatness_angle: f64,
    /// In which order a segment grows.
    pub growth: GrowthOrder,
    /// Segments with fewer triangles than this share of all go on growing.
    pub smallest_share: f64,
    /// Interstices and overlaps thinner than this many d_m are corrected.
    pub tolerance: f64,
    /// Whether wrapped points are equalized, as the command line program does. Default: true.
    pub equalize: bool,
}

impl Default for Settings {
    fn default() -> Self {
        let Options { request, segment, sequence, seed, tolerance, .. } = Options::default();
        Self {
            request,
            method: Method::default(),
            sequence,
            seed,
            flatness_angle: segment.flatness_angle.to_degrees().round(),
            growth: segment.order,
            smallest_share: segment.smallest_share,
            tolerance,
            equalize: true,
        }
    }
}

impl Settings {
    /// Whether the points are equalized: only this method's are.
    pub fn equalizes(&self) -> bool {
        self.equalize && self.method == Method::Wrap
    }

    /// The library's options; what the method fixes overrides what was set.
    pub fn options(&self) -> Options {
        let paper = self.method == Method::Paper;
        Options {
            request: self.request,
            segment: SegmentOptions {
                flatness_angle: self.flatness_angle.to_radians(),
                smallest_share: self.smallest_share,
                order: if paper { GrowthOrder::BoundaryWalk } else { self.growth },
            },
            sequence: self.sequence,
            seed: self.seed,
            selection: if paper { Selection::Sequence } else { Selection::Regions },
            tolerance: self.tolerance,
            equalize: self
                .equalizes()
                .then(|| EqualizeOptions { spread_before: true, ..EqualizeOptions::default() }),
            ..Options::default()
        }
    }

    /// Reads JSON; an empty text gives the default.
    ///
    /// # Errors
    /// What is wrong with it, for a person.
    pub fn from_json(json: &str) -> Result<Self, String> {
        if json.trim().is_empty() {
            return Ok(Self::default());
        }
        serde_json::from_str(json).map_err(|e| format!("the options cannot be read: {e}"))
    }
}

/// What a link holds: the built-in shape (a person's own mesh never leaves the machine) and the settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Link {
    /// The name of the built-in shape; empty for the person's own file.
    pub shape: String,
    /// The settings.
    pub settings: Settings,
    /// Those of B, when two are compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other: Option<Settings>,
}

impl Link {
    /// The part of an address behind `#`.
    pub fn fragment(&self) -> String {
        let json = serde_json::to_string(self).unwrap_or_default();
        percent_encoding::utf8_percent_encode(&json, percent_encoding::NON_ALPHANUMERIC).to_string()
    }

    /// Reads the part of an address behind `#`; `None` when there is nothing that can be read.
    pub fn from_fragment(fragment: &str) -> Option<Self> {
        let text =
            percent_encoding::percent_decode_str(fragment.trim_start_matches('#')).decode_utf8().ok()?;
        serde_json::from_str(&text).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_gives_back_its_settings() {
        let settings = Settings {
            seed: 7,
            request: Request::Spacing(0.25),
            method: Method::Paper,
            ..Settings::default()
        };
        for other in [None, Some(Settings { method: Method::Hilbert, ..Settings::default() })] {
            let link = Link { shape: "cup".into(), settings: settings.clone(), other };
            let fragment = link.fragment();
            assert!(fragment.chars().all(|c| c.is_ascii_alphanumeric() || c == '%'), "{fragment}");
            assert_eq!(Link::from_fragment(&format!("#{fragment}")), Some(link));
        }
        assert_eq!(Link::from_fragment("#nonsense"), None);
    }

    #[test]
    fn json_may_leave_keys_out_but_not_invent_them() {
        assert_eq!(Settings::from_json("").unwrap(), Settings::default());
        assert_eq!(Settings::from_json(r#"{"seed": 3}"#).unwrap().seed, 3);
        assert!(Settings::from_json(r#"{"seeds": 3}"#).unwrap_err().contains("seeds"));
    }

    #[test]
    fn the_papers_method_walks_the_boundary_and_does_not_equalize() {
        let settings = Settings { method: Method::Paper, equalize: true, ..Settings::default() };
        let options = settings.options();
        assert_eq!(options.segment.order, GrowthOrder::BoundaryWalk);
        assert_eq!((options.equalize, options.selection), (None, Selection::Sequence));
    }

    #[test]
    fn the_default_settings_are_the_librarys_default_options_equalized() {
        let equalize = Some(EqualizeOptions { spread_before: true, ..EqualizeOptions::default() });
        let (ours, theirs) = (Settings::default().options(), Options { equalize, ..Options::default() });
        assert!((ours.segment.flatness_angle - theirs.segment.flatness_angle).abs() < 1e-12);
        assert_eq!(Options { segment: theirs.segment, ..ours }, theirs);
    }
}
