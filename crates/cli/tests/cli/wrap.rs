//! Points: how many, where, and the same bits every time.

use serde_json::{Value, json};

use crate::common::{Folder, OCTAHEDRON_AREA, rows, square};

/// How far a point is from the octahedron |x| + |y| + |z| = 1.
fn off_octahedron(row: &[f64]) -> f64 {
    ((row[..3].iter().map(|x| x.abs()).sum::<f64>() - 1.0) / 3f64.sqrt()).abs()
}

#[test]
fn exactly_n_points_on_the_surface() {
    let folder = Folder::with_octahedron();
    for n in [1, 2, 3, 57, 335, 1000] {
        for equalize in ["", "--no-equalize"] {
            let ran = folder.run(&format!("wrap octahedron.obj -n {n} {equalize} -o - --format xyz")).ok();
            let rows = rows(ran.text());
            assert_eq!(rows.len(), n, "{equalize}");
            for row in &rows {
                assert!(off_octahedron(row) < 1e-6, "{row:?}");
            }
        }
    }
}

#[test]
fn a_thousand_points_unless_told_otherwise() {
    let folder = Folder::with_octahedron();
    assert_eq!(rows(folder.run("wrap octahedron.obj -o - --format xyz").ok().text()).len(), 1000);
}

#[test]
fn density_and_spacing_give_the_number_of_points() {
    let folder = Folder::new();
    folder.write("square.obj", square(4));
    let count = |options: &str| {
        rows(folder.run(&format!("wrap square.obj {options} -o - --format xyz")).ok().text()).len() as f64
    };
    // The square has area 4.
    assert!((count("--density 100") - 400.0).abs() <= 40.0);
    assert!((count("--spacing 0.1") - 400.0).abs() <= 40.0);
    assert!(count("--density 1000") > count("--density 100"));
}

#[test]
fn irregularity_is_met() {
    let folder = Folder::with_octahedron();
    folder.run("wrap octahedron.obj --irregularity 0.3 --report r.json").ok();
    let report = folder.json("r.json");
    assert!(report["irregularity"]["bound"].as_f64().expect("a number") <= 0.3 + 1e-9);
}

#[test]
fn the_same_bits_on_every_run_and_any_number_of_threads() {
    let folder = Folder::with_octahedron();
    for options in ["", "--no-equalize", "--sequence halton --seed 7", "--sequence sobol --seed 3"] {
        let run = |threads: &str| {
            let ran = folder
                .run(&format!("wrap octahedron.obj -n 500 {options} {threads} -o - --format ply -q"))
                .ok();
            ran.stdout
        };
        let first = run("");
        assert_eq!(first, run(""), "{options}");
        assert_eq!(first, run("--threads 1"), "{options}");
        assert_eq!(first, run("--threads 2"), "{options}");
        assert_eq!(first, run("--threads 5"), "{options}");
    }
}

#[test]
fn options_change_the_points() {
    let folder = Folder::new();
    folder.write("square.obj", square(6));
    let run = |options: &str| {
        folder
            .run(&format!("wrap square.obj -n 200 --no-equalize {options} -o - --format xyz -q"))
            .ok()
            .stdout
    };
    let mut seen = vec![run("")];
    for options in [
        "--seed 1",
        "--seed 2",
        "--bases 3",
        "--sequence halton",
        "--sequence halton --bases 5,7",
        "--sequence sobol",
        "--sequence sobol --seed 1",
        "--sequence r2",
        "--sequence fibonacci",
    ] {
        let points = run(options);
        assert_eq!(rows(std::str::from_utf8(&points).expect("text")).len(), 200, "{options}");
        assert!(!seen.contains(&points), "{options} changes nothing");
        seen.push(points);
    }
    assert_eq!(run("--seed 0 --bases 2 --sequence hammersley"), seen[0], "these are the defaults");
}

#[test]
fn segmentation_options_reach_the_segmentation() {
    let folder = Folder::with_octahedron();
    let strips = |options: &str| {
        let report = folder.run(&format!("wrap octahedron.obj -n 50 {options} --report - -q")).ok().json();
        report["strips"].as_array().expect("a list").len()
    };
    // Neighbours of the octahedron meet at 70.5 degrees between their normals.
    assert_eq!(strips("--flatness-angle 80"), 1);
    assert!(strips("--growth flattest-first --flatness-angle 60 --smallest-share 0") > 1);
    for growth in ["least-open", "rehung", "boundary-walk", "flattest-first", "longest-first"] {
        assert_eq!(strips(&format!("--growth {growth} --flatness-angle 80")), 1);
    }
}

#[test]
fn every_format_holds_every_point() {
    let folder = Folder::with_octahedron();
    let run = |format: &str| folder.run(&format!("wrap octahedron.obj -n 40 -o - --format {format}")).ok();
    let xyz = rows(run("xyz").text());
    assert_eq!(run("csv").text().lines().count(), 41, "a header and the points");
    assert_eq!(run("obj").text().lines().filter(|line| line.starts_with("v ")).count(), 40);
    let ascii = run("ply-ascii");
    let (header, body) = ascii.text().split_once("end_header\n").expect("a header");
    assert!(header.contains("element vertex 40\n"));
    for (row, expected) in rows(body).iter().zip(&xyz) {
        for c in 0..3 {
            assert!((row[c] - expected[c]).abs() < 1e-6, "{row:?} is not {expected:?}");
        }
    }
    assert!(run("npy").stdout.starts_with(b"\x93NUMPY"));
    serde_json::from_slice::<Value>(&run("json").stdout).expect("JSON");
    assert!(run("ply").stdout.starts_with(b"ply\nformat binary_little_endian 1.0\n"));
}

#[test]
fn the_report_has_its_keys() {
    let folder = Folder::with_octahedron();
    folder
        .run("wrap octahedron.obj -n 335 --seed 5 --flatness-angle 25.5 --no-equalize --report r.json")
        .ok();
    let report = folder.json("r.json");
    let keys = |value: &Value| value.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
    assert_eq!(
        keys(&report),
        ["irregularity", "mesh", "open_border", "options", "points", "seconds", "strips", "version"]
    );
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(
        keys(&report["mesh"]),
        ["area", "border_edges", "components", "faces", "repaired", "vertices"]
    );
    assert_eq!(keys(&report["points"]), ["count", "d_m", "projected", "removed"]);
    assert_eq!(keys(&report["irregularity"]), ["bound", "exact", "refined", "undecided"]);
    assert_eq!(
        report["options"],
        json!({
            "request": {"count": 335},
            "sequence": {"hammersley": {"base": 2}},
            "seed": 5,
            "tolerance": 0.1,
            "flatness_angle": 25.5,
            "smallest_share": 0.002,
            "growth": "least-open",
            "selection": "regions",
            "equalize": null,
            "order": "sequence",
            "weighted": false,
        })
    );
    let number = |value: &Value| value.as_f64().expect("a number");
    let strips = report["strips"].as_array().expect("a list");
    assert!(strips.iter().all(|s| keys(s) == ["area", "border_length", "faces", "open_border_length"]));
    let sum = |key: &str| strips.iter().map(|s| number(&s[key])).sum::<f64>();
    assert_eq!(sum("faces"), 8.0);
    assert!((sum("area") - OCTAHEDRON_AREA).abs() < 1e-9);
    assert!((number(&report["mesh"]["area"]) - OCTAHEDRON_AREA).abs() < 1e-12);
    assert!(sum("open_border_length") <= sum("border_length"));
    let open = sum("open_border_length") / OCTAHEDRON_AREA.sqrt();
    assert!((number(&report["open_border"]) - open).abs() < 1e-9);
    assert!((number(&report["points"]["d_m"]) - (OCTAHEDRON_AREA / 335.0).sqrt()).abs() < 1e-12);
    assert!(number(&report["irregularity"]["exact"]) <= 1.0);
    let seconds = keys(&report["seconds"]);
    for stage in ["read", "check", "segment", "unfold", "wrap", "irregularity"] {
        assert!(seconds.contains(&stage.to_owned()), "{stage} in {seconds:?}");
        assert!(number(&report["seconds"][stage]) >= 0.0);
    }
}

#[test]
fn equalizing_is_on_and_reported() {
    let folder = Folder::with_octahedron();
    let report = folder.run("wrap octahedron.obj -n 100 --report - -q").ok().json();
    assert_eq!(report["options"]["equalize"]["rounds"], 4);
    let spread = |key: &str| report["equalize"][key].as_f64().expect("a number");
    assert!(spread("spread_after") < spread("spread_before"));
    assert!(spread("moved") > 0.0);
    assert!(report["seconds"]["equalize"].is_number());
}

#[test]
fn weights_move_points_to_where_they_are() {
    let folder = Folder::with_octahedron();
    // The face of the file's first line weighs as much as the seven others together.
    folder.write("faces.csv", "face,weight\n0,7\n1,1\n2,1\n3,1\n4,1\n5,1\n6,1\n7,1\n");
    let count = |options: &str| {
        let run = format!("wrap octahedron.obj -n 100 --no-equalize {options} -o - --format xyz");
        let ran = folder.run(&run).ok();
        let points = rows(ran.text());
        assert_eq!(points.len(), 100);
        points.iter().filter(|p| p[0] > 0.0 && p[1] > 0.0 && p[2] > 0.0).count()
    };
    assert!((49..=51).contains(&count("--weights faces.csv")));
    assert!((49..=51).contains(&count("--weights faces.csv --weights-of faces")));
    let ran = folder.run("wrap octahedron.obj -n 100 --weights faces.csv -o - --format xyz").ok();
    let equalized = rows(ran.text()).iter().filter(|p| p[0] > 0.0 && p[1] > 0.0 && p[2] > 0.0).count();
    assert!((48..=52).contains(&equalized), "{equalized}");
    // All weight at one vertex: its four faces get everything.
    folder.write("vertices.txt", "0\n0\n0\n0\n1\n0\n");
    let ran =
        folder.run("wrap octahedron.obj -n 50 --no-equalize --weights vertices.txt -o - --format xyz").ok();
    assert!(rows(ran.text()).iter().all(|p| p[2] >= 0.0));
    let report = folder.run("wrap octahedron.obj -n 9 --weights vertices.txt --report - -q").ok().json();
    assert_eq!(report["options"]["weighted"], true);
}

#[test]
fn weights_that_do_not_fit_are_refused() {
    let folder = Folder::with_octahedron();
    folder.write("seven.txt", "1\n".repeat(7));
    folder.run("wrap octahedron.obj --weights seven.txt").failed(&[
        "seven.txt",
        "7 weights",
        "6 vertices",
        "8 faces",
    ]);
    folder
        .run("wrap octahedron.obj --weights seven.txt --weights-of faces")
        .failed(&["7 weights for 8 polygons"]);
    folder.write("zero.txt", "0\n".repeat(8));
    folder.run("wrap octahedron.obj --weights zero.txt").failed(&["zero"]);
    folder.write("minus.txt", format!("{}-1\n", "1\n".repeat(7)));
    folder.run("wrap octahedron.obj --weights minus.txt").failed(&["-1", "7"]);
    folder.write("words.txt", "1\ntwo\n");
    folder.run("wrap octahedron.obj --weights words.txt").failed(&["line 2", "two"]);
    folder.run("wrap octahedron.obj --weights none.txt").failed(&["none.txt"]);
    folder.run("wrap octahedron.obj --weights-of faces").refused(&["--weights"]);
    // As many vertices as faces.
    folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    folder.write("four.txt", "1\n2\n3\n4\n");
    folder.run("wrap t.obj --weights four.txt").failed(&["--weights-of"]);
    folder.run("wrap t.obj -n 5 --weights four.txt --weights-of vertices -o p.xyz").ok();
}

#[test]
fn more_extensible_points_contain_fewer() {
    let folder = Folder::with_octahedron();
    for sequence in ["halton", "sobol", "r2"] {
        let run = |n: usize| {
            let options = format!("--select extensible --sequence {sequence} --seed 2");
            folder.run(&format!("wrap octahedron.obj -n {n} {options} -o - --format xyz")).ok()
        };
        let (few, many) = (run(20), run(90));
        assert_eq!(few.text().lines().count(), 20);
        assert!(many.text().starts_with(few.text()), "{sequence}");
    }
    folder.run("wrap octahedron.obj --select extensible").refused(&["Hammersley", "Halton"]);
    folder.run("wrap octahedron.obj --select extensible --sequence fibonacci").refused(&["Fibonacci"]);
    folder
        .run("wrap octahedron.obj --select extensible --sequence r2 --order progressive")
        .refused(&["extensible points cannot be put in another order"]);
}

#[test]
fn the_progressive_order_has_the_same_points() {
    let folder = Folder::with_octahedron();
    let lines = |order: &str| {
        let ran = folder.run(&format!("wrap octahedron.obj -n 64 --order {order} -o - --format xyz")).ok();
        ran.text().lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let (plain, ordered) = (lines("sequence"), lines("progressive"));
    assert_ne!(plain, ordered);
    let sorted = |mut lines: Vec<String>| {
        lines.sort();
        lines
    };
    // The first eight points lie on eight faces, or nearly.
    let octants: std::collections::BTreeSet<Vec<bool>> =
        rows(&ordered[..8].join("\n")).iter().map(|p| p.iter().map(|x| *x > 0.0).collect()).collect();
    assert!(octants.len() >= 6, "{octants:?}");
    assert_eq!(sorted(plain), sorted(ordered));
}

#[test]
fn the_horse() {
    let Ok(meshes) = std::env::var("LDWRAP_MESHES") else {
        eprintln!("skipped: LDWRAP_MESHES is not set");
        return;
    };
    let folder = Folder::new();
    let command = format!("wrap {meshes}/horse.ply -n 335 --no-equalize --report r.json -o - --format xyz");
    let ran = folder.run(&command).ok().says(&["wound inward"]);
    assert_eq!(rows(ran.text()).len(), 335);
    let report = folder.json("r.json");
    assert_eq!(report["mesh"]["faces"], 96_966);
    let strips = report["strips"].as_array().expect("a list");
    assert!(strips.len() <= 28, "{} strips", strips.len());
    let largest = strips.iter().map(|s| s["faces"].as_u64().expect("a count")).max();
    assert!(largest >= Some(93_754), "{largest:?}");
}

#[test]
fn points_for_views_are_made_and_reported() {
    let folder = Folder::with_octahedron();
    let run =
        |options: &str| folder.run(&format!("wrap octahedron.obj -n 40 --report - -q {options}")).ok().json();
    let everywhere = run("--for-views --views 64");
    assert_eq!(everywhere["options"]["equalize"]["for_views"]["cameras"], "around");
    let cone = run("--for-views --views 64 --view-from 0,-1,2 --view-angle 20 --view-distance 5");
    assert_eq!(cone["options"]["equalize"]["for_views"]["cameras"]["cone"]["distance"], 5.0);
    assert!(run("")["options"]["equalize"]["for_views"].is_null());
}

#[test]
fn what_makes_no_sense_for_views_is_refused() {
    let folder = Folder::with_octahedron();
    for options in [
        "--for-views --no-equalize",
        "--views 10",
        "--view-from 0,0,1",
        "--for-views --view-from 0,0",
        "--for-views --view-from 0,0,0",
        "--for-views --view-from 0,nan,1",
        "--for-views --view-from 0,0,1 --view-angle 181",
        "--for-views --view-from 0,0,1 --view-distance 0",
        "--for-views --views 0",
        "--for-views --select extensible --sequence halton",
    ] {
        let ran = folder.run(&format!("wrap octahedron.obj -n 10 {options}"));
        assert_eq!(ran.code, 2, "{options}: {}", ran.stderr);
    }
}
