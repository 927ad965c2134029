//! Weights of a mesh from a text file, or from what the mesh file has itself.

use std::fs;
use std::path::Path;

use anyhow::{Context, anyhow};
use glam::{DVec3, DVec4, Vec4Swizzles};
use ldwrap::attributes::Places;
use ldwrap::density::Density;
use ldwrap::io::Detail;
use ldwrap::io::points::Attribute;
use ldwrap::pipeline::Request;
use ldwrap::{SurfacePoint, quota};

use crate::args::{WeightsArgs, WeightsBy, WeightsOf};
use crate::input::Input;
use crate::job::Quota;

/// The density that the arguments ask for on the mesh.
pub(crate) fn density(args: &WeightsArgs, input: &Input) -> anyhow::Result<Density> {
    if let Some(by) = &args.weights_by {
        return by_attribute(by, input).with_context(|| input.name.clone());
    }
    let Some(path) = &args.weights else { return Ok(Density::UNIFORM) };
    read(args.weights_of, path, input).with_context(|| path.display().to_string())
}

/// The density and the request that give connected components their quotas.
pub(crate) fn shared_out(
    quota: Quota,
    density: &Density,
    request: Request,
    input: &Input,
) -> anyhow::Result<(Density, Request)> {
    let Input { name, mesh, .. } = input;
    let counts = match (quota, request) {
        (Quota::Each(count), _) => quota::each(mesh, density, count),
        (Quota::AtLeast(least), Request::Count(count)) => {
            quota::at_least(mesh, density, count, least).with_context(|| format!("{name}: --at-least"))?
        }
        (Quota::AtLeast(_), request) => return Err(anyhow!("--at-least needs a count, not {request:?}")),
    };
    let total = counts.iter().try_fold(0usize, |sum, &count| sum.checked_add(count));
    let total = total.filter(|&total| u32::try_from(total).is_ok()).ok_or_else(|| {
        anyhow!("{name}: --per-component asks for more than {} points: take a smaller number", u32::MAX)
    })?;
    let density = density.with_counts(mesh, &counts).with_context(|| name.clone())?;
    Ok((density, Request::Count(total)))
}

/// How much of the mesh file must be read for the weights.
pub(crate) fn detail(args: &WeightsArgs) -> Detail {
    match &args.weights_by {
        None => Detail::Shape,
        Some(WeightsBy::Property(_)) => Detail::Attributes,
        Some(_) => Detail::Textures,
    }
}

/// The values at the corners of the triangles.
fn by_attribute(by: &WeightsBy, input: &Input) -> anyhow::Result<Density> {
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
    let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let weights: Vec<[f64; 3]> = mesh
        .topology()
        .face_ids()
        .map(|face| corners.map(|barycentric| value(&SurfacePoint { face, barycentric })))
        .collect();
    Ok(Density::of_corners(mesh, &weights)?)
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
