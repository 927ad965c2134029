//! Weights of a mesh from a text file, or from what the mesh file has itself.

use std::borrow::Cow;
use std::fs;
use std::path::Path;

use anyhow::{Context, anyhow};
use glam::{DVec3, DVec4, Vec4Swizzles};
use ldwrap::attributes::Places;
use ldwrap::density::Density;
use ldwrap::io::Detail;
use ldwrap::io::points::Attribute;
use ldwrap::pipeline::{Block, Options, Request, StreamError, Streamed, run_into};
use ldwrap::refine::{Refined, refine};
use ldwrap::{Progress, Sample, SurfaceMesh, SurfacePoint, quota};

use crate::args::{PlacingArgs, WeightsArgs, WeightsBy, WeightsOf};
use crate::input::Input;
use crate::job::{self, Quota};

/// What points are placed on.
pub(crate) struct Ground {
    /// The mesh file, or the part of it that is asked for.
    pub(crate) input: Input,
    /// Its faces cut as finely as the weights vary.
    refined: Option<Refined>,
    /// How densely, on the fine faces.
    pub(crate) density: Density,
    /// How many points, and all else that decides them.
    pub(crate) options: Options,
    /// How many each connected component is to get, if that was asked for.
    counts: Option<Vec<usize>>,
}

impl Ground {
    /// The mesh that the stages run on.
    pub(crate) fn mesh(&self) -> &SurfaceMesh {
        self.refined.as_ref().map_or(&self.input.mesh, Refined::mesh)
    }

    /// Runs all stages and hands the points on to `take`; see [`run_into`].
    pub(crate) fn run_into(
        &self,
        progress: &dyn Progress,
        mut take: impl FnMut(Block<'_>) -> anyhow::Result<()>,
    ) -> anyhow::Result<Streamed> {
        /// Points in a block of those that are there at once.
        const BLOCK: usize = 1 << 17;
        let (mesh, density, options) = (self.mesh(), &self.density, &self.options);
        let name = || self.input.name.clone();
        match &self.counts {
            Some(counts) => {
                let run = quota::run(mesh, density, counts, options, progress).with_context(name)?;
                let (streamed, samples) = run.split();
                let count = samples.len();
                samples.chunks(BLOCK).try_for_each(|samples| take(Block { samples, count }))?;
                Ok(streamed)
            }
            None => run_into(mesh, density, options, progress, take).map_err(|error| match error {
                StreamError::Options(error) => anyhow::Error::from(error).context(name()),
                StreamError::Sink(error) => error,
            }),
        }
    }

    /// Samples on it as samples on the mesh of the input.
    pub(crate) fn lifted<'a>(&self, samples: &'a [Sample]) -> Cow<'a, [Sample]> {
        match &self.refined {
            Some(refined) => {
                let lift = |s: &Sample| Sample { point: refined.lift(&s.point), ..*s };
                Cow::Owned(samples.iter().map(lift).collect())
            }
            None => Cow::Borrowed(samples),
        }
    }
}

/// Finds the part of the mesh that is asked for, its weights, and what each connected component is to get.
pub(crate) fn prepare(args: &PlacingArgs, input: Input, options: Options) -> anyhow::Result<Ground> {
    let input = match args.inside {
        Some(inside) => input.clip(inside)?,
        None => input,
    };
    let WeightsArgs { weights, weights_of, weights_by } = &args.weights;
    let (refined, density) = match (weights_by, weights) {
        (Some(by), _) => by_attribute(by, &input).with_context(|| input.name.clone())?,
        (None, Some(path)) => {
            (None, read(*weights_of, path, &input).with_context(|| path.display().to_string())?)
        }
        (None, None) => (None, Density::UNIFORM),
    };
    let mut ground = Ground { input, refined, density, options, counts: None };
    if let Some(quota) = job::quota(args) {
        let counts = counts(quota, &ground)?;
        ground.options.request = Request::Count(counts.iter().sum());
        ground.counts = Some(counts);
    }
    Ok(ground)
}

/// How many points each connected component is to get.
fn counts(quota: Quota, ground: &Ground) -> anyhow::Result<Vec<usize>> {
    let (name, mesh, density) = (&ground.input.name, ground.mesh(), &ground.density);
    let counts = match (quota, ground.options.request) {
        (Quota::Each(count), _) => quota::each(mesh, density, count),
        (Quota::AtLeast(least), Request::Count(count)) => {
            quota::at_least(mesh, density, count, least).with_context(|| format!("{name}: --at-least"))?
        }
        (Quota::AtLeast(_), _) => return Err(anyhow!("{name}: --at-least needs a number of points")),
    };
    // Checked here, because sums must not overflow.
    if counts.iter().fold(0_u64, |sum, &count| sum.saturating_add(count as u64)) > u64::from(u32::MAX) {
        return Err(anyhow!("{name}: more than {} points are asked for: take a smaller number", u32::MAX));
    }
    Ok(counts)
}

/// How much of the mesh file must be read for the weights.
pub(crate) fn detail(args: &WeightsArgs) -> Detail {
    match &args.weights_by {
        None => Detail::Shape,
        Some(WeightsBy::Property(_)) => Detail::Attributes,
        Some(_) => Detail::Textures,
    }
}

/// At most so many more faces are made so that weights can follow a texture.
const MORE_FACES: usize = 1 << 18;

/// Where weights are known, in texels of a texture.
const RESOLUTION: f64 = 1.5;

/// The values at the corners of the triangles; under a texture, of finer ones.
fn by_attribute(by: &WeightsBy, input: &Input) -> anyhow::Result<(Option<Refined>, Density)> {
    let Input { mesh, attributes, .. } = input;
    let places = Places::new(mesh, attributes);
    let color = |point: &SurfacePoint| places.color(mesh, point).unwrap_or(DVec4::ZERO);
    let needed = match by {
        WeightsBy::Property(name) => Attribute::Number(name.clone()),
        _ => Attribute::Color,
    };
    if !needed.is_in(attributes) {
        return Err(anyhow!("the mesh has no {needed}: leave --weights-by out, or give --weights FILE"));
    }
    let number = match by {
        WeightsBy::Property(name) => attributes.numbers.iter().position(|(known, _)| known == name),
        _ => None,
    };
    let value = |point: &SurfacePoint| match by {
        WeightsBy::Red => color(point).x,
        WeightsBy::Green => color(point).y,
        WeightsBy::Blue => color(point).z,
        // ITU-R BT.709, whose primaries sRGB has.
        WeightsBy::Luminance => color(point).xyz().dot(DVec3::new(0.2126, 0.7152, 0.0722)),
        WeightsBy::Alpha => color(point).w,
        WeightsBy::Property(_) => number.and_then(|n| places.number(mesh, point, n)).unwrap_or(0.0),
    };
    let has_texture = attributes.materials.iter().flatten().any(|material| material.texture.is_some());
    let texels = |face| if has_texture { places.texels(mesh, face) } else { None };
    let refined = refine(mesh, texels, RESOLUTION, mesh.face_count().saturating_add(MORE_FACES));
    let density = refined.density(value)?;
    Ok((Some(refined), density))
}

fn read(of: Option<WeightsOf>, path: &Path, input: &Input) -> anyhow::Result<Density> {
    let text = fs::read_to_string(path).context("cannot be read as text")?;
    let weights = parse(&text)?;
    let Input { soup, mesh, .. } = input;
    let (vertices, faces) = (soup.positions.len(), soup.polygon_count());
    let of = match of {
        Some(of) => of,
        None if vertices == faces && weights.len() == vertices => {
            return Err(anyhow!(
                "{}: the mesh file has {vertices} vertices and as many faces: add --weights-of vertices or faces",
                "what the weights belong to cannot be told"
            ));
        }
        None if weights.len() == vertices => WeightsOf::Vertices,
        None if weights.len() == faces => WeightsOf::Faces,
        None => {
            return Err(anyhow!(
                "{} weights: there must be one for each of the {vertices} vertices or of the {faces} faces of {}",
                weights.len(),
                input.name
            ));
        }
    };
    Ok(match of {
        WeightsOf::Vertices => Density::of_positions(mesh, soup, &weights)?,
        WeightsOf::Faces => Density::of_polygons(mesh, soup, &weights)?,
    })
}

/// A number a line, the last of those separated by commas, semicolons or blanks; empty lines and those that start with
/// `#` do not count, and the first may name the columns.
fn parse(text: &str) -> anyhow::Result<Vec<f64>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.lines().map(str::trim).enumerate();
    let mut weights = Vec::new();
    for (place, (line, content)) in
        lines.filter(|(_, content)| !content.is_empty() && !content.starts_with('#')).enumerate()
    {
        let last = content.rsplit([',', ';', ' ', '\t']).next().unwrap_or(content);
        match last.parse::<f64>() {
            Ok(weight) => weights.push(weight),
            Err(_) if place == 0 => {}
            Err(_) => return Err(anyhow!("line {}: '{last}' is not a number", line + 1)),
        }
    }
    Ok(weights)
}

#[cfg(test)]
mod tests {
    use super::parse;

    #[test]
    fn numbers_in_lines() {
        let text = "\u{feff}vertex,weight\r\n# a note\r\n0,1.5\r\n\r\n1, 2\r\n2;3e-1\n";
        assert_eq!(parse(text).unwrap(), [1.5, 2.0, 0.3]);
        assert_eq!(parse("1\n2\n").unwrap(), [1.0, 2.0]);
        assert_eq!(parse("").unwrap(), [0.0; 0]);
        assert_eq!(parse("1\nx\n").unwrap_err().to_string(), "line 2: 'x' is not a number");
    }
}
