//! The paper redone: writes RESULTS.md and its pictures.
//!
//! `cargo run --release -p ldwrap-cli --example results -- MESHES_FOLDER [DOCS_FOLDER]`
//!
//! MESHES_FOLDER should hold `horse.ply` and `fruit-drink-800.obj`; what is not there is skipped and said so.

#[path = "../../src/bound.rs"]
mod bound;
mod fewer;
mod object;
mod parts;
mod picture;
#[path = "../../src/quality.rs"]
mod quality;
mod report;
mod square;
#[path = "../../src/table.rs"]
#[allow(dead_code, reason = "the program prints tables and plots too")]
mod table;
mod text;

use std::path::PathBuf;
use std::time::Instant;

use ldwrap::baseline::Baseline;
use ldwrap::shapes::Shape;
use ldwrap::{Silent, SurfaceMesh};

use object::{Object, Outcome, Way, checked};
use quality::Judge;
use report::Report;

const OURS: &[Way] = &[Way::Walk, Way::Wrap, Way::Equalized];

const SPHERE: Object = Object {
    stem: "figure4-sphere",
    file: "sphere.obj",
    heading: "Figure 4: sphere",
    strips: Some(1),
    paper: &[(192, Some(1.32)), (770, Some(0.95))],
    ways: &[
        Way::Walk,
        Way::Wrap,
        Way::Equalized,
        Way::Baseline(Baseline::SphereHammersley),
        Way::Baseline(Baseline::SphereFibonacci),
        Way::Baseline(Baseline::Random),
    ],
};

const CUP: Object = Object {
    stem: "figure5-cup",
    file: "cup.ply",
    heading: "Figure 5: cup",
    strips: Some(4),
    paper: &[(65, Some(1.73)), (550, Some(0.30))],
    ways: OURS,
};

const DRINK: Object = Object {
    stem: "figure6-drink",
    file: "fruit-drink-800.obj",
    heading: "Figure 6: Fruit Drink, reduced to 776 triangles",
    strips: None,
    paper: &[(56, Some(1.07)), (315, Some(0.22))],
    ways: OURS,
};

const DRINK_LIKE: Object = Object {
    stem: "figure6-drink-like",
    file: "drink.ply",
    heading: "Figure 6: a look-alike with the counts of the paper's mesh",
    strips: Some(32),
    ..DRINK
};

const HORSE: Object = Object {
    stem: "figure7-horse",
    file: "horse.ply",
    heading: "Figure 7: horse",
    strips: Some(28),
    paper: &[(28, Some(1.65)), (57, Some(1.65)), (335, Some(0.25))],
    ways: OURS,
};

/// All methods that work on any mesh.
const ALL: &[Way] = &[
    Way::Walk,
    Way::Wrap,
    Way::Equalized,
    Way::Baseline(Baseline::Random),
    Way::Baseline(Baseline::Hilbert),
    Way::Baseline(Baseline::Poisson),
];

fn main() -> Outcome {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let Some(meshes) = arguments.next() else {
        return Err("usage: results MESHES_FOLDER [DOCS_FOLDER]".into());
    };
    let docs = arguments.next().unwrap_or_else(|| PathBuf::from("docs"));
    let mut report = Report::new(&docs)?;
    report.say(text::HEAD);
    square::write(&mut report)?;
    parts::write(&mut report)?;
    for (object, shape, note) in [
        (SPHERE, Shape::Sphere, text::SPHERE),
        (CUP, Shape::Cup, text::CUP),
        (DRINK_LIKE, Shape::Drink, text::DRINK_LIKE),
    ] {
        let mesh = checked(&shape.generate())?;
        object::write(&mut report, &mesh, &object)?;
        report.say(note);
        report.write()?;
    }
    match object::read(&meshes.join(DRINK.file))? {
        Some(mesh) => {
            object::write(&mut report, &mesh, &DRINK)?;
            report.say(text::DRINK);
        }
        None => report.say("**Skipped: figure 6 on the reduced Fruit Drink, its mesh was not there.**"),
    }
    report.write()?;
    match object::read(&meshes.join(HORSE.file))? {
        Some(mesh) => horse(&mut report, &mesh)?,
        None => report.say("**Skipped: figure 7 and all methods on the horse, its mesh was not there.**"),
    }
    fewer::write(&mut report, &meshes)?;
    report.say(text::WHY);
    report.write()?;
    Ok(())
}

fn horse(report: &mut Report, mesh: &SurfaceMesh) -> Outcome {
    object::write(report, mesh, &HORSE)?;
    report.say(text::HORSE);
    report.write()?;
    report.heading("All methods by all measures, on the horse");
    object::measures(report, mesh, ALL, &[335, 10_000])?;
    report.say(text::ALL);
    let (points, _) = Way::Equalized.place(mesh, 10_000, 0)?;
    let measured = || Judge::new(mesh, points.len(), &Silent).quality(&points, &Silent);
    let begin = Instant::now();
    let once = measured();
    let seconds = begin.elapsed().as_secs_f64();
    let same = once == measured();
    let threads = std::thread::available_parallelism()?;
    let known = [&once.view, &once.view_occluded].map(|view| 100.0 * view.reference_error / view.norms.l2);
    report.say(&format!(
        "Measuring one set of 10,000 points on the horse by every measure, from nothing, took {seconds:.1} s of wall time \
         on {threads} cores that other work shared. Measured twice, all numbers had {} bits. The error of the visible area \
         was {:.0} % of what the views measured on it, {:.0} % with occluders. `ldwrap-cli wrap horse.ply -n 10000 -o p.ply`, then \
         `ldwrap-cli measure horse.ply p.ply`.",
        if same { "the same" } else { "**different**" },
        known[0],
        known[1],
    ));
    Ok(())
}
