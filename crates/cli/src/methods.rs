//! The methods that `compare` compares: a mesh, a number and a seed in, points out.

use anyhow::anyhow;
use clap::ValueEnum;
use ldwrap::baseline::Baseline;
use ldwrap::equalize::{EqualizeOptions, ForViews};
use ldwrap::pipeline::{self, Options, Request, Selection};
use ldwrap::segment::{GrowthOrder, SegmentOptions};
use ldwrap::{Progress, SurfaceMesh, SurfacePoint};

/// A way to make points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Method {
    /// Segment, unfold, wrap, correct, and choose one point in each region of equal area
    Wrap,
    /// The paper's own: segments grow along their boundary, points along the sequence
    Paper,
    /// As wrap, then equalized
    Equalize,
    /// Equalized, then placed for views
    ForViews,
    /// Independent uniform points
    Random,
    /// Triangles along a Hilbert curve, the sum of areas inverted at equal steps
    Hilbert,
    /// Poisson disk by sample elimination
    Poisson,
    /// On a sphere: Hammersley in spherical coordinates
    SphereHammersley,
    /// On a sphere: spherical Fibonacci lattice
    SphereFibonacci,
}

impl Method {
    /// All of them.
    pub(crate) const ALL: [Self; 9] = [
        Self::Wrap,
        Self::Paper,
        Self::Equalize,
        Self::ForViews,
        Self::Random,
        Self::Hilbert,
        Self::Poisson,
        Self::SphereHammersley,
        Self::SphereFibonacci,
    ];

    /// Its name as it is typed.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// Whether it works on the mesh: lattices on the sphere need one.
    pub(crate) fn suits(self, mesh: &SurfaceMesh) -> bool {
        let sphere = |baseline: Baseline| baseline.place(mesh, 1, 0).is_ok();
        match self {
            Self::SphereHammersley => sphere(Baseline::SphereHammersley),
            Self::SphereFibonacci => sphere(Baseline::SphereFibonacci),
            Self::Wrap
            | Self::Paper
            | Self::Equalize
            | Self::ForViews
            | Self::Random
            | Self::Hilbert
            | Self::Poisson => true,
        }
    }

    /// Makes `count` points. `options` say how to wrap; their request, seed and equalizing are replaced.
    pub(crate) fn place(
        self,
        mesh: &SurfaceMesh,
        count: usize,
        seed: u64,
        options: &Options,
        progress: &dyn Progress,
    ) -> anyhow::Result<Vec<SurfacePoint>> {
        let wrapped_by = |options: &Options, equalize| {
            let options = Options { request: Request::Count(count), seed, equalize, ..*options };
            let run = pipeline::run(mesh, &options, progress)?;
            anyhow::Ok(run.samples.iter().map(|sample| sample.point).collect())
        };
        let wrapped = |equalize| wrapped_by(options, equalize);
        let baseline = |baseline: Baseline| {
            progress.begin("place", 1);
            baseline.place(mesh, count, seed).map_err(|error| anyhow!(error))
        };
        match self {
            Self::Wrap => wrapped(None),
            Self::Paper => {
                let segment = SegmentOptions { order: GrowthOrder::BoundaryWalk, ..options.segment };
                wrapped_by(&Options { segment, selection: Selection::Sequence, ..*options }, None)
            }
            Self::Equalize => wrapped(Some(EqualizeOptions::default())),
            Self::ForViews => {
                let for_views = Some(ForViews { seed, ..ForViews::default() });
                wrapped(Some(EqualizeOptions { for_views, ..EqualizeOptions::default() }))
            }
            Self::Random => baseline(Baseline::Random),
            Self::Hilbert => baseline(Baseline::Hilbert),
            Self::Poisson => baseline(Baseline::Poisson),
            Self::SphereHammersley => baseline(Baseline::SphereHammersley),
            Self::SphereFibonacci => baseline(Baseline::SphereFibonacci),
        }
    }
}
