//! Decomposition degree (paper, section 3): into how many parts sample figures fall when the surface is unfolded,
//! and the bound that follows (eq. 6 and 7).

use super::patch::{self, PatchOptions};
use crate::ids::HalfedgeId;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::unfold::Strips;

/// Into how many parts sample figures fall.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Decomposition {
    /// f_d: the largest number of parts of a figure.
    pub degree: usize,
    /// The mean number of parts.
    pub mean: f64,
    /// How many figures were looked at.
    pub figures: usize,
}

/// Which edges of the surface still join their two faces after unfolding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Joints {
    joined: Vec<bool>,
}

impl Joints {
    /// An edge joins when both faces lie in one strip and the two copies of each of its ends lie no farther apart
    /// than `tolerance`, in units of the mesh. The paper's correction closes cuts up to 0.1 d_m.
    pub fn of(mesh: &SurfaceMesh, strips: &Strips, tolerance: f64) -> Self {
        let topology = mesh.topology();
        let corner = |halfedge: HalfedgeId| {
            let place = strips.places[halfedge.face().index()];
            let strip = &strips.strips[place.strip.index()];
            let vertex = strip.corners[place.index as usize][halfedge.corner()];
            (place.strip, strip.vertices[vertex as usize])
        };
        let joined = parallel::map(mesh.face_count() * 3, |h| {
            let halfedge = HalfedgeId::new(h);
            let Some(twin) = topology.twin(halfedge) else { return false };
            let near = |a: HalfedgeId, b: HalfedgeId| {
                let ((strip, p), (other, q)) = (corner(a), corner(b));
                strip == other && p.distance(q) <= tolerance
            };
            near(halfedge, twin.next()) && near(halfedge.next(), twin)
        });
        Self { joined }
    }

    /// Whether the two faces beside this edge lie joined in the plane.
    pub fn is_joined(&self, halfedge: HalfedgeId) -> bool {
        self.joined[halfedge.index()]
    }
}

/// Into how many parts patches fall: sets of faces joined across edges in the plane. The figures are those of
/// [`patch`](super::patch()), so a degree stands beside the discrepancy measured over the same figures. The paper's
/// parts are convex as well; a part here is counted once whatever its shape.
///
/// O(seeds faces). `progress` counts seed triangles.
pub fn decomposition(
    mesh: &SurfaceMesh,
    joints: &Joints,
    options: &PatchOptions,
    progress: &dyn Progress,
) -> Decomposition {
    let seeds = patch::seed_faces(mesh, options);
    progress.begin("decomposition", seeds.len() as u64);
    let tallies = parallel::map(seeds.len(), |i| {
        if progress.is_cancelled() {
            return (0, 0, 0);
        }
        let mut parts = Parts::new(mesh.face_count());
        let (mut most, mut sum, mut figures) = (0, 0u64, 0u64);
        patch::grow(mesh.topology(), seeds[i], |ring| {
            for &face in ring {
                parts.add(face.0);
                for corner in 0..3 {
                    let halfedge = HalfedgeId::of(face, corner);
                    if joints.is_joined(halfedge)
                        && let Some(twin) = mesh.topology().twin(halfedge)
                    {
                        parts.join(face.0, twin.face().0);
                    }
                }
            }
            most = most.max(parts.count);
            sum += parts.count as u64;
            figures += 1;
        });
        progress.advance(1);
        (most, sum, figures)
    });
    let (mut degree, mut sum, mut figures) = (0, 0, 0);
    for (most, parts, count) in tallies {
        degree = degree.max(most);
        sum += parts;
        figures += count;
    }
    Decomposition { degree, mean: sum as f64 / figures as f64, figures: figures as usize }
}

/// The bound of eq. 7 on the share of points - share of area of any sample figure: `degree` times the discrepancy
/// `planar` (a share of the `domain_points` points in the planar domain) over `points`, the number of points on the
/// surface. The factor c of the paper, at most 1, is taken as 1. `planar` must bound figures of the parts' shapes:
/// for boxes of any place it is at most four times the star discrepancy; other convex parts can exceed that, so with
/// it the number is a guide rather than a proof.
pub fn surface_bound(degree: usize, planar: f64, domain_points: usize, points: usize) -> f64 {
    degree as f64 * planar * domain_points as f64 / points as f64
}

/// Faces added one by one and joined: union-find with path halving.
struct Parts {
    parent: Vec<u32>,
    count: usize,
}

/// A face that was not added yet.
const ABSENT: u32 = u32::MAX;

impl Parts {
    fn new(faces: usize) -> Self {
        Self { parent: vec![ABSENT; faces], count: 0 }
    }

    fn add(&mut self, face: u32) {
        self.parent[face as usize] = face;
        self.count += 1;
    }

    fn root(&mut self, mut face: u32) -> u32 {
        while self.parent[face as usize] != face {
            let above = self.parent[self.parent[face as usize] as usize];
            self.parent[face as usize] = above;
            face = above;
        }
        face
    }

    /// Joins the parts of two faces; nothing happens while one of them is absent.
    fn join(&mut self, a: u32, b: u32) {
        if self.parent[a as usize] == ABSENT || self.parent[b as usize] == ABSENT {
            return;
        }
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            self.parent[a.max(b) as usize] = a.min(b);
            self.count -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::FaceId;
    use crate::mesh::shapes;
    use crate::planted::mesh;
    use crate::progress::Silent;
    use crate::segment::{Attachment, Segment, SegmentOptions, Segmentation, segment};
    use crate::unfold::unfold;

    fn unfolded(mesh: &SurfaceMesh) -> Strips {
        unfold(mesh, &segment(mesh, &SegmentOptions::default()))
    }

    #[test]
    fn a_flat_square_does_not_fall_apart() {
        let square = mesh(&shapes::square(5));
        let joints = Joints::of(&square, &unfolded(&square), 1e-9);
        let parts = decomposition(&square, &joints, &PatchOptions::default(), &Silent);
        assert_eq!((parts.degree, parts.mean), (1, 1.0));
    }

    #[test]
    fn faces_in_segments_of_their_own_fall_apart_entirely() {
        let square = mesh(&shapes::square(3));
        let alone = |face| Segment { attachments: vec![Attachment { face, across: None }] };
        let cut = Segmentation { segments: square.topology().face_ids().map(alone).collect() };
        let joints = Joints::of(&square, &unfold(&square, &cut), 1e9);
        let options = PatchOptions { seeds: 1, seed: 3 };
        let parts = decomposition(&square, &joints, &options, &Silent);
        // Every figure falls into its triangles; the last is the whole square.
        assert_eq!(parts.degree, 18);
        let mut sizes = Vec::new();
        patch::grow(square.topology(), patch::seed_faces(&square, &options)[0], |ring| {
            sizes.push(ring.len() + sizes.last().copied().unwrap_or(0));
        });
        assert_eq!(parts.figures, sizes.len());
        assert_eq!(parts.mean, sizes.iter().sum::<usize>() as f64 / sizes.len() as f64);
    }

    #[test]
    fn a_cut_of_a_tetrahedron_is_open_until_the_tolerance_closes_it() {
        let body = mesh(&shapes::tetrahedron());
        let all = SegmentOptions { flatness_angle: std::f64::consts::PI, ..SegmentOptions::default() };
        let strips = unfold(&body, &segment(&body, &all));
        assert_eq!(strips.strips.len(), 1);
        let joined = |tolerance| {
            let joints = Joints::of(&body, &strips, tolerance);
            (0..12).filter(|&h| joints.is_joined(HalfedgeId::new(h))).count()
        };
        // The spanning tree of four faces joins three edges, each with two sides.
        assert_eq!(joined(1e-9), 6);
        assert_eq!(joined(1e9), 12);
        let whole = |tolerance| {
            let joints = Joints::of(&body, &strips, tolerance);
            decomposition(&body, &joints, &PatchOptions::default(), &Silent).degree
        };
        // A face with its three neighbours is the whole body, one strip; never more than the three neighbours of a
        // face that is joined to none of them.
        assert!(whole(1e-9) <= 3 && whole(1e9) == 1);
    }

    #[test]
    fn joints_agree_with_their_twins() {
        let ball = mesh(&shapes::uv_sphere(20, 20));
        let joints = Joints::of(&ball, &unfolded(&ball), 1e-3);
        for face in ball.topology().face_ids() {
            for corner in 0..3 {
                let halfedge = HalfedgeId::of(face, corner);
                let twin = ball.topology().twin(halfedge).expect("a closed body");
                assert_eq!(joints.is_joined(halfedge), joints.is_joined(twin));
            }
        }
    }

    #[test]
    fn parts_are_counted_as_by_flooding() {
        let ball = mesh(&shapes::uv_sphere(12, 12));
        let joints = Joints::of(&ball, &unfolded(&ball), 1e-6);
        let seed = FaceId(17);
        let mut figure = vec![false; ball.face_count()];
        let mut parts = Parts::new(ball.face_count());
        patch::grow(ball.topology(), seed, |ring| {
            for &face in ring {
                figure[face.index()] = true;
                parts.add(face.0);
                for corner in 0..3 {
                    let halfedge = HalfedgeId::of(face, corner);
                    let twin = ball.topology().twin(halfedge).expect("a closed body");
                    if joints.is_joined(halfedge) {
                        parts.join(face.0, twin.face().0);
                    }
                }
            }
            let mut seen = figure.iter().map(|&inside| !inside).collect::<Vec<bool>>();
            let mut count = 0;
            for start in ball.topology().face_ids() {
                if seen[start.index()] {
                    continue;
                }
                count += 1;
                let mut stack = vec![start];
                while let Some(face) = stack.pop() {
                    if std::mem::replace(&mut seen[face.index()], true) {
                        continue;
                    }
                    for corner in 0..3 {
                        let halfedge = HalfedgeId::of(face, corner);
                        if joints.is_joined(halfedge) {
                            stack.extend(ball.topology().twin(halfedge).map(HalfedgeId::face));
                        }
                    }
                }
            }
            assert_eq!(parts.count, count);
        });
    }

    #[test]
    fn the_bound_by_hand() {
        // Ten parts, each off by at most 2 of 100 points in the domain, of which 50 land on the surface: 20 of 50.
        assert!((surface_bound(10, 0.02, 100, 50) - 0.4).abs() < 1e-15);
    }
}
