//! The report of a run as JSON. Its keys and units are documented in this crate's README and stay as they are.

use ldwrap::density::Density;
use ldwrap::equalize::{EqualizeOptions, EqualizeReport};
use ldwrap::irregularity::Irregularity;
use ldwrap::pipeline::{Options, Request, SampleOrder, Selection, Streamed};
use ldwrap::segment::GrowthOrder;
use ldwrap::sequence::Sequence;
use ldwrap::unfold::Strip;
use ldwrap::{RepairReport, SurfaceMesh};
use serde::Serialize;

use crate::args::degrees;
use crate::progress::Seconds;
use crate::quality::Quality;

/// What `wrap --report` writes.
#[derive(Serialize)]
pub(crate) struct Report<'a> {
    version: &'static str,
    options: OptionsReport,
    mesh: MeshReport<'a>,
    strips: Vec<StripReport>,
    /// The length of all open border edges over sqrt(area).
    open_border: f64,
    points: PointsReport,
    irregularity: Irregularity,
    #[serde(skip_serializing_if = "Option::is_none")]
    equalize: Option<EqualizeReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    quality: Option<Quality>,
    seconds: Seconds,
}

#[derive(Serialize)]
struct OptionsReport {
    request: Request,
    sequence: Sequence,
    seed: u64,
    tolerance: f64,
    flatness_angle: f64,
    smallest_share: f64,
    growth: GrowthOrder,
    selection: Selection,
    equalize: Option<EqualizeOptions>,
    order: SampleOrder,
    /// Whether weights were given.
    weighted: bool,
}

/// What a mesh is; `info --json` prints this.
#[derive(Serialize)]
pub(crate) struct MeshReport<'a> {
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    pub(crate) components: usize,
    pub(crate) border_edges: usize,
    pub(crate) area: f64,
    pub(crate) repaired: &'a RepairReport,
}

#[derive(Serialize)]
struct StripReport {
    faces: usize,
    area: f64,
    border_length: f64,
    open_border_length: f64,
}

#[derive(Serialize)]
struct PointsReport {
    count: usize,
    d_m: f64,
    projected: usize,
    removed: usize,
}

impl<'a> Report<'a> {
    /// Puts together what `run` did with `options` in `seconds`, and how good its points are if that was asked for.
    pub(crate) fn new(
        mesh: MeshReport<'a>,
        options: &Options,
        density: &Density,
        run: &Streamed,
        irregularity: Irregularity,
        quality: Option<Quality>,
        seconds: Seconds,
    ) -> Self {
        let area = mesh.area;
        Self {
            version: env!("CARGO_PKG_VERSION"),
            options: OptionsReport {
                request: options.request,
                sequence: options.sequence,
                seed: options.seed,
                tolerance: options.tolerance,
                flatness_angle: degrees(options.segment.flatness_angle),
                smallest_share: options.segment.smallest_share,
                growth: options.segment.order,
                selection: options.selection,
                equalize: options.equalize,
                order: options.order,
                weighted: !density.is_uniform(),
            },
            mesh,
            strips: run.strips.strips.iter().map(|strip| strip_report(strip, run.tolerance)).collect(),
            open_border: open_border(area, run),
            points: PointsReport {
                count: run.samples,
                d_m: run.d_m,
                projected: run.correction.projected,
                removed: run.correction.removed,
            },
            irregularity,
            equalize: run.equalize,
            quality,
            seconds,
        }
    }
}

impl<'a> MeshReport<'a> {
    /// Counts a mesh.
    pub(crate) fn new(mesh: &SurfaceMesh, repaired: &'a RepairReport) -> Self {
        let topology = mesh.topology();
        Self {
            vertices: mesh.vertex_count(),
            faces: mesh.face_count(),
            components: topology.components().count,
            border_edges: topology.border_edge_count(),
            area: mesh.area(),
            repaired,
        }
    }
}

/// The length of the border that stays open at a run's d_m, both sides of each cut, over the root of the area.
pub(crate) fn open_border(area: f64, run: &Streamed) -> f64 {
    run.strips.open_border_length(run.tolerance) / area.sqrt()
}

fn strip_report(strip: &Strip, tolerance: f64) -> StripReport {
    let length = |open_only: bool| {
        let counted = strip.border.iter().filter(|edge| !open_only || strip.is_open(edge, tolerance));
        counted.map(|edge| strip.border_length(edge)).sum()
    };
    StripReport {
        faces: strip.faces.len(),
        area: strip.area,
        border_length: length(false),
        open_border_length: length(true),
    }
}

/// A value as indented JSON that ends in a newline.
pub(crate) fn json(value: &impl Serialize) -> serde_json::Result<Vec<u8>> {
    let mut bytes = serde_json::to_vec_pretty(value)?;
    bytes.push(b'\n');
    Ok(bytes)
}
