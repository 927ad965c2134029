//! The least open border, on surfaces whose best unfolding is known and against the orders that are tried.

use super::*;
use crate::planted;
use crate::shapes::{self, Shape};
use crate::unfold::unfold;

fn open_length(mesh: &SurfaceMesh, order: GrowthOrder, tolerance: f64) -> f64 {
    let options = SegmentOptions { order, ..SegmentOptions::default() };
    unfold(mesh, &segment_for(mesh, &options, tolerance)).open_border_length(tolerance)
}

#[test]
fn least_open_is_never_worse_than_the_orders_it_tries() {
    for shape in [Shape::Sphere, Shape::Cup, Shape::Torus, Shape::Cube, Shape::Capsule, Shape::Tetrahedron] {
        let mesh = planted::mesh(&shape.generate());
        for n in [100.0, 1000.0, 10_000.0] {
            let tolerance = 0.1 * libm::sqrt(mesh.area() / n);
            let least = open_length(&mesh, GrowthOrder::LeastOpen, tolerance);
            for order in [GrowthOrder::BoundaryWalk, GrowthOrder::FlattestFirst] {
                let other = open_length(&mesh, order, tolerance);
                assert!(least <= other * (1.0 + 1e-9), "{shape:?} {n} {order:?}: {least} > {other}");
            }
        }
    }
}

#[test]
fn what_is_developable_is_cut_as_little_as_can_be() {
    // A plane not at all; an open tube once along its length, which lies twice in the border.
    let mesh = planted::mesh(&planted::moved(shapes::square(9), |p| planted::turn() * p));
    let strips = unfold(&mesh, &segment(&mesh, &SegmentOptions::default()));
    assert!(
        strips.strips.len() == 1
            && strips.strips[0].border.iter().all(|e| mesh.topology().twin(e.halfedge).is_none())
    );
    let (around, length) = (24u32, 10u32);
    let mut soup = crate::mesh::PolygonSoup::default();
    for j in 0..=length {
        for i in 0..around {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(around));
            soup.positions.push(glam::DVec3::new(cos, sin, f64::from(j)));
        }
    }
    for j in 0..length {
        for i in 0..around {
            let (a, b) = (j * around + i, j * around + (i + 1) % around);
            soup.push_polygon(&[a, b, b + around]);
            soup.push_polygon(&[a, b + around, a + around]);
        }
    }
    let tube = planted::mesh(&soup);
    let strips = unfold(&tube, &segment(&tube, &SegmentOptions::default()));
    let cut: f64 = strips
        .strips
        .iter()
        .flat_map(|s| s.border.iter().map(move |e| (s, e)))
        .filter(|(_, e)| tube.topology().twin(e.halfedge).is_some())
        .map(|(s, e)| s.border_length(e))
        .sum();
    // Along the length, perhaps across a few diagonals; half of the border is the other side.
    assert!((20.0 - 1e-9..=22.0).contains(&cut), "{cut}");
}

#[test]
fn each_component_takes_what_is_best_for_it() {
    let mut soup = Shape::Torus.generate();
    planted::join(&mut soup, &planted::moved(Shape::Cup.generate(), |p| p + glam::DVec3::splat(20.0)));
    let both = planted::mesh(&soup);
    let tolerance = 0.1 * libm::sqrt(both.area() / 700.0);
    let alone = [Shape::Torus, Shape::Cup]
        .map(|shape| open_length(&planted::mesh(&shape.generate()), GrowthOrder::LeastOpen, tolerance));
    let together = open_length(&both, GrowthOrder::LeastOpen, tolerance);
    // Another place rounds otherwise, which decides ties.
    assert!(together <= (alone[0] + alone[1]) * 1.01, "{together} of {alone:?}");
}

#[test]
fn fitting_reaches_all_of_a_component_and_knows_what_it_opens() {
    for shape in [Shape::Cube, Shape::Sphere, Shape::Cup, Shape::Torus] {
        let mesh = planted::mesh(&shape.generate());
        let (shapes, seeds) = (planar::Shapes::new(&mesh), seeds::component_seeds(&mesh));
        let tolerance = shapes.relative(0.1 * libm::sqrt(mesh.area() / 300.0));
        for tie in [fitting::Tie::Flattest, fitting::Tie::Nearest, fitting::Tie::Tightest] {
            let fitted = fitting::fit(&mesh, &shapes, &seeds, tolerance, tie);
            assert_eq!(fitted.len(), mesh.topology().components().count);
            let known: f64 = fitted.iter().map(|f| f.open).sum();
            let segmentation =
                Segmentation { segments: fitted.iter().map(fitting::Fitted::segment).collect() };
            let faces: usize = segmentation.segments.iter().map(|s| s.attachments.len()).sum();
            assert_eq!(faces, mesh.face_count());
            let laid = planar::Planar::of(&mesh, &shapes, &segmentation);
            let open = laid.open_lengths(&shapes, &segmentation, mesh.topology().components(), tolerance);
            assert!((known - open.iter().sum::<f64>()).abs() <= 1e-9, "{shape:?} {tie:?}");
        }
    }
}

#[test]
fn what_is_rehung_hangs_together_and_opens_less() {
    for (shape, most) in [
        (Shape::Torus, 0.75),
        (Shape::Cup, 0.9),
        (Shape::Sphere, 0.98),
        (Shape::Capsule, 1.0),
        (Shape::Cube, 1.0),
    ] {
        let mesh = planted::mesh(&shape.generate());
        for n in [335.0, 10_000.0] {
            let tolerance = 0.1 * libm::sqrt(mesh.area() / n);
            let options = SegmentOptions { order: GrowthOrder::Rehung, ..SegmentOptions::default() };
            let segmentation = segment_for(&mesh, &options, tolerance);
            let mut there = vec![false; mesh.face_count()];
            for attachment in segmentation.segments.iter().flat_map(|s| &s.attachments) {
                if let Some(across) = attachment.across {
                    let above = mesh.topology().twin(across).map(|twin| twin.face());
                    assert!(
                        across.face() == attachment.face && above.is_some_and(|face| there[face.index()])
                    );
                }
                assert!(!std::mem::replace(&mut there[attachment.face.index()], true));
            }
            assert!(there.iter().all(|there| *there));
            let open = unfold(&mesh, &segmentation).open_border_length(tolerance);
            let before = open_length(&mesh, GrowthOrder::LeastOpen, tolerance);
            assert!(open <= most * before * (1.0 + 1e-9), "{shape:?} {n}: {open} of {before}");
        }
    }
}

/// A cube cannot be opened along less than seven edges. Here its diagonals are open too.
#[test]
fn a_badly_cut_cube_is_rehung_as_it_can_be() {
    let mut soup = crate::mesh::PolygonSoup::default();
    soup.positions
        .extend((0..8).map(|i| glam::DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))));
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        soup.push_polygon(&[a, b, c]);
        soup.push_polygon(&[a, c, d]);
    }
    let cube = planted::mesh(&soup);
    let twin = |side: HalfedgeId| cube.topology().twin(side).expect("closed");
    let is_diagonal = |side: HalfedgeId| cube.fold_angle(side).expect("closed") < 0.1;
    // Across diagonals only where there is no other way.
    let mut attachments = vec![Attachment { face: FaceId::new(0), across: None }];
    let mut there = vec![false; cube.face_count()];
    there[0] = true;
    while attachments.len() < cube.face_count() {
        let sides = attachments.iter().flat_map(|a| (0..3).map(|c| HalfedgeId::of(a.face, c)));
        let ways = sides.map(twin).filter(|across| !there[across.face().index()]);
        let across = ways.min_by_key(|&across| is_diagonal(across)).expect("connected");
        there[across.face().index()] = true;
        attachments.push(Attachment { face: across.face(), across: Some(across) });
    }
    let tolerance = 0.01;
    let open = |segmentation: &Segmentation| unfold(&cube, segmentation).open_border_length(tolerance);
    let bad = Segmentation { segments: vec![Segment { attachments }] };
    assert!(open(&bad) > 16.0, "{}", open(&bad));
    let good = open(&rehang(&cube, bad, tolerance));
    assert!((good - 14.0).abs() < 1e-9, "{good}");
}

#[test]
fn what_is_rehung_does_not_hang_on_other_components() {
    // The first part takes all the work that it may.
    let crumpled = |p: glam::DVec3| {
        let hash = libm::sin(p.x * 91.7 + p.y * 37.3) * 1e4;
        p + glam::DVec3::Z * (hash - libm::floor(hash))
    };
    let mut soup = planted::moved(shapes::square(60), |p| crumpled(p * 60.0));
    planted::join(&mut soup, &planted::moved(Shape::Torus.generate(), |p| p + glam::DVec3::splat(200.0)));
    let both = planted::mesh(&soup);
    let torus = planted::mesh(&Shape::Torus.generate());
    let tolerance = 0.1 * libm::sqrt(torus.area() / 335.0);
    let open = |mesh: &SurfaceMesh, wanted: u32| {
        let options = SegmentOptions { order: GrowthOrder::Rehung, ..SegmentOptions::default() };
        let strips = unfold(mesh, &segment_for(mesh, &options, tolerance));
        let component = &mesh.topology().components().of_face;
        let own = strips.strips.iter().filter(|s| component[s.faces[0].index()] == wanted);
        own.flat_map(|s| {
            s.border.iter().filter(move |e| s.is_open(e, tolerance)).map(move |e| s.border_length(e))
        })
        .sum::<f64>()
    };
    let (beside, alone) = (open(&both, 1), open(&torus, 0));
    // Another place rounds otherwise, which decides ties.
    assert!(beside <= 1.15 * alone, "{beside} of {alone}");
}
