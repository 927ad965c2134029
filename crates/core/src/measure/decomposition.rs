//! Decomposition degree (paper, section 3): into how many parts sample figures fall when the surface is unfolded,
//! and the bound that follows (eq. 6 and 7).

use super::patch::{self, PatchOptions};
use super::{Norms, Shares};
use crate::ids::{FaceId, HalfedgeId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::sample::SurfacePoint;
use crate::sets::Sets;
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
        let mut tally = Tally::default();
        if !progress.is_cancelled() {
            let mut parts = Parts::new(mesh.face_count());
            patch::grow(mesh.topology(), seeds[i], |ring| {
                parts.grow(mesh, joints, ring, |_| 0.0);
                tally.add(parts.count);
            });
            progress.advance(1);
        }
        tally
    });
    Tally::total(&tallies)
}

/// Norms over sample figures: eq. 1 to 3 of the paper divided by the number of points.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FigureNorms {
    /// The largest value.
    pub linf: f64,
    /// The mean.
    pub l1: f64,
    /// The root of the mean square.
    pub l2: f64,
}

/// The discrepancy of points over sample figures, and what eq. 6 bounds it by.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PartDiscrepancy {
    /// Into how many parts the figures fall.
    pub decomposition: Decomposition,
    /// Over the figures: what [`patch`](super::patch()) measures.
    pub figure: Norms,
    /// Over the figures, each with the largest |share of points - share of area| of its parts: the norm of eq. 6's
    /// max c times the discrepancy of the plane, measured.
    pub largest_part: FigureNorms,
    /// The bound of eq. 6 on `figure`: f_d times `largest_part`, in each norm. It holds for any points and parts of
    /// any shape, because the difference of a figure is the sum of those of its parts.
    pub bound: FigureNorms,
}

/// Measures points over the figures of [`decomposition`] and over their parts: the bound of eq. 6 from measured parts.
/// A part holds the points of its faces, and its area is exact. NaN without points.
///
/// O(seeds (faces + rings parts)). `progress` counts seed triangles.
pub fn part_discrepancy(
    mesh: &SurfaceMesh,
    joints: &Joints,
    points: &[SurfacePoint],
    options: &PatchOptions,
    progress: &dyn Progress,
) -> PartDiscrepancy {
    let mut counts = vec![0u32; mesh.face_count()];
    for point in points {
        counts[point.face.index()] += 1;
    }
    let n = points.len() as f64;
    let excess = |face: FaceId| f64::from(counts[face.index()]) / n - mesh.face_area(face) / mesh.area();
    let seeds = patch::seed_faces(mesh, options);
    progress.begin("decomposition", seeds.len() as u64);
    let grown = parallel::map(seeds.len(), |i| {
        let (mut tally, mut figures, mut largest) = (Tally::default(), Vec::new(), Vec::new());
        if !progress.is_cancelled() {
            let mut parts = Parts::new(mesh.face_count());
            let (mut held, mut area) = (0u64, 0.0);
            patch::grow(mesh.topology(), seeds[i], |ring| {
                for face in ring {
                    held += u64::from(counts[face.index()]);
                    area += mesh.face_area(*face);
                }
                parts.grow(mesh, joints, ring, excess);
                tally.add(parts.count);
                figures.push(Shares { area: (area / mesh.area()).min(1.0), points: held as f64 / n });
                largest.push(parts.largest());
            });
            progress.advance(1);
        }
        (tally, figures, largest)
    });
    let tallies: Vec<Tally> = grown.iter().map(|(tally, ..)| *tally).collect();
    let figures: Vec<Shares> = grown.iter().flat_map(|(_, figures, _)| figures.iter().copied()).collect();
    let decomposition = Tally::total(&tallies);
    let largest_part = FigureNorms::over(grown.iter().flat_map(|(.., largest)| largest.iter().copied()));
    PartDiscrepancy {
        decomposition,
        figure: Norms::over(&figures, points.len()),
        largest_part,
        bound: largest_part.times(decomposition.degree as f64),
    }
}

impl FigureNorms {
    /// Of values that are not negative; NaN if there is none or one is NaN.
    fn over(values: impl Iterator<Item = f64>) -> Self {
        let (mut linf, mut sum, mut squares, mut count) = (0.0f64, 0.0, 0.0, 0.0);
        for value in values {
            linf = linf.max(value);
            sum += value;
            squares += value * value;
            count += 1.0;
        }
        // A mean without values or of NaN is NaN, which a maximum would hide.
        let l1 = sum / count;
        Self { linf: if l1.is_nan() { f64::NAN } else { linf }, l1, l2: (squares / count).sqrt() }
    }

    fn times(self, factor: f64) -> Self {
        Self { linf: factor * self.linf, l1: factor * self.l1, l2: factor * self.l2 }
    }
}

/// The parts of the figures of one seed.
#[derive(Clone, Copy, Default)]
struct Tally {
    most: usize,
    sum: u64,
    figures: u64,
}

impl Tally {
    fn add(&mut self, parts: usize) {
        self.most = self.most.max(parts);
        self.sum += parts as u64;
        self.figures += 1;
    }

    fn total(tallies: &[Self]) -> Decomposition {
        let mut total = Self::default();
        for tally in tallies {
            total.most = total.most.max(tally.most);
            total.sum += tally.sum;
            total.figures += tally.figures;
        }
        Decomposition {
            degree: total.most,
            mean: total.sum as f64 / total.figures as f64,
            figures: total.figures as usize,
        }
    }
}

/// The bound of eq. 7 on the share of points - share of area of any sample figure: `degree` times the discrepancy
/// `planar` (a share of the `domain_points` points in the planar domain) over `points`, the number of points on the
/// surface. The factor c of the paper, at most 1, is taken as 1. `planar` must bound figures of the parts' shapes:
/// for boxes of any place it is at most four times the star discrepancy; other convex parts can exceed that, so with
/// it the number is a guide rather than a proof.
pub fn surface_bound(degree: usize, planar: f64, domain_points: usize, points: usize) -> f64 {
    degree as f64 * planar * domain_points as f64 / points as f64
}

/// Faces added ring by ring and joined.
struct Parts {
    sets: Sets,
    is_added: Vec<bool>,
    count: usize,
    /// For each root the share of points less the share of area of its part.
    excess: Vec<f64>,
    /// The roots, and since the last call of [`largest`](Self::largest) also what was one.
    roots: Vec<u32>,
}

impl Parts {
    fn new(faces: usize) -> Self {
        Self {
            sets: Sets::new(faces),
            is_added: vec![false; faces],
            count: 0,
            excess: vec![0.0; faces],
            roots: Vec::new(),
        }
    }

    /// Adds the faces of a ring, each with its excess, and joins what lies joined in the plane.
    fn grow(&mut self, mesh: &SurfaceMesh, joints: &Joints, ring: &[FaceId], excess: impl Fn(FaceId) -> f64) {
        for &face in ring {
            self.add(face, excess(face));
            for corner in 0..3 {
                let halfedge = HalfedgeId::of(face, corner);
                if joints.is_joined(halfedge)
                    && let Some(twin) = mesh.topology().twin(halfedge)
                {
                    self.join(face.0, twin.face().0);
                }
            }
        }
    }

    fn add(&mut self, face: FaceId, excess: f64) {
        self.is_added[face.index()] = true;
        self.excess[face.index()] = excess;
        self.roots.push(face.0);
        self.count += 1;
    }

    /// Joins the parts of two faces; nothing happens while one of them is absent.
    fn join(&mut self, a: u32, b: u32) {
        if !self.is_added[a as usize] || !self.is_added[b as usize] {
            return;
        }
        let (a, b) = (self.sets.root(a), self.sets.root(b));
        if a != b {
            let joined = self.sets.join(a, b);
            self.excess[joined as usize] += self.excess[a.max(b) as usize];
            self.count -= 1;
        }
    }

    /// The largest |excess| of a part; NaN if one is NaN.
    fn largest(&mut self) -> f64 {
        let Self { sets, roots, excess, .. } = self;
        roots.retain(|&face| sets.is_root(face));
        roots
            .iter()
            .map(|&face| excess[face as usize].abs())
            .fold(0.0, |largest: f64, value| if value.is_nan() { value } else { largest.max(value) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baseline::random;
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
        let excess = |face: FaceId| f64::from(face.0 % 7) - 3.0;
        let mut figure = vec![false; ball.face_count()];
        let mut parts = Parts::new(ball.face_count());
        patch::grow(ball.topology(), seed, |ring| {
            parts.grow(&ball, &joints, ring, excess);
            for &face in ring {
                figure[face.index()] = true;
            }
            let mut seen = figure.iter().map(|&inside| !inside).collect::<Vec<bool>>();
            let (mut count, mut largest) = (0, 0.0f64);
            for start in ball.topology().face_ids() {
                if seen[start.index()] {
                    continue;
                }
                count += 1;
                let (mut stack, mut sum) = (vec![start], 0.0);
                while let Some(face) = stack.pop() {
                    if std::mem::replace(&mut seen[face.index()], true) {
                        continue;
                    }
                    sum += excess(face);
                    for corner in 0..3 {
                        let halfedge = HalfedgeId::of(face, corner);
                        if joints.is_joined(halfedge) {
                            stack.extend(ball.topology().twin(halfedge).map(HalfedgeId::face));
                        }
                    }
                }
                largest = largest.max(sum.abs());
            }
            assert_eq!(parts.count, count);
            // Whole numbers: their sums have no rounding.
            assert_eq!(parts.largest(), largest);
        });
    }

    #[test]
    fn eq_6_by_hand() {
        // Two triangles cut apart, all points in one: each figure has a part that is off by a half. The first ring is
        // off by a half, the whole square by nothing.
        let square = mesh(&shapes::square(1));
        let alone = |face| Segment { attachments: vec![Attachment { face, across: None }] };
        let cut = Segmentation { segments: square.topology().face_ids().map(alone).collect() };
        let joints = Joints::of(&square, &unfold(&square, &cut), 1e9);
        let point = SurfacePoint { face: FaceId(0), barycentric: [0.2, 0.3, 0.5] };
        let report = part_discrepancy(&square, &joints, &[point; 8], &PatchOptions::default(), &Silent);
        assert_eq!(report.decomposition.degree, 2);
        assert_eq!(report.largest_part, FigureNorms { linf: 0.5, l1: 0.5, l2: 0.5 });
        assert_eq!(report.bound, FigureNorms { linf: 1.0, l1: 1.0, l2: 1.0 });
        assert_eq!((report.figure.linf, report.figure.l1), (0.5, 0.25));
        let none = part_discrepancy(&square, &joints, &[], &PatchOptions::default(), &Silent);
        assert!(none.bound.linf.is_nan() && none.largest_part.l2.is_nan() && none.figure.l1.is_nan());
        assert_eq!(none.decomposition, report.decomposition);
    }

    #[test]
    fn eq_6_holds_in_every_norm_and_measures_what_patches_do() {
        let options = PatchOptions { seeds: 40, seed: 1 };
        for soup in [shapes::uv_sphere(20, 20), shapes::torus(30, 12, 0.4), shapes::scan_like(2, 900)] {
            let body = mesh(&soup);
            let points = random(&body, 120, 4);
            for tolerance in [1e-9, 0.02, 1e9] {
                let joints = Joints::of(&body, &unfolded(&body), tolerance);
                let report = part_discrepancy(&body, &joints, &points, &options, &Silent);
                assert_eq!(report.figure, patch::patch(&body, &points, &options, &Silent));
                assert_eq!(report.decomposition, decomposition(&body, &joints, &options, &Silent));
                let (figure, bound) = (report.figure, report.bound);
                assert!(figure.linf <= bound.linf + 1e-12, "{report:?}");
                assert!(figure.l1 <= bound.l1 + 1e-12 && figure.l2 <= bound.l2 + 1e-12, "{report:?}");
            }
        }
    }

    #[test]
    fn without_cuts_eq_6_is_the_measured_value() {
        let square = mesh(&shapes::square(6));
        let joints = Joints::of(&square, &unfolded(&square), 1e-9);
        let points = random(&square, 50, 2);
        let report = part_discrepancy(&square, &joints, &points, &PatchOptions::default(), &Silent);
        let Norms { linf, l1, l2, .. } = report.figure;
        assert_eq!(report.decomposition.degree, 1);
        for (bound, measured) in [(report.bound.linf, linf), (report.bound.l1, l1), (report.bound.l2, l2)] {
            assert!((bound - measured).abs() < 1e-12, "{report:?}");
        }
    }

    #[test]
    fn eq_7_by_hand() {
        // Ten parts, each off by at most 2 of 100 points in the domain, of which 50 land on the surface: 20 of 50.
        assert!((surface_bound(10, 0.02, 100, 50) - 0.4).abs() < 1e-15);
    }
}
