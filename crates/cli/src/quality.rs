//! How good points are: every measure of the library, on one mesh, for one or many sets.

use ldwrap::measure::{
    BallOptions, EnergyOptions, EnergyReport, HalfSpaceOptions, IntegrationOptions, IntegrationReport, Norms,
    PatchOptions, SpacingOptions, SpacingReport, ViewOptions, Views, ball, components, energy, half_space,
    integration, patch, spacing,
};
use ldwrap::{Progress, SurfaceMesh, SurfacePoint};
use serde::Serialize;

/// What `measure --json` prints as `quality`, and `wrap --quality` adds to the report. A number that does not exist (such
/// as the spacing of a single point) is null.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Quality {
    pub(crate) energy: EnergyReport,
    pub(crate) ball: Norms,
    pub(crate) half_space: Norms,
    pub(crate) patch: Norms,
    pub(crate) view: Norms,
    pub(crate) view_occluded: Norms,
    pub(crate) integration: IntegrationReport,
    pub(crate) spacing: SpacingReport,
    pub(crate) components: ComponentQuality,
}

/// Whether each connected part of the mesh has its share of the points.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ComponentQuality {
    /// How many parts there are.
    pub(crate) count: usize,
    /// The largest difference between the number of points of a part and its share, in points.
    pub(crate) worst: f64,
}

/// Measures sets of points on one mesh; what depends on the mesh alone is computed once.
pub(crate) struct Judge<'a> {
    mesh: &'a SurfaceMesh,
    views: Views,
}

impl<'a> Judge<'a> {
    /// A judge that is exact enough for sets of up to `count` points.
    pub(crate) fn new(mesh: &'a SurfaceMesh, count: usize, progress: &dyn Progress) -> Self {
        Self { mesh, views: Views::new(mesh, &ViewOptions::for_count(count), progress) }
    }

    /// Every measure of one set. The same bits for the same points.
    pub(crate) fn quality(&self, points: &[SurfacePoint], progress: &dyn Progress) -> Quality {
        let mesh = self.mesh;
        let energy = energy(mesh, points, &EnergyOptions::default(), progress);
        let ball = ball(mesh, points, &BallOptions::default(), progress).norms;
        let half_space = half_space(mesh, points, &HalfSpaceOptions::default(), progress).norms;
        let patch = patch(mesh, points, &PatchOptions::default(), progress);
        progress.begin("view", 1);
        let views = self.views.measure(mesh, points);
        progress.advance(1);
        let integration = integration(mesh, points, &IntegrationOptions::default(), progress);
        let spacing = spacing(mesh, points, &SpacingOptions::default(), progress);
        let shares = components(mesh, points);
        Quality {
            energy,
            ball,
            half_space,
            patch,
            view: views.view,
            view_occluded: views.view_occluded,
            integration,
            spacing,
            components: ComponentQuality { count: shares.components.len(), worst: shares.worst },
        }
    }
}
