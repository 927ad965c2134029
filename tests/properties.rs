//! Properties that hold for any input: planted ones first, then random ones.

use glam::{DMat3, DVec2, DVec3, dvec2};
use ldwrap::correct::correct;
use ldwrap::domain::{DomainPoints, PlanarDomain};
use ldwrap::geometry::plane;
use ldwrap::pipeline::{Options, Request, Run, run};
use ldwrap::segment::SegmentOptions;
use ldwrap::sequence::Sequence;
use ldwrap::shapes::{self, Shape};
use ldwrap::unfold::{FacePlace, Strip, Strips, Twin};
use ldwrap::wrap::wrap;
use ldwrap::{FaceId, PolygonSoup, Sample, Silent, StripId, SurfaceMesh};
use ldwrap_tests::{Unfolded, check_segmentation, check_strips, mesh, unfolded};
use proptest::prelude::*;

/// A random triangulation of a square in whole numbers, so that points can be planted on its edges and corners.
mod tiling {
    type Place = [i64; 2];

    /// Counterclockwise triangles that cover the square from (0, 0) to (side, side) once.
    #[derive(Clone, Debug)]
    pub(crate) struct Tiling {
        pub(crate) vertices: Vec<Place>,
        pub(crate) triangles: Vec<[usize; 3]>,
    }

    fn orientation(a: Place, b: Place, c: Place) -> i64 {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    impl Tiling {
        pub(crate) fn of_square(side: i64) -> Self {
            let vertices = vec![[0, 0], [side, 0], [side, side], [0, side]];
            Self { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] }
        }

        /// How far inside a place is of each of a triangle's sides.
        fn sides(&self, triangle: [usize; 3], place: Place) -> [i64; 3] {
            let [a, b, c] = triangle.map(|v| self.vertices[v]);
            [orientation(a, b, place), orientation(b, c, place), orientation(c, a, place)]
        }

        /// Adds a vertex in the square, unless there is one: triangles that hold it, inside or on a side, are cut.
        pub(crate) fn insert(&mut self, place: Place) {
            if self.vertices.contains(&place) {
                return;
            }
            let new = self.vertices.len();
            self.vertices.push(place);
            for [a, b, c] in std::mem::take(&mut self.triangles) {
                let sides = self.sides([a, b, c], place);
                if sides.iter().any(|&s| s < 0) {
                    self.triangles.push([a, b, c]);
                    continue;
                }
                // A side that the vertex lies on gives no triangle.
                let cut = [[a, b, new], [b, c, new], [c, a, new]];
                self.triangles.extend(cut.into_iter().zip(sides).filter(|(_, s)| *s > 0).map(|(t, _)| t));
            }
        }

        /// Turns the `edge`-th side into the other diagonal of its two triangles, where that is possible.
        pub(crate) fn flip(&mut self, edge: usize) {
            let (first, corner) = (edge / 3 % self.triangles.len(), edge % 3);
            let t = self.triangles[first];
            let (a, b, c) = (t[corner], t[(corner + 1) % 3], t[(corner + 2) % 3]);
            let shared = |t: &[usize; 3]| (0..3).find(|&k| t[k] == b && t[(k + 1) % 3] == a);
            let Some(second) = self.triangles.iter().position(|t| shared(t).is_some()) else { return };
            let other = self.triangles[second];
            let Some(k) = shared(&other) else { return };
            let d = other[(k + 2) % 3];
            let at = |v: usize| self.vertices[v];
            if orientation(at(d), at(b), at(c)) > 0 && orientation(at(a), at(d), at(c)) > 0 {
                self.triangles[first] = [d, b, c];
                self.triangles[second] = [a, d, c];
            }
        }

        /// Twice the area of the square, by its triangles, all counterclockwise.
        pub(crate) fn doubled_area(&self) -> i64 {
            let doubled =
                |t: &[usize; 3]| orientation(self.vertices[t[0]], self.vertices[t[1]], self.vertices[t[2]]);
            assert!(self.triangles.iter().all(|t| doubled(t) > 0));
            self.triangles.iter().map(doubled).sum()
        }
    }
}

use tiling::Tiling;

/// The square has sides of this many units; the domain is twice as large.
const SIDE: i64 = 2048;

/// Sequences whose first 4,096 points lie on whole numbers of the domain; the last are all on its diagonal.
const WHOLE: [Sequence; 3] = [
    Sequence::Hammersley { base: 2 },
    Sequence::Halton { bases: [2, 4] },
    Sequence::Hammersley { base: 4096 },
];
const COUNT: u32 = 4096;

/// The domain's points as whole numbers.
fn whole_points(sequence: Sequence, shift: DVec2) -> Vec<[i64; 2]> {
    (0..u64::from(COUNT))
        .map(|i| {
            let p = ldwrap::sequence::shift(sequence.point(i, u64::from(COUNT)), shift) * (2 * SIDE) as f64;
            let whole = [p.x as i64, p.y as i64];
            assert_eq!([whole[0] as f64, whole[1] as f64], [p.x, p.y], "a whole number");
            whole
        })
        .collect()
}

fn strip_of(tilings: &[Tiling]) -> Strip {
    let mut strip = Strip {
        faces: Vec::new(),
        corners: Vec::new(),
        vertices: Vec::new(),
        border: Vec::new(),
        loops: Vec::new(),
        area: 0.0,
        extent: DVec2::splat(SIDE as f64),
    };
    for tiling in tilings {
        let first = strip.vertices.len();
        strip.vertices.extend(tiling.vertices.iter().map(|&[x, y]| dvec2(x as f64, y as f64)));
        strip.corners.extend(tiling.triangles.iter().map(|t| t.map(|v| (first + v) as u32)));
        strip.area += 0.5 * tiling.doubled_area() as f64;
    }
    strip.faces = (0..strip.corners.len()).map(FaceId::new).collect();
    strip
}

/// What is done to a tiling: a vertex planted on a point of the sequence, one anywhere, or an edge turned.
#[derive(Clone, Debug)]
enum Edit {
    Plant(usize),
    Insert([i64; 2]),
    Flip(usize),
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let edit = prop_oneof![
        3 => any::<usize>().prop_map(Edit::Plant),
        1 => [0..=SIDE, 0..=SIDE].prop_map(Edit::Insert),
        4 => (0..100_000usize).prop_map(Edit::Flip),
    ];
    prop::collection::vec(edit, 0..80)
}

fn tiling(edits: &[Edit], planted: &[[i64; 2]]) -> Tiling {
    let mut tiling = Tiling::of_square(SIDE);
    for edit in edits {
        match *edit {
            Edit::Plant(i) if planted.is_empty() => tiling.flip(i % 1000),
            Edit::Plant(i) => tiling.insert(planted[i % planted.len()]),
            Edit::Insert(place) => tiling.insert(place),
            Edit::Flip(edge) => tiling.flip(edge),
        }
    }
    assert_eq!(tiling.doubled_area(), 2 * SIDE * SIDE);
    tiling
}

fn is_inside([x, y]: [i64; 2], offset: [i64; 2]) -> bool {
    (offset[0]..offset[0] + SIDE).contains(&x) && (offset[1]..offset[1] + SIDE).contains(&y)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Also points exactly on edges and corners: a square that is tiled once catches each of its points once, and one
    /// that is tiled `sheets` times, each time in another way, that often. Of its border, the left and the lower
    /// side belong to it.
    #[test]
    fn a_point_where_a_strip_covers_once_gives_exactly_one_surface_point(
        sheets in prop::collection::vec(edits(), 1..3),
        which in 0..WHOLE.len(),
        shift in [0..2 * SIDE, 0..2 * SIDE],
        offset in [0..=SIDE, 0..=SIDE],
    ) {
        let sequence = WHOLE[which];
        let shift = dvec2(shift[0] as f64, shift[1] as f64) / (2 * SIDE) as f64;
        let all = whole_points(sequence, shift);
        let planted: Vec<_> =
            all.iter().filter(|p| is_inside(**p, offset)).map(|p| [p[0] - offset[0], p[1] - offset[1]]).collect();
        let sheets: Vec<_> = sheets.iter().map(|edits| tiling(edits, &planted)).collect();
        let strip = strip_of(&sheets);
        let places = (0..strip.faces.len()).map(|i| FacePlace { strip: StripId(0), index: i as u32 }).collect();
        let strips = Strips { strips: vec![strip], places };
        let offset_place = dvec2(offset[0] as f64, offset[1] as f64);
        let domain = PlanarDomain { side: (2 * SIDE) as f64, offsets: vec![offset_place] };
        let points = DomainPoints::scatter(&domain, &sequence, COUNT, shift);
        let wrapping = wrap(&strips, &domain, &points);
        let mut caught = vec![0; all.len()];
        for wrapped in wrapping.points_of(&strips, &domain, &points, StripId(0)) {
            caught[wrapped.index as usize] += 1;
            let (_, laid) = strips.lay_point(&wrapped.point);
            prop_assert!((laid + offset_place).distance(wrapped.place) <= 1e-9 * domain.side);
        }
        for (i, &p) in all.iter().enumerate() {
            prop_assert_eq!(caught[i], if is_inside(p, offset) { sheets.len() } else { 0 }, "point {:?}", p);
        }
    }

    /// A plane is unfolded without a cut, wherever it lies in space, and every point well inside is caught once.
    #[test]
    fn a_plane_in_space_is_unfolded_without_a_cut(
        edits in edits(),
        axis in [-1.0..1.0, -1.0..1.0, -1.0..1.0f64],
        angle in 0.0..6.0,
        at in [-3e3..3e3, -3e3..3e3, -3e3..3e3f64],
    ) {
        let tiling = tiling(&edits, &[]);
        let axis = DVec3::from(axis).try_normalize().unwrap_or(DVec3::Z);
        let turn = DMat3::from_axis_angle(axis, angle);
        let mut soup = PolygonSoup {
            positions: tiling.vertices.iter().map(|&[x, y]| {
                turn * DVec3::new(x as f64, y as f64, 0.0) + DVec3::from(at)
            }).collect(),
            ..PolygonSoup::default()
        };
        for t in &tiling.triangles {
            soup.push_polygon(&t.map(|v| v as u32));
        }
        let mesh = mesh(&soup);
        prop_assume!(mesh.face_count() == tiling.triangles.len());
        let Unfolded { segmentation, strips, domain } = unfolded(&mesh, &SegmentOptions::default());
        check_segmentation("plane", &mesh, &segmentation);
        check_strips("plane", &mesh, &segmentation, &strips);
        prop_assert_eq!(strips.strips.len(), 1);
        let strip = &strips.strips[0];
        prop_assert!(strip.border.iter().all(|e| e.twin == Twin::MeshBorder), "a cut in a plane");
        prop_assert_eq!(strip.loops.len(), 1);
        let count = 500;
        let points = DomainPoints::scatter(&domain, &Sequence::default(), count, DVec2::ZERO);
        let mut caught = vec![0; count as usize];
        for wrapped in wrap(&strips, &domain, &points).points_of(&strips, &domain, &points, StripId(0)) {
            caught[wrapped.index as usize] += 1;
        }
        for (i, caught) in (0..).zip(caught) {
            let place = Sequence::default().point(i, u64::from(count)) * domain.side;
            // The square is convex: inside is to the left of every border edge.
            let depth = strip.border.iter().map(|e| {
                let [a, b] = [e.from, e.to].map(|v| strip.vertices[v as usize]);
                plane::orientation(a, b, place) / a.distance(b)
            }).fold(f64::INFINITY, f64::min);
            if depth.abs() > 1e-6 {
                prop_assert_eq!(caught, usize::from(depth > 0.0), "point {}, {} inside", i, depth);
            }
        }
    }
}

/// Everything a run made that must not depend on anything but its input, to the bit.
fn bits(run: &Run) -> String {
    format!(
        "{:?} {:?} {:?} {:?} {:?}",
        run.samples,
        run.correction,
        run.irregularity(),
        run.equalize,
        run.domain
    )
}

fn found(mesh: &SurfaceMesh, options: &Options) -> Run {
    run(mesh, options, &Silent).expect("the options can be met")
}

#[test]
fn the_same_bits_with_one_thread_and_with_two() {
    for shape in [Shape::Cup, Shape::Scan, Shape::Plate] {
        let mesh = mesh(&shape.generate_about(9_000));
        for (request, equalize) in [
            (Request::Count(500), None),
            (Request::Count(300), Some(Default::default())),
            (Request::Spacing(0.2), None),
        ] {
            let options = Options { request, equalize, seed: 3, ..Options::default() };
            let [one, two] = [1, 2].map(|threads| {
                let pool =
                    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a small pool");
                pool.install(|| bits(&found(&mesh, &options)))
            });
            assert!(one == two, "{}: {request:?} differs", shape.name());
            assert!(
                one == bits(&found(&mesh, &options)),
                "{}: {request:?} differs on another run",
                shape.name()
            );
        }
    }
}

fn moved(soup: &PolygonSoup, f: impl Fn(DVec3) -> DVec3) -> SurfaceMesh {
    let mut soup = soup.clone();
    for p in &mut soup.positions {
        *p = f(*p);
    }
    mesh(&soup)
}

/// A power of two changes no digit of any number.
#[test]
fn another_unit_gives_the_same_points() {
    for shape in [Shape::Cup, Shape::Drink, Shape::Torus] {
        let soup = shape.generate_about(3_000);
        for unit in [2f64.powi(-20), 2f64.powi(30)] {
            let points = |mesh: &SurfaceMesh, request| {
                let samples = found(mesh, &Options { request, ..Options::default() }).samples;
                samples.into_iter().map(|s: Sample| (s.point, s.origin)).collect::<Vec<_>>()
            };
            let (here, there) = (mesh(&soup), moved(&soup, |p| p * unit));
            let requests = [
                (Request::Count(200), Request::Count(200)),
                (Request::Spacing(0.125), Request::Spacing(0.125 * unit)),
                (Request::Density(64.0), Request::Density(64.0 / (unit * unit))),
                (Request::Irregularity(2.0), Request::Irregularity(2.0)),
            ];
            for (a, b) in requests {
                assert!(points(&here, a) == points(&there, b), "{}: {a:?} times {unit}", shape.name());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Rigid motion and scale keep the strips, the irregularity and the number of points.
    #[test]
    fn motion_and_scale_keep_what_is_counted(
        seed in 0..1000u64,
        axis in [-1.0..1.0, -1.0..1.0, 0.1..1.0f64],
        angle in 0.0..6.0,
        at in [-50.0..50.0, -50.0..50.0, -50.0..50.0f64],
        scale in 0.01..100.0,
    ) {
        // Unstructured: no two edges are as long or as flat, so that rounding decides nothing.
        let soup = shapes::scan_like(seed, 500);
        let turn = DMat3::from_axis_angle(DVec3::from(axis).normalize(), angle);
        let here = mesh(&soup);
        let there = moved(&soup, |p| (turn * p + DVec3::from(at)) * scale);
        let density = 20.0;
        let options = |density| Options { request: Request::Density(density), ..Options::default() };
        let (a, b) = (found(&here, &options(density)), found(&there, &options(density / (scale * scale))));
        prop_assert_eq!(&a.segmentation, &b.segmentation);
        prop_assert_eq!(a.samples.len(), b.samples.len());
        prop_assert_eq!(a.correction, b.correction);
        prop_assert!((a.irregularity().bound / b.irregularity().bound - 1.0).abs() < 1e-6);
        for (p, q) in a.samples.iter().zip(&b.samples) {
            prop_assert_eq!((p.point.face, p.strip, p.origin), (q.point.face, q.strip, q.origin));
        }
    }

    /// Points out are those caught, less the copies that were removed, and those that were projected.
    #[test]
    fn points_in_are_points_out_and_reported(
        shape in prop::sample::select(Shape::ALL.to_vec()),
        faces in 4..800u32,
        count in 1..5_000u32,
        shift in [0.0..1.0, 0.0..1.0f64],
        tolerance in 0.0..1.0,
        degrees in 0.0..180.0f64,
    ) {
        let mesh = mesh(&shape.generate_about(faces));
        let options = SegmentOptions { flatness_angle: degrees.to_radians(), ..SegmentOptions::default() };
        let Unfolded { strips, domain, .. } = unfolded(&mesh, &options);
        let points = DomainPoints::scatter(&domain, &Sequence::R2, count, DVec2::from(shift));
        prop_assert_eq!(points.count(), u64::from(count));
        let wrapping = wrap(&strips, &domain, &points);
        let caught = wrapping.count();
        let mut of_strips: Vec<(StripId, u64)> = (0..strips.strips.len())
            .map(StripId::new)
            .flat_map(|s| wrapping.points_of(&strips, &domain, &points, s).map(move |w| (s, w.index)))
            .collect();
        of_strips.sort_unstable();
        let d_m = domain.side / f64::from(count).sqrt();
        let (corrected, correction) = correct(&mesh, &strips, &domain, &points, wrapping, tolerance * d_m);
        prop_assert_eq!(corrected.len() + correction.removed, caught + correction.projected);
        // Of a point that a strip caught at least one copy is left, and no point is both projected and caught.
        let mut left: Vec<_> = corrected.iter().map(|c| (c.sample.strip, c.index)).collect();
        left.sort_unstable();
        for caught in &of_strips {
            prop_assert!(left.binary_search(caught).is_ok());
        }
        let projected = corrected.iter().filter(|c| c.sample.origin == ldwrap::Origin::Projected);
        for c in projected {
            prop_assert!(of_strips.binary_search(&(c.sample.strip, c.index)).is_err());
        }
    }
}
