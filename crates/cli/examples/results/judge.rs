//! Every measure of the library for many sets on one mesh: what depends on the mesh alone is computed once.

use ldwrap::measure::{
    BallOptions, Balls, EnergyOptions, EnergyPlanes, HalfSpaceOptions, HalfSpaces, IntegrationOptions,
    PatchOptions, SpacingOptions, TestFunctions, ViewOptions, Views, components, patch, spacing,
};
use ldwrap::{Silent, SurfaceMesh, SurfacePoint};

/// The columns of all tables of measures.
pub(crate) const COLUMNS: [&str; 13] = [
    "eta",
    "energy",
    "ball",
    "half-space",
    "patch",
    "patch sup",
    "view",
    "view, occluded",
    "integration",
    "spacing min",
    "spacing mean",
    "cover",
    "component",
];

/// The numbers of one set, in the order of [`COLUMNS`].
pub(crate) type Scores = [f64; COLUMNS.len()];

/// Measures sets on one mesh.
pub(crate) struct Judge<'a> {
    mesh: &'a SurfaceMesh,
    planes: EnergyPlanes,
    balls: Balls,
    half_spaces: HalfSpaces,
    functions: TestFunctions,
    views: Views,
}

impl<'a> Judge<'a> {
    /// Exact enough for sets of up to `count` points.
    pub(crate) fn new(mesh: &'a SurfaceMesh, count: usize) -> Self {
        Self {
            mesh,
            planes: EnergyPlanes::new(mesh, count, &EnergyOptions::default(), &Silent),
            balls: Balls::new(mesh, &BallOptions::default(), &Silent),
            half_spaces: HalfSpaces::new(mesh, &HalfSpaceOptions::default(), &Silent),
            functions: TestFunctions::new(mesh, &IntegrationOptions::default(), &Silent),
            views: Views::new(mesh, &ViewOptions::for_count(count), &Silent),
        }
    }

    /// Every measure of one set.
    pub(crate) fn scores(&self, points: &[SurfacePoint]) -> Scores {
        let mesh = self.mesh;
        let energy = self.planes.measure(mesh, points, &Silent);
        let patches = patch(mesh, points, &PatchOptions::default(), &Silent);
        let views = self.views.measure(mesh, points);
        let spacing = spacing(mesh, points, &SpacingOptions::default(), &Silent);
        [
            energy.eta,
            energy.mc,
            self.balls.measure(mesh, points).norms.mc,
            self.half_spaces.measure(mesh, points).norms.mc,
            patches.mc,
            patches.linf,
            views.view.mc,
            views.view_occluded.mc,
            self.functions.measure(mesh, points).mc,
            spacing.min,
            spacing.mean,
            spacing.cover,
            components(mesh, points).worst,
        ]
    }
}

/// The mean of each column over sets, with the standard deviation of one set where there are several.
pub(crate) fn cells(sets: &[Scores]) -> Vec<String> {
    let count = sets.len() as f64;
    (0..COLUMNS.len())
        .map(|c| {
            let mean = sets.iter().map(|s| s[c]).sum::<f64>() / count;
            let squares: f64 = sets.iter().map(|s| (s[c] - mean) * (s[c] - mean)).sum();
            match sets.len() {
                1 => format!("{mean:.3}"),
                _ => format!("{mean:.3} ±{:.3}", (squares / (count - 1.0)).sqrt()),
            }
        })
        .collect()
}
