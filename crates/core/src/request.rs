//! Meets a request for points: how many points of the planar domain give the number, density, spacing or
//! irregularity that is wanted (paper, 4.2 steps 2 and 4).

use std::borrow::Cow;
use std::convert::Infallible;

use glam::DVec2;

use crate::baseline::HilbertOrder;
use crate::correct::{Caught, Correction, Keep, Mended, Pick, Picks};
use crate::density::Density;
use crate::domain::{DomainPoints, PlanarDomain, TooManyCells};
use crate::irregularity;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::pipeline::OptionsError;
use crate::sample::{Origin, Sample, SurfacePoint};
use crate::selection::Choice;
use crate::sequence::{self, Sequence};
use crate::shares::Regions;
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
    pub(crate) density: &'a Density,
    pub(crate) strips: &'a Strips,
    pub(crate) domain: &'a PlanarDomain,
    pub(crate) sequence: Sequence,
    pub(crate) shift: DVec2,
    pub(crate) choice: Choice,
    /// In units of d_m.
    pub(crate) tolerance: f64,
}

/// The samples that meet a request.
pub(crate) struct Scattered<'a> {
    pub(crate) points: Points<'a>,
    /// sqrt(area / number of points wanted).
    pub(crate) d_m: f64,
}

/// Samples that are chosen.
pub(crate) enum Points<'a> {
    /// To be made of what was caught.
    Picked { mended: Box<Mended<'a>>, picks: Picks, keep: Keep },
    /// There already.
    Made { samples: Vec<Sample>, correction: Correction },
}

impl<'a> Points<'a> {
    fn picked(caught: Caught<'a>, picked: Vec<Vec<Pick>>, keep: Keep) -> Self {
        let mended = caught.into_mended();
        let picks = Picks::new(&mended, picked);
        Self::Picked { mended: Box::new(mended), picks, keep }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        match self {
            Self::Picked { picks, keep, .. } => keep.count(picks.count()),
            Self::Made { samples, .. } => samples.len(),
        }
    }

    /// All of them, and what the correction did to them.
    pub(crate) fn into_samples(self) -> (Vec<Sample>, Correction) {
        let mut all = Vec::with_capacity(if let Self::Picked { .. } = self { self.count() } else { 0 });
        match self {
            Self::Picked { mended, picks, keep } => {
                let correction = made(&mended, &picks, keep, |block| {
                    parallel::extend(&mut all, block.len(), |i| mended.sample(block[i]));
                    Ok::<(), Infallible>(())
                });
                match correction {
                    Ok(correction) => (all, correction),
                    Err(never) => match never {},
                }
            }
            Self::Made { samples, correction } => (samples, correction),
        }
    }

    /// Calls `take` with block after block of them, none of which is empty; the first error ends it. What the correction
    /// did to them.
    pub(crate) fn hand_on<E>(
        self,
        mut take: impl FnMut(&[Sample]) -> Result<(), E>,
    ) -> Result<Correction, E> {
        /// Samples in a block of those that are there.
        const BLOCK: usize = 1 << 17;
        match self {
            Self::Picked { mended, picks, keep } => {
                let mut samples = Vec::new();
                made(&mended, &picks, keep, |block| {
                    samples.clear();
                    parallel::extend(&mut samples, block.len(), |i| mended.sample(block[i]));
                    take(&samples)
                })
            }
            Self::Made { samples, correction } => {
                samples.chunks(BLOCK).try_for_each(take)?;
                Ok(correction)
            }
        }
    }
}

/// Calls `make` with block after block of what is kept, in order. What the correction did to it.
fn made<E>(
    mended: &Mended<'_>,
    picks: &Picks,
    keep: Keep,
    mut make: impl FnMut(&[Pick]) -> Result<(), E>,
) -> Result<Correction, E> {
    let mut correction = Correction::default();
    picks.blocks(mended, keep, |block| {
        correction.add(mended.correction(block));
        make(block)
    })?;
    Ok(correction)
}

/// How many points are caught for each that is wanted when the most central ones are chosen. More bring the errors down
/// further (ball on the horse at n = 1,000: 0.26 at 1.5, 0.22 at 2, 0.21 at 3, 0.19 at 6) and cost as much more.
const SURPLUS: f64 = 2.0;

/// How many points are caught for each that is wanted when it does not matter which stay: so many that once is mostly
/// enough.
const ENOUGH: f64 = 1.1;

/// With weights so many points of the domain, at most, are looked at to fill the densest places.
const MOST_FOR_WEIGHTS: f64 = 1_048_576.0;

/// With weights at most so many points are scattered on all of the surface for each one wanted before another way is taken.
const MOST_FOR_ONE: f64 = 32.0;

/// So many may be scattered in any case.
const ALWAYS: f64 = 262_144.0;

impl<'a> Scattering<'a> {
    pub(crate) fn meet(&self, request: Request) -> Result<Scattered<'a>, OptionsError> {
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
            Request::Count(n) => match self.choice {
                Choice::Regions => self.by_regions(n),
                Choice::Sequence => self.along_sequence(n),
                Choice::First => self.first(n),
                Choice::Any => self.any(n),
            },
            Request::Density(density) => self.at_spacing(libm::sqrt(positive("density", density)?.recip())),
            Request::Spacing(spacing) => self.at_spacing(positive("spacing", spacing)?),
            Request::Irregularity(most) => self.at_spacing(self.spacing_for(positive("irregularity", most)?)),
        }
    }

    /// How many points of the domain give `n` on the surface where it is covered once and the density is 1.
    fn domain_count(&self, n: f64) -> u64 {
        // The cast saturates.
        (n * self.domain.room(self.mesh.area())).round().max(1.0) as u64
    }

    /// How many times as dense as on average points are scattered, so that the densest places get theirs; less where
    /// that would be too many for `n`, but at least four times, so that extreme places get fewer than are due.
    fn peak(&self, n: f64) -> f64 {
        let affordable = MOST_FOR_WEIGHTS / (n * self.domain.room(self.mesh.area()));
        self.density.largest().min(affordable.max(4.0))
    }

    /// The samples that so many points of the domain give.
    fn scatter(&self, count: u64, d_m: f64) -> Result<Caught<'a>, OptionsError> {
        let reach = self.tolerance * d_m;
        let points =
            DomainPoints::scatter_near(self.domain, self.strips, &self.sequence, count, self.shift, reach)
                .map_err(|TooManyCells| OptionsError::TooMany { wanted: count as f64 })?;
        let wrapping = wrap(self.strips, self.domain, &points);
        Ok(Caught::new(self.mesh, self.strips, self.domain, Cow::Owned(points), wrapping, reach))
    }

    /// The points of `count` scattered ones that weights leave: those whose third coordinate is below their density
    /// over `peak`. Whether one stays depends on no other.
    fn weigh(&self, count: u64, d_m: f64, peak: f64) -> Result<Weighed<'a>, OptionsError> {
        self.caught(count, d_m, |index, density| {
            sequence::third_coordinate(&self.sequence, index) * peak < density
        })
    }

    /// The points of `count` scattered ones that stay by their number and their density; all if that is uniform.
    fn caught(
        &self,
        count: u64,
        d_m: f64,
        stays: impl Fn(u64, f64) -> bool + Sync + Send,
    ) -> Result<Weighed<'a>, OptionsError> {
        let caught = self.scatter(count, d_m)?;
        let picked = if self.density.is_uniform() {
            caught.pick(|_| true)
        } else {
            let mended = caught.mended();
            caught.pick(|pick| stays(mended.index(pick), self.density.at(&mended.sample(pick).point)))
        };
        Ok(Weighed { caught, picked })
    }

    fn at_spacing(&self, d_m: f64) -> Result<Scattered<'a>, OptionsError> {
        let n = self.mesh.area() / (d_m * d_m);
        let peak = self.peak(n);
        Ok(self.weigh(self.domain_count(n * peak), d_m, peak)?.kept(Keep::All, d_m))
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

    /// How many points of the domain to begin with so that `surplus` times `n` are caught, in the densest places too.
    fn count_for(&self, n: usize, surplus: f64) -> u64 {
        let wanted = n as f64 * surplus;
        self.domain_count(wanted * self.peak(wanted))
    }

    /// At least `n` points: [`ENOUGH`] times as many, or more where those do not catch enough; `None` if that would be far
    /// too many.
    fn at_least(&self, n: usize, d_m: f64) -> Result<Option<Weighed<'a>>, OptionsError> {
        let mut count = self.count_for(n, ENOUGH);
        loop {
            let caught = self.caught(count, d_m, |_, density| density > 0.0)?;
            if caught.count() >= n {
                return Ok(Some(caught));
            }
            count = count.saturating_mul(2);
            if self.is_too_many(count, n) {
                return Ok(None);
            }
        }
    }

    /// Whether weights leave so little of the surface that points scattered on all of it are no way to fill it.
    fn is_too_many(&self, count: u64, n: usize) -> bool {
        let everywhere = count as f64 / self.domain.room(self.mesh.area());
        !self.density.is_uniform() && everywhere > (MOST_FOR_ONE * n as f64).max(ALWAYS)
    }

    /// Exactly `n` points in Hilbert order by mass, each at its place in its strip: for weights that leave almost nothing of
    /// the surface.
    fn along_curve(&self, n: usize, d_m: f64) -> Scattered<'a> {
        let points =
            HilbertOrder::by_mass(self.mesh, &self.density.face_masses(self.mesh)).points(n, 0.5, 0.0);
        let sample = |point: SurfacePoint| {
            let [a, b, c] = self.domain.triangle(self.strips, point.face);
            let [u, v, w] = point.barycentric;
            let strip = self.strips.places[point.face.index()].strip;
            Sample { point, strip, place: a * u + b * v + c * w, origin: Origin::Wrapped }
        };
        let samples = points.into_iter().map(sample).collect();
        Scattered { points: Points::Made { samples, correction: Correction::default() }, d_m }
    }

    /// Exactly `n` points, thinned out evenly along the sequence.
    fn any(&self, n: usize) -> Result<Scattered<'a>, OptionsError> {
        let d_m = libm::sqrt(self.mesh.area() / n as f64);
        let caught = self.at_least(n, d_m)?;
        Ok(caught.map_or_else(|| self.along_curve(n, d_m), |caught| caught.kept(Keep::Spread(n), d_m)))
    }

    /// Exactly `n` points, the most central in each of as many regions of equal mass.
    fn by_regions(&self, n: usize) -> Result<Scattered<'a>, OptionsError> {
        let d_m = libm::sqrt(self.mesh.area() / n as f64);
        let regions = Regions::new(self.mesh, self.density, n);
        let mut count = self.count_for(n, SURPLUS);
        loop {
            let caught = self.scatter(count, d_m)?;
            if let Some(picked) = regions.choose(&caught) {
                return Ok(Weighed { caught, picked }.kept(Keep::All, d_m));
            }
            count = count.saturating_mul(2);
            if self.is_too_many(count, n) {
                return Ok(self.along_curve(n, d_m));
            }
        }
    }

    /// The first `n` points on the surface.
    fn first(&self, n: usize) -> Result<Scattered<'a>, OptionsError> {
        let d_m = libm::sqrt(self.mesh.area() / n as f64);
        // The same for every n, or points that stayed might not stay for another n.
        let peak = self.density.largest();
        let mut count = self.domain_count(n as f64 * peak);
        loop {
            let caught = self.weigh(count, d_m, peak)?;
            if caught.count() >= n {
                return Ok(caught.kept(Keep::First(n), d_m));
            }
            // A tenth more than are missing, and at least one.
            count = count.saturating_add(1 + count / 10);
        }
    }

    /// Exactly `n` points. The number caught jumps a little as points of the domain are added, so a few numbers are
    /// tried; where none gives `n`, the surplus of the best is left out, evenly along the sequence.
    fn along_sequence(&self, n: usize) -> Result<Scattered<'a>, OptionsError> {
        let d_m = libm::sqrt(self.mesh.area() / n as f64);
        let peak = self.peak(n as f64);
        let nominal = self.domain_count(n as f64 * peak);
        let mut best: Option<Weighed<'a>> = None;
        let mut tried = Vec::new();
        let trials = self.trials(n, nominal);
        let mut count = nominal;
        loop {
            tried.push(count);
            let caught = self.weigh(count, d_m, peak)?;
            let found = caught.count();
            if found >= n && best.as_ref().is_none_or(|best| found < best.count()) {
                best = Some(caught);
            }
            if let Some(best) = best.take_if(|_| found == n || tried.len() >= trials) {
                return Ok(best.kept(Keep::Spread(n), d_m));
            }
            count = if tried.len() < trials {
                self.next_count(count, (n as f64 - found as f64) * peak, &tried)
            } else {
                // Points that the steps do not bring: doubling ends, with enough points or with too many.
                tried.iter().copied().max().unwrap_or(1).saturating_mul(2)
            };
        }
    }

    /// How many numbers of domain points are tried: many where a trial is cheap. It costs about the faces, the points
    /// near them, and for a narrow strip the rows of cells, or all points if they can only be looked at one by one.
    fn trials(&self, n: usize, nominal: u64) -> usize {
        let points = if self.sequence == Sequence::R2 {
            nominal
        } else {
            nominal.min(16 * n as u64).max(4 * libm::sqrt(nominal as f64) as u64)
        };
        let cost = (self.mesh.face_count() / 4) as u64 + points;
        (2_000_000 / cost.max(1)).clamp(2, 24) as usize
    }

    /// The next number of domain points to try: by as many more as points are missing, and not one tried before.
    fn next_count(&self, count: u64, missing: f64, tried: &[u64]) -> u64 {
        let room = self.domain.room(self.mesh.area()).max(1.0);
        let mut next = (count as f64 + missing * room).round().max(1.0) as u64;
        while tried.contains(&next) {
            next = if missing > 0.0 { next.saturating_add(1) } else { next - 1 };
            if next < 1 {
                next = tried.iter().copied().max().unwrap_or(0).saturating_add(1);
            }
        }
        next
    }
}

/// What was caught, and which of it stays.
struct Weighed<'a> {
    caught: Caught<'a>,
    picked: Vec<Vec<Pick>>,
}

impl<'a> Weighed<'a> {
    /// How many stay.
    fn count(&self) -> usize {
        self.picked.iter().map(Vec::len).sum()
    }

    /// Of those that stay, in order, the ones that are kept.
    fn kept(self, keep: Keep, d_m: f64) -> Scattered<'a> {
        Scattered { points: Points::picked(self.caught, self.picked, keep), d_m }
    }
}
