//! How few points are enough: the errors on the horse and on other meshes, with and without placing for views.

use std::path::Path;

use ldwrap::baseline::Baseline;
use ldwrap::shapes::Shape;

use crate::object::{Outcome, Way, checked, measures, read};
use crate::report::Report;
use crate::text;

const BEST: &[Way] = &[Way::Wrap, Way::Equalized, Way::ForViews];

const RIVALS: &[Way] = &[Way::Equalized, Way::Baseline(Baseline::Hilbert), Way::Baseline(Baseline::Poisson)];

/// The tables.
pub(crate) fn write(report: &mut Report, meshes: &Path) -> Outcome {
    report.heading("Fewer points for the same accuracy");
    if let Some(horse) = read(&meshes.join("horse.ply"))? {
        measures(report, &horse, BEST, &[56, 335, 1_000, 10_000])?;
        report.say(text::FEWER);
    }
    for file in ["stanford-bunny.obj", "fandisk.obj", "suzanne.obj"] {
        if let Some(mesh) = read(&meshes.join(file))? {
            report.say(&format!("**{file}**, {} triangles:", mesh.face_count()));
            measures(report, &mesh, RIVALS, &[56, 335, 1_000])?;
            report.say(&format!(
                "`ldwrap-cli compare {file} -n 56,335,1000 --seeds 5 --methods equalize,hilbert,poisson`"
            ));
        }
    }
    let sphere = checked(&Shape::Sphere.generate())?;
    report.say("**sphere.obj**:");
    measures(report, &sphere, RIVALS, &[56, 335, 1_000])?;
    report.say("`ldwrap-cli compare sphere.obj -n 56,335,1000 --seeds 5 --methods equalize,hilbert,poisson`");
    Ok(())
}
