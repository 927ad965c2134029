//! The plot of errors against the number of points, one panel a measure, both axes logarithmic.

use std::fmt::Write;

use libm::{ceil, floor, log10, pow};

/// One measure.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    /// What is measured.
    pub(crate) title: String,
    /// One line a method. The methods are the same, in the same order, in every panel.
    pub(crate) lines: Vec<Line>,
    /// The (number of points, error) at which the slopes start: what random points have.
    pub(crate) anchor: Option<(f64, f64)>,
}

/// One method.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    /// Its name.
    pub(crate) name: String,
    /// (number of points, error), ascending; what is not above 0 is left out.
    pub(crate) points: Vec<(f64, f64)>,
}

/// Colours that people with any colour vision can tell apart (Okabe and Ito 2008), then greys.
const COLOURS: [&str; 9] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f", "#b0a000"];

/// The slopes that are drawn: independent points, and the best that any points reach on a surface.
const SLOPES: [(f64, &str); 2] = [(-0.5, "n^-1/2"), (-0.75, "n^-3/4")];

const WIDTH: f64 = 340.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 56.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 40.0;
const COLUMNS: usize = 4;
const LEGEND_ROW: f64 = 18.0;

/// The plot as an SVG picture.
pub(crate) fn error_plot(heading: &str, panels: &[Panel]) -> String {
    let columns = panels.len().clamp(1, COLUMNS);
    let rows = panels.len().div_ceil(columns);
    let names: Vec<&str> =
        panels.first().map_or(Vec::new(), |p| p.lines.iter().map(|l| l.name.as_str()).collect());
    let head = 34.0;
    let legend = LEGEND_ROW * names.len().div_ceil(columns * 2) as f64 + 16.0;
    let (width, height) = (WIDTH * columns as f64, head + HEIGHT * rows as f64 + legend);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <title>{0}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{1}\" y=\"22\" text-anchor=\"middle\" font-size=\"15\">{0}</text>\n",
        escape(heading),
        width / 2.0
    );
    for (i, panel) in panels.iter().enumerate() {
        let (x, y) = (WIDTH * (i % columns) as f64, head + HEIGHT * (i / columns) as f64);
        let _ = writeln!(svg, "<g transform=\"translate({x} {y})\">");
        draw(&mut svg, panel);
        svg.push_str("</g>\n");
    }
    let cell = width / (columns * 2) as f64;
    for (i, name) in names.iter().enumerate() {
        let x = LEFT / 2.0 + cell * (i % (columns * 2)) as f64;
        let y = head + HEIGHT * rows as f64 + LEGEND_ROW * (i / (columns * 2)) as f64 + 12.0;
        let colour = colour(i);
        let _ = writeln!(
            svg,
            "<path d=\"M{x} {y}h22\" stroke=\"{colour}\" stroke-width=\"2\"/><circle cx=\"{}\" cy=\"{y}\" r=\"3\" \
             fill=\"{colour}\"/><text x=\"{}\" y=\"{}\">{}</text>",
            x + 11.0,
            x + 28.0,
            y + 4.0,
            escape(name)
        );
    }
    svg.push_str("</svg>\n");
    svg
}

fn colour(line: usize) -> &'static str {
    COLOURS[line % COLOURS.len()]
}

/// A logarithmic axis from `low` to `high` (powers of ten of them) along `from` to `to` in the picture.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn around(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (low, high) =
            values.map(log10).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let margin = if low < high { 0.06 * (high - low) } else { 0.5 };
        if low <= high {
            Self { low: low - margin, high: high + margin, from, to }
        } else {
            Self { low: 0.0, high: 1.0, from, to }
        }
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (log10(value) - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Values to mark: 1, 2, 5 times powers of ten, or the powers alone on a long axis.
    fn ticks(&self) -> Vec<f64> {
        let steps: &[f64] = if self.high - self.low > 2.5 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let mut ticks = Vec::new();
        for power in floor(self.low) as i32..=ceil(self.high) as i32 {
            for step in steps {
                // Written out and read back, so that 0.3 is not 0.30000000000000004.
                let tick: f64 = format!("{step}e{power}").parse().unwrap_or(f64::NAN);
                if (self.low..=self.high).contains(&log10(tick)) {
                    ticks.push(tick);
                }
            }
        }
        ticks
    }
}

fn has_logarithms((n, error): &(f64, f64)) -> bool {
    let positive = |x: f64| x > 0.0 && x.is_finite();
    positive(*n) && positive(*error)
}

fn draw(svg: &mut String, panel: &Panel) {
    let shown: Vec<Vec<(f64, f64)>> =
        panel.lines.iter().map(|line| line.points.iter().copied().filter(has_logarithms).collect()).collect();
    let anchor = panel.anchor.filter(has_logarithms);
    let all = || shown.iter().flatten().copied().chain(anchor);
    let x = Axis::around(all().map(|p| p.0), LEFT, WIDTH - RIGHT);
    let y = Axis::around(all().map(|p| p.1), HEIGHT - BOTTOM, TOP);
    for tick in x.ticks() {
        let _ = writeln!(
            svg,
            "<path d=\"M{0:.1} {TOP}V{1}\" stroke=\"#e4e4e4\"/><text x=\"{0:.1}\" y=\"{2}\" text-anchor=\"middle\">{tick}</text>",
            x.at(tick),
            y.from,
            y.from + 14.0
        );
    }
    for tick in y.ticks() {
        let label = if tick < 1e-3 { format!("{tick:e}") } else { tick.to_string() };
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {0:.1}H{1}\" stroke=\"#e4e4e4\"/><text x=\"{2}\" y=\"{3:.1}\" text-anchor=\"end\">{label}</text>",
            y.at(tick),
            x.to,
            LEFT - 5.0,
            y.at(tick) + 4.0
        );
    }
    let _ = writeln!(
        svg,
        "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#888\"/>\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">points n</text>\
         <text x=\"{LEFT}\" y=\"{}\" font-weight=\"bold\">{}</text>",
        x.to - LEFT,
        y.from - TOP,
        (LEFT + x.to) / 2.0,
        HEIGHT - 10.0,
        TOP - 8.0,
        escape(&panel.title)
    );
    if let Some(anchor) = anchor {
        slopes(svg, anchor, &x, &y);
    }
    for (i, points) in shown.iter().enumerate() {
        let colour = colour(i);
        let corners: Vec<String> =
            points.iter().map(|p| format!("{:.1},{:.1}", x.at(p.0), y.at(p.1))).collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>",
            corners.join(" ")
        );
        for (p, corner) in points.iter().zip(&corners) {
            let (cx, cy) = corner.split_once(',').unwrap_or_default();
            let _ = writeln!(
                svg,
                "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"3\" fill=\"{colour}\"><title>{}: {} at n = {}</title></circle>",
                escape(&panel.lines[i].name),
                p.1,
                p.0
            );
        }
    }
}

/// The guide lines, cut off at the lower end of the panel.
fn slopes(svg: &mut String, (n, error): (f64, f64), x: &Axis, y: &Axis) {
    let last = pow(10.0, x.high);
    for (slope, label) in SLOPES {
        let lowest = pow(10.0, y.low);
        let end = last.min(n * pow(lowest / error, 1.0 / slope));
        if end <= n {
            continue;
        }
        let (ex, ey) = (x.at(end), y.at(error * pow(end / n, slope)));
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {:.1}L{ex:.1} {ey:.1}\" stroke=\"#999\" stroke-dasharray=\"5 4\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#666\" font-size=\"10\" paint-order=\"stroke\" \
             stroke=\"white\" stroke-width=\"3\">{label}</text>",
            x.at(n),
            y.at(error),
            ex - 4.0,
            ey - 5.0
        );
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(points: &[(f64, f64)]) -> Panel {
        Panel {
            title: "a <b> & \"c\"".into(),
            lines: vec![Line { name: "one".into(), points: points.to_vec() }],
            anchor: points.first().copied(),
        }
    }

    #[test]
    fn equal_ratios_are_equal_distances() {
        let axis = Axis::around([1.0, 100.0].into_iter(), 0.0, 10.0);
        assert!((axis.at(10.0) - 5.0).abs() < 1e-12);
        assert!((axis.at(10.0) - axis.at(1.0) - (axis.at(100.0) - axis.at(10.0))).abs() < 1e-12);
        assert_eq!(axis.ticks(), [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
    }

    #[test]
    fn a_line_of_slope_one_half_lies_on_its_guide() {
        let svg = error_plot("x", &[panel(&[(100.0, 0.1), (400.0, 0.05)])]);
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let line = svg.split("<polyline points=\"").nth(1).and_then(|s| s.split('"').next()).expect("a line");
        let corners: Vec<(f64, f64)> = line
            .split(' ')
            .map(|c| c.split_once(',').map(|(x, y)| (number(x), number(y))).expect("a pair"))
            .collect();
        let guide =
            svg.split("stroke=\"#999\"").next().and_then(|s| s.rsplit("d=\"M").next()).expect("a guide");
        let ends: Vec<f64> = guide
            .trim_end_matches(['"', ' '])
            .split(['L', ' '])
            .filter(|w| !w.is_empty())
            .map(number)
            .collect();
        let slope = (corners[1].1 - corners[0].1) / (corners[1].0 - corners[0].0);
        let guided = (ends[3] - ends[1]) / (ends[2] - ends[0]);
        assert!((slope - guided).abs() < 0.01, "{slope} {guided}");
    }

    #[test]
    fn text_is_escaped_and_what_has_no_logarithm_is_left_out() {
        let svg = error_plot("x", &[panel(&[(10.0, 0.0), (20.0, f64::NAN), (30.0, 0.5)])]);
        assert!(svg.contains("a &lt;b&gt; &amp; &quot;c&quot;"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 2, "one point and the legend");
    }

    #[test]
    fn nothing_to_show_is_still_a_picture() {
        for panels in [vec![], vec![panel(&[])]] {
            let svg = error_plot("x", &panels);
            assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
        }
    }
}
