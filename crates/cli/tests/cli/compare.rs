//! Methods by measures.

use crate::common::Folder;

#[test]
fn a_table_of_methods() {
    let folder = Folder::with_octahedron();
    let ran = folder.run("compare octahedron.obj -n 20,40 --methods wrap,random,hilbert,poisson -q").ok();
    let lines: Vec<&str> = ran.text().lines().collect();
    assert_eq!(lines.len(), 2 + 8, "{}", ran.text());
    for column in ["eta", "half space", "patch sup", "view occluded", "component", "seconds"] {
        assert!(lines[0].contains(column), "{column}: {}", lines[0]);
    }
    for (line, (count, method)) in lines[2..].iter().zip([
        ("20", "wrap"),
        ("20", "random"),
        ("20", "hilbert"),
        ("20", "poisson"),
        ("40", "wrap"),
        ("40", "random"),
        ("40", "hilbert"),
        ("40", "poisson"),
    ]) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        assert_eq!((cells[1], cells[2]), (count, method));
        assert!(cells[3].parse::<f64>().is_ok(), "{line}");
    }
}

#[test]
fn seeds_give_the_spread() {
    let folder = Folder::with_octahedron();
    let report =
        folder.run("compare octahedron.obj -n 30 --methods random,hilbert --seeds 3 --json -q").ok().json();
    let table = report["table"].as_array().expect("a list");
    assert_eq!(table.len(), 2);
    let sets = report["sets"].as_array().expect("a list");
    assert_eq!(sets.len(), 6);
    assert_eq!(sets.iter().filter(|set| set["seed"] == 2).count(), 2);
    for row in table {
        assert_eq!(row["sets"], 3);
        let method = &row["method"];
        let of_method: Vec<f64> = sets
            .iter()
            .filter(|set| set["method"] == *method)
            .map(|set| set["ball"]["mc"].as_f64().expect("a number"))
            .collect();
        let mean = of_method.iter().sum::<f64>() / 3.0;
        let summary = &row["measures"]["ball"];
        assert!((summary["mean"].as_f64().expect("a number") - mean).abs() < 1e-12);
        assert!(summary["spread"].as_f64().expect("a number") > 0.0);
    }
}

#[test]
fn every_method_on_a_sphere_and_only_those_that_suit_elsewhere() {
    let folder = Folder::with_octahedron();
    folder.run("shape sphere -o sphere.ply -q").ok();
    let methods = |mesh: &str| {
        let report = folder.run(&format!("compare {mesh} -n 25 --json -q")).ok().json();
        let rows = report["table"].as_array().expect("a list").clone();
        rows.iter().map(|row| row["method"].as_str().expect("a name").to_owned()).collect::<Vec<_>>()
    };
    let everywhere = ["wrap", "paper", "equalize", "random", "hilbert", "poisson"];
    folder.run("shape cube -o cube.ply -q").ok();
    assert_eq!(methods("cube.ply"), everywhere);
    assert_eq!(methods("sphere.ply"), [&everywhere[..], &["sphere-hammersley", "sphere-fibonacci"]].concat());
    folder.run("compare cube.ply -n 25 --methods sphere-fibonacci").refused(&["cube.ply", "not a sphere"]);
}

#[test]
fn points_of_other_tools_take_part() {
    let folder = Folder::with_octahedron();
    folder.run("wrap octahedron.obj -n 33 --no-equalize -q -o theirs.csv").ok();
    let ran =
        folder.run("compare octahedron.obj -n 33 --methods wrap --points theirs=theirs.csv --json -q").ok();
    let report = ran.json();
    let row = |name: &str| {
        let rows = report["table"].as_array().expect("a list");
        rows.iter().find(|row| row["method"] == name).expect("a row").clone()
    };
    let (ours, theirs) = (row("wrap"), row("theirs"));
    assert_eq!(theirs["count"], 33);
    assert!(theirs["seconds"].is_null() && ours["seconds"]["mean"].is_number());
    let eta = |row: &serde_json::Value| row["measures"]["eta"]["mean"].as_f64().expect("a number");
    assert!((eta(&ours) / eta(&theirs) - 1.0).abs() < 1e-6);
    for (name, known) in [("wrap", false), ("theirs", true)] {
        let sets = report["sets"].as_array().expect("a list");
        let off = &sets.iter().find(|set| set["method"] == name).expect("a set")["off_surface"];
        assert_eq!(off.is_object(), known, "{name}: {off}");
        assert!(!known || off["count"] == 0, "{off}");
    }
    folder.run("compare octahedron.obj --points theirs.csv").refused(&["NAME=FILE"]);
    folder.run("compare octahedron.obj -n 5 --points a=none.xyz").failed(&["none.xyz"]);
}

#[test]
fn the_plot_shows_methods_and_slopes() {
    let folder = Folder::with_octahedron();
    folder
        .run("compare octahedron.obj -n 20,80 --methods wrap,random --plot plot.svg")
        .ok()
        .says(&["wrote plot.svg"]);
    let svg = folder.text("plot.svg");
    for word in
        ["<svg", "n^-1/2", "n^-3/4", ">wrap<", ">random<", "half space", "view occluded", "octahedron.obj"]
    {
        assert!(svg.contains(word), "{word}");
    }
    assert!(!svg.contains("NaN"));
}

#[test]
fn columns_and_sets_are_the_same_numbers() {
    let folder = Folder::with_octahedron();
    let report = folder.run("compare octahedron.obj -n 50 --methods hilbert --json -q").ok().json();
    let (row, set) = (&report["table"][0]["measures"], &report["sets"][0]);
    assert_eq!(row["patch_sup"]["mean"], set["patch"]["linf"]);
    assert_eq!(row["component"]["mean"], set["components"]["worst"]);
    assert_eq!(row["view"]["mean"], set["view"]["mc"]);
    assert!(set["view"]["reference_error"].is_number());
}

#[test]
fn twice_the_same_bits_but_for_the_seconds() {
    let folder = Folder::with_octahedron();
    let compared = |threads: &str| {
        let command = "compare octahedron.obj -n 30,60 --methods equalize,random,poisson --seeds 2 --json -q";
        let mut report = folder.run(&format!("{command} {threads}")).ok().json();
        for list in ["table", "sets"] {
            for entry in report[list].as_array_mut().expect("a list") {
                entry["seconds"] = serde_json::Value::Null;
            }
        }
        report
    };
    let first = compared("");
    assert_eq!(first, compared(""));
    assert_eq!(first, compared("--threads 1"));
}

#[test]
fn nothing_is_named_twice() {
    let folder = Folder::with_octahedron();
    folder.write("p.xyz", "1 0 0\n");
    folder.run("compare octahedron.obj -n 5,9,5").refused(&["--count", "5 is given twice"]);
    folder.run("compare octahedron.obj -n 5 --methods wrap,random,wrap").refused(&["--methods", "wrap"]);
    folder
        .run("compare octahedron.obj -n 5 --points a=p.xyz --points a=p.xyz")
        .refused(&["--points", "the name a is given twice"]);
    folder
        .run("compare octahedron.obj -n 5 --methods wrap --points poisson=p.xyz")
        .refused(&["--points", "poisson is a method"]);
}

#[test]
fn wrong_use() {
    let folder = Folder::with_octahedron();
    folder.run("compare octahedron.obj -n 0").refused(&["--count"]);
    folder.run("compare octahedron.obj -n 4294967295").refused(&["--count"]);
    folder
        .run("compare octahedron.obj -n 5 --methods random --seed 18446744073709551615 --seeds 2")
        .refused(&["--seeds", "2 seeds from 18446744073709551615"]);
    folder.run("compare octahedron.obj -n 5 --methods random --seed 18446744073709551614 --seeds 2 -q").ok();
    folder.run("compare octahedron.obj -n 5, --methods nonsense").refused(&["error"]);
    folder.run("compare octahedron.obj --methods nonsense").refused(&["nonsense", "hilbert"]);
    folder.run("compare octahedron.obj --seeds 0").refused(&["--seeds"]);
    folder.run("compare octahedron.obj --plot -").refused(&["--plot"]);
    folder.run("compare octahedron.obj --plot missing/p.svg").failed(&["missing/p.svg"]);
}
