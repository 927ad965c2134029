//! The table, and its place in a document.

use crate::timing::{Times, digits};

/// Between these lines of the document the table is written.
const BEGIN: &str = "<!-- measured: begin -->";
const END: &str = "<!-- measured: end -->";

/// What a figure must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Target {
    AtMost(f64),
    AtLeast(f64),
    /// Stated to be known only.
    None,
}

impl Target {
    fn shown(self) -> String {
        match self {
            Self::AtMost(bound) => format!("at most {bound}"),
            Self::AtLeast(bound) => format!("at least {bound}"),
            Self::None => String::new(),
        }
    }

    fn verdict(self, figure: f64) -> &'static str {
        let met = match self {
            Self::AtMost(bound) => figure <= bound,
            Self::AtLeast(bound) => figure >= bound,
            Self::None => return "",
        };
        if met { "yes" } else { "**no**" }
    }
}

/// One line of the table.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// What is done, and what was seen.
    pub(crate) work: String,
    pub(crate) ours: String,
    /// Against what, and what was seen.
    pub(crate) against: String,
    pub(crate) theirs: String,
    /// What has the target, and its unit; empty for a ratio.
    pub(crate) figure: Times,
    pub(crate) unit: &'static str,
    pub(crate) target: Target,
}

impl Row {
    /// Ours over theirs, round by round.
    pub(crate) fn ratio(work: &str, ours: &Times, against: &str, theirs: &Times, target: Target) -> Self {
        Self {
            work: work.to_owned(),
            ours: ours.shown(),
            against: against.to_owned(),
            theirs: theirs.shown(),
            figure: ours.over(theirs),
            unit: "",
            target,
        }
    }

    /// A figure of ours that is compared with nothing but its target.
    pub(crate) fn alone(work: &str, ours: String, figure: Times, unit: &'static str, target: Target) -> Self {
        let work = work.to_owned();
        Self { work, ours, against: String::new(), theirs: String::new(), figure, unit, target }
    }

    pub(crate) fn line(&self) -> String {
        let (low, high) = self.figure.range();
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let middle = digits(self.figure.median());
        let figure = if low < high {
            format!("{middle}{unit} ({} to {})", digits(low), digits(high))
        } else {
            format!("{middle}{unit}")
        };
        let target = self.target.shown();
        let target = if target.is_empty() { target } else { format!("{target}{unit}") };
        let verdict = self.target.verdict(self.figure.median());
        let Self { work, ours, against, theirs, .. } = self;
        format!("| {work} | {ours} | {against} | {theirs} | {figure} | {target} | {verdict} |")
    }
}

/// The table of all rows under what was said about the machine.
pub(crate) fn table(head: &str, rows: &[Row]) -> String {
    let mut text = format!("{}\n\n", head.trim());
    text.push_str(
        "| work | ours | against | theirs | figure | target | met |\n|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        text.push_str(&row.line());
        text.push('\n');
    }
    text
}

/// The document with `inner` between its markers.
pub(crate) fn replaced(document: &str, inner: &str) -> Result<String, String> {
    let fault = || format!("the document needs the lines {BEGIN} and {END}, once and in this order");
    let (before, rest) = document.split_once(BEGIN).ok_or_else(fault)?;
    let (old, after) = rest.split_once(END).ok_or_else(fault)?;
    if [before, old, after].iter().any(|part| part.contains(BEGIN) || part.contains(END)) {
        return Err(fault());
    }
    Ok(format!("{before}{BEGIN}\n{}\n{END}{after}", inner.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(figures: &[f64], target: Target) -> String {
        let times = Times(figures.to_vec());
        Row::ratio("wrap", &times, "Open3D", &Times(vec![1.0; figures.len()]), target).line()
    }

    #[test]
    fn only_what_is_between_the_markers_changes() {
        let document = format!("# Head\n\n{BEGIN}\nold\n{END}\n\ntail\n");
        let renewed = replaced(&document, "new\n").expect("there are markers");
        assert_eq!(renewed, format!("# Head\n\n{BEGIN}\nnew\n{END}\n\ntail\n"));
        assert_eq!(replaced(&renewed, "new").expect("there are still markers"), renewed);
    }

    #[test]
    fn missing_swapped_and_repeated_markers_are_errors() {
        for document in [
            "no markers".to_owned(),
            BEGIN.to_owned(),
            format!("{END}\n{BEGIN}"),
            format!("{BEGIN}{END}{BEGIN}{END}"),
        ] {
            assert!(replaced(&document, "new").is_err(), "{document}");
        }
    }

    #[test]
    fn the_median_decides_whether_a_target_is_met() {
        assert!(row(&[0.4, 0.5, 0.9], Target::AtMost(0.5)).ends_with("| at most 0.5 | yes |"));
        assert!(row(&[0.4, 0.6, 0.9], Target::AtMost(0.5)).ends_with("| at most 0.5 | **no** |"));
        assert!(row(&[1.8, 1.6, 1.7], Target::AtLeast(1.7)).ends_with("| at least 1.7 | yes |"));
        assert!(row(&[1.0], Target::None).ends_with("| 1.00 |  |  |"));
        assert!(row(&[f64::NAN], Target::AtMost(1.0)).ends_with("**no** |"));
    }

    #[test]
    fn the_spread_is_shown_where_there_is_one() {
        assert!(row(&[0.4, 0.5, 0.6], Target::None).contains("| 0.500 (0.400 to 0.600) |"));
    }
}
