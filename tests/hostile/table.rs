//! Runs every bad input and writes down what happens: `docs/HOSTILE.md`.

use std::fmt::Write;
use std::path::Path;

use ldwrap::equalize::EqualizeOptions;
use ldwrap::io::{Detail, ReadOptions, read_model_with};
use ldwrap::pipeline::{Options, Request, run};
use ldwrap::{CheckOptions, PolygonSoup, RepairReport, Silent, SurfaceMesh, spatial};

use crate::{files, meshes};

/// How many points are asked for.
pub(crate) const COUNT: usize = 100;

/// How far a point may be from the surface, in diagonals of the mesh.
const ON_SURFACE: f64 = 1e-8;

/// What must happen.
#[derive(Clone, Copy)]
pub(crate) enum Expected {
    /// Exactly the points that were asked for.
    Points,
    /// An error with these words.
    Error(&'static str),
}

/// What is put in.
pub(crate) enum Input {
    File { name: &'static str, bytes: Vec<u8>, options: ReadOptions<'static> },
    Soup(PolygonSoup),
}

/// A bad input.
pub(crate) struct Case {
    pub(crate) what: String,
    pub(crate) input: Input,
    pub(crate) expected: Expected,
}

impl Case {
    pub(crate) fn soup(what: &str, soup: PolygonSoup, expected: Expected) -> Self {
        Self { what: what.to_owned(), input: Input::Soup(soup), expected }
    }

    pub(crate) fn file(
        what: &str,
        name: &'static str,
        bytes: impl Into<Vec<u8>>,
        expected: Expected,
    ) -> Self {
        let options = ReadOptions { name: Some(name), detail: Detail::Textures, ..ReadOptions::default() };
        Self { what: what.to_owned(), input: Input::File { name, bytes: bytes.into(), options }, expected }
    }
}

/// What happens, in words; an `Err` if that is not what must.
pub(crate) fn happens(case: &Case) -> Result<String, String> {
    let outcome = soup(&case.input).and_then(|soup| points(&case.what, &soup));
    // As the program tells it.
    let outcome = match &case.input {
        Input::File { name, .. } => outcome.map_err(|error| format!("{name}: {error}")),
        Input::Soup(_) => outcome,
    };
    match (case.expected, outcome) {
        (Expected::Points, Ok(words)) => Ok(words),
        (Expected::Error(words), Err(error)) if error.contains(words) => Ok(error),
        (Expected::Points, Err(words)) | (Expected::Error(_), Ok(words) | Err(words)) => {
            Err(format!("{}: {words}", case.what))
        }
    }
}

fn soup(input: &Input) -> Result<PolygonSoup, String> {
    match input {
        Input::Soup(soup) => Ok(soup.clone()),
        Input::File { bytes, options, .. } => {
            let resolver = |_: &str| Err("it is not there".to_owned());
            let model = read_model_with(bytes, options, &resolver);
            model.map(|model| model.soup).map_err(|error| error.to_string())
        }
    }
}

/// Makes points, equalized and not; checks that they are as many as were asked for, and on the surface.
fn points(what: &str, soup: &PolygonSoup) -> Result<String, String> {
    let (mesh, report) =
        SurfaceMesh::from_soup(soup, &CheckOptions::default()).map_err(|error| error.to_string())?;
    for equalize in [None, Some(EqualizeOptions::default())] {
        let options = Options { request: Request::Count(COUNT), equalize, ..Options::default() };
        let run = run(&mesh, &options, &Silent).map_err(|error| error.to_string())?;
        assert_eq!(run.samples.len(), COUNT, "{what}");
        let places: Vec<_> = run.samples.iter().map(|sample| mesh.locate(&sample.point)).collect();
        for (sample, place) in run.samples.iter().zip(&places) {
            let weights = sample.point.barycentric;
            assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{what}: {weights:?}");
            assert!(place.is_finite(), "{what}: {place}");
        }
        let (low, high) = mesh.bounds();
        let rounding = 16.0 * f64::EPSILON * low.abs().max(high.abs()).max_element();
        for (nearest, place) in spatial::nearest(&mesh, &places).iter().zip(&places) {
            let off = mesh.locate(&nearest.point).distance(*place);
            assert!(off <= ON_SURFACE * mesh.diagonal() + rounding, "{what}: {off:e} off the surface");
        }
    }
    let faces = mesh.face_count();
    Ok(format!("{COUNT} points on {faces} triangle{}{}", if faces == 1 { "" } else { "s" }, repairs(&report)))
}

/// What the check changed.
fn repairs(report: &RepairReport) -> String {
    let counts = [
        (report.welded_vertices, "vertices welded"),
        (report.isolated_vertices, "vertices left out"),
        (report.degenerate_polygons, "faces of fewer than three corners left out"),
        (report.fanned_polygons, "faces cut as fans"),
        (report.zero_area_faces, "triangles without area left out"),
        (report.duplicate_faces, "repeated triangles left out"),
        (report.non_manifold_edges, "edges of more than two triangles made borders"),
        (report.inconsistent_edges, "edges wound against each other made borders"),
        (report.turned_components, "components turned outward"),
    ];
    let told: Vec<String> = counts
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{count} {what}"))
        .collect();
    if told.is_empty() { String::new() } else { format!("; {}", told.join(", ")) }
}

/// The rows of a table; what would end a cell is shown otherwise.
fn rows(page: &mut String, cases: &[Case]) {
    page.push_str("\n\n| input | what happens |\n|---|---|\n");
    let mut wrong = Vec::new();
    for case in cases {
        match happens(case) {
            Ok(words) => {
                writeln!(page, "| {} | {} |", case.what, words.replace('|', "/"))
                    .expect("a string takes all");
            }
            Err(words) => wrong.push(words),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn page() -> String {
    let mut page = format!(
        "# Bad input, and what happens\n\n\
         Written by the test `hostile` ([tests/hostile](../tests/hostile)), which runs every row and compares; `LDWRAP_BLESS=1 cargo \
         test -p ldwrap-tests --test hostile` writes it anew. \"{COUNT} points\" means: asked for {COUNT} points with \
         equalizing and without, it made exactly {COUNT} both times, all finite, with barycentric coordinates from 0 to 1, and \
         no farther from the surface than {ON_SURFACE:e} of the mesh's diagonal. Everything else is the error that the library \
         returns, behind the name of the file.\n\n## Files"
    );
    rows(&mut page, &files::cases());
    page.push_str("\n## Meshes");
    rows(&mut page, &meshes::cases());
    page.push_str(
        "\nA mesh of a million components is run by the same test in release builds \
         (`cargo test --release -p ldwrap-tests --test hostile -- --ignored`); debug builds take the hundred thousand above.\n",
    );
    page
}

#[test]
fn the_table_says_what_happens() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/HOSTILE.md");
    let page = page();
    if std::env::var_os("LDWRAP_BLESS").is_some() {
        std::fs::write(&path, page).expect("the table can be written");
        return;
    }
    let committed = std::fs::read_to_string(&path).expect("docs/HOSTILE.md is there");
    for (committed, now) in committed.lines().zip(page.lines()) {
        assert_eq!(committed, now, "docs/HOSTILE.md is not true any more: LDWRAP_BLESS=1 writes it anew");
    }
    assert_eq!(committed, page, "docs/HOSTILE.md is not true any more: LDWRAP_BLESS=1 writes it anew");
}

/// Takes memory and minutes without optimisation.
#[test]
#[ignore = "for release builds"]
fn a_million_components() {
    let case = meshes::components(1_000_000);
    assert!(happens(&case).expect("points").starts_with("100 points on 1000000 triangles"));
}
