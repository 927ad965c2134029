//! Point files: samples out, anybody's points in.

use std::io::Read;
use std::path::Path;

use anyhow::{Context, anyhow};
use ldwrap::attributes::MeshAttributes;
use ldwrap::io::points::{Attribute, Gatherer, PointFormat, PointWriter, read_points, write_fields};
use ldwrap::pipeline::Block;
use ldwrap::spatial::nearest;
use ldwrap::{Progress, Sample, SurfaceMesh, SurfacePoint};
use serde::Serialize;

use crate::input::Input;
use crate::job::{Carried, Held};
use crate::output::Staged;
use crate::weights::Ground;

/// Points nearer to the surface than this share of the mesh's size are on it: rounding to single precision.
const ON_SURFACE: f64 = 1e-6;

/// What points carry when nothing was asked for, where the format has room.
const USUAL: [Attribute; 6] = [
    Attribute::FlatNormal,
    Attribute::Face,
    Attribute::Barycentric,
    Attribute::Strip,
    Attribute::Place,
    Attribute::Origin,
];

/// What points in a format carry besides their position.
fn attributes(attributes: &MeshAttributes, format: PointFormat, carried: &Carried) -> Vec<Attribute> {
    let all = || {
        let numbers = attributes.numbers.iter().map(|(name, _)| Attribute::Number(name.clone()));
        Attribute::FIXED.into_iter().chain(numbers.filter(is_other))
    };
    match carried {
        // Positions alone.
        Carried::Usual if format == PointFormat::Xyz => Vec::new(),
        Carried::Usual => USUAL.into_iter().filter(|one| one.fits(format)).collect(),
        Carried::Named(names) => names.clone(),
        Carried::All => all().filter(|one| one.is_in(attributes) && one.fits(format)).collect(),
    }
}

/// Whether points can be written block by block.
pub(crate) fn in_blocks(input: &Input, format: PointFormat, carried: &Carried) -> bool {
    let attributes = attributes(&input.attributes, format, carried);
    format.takes_blocks() && !attributes.iter().any(Attribute::is_of_all_points)
}

/// Points on their way to a file.
pub(crate) struct PointFile<'a> {
    format: PointFormat,
    in_blocks: bool,
    gatherer: Gatherer<'a>,
    begin: &'a dyn Fn() -> anyhow::Result<Staged>,
    writer: Option<PointWriter<Staged>>,
}

impl<'a> PointFile<'a> {
    /// A file that `begin` will begin when there are points of `input`.
    pub(crate) fn new(
        input: &'a Input,
        format: PointFormat,
        carried: &Carried,
        begin: &'a dyn Fn() -> anyhow::Result<Staged>,
    ) -> anyhow::Result<Self> {
        let Input { name, mesh, attributes: known, .. } = input;
        let wanted = attributes(known, format, carried);
        let gatherer = Gatherer::new(mesh, known, &wanted)
            .map_err(|error| anyhow!("{name}: {error}: leave it out of --attributes"))?;
        Ok(Self { format, in_blocks: in_blocks(input, format, carried), gatherer, begin, writer: None })
    }

    /// Writes some of `count` points.
    fn write(&mut self, samples: &[Sample], count: usize) -> anyhow::Result<()> {
        let fields = self.gatherer.fields(samples);
        let mut writer = match self.writer.take() {
            Some(writer) => writer,
            None => {
                let staged = (self.begin)()?;
                let failed = staged.failed();
                PointWriter::new(self.format, &fields, count, staged).context(failed)?
            }
        };
        writer.write(&fields).with_context(|| writer.get_ref().failed())?;
        self.writer = Some(writer);
        Ok(())
    }

    /// The file, complete.
    fn finish(self) -> anyhow::Result<Option<Staged>> {
        let Some(writer) = self.writer else { return Ok(None) };
        let failed = writer.get_ref().failed();
        writer.finish().map(Some).context(failed)
    }

    /// The file of all points at once.
    fn whole(self, samples: &[Sample]) -> anyhow::Result<Staged> {
        let mut staged = (self.begin)()?;
        let failed = staged.failed();
        write_fields(self.format, &self.gatherer.fields(samples), &mut staged).context(failed)?;
        Ok(staged)
    }
}

/// Takes the points of a run: writes them as they come and keeps them, as far as that is wanted.
pub(crate) struct Taking<'a> {
    ground: &'a Ground,
    file: Option<PointFile<'a>>,
    kept: Option<Vec<Sample>>,
}

/// What is left of the points of a run.
pub(crate) struct Taken {
    /// Their file, complete.
    pub(crate) file: Option<Staged>,
    /// All of them, if something looks at all; on the ground that they were placed on.
    pub(crate) samples: Option<Vec<Sample>>,
}

impl<'a> Taking<'a> {
    /// Nothing was taken yet; `held` says whether something besides the file looks at all points.
    pub(crate) fn new(ground: &'a Ground, file: Option<PointFile<'a>>, held: Held) -> Self {
        let keeps = held == Held::All || file.as_ref().is_some_and(|file| !file.in_blocks);
        Self { ground, file, kept: keeps.then(Vec::new) }
    }

    /// Takes a block; `progress` hears `write`.
    pub(crate) fn take(&mut self, block: Block<'_>, progress: &dyn Progress) -> anyhow::Result<()> {
        let Block { samples, count } = block;
        if let Some(file) = self.file.as_mut().filter(|file| file.in_blocks) {
            if file.writer.is_none() {
                progress.begin("write", count as u64);
            }
            file.write(&self.ground.lifted(samples), count)?;
            progress.advance(samples.len() as u64);
        }
        if let Some(kept) = &mut self.kept {
            kept.reserve_exact(count - kept.len());
            kept.extend_from_slice(samples);
        }
        Ok(())
    }

    /// All blocks were taken.
    pub(crate) fn finish(self, progress: &dyn Progress) -> anyhow::Result<Taken> {
        let Self { ground, file, kept } = self;
        let file = match (file, &kept) {
            (Some(file), Some(kept)) if !file.in_blocks => {
                progress.begin("write", 1);
                Some(file.whole(&ground.lifted(kept))?)
            }
            (Some(file), _) => file.finish()?,
            (None, _) => None,
        };
        Ok(Taken { file, samples: kept })
    }
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
