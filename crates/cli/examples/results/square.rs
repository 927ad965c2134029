//! Figure 1: points on the unit square.

use std::fmt::Write;

use glam::DVec2;
use ldwrap::baseline::{square_lattice, square_random};
use ldwrap::measure::plane::{square_discrepancy, star_discrepancy};
use ldwrap::sequence::Sequence;

use crate::report::Report;

/// A 16 x 16 lattice has as many points as a power of the Hammersley set's base.
const SIDE: u32 = 16;
const COUNT: u64 = (SIDE * SIDE) as u64;

pub(crate) fn write(report: &mut Report) -> std::io::Result<()> {
    let hammersley = Sequence::Hammersley { base: 2 };
    let sets: [(&str, Vec<DVec2>); 3] = [
        ("(a) lattice", square_lattice(SIDE)),
        ("(b) random", square_random(COUNT as usize, 0)),
        ("(c) Hammersley", (0..COUNT).map(|i| hammersley.point(i, COUNT)).collect()),
    ];
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 960 340\" width=\"960\" height=\"340\" \
         font-family=\"sans-serif\" font-size=\"15\">\n<rect width=\"960\" height=\"340\" fill=\"white\"/>\n",
    );
    let (mut rows, mut stars) = (Vec::new(), Vec::new());
    for (k, (name, points)) in sets.iter().enumerate() {
        let left = 20.0 + 320.0 * k as f64;
        let star = star_discrepancy(points);
        let square = square_discrepancy(points);
        let _ = writeln!(
            svg,
            "<rect x=\"{left}\" y=\"10\" width=\"280\" height=\"280\" fill=\"#eef3f9\" stroke=\"#1b1b1b\"/>\
             <text x=\"{}\" y=\"318\" text-anchor=\"middle\">{name}: star discrepancy {:.4}</text>",
            left + 140.0,
            star.upper
        );
        for p in points {
            let _ = write!(
                svg,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.8\" fill=\"#1b1b1b\"/>",
                left + 280.0 * p.x,
                290.0 - 280.0 * p.y
            );
        }
        stars.push(star.upper);
        rows.push(vec![
            (*name).to_owned(),
            format!("{:.4}", star.upper),
            format!("{:.4}", square.star),
            format!("{:.4}", square.average),
            format!("{:.3}", square.star / square.random),
            format!("{:.3}", square.average / square.random),
        ]);
    }
    svg.push_str("\n</svg>\n");
    report.heading("Figure 1: points on the square");
    let picture = report.image("figure1-square.svg", svg.as_bytes())?;
    report.say(&format!("![256 points on the unit square, three ways]({picture})"));
    report.table(
        &[
            "256 points",
            "star (sup over boxes at one corner)",
            "L2 star",
            "L2, average of four corners",
            "L2 star / random",
            "L2 average / random",
        ],
        &rows,
    );
    report.say(&format!(
        "`ldwrap-cli plane -n {COUNT}`. Exact (`ldwrap::measure::plane`), as shares. The last two columns are over the root mean \
         square of independent points. A box that ends just before a column of the lattice misses all of it, so the lattice \
         has {:.1} times the star discrepancy of the Hammersley points; this set of random points has {:.1} times: the \
         paper's reason for figure 1.",
        stars[0] / stars[2],
        stars[1] / stars[2],
    ));
    Ok(())
}
