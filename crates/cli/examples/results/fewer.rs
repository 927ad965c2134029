//! How few points are enough: the errors on the horse and on other meshes, with and without placing for views.

use std::path::Path;

use ldwrap::SurfaceMesh;
use ldwrap::baseline::Baseline;
use ldwrap::shapes::Shape;

use crate::object::{Means, Outcome, Way, checked, measures, read};
use crate::report::Report;
use crate::table::MEASURES;
use crate::text;

const BEST: &[Way] = &[
    Way::Wrap,
    Way::Equalized,
    Way::ForViews,
    Way::Baseline(Baseline::Hilbert),
    Way::Baseline(Baseline::Poisson),
];

const RIVALS: &[Way] = &[Way::Equalized, Way::Baseline(Baseline::Hilbert), Way::Baseline(Baseline::Poisson)];

const COUNTS: &[usize] = &[56, 335, 1_000, 10_000];

/// The tables.
pub(crate) fn write(report: &mut Report, meshes: &Path) -> Outcome {
    report.heading("Fewer points for the same accuracy");
    let mut all = Vec::new();
    if let Some(horse) = read(&meshes.join("horse.ply"))? {
        all.push(measures(report, &horse, BEST, COUNTS)?);
        report.say(text::FEWER);
    }
    for file in ["stanford-bunny.obj", "fandisk.obj", "suzanne.obj"] {
        if let Some(mesh) = read(&meshes.join(file))? {
            report.say(&format!("**{file}**, {} triangles:", mesh.face_count()));
            all.push(rivals(report, file, &mesh)?);
        }
    }
    let sphere = checked(&Shape::Sphere.generate())?;
    report.say("**sphere.obj**:");
    all.push(rivals(report, "sphere.obj", &sphere)?);
    together(report, &all);
    Ok(())
}

fn rivals(report: &mut Report, file: &str, mesh: &SurfaceMesh) -> Outcome<Vec<Means>> {
    let means = measures(report, mesh, RIVALS, COUNTS)?;
    report.say(&format!(
        "`ldwrap-cli compare {file} -n 56,335,1000 --seeds 5 --methods equalize,hilbert,poisson` and the same with `-n 10000 --seeds 1`."
    ));
    Ok(means)
}

/// Errors that are in units of those of random points.
const ERRORS: [&str; 5] = ["ball", "half_space", "view", "view_occluded", "integration"];

/// Geometric means over the meshes.
fn together(report: &mut Report, all: &[Vec<Means>]) {
    report.say(&format!("**Geometric means** over the {} meshes above:", all.len()));
    let mut rows = Vec::new();
    for &count in COUNTS {
        for &way in RIVALS {
            let of = |name: &str| {
                let at = MEASURES.iter().position(|measure| measure.name == name)?;
                let one =
                    |m: &Vec<Means>| Some(m.iter().find(|m| m.way == way && m.count == count)?.values[at]);
                let values: Vec<f64> = all.iter().filter_map(one).collect();
                Some(libm::exp(
                    values.iter().map(|&value| libm::log(value)).sum::<f64>() / values.len() as f64,
                ))
            };
            let mut row = vec![way.name().to_owned(), count.to_string()];
            row.extend(ERRORS.map(|name| of(name).map_or("-".to_owned(), |mean| format!("{mean:.3}"))));
            rows.push(row);
        }
    }
    let names = ERRORS.map(|name| name.replace('_', " "));
    let mut head = vec!["", "n"];
    head.extend(names.iter().map(String::as_str));
    report.table(&head, &rows);
}
