//! The paper's bounds on the discrepancy of wrapped points (section 3, eq. 6 and 7), next to the measured value.

use glam::DVec2;
use ldwrap::measure::PatchOptions;
use ldwrap::measure::decomposition::{Joints, PartDiscrepancy, part_discrepancy, surface_bound};
use ldwrap::measure::plane::{StarDiscrepancy, star_discrepancy};
use ldwrap::pipeline::{Options, Run};
use ldwrap::sequence::{shift, shift_of_seed};
use ldwrap::{Progress, SurfaceMesh, SurfacePoint};
use serde::Serialize;

/// Boxes of any place are sums and differences of four boxes at the corner.
const BOXES: f64 = 4.0;

/// Both bounds for one set of wrapped points, as shares of all points.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Bounds {
    pub(crate) count: usize,
    pub(crate) strips: usize,
    /// About how many points the planar domain holds: its area over that of the surface, times `count`.
    pub(crate) domain_points: u64,
    /// The star discrepancy of as many points of the sequence in the unit square.
    pub(crate) star: StarDiscrepancy,
    /// f_d, the measured discrepancy of figures and of their parts, and eq. 6.
    #[serde(flatten)]
    pub(crate) parts: PartDiscrepancy,
    /// Eq. 7 with c = 1 and four times the star discrepancy for that of the plane.
    pub(crate) eq7: f64,
}

impl Bounds {
    /// Of what `options` made of `mesh`. Cuts narrower than the tolerance of the correction count as joined.
    pub(crate) fn of(mesh: &SurfaceMesh, options: &Options, run: &Run, progress: &dyn Progress) -> Self {
        let points: Vec<SurfacePoint> = run.samples.iter().map(|sample| sample.point).collect();
        let count = points.len();
        let joints = Joints::of(mesh, &run.strips, options.tolerance * run.d_m);
        let parts = part_discrepancy(mesh, &joints, &points, &PatchOptions::default(), progress);
        progress.begin("star", 1);
        let domain_points = (run.domain.room(mesh.area()) * count as f64).round() as u64;
        let moved = shift_of_seed(options.seed);
        let places: Vec<DVec2> =
            (0..domain_points).map(|i| shift(options.sequence.point(i, domain_points), moved)).collect();
        let star = star_discrepancy(&places);
        let degree = parts.decomposition.degree;
        let eq7 = surface_bound(degree, BOXES * star.upper, domain_points as usize, count);
        Self { count, strips: run.strips.strips.len(), domain_points, star, parts, eq7 }
    }
}

/// The headings of [`cells`].
pub(crate) const HEAD: [&str; 12] = [
    "n",
    "strips",
    "f_d",
    "mean parts",
    "points of the domain",
    "4 x star discrepancy there",
    "eq. 7 (c = 1)",
    "largest part, measured",
    "eq. 6",
    "measured sup",
    "eq. 6 / measured",
    "eq. 7 / measured",
];

/// One row of a table.
pub(crate) fn cells(bounds: &Bounds) -> Vec<String> {
    let Bounds { count, strips, domain_points, star, parts, eq7 } = bounds;
    let measured = parts.figure.linf;
    vec![
        count.to_string(),
        strips.to_string(),
        parts.decomposition.degree.to_string(),
        format!("{:.2}", parts.decomposition.mean),
        domain_points.to_string(),
        digits(BOXES * star.upper, 4),
        digits(*eq7, 3),
        digits(parts.largest_part.linf, 4),
        digits(parts.bound.linf, 3),
        digits(measured, 4),
        digits(parts.bound.linf / measured, 0),
        digits(eq7 / measured, 0),
    ]
}

/// So many digits behind the point; a dash for what does not exist: the discrepancy of a domain without points, or a
/// bound over a measured zero.
fn digits(value: f64, digits: usize) -> String {
    if value.is_finite() { format!("{value:.digits$}") } else { "-".to_owned() }
}
