//! The mesh that is worked on: from a file or stdin to a checked surface.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use ldwrap::io as formats;
use ldwrap::{CheckOptions, Progress, RepairReport, SurfaceMesh};

use crate::args::{MeshArgs, MeshFormatArg};
use crate::exit::{Failure, Outcome};

/// A checked mesh and what had to be done to it.
pub(crate) struct Input {
    /// What messages call it.
    pub(crate) name: String,
    pub(crate) mesh: SurfaceMesh,
    pub(crate) repaired: RepairReport,
}

/// Reads and checks a mesh; `progress` hears the stages `read` and `check`.
pub(crate) fn read(args: &MeshArgs, progress: &dyn Progress) -> Outcome<Input> {
    let stdin = args.mesh.as_os_str() == "-";
    if stdin && args.mesh_format.is_none() {
        return Err(Failure::wrong_use(
            "a mesh from stdin needs its format: add --mesh-format ply, obj, stl, gltf or glb",
        ));
    }
    let name = if stdin { "stdin".to_owned() } else { args.mesh.display().to_string() };
    progress.begin("read", 0);
    let bytes = bytes(&args.mesh, stdin).with_context(|| name.clone())?;
    let format_name = match args.mesh_format {
        Some(format) => format!("{name}.{}", extension(format)),
        None => name.clone(),
    };
    let folder = if stdin { PathBuf::from(".") } else { args.mesh.parent().unwrap_or(Path::new("")).to_path_buf() };
    let resolver = |file: &str| fs::read(folder.join(file)).map_err(|error| error.to_string());
    let soup = formats::read_mesh(&bytes, &format_name, &resolver).with_context(|| name.clone())?;
    drop(bytes);
    progress.begin("check", 0);
    let options = CheckOptions { turn_outward: !args.keep_winding };
    let (mesh, repaired) = SurfaceMesh::from_soup(&soup, &options).with_context(|| name.clone())?;
    Ok(Input { name, mesh, repaired })
}

fn bytes(path: &Path, stdin: bool) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if stdin {
        io::stdin().lock().read_to_end(&mut bytes).context("cannot be read")?;
    } else {
        let found = fs::metadata(path).context("cannot be opened")?;
        if found.is_dir() {
            return Err(anyhow!("is a folder; name a mesh file in it"));
        }
        bytes = fs::read(path).context("cannot be read")?;
    }
    if bytes.is_empty() {
        return Err(anyhow!("is empty: there is no mesh in it"));
    }
    Ok(bytes)
}

fn extension(format: MeshFormatArg) -> &'static str {
    match format {
        MeshFormatArg::Ply => "ply",
        MeshFormatArg::Obj => "obj",
        MeshFormatArg::Stl => "stl",
        MeshFormatArg::Gltf => "gltf",
        MeshFormatArg::Glb => "glb",
    }
}

/// What checking did, one line for each kind of repair.
pub(crate) fn notes(repaired: &RepairReport) -> Vec<String> {
    let r = repaired;
    let notes = [
        (r.welded_vertices, "vertex welded to another at the same position", "vertices welded to others at the same position"),
        (r.isolated_vertices, "vertex left out: no face uses it", "vertices left out: no face uses them"),
        (r.degenerate_polygons, "polygon left out: fewer than three different corners", "polygons left out: fewer than three different corners"),
        (r.polygons_triangulated, "polygon with more than three corners cut into triangles", "polygons with more than three corners cut into triangles"),
        (r.fanned_polygons, "of these cut as a fan: it crosses itself or has no area", "of these cut as fans: they cross themselves or have no area"),
        (r.zero_area_faces, "triangle left out: its area is zero", "triangles left out: their area is zero"),
        (r.duplicate_faces, "triangle left out: another has the same corners", "triangles left out: others have the same corners"),
        (r.non_manifold_edges, "edge of more than two triangles made a border", "edges of more than two triangles made borders"),
        (r.inconsistent_edges, "edge between triangles wound against each other made a border", "edges between triangles wound against each other made borders"),
        (r.turned_components, "closed component was wound inward and is turned outward", "closed components were wound inward and are turned outward"),
    ];
    notes
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }))
        .collect()
}
