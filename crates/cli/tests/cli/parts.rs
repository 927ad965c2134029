//! Parts of a mesh: what lies in a box, and points for each connected component.

use crate::common::{Folder, OCTAHEDRON, rows, square};

/// Three octahedra, each a tenth as large as the one before, 10 apart along x.
fn octahedra() -> String {
    let mut obj = String::new();
    for (i, size) in [1.0, 0.1, 0.01].into_iter().enumerate() {
        for line in OCTAHEDRON.lines() {
            let numbers: Vec<f64> =
                line.split(' ').skip(1).map(|word| word.parse().expect("a number")).collect();
            let words: Vec<String> = match line.starts_with('v') {
                true => vec![
                    (numbers[0] * size + 10.0 * i as f64).to_string(),
                    (numbers[1] * size).to_string(),
                    (numbers[2] * size).to_string(),
                ],
                false => numbers.iter().map(|n| (n + 6.0 * i as f64).to_string()).collect(),
            };
            obj += &format!("{} {}\n", &line[..1], words.join(" "));
        }
    }
    obj
}

/// How many points each octahedron has.
fn on_each(folder: &Folder) -> [usize; 3] {
    let mut counts = [0; 3];
    for row in rows(&folder.text("p.xyz")) {
        counts[(row[0] / 10.0).round() as usize] += 1;
    }
    counts
}

#[test]
fn what_lies_in_a_box() {
    let folder = Folder::with_octahedron();
    folder.write("square.obj", square(3));
    let wrap = |rest: &str| folder.run(&format!("wrap square.obj -q -o p.xyz {rest}"));
    // The box is no multiple of the triangles: its rectangle of 1.1 x 0.35 is cut out exactly.
    wrap("-n 120 --box 0.4,0.9,-1,1.5,1.25,1 --report r.json").ok();
    let points = rows(&folder.text("p.xyz"));
    assert_eq!(points.len(), 120);
    assert!(
        points.iter().all(|p| (0.4..=1.5).contains(&p[0]) && (0.9..=1.25).contains(&p[1]) && p[2] == 0.0)
    );
    let area = folder.json("r.json")["mesh"]["area"].as_f64().expect("an area");
    assert!((area - 1.1 * 0.35).abs() < 1e-12, "{area}");
    let mean = points.iter().map(|p| p[0]).sum::<f64>() / 120.0;
    assert!((mean - 0.95).abs() < 0.005, "{mean}");

    // Its sides belong to it, and may be infinitely far.
    wrap("-n 30 --box -inf,-inf,0,inf,1,0").ok();
    assert!(rows(&folder.text("p.xyz")).iter().all(|p| p[1] <= 1.0));
    wrap("--box 0,0,1,2,2,2").failed(&[
        "square.obj",
        "no face lies in the box",
        "from [0, 0, 0] to [2, 2, 0]",
    ]);
    // It touches no more than an edge.
    wrap("--box 2,0,0,3,3,3").failed(&["square.obj"]);
    wrap("--box 0,0,0,1,1").refused(&["six numbers"]);
    wrap("--box 0,0,0,1,1,nan").refused(&["smallest coordinates come first"]);
    wrap("--box 1,0,0,0,1,1").refused(&["smallest coordinates come first"]);
    wrap("--box 0,0,0,1,1,1 --weights w.txt").refused(&["--weights"]);
    // With normals and the file's polygons, outside as before; the other faces are not there.
    folder
        .run("wrap octahedron.obj -q -n 60 -o p.csv --box 0,-9,-9,9,9,9 --attributes flat-normal,polygon")
        .ok();
    for line in folder.text("p.csv").lines().skip(1) {
        let numbers: Vec<f64> = line.split(',').map(|word| word.parse().expect("a number")).collect();
        assert!(numbers[0] >= 0.0 && numbers[3] > 0.57, "{line}");
        assert!([0.0, 3.0, 4.0, 7.0].contains(&numbers[6]), "{line}");
    }
}

#[test]
fn points_for_each_component() {
    let folder = Folder::new();
    folder.write("three.obj", octahedra());
    let wrap = |rest: &str| folder.run(&format!("wrap three.obj -q -o p.xyz {rest}"));
    wrap("-n 100").ok();
    assert_eq!(on_each(&folder), [99, 1, 0]);
    wrap("--per-component 25 --report r.json").ok();
    assert_eq!(on_each(&folder), [25, 25, 25]);
    assert_eq!(folder.json("r.json")["options"]["request"]["count"], 75);
    wrap("-n 100 --at-least 10").ok();
    assert_eq!(on_each(&folder), [80, 10, 10]);
    wrap("-n 3 --at-least 1").ok();
    assert_eq!(on_each(&folder), [1, 1, 1]);
    wrap("-n 20 --at-least 7").failed(&[
        "three.obj",
        "20 points are fewer than 7",
        "3 connected components: 21",
    ]);
    wrap("-n 10 --per-component 5").refused(&["cannot be used with"]);
    wrap("--density 5 --at-least 5").refused(&["cannot be used with"]);
    wrap("--per-component 5 --no-equalize").refused(&["cannot be used with"]);
    wrap("-n 9 --at-least 1 --no-equalize").refused(&["cannot be used with"]);
    wrap("-n 9 --at-least 1 --select extensible --sequence r2").refused(&["--at-least move points"]);
    wrap("--per-component 4000000000").failed(&["three.obj", "take a smaller number"]);
    // Where the box leaves two components, those count.
    wrap("--per-component 9 --box -5,-5,-5,15,5,5").ok();
    assert_eq!(on_each(&folder), [9, 9, 0]);
}
