//! Beyond the paper: each component takes the order of growth that leaves the least border open.

use super::fitting::{Tie, fit};
use super::growth::Next;
use super::planar::Planar;
use super::{SegmentOptions, Segmentation, grow};
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
    let count = if mesh.face_count() > SMALL { 2 } else { CANDIDATES.len() };
    let tried = parallel::map(count, |k| {
        let segmentation = match CANDIDATES[k] {
            Candidate::Fit(tie) => fit(mesh, tolerance, tie),
            Candidate::Grow(next) => grow(mesh, options, next),
        };
        let open = Planar::of(mesh, &segmentation).open_lengths(mesh, &segmentation, &components, tolerance);
        (segmentation, open)
    });
    let best: Vec<usize> = (0..components.count)
        .map(|c| (1..tried.len()).fold(0, |best, k| if tried[k].1[c] < tried[best].1[c] { k } else { best }))
        .collect();
    let mut segments = Vec::new();
    for (k, (segmentation, _)) in tried.into_iter().enumerate() {
        segments.extend(segmentation.segments.into_iter().filter(|segment| {
            let component = segment.attachments.first().map(|a| components.of_face[a.face.index()]);
            component.is_some_and(|c| best[c as usize] == k)
        }));
    }
    Segmentation { segments }
}
