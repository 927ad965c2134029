//! Figures 4 to 7: one object at the paper's numbers of points.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use ldwrap::baseline::Baseline;
use ldwrap::equalize::{EqualizeOptions, ForViews};
use ldwrap::io::read_mesh;
use ldwrap::pipeline::{self, Options, Request, Run, Selection};
use ldwrap::segment::{GrowthOrder, SegmentOptions};
use ldwrap::{CheckOptions, Origin, PolygonSoup, Sample, Silent, StripId, SurfaceMesh, SurfacePoint};

use crate::picture::{PreviewOptions, preview_png, strips_png, strips_svg};
use crate::quality::{Judge, Quality};
use crate::report::Report;
use crate::table::{MEASURES, Summary, cell};

pub(crate) type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// Strips of meshes with more triangles than this are drawn in pixels: their borders would swell an SVG file.
const DRAWN_AS_LINES: usize = 2_000;

/// A way to place points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// The paper's: segments grow along their boundary, first in, first out.
    Walk,
    /// What the program does under `--no-equalize`.
    Wrap,
    /// The default, then equalized.
    Equalized,
    /// Equalized, then placed for views.
    ForViews,
    Baseline(Baseline),
}

impl Way {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Walk => "wrap, paper's order",
            Self::Wrap => "wrap, not equalized",
            Self::Equalized => "equalized (default)",
            Self::ForViews => "for views",
            Self::Baseline(baseline) => baseline.name(),
        }
    }

    /// The points, and how many seconds they took.
    pub(crate) fn place(
        self,
        mesh: &SurfaceMesh,
        count: usize,
        seed: u64,
    ) -> Outcome<(Vec<SurfacePoint>, f64)> {
        let begin = Instant::now();
        let points = match self {
            Self::Baseline(baseline) => baseline.place(mesh, count, seed)?,
            way => wrapped(mesh, way, count, seed)?.samples.iter().map(|s| s.point).collect(),
        };
        Ok((points, begin.elapsed().as_secs_f64()))
    }
}

/// Runs the pipeline; a baseline has none and is taken as the default.
pub(crate) fn wrapped(mesh: &SurfaceMesh, way: Way, count: usize, seed: u64) -> Outcome<Run> {
    let order = if way == Way::Walk { GrowthOrder::BoundaryWalk } else { GrowthOrder::default() };
    let options = Options {
        request: Request::Count(count),
        segment: SegmentOptions { order, ..SegmentOptions::default() },
        seed,
        selection: if way == Way::Walk { Selection::Sequence } else { Selection::default() },
        equalize: match way {
            Way::Equalized => Some(EqualizeOptions::default()),
            Way::ForViews => {
                let for_views = Some(ForViews { seed, ..ForViews::default() });
                Some(EqualizeOptions { for_views, ..EqualizeOptions::default() })
            }
            Way::Walk | Way::Wrap | Way::Baseline(_) => None,
        },
        ..Options::default()
    };
    Ok(pipeline::run(mesh, &options, &Silent)?)
}

pub(crate) fn checked(soup: &PolygonSoup) -> Outcome<SurfaceMesh> {
    Ok(SurfaceMesh::from_soup(soup, &CheckOptions::default())?.0)
}

/// The mesh of a file, or nothing, said loudly, when there is no such file.
pub(crate) fn read(path: &Path) -> Outcome<Option<SurfaceMesh>> {
    if !path.exists() {
        eprintln!("SKIPPED: {} is not there", path.display());
        return Ok(None);
    }
    let bytes = std::fs::read(path)?;
    let name = path.to_string_lossy();
    let soup = read_mesh(&bytes, Some(&name), &|_| Err("no external buffers".to_owned()))?;
    checked(&soup).map(Some)
}

/// An object of the paper.
pub(crate) struct Object {
    /// The start of the names of its pictures.
    pub(crate) stem: &'static str,
    /// The mesh as commands name it.
    pub(crate) file: &'static str,
    pub(crate) heading: &'static str,
    /// The paper's number of strips, if it gives one for this mesh.
    pub(crate) strips: Option<usize>,
    /// Numbers of points with the paper's R.
    pub(crate) paper: &'static [(usize, Option<f64>)],
    /// What is measured at every number of points.
    pub(crate) ways: &'static [Way],
}

/// Seeds of each way.
pub(crate) const SEEDS: u64 = 5;

/// Pictures, R and all measures of an object.
pub(crate) fn write(report: &mut Report, mesh: &SurfaceMesh, object: &Object) -> Outcome {
    let Object { stem, file, heading, strips, paper, ways } = *object;
    report.heading(heading);
    report.say(&format!(
        "{} vertices, {} edges, {} triangles, {} border edges.{}",
        mesh.vertex_count(),
        mesh.topology().edge_count(),
        mesh.face_count(),
        mesh.topology().border_edge_count(),
        strips.map_or(String::new(), |s| format!(" Strips in the paper: {s}.")),
    ));
    let mut rows = Vec::new();
    for way in [Way::Walk, Way::Wrap] {
        for &(count, wanted) in paper {
            let run = wrapped(mesh, way, count, 0)?;
            if way == Way::Walk {
                pictures(report, mesh, &run, &format!("{stem}-{count}"))?;
            }
            let r = run.irregularity();
            let open = run.strips.open_border_length(0.1 * run.d_m) / mesh.area().sqrt();
            let mut row = vec![way.name().to_owned(), count.to_string(), run.strips.strips.len().to_string()];
            row.push(format!("{open:.1}"));
            row.push(wanted.map_or("-".to_owned(), |r| format!("{r:.2}")));
            row.extend([r.bound, r.refined, r.exact].map(|r| format!("{r:.2}")));
            row.extend([run.correction.projected, run.correction.removed].map(|x| x.to_string()));
            rows.push(row);
        }
    }
    for &way in ways.iter().filter(|&&way| way != Way::Walk && way != Way::Wrap) {
        for &(count, _) in paper.iter().filter(|_| pictured(way)) {
            let samples = on_one_strip(&way.place(mesh, count, 0)?.0);
            let run = wrapped(mesh, Way::Walk, count, 0)?;
            let png = preview(mesh, &run, &samples);
            let name = format!("{stem}-{count}-{}.png", way.name().split(' ').next().unwrap_or("points"));
            let picture = report.image(&name, &png)?;
            report.say(&format!("![{}, {count} points]({picture}) {}, n = {count}", way.name(), way.name()));
        }
    }
    report.table(
        &[
            "",
            "n",
            "strips",
            "open border / sqrt(A)",
            "paper's R",
            "R, eq. 8",
            "R, cases a to c",
            "R, exact band",
            "projected",
            "removed",
        ],
        &rows,
    );
    report.say(&format!(
        "`ldwrap-cli wrap {file} -n {} --no-equalize --select sequence --growth boundary-walk --report -` (or without the last two options; any n of the \
         table).",
        paper[0].0
    ));
    measures(report, mesh, ways, &paper.iter().map(|p| p.0).collect::<Vec<_>>())?;
    let counts = paper.iter().map(|p| p.0.to_string()).collect::<Vec<_>>().join(",");
    report.say(&format!(
        "`ldwrap-cli compare {file} -n {counts} --seeds {SEEDS}`, and for the paper's order `--methods wrap --growth \
         boundary-walk`."
    ));
    Ok(())
}

/// Lattices and equalized points are shown beside the wrapped ones; random ones are known.
fn pictured(way: Way) -> bool {
    !matches!(
        way,
        Way::Baseline(Baseline::Random | Baseline::Hilbert | Baseline::Poisson | Baseline::SphereFibonacci)
    )
}

/// Points as samples that lie nowhere in the plane, to be drawn on the mesh.
fn on_one_strip(points: &[SurfacePoint]) -> Vec<Sample> {
    let sample =
        |&point| Sample { point, strip: StripId(0), place: glam::DVec2::ZERO, origin: Origin::Wrapped };
    points.iter().map(sample).collect()
}

fn preview(mesh: &SurfaceMesh, run: &Run, samples: &[Sample]) -> Vec<u8> {
    preview_png(mesh, &run.strips, samples, &PreviewOptions { width: 480, height: 480 })
}

fn pictures(report: &mut Report, mesh: &SurfaceMesh, run: &Run, stem: &str) -> Outcome {
    let count = run.samples.len();
    let picture = report.image(&format!("{stem}.png"), &preview(mesh, run, &run.samples))?;
    let tolerance = 0.1 * run.d_m;
    let strips = if mesh.face_count() <= DRAWN_AS_LINES {
        let svg = strips_svg(&run.strips, &run.domain, &run.samples, tolerance);
        report.image(&format!("{stem}-strips.svg"), svg.as_bytes())?
    } else {
        report.image(&format!("{stem}-strips.png"), &strips_png(mesh, run, tolerance))?
    };
    report.say(&format!(
        "![Wrapped in the paper's order, {count} points]({picture}) ![Its strips in the plane]({strips}) wrapped in the paper's \
         order, n = {count}"
    ));
    Ok(())
}

/// Up to this many points there are [`SEEDS`] sets, and one judge for all of them, as `compare` has one for a run.
const FEW: usize = 1_000;

/// Means over the seeds of one way at one number of points.
pub(crate) struct Means {
    pub(crate) way: Way,
    pub(crate) count: usize,
    /// As in [`MEASURES`].
    pub(crate) values: Vec<f64>,
}

/// The table of ways by measures, which it gives back.
pub(crate) fn measures(
    report: &mut Report,
    mesh: &SurfaceMesh,
    ways: &[Way],
    counts: &[usize],
) -> Outcome<Vec<Means>> {
    let (mut rows, mut means) = (Vec::new(), Vec::new());
    let (few, many): (Vec<usize>, Vec<usize>) = counts.iter().partition(|&&count| count <= FEW);
    for counts in std::iter::once(&few[..]).chain(many.chunks(1)) {
        let Some(&most) = counts.iter().max() else { continue };
        let judge = Judge::new(mesh, most, &Silent);
        let seeds = if most > FEW { 1 } else { SEEDS };
        for &count in counts {
            for &way in ways {
                let (mut sets, mut seconds): (Vec<Quality>, f64) = (Vec::new(), 0.0);
                for seed in 0..seeds {
                    let (points, took) = way.place(mesh, count, seed)?;
                    seconds += took / seeds as f64;
                    sets.push(judge.quality(&points, &Silent));
                }
                let summaries =
                    MEASURES.map(|m| Summary::of(&sets.iter().map(m.value).collect::<Vec<f64>>()));
                let mut row = vec![way.name().to_owned(), count.to_string()];
                row.extend(summaries.map(cell));
                row.push(format!("{seconds:.2}"));
                rows.push(row);
                means.push(Means { way, count, values: summaries.map(|summary| summary.mean).to_vec() });
            }
        }
    }
    let names = MEASURES.map(|measure| measure.name.replace('_', " "));
    let mut head = vec!["", "n"];
    head.extend(names.iter().map(String::as_str));
    head.push("seconds to place");
    report.table(&head, &rows);
    Ok(means)
}
