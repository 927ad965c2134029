//! `shape`: the built-in shapes.

use anyhow::Context;
use ldwrap::io::mesh_out::write_mesh;

use crate::args::ShapeArgs;
use crate::commands::counted;
use crate::exit::{Failure, Outcome};
use crate::output::{Destination, Outputs, Targets};
use crate::progress::Stages;

/// Runs the command.
pub(crate) fn run(args: &ShapeArgs, quiet: bool) -> Outcome {
    let mut targets = Targets::default();
    let destination = targets.add("--output", &args.output);
    let extension = match (args.format, &destination) {
        (Some(format), _) => format.extension(),
        (None, Destination::Stdout) => {
            return Err(Failure::wrong_use(
                "a mesh on stdout needs a format: add --format ply, obj, stl or off",
            ));
        }
        (None, Destination::File(path)) => path.extension().and_then(|e| e.to_str()).unwrap_or_default(),
    };
    targets.check(None)?;
    let soup = match args.faces {
        Some(faces) => args.shape.generate_about(faces),
        None => args.shape.generate(),
    };
    let name = format!("{}.{extension}", args.shape.name());
    let bytes = match write_mesh(&soup, &name) {
        Ok(bytes) => bytes,
        // The only thing that can be wrong with a built-in shape is the name of its file.
        Err(error) => return Err(Failure::wrong_use(format!("{}: {error}", args.output.display()))),
    };
    let mut outputs = Outputs::default();
    outputs.stage(&destination, &bytes)?;
    let files = outputs.commit().with_context(|| name)?;
    let stages = Stages::new(quiet);
    for file in files {
        stages.say(&format!("wrote {}: {}", file.display(), counted(soup.polygon_count(), "triangle")));
    }
    Ok(())
}
