//! Faults that were found once, each with the input that showed it.

use ldwrap::equalize::EqualizeOptions;
use ldwrap::pipeline::{Options, Request, run};
use ldwrap::shapes::Shape;
use ldwrap::{PolygonSoup, Silent};
use ldwrap_tests::mesh;

/// One patch of the cup falls into three parts without a common border, whose areas are no whole numbers of cells. The
/// weights' equations then had no solution, and conjugate gradients ran away in all patches: the spread of the cells'
/// areas rose from 0.28 to 0.60.
#[test]
fn equalizing_holds_where_a_patch_falls_into_parts() {
    let cup = mesh(&Shape::Cup.generate());
    let options = Options {
        request: Request::Count(400),
        equalize: Some(EqualizeOptions::default()),
        ..Options::default()
    };
    let report =
        run(&cup, &options, &Silent).expect("the options can be met").equalize.expect("it was asked for");
    assert!(report.spread_after < 0.02, "{report:?}");
}

/// A thousand triangles that touch nowhere lie on top of each other in the plane: each point of the domain is caught by
/// many, so the number caught jumps by hundreds, and the surplus must be left out.
#[test]
fn exactly_n_where_the_number_caught_jumps() {
    let mut soup = PolygonSoup::default();
    for i in 0..1_000u32 {
        let x = f64::from(i) * 3.0;
        soup.positions.extend([[x, 0.0], [x + 1.0, 0.0], [x, 1.0]].map(|[x, y]| glam::dvec3(x, y, 0.0)));
        soup.push_polygon(&[3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let triangles = mesh(&soup);
    for n in [1, 7, 999, 1_001, 2_500] {
        let options = Options { request: Request::Count(n), ..Options::default() };
        assert_eq!(run(&triangles, &options, &Silent).expect("the options can be met").samples.len(), n);
    }
}
