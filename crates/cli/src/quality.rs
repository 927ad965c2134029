//! How good points are: every measure of the library, on one mesh, for one or many sets.

use ldwrap::measure::{
    BallOptions, Balls, EnergyOptions, EnergyPlanes, EnergyReport, HalfSpaceOptions, HalfSpaces,
    IntegrationOptions, IntegrationReport, Norms, PatchOptions, SpacingOptions, SpacingReport, TestFunctions,
    ViewOptions, Views, components, patch, spacing,
};
use ldwrap::{Progress, SurfaceMesh, SurfacePoint};
use serde::Serialize;

/// What `measure --json` prints as `quality`, and `wrap --quality` adds to the report. A number that does not exist (such
/// as the spacing of a single point) is null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Quality {
    pub(crate) energy: EnergyReport,
    pub(crate) ball: Norms,
    pub(crate) half_space: Norms,
    pub(crate) patch: Norms,
    pub(crate) view: ViewQuality,
    pub(crate) view_occluded: ViewQuality,
    pub(crate) integration: IntegrationReport,
    pub(crate) spacing: SpacingReport,
    pub(crate) components: ComponentQuality,
}

/// How the visible shares of points differ from those of the area, which is itself known only so well.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ViewQuality {
    #[serde(flatten)]
    pub(crate) norms: Norms,
    /// The root mean square error of the visible share of the area.
    pub(crate) reference_error: f64,
    /// Whether that is at most a tenth of `l2`.
    #[serde(skip)]
    pub(crate) is_sharp: bool,
}

/// Whether each connected part of the mesh has its share of the points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ComponentQuality {
    /// How many parts there are.
    pub(crate) count: usize,
    /// The largest difference between the number of points of a part and its share, in points.
    pub(crate) worst: f64,
}

/// Measures sets of points on one mesh; what depends on the mesh alone is computed once.
pub(crate) struct Judge<'a> {
    mesh: &'a SurfaceMesh,
    planes: EnergyPlanes,
    balls: Balls,
    half_spaces: HalfSpaces,
    functions: TestFunctions,
    views: Views,
}

impl<'a> Judge<'a> {
    /// A judge that is exact enough for sets of up to `count` points. Another `count` may change the last digits.
    pub(crate) fn new(mesh: &'a SurfaceMesh, count: usize, progress: &dyn Progress) -> Self {
        Self {
            mesh,
            planes: EnergyPlanes::new(mesh, count, &EnergyOptions::default(), progress),
            balls: Balls::new(mesh, &BallOptions::default(), progress),
            half_spaces: HalfSpaces::new(mesh, &HalfSpaceOptions::default(), progress),
            functions: TestFunctions::new(mesh, &IntegrationOptions::default(), progress),
            views: Views::new(mesh, &ViewOptions::for_count(count), progress),
        }
    }

    /// Every measure of one set. The same bits for the same points.
    pub(crate) fn quality(&self, points: &[SurfacePoint], progress: &dyn Progress) -> Quality {
        let mesh = self.mesh;
        let energy = self.planes.measure(mesh, points, progress);
        let step = |stage| progress.begin(stage, 1);
        step("ball");
        let ball = self.balls.measure(mesh, points).norms;
        step("half-space");
        let half_space = self.half_spaces.measure(mesh, points).norms;
        let patch = patch(mesh, points, &PatchOptions::default(), progress);
        let views = self.views.measure(mesh, points, progress);
        step("integration");
        let integration = self.functions.measure(mesh, points);
        let spacing = spacing(mesh, points, &SpacingOptions::default(), progress);
        let shares = components(mesh, points);
        let [sharp, sharp_occluded] = views.is_sharp();
        let view = |norms, reference_error, is_sharp| ViewQuality { norms, reference_error, is_sharp };
        Quality {
            energy,
            ball,
            half_space,
            patch,
            view: view(views.view, views.reference_error, sharp),
            view_occluded: view(views.view_occluded, views.occluded_reference_error, sharp_occluded),
            integration,
            spacing,
            components: ComponentQuality { count: shares.components.len(), worst: shares.worst },
        }
    }
}
