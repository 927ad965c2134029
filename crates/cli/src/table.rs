//! Methods by measures as a table: means over seeds, with their spread.

use std::fmt::Write;

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use crate::quality::Quality;

/// A column of the table.
pub(crate) struct Measure {
    /// Its name: heading and JSON key.
    pub(crate) name: &'static str,
    /// What is in it.
    pub(crate) value: fn(&Quality) -> f64,
    /// For the plot: the error itself.
    pub(crate) error: Option<fn(&Quality) -> f64>,
}

/// All columns. Those with an error are stated over that of independent random points: 1 is random, less is better.
/// `patch_sup` is a share of all points, `component` a number of points.
pub(crate) const MEASURES: [Measure; 13] = [
    Measure { name: "eta", value: |q| q.energy.eta, error: None },
    Measure { name: "energy", value: |q| q.energy.mc, error: Some(|q| q.energy.discrepancy.sqrt()) },
    Measure { name: "ball", value: |q| q.ball.mc, error: Some(|q| q.ball.l2) },
    Measure { name: "half_space", value: |q| q.half_space.mc, error: Some(|q| q.half_space.l2) },
    Measure { name: "patch", value: |q| q.patch.mc, error: Some(|q| q.patch.l2) },
    Measure { name: "patch_sup", value: |q| q.patch.linf, error: None },
    Measure { name: "view", value: |q| q.view.norms.mc, error: Some(|q| q.view.norms.l2) },
    Measure {
        name: "view_occluded",
        value: |q| q.view_occluded.norms.mc,
        error: Some(|q| q.view_occluded.norms.l2),
    },
    Measure { name: "integration", value: |q| q.integration.mc, error: Some(|q| q.integration.rms) },
    Measure { name: "spacing_min", value: |q| q.spacing.min, error: None },
    Measure { name: "spacing_mean", value: |q| q.spacing.mean, error: None },
    Measure { name: "cover", value: |q| q.spacing.cover, error: None },
    Measure { name: "component", value: |q| q.components.worst, error: None },
];

/// Mean and spread of a number over several seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Summary {
    /// The mean.
    pub(crate) mean: f64,
    /// The standard deviation of one value; none of a single one.
    pub(crate) spread: Option<f64>,
}

impl Summary {
    /// Of at least one value.
    pub(crate) fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        Self { mean, spread: (values.len() > 1).then(|| (squares / (count - 1.0)).sqrt()) }
    }
}

/// One method at one number of points.
#[derive(Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) method: String,
    pub(crate) count: usize,
    /// How many sets the numbers are from.
    pub(crate) sets: usize,
    /// How long a set took to make; not known of points from a file.
    pub(crate) seconds: Option<Summary>,
    #[serde(serialize_with = "by_name")]
    pub(crate) measures: Vec<Summary>,
}

fn by_name<S: Serializer>(measures: &[Summary], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(measures.len()))?;
    for (measure, summary) in MEASURES.iter().zip(measures) {
        map.serialize_entry(measure.name, summary)?;
    }
    map.end()
}

/// The rows as a table that is also Markdown.
pub(crate) fn text(rows: &[Row]) -> String {
    let head = ["n".to_owned(), "method".to_owned()].into_iter();
    let head: Vec<String> = head
        .chain(MEASURES.iter().map(|measure| measure.name.replace('_', " ")))
        .chain(["seconds".to_owned()])
        .collect();
    let body = rows.iter().map(|row| {
        let mut cells = vec![row.count.to_string(), row.method.clone()];
        cells.extend(row.measures.iter().map(|summary| cell(*summary)));
        cells.push(row.seconds.map_or_else(|| "-".to_owned(), |s| format!("{:.3}", s.mean)));
        cells
    });
    let lines: Vec<Vec<String>> = std::iter::once(head).chain(body).collect();
    aligned(&lines, Some(1))
}

/// Lines of as many cells each, the first the heading, as a Markdown table with columns of even width: to the right but
/// for the column `left`.
pub(crate) fn aligned(lines: &[Vec<String>], left: Option<usize>) -> String {
    let columns = lines.first().map_or(0, Vec::len);
    let widths: Vec<usize> =
        (0..columns).map(|c| lines.iter().map(|line| line[c].chars().count()).max().unwrap_or(0)).collect();
    let mut text = String::new();
    for (i, line) in lines.iter().enumerate() {
        for (c, (cell, width)) in line.iter().zip(&widths).enumerate() {
            let _ = if left == Some(c) {
                write!(text, "| {cell:<width$} ")
            } else {
                write!(text, "| {cell:>width$} ")
            };
        }
        text.push_str("|\n");
        if i == 0 {
            for (c, width) in widths.iter().enumerate() {
                let dashes = "-".repeat(width + 1);
                let _ = if left == Some(c) { write!(text, "|{dashes}-") } else { write!(text, "|{dashes}:") };
            }
            text.push_str("|\n");
        }
    }
    text
}

/// A mean with its spread, to three digits behind the point; a dash where there is no number.
pub(crate) fn cell(Summary { mean, spread }: Summary) -> String {
    if !mean.is_finite() {
        return "-".to_owned();
    }
    match spread {
        Some(spread) => format!("{mean:.3} ±{spread:.3}"),
        None => format!("{mean:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_spread_by_hand() {
        assert_eq!(Summary::of(&[2.0, 4.0, 9.0]), Summary { mean: 5.0, spread: Some(13f64.sqrt()) });
        assert_eq!(Summary::of(&[3.0]), Summary { mean: 3.0, spread: None });
    }

    #[test]
    fn a_table_is_rectangular() {
        let row = |method: &str, mean| Row {
            method: method.into(),
            count: 10,
            sets: 1,
            seconds: None,
            measures: vec![Summary { mean, spread: None }; MEASURES.len()],
        };
        let text = text(&[row("a", 0.5), row("longer", f64::NAN)]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 4);
        assert!(lines.iter().all(|line| line.len() == lines[0].len()), "{text}");
        assert!(lines[1].chars().all(|c| "|-:".contains(c)), "{text}");
        assert!(lines[2].contains("0.500") && !lines[3].contains("NaN"), "{text}");
    }
}
