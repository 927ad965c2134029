//! The mesh that is worked on: from a file or stdin to a checked surface.

use std::fs::{self, File};
use std::io::{self, Read, stdin as standard_input};
use std::path::{Component, Path};

use anyhow::{Context, anyhow};
use ldwrap::attributes::MeshAttributes;
use ldwrap::io::{Detail, Limits, MeshFormat, Model, ReadOptions, detect, read_model_with};
use ldwrap::{CheckOptions, PolygonSoup, Progress, RepairReport, SurfaceMesh};

use crate::args::{BoxArg, MeshArgs, MeshFormatArg, OnlyArg};

/// A checked mesh and what had to be done to it.
pub(crate) struct Input {
    /// What messages call it.
    pub(crate) name: String,
    /// The format that content or name tell.
    pub(crate) format: Option<MeshFormat>,
    /// As the file gives it.
    pub(crate) soup: PolygonSoup,
    pub(crate) mesh: SurfaceMesh,
    pub(crate) repaired: RepairReport,
    /// What the file has besides the shape, as far as it was asked for.
    pub(crate) attributes: MeshAttributes,
}

/// Reads and checks a mesh; `progress` hears the stages `read` and `check`.
pub(crate) fn read(args: &MeshArgs, progress: &dyn Progress) -> anyhow::Result<Input> {
    read_detail(args, Detail::Shape, &[], progress)
}

/// Reads and checks a mesh, or `only` some of its faces, with what it has besides the shape.
pub(crate) fn read_detail(
    args: &MeshArgs,
    detail: Detail,
    only: &[OnlyArg],
    progress: &dyn Progress,
) -> anyhow::Result<Input> {
    let stdin = args.mesh.as_os_str() == "-";
    let name = if stdin { "stdin".to_owned() } else { args.mesh.display().to_string() };
    progress.begin("read", 1);
    let limits = Limits::for_memory(args.reading.memory());
    let bytes = bytes(&args.mesh, stdin, limits.bytes).with_context(|| name.clone())?;
    let folder = if stdin { None } else { args.mesh.parent() };
    let resolver = |file: &str| beside(folder.unwrap_or(Path::new("")), file, limits.bytes);
    let reading =
        ReadOptions { format: args.reading.mesh_format.map(Into::into), name: Some(&name), detail, limits };
    let mut model = read_model_with(&bytes, &reading, &resolver).with_context(|| name.clone())?;
    let detected = || detect(&bytes, Some(name.strip_suffix(".gz").unwrap_or(&name)));
    let format = args.reading.mesh_format.map(MeshFormat::from).or_else(detected);
    if !only.is_empty() {
        select(&mut model, only).with_context(|| name.clone())?;
    }
    let Model { soup, attributes } = model;
    drop(bytes);
    progress.begin("check", 1);
    let options = CheckOptions { turn_outward: !args.reading.keep_winding };
    let (mesh, repaired) = SurfaceMesh::from_soup(&soup, &options).with_context(|| name.clone())?;
    Ok(Input { name, format, soup, mesh, repaired, attributes })
}

impl Input {
    /// Keeps what lies in a box.
    pub(crate) fn clip(self, BoxArg(low, high): BoxArg) -> anyhow::Result<Self> {
        let Self { name, format, soup, mesh, repaired, attributes } = self;
        let mut model = Model { soup, attributes };
        model
            .clip(&mesh, (low, high))
            .map_err(|error| anyhow!("{error}: give another --box"))
            .with_context(|| name.clone())?;
        let Model { soup, attributes } = model;
        // What was turned stays turned; what was repaired is the file's.
        let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions { turn_outward: false })
            .context("in the box")
            .with_context(|| name.clone())?;
        Ok(Self { name, format, soup, mesh, repaired, attributes })
    }
}

/// Keeps the faces that have one of the names.
fn select(model: &mut Model, only: &[OnlyArg]) -> anyhow::Result<()> {
    let attributes = &model.attributes;
    let mut keep = vec![false; model.soup.polygon_count()];
    for wanted in only {
        let (what, name, names) = match wanted {
            OnlyArg::Material(name) => ("material", name, &attributes.material_of),
            OnlyArg::Part(name) => ("part", name, &attributes.parts),
        };
        let mut found = false;
        for (polygon, keep) in keep.iter_mut().enumerate() {
            // Several may have the same name.
            if names.get(polygon).is_some_and(|index| names.names()[index] == *name) {
                (*keep, found) = (true, true);
            }
        }
        if !found {
            const MOST: usize = 10;
            let known: Vec<&str> = names.names().iter().take(MOST).map(String::as_str).collect();
            return Err(match (known.is_empty(), names.names().len() > MOST) {
                (true, _) => anyhow!("no face has a {what}: leave --only out"),
                (false, more) => anyhow!(
                    "no face has the {what} {name:?}: there are {}{}",
                    known.join(", "),
                    if more { ", ..." } else { "" }
                ),
            });
        }
    }
    model.retain(|polygon| keep[polygon]);
    Ok(())
}

impl From<MeshFormatArg> for MeshFormat {
    fn from(arg: MeshFormatArg) -> Self {
        match arg {
            MeshFormatArg::Ply => Self::Ply,
            MeshFormatArg::Obj => Self::Obj,
            MeshFormatArg::Stl => Self::Stl,
            MeshFormatArg::Gltf => Self::Gltf,
            MeshFormatArg::Off => Self::Off,
        }
    }
}

/// A file that a mesh names: only one in the mesh's own folder or below it, whatever the mesh says.
fn beside(folder: &Path, file: &str, most: u64) -> Result<Vec<u8>, String> {
    let inside = Path::new(file).components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    if !inside {
        return Err("it lies outside the mesh's folder".to_owned());
    }
    let path = folder.join(file);
    // A pipe would be waited for.
    match fs::metadata(&path) {
        Ok(found) if !found.is_file() => return Err("it is no file".to_owned()),
        Ok(_) => {}
        Err(error) => return Err(format!("it cannot be read ({error})")),
    }
    let bytes = File::open(path).and_then(|file| at_most(file, most));
    match bytes {
        Ok(Some(bytes)) => Ok(bytes),
        Ok(None) => Err(format!("it has more than {most} bytes, which is the limit (--max-memory)")),
        Err(error) => Err(format!("it cannot be read ({error})")),
    }
}

/// The bytes of a file; of too many not more than show that it is too large.
fn bytes(path: &Path, stdin: bool, most: u64) -> anyhow::Result<Vec<u8>> {
    let bytes = if stdin {
        at_most(standard_input().lock(), most).context("cannot be read")?
    } else {
        let found = fs::metadata(path).context("cannot be opened")?;
        if found.is_dir() {
            return Err(anyhow!("is a folder; name a mesh file in it"));
        }
        // Pipes and devices have no length until they are read.
        if found.len() > most {
            None
        } else {
            File::open(path).and_then(|file| at_most(file, most)).context("cannot be read")?
        }
    };
    match bytes {
        None => Err(anyhow!(
            "has more than {most} bytes, which is the limit; split the mesh, or raise the limit (--max-memory)"
        )),
        Some(bytes) if bytes.is_empty() => Err(anyhow!("is empty: there is no mesh in it")),
        Some(bytes) => Ok(bytes),
    }
}

/// All bytes, if they are no more than `most`.
fn at_most(input: impl Read, most: u64) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    input.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= most).then_some(bytes))
}

/// What checking did, one line for each kind of repair.
pub(crate) fn notes(repaired: &RepairReport) -> Vec<String> {
    let r = repaired;
    let notes = [
        (
            r.welded_vertices,
            "vertex welded to another at the same position",
            "vertices welded to others at the same position",
        ),
        (r.isolated_vertices, "vertex left out: no face uses it", "vertices left out: no face uses them"),
        (
            r.degenerate_polygons,
            "polygon left out: fewer than three different corners",
            "polygons left out: fewer than three different corners",
        ),
        (
            r.polygons_triangulated,
            "polygon with more than three corners cut into triangles",
            "polygons with more than three corners cut into triangles",
        ),
        (
            r.fanned_polygons,
            "of these cut as a fan: it crosses itself or has no area",
            "of these cut as fans: they cross themselves or have no area",
        ),
        (r.zero_area_faces, "triangle left out: its area is zero", "triangles left out: their area is zero"),
        (
            r.duplicate_faces,
            "triangle left out: another has the same corners",
            "triangles left out: others have the same corners",
        ),
        (
            r.non_manifold_edges,
            "edge of more than two triangles made a border",
            "edges of more than two triangles made borders",
        ),
        (
            r.inconsistent_edges,
            "edge between triangles wound against each other made a border",
            "edges between triangles wound against each other made borders",
        ),
        (
            r.turned_components,
            "closed component was wound inward and is turned outward",
            "closed components were wound inward and are turned outward",
        ),
    ];
    notes
        .into_iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }))
        .collect()
}
