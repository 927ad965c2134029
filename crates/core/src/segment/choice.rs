//! Beyond the paper: each component takes the order of growth that leaves the least border open.

use super::fitting::{Fitted, Tie, fit};
use super::growth::Next;
use super::planar::{Planar, Shapes};
use super::seeds::component_seeds;
use super::{Segment, SegmentOptions, Segmentation, grow};
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// What is tried; of equally good ones the first is taken.
#[derive(Clone, Copy)]
enum Candidate {
    Fit(Tie),
    Grow(Next),
}

/// The segments that a candidate gives.
enum Tried {
    Fitted(Vec<Fitted>),
    Grown(Vec<Segment>),
}

/// No single order is best on every surface: flat fingers suit scanned bodies, round strips tubes, the paper's walk tori.
/// On meshes of more than [`SMALL`] faces the first two alone are tried.
const CANDIDATES: [Candidate; 5] = [
    Candidate::Fit(Tie::Flattest),
    Candidate::Fit(Tie::Nearest),
    Candidate::Fit(Tie::Tightest),
    Candidate::Grow(Next::Oldest),
    Candidate::Grow(Next::Flattest),
];

/// The most faces for which time is spent on all candidates.
const SMALL: usize = 20_000;

/// Tries the candidates and puts together what is best for each component.
pub(super) fn least_open(mesh: &SurfaceMesh, options: &SegmentOptions, tolerance: f64) -> Segmentation {
    let components = mesh.topology().components();
    let (shapes, seeds) = parallel::join(|| Shapes::new(mesh), || component_seeds(mesh));
    let tolerance = shapes.relative(tolerance);
    let count = if mesh.face_count() > SMALL { 2 } else { CANDIDATES.len() };
    let tried = parallel::map(count, |k| match CANDIDATES[k] {
        Candidate::Fit(tie) => {
            let fitted = fit(mesh, &shapes, &seeds, tolerance, tie);
            let mut open = vec![0.0; components.count];
            for (fitted, seed) in fitted.iter().zip(&seeds) {
                open[components.of_face[seed.face().index()] as usize] = fitted.open;
            }
            (Tried::Fitted(fitted), open)
        }
        Candidate::Grow(next) => {
            let segmentation = grow(mesh, options, next);
            let planar = Planar::of(mesh, &shapes, &segmentation);
            let open = planar.open_lengths(&shapes, &segmentation, components, tolerance);
            (Tried::Grown(segmentation.segments), open)
        }
    });
    drop(shapes);
    let best: Vec<usize> = (0..components.count)
        .map(|c| (1..tried.len()).fold(0, |best, k| if tried[k].1[c] < tried[best].1[c] { k } else { best }))
        .collect();
    let mut segments: Vec<Segment> = Vec::new();
    for (k, (tried, _)) in tried.into_iter().enumerate() {
        let is_best = |face: FaceId| best[components.of_face[face.index()] as usize] == k;
        match tried {
            Tried::Fitted(fitted) => {
                segments.extend(fitted.iter().filter(|f| is_best(f.sides[0].face())).map(Fitted::segment));
            }
            Tried::Grown(grown) => {
                segments.extend(grown.into_iter().filter(|s| is_best(s.attachments[0].face)));
            }
        }
    }
    Segmentation { segments }
}
