//! Patch discrepancy (paper, section 3): sample figures grown on the surface ring by ring, after Quinn et al. 2007,
//! DOI 10.2312/SPBG/SPBG07/019-028.

use super::{Norms, Shares};
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::{SurfaceMesh, Topology};
use crate::parallel;
use crate::progress::Progress;
use crate::random::Random;
use crate::sample::SurfacePoint;

/// Which patches are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PatchOptions {
    /// From how many random triangles patches grow. More make the norms steadier: `l2` scatters by about
    /// 1 / sqrt(seeds) between values of `seed`. Default: 256.
    pub seeds: usize,
    /// Chooses the triangles. Default: 0.
    pub seed: u64,
}

impl Default for PatchOptions {
    fn default() -> Self {
        Self { seeds: 256, seed: 0 }
    }
}

/// Keeps the stream of random triangles apart from others of the same seed.
const PURPOSE: u64 = 0x70_61_74_63;

/// The norms of share of points - share of area over patches: from each seed triangle the triangle itself, then
/// with its first ring of neighbours across edges, and so on to the whole component. "A random number of rings" is
/// every number of rings, each a figure of its own. A patch holds the points of its faces, and its area is exact.
///
/// O(seeds faces). `progress` counts seed triangles.
pub fn patch(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    options: &PatchOptions,
    progress: &dyn Progress,
) -> Norms {
    let mut counts = vec![0u32; mesh.face_count()];
    for point in points {
        counts[point.face.index()] += 1;
    }
    let seeds = seed_faces(mesh, options);
    progress.begin("patch", seeds.len() as u64);
    let figures = parallel::map(seeds.len(), |i| {
        let mut figures = Vec::new();
        if progress.is_cancelled() {
            return figures;
        }
        let (mut held, mut area) = (0u64, 0.0);
        grow(mesh.topology(), seeds[i], |ring| {
            for face in ring {
                held += u64::from(counts[face.index()]);
                area += mesh.face_area(*face);
            }
            let share = (area / mesh.area()).min(1.0);
            figures.push(Shares { area: share, points: held as f64 / points.len() as f64 });
        });
        progress.advance(1);
        figures
    });
    Norms::over(&figures.concat(), points.len())
}

/// The triangles that patches grow from: independent and uniform, as the paper has it.
pub(super) fn seed_faces(mesh: &SurfaceMesh, options: &PatchOptions) -> Vec<FaceId> {
    let mut random = Random::new(options.seed, PURPOSE);
    let count = if mesh.face_count() == 0 { 0 } else { options.seeds };
    (0..count).map(|_| FaceId::new(random.below(mesh.face_count()))).collect()
}

/// Calls `on_ring` with the seed, then with the ring of faces across an edge from the last, until none is left.
pub(super) fn grow(topology: &Topology, seed: FaceId, mut on_ring: impl FnMut(&[FaceId])) {
    let mut seen = vec![false; topology.face_count()];
    seen[seed.index()] = true;
    let (mut ring, mut next) = (vec![seed], Vec::new());
    while !ring.is_empty() {
        on_ring(&ring);
        next.clear();
        for &face in &ring {
            for corner in 0..3 {
                if let Some(twin) = topology.twin(HalfedgeId::of(face, corner)) {
                    let neighbour = twin.face();
                    if !seen[neighbour.index()] {
                        seen[neighbour.index()] = true;
                        next.push(neighbour);
                    }
                }
            }
        }
        std::mem::swap(&mut ring, &mut next);
    }
}
