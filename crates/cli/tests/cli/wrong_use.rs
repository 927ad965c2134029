//! What makes no sense is refused before any work: exit code 2 and a way out.

use crate::common::Folder;

#[test]
fn two_requests_exclude_each_other() {
    let folder = Folder::with_octahedron();
    for pair in
        ["-n 10 --density 2", "--spacing 1 --irregularity 0.5", "-n 5 --spacing 0.1", "-n 5 --irregularity 1"]
    {
        folder.run(&format!("wrap octahedron.obj {pair}")).refused(&["cannot be used with"]);
    }
}

#[test]
fn numbers_are_checked() {
    let folder = Folder::with_octahedron();
    for option in [
        "-n 0",
        "-n 4294967296",
        "-n -3",
        "-n ten",
        "-n 1.5",
        "-n 99999999999999999999999999",
        "--density 0",
        "--density nan",
        "--density inf",
        "--spacing=-1",
        "--spacing 0",
        "--irregularity 0",
        "--tolerance=-0.1",
        "--tolerance nan",
        "--flatness-angle 181",
        "--flatness-angle=-1",
        "--smallest-share 1.5",
        "--seed=-1",
        "--threads 0",
        "--threads 1000000",
        "--bases 1",
        "--sequence halton --bases 2",
        "--sequence halton --bases 2,4",
        "--sequence halton --bases 2,3,5",
        "--sequence hammersley --bases 2,3",
        "--sequence sobol --bases 2",
        "--sequence nonsense",
        "--select nonsense",
        "--order nonsense",
        "--sequence halton --bases 2,1025",
        "--growth nonsense",
        "--format nonsense -o x.ply",
    ] {
        let ran = folder.run(&format!("wrap octahedron.obj {option}"));
        assert_eq!(ran.code, 2, "{option}: {}", ran.stderr);
        ran.refused(&["error: "]);
    }
    assert_eq!(folder.names(), ["octahedron.obj"]);
}

#[test]
fn a_common_factor_of_the_bases_is_named() {
    let folder = Folder::with_octahedron();
    folder.run("wrap octahedron.obj --sequence halton --bases 6,9").refused(&["6", "9", "factor 3"]);
}

#[test]
fn unknown_point_formats_are_refused_with_the_known_ones() {
    let folder = Folder::with_octahedron();
    let known = [".ply", ".xyz", ".csv", ".npy", ".npz", ".json", ".obj", ".glb", "--format"];
    folder.run("wrap octahedron.obj -o points.docx").refused(&known).says(&["points.docx", ".docx"]);
    folder.run("wrap octahedron.obj -o points").refused(&known);
    folder.run("wrap octahedron.obj -o -").refused(&["stdout", "--format"]);
    folder.run("wrap octahedron.obj --format csv").refused(&["--output"]);
}

#[test]
fn two_outputs_cannot_share_a_place() {
    let folder = Folder::with_octahedron();
    std::fs::create_dir(folder.path("sub")).expect("a folder");
    for outputs in [
        "-o a.json --report a.json",
        "-o a.json --report ./a.json",
        "-o sub/../a.json --report a.json",
        "--strips a --preview a",
        "-o - --format xyz --report -",
    ] {
        folder.run(&format!("wrap octahedron.obj {outputs}")).refused(&["both go to"]);
    }
    assert_eq!(folder.names(), ["octahedron.obj", "sub"]);
}

#[test]
fn the_input_is_never_overwritten() {
    let folder = Folder::with_octahedron();
    let before = folder.read("octahedron.obj");
    folder.run("wrap octahedron.obj -o ./octahedron.obj").refused(&["overwrite", "octahedron.obj"]);
    folder.run("strips octahedron.obj -o octahedron.obj").refused(&["overwrite"]);
    assert_eq!(folder.read("octahedron.obj"), before);
}

#[test]
fn unknown_commands_and_options_are_refused() {
    let folder = Folder::with_octahedron();
    folder.run("wrapp octahedron.obj").refused(&["wrap"]);
    folder.run("wrap octahedron.obj --points 3").refused(&["--points"]);
    folder.run("wrap").refused(&["MESH"]);
    folder.run("strips octahedron.obj").refused(&["--output"]);
}

#[test]
fn help_and_version_go_to_stdout() {
    let folder = Folder::new();
    let version = folder.run("--version").ok();
    assert_eq!(version.text(), format!("ldwrap-cli {}\n", env!("CARGO_PKG_VERSION")));
    let help = folder.run("--help").ok();
    for command in ["wrap", "strips", "info", "shape", "Exit codes"] {
        assert!(help.text().contains(command), "{command}");
    }
    for option in ["--density", "--sequence", "--flatness-angle", "--report", "--threads"] {
        assert!(folder.run("wrap --help").ok().text().contains(option), "{option}");
    }
}

#[test]
fn completions_and_manual_pages_name_every_option() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = folder.run(&format!("completions {shell}")).ok();
        assert!(script.text().contains("irregularity") && script.text().contains("compare"), "{shell}");
    }
    let page = folder.run("man").ok();
    assert!(page.text().contains(".TH ldwrap-cli") && page.text().contains("measure"), "{}", page.text());
    let page = folder.run("man wrap").ok();
    for word in ["ldwrap-cli-wrap", "density", "flatness", "threads"] {
        assert!(page.text().contains(word), "{word}");
    }
    folder.run("man nonsense").refused(&["nonsense"]);
    folder.run("completions nonsense").refused(&["nonsense", "bash"]);
}
