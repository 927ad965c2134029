//! The page in a real browser. `cargo xtask test` builds the page and says where it is; without a browser or a wasm
//! compiler these tests skip loudly, and fail in continuous integration.

mod chrome;
mod gestures;
mod trouble;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use chrome::{Chrome, DESKTOP, Screen};
use ldwrap::equalize::EqualizeOptions;
use ldwrap::io::points::{PointFormat, PointRow, write_points};
use ldwrap::pipeline::{self, Options, Request};
use ldwrap::shapes::Shape;
use ldwrap::{CheckOptions, Silent, SurfaceMesh};
use serde_json::{Value, json};
use xtask::serve::Server;

/// One browser at a time: two share the processor and are slower together.
static ONE: Mutex<()> = Mutex::new(());

struct Built {
    page: PathBuf,
    package: PathBuf,
    browser: PathBuf,
}

/// The built page and the browser; `None`, said loudly, where they are missing.
fn built() -> Option<Built> {
    let folder = |name| std::env::var_os(name).map(PathBuf::from);
    match (folder("LDWRAP_PAGE"), folder("LDWRAP_PACKAGE"), folder("LDWRAP_BROWSER")) {
        (Some(page), Some(package), Some(browser)) => Some(Built { page, package, browser }),
        _ => {
            assert!(!xtask::in_ci(), "the page must be tested: run `cargo xtask test`");
            eprintln!(
                "SKIPPED: the page is not tested without a browser and a wasm compiler: see `cargo xtask test`"
            );
            None
        }
    }
}

/// Runs a test on the opened page.
fn on_page(screen: Screen, fragment: &str, test: impl FnOnce(&mut Chrome)) {
    let Some(Built { page, browser, .. }) = built() else { return };
    let _one = ONE.lock().unwrap_or_else(|broken| broken.into_inner());
    let server = Server::start(&page, 0).expect("a server");
    let mut chrome = Chrome::start(&browser, screen);
    chrome.open(&format!("{}{fragment}", server.address()));
    chrome.wait_for("window.ldwrap");
    test(&mut chrome);
    let problems = chrome.problems();
    assert!(problems.is_empty(), "the page reported errors: {problems:#?}");
}

/// Waits until the shown mesh is wrapped.
fn wait_for_points(chrome: &mut Chrome, count: usize) -> Value {
    chrome.wait_for_state(&format!("!s.busy && s.points === {count}"))
}

/// Keeps a picture of the page for people to look at.
fn keep_picture(chrome: &mut Chrome, name: &str) {
    let bytes = chrome.screenshot();
    assert!(bytes.starts_with(b"\x89PNG") && bytes.len() > 20_000, "a picture of nothing");
    let folder = xtask::target().join("screenshots");
    fs::create_dir_all(&folder).expect("a folder for pictures");
    fs::write(folder.join(name), bytes).expect("a picture");
}

/// What the page and the command line program do unless told otherwise.
fn options(count: usize) -> Options {
    Options {
        request: Request::Count(count),
        equalize: Some(EqualizeOptions::default()),
        ..Options::default()
    }
}

/// Native points: the face and the exact weights, in order.
fn native(mesh: &SurfaceMesh, count: usize) -> (Vec<u32>, Vec<u64>, Vec<u32>) {
    let options = options(count);
    let run = pipeline::run(mesh, &options, &Silent).expect("a run");
    let faces = run.samples.iter().map(|s| s.point.face.0).collect();
    let weights = run.samples.iter().flat_map(|s| s.point.barycentric).map(f64::to_bits).collect();
    let positions = run
        .samples
        .iter()
        .flat_map(|s| mesh.locate(&s.point).as_vec3().to_array())
        .map(f32::to_bits)
        .collect();
    (faces, weights, positions)
}

/// The points as the native program writes them.
fn native_csv(mesh: &SurfaceMesh, options: &Options) -> Vec<u8> {
    let run = pipeline::run(mesh, options, &Silent).expect("a run");
    let rows: Vec<_> = run.samples.iter().map(|s| PointRow::new(mesh, s)).collect();
    let mut bytes = Vec::new();
    write_points(PointFormat::Csv, &rows, &mut bytes).expect("written");
    bytes
}

fn checked(soup: &ldwrap::PolygonSoup) -> SurfaceMesh {
    SurfaceMesh::from_soup(soup, &CheckOptions::default()).expect("a mesh").0
}

/// The words of a JavaScript array of typed arrays, as whole numbers.
fn bits<T: TryFrom<u64>>(value: &Value) -> Vec<T> {
    let numbers = value.as_array().expect("an array");
    numbers
        .iter()
        .map(|n| T::try_from(n.as_str().expect("text").parse().expect("a number")).ok().expect("in range"))
        .collect()
}

#[test]
fn it_opens_wrapped_and_shows_itself_in_light_dark_and_on_a_phone() {
    let screens = [
        ("page-light.png", DESKTOP),
        ("page-dark.png", Screen { dark: true, ..DESKTOP }),
        ("page-phone.png", Screen { width: 400, height: 860, phone: true, scale: 2, ..DESKTOP }),
        ("page-zoomed.png", Screen { width: 640, height: 400, scale: 2, ..DESKTOP }),
    ];
    for (name, screen) in screens {
        on_page(screen, "", |chrome| {
            let state = wait_for_points(chrome, 1000);
            assert_eq!((&state["mesh"], &state["triangles"]), (&json!("cup"), &json!(13952)));
            // Measures and looks come later, off the page's own frame.
            chrome.wait_for_state("s.verdicts === 7 && s.look");
            let status = chrome.evaluate("document.getElementById('status').textContent");
            assert!(status.as_str().is_some_and(|s| s.contains("1000 points")), "{status}");
            keep_picture(chrome, name);
            let mute = chrome.evaluate(
                "[...document.querySelectorAll('#mirror > div')].filter(e => !e.ariaLabel.trim()).map(e => e.outerHTML)",
            );
            assert_eq!(mute, json!([]), "controls without a name");
            for number in ["Number of points", "Flatness angle", "Tolerance"] {
                let find =
                    format!("document.querySelector('#mirror > [role=spinbutton][aria-label=\"{number}\"]')");
                chrome.wait_for(&find);
            }
        });
    }
}

#[test]
fn a_dropped_file_is_shown_and_a_broken_one_leaves_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = folder.path().join("pyramid.obj");
    fs::write(
        &good,
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 1\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n",
    )
    .expect("a file");
    let broken = folder.path().join("broken.ply");
    fs::write(&broken, "ply\nformat ascii 1.0\nelement vertex 3\n").expect("a file");
    let apart = folder.path().join("apart.gltf");
    let document = json!({
        "asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri": "corners.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0
    });
    fs::write(&apart, document.to_string()).expect("a file");
    on_page(DESKTOP, "", |chrome| {
        wait_for_points(chrome, 1000);
        chrome.drop_file(&good);
        let state = chrome.wait_for_state("!s.busy && s.mesh === 'pyramid.obj' && s.points === 1000");
        assert_eq!(state["triangles"], 6);
        chrome.drop_file(&broken);
        let state = chrome.wait_for_state("!s.busy && s.notice?.problem");
        assert!(state["notice"]["problem"].as_str().is_some_and(|t| t.contains("broken.ply")), "{state}");
        assert_eq!((&state["mesh"], &state["points"]), (&json!("pyramid.obj"), &json!(1000)));
        // A browser cannot look beside a file.
        chrome.drop_file(&apart);
        let state = chrome.wait_for_state("!s.busy && s.notice?.problem?.includes('apart.gltf')");
        let told = state["notice"]["problem"].as_str().unwrap_or_default();
        assert!(told.contains("corners.bin") && told.contains("GLB"), "{told}");
        assert_eq!(state["mesh"], "pyramid.obj");
    });
}

#[test]
fn pointing_links_the_views_and_a_click_pins_a_figure() {
    on_page(DESKTOP, "", |chrome| {
        wait_for_points(chrome, 1000);
        let surface = chrome.place_of("Surface");
        chrome.move_to((surface.0 - 3.0, surface.1 - 3.0));
        chrome.move_to(surface);
        let on_surface = chrome.wait_for_state("s.hover")["hover"]["face"].clone();
        assert!(on_surface.is_u64());
        let plane = chrome.place_of("Planar domain");
        // Somewhere near the middle of the plane lies a strip.
        let hit = (0..40).any(|k| {
            chrome.move_to((plane.0 - 100.0 + 5.0 * f64::from(k), plane.1 + 3.0 * f64::from(k)));
            let hover = chrome.state()["hover"]["face"].clone();
            hover.is_u64() && hover != on_surface
        });
        assert!(hit, "no strip under the pointer in the plane");
        let at = chrome.place_of("Surface");
        chrome.move_to(at);
        chrome.press(at, true);
        chrome.press(at, false);
        let state = chrome.wait_for_state("s.pinned && s.figure");
        assert!(state["figure"]["degree"].as_u64().is_some_and(|d| d >= 1), "{state}");
        // And by the keyboard alone.
        chrome.key("Escape", "Escape");
        chrome.wait_for_state("!s.pinned");
        chrome.key("n", "KeyN");
        let state = chrome.wait_for_state("s.pinned && s.figure");
        assert_eq!(state["pinned"]["point"], 0);
        keep_picture(chrome, "page-figure.png");
    });
}

#[test]
fn orbiting_is_followed_by_the_visible_share() {
    on_page(DESKTOP, "", |chrome| {
        wait_for_points(chrome, 1000);
        let before = chrome.wait_for_state("s.look")["trail"].as_u64().expect("a trail");
        let (x, y) = chrome.place_of("Surface");
        chrome.move_to((x, y));
        chrome.press((x, y), true);
        for step in 1..12 {
            chrome.drag_to((x + 12.0 * f64::from(step), y));
        }
        chrome.press((x + 132.0, y), false);
        let state = chrome.wait_for_state(&format!("s.trail > {before}"));
        let (surface, points) = (&state["look"]["surface"], &state["look"]["points"][0]);
        let error = surface.as_f64().expect("a share") - points.as_f64().expect("a share");
        assert!(error.abs() < 0.06, "{state}");
    });
}

#[test]
fn two_methods_are_compared_behind_an_obstacle() {
    on_page(DESKTOP, "", |chrome| {
        wait_for_points(chrome, 1000);
        let open = chrome.wait_for_state("s.look")["look"]["surface"].as_f64().expect("a share");
        chrome.click("compare A and B");
        chrome.wait_for_state("!s.busy && s.pointsOfB === 1000 && s.look?.points[1] !== null");
        chrome.activate("obstacle");
        let state = chrome.wait_for_state(&format!("s.look.surface < 0.9 * {open}"));
        for slot in 0..2 {
            let points = state["look"]["points"][slot].as_f64().expect("a share");
            let surface = state["look"]["surface"].as_f64().expect("a share");
            assert!((points - surface).abs() < 0.06, "{state}");
        }
        for control in ["irregular band", "local surplus"] {
            chrome.activate(control);
        }
        chrome.wait_for_state("s.verdicts === 7 && s.verdictsOfB === 7");
        keep_picture(chrome, "page-compare.png");
        chrome.activate("in the domain");
        chrome.activate("wireframe");
        keep_picture(chrome, "page-domain.png");
    });
}

/// As below. Each time in a new browser, which has compiled nothing yet.
#[test]
#[ignore = "measures time"]
fn measure_the_first_picture() {
    for _ in 0..3 {
        on_page(DESKTOP, "", |chrome| {
            let state = chrome.wait_for_state("s.firstPictureSeconds");
            eprintln!(
                "the first picture, cup: {:.2} s",
                state["firstPictureSeconds"].as_f64().expect("seconds")
            );
        });
    }
}

/// Run alone, on a machine that does nothing else: `cargo test -p ldwrap-tests --test browser -- --ignored`, with the
/// environment of `cargo xtask test`.
#[test]
#[ignore = "measures time"]
fn measure_the_horse() {
    let Some(meshes) = std::env::var_os("LDWRAP_MESHES").map(PathBuf::from) else {
        eprintln!("SKIPPED: LDWRAP_MESHES is not set");
        return;
    };
    let link = "#%7B%22settings%22%3A%7B%22request%22%3A%7B%22count%22%3A10000%7D%7D%7D";
    on_page(DESKTOP, link, |chrome| {
        wait_for_points(chrome, 10_000);
        chrome.drop_file(&meshes.join("horse.ply"));
        let state = chrome
            .wait_for_state("!s.busy && s.mesh === 'horse.ply' && s.points === 10000 && s.verdicts === 7");
        eprintln!("wasm, one thread: {} s", state["seconds"]);
        let (x, y) = chrome.place_of("Surface");
        chrome.move_to((x, y));
        chrome.press((x, y), true);
        for step in 1..60 {
            chrome.drag_to((x + 2.0 * f64::from(step), y));
            std::thread::sleep(std::time::Duration::from_millis(30));
        }
        chrome.press((x + 120.0, y), false);
        eprintln!("a frame while orbiting, software rendering: {} ms", chrome.state()["frameMilliseconds"]);
        keep_picture(chrome, "page-horse.png");
    });
    let bytes = fs::read(meshes.join("horse.ply")).expect("the horse");
    let alone = |_: &str| Err(String::new());
    let mesh = checked(&ldwrap::io::read_mesh(&bytes, Some("horse.ply"), &alone).expect("a mesh"));
    let start = std::time::Instant::now();
    native(&mesh, 10_000);
    eprintln!("native, all threads: {:.2} s", start.elapsed().as_secs_f64());
}

#[test]
fn what_is_downloaded_is_what_the_native_program_writes() {
    on_page(DESKTOP, "", |chrome| {
        wait_for_points(chrome, 1000);
        let mut taken = |what: &str, name: &str| {
            chrome.click("Take away");
            chrome.click(what);
            chrome.downloaded(name)
        };
        let starts = |bytes: &[u8], with: &[u8]| bytes.starts_with(with);
        assert!(starts(&taken("Points, PLY", "cup-points.ply"), b"ply\nformat binary_little_endian 1.0"));
        assert!(starts(&taken("Points, NPY", "cup-points.npy"), b"\x93NUMPY"));
        let svg = taken("Strips, SVG", "cup-strips.svg");
        assert_eq!(String::from_utf8_lossy(&svg).matches("<circle").count(), 1000);
        let report: Value = serde_json::from_slice(&taken("Report, JSON", "cup-report.json")).expect("JSON");
        assert_eq!(report["points"]["count"], 1000);
        let picture = taken("Picture, PNG", "cup.png");
        assert!(starts(&picture, b"\x89PNG") && picture.len() > 20_000);
        let bytes = taken("Points, CSV", "cup-points.csv");
        let native = native_csv(&checked(&Shape::Cup.generate()), &options(1000));
        assert_eq!(String::from_utf8_lossy(&bytes), String::from_utf8_lossy(&native));
    });
}

#[test]
fn the_javascript_api_gives_the_bits_of_the_native_library() {
    on_page(DESKTOP, "", |chrome| {
        chrome.evaluate(
            "import('./ldwrap_web.js').then(m => { window.api = m; window.text = (T, a) => Array.from(new T(a.buffer), String) })",
        );
        for shape in [Shape::Sphere, Shape::Cup, Shape::Trefoil] {
            let call = format!(
                "(w => [text(Uint32Array, w.faces), text(BigUint64Array, w.barycentric), text(Uint32Array, w.positions)])\
                 (api.wrapShape('{}', {{request: {{count: 700}}}}))",
                shape.name()
            );
            let got = chrome.evaluate(&call);
            let (faces, weights, positions) = native(&checked(&shape.generate()), 700);
            assert_eq!(bits::<u32>(&got[0]), faces, "{}: faces", shape.name());
            assert_eq!(bits::<u64>(&got[1]), weights, "{}: weights", shape.name());
            assert_eq!(bits::<u32>(&got[2]), positions, "{}: positions", shape.name());
        }
        if let Some(meshes) = std::env::var_os("LDWRAP_MESHES").map(PathBuf::from) {
            let bytes = fs::read(meshes.join("fruit-drink-800.obj")).expect("the drink");
            let text = String::from_utf8(bytes.clone()).expect("text");
            let call = format!(
                "(w => [text(Uint32Array, w.faces), text(BigUint64Array, w.barycentric)])\
                 (api.wrap(new TextEncoder().encode({}), 'drink.obj', {{request: {{count: 315}}}}))",
                json!(text)
            );
            let got = chrome.evaluate(&call);
            let alone = |_: &str| Err(String::new());
            let mesh = checked(&ldwrap::io::read_mesh(&bytes, Some("drink.obj"), &alone).expect("a mesh"));
            let (faces, weights, _) = native(&mesh, 315);
            assert_eq!(bits::<u32>(&got[0]), faces, "drink: faces");
            assert_eq!(bits::<u64>(&got[1]), weights, "drink: weights");
        }
        let told = chrome.evaluate(
            "(() => { try { api.wrapShape('cup', {seeds: 1}) } catch (e) { return e.message } })()",
        );
        assert!(told.as_str().is_some_and(|t| t.contains("seeds")), "{told}");
    });
}

#[test]
fn the_package_works_in_node_and_packs() {
    let Some(Built { package, .. }) = built() else { return };
    let has =
        |program: &str| Command::new(program).arg("--version").output().is_ok_and(|o| o.status.success());
    if !has("node") || !has("npm") {
        assert!(!xtask::in_ci(), "node and npm are needed in continuous integration");
        eprintln!("SKIPPED: the JavaScript package is not tested without node and npm");
        return;
    }
    let mesh = checked(&Shape::Cup.generate());
    let (_, _, positions) = native(&mesh, 1000);
    let in_worker = "new (require('node:worker_threads').Worker)('./example.mjs')";
    for arguments in [["--no-warnings", "example.mjs"], ["--eval", in_worker]] {
        let output = Command::new("node").args(arguments).current_dir(&package).output().expect("node runs");
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        let printed: Vec<u32> = String::from_utf8_lossy(&output.stdout)
            .split_whitespace()
            .map(|number| (number.parse::<f64>().expect("a number") as f32).to_bits())
            .collect();
        assert_eq!(printed, positions, "{arguments:?}");
    }
    pack(&package);
}

#[test]
fn the_package_works_in_a_page_and_its_worker() {
    let Some(Built { package, browser, .. }) = built() else { return };
    let _one = ONE.lock().unwrap_or_else(|broken| broken.into_inner());
    let folder = tempfile::tempdir().expect("a folder");
    let soup = Shape::Sphere.generate();
    let bytes = ldwrap::io::mesh_out::write_obj(&soup).expect("a mesh");
    let file = folder.path().join("sphere.obj");
    fs::write(&file, &bytes).expect("a file");
    let server = Server::start(&package, 0).expect("a server");
    let mut chrome = Chrome::start(&browser, DESKTOP);
    chrome.open(&format!("{}example.html", server.address()));
    chrome.wait_for("document.querySelector('pre')");
    chrome.choose_file("input", &file);
    chrome.wait_for("document.querySelector('pre').textContent.startsWith('500 points on ')");
    let ask = |message: &str| {
        format!(
            "new Promise((told, broken) => {{
                const worker = new Worker('worker.js', {{ type: 'module' }});
                worker.onmessage = ({{ data: d }}) => told(d.error ?? [d.faces, d.positions, d.normals].map(
                    a => Array.from(new Uint32Array(a.buffer), String)));
                worker.onerror = () => broken(new Error('the worker broke'));
                worker.postMessage({message});
            }})"
        )
    };
    let text = json!(String::from_utf8_lossy(&bytes));
    let message = format!(
        "{{ bytes: new TextEncoder().encode({text}), name: 'sphere.obj', options: {{ request: {{ count: 700 }} }} }}"
    );
    let got = chrome.evaluate(&ask(&message));
    let alone = |_: &str| Err(String::new());
    let mesh = checked(&ldwrap::io::read_mesh(&bytes, Some("sphere.obj"), &alone).expect("a mesh"));
    let (faces, _, positions) = native(&mesh, 700);
    assert_eq!(bits::<u32>(&got[0]), faces);
    assert_eq!(bits::<u32>(&got[1]), positions);
    assert_eq!(bits::<u32>(&got[2]).len(), positions.len());
    let told = chrome.evaluate(&ask("{ bytes: new Uint8Array(9), name: 'broken.ply' }"));
    assert!(told.as_str().is_some_and(|t| t.contains("broken.ply")), "{told}");
    let problems: Vec<_> = chrome.problems().into_iter().filter(|p| !p.contains("favicon")).collect();
    assert!(problems.is_empty(), "the page reported errors: {problems:#?}");
}

fn pack(package: &Path) {
    let folder = tempfile::tempdir().expect("a folder");
    let output = Command::new("npm")
        .args(["pack", "--pack-destination"])
        .arg(folder.path())
        .current_dir(package)
        .output()
        .expect("npm runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let packed: Vec<_> =
        fs::read_dir(folder.path()).expect("the folder").flatten().map(|e| e.file_name()).collect();
    assert!(packed.iter().any(|name| name.to_string_lossy().ends_with(".tgz")), "{packed:?}");
}
