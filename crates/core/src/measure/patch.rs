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
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
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
/// A point on an edge belongs to the one face that it is given on, whichever that is: sets that lie on the edges or
/// corners of a coarse mesh, such as some of its vertices, measure worse here than they are.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baseline::{Baseline, random};
    use crate::mesh::shapes;
    use crate::planted::{join, mesh, moved, turn};
    use crate::progress::Silent;

    #[test]
    fn rings_of_a_square_by_hand() {
        // Two triangles: each is a seed ring, the other the next.
        let square = mesh(&shapes::square(1));
        let mut rings = Vec::new();
        grow(square.topology(), FaceId(1), |ring| rings.push(ring.to_vec()));
        assert_eq!(rings, [vec![FaceId(1)], vec![FaceId(0)]]);
    }

    #[test]
    fn rings_hold_every_face_of_the_component_once() {
        let mut soup = shapes::torus(12, 8, 0.4);
        join(&mut soup, &shapes::cube(2));
        let pair = mesh(&soup);
        let mut seen = Vec::new();
        grow(pair.topology(), FaceId(5), |ring| seen.extend(ring.iter().map(|f| f.index())));
        seen.sort_unstable();
        assert_eq!(seen, (0..192).collect::<Vec<_>>());
    }

    #[test]
    fn all_points_in_one_half_by_hand() {
        // Of the two halves of a square one has all the points. Every seed grows through one half (difference 1/2)
        // and the whole (difference 0).
        let square = mesh(&shapes::square(1));
        let point = SurfacePoint { face: FaceId(0), barycentric: [0.2, 0.3, 0.5] };
        let norms = patch(&square, &[point; 8], &PatchOptions::default(), &Silent);
        assert_eq!((norms.linf, norms.l1), (0.5, 0.25));
        assert!((norms.l2 - (0.125f64).sqrt()).abs() < 1e-15);
        // Random points: v (1 - v) / n = 1/32 for half of the figures.
        assert!((norms.mc - (0.125f64 / (0.125 / 8.0)).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn one_point_a_face_is_perfect_where_faces_are_alike() {
        let square = mesh(&shapes::square(6));
        let third = [1.0 / 3.0; 3];
        let points: Vec<SurfacePoint> =
            square.topology().face_ids().map(|face| SurfacePoint { face, barycentric: third }).collect();
        assert!(patch(&square, &points, &PatchOptions::default(), &Silent).linf < 1e-14);
    }

    #[test]
    fn lattice_beats_random_and_the_order_does_not_matter() {
        let ball = mesh(&shapes::uv_sphere(40, 40));
        let mut points = Baseline::SphereFibonacci.place(&ball, 700, 0).expect("a sphere");
        let measure = |points: &[SurfacePoint]| patch(&ball, points, &PatchOptions::default(), &Silent);
        let norms = measure(&points);
        assert!(norms.mc < 0.3 && norms.l1 <= norms.l2 && norms.l2 <= norms.linf, "{norms:?}");
        points.rotate_left(99);
        assert_eq!(measure(&points), norms);
        assert!(measure(&random(&ball, 700, 1)).mc > 2.0 * norms.mc);
    }

    #[test]
    fn turn_shift_and_scale_do_not_matter() {
        let soup = shapes::torus(20, 10, 0.4);
        let still = mesh(&soup);
        let points = random(&still, 150, 3);
        let other = mesh(&moved(soup, |p| turn() * p * 7.0 + 2.0));
        let [a, b] = [&still, &other].map(|m| patch(m, &points, &PatchOptions::default(), &Silent));
        assert!((a.l2 - b.l2).abs() < 1e-12 && (a.linf - b.linf).abs() < 1e-12);
    }

    #[test]
    #[cfg(feature = "parallel")]
    fn the_same_bits_on_any_number_of_threads() {
        let ball = mesh(&shapes::uv_sphere(20, 20));
        let points = random(&ball, 99, 3);
        let [one, two] =
            crate::planted::with_threads(|| patch(&ball, &points, &PatchOptions::default(), &Silent));
        assert_eq!(one, two);
    }
}
