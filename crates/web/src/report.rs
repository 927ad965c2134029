//! Counts and reports in plain numbers, with the keys of the command line program's report.

use ldwrap::irregularity::Irregularity;
use ldwrap::pipeline::{Options, Run};
use ldwrap::{RepairReport, SurfaceMesh};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// What a mesh is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshReport {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub faces: usize,
    /// Connected components.
    pub components: usize,
    /// Edges with a face on one side only.
    pub border_edges: usize,
    /// The area.
    pub area: f64,
}

impl MeshReport {
    /// Counts a mesh.
    pub fn new(mesh: &SurfaceMesh) -> Self {
        Self {
            vertices: mesh.vertex_count(),
            faces: mesh.face_count(),
            components: mesh.topology().components().count,
            border_edges: mesh.topology().border_edge_count(),
            area: mesh.area(),
        }
    }
}

/// What the check repaired, each kind in words with its count; empty for a clean mesh.
pub fn repaired_in_words(repaired: &RepairReport) -> Vec<String> {
    match serde_json::to_value(repaired) {
        Ok(Value::Object(counts)) => counts
            .iter()
            .filter(|(_, count)| count.as_u64().is_some_and(|c| c > 0))
            .map(|(name, count)| format!("{}: {count}", name.replace('_', " ")))
            .collect(),
        _ => Vec::new(),
    }
}

/// The report of a run, as the command line program writes it; `seconds` is the whole run's time.
pub fn of_run(
    mesh: &SurfaceMesh,
    repaired: &RepairReport,
    options: &Options,
    run: &Run,
    irregularity: Irregularity,
    seconds: f64,
) -> Value {
    let gap = run.tolerance;
    let strips: Vec<Value> = run
        .strips
        .strips
        .iter()
        .map(|strip| {
            let length = |open_only: bool| -> f64 {
                let counted = strip.border.iter().filter(|e| !open_only || strip.is_open(e, gap));
                counted.map(|e| strip.border_length(e)).sum()
            };
            json!({
                "faces": strip.faces.len(),
                "area": strip.area,
                "border_length": length(false),
                "open_border_length": length(true),
            })
        })
        .collect();
    let MeshReport { vertices, faces, components, border_edges, area } = MeshReport::new(mesh);
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "options": {
            "request": options.request,
            "sequence": options.sequence,
            "seed": options.seed,
            "tolerance": options.tolerance,
            "flatness_angle": options.segment.flatness_angle.to_degrees(),
            "smallest_share": options.segment.smallest_share,
            "growth": options.segment.order,
            "equalize": options.equalize.is_some(),
        },
        "mesh": {
            "vertices": vertices,
            "faces": faces,
            "components": components,
            "border_edges": border_edges,
            "area": area,
            "repaired": repaired,
        },
        "strips": strips,
        "points": {
            "count": run.samples.len(),
            "d_m": run.d_m,
            "projected": run.correction.projected,
            "removed": run.correction.removed,
        },
        "irregularity": irregularity,
        "equalize": run.equalize,
        "seconds": { "total": seconds },
    })
}
