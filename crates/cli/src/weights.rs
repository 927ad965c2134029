//! Weights of a mesh from a text file.

use std::fs;
use std::path::Path;

use anyhow::{Context, anyhow};
use ldwrap::density::Density;

use crate::args::{WeightsArgs, WeightsOf};
use crate::input::Input;

/// The density that the arguments ask for on the mesh.
pub(crate) fn density(args: &WeightsArgs, input: &Input) -> anyhow::Result<Density> {
    let Some(path) = &args.weights else { return Ok(Density::UNIFORM) };
    read(args.weights_of, path, input).with_context(|| path.display().to_string())
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
