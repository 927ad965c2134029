//! Discrepancy in the unit square, and the bounds that follow for the surface.

use serde_json::Value;

use crate::common::{Folder, square};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[test]
fn a_lattice_has_its_known_discrepancy() {
    // m x m points: 1 - (1 - 1/2m)^2.
    let folder = Folder::new();
    let report = folder.run("plane -n 256 --sequence lattice,hammersley,random --json").ok().json();
    let sets = report["sets"].as_array().expect("a list");
    assert_eq!(sets.len(), 3);
    let star = |k: usize| number(&sets[k]["star"]["upper"]);
    let last = 1.0 - 1.0 / 32.0;
    assert!((star(0) - (1.0 - last * last)).abs() < 1e-14, "{}", sets[0]);
    assert!(star(1) < 0.5 * star(0) && star(1) < 0.5 * star(2));
    assert_eq!(sets[0]["star"]["lower"], sets[0]["star"]["upper"]);
    assert!(number(&sets[1]["l2"]["star"]) < number(&sets[1]["l2"]["random"]));
    // One point at the origin: everything but an empty box is missed.
    let one = folder.run("plane -n 1 --sequence hammersley --json").ok().json();
    assert_eq!(number(&one["sets"][0]["star"]["upper"]), 1.0);
}

#[test]
fn the_table_of_the_plane() {
    let folder = Folder::new();
    let ran = folder.run("plane -n 16,20").ok();
    let rows: Vec<Vec<&str>> =
        ran.text().lines().skip(2).map(|line| line.split('|').map(str::trim).collect()).collect();
    // 20 is not a square number: no lattice.
    assert_eq!(rows.iter().filter(|row| row[1] == "16").count(), 7);
    assert_eq!(rows.iter().filter(|row| row[1] == "20").count(), 6);
    assert!(rows.iter().all(|row| row[3].parse::<f64>().is_ok()), "{}", ran.text());
    let spread = folder.run("plane -n 64 --sequence hammersley,sobol --seeds 4").ok();
    assert_eq!(spread.text().matches('±').count(), 10, "{}", spread.text());
    let many = folder.run("plane -n 20001 --sequence r2").ok();
    assert!(many.text().contains("at most 0.00"), "{}", many.text());
    let bases = folder.run("plane -n 81 --sequence hammersley --bases 3").ok();
    assert_ne!(bases.text(), folder.run("plane -n 81 --sequence hammersley").ok().text());
}

#[test]
fn wrong_use_of_plane() {
    let folder = Folder::new();
    folder.run("plane -n 20 --sequence lattice").refused(&["20 is not a square number", "16 or 25"]);
    folder.run("plane -n 0").refused(&["--count"]);
    folder.run("plane -n 16,9,16").refused(&["--count", "16 is given twice"]);
    folder.run("plane -n 16 --seed 18446744073709551615 --seeds 2").refused(&["--seeds", "2 seeds from"]);
    folder.run("plane --sequence r2,r2").refused(&["--sequence", "r2 is given twice"]);
    folder.run("plane --bases 3").refused(&["--sequence"]);
    folder.run("plane --sequence r2 --bases 3").refused(&["--bases"]);
    folder.run("plane --sequence random --bases 3").refused(&["--bases"]);
    folder.run("plane --sequence halton --bases 2,4").refused(&["--bases", "factor"]);
}

#[test]
fn a_flat_square_does_not_fall_apart_and_eq_6_is_what_is_measured() {
    let folder = Folder::new();
    folder.write("square.obj", square(6));
    let report = folder.run("bound square.obj -n 40,90 --json -q").ok().json();
    let bounds = report["bounds"].as_array().expect("a list");
    assert_eq!(bounds.len(), 2);
    for (bound, count) in bounds.iter().zip([40, 90]) {
        assert_eq!(bound["count"], count);
        assert_eq!(bound["decomposition"]["degree"], 1);
        // The square fills its domain: the points are those of the sequence.
        assert_eq!(bound["domain_points"], count);
        let measured = number(&bound["figure"]["linf"]);
        assert!((number(&bound["bound"]["linf"]) - measured).abs() < 1e-12, "{bound}");
        assert!((number(&bound["eq7"]) - 4.0 * number(&bound["star"]["upper"])).abs() < 1e-12);
    }
}

#[test]
fn the_bounds_hold_on_a_sphere() {
    let folder = Folder::new();
    folder.run("shape sphere -o sphere.obj -q").ok();
    let report = folder.run("bound sphere.obj -n 192 --growth boundary-walk --json -q").ok().json();
    let bound = &report["bounds"][0];
    assert!(number(&bound["decomposition"]["degree"]) > 5.0, "{bound}");
    for norm in ["linf", "l1", "l2"] {
        assert!(number(&bound["figure"][norm]) <= number(&bound["bound"][norm]), "{norm}: {bound}");
    }
    assert!(number(&bound["figure"]["linf"]) < number(&bound["eq7"]));
    // The figures are those of `measure`.
    folder.run("wrap sphere.obj -n 192 --growth boundary-walk --no-equalize -o p.ply -q").ok();
    let measured = folder.run("measure sphere.obj p.ply --json -q").ok().json();
    let (a, b) = (number(&measured["patch"]["linf"]), number(&bound["figure"]["linf"]));
    assert!((a - b).abs() < 1e-9, "{a} {b}");
    let text = folder.run("bound sphere.obj -n 192 -q").ok();
    for column in ["f_d", "eq. 6", "eq. 7", "measured sup"] {
        assert!(text.text().contains(column), "{}", text.text());
    }
    // A single point: nothing is left undefined.
    folder.run("shape cube -o cube.obj -q").ok();
    let few = folder.run("bound cube.obj -n 1 -q").ok();
    assert!(!few.text().contains("NaN") && !few.text().contains("inf"), "{}", few.text());
    folder.run("bound sphere.obj -n 9,9").refused(&["--count", "9 is given twice"]);
    folder.run("bound none.obj -n 9").failed(&["none.obj"]);
}
