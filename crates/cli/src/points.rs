//! Point files: samples out, anybody's points in.

use std::io::Read;
use std::path::Path;

use anyhow::{Context, anyhow};
use ldwrap::io::points::{Attribute, PointFormat, PointRow, gather, read_points, write_fields, write_points};
use ldwrap::spatial::nearest;
use ldwrap::{Progress, Sample, SurfaceMesh, SurfacePoint};
use serde::Serialize;

use crate::input::Input;
use crate::job::{Carried, PointOutput};

/// Points nearer to the surface than this share of the mesh's size are on it: rounding to single precision.
const ON_SURFACE: f64 = 1e-6;

/// Samples as a file, with what they carry.
pub(crate) fn bytes(input: &Input, samples: &[Sample], wanted: &PointOutput) -> anyhow::Result<Vec<u8>> {
    let Input { name, mesh, attributes, .. } = input;
    let mut bytes = Vec::new();
    let carried = match &wanted.carried {
        Carried::Usual => {
            let rows: Vec<PointRow> = samples.iter().map(|sample| PointRow::new(mesh, sample)).collect();
            write_points(wanted.format, &rows, &mut bytes)?;
            return Ok(bytes);
        }
        Carried::Named(names) => names.clone(),
        Carried::All => {
            let numbers = attributes.numbers.iter().map(|(name, _)| Attribute::Number(name.clone()));
            let all = Attribute::FIXED.into_iter().chain(numbers.filter(is_other));
            all.filter(|one| one.is_in(attributes) && one.fits(wanted.format)).collect()
        }
    };
    let fields = gather(mesh, attributes, samples, &carried)
        .map_err(|error| anyhow!("{name}: {error}: leave it out of --attributes"))?;
    write_fields(wanted.format, &fields, &mut bytes)?;
    Ok(bytes)
}

/// Whether a number of the file is none of those that attributes are made of.
fn is_other(number: &Attribute) -> bool {
    const KNOWN: [&str; 16] = [
        "nx",
        "ny",
        "nz",
        "red",
        "green",
        "blue",
        "alpha",
        "s",
        "t",
        "u",
        "v",
        "texture_u",
        "texture_v",
        "diffuse_red",
        "diffuse_green",
        "diffuse_blue",
    ];
    !matches!(number, Attribute::Number(name) if KNOWN.contains(&&**name))
}

/// Points from a file, each at the nearest place of a mesh.
pub(crate) struct Placed {
    /// What messages call the file.
    pub(crate) name: String,
    pub(crate) points: Vec<SurfacePoint>,
    pub(crate) off_surface: OffSurface,
}

/// How far points lie from the surface, in units of the mesh.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct OffSurface {
    /// How many are farther away than a millionth of the diagonal of the box around the mesh.
    pub(crate) count: usize,
    /// The largest distance of all points.
    pub(crate) max: f64,
    /// The mean distance of all points.
    pub(crate) mean: f64,
}

impl OffSurface {
    /// How far `all` points are from the surface, in words.
    pub(crate) fn text(&self, all: usize) -> String {
        let Self { count, max, mean } = self;
        match count {
            0 => format!("none of {all}; farthest {max:.1e}"),
            _ => format!(
                "{count} of {all}; farthest {max:.3e}, on average {mean:.3e}: the nearest places are measured"
            ),
        }
    }
}

/// Reads points and finds their nearest places on the mesh; `progress` hears `read points` and `project`.
pub(crate) fn read(
    mesh: &SurfaceMesh,
    path: &Path,
    format: Option<PointFormat>,
    progress: &dyn Progress,
) -> anyhow::Result<Placed> {
    let stdin = path.as_os_str() == "-";
    let name = if stdin { "stdin".to_owned() } else { path.display().to_string() };
    progress.begin("read points", 1);
    let bytes = if stdin {
        let mut bytes = Vec::new();
        std::io::stdin().lock().read_to_end(&mut bytes).map(|_| bytes).context("cannot be read")
    } else if path.is_dir() {
        Err(anyhow!("is a folder; name a point file in it"))
    } else {
        std::fs::read(path).context("cannot be read")
    };
    let bytes = bytes.with_context(|| name.clone())?;
    let format_name = format.map_or_else(|| name.clone(), |format| format!("{name}.{}", format.name()));
    let places = read_points(&bytes, &format_name).with_context(|| name.clone())?;
    progress.begin("project", 1);
    let projected = nearest(mesh, &places);
    let limit = ON_SURFACE * mesh.diagonal();
    let off_surface = OffSurface {
        count: projected.iter().filter(|p| p.distance > limit).count(),
        max: projected.iter().fold(0.0, |max, p| p.distance.max(max)),
        mean: projected.iter().map(|p| p.distance).sum::<f64>() / projected.len() as f64,
    };
    Ok(Placed { name, points: projected.iter().map(|p| p.point).collect(), off_surface })
}

impl Placed {
    /// A line about points that are not on the surface; none if all are.
    pub(crate) fn note(&self) -> Option<String> {
        let OffSurface { count, max, mean } = self.off_surface;
        (count > 0).then(|| {
            format!(
                "note: {}: {count} of {} points lie off the surface (farthest {max:.3e}, on average {mean:.3e}): \
                 the nearest places are measured",
                self.name,
                self.points.len()
            )
        })
    }
}
