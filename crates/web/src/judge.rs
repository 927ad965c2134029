//! Measures the points of a run, each relative to independent random points.

use glam::DVec3;
use ldwrap::baseline::hilbert;
use ldwrap::measure::{
    self, BallOptions, EnergyOptions, HalfSpaceOptions, PatchOptions, SpacingOptions, ViewOptions,
};
use ldwrap::{FaceId, Progress, SurfaceMesh, SurfacePoint};
use serde::{Deserialize, Serialize};

/// What can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Measure {
    /// The energy discrepancy.
    Energy,
    /// Shares of half-spaces.
    HalfSpace,
    /// Shares of balls.
    Ball,
    /// Shares of grown patches, the paper's measure.
    Patch,
    /// How much area each point stands for, place by place.
    Local,
    /// Distances of neighbours.
    Spacing,
    /// Visible shares over many views, the paper's purpose.
    View,
}

impl Measure {
    /// All, in the order in which they are shown; quick ones first.
    pub const ALL: [Self; 7] =
        [Self::Energy, Self::HalfSpace, Self::Ball, Self::Patch, Self::Local, Self::Spacing, Self::View];

    /// What a person reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::Energy => "Energy",
            Self::HalfSpace => "Half-spaces",
            Self::Ball => "Balls",
            Self::Patch => "Patches",
            Self::Local => "Local",
            Self::Spacing => "Spacing",
            Self::View => "Views",
        }
    }

    /// What it says, in a sentence.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Energy => "Points on one side of a plane against area there, over all planes in space.",
            Self::HalfSpace => {
                "Points on one side of a plane against area there, over planes through the surface."
            }
            Self::Ball => "Points in a ball against area in it, over balls of many sizes.",
            Self::Patch => "Points in a patch grown on the surface against its area: the paper's measure.",
            Self::Local => "How much area each point stands for; shown as colours.",
            Self::Spacing => "Distances of neighbours over those of the hexagonal lattice.",
            Self::View => {
                "Visible points against visible surface, over views from all sides: the paper's purpose."
            }
        }
    }
}

/// What a measure says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The error over that of independent random points of the same number: 1 is random, smaller is better.
    pub error: Option<f64>,
    /// Further numbers, in words.
    pub note: String,
    /// For each triangle the area that the point nearest to it stands for, over what it should be; empty for
    /// measures that are not local.
    pub local: Vec<f32>,
}

/// Measures points. The test sets are smaller than those of the command line program, so that each measure takes
/// about a second in a browser.
pub fn judge(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    measure: Measure,
    progress: &dyn Progress,
) -> Verdict {
    // Where random points err by nothing either, as on one triangle, there is nothing to compare with.
    let of = |error: f64, note: String| Verdict {
        error: error.is_finite().then_some(error),
        note,
        local: Vec::new(),
    };
    match measure {
        Measure::Energy => {
            let report =
                measure::energy(mesh, points, &EnergyOptions { work: 2e7, ..Default::default() }, progress);
            of(report.mc, format!("eta {:.3}, where 1 is the best that points can be", report.eta))
        }
        Measure::HalfSpace => {
            let options = HalfSpaceOptions { directions: 64, ..Default::default() };
            let norms = measure::half_space(mesh, points, &options, progress).norms;
            of(norms.mc, format!("largest {:.2} %", 100.0 * norms.linf))
        }
        Measure::Ball => {
            let options = BallOptions { balls: 512, ..Default::default() };
            let norms = measure::ball(mesh, points, &options, progress).norms;
            of(norms.mc, format!("largest {:.2} %", 100.0 * norms.linf))
        }
        Measure::Patch => {
            let norms = measure::patch(mesh, points, &PatchOptions { seeds: 48, seed: 0 }, progress);
            of(norms.mc, format!("largest {:.2} %", 100.0 * norms.linf))
        }
        Measure::Spacing => {
            let report = measure::spacing(mesh, points, &SpacingOptions { tolerance: 0.02 }, progress);
            let note =
                format!("smallest {:.2}, mean {:.2}, cover {:.2}", report.min, report.mean, report.cover);
            Verdict { error: None, note, local: Vec::new() }
        }
        Measure::View => {
            let options = ViewOptions { views: 48, occlusions: 2, nodes: 20_000, seed: 0 };
            let report = measure::view(mesh, points, &options, progress);
            of(report.view.mc, format!("with obstacles {:.3}", report.view_occluded.mc))
        }
        Measure::Local => Verdict { local: local(mesh, points, progress), ..Verdict::default() },
    }
}

/// How many places of the surface are given to their nearest point, for each point.
const PLACES: usize = 64;

/// For each triangle the area nearest to the point nearest to it, over area / number of points. The areas are
/// counted at evenly spread places, so they err by about a twentieth.
fn local(mesh: &SurfaceMesh, points: &[SurfacePoint], progress: &dyn Progress) -> Vec<f32> {
    if points.is_empty() {
        return Vec::new();
    }
    progress.begin("local", 1);
    let grid = Grid::new(&points.iter().map(|p| mesh.locate(p)).collect::<Vec<_>>());
    let places = hilbert(mesh, (PLACES * points.len()).min(1_000_000), 1);
    let mut counts = vec![0u32; points.len()];
    for place in &places {
        counts[grid.nearest(mesh.locate(place))] += 1;
    }
    let even = places.len() as f32 / points.len() as f32;
    (0..mesh.face_count())
        .map(|face| {
            let [a, b, c] = mesh.triangle(FaceId::new(face));
            counts[grid.nearest((a + b + c) / 3.0)] as f32 / even
        })
        .collect()
}

/// Points in a grid of cubes of about their distance.
struct Grid {
    low: DVec3,
    side: f64,
    size: [usize; 3],
    starts: Vec<u32>,
    order: Vec<u32>,
    points: Vec<DVec3>,
}

impl Grid {
    fn new(points: &[DVec3]) -> Self {
        let low = points.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
        let high = points.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
        let extent = high - low;
        // On a surface n points fill about n of the cubes when they are extent / sqrt(n) wide.
        let side = (extent.max_element() / (points.len() as f64).sqrt()).max(f64::MIN_POSITIVE);
        let size = extent.to_array().map(|e| ((e / side) as usize + 1).min(512));
        let mut grid = Self {
            low,
            side,
            size,
            starts: vec![0; size.iter().product::<usize>() + 1],
            order: vec![0; points.len()],
            points: points.to_vec(),
        };
        let cells: Vec<usize> = points.iter().map(|p| grid.index(grid.cell(*p))).collect();
        for cell in &cells {
            grid.starts[cell + 1] += 1;
        }
        for cell in 1..grid.starts.len() {
            grid.starts[cell] += grid.starts[cell - 1];
        }
        let mut cursor = grid.starts.clone();
        for (point, cell) in (0..).zip(cells) {
            grid.order[cursor[cell] as usize] = point;
            cursor[cell] += 1;
        }
        grid
    }

    fn cell(&self, p: DVec3) -> [usize; 3] {
        let at = ((p - self.low) / self.side).to_array();
        // The cast saturates: what lies outside is in the outermost cubes.
        std::array::from_fn(|k| (at[k] as usize).min(self.size[k] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.size[1] + y) * self.size[0] + x
    }

    /// The nearest point: rings of cubes around the place until none nearer can come.
    fn nearest(&self, place: DVec3) -> usize {
        let centre = self.cell(place);
        let reach = self.size.iter().copied().max().unwrap_or(1);
        let mut best = (f64::INFINITY, 0);
        for ring in 0..=reach {
            let range = |k: usize| centre[k].saturating_sub(ring)..=(centre[k] + ring).min(self.size[k] - 1);
            for z in range(2) {
                for y in range(1) {
                    for x in range(0) {
                        let apart =
                            x.abs_diff(centre[0]).max(y.abs_diff(centre[1])).max(z.abs_diff(centre[2]));
                        if apart == ring {
                            self.nearest_in(self.index([x, y, z]), place, &mut best);
                        }
                    }
                }
            }
            // Points in farther rings lie at least this far away.
            let next = ring as f64 * self.side;
            if best.0 <= next * next {
                break;
            }
        }
        best.1
    }

    fn nearest_in(&self, cell: usize, place: DVec3, best: &mut (f64, usize)) {
        for &point in &self.order[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
            let squared = self.points[point as usize].distance_squared(place);
            if squared < best.0 {
                *best = (squared, point as usize);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use ldwrap::Silent;
    use ldwrap::baseline::random;
    use ldwrap::shapes::Shape;

    #[test]
    fn the_grid_finds_the_nearest_point() {
        let (mesh, _) = Source::Shape(Shape::Torus).load().unwrap();
        let points: Vec<DVec3> = random(&mesh, 300, 1).iter().map(|p| mesh.locate(p)).collect();
        let grid = Grid::new(&points);
        for place in random(&mesh, 500, 2).iter().map(|p| mesh.locate(p)) {
            let found = points[grid.nearest(place)].distance(place);
            let nearest = points.iter().map(|p| p.distance(place)).fold(f64::INFINITY, f64::min);
            assert_eq!(found, nearest);
        }
    }

    #[test]
    fn even_points_are_judged_better_than_random_ones() {
        let (mesh, _) = Source::Shape(Shape::Sphere).load().unwrap();
        let (even, rough) = (hilbert(&mesh, 400, 1), random(&mesh, 400, 1));
        for measure in Measure::ALL {
            let errors = [&even, &rough].map(|points| judge(&mesh, points, measure, &Silent).error);
            if let [Some(even), Some(rough)] = errors {
                assert!(even < rough, "{}: {even} against {rough}", measure.name());
            }
        }
        let local = judge(&mesh, &even, Measure::Local, &Silent).local;
        assert_eq!(local.len(), 760);
        let mean = local.iter().sum::<f32>() / 760.0;
        assert!((mean - 1.0).abs() < 0.3, "{mean}");
    }
}
