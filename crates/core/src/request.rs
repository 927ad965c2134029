//! Meets a request for points: how many points of the planar domain give the number, density, spacing or
//! irregularity that is wanted (paper, 4.2 steps 2 and 4).

use glam::DVec2;

use crate::correct::{Corrected, Correction, correct};
use crate::domain::{DomainPoints, PlanarDomain, TooManyCells};
use crate::irregularity;
use crate::mesh::SurfaceMesh;
use crate::pipeline::OptionsError;
use crate::sample::{Origin, Sample};
use crate::sequence::Sequence;
use crate::unfold::Strips;
use crate::wrap::wrap;

/// How many points are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Request {
    /// Exactly this many points.
    Count(usize),
    /// Points per squared unit of the mesh.
    Density(f64),
    /// The mean distance d_m between neighbours, in units of the mesh.
    Spacing(f64),
    /// The largest irregularity ratio R (eq. 8) allowed; the density rises until it holds.
    Irregularity(f64),
}

/// What points are scattered on.
pub(crate) struct Scattering<'a> {
    pub(crate) mesh: &'a SurfaceMesh,
    pub(crate) strips: &'a Strips,
    pub(crate) domain: &'a PlanarDomain,
    pub(crate) sequence: Sequence,
    pub(crate) shift: DVec2,
    /// In units of d_m.
    pub(crate) tolerance: f64,
}

/// The samples that meet a request.
pub(crate) struct Scattered {
    pub(crate) samples: Vec<Sample>,
    pub(crate) correction: Correction,
    /// sqrt(area / number of points wanted).
    pub(crate) d_m: f64,
}

impl Scattering<'_> {
    pub(crate) fn meet(&self, request: Request) -> Result<Scattered, OptionsError> {
        let positive = |name, value: f64| {
            if value.is_finite() && value > 0.0 {
                Ok(value)
            } else {
                let allowed = "finite and above 0";
                Err(OptionsError::OutOfRange { name, value: value.to_string(), allowed })
            }
        };
        match request {
            Request::Count(0) => {
                Err(OptionsError::OutOfRange { name: "count", value: "0".into(), allowed: "1 or more" })
            }
            Request::Count(n) => self.exactly(n),
            Request::Density(density) => self.at_spacing(libm::sqrt(positive("density", density)?.recip())),
            Request::Spacing(spacing) => self.at_spacing(positive("spacing", spacing)?),
            Request::Irregularity(most) => self.at_spacing(self.spacing_for(positive("irregularity", most)?)),
        }
    }

    /// How many points of the domain give `n` on the surface where it is covered once.
    fn domain_count(&self, n: f64) -> u64 {
        // The cast saturates.
        (n * self.domain.room(self.mesh.area())).round().max(1.0) as u64
    }

    fn scatter(&self, count: u64, d_m: f64) -> Result<(Vec<Corrected>, Correction), OptionsError> {
        let reach = self.tolerance * d_m;
        let points =
            DomainPoints::scatter_near(self.domain, self.strips, &self.sequence, count, self.shift, reach)
                .map_err(|TooManyCells| OptionsError::TooMany { wanted: count as f64 })?;
        let wrapping = wrap(self.strips, self.domain, &points);
        Ok(correct(self.mesh, self.strips, self.domain, &points, wrapping, reach))
    }

    fn at_spacing(&self, d_m: f64) -> Result<Scattered, OptionsError> {
        let count = self.domain_count(self.mesh.area() / (d_m * d_m));
        let (corrected, correction) = self.scatter(count, d_m)?;
        Ok(Scattered { samples: corrected.into_iter().map(|c| c.sample).collect(), correction, d_m })
    }

    /// The largest spacing whose irregularity is at most `most`, to a thousandth.
    fn spacing_for(&self, most: f64) -> f64 {
        let holds = |d: f64| irregularity::bound(self.strips, d, self.tolerance * d) <= most;
        let mut high = libm::sqrt(self.mesh.area());
        if holds(high) {
            return high;
        }
        // Eq. 8 falls to 0 with d_m, so halving ends.
        let mut low = 0.5 * high;
        while !holds(low) && low > 0.0 {
            high = low;
            low *= 0.5;
        }
        while high - low > 1e-3 * low {
            let middle = 0.5 * (low + high);
            if holds(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Exactly `n` points. The number caught jumps a little as points of the domain are added, so a few numbers are
    /// tried; where none gives `n`, the surplus of the best is left out, evenly along the sequence.
    fn exactly(&self, n: usize) -> Result<Scattered, OptionsError> {
        let d_m = libm::sqrt(self.mesh.area() / n as f64);
        let nominal = self.domain_count(n as f64);
        // A trial costs about the faces and the points near them; many are cheap when both are few.
        let cost = (self.mesh.face_count() / 4) as u64 + nominal.min(16 * n as u64);
        let trials = (2_000_000 / cost.max(1)).clamp(2, 24) as usize;
        let mut best: Option<Vec<Corrected>> = None;
        let mut tried = Vec::new();
        let mut count = nominal;
        loop {
            tried.push(count);
            let (corrected, _) = self.scatter(count, d_m)?;
            let found = corrected.len();
            let better = best.as_ref().is_none_or(|b| found < b.len());
            if found >= n && better {
                best = Some(corrected);
            }
            if found == n || (tried.len() >= trials && best.is_some()) {
                break;
            }
            count = if tried.len() < trials {
                self.next_count(count, n, found, &tried)
            } else {
                // Points that the steps do not bring: doubling ends, with enough points or with too many.
                tried.iter().copied().max().unwrap_or(1).saturating_mul(2)
            };
        }
        let kept = thin_out(best.unwrap_or_default(), n);
        let correction = Correction {
            projected: kept.iter().filter(|c| c.sample.origin == Origin::Projected).count(),
            removed: kept.iter().map(|c| c.copies_removed as usize).sum(),
        };
        Ok(Scattered { samples: kept.into_iter().map(|c| c.sample).collect(), correction, d_m })
    }

    /// The next number of domain points to try: by as many more as points are missing, and not one tried before.
    fn next_count(&self, count: u64, n: usize, found: usize, tried: &[u64]) -> u64 {
        let room = self.domain.room(self.mesh.area()).max(1.0);
        let step = (n as f64 - found as f64) * room;
        let mut next = (count as f64 + step).round().max(1.0) as u64;
        while tried.contains(&next) {
            next = if found < n { next.saturating_add(1) } else { next - 1 };
            if next < 1 {
                next = tried.iter().copied().max().unwrap_or(0).saturating_add(1);
            }
        }
        next
    }
}

/// Leaves out points, evenly along the sequence, until `n` are left.
fn thin_out(corrected: Vec<Corrected>, n: usize) -> Vec<Corrected> {
    let count = corrected.len();
    let surplus = count.saturating_sub(n);
    // In 64 bits also where indices have 32.
    let (wide_count, wide_surplus) = (count as u64, surplus as u64);
    let mut left_out =
        (0..wide_surplus).map(|k| (((2 * k + 1) * wide_count) / (2 * wide_surplus)) as usize).peekable();
    corrected
        .into_iter()
        .enumerate()
        .filter(|&(i, _)| left_out.next_if_eq(&i).is_none())
        .map(|(_, c)| c)
        .collect()
}
