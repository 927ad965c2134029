//! `summary.csv`: a row for each mesh, in the order in which the meshes were given.

use std::fmt::Write;

use serde::Serialize;

use crate::args::Shard;
use crate::batch::Task;
use crate::batch::record::{Ended, Record};

/// A row. The columns are documented in docs/BATCH.md and stay as they are; the time comes last.
#[derive(Default, Serialize)]
struct Row<'a> {
    input: String,
    output: Option<&'a str>,
    status: &'static str,
    vertices: Option<usize>,
    triangles: Option<usize>,
    components: Option<usize>,
    area: Option<f64>,
    strips: Option<usize>,
    points: Option<usize>,
    d_m: Option<f64>,
    irregularity_bound: Option<f64>,
    irregularity_refined: Option<f64>,
    irregularity_exact: Option<f64>,
    irregularity_undecided: Option<f64>,
    eta: Option<f64>,
    repairs: String,
    error_kind: Option<&'static str>,
    error: Option<&'a str>,
    seconds: Option<f64>,
}

/// The names of the columns, which a table without rows has too.
const COLUMNS: [&str; 19] = [
    "input",
    "output",
    "status",
    "vertices",
    "triangles",
    "components",
    "area",
    "strips",
    "points",
    "d_m",
    "irregularity_bound",
    "irregularity_refined",
    "irregularity_exact",
    "irregularity_undecided",
    "eta",
    "repairs",
    "error_kind",
    "error",
    "seconds",
];

/// The name of the file.
pub(crate) fn name(shard: Option<Shard>) -> String {
    shard.map_or_else(|| "summary.csv".to_owned(), |shard| format!("summary.{shard}.csv"))
}

/// The table as CSV. A mesh without a record is `pending`.
pub(crate) fn csv<'a>(rows: impl Iterator<Item = (&'a Task, Option<&'a Record>)>) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    for (task, record) in rows {
        writer.serialize(row(task, record))?;
    }
    Ok(writer.into_inner()?)
}

/// Seconds to the millisecond.
fn milliseconds(seconds: f64) -> f64 {
    (seconds * 1e3).round() / 1e3
}

fn row<'a>(task: &'a Task, record: Option<&'a Record>) -> Row<'a> {
    let row = Row {
        input: task.input.display().to_string(),
        output: task.output.as_deref().ok(),
        status: "pending",
        seconds: record.map(|record| milliseconds(record.seconds.values().sum())),
        ..Row::default()
    };
    match record.map(|record| &record.result) {
        Some(Ended::Done(made)) => Row {
            status: "done",
            vertices: Some(made.vertices),
            triangles: Some(made.triangles),
            components: Some(made.components),
            area: made.area,
            strips: Some(made.strips),
            points: Some(made.points),
            d_m: made.d_m,
            irregularity_bound: made.irregularity.bound,
            irregularity_refined: made.irregularity.refined,
            irregularity_exact: made.irregularity.exact,
            irregularity_undecided: made.irregularity.undecided,
            eta: made.eta,
            repairs: made.repairs.iter().fold(String::new(), |mut text, (name, count)| {
                let _ = write!(text, "{}{name}={count}", if text.is_empty() { "" } else { " " });
                text
            }),
            ..row
        },
        Some(Ended::Failed(trouble)) => Row {
            status: "failed",
            error_kind: Some(trouble.kind.name()),
            error: Some(&trouble.message),
            ..row
        },
        None => row,
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::batch::record::tests::{done, failed};

    #[test]
    fn a_row_by_hand() {
        let task = |name: &str| Task { input: PathBuf::from(name), output: Ok("a,b.ply".to_owned()) };
        let tasks = [task("in/a,b.obj"), task("x"), task("y")];
        let records = [done("a,b.ply", "x", 1), failed("a,b.ply", "x", 2)];
        let rows = tasks.iter().zip([Some(&records[0]), Some(&records[1]), None]);
        let text = String::from_utf8(csv(rows).unwrap()).unwrap();
        let expected = "\
            \"in/a,b.obj\",\"a,b.ply\",done,4,4,1,0.3333333333333333,2,5,0.25,0.30000000000000004,1e-300,,0.0,,welded_vertices=2,,,0.125\n\
            x,\"a,b.ply\",failed,,,,,,,,,,,,,,format,\"no \"\"mesh\"\",\nat all\",0.125\n\
            y,\"a,b.ply\",pending,,,,,,,,,,,,,,,,\n";
        assert_eq!(text, format!("{}\n{expected}", COLUMNS.join(",")));
    }

    #[test]
    fn columns_have_the_names_of_the_fields() {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.serialize(Row::default()).unwrap();
        let text = String::from_utf8(writer.into_inner().unwrap()).unwrap();
        assert_eq!(text.lines().next(), Some(&*COLUMNS.join(",")));
    }
}
