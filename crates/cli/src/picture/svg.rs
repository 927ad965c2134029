//! The strips picture.

use ldwrap::Sample;
use ldwrap::domain::PlanarDomain;
use ldwrap::unfold::Strips;

/// The strips side by side as an SVG picture. `tolerance` is a length in units of the mesh: borders whose gap is at
/// most that wide count as closed.
pub(crate) fn strips_svg(
    strips: &Strips,
    domain: &PlanarDomain,
    samples: &[Sample],
    tolerance: f64,
) -> String {
    let _ = (strips, domain, samples, tolerance);
    String::new()
}
