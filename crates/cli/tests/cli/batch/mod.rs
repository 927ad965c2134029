//! `batch`: many meshes at once. What a run does that is killed, in `resume`; parts of a list, in `shards`; which meshes are
//! taken and what their outputs are called, in `names`.

mod names;
mod resume;
mod shards;

use std::collections::BTreeMap;
use std::path::Path;

use ldwrap::io::mesh_out::write_mesh;
use ldwrap::shapes::Shape;

use crate::common::{Folder, OCTAHEDRON, square};

/// The kinds of meshes that cannot be used, as the summary calls them, in the order in which `planted` takes them.
const BAD: [&str; 7] = ["format", "format", "surface", "format", "read", "surface", "surface"];

/// Writes `count` small meshes of many shapes in four formats into seven folders below `meshes`; every `bad`-th cannot be
/// used, for all reasons by turns. Returns the paths below `meshes` of those.
fn planted(folder: &Folder, count: usize, bad: usize) -> Vec<(String, &'static str)> {
    const SHAPES: [(Shape, u32); 6] = [
        (Shape::Tetrahedron, 4),
        (Shape::Cube, 12),
        (Shape::Sphere, 40),
        (Shape::Torus, 50),
        (Shape::Square, 8),
        (Shape::Capsule, 60),
    ];
    let mut planted = Vec::new();
    for i in 0..count {
        let (shape, faces) = SHAPES[i % SHAPES.len()];
        let mut soup = shape.generate_about(faces);
        for position in &mut soup.positions {
            *position *= 1.0 + i as f64 / count as f64;
        }
        let mut name = format!("part-{}/{i:04}.{}", i % 7, ["ply", "obj", "stl", "off"][i % 4]);
        let mut bytes = write_mesh(&soup, &name).expect("a mesh is written");
        if i % bad == bad - 1 {
            let kind = planted.len() % BAD.len();
            match kind {
                0 => bytes.truncate(bytes.len() / 3),
                1 => bytes.clear(),
                2 => bytes = OCTAHEDRON.replace("v 0 0 1", "v 0 nan 1").into_bytes(),
                3 => bytes = b"Dear reader, this is a letter.".to_vec(),
                4 => bytes.clear(),
                5 => bytes = b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_vec(),
                _ => bytes = b"v 0 0 0\nv 1 0 0\nv 2 0 0\n".to_vec(),
            }
            // A file that is cut off must be in a format that tells, and a letter would be an OBJ file without faces.
            if kind == 0 {
                name = Path::new(&name).with_extension("stl").to_string_lossy().into_owned();
                bytes = write_mesh(&soup, &name).expect("a mesh is written");
                bytes.truncate(bytes.len() * 2 / 3);
            } else {
                let extension = if kind == 3 { "ply" } else { "obj" };
                name = Path::new(&name).with_extension(extension).to_string_lossy().into_owned();
            }
            planted.push((name.clone(), BAD[kind]));
            if kind == 4 {
                std::fs::create_dir_all(folder.path("meshes").join(&name).parent().expect("a folder"))
                    .expect("it");
                missing(&folder.path("meshes").join(&name));
                continue;
            }
        }
        folder.put(&format!("meshes/{name}"), bytes);
    }
    planted
}

/// A file that is listed but cannot be read, even by root.
#[cfg(unix)]
fn missing(path: &Path) {
    std::os::unix::fs::symlink("nowhere", path).expect("a link");
}

#[cfg(not(unix))]
fn missing(_: &Path) {}

impl Folder {
    /// Writes a file and the folders that it lies in.
    fn put(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::create_dir_all(self.path(name).parent().expect("a folder")).expect("a folder is made");
        self.write(name, content);
    }

    /// All files below a folder with their bytes, by path, but for journals, summaries and what is hidden.
    fn outputs(&self, below: &str) -> BTreeMap<String, Vec<u8>> {
        let mut files = BTreeMap::new();
        let mut folders = vec![self.path(below)];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).expect("the folder can be listed") {
                let path = entry.expect("an entry").path();
                let name = path.strip_prefix(self.path(below)).expect("below").to_string_lossy().into_owned();
                if path.is_dir() && name != ".ldwrap-batch" {
                    folders.push(path);
                } else if path.is_file() && !name.starts_with("journal.") && !name.starts_with("summary.") {
                    files.insert(name, std::fs::read(&path).expect("a file"));
                }
            }
        }
        files
    }

    /// The rows of a summary by column.
    fn summary(&self, name: &str) -> Vec<BTreeMap<String, String>> {
        let text = self.text(name);
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        reader.deserialize().map(|row| row.expect("a row")).collect()
    }

    /// A summary without the times.
    fn summary_without_times(&self, name: &str) -> Vec<BTreeMap<String, String>> {
        let mut rows = self.summary(name);
        for row in &mut rows {
            row.remove("seconds").expect("a time");
        }
        rows
    }

    /// The records of a journal.
    fn journal(&self, name: &str) -> Vec<serde_json::Value> {
        self.text(name).lines().map(|line| serde_json::from_str(line).expect("a record")).collect()
    }
}

/// The values of a column.
fn column(rows: &[BTreeMap<String, String>], name: &str) -> Vec<String> {
    rows.iter().map(|row| row[name].clone()).collect()
}

#[test]
fn outputs_are_those_of_wrap() {
    let folder = Folder::new();
    folder.put("in/octahedron.obj", OCTAHEDRON);
    folder.put("in/deep/square.obj", square(4));
    let options = "-n 40 --sequence halton --seed 3 --order progressive --attributes smooth-normal,cell-area --format csv";
    folder.run(&format!("batch in -o out {options}")).ok().says(&["2 meshes: 2 done"]);
    for name in ["octahedron", "deep/square"] {
        folder.run(&format!("wrap in/{name}.obj -o one.csv {options}")).ok();
        assert_eq!(folder.text(&format!("out/{name}.csv")), folder.text("one.csv"));
    }
    folder
        .run("wrap in/octahedron.obj -n 40 --sequence halton --seed 3 --order progressive --report one.json")
        .ok();
    let (report, rows) = (folder.json("one.json"), folder.summary("out/summary.csv"));
    assert_eq!(column(&rows, "input"), ["in/deep/square.obj", "in/octahedron.obj"]);
    for (name, key) in [
        ("vertices", "/mesh/vertices"),
        ("triangles", "/mesh/faces"),
        ("components", "/mesh/components"),
        ("area", "/mesh/area"),
        ("points", "/points/count"),
        ("d_m", "/points/d_m"),
        ("irregularity_bound", "/irregularity/bound"),
        ("irregularity_refined", "/irregularity/refined"),
        ("irregularity_exact", "/irregularity/exact"),
    ] {
        let told: f64 = rows[1][name].parse().unwrap_or_else(|_| panic!("{name}: {}", rows[1][name]));
        assert_eq!(Some(told), report.pointer(key).and_then(serde_json::Value::as_f64), "{name}");
    }
    assert_eq!(rows[1]["strips"], report["strips"].as_array().expect("strips").len().to_string());
}

#[test]
fn results_do_not_depend_on_jobs_and_threads() {
    let folder = Folder::new();
    planted(&folder, 40, 13);
    folder.run("batch meshes -o one -n 15 --jobs 1 --threads 1").says(&["3 of 40 meshes failed"]);
    let runs =
        [("many", "--jobs 7"), ("wide", "--jobs 2 --threads 6"), ("quiet", "--jobs 3 --threads 1 --quiet")];
    for (out, how) in runs {
        folder.run(&format!("batch meshes -o {out} -n 15 {how}"));
        assert_eq!(folder.outputs(out), folder.outputs("one"), "{how}");
        let (these, those) = ("summary.csv", "one/summary.csv");
        assert_eq!(
            folder.summary_without_times(&format!("{out}/{these}")),
            folder.summary_without_times(those)
        );
    }
}

#[test]
fn a_bad_mesh_is_told_and_stops_no_other() {
    let folder = Folder::new();
    let planted = planted(&folder, 21, 3);
    assert_eq!(planted.len(), BAD.len());
    let ran = folder.run("batch meshes -o out -n 10");
    assert_eq!((ran.code, ran.stdout.len()), (1, 0));
    let rows = folder.summary("out/summary.csv");
    let mut failed = 0;
    for row in &rows {
        let bad = planted.iter().find(|(name, _)| row["input"] == format!("meshes/{name}"));
        assert_eq!(row["error_kind"], bad.map_or("", |(_, kind)| kind), "{row:?}");
        assert_eq!(row["error"].is_empty(), bad.is_none(), "{row:?}");
        assert_eq!(row["status"], if bad.is_none() { "done" } else { "failed" });
        assert_eq!(row["points"], if bad.is_none() { "10" } else { "" });
        assert_eq!(folder.path("out").join(&row["output"]).exists(), bad.is_none(), "{row:?}");
        if bad.is_some() {
            failed += 1;
            let line = format!("failed: {}: {}", row["input"], row["error"]);
            assert!(ran.stderr.lines().any(|said| said == line), "{line}\n{}", ran.stderr);
        }
    }
    assert_eq!((rows.len(), failed), (21, 7));
    let last = ran.stderr.lines().last().expect("a line");
    assert!(last.starts_with("error: 7 of 21 meshes failed") && last.contains("summary.csv"), "{last}");
    assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
    // Nothing but errors when it is to be quiet; what failed is tried again.
    let again = folder.run("batch meshes -o out -n 10 --quiet").failed(&["7 of 21 meshes failed"]);
    assert_eq!(again.stderr.lines().count(), 1);
    // Once mended, it is done, and nothing else.
    for (name, _) in &planted {
        let _ = std::fs::remove_file(folder.path("meshes").join(name));
        folder.put(&format!("meshes/{name}"), OCTAHEDRON);
    }
    folder.run("batch meshes -o out -n 10").ok().says(&["21 done, 14 of them before; 0 failed"]);
}

#[test]
fn eta_and_repairs_are_told_on_request() {
    let folder = Folder::new();
    folder.put("in/a.obj", OCTAHEDRON);
    folder.put("in/b.obj", format!("{OCTAHEDRON}v 9 9 9\nf 1 3 5\nf 1 1 2\n"));
    folder.run("batch in -o out -n 20 --eta --format csv").ok();
    let rows = folder.summary("out/summary.csv");
    let measured = folder.run("measure in/a.obj out/a.csv --json").ok().json();
    let eta = measured.pointer("/energy/eta").and_then(serde_json::Value::as_f64).expect("eta");
    let told: f64 = rows[0]["eta"].parse().expect("a number");
    assert!((told - eta).abs() <= 1e-9 * eta, "{told} {eta}");
    assert_eq!(rows[0]["repairs"], "");
    assert_eq!(rows[1]["repairs"], "degenerate_polygons=1 duplicate_faces=1 isolated_vertices=1");
}

#[test]
fn options_that_a_mesh_cannot_meet_are_its_own_failure() {
    let folder = Folder::new();
    folder.put("in/a.obj", OCTAHEDRON);
    folder.put("in/b.obj", square(4));
    folder.write("weights.txt", "1\n2\n3\n4\n5\n6\n");
    folder
        .run("batch in -o out -n 20 --weights weights.txt")
        .says(&["failed: in/b.obj", "1 of 2 meshes failed"]);
    let rows = folder.summary("out/summary.csv");
    assert_eq!(column(&rows, "status"), ["done", "failed"]);
    assert_eq!(rows[1]["error_kind"], "options");
    folder.run("batch in -o colours -n 20 --attributes color").says(&["2 of 2 meshes failed"]);
    assert_eq!(column(&folder.summary("colours/summary.csv"), "error_kind"), ["options"; 2]);
}

#[test]
fn wrong_use_is_refused_before_anything_is_made() {
    let folder = Folder::new();
    folder.put("in/a.obj", OCTAHEDRON);
    for (arguments, words) in [
        ("batch -o out", "IN"),
        ("batch in", "--output"),
        ("batch in -o out --jobs 0", "--jobs"),
        ("batch in -o out --shard 0/3", "1/K to K/K"),
        ("batch in -o out --shard 4/3", "1/K to K/K"),
        ("batch in -o out --shard x", "such as 3/8"),
        ("batch in -o out --format docx", "--format"),
        ("batch in -o out --summary-only --redo", "--redo"),
        ("batch in -o out -n 0", "--count"),
        ("batch in -o out --sequence r2 --bases 2,3", "--bases"),
        ("batch in -o out --format npy --attributes uv", "cannot hold"),
        ("batch - -o out", "--list -"),
        ("batch in/*.ply -o out", "no file matches"),
        ("batch in/[ -o out", "in/["),
        ("batch in -o in", "choose another"),
        ("batch in/a.obj -o in --format obj", "overwrite the mesh"),
        ("batch in -o out --base elsewhere", "--base"),
    ] {
        folder.run(arguments).refused(&[words]);
        assert_eq!(folder.names(), ["in"], "{arguments}");
    }
    std::fs::create_dir(folder.path("empty")).expect("a folder");
    folder.run("batch empty -o out").failed(&["no mesh was found"]);
    folder.run("batch in -o out --weights none.txt").failed(&["none.txt"]);
    folder.run("batch --list none.txt -o out").failed(&["none.txt"]);
    assert_eq!(folder.names(), ["empty", "in"]);
    folder.write("file", "");
    folder.run("batch in -o file").failed(&["file", "cannot be made"]);
}

#[test]
fn help_completions_and_manual_page_have_it() {
    let folder = Folder::new();
    assert!(folder.run("--help").ok().text().contains("  batch "));
    let options =
        ["--shard", "--full-names", "--summary-only", "--redo", "--jobs", "--attributes", "--flatness-angle"];
    let help = folder.run("batch --help").ok();
    for option in options {
        assert!(help.text().contains(option), "{option}");
    }
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = folder.run(&format!("completions {shell}")).ok();
        assert!(script.text().contains("full-names") && script.text().contains("summary-only"), "{shell}");
    }
    let page = folder.run("man batch").ok();
    for word in ["ldwrap-cli-batch", "shard", "full\\-names", "summary\\-only", "OUT_DIR"] {
        assert!(page.text().contains(word), "{word}");
    }
}
