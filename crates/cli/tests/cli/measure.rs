//! Measuring anybody's points.

use serde_json::Value;

use crate::common::{Folder, square};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

/// A `side` x `side` lattice of points in the middles of its cells on the square, `z` above it, as XYZ.
fn lattice(side: usize, z: f64) -> String {
    let at = |i: usize| (i as f64 + 0.5) * 2.0 / side as f64;
    (0..side * side).map(|i| format!("{} {} {z}\n", at(i % side), at(i / side))).collect()
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("square.obj", square(4));
    folder
}

#[test]
fn the_json_has_its_keys() {
    let folder = Folder::with_octahedron();
    folder.run("wrap octahedron.obj -n 64 -q -o p.ply").ok();
    let report = folder.run("measure octahedron.obj p.ply --json -q").ok().json();
    for key in ["ball", "half_space", "patch", "view", "view_occluded"] {
        for norm in ["linf", "l1", "l2", "mc"] {
            assert!(report[key][norm].is_number(), "{key}.{norm}: {}", report[key]);
        }
    }
    for key in ["view", "view_occluded"] {
        let (error, l2) = (number(&report[key]["reference_error"]), number(&report[key]["l2"]));
        assert!((0.0..=0.1 * l2).contains(&error), "{key}: {error} of {l2}");
    }
    for (key, names) in [
        ("energy", &["eta", "mc", "relative_error", "mean_distance", "mean_distance_error"][..]),
        ("integration", &["rms", "mc"]),
        ("spacing", &["min", "mean", "cover"]),
        ("components", &["count", "worst"]),
    ] {
        for name in names {
            assert!(report[key][name].is_number(), "{key}.{name}: {}", report[key]);
        }
    }
    assert_eq!(report["component_shares"][0]["points"], 64);
    assert!((number(&report["component_shares"][0]["expected"]) - 64.0).abs() < 1e-9);
    assert_eq!(report["points"]["count"], 64);
    assert_eq!(report["points"]["off_surface"]["count"], 0);
    assert_eq!(report["mesh"]["faces"], 8);
    for stage in ["read", "check", "read points", "project", "energy"] {
        assert!(report["seconds"][stage].is_number(), "{stage}: {}", report["seconds"]);
    }
}

#[test]
fn a_lattice_is_better_than_points_in_a_heap() {
    let folder = folder();
    folder.write("even.xyz", lattice(10, 0.0));
    let heap: String = (0..100).map(|i| format!("0.1 {} 0\n", 0.001 * f64::from(i))).collect();
    folder.write("heap.xyz", heap);
    let measure = |name: &str| folder.run(&format!("measure square.obj {name} --json -q")).ok().json();
    let (even, heap) = (measure("even.xyz"), measure("heap.xyz"));
    for key in ["energy", "ball", "half_space", "patch", "integration"] {
        assert!(number(&even[key]["mc"]) < 0.7, "{key}: {}", even[key]);
        assert!(number(&heap[key]["mc"]) > 2.0, "{key}: {}", heap[key]);
    }
    assert!(number(&heap["energy"]["eta"]) < 0.01);
}

#[test]
fn every_point_format_is_read_back() {
    let folder = folder();
    folder.run("wrap square.obj -n 50 -q -o p.xyz").ok();
    let expected = folder.run("measure square.obj p.xyz --json -q").ok().json();
    for format in ["ply", "ply-ascii", "csv", "npy", "json", "obj"] {
        let extension = format.trim_end_matches("-ascii");
        folder.run(&format!("wrap square.obj -n 50 -q -o p.{extension} --format {format}")).ok();
        let report = folder.run(&format!("measure square.obj p.{extension} --json -q")).ok().json();
        assert_eq!(report["points"]["count"], 50, "{format}");
        assert_eq!(report["points"]["off_surface"]["count"], 0, "{format}");
        let (got, wanted) = (number(&report["energy"]["eta"]), number(&expected["energy"]["eta"]));
        assert!((got / wanted - 1.0).abs() < 1e-6, "{format}: {got} is not {wanted}");
    }
}

#[test]
fn points_off_the_surface_are_told() {
    let folder = folder();
    folder.write("above.xyz", lattice(4, 0.25) + "1 1 0\n");
    let ran = folder.run("measure square.obj above.xyz --json").ok();
    let off = &ran.json()["points"]["off_surface"];
    assert_eq!(off["count"], 16);
    assert!((number(&off["max"]) - 0.25).abs() < 1e-12);
    assert!((number(&off["mean"]) - 0.25 * 16.0 / 17.0).abs() < 1e-12);
    ran.says(&["note: above.xyz: 16 of 17 points lie off the surface"]);
    // The text says it too, whatever is hidden on stderr.
    let text = folder.run("measure square.obj above.xyz -q").ok();
    assert!(text.text().contains("off the surface           16 of 17; farthest 2.500e-1"), "{}", text.text());
    folder.write("on.xyz", lattice(4, 0.0));
    let text = folder.run("measure square.obj on.xyz -q").ok();
    assert!(text.text().contains("off the surface           none of 16"), "{}", text.text());
}

#[test]
fn twice_the_same_bits_with_any_number_of_threads() {
    let folder = folder();
    folder.write("p.xyz", lattice(7, 0.0));
    let measure = |threads: &str| {
        let mut report = folder.run(&format!("measure square.obj p.xyz --json -q {threads}")).ok().json();
        report["seconds"] = Value::Null;
        report
    };
    let first = measure("");
    assert_eq!(first, measure(""));
    assert_eq!(first, measure("--threads 1"));
    assert_eq!(first, measure("--threads 3"));
}

#[test]
fn a_summary_for_people() {
    let folder = folder();
    folder.write("p.xyz", lattice(5, 0.0));
    let ran = folder.run("measure square.obj p.xyz").ok();
    for word in
        ["p.xyz: 25 points on square.obj", "eta", "balls", "half-spaces", "patches", "views", "spacing"]
    {
        assert!(ran.text().contains(word), "{word}: {}", ran.text());
    }
    assert!(
        ran.text().contains("visible area known to") && ran.text().contains("1 ± 0.25"),
        "{}",
        ran.text()
    );
    let one = folder.run_with_input("measure square.obj - --points-format xyz", "1 1 0\n").ok();
    assert!(one.text().contains("1 point on") && !one.text().contains("NaN"), "{}", one.text());
}

#[test]
fn bad_points() {
    let folder = folder();
    folder.run("measure square.obj none.xyz").failed(&["none.xyz", "No such file"]);
    for (name, content) in [
        ("empty.xyz", ""),
        ("nan.xyz", "0 0 nan\n"),
        ("short.xyz", "0 0\n"),
        ("words.xyz", "one two three\n"),
        ("points.docx", "PK\x03\x04"),
        ("cut.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"),
        ("bad.npy", "\u{93}NUMPY"),
        ("bad.json", "[[1, 2"),
    ] {
        folder.write(name, content);
        folder.run(&format!("measure square.obj {name}")).failed(&[name]);
    }
    folder.run("measure - -").refused(&["stdin"]);
    folder.run("measure square.obj").refused(&["POINTS"]);
}

/// NumPy's format with these numbers, 3 a row.
fn npy(kind: &str, rows: usize, numbers: &[u8]) -> Vec<u8> {
    let head = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({rows}, 3), }}\n");
    let length = (head.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], head.as_bytes(), numbers].concat()
}

#[test]
fn npy_of_other_numbers_is_read_or_refused_in_words() {
    let folder = folder();
    let single: Vec<u8> = [1.0f32, 0.5, 0.0].iter().flat_map(|x| x.to_be_bytes()).collect();
    folder.write("single.npy", npy(">f4", 1, &single));
    assert_eq!(folder.run("measure square.obj single.npy --json -q").ok().json()["points"]["count"], 1);
    folder.write("words.npy", npy("<U4", 1, &[0; 48]));
    folder.run("measure square.obj words.npy").failed(&["words.npy", "npy", "numbers are"]);
}

#[test]
fn the_report_of_wrap_has_the_quality_on_request() {
    let folder = folder();
    let report = folder.run("wrap square.obj -n 64 --quality --report - -o p.xyz -q").ok().json();
    let measured = folder.run("measure square.obj p.xyz --json -q").ok().json();
    for key in ["energy", "ball", "half_space", "patch", "view", "view_occluded", "integration", "spacing"] {
        let quality = report["quality"][key].as_object().expect("an object");
        for (name, value) in quality {
            if let Some(value) = value.as_f64() {
                let again = number(&measured[key][name]);
                assert!(
                    (again - value).abs() <= 1e-9 * value.abs().max(1e-3),
                    "{key}.{name}: {value} is not {again}"
                );
            }
        }
    }
    folder.run("wrap square.obj --quality").refused(&["--report"]);
}
