//! Beyond the paper: each component takes the order of growth that leaves the least border open.

use super::fitting::{Tie, fit};
use super::growth::Next;
use super::planar::{Planar, Shapes};
use super::seeds::component_seeds;
use super::{Segment, SegmentOptions, Segmentation, grow};
use crate::mesh::SurfaceMesh;
use crate::parallel;

/// What is tried; of equally good ones the first is taken.
#[derive(Clone, Copy)]
enum Candidate {
    Fit(Tie),
    Grow(Next),
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
    let count = if mesh.face_count() > SMALL { 2 } else { CANDIDATES.len() };
    let tried = parallel::map(count, |k| match CANDIDATES[k] {
        Candidate::Fit(tie) => {
            let mut open = vec![0.0; components.count];
            let segments = fit(mesh, &shapes, &seeds, tolerance, tie).into_iter().zip(&seeds);
            let segments = segments.map(|(fitted, seed)| {
                open[components.of_face[seed.face().index()] as usize] = fitted.open;
                fitted.segment
            });
            (segments.collect(), open)
        }
        Candidate::Grow(next) => {
            let segmentation = grow(mesh, options, next);
            let planar = Planar::of(mesh, &shapes, &segmentation);
            let open = planar.open_lengths(&shapes, &segmentation, components, tolerance);
            (segmentation.segments, open)
        }
    });
    let best: Vec<usize> = (0..components.count)
        .map(|c| (1..tried.len()).fold(0, |best, k| if tried[k].1[c] < tried[best].1[c] { k } else { best }))
        .collect();
    let mut segments: Vec<Segment> = Vec::new();
    for (k, (tried, _)) in tried.into_iter().enumerate() {
        segments.extend(tried.into_iter().filter(|segment: &Segment| {
            let component = segment.attachments.first().map(|a| components.of_face[a.face.index()]);
            component.is_some_and(|c| best[c as usize] == k)
        }));
    }
    Segmentation { segments }
}
