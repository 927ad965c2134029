//! What checking repaired is told, on stderr and in the report.

use crate::common::{Folder, OCTAHEDRON, OCTAHEDRON_AREA};

#[test]
fn a_clean_mesh_has_no_notes() {
    let folder = Folder::with_octahedron();
    let ran = folder.run("wrap octahedron.obj -n 10").ok();
    assert!(!ran.stderr.contains("note:"), "{}", ran.stderr);
}

#[test]
fn each_repair_has_a_line() {
    let folder = Folder::new();
    // The octahedron with a vertex twice, a vertex that nothing uses, a face twice and a face without area.
    let broken = "OFF 8 10 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n1 0 0\n9 9 9\n\
        3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n3 2 6 5\n3 0 0 1\n";
    folder.write("broken.off", broken);
    let ran = folder.run("wrap broken.off -n 10 -o p.xyz --report r.json").ok();
    let notes: Vec<_> = ran.stderr.lines().filter(|line| line.starts_with("note: broken.off: ")).collect();
    assert!(notes.iter().any(|n| n.contains("1 vertex welded")), "{notes:?}");
    assert!(notes.iter().any(|n| n.contains("1 vertex left out")), "{notes:?}");
    assert!(notes.iter().any(|n| n.contains("another has the same corners")), "{notes:?}");
    let repaired = &folder.json("r.json")["mesh"]["repaired"];
    assert_eq!(repaired["welded_vertices"], 1);
    assert_eq!(repaired["isolated_vertices"], 1);
    assert_eq!(repaired["duplicate_faces"], 1);
    assert_eq!(repaired["non_manifold_edges"], 0);
    let reported = repaired.as_object().expect("an object").values().filter(|v| **v != 0).count();
    assert_eq!(notes.len(), reported, "one line for each count that is not zero: {notes:?}");
    assert!(!folder.run("wrap broken.off -n 10 --quiet").ok().stderr.contains("note"));
}

#[test]
fn inward_winding_is_turned_unless_it_is_to_be_kept() {
    let folder = Folder::new();
    let inward: String = OCTAHEDRON
        .lines()
        .map(|line| match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["f", a, b, c] => format!("f {a} {c} {b}\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    folder.write("inward.obj", inward);
    let turned = folder.run("info inward.obj --json").ok().json();
    assert_eq!(turned["repaired"]["turned_components"], 1);
    let kept = folder.run("info inward.obj --json --keep-winding").ok().json();
    assert_eq!(kept["repaired"]["turned_components"], 0);
    folder.run("wrap inward.obj -n 10").ok().says(&["note: inward.obj: 1 closed component was wound inward"]);
}

#[test]
fn info_counts() {
    let folder = Folder::with_octahedron();
    let info = folder.run("info octahedron.obj --json").ok().json();
    assert_eq!(info["vertices"], 6);
    assert_eq!(info["faces"], 8);
    assert_eq!(info["edges"], 12);
    assert_eq!(info["components"], 1);
    assert_eq!(info["border_edges"], 0);
    assert_eq!(info["euler_characteristic"], 2);
    assert_eq!(info["bounds"], serde_json::json!([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]));
    let area = info["area"].as_f64().expect("a number");
    assert!((area - OCTAHEDRON_AREA).abs() < 1e-12);
    let text = folder.run("info octahedron.obj").ok();
    for word in ["octahedron.obj", "vertices", "6", "closed"] {
        assert!(text.text().contains(word), "{word}: {}", text.text());
    }
}
