//! Discrepancy of a point set in the unit square (paper, section 3), before it meets any surface.

use glam::DVec2;

use crate::parallel;

/// The star discrepancy between two bounds, which are equal when it was computed exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StarDiscrepancy {
    /// It is not smaller.
    pub lower: f64,
    /// It is not larger.
    pub upper: f64,
}

impl StarDiscrepancy {
    /// Whether the two bounds are one value.
    pub fn is_exact(&self) -> bool {
        self.lower == self.upper
    }
}

/// Mean squared discrepancies of a point set in the unit square; roots, as shares.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SquareDiscrepancy {
    /// Over the boxes [0, x) x [0, y): the L2 star discrepancy (Warnock 1972).
    pub star: f64,
    /// Over the boxes that hang on each of the four corners, in equal parts: the average squared discrepancy,
    /// which favours no corner (Clement, Kirk, Owen and Pillards, arXiv 2508.04926).
    pub average: f64,
    /// The root mean square of either for as many independent uniform points.
    pub random: f64,
}

/// Up to this many points the star discrepancy is exact; 20,000 points take about a second on one core.
const EXACT: usize = 20_000;

/// Cells along a side of the grid that bounds the star discrepancy of more points.
const GRID: usize = 1024;

/// Rows and columns of pairs that one task adds up.
const CHUNK: usize = 256;

/// The largest |share of points - area| over the boxes [0, x) x [0, y) and their closures. Points lie in [0, 1]^2.
///
/// Exact for up to 20,000 points in O(n^2): only boxes that end at coordinates of points (or at 1) matter
/// (Niederreiter 1972; Bundschuh and Zhu, "A method for exact calculation of the discrepancy of low-dimensional
/// finite point sets", 1993, DOI 10.1007/BF02941091). For more, two bounds from boxes on a grid of 1,024 quantiles
/// a side, in O(n + grid^2): they differ by at most about 1/250. Both bounds are NaN without points.
pub fn star_discrepancy(points: &[DVec2]) -> StarDiscrepancy {
    if points.is_empty() {
        return StarDiscrepancy { lower: f64::NAN, upper: f64::NAN };
    }
    if points.len() <= EXACT {
        let exact = exact_star(points);
        return StarDiscrepancy { lower: exact, upper: exact };
    }
    bounded_star(points, GRID)
}

fn exact_star(points: &[DVec2]) -> f64 {
    let n = points.len();
    let mut by_x = points.to_vec();
    by_x.sort_unstable_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    // For each group of rows the heights below are found by sorting, then kept sorted by insertion.
    let groups = parallel::map_chunks(n, CHUNK, |range| {
        let mut heights: Vec<f64> = by_x[..range.start].iter().map(|p| p.y).collect();
        heights.sort_unstable_by(f64::total_cmp);
        let mut worst = 0.0f64;
        for i in range {
            let y = by_x[i].y;
            heights.insert(heights.partition_point(|&h| h <= y), y);
            // Boxes that hold the first i + 1 points by x: closed ones end at x_i, open ones reach to x_(i+1).
            let from = by_x[i].x;
            let to = by_x.get(i + 1).map_or(1.0, |p| p.x);
            worst = worst.max(over_heights(&heights, from, to, n));
        }
        worst
    });
    // An open box that ends at the first point is empty.
    groups.into_iter().fold(by_x[0].x, f64::max)
}

/// The largest difference over boxes of width `from` (too many points) or `to` (too few), which hold the points
/// of these heights if they are high enough.
fn over_heights(heights: &[f64], from: f64, to: f64, n: usize) -> f64 {
    let unit = 1.0 / n as f64;
    let mut worst = heights.first().copied().unwrap_or(1.0) * to;
    for (k, &height) in heights.iter().enumerate() {
        let share = (k + 1) as f64 * unit;
        let next = if k + 1 < heights.len() { heights[k + 1] } else { 1.0 };
        worst = worst.max(share - from * height).max(to * next - share);
    }
    worst
}

/// Bounds from the boxes whose upper corners lie on a grid of quantiles.
fn bounded_star(points: &[DVec2], grid: usize) -> StarDiscrepancy {
    let n = points.len();
    let lines = |coordinate: fn(&DVec2) -> f64| {
        let mut sorted: Vec<f64> = points.iter().map(coordinate).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let mut lines: Vec<f64> = (1..grid).map(|i| sorted[i * n / grid]).collect();
        lines.insert(0, 0.0);
        lines.push(1.0);
        lines.dedup();
        lines
    };
    let (columns, rows) = (lines(|p| p.x), lines(|p| p.y));
    // For each pair of lines the points strictly below and left of both, and those not above and not right.
    let count = |strict: bool| {
        let slot =
            |lines: &[f64], c: f64| lines.partition_point(|&line| if strict { line <= c } else { line < c });
        let mut below = vec![0u32; columns.len() * rows.len()];
        for p in points {
            let (i, j) = (slot(&columns, p.x), slot(&rows, p.y));
            if i < columns.len() && j < rows.len() {
                below[i * rows.len() + j] += 1;
            }
        }
        for i in 0..columns.len() {
            for j in 0..rows.len() {
                let left = if i > 0 { below[(i - 1) * rows.len() + j] } else { 0 };
                let under = if j > 0 { below[i * rows.len() + j - 1] } else { 0 };
                let both = if i > 0 && j > 0 { below[(i - 1) * rows.len() + j - 1] } else { 0 };
                below[i * rows.len() + j] += left + under - both;
            }
        }
        below
    };
    let (open, closed) = (count(true), count(false));
    let share = |counts: &[u32], i: usize, j: usize| f64::from(counts[i * rows.len() + j]) / n as f64;
    let (mut lower, mut upper) = (0.0f64, 0.0f64);
    for i in 0..columns.len() {
        for j in 0..rows.len() {
            let area = columns[i] * rows[j];
            lower = lower.max(share(&closed, i, j) - area).max(area - share(&open, i, j));
            // A box that ends between these lines and the next holds at least `closed` here and at most `open`
            // there (at 1 also what lies on the rim), and its area lies between the areas of the two.
            if i + 1 < columns.len() && j + 1 < rows.len() {
                let at_rim = i + 2 == columns.len() || j + 2 == rows.len();
                let most = share(if at_rim { &closed } else { &open }, i + 1, j + 1);
                let larger = columns[i + 1] * rows[j + 1];
                upper = upper.max(larger - share(&closed, i, j)).max(most - area);
            }
        }
    }
    StarDiscrepancy { lower, upper: upper.max(lower) }
}

/// The mean squared discrepancies, exactly, in O(n^2): 10,000 points take about 0.3 s on one core. NaN without points.
pub fn square_discrepancy(points: &[DVec2]) -> SquareDiscrepancy {
    let n = points.len() as f64;
    let sums = parallel::map_chunks(points.len(), CHUNK, |range| {
        let mut sums = [0.0; 4];
        for i in range {
            let p = points[i];
            sums[0] += (1.0 - p.x * p.x) * (1.0 - p.y * p.y) / 4.0;
            sums[1] += (1.0 + 2.0 * p.x * (1.0 - p.x)) * (1.0 + 2.0 * p.y * (1.0 - p.y)) / 16.0;
            let (mut star, mut average) = (0.0, 0.0);
            for q in points {
                star += (1.0 - p.x.max(q.x)) * (1.0 - p.y.max(q.y));
                average += (1.0 - (p.x - q.x).abs()) * (1.0 - (p.y - q.y).abs());
            }
            sums[2] += star;
            sums[3] += average / 4.0;
        }
        sums
    });
    let mut total = [0.0; 4];
    for sums in sums {
        for (t, s) in total.iter_mut().zip(sums) {
            *t += s;
        }
    }
    let root = |single: f64, pairs: f64| (1.0 / 9.0 - 2.0 / n * single + pairs / (n * n)).max(0.0).sqrt();
    SquareDiscrepancy {
        star: root(total[0], total[2]),
        average: root(total[1], total[3]),
        // The mean over boxes of v (1 - v) is 1/4 - 1/9, with v the area.
        random: ((1.0 / 4.0 - 1.0 / 9.0) / n).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn random_square(n: usize, seed: u64) -> Vec<DVec2> {
        let mut random = Random::new(seed, 0);
        (0..n).map(|_| DVec2::new(random.unit(), random.unit())).collect()
    }

    /// Every box that can be the worst, straight from the definition.
    fn star_by_definition(points: &[DVec2]) -> f64 {
        let n = points.len() as f64;
        let mut worst = 0.0f64;
        let xs: Vec<f64> = points.iter().map(|p| p.x).chain([1.0]).collect();
        let ys: Vec<f64> = points.iter().map(|p| p.y).chain([1.0]).collect();
        for &x in &xs {
            for &y in &ys {
                let open = points.iter().filter(|p| p.x < x && p.y < y).count() as f64 / n;
                let closed = points.iter().filter(|p| p.x <= x && p.y <= y).count() as f64 / n;
                worst = worst.max(x * y - open).max(closed - x * y);
            }
        }
        worst
    }

    #[test]
    fn one_point_by_hand() {
        // Too few: the open box up to the point's height, 3/4; too many: 1 - 1/2 * 3/4.
        let d = star_discrepancy(&[DVec2::new(0.5, 0.75)]);
        assert_eq!((d.lower, d.upper), (0.75, 0.75));
        // Warnock: 1/9 - 2 (1 - 1/4)(1 - 9/16)/4 + (1/2)(1/4).
        let square = square_discrepancy(&[DVec2::new(0.5, 0.75)]);
        let by_hand = 1.0f64 / 9.0 - 2.0 * 0.75 * 0.4375 / 4.0 + 0.125;
        assert!((square.star - by_hand.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn centred_lattice_has_a_known_star_discrepancy() {
        // m x m points at the cells' middles: the closed box at the last point holds all of (1 - 1/2m)^2.
        for m in [1usize, 2, 5, 16] {
            let points: Vec<DVec2> = (0..m * m)
                .map(|i| DVec2::new((i % m) as f64 + 0.5, (i / m) as f64 + 0.5) / m as f64)
                .collect();
            let last = 1.0 - 0.5 / m as f64;
            let d = star_discrepancy(&points);
            assert!((d.upper - (1.0 - last * last)).abs() < 1e-14, "{m}: {d:?}");
        }
    }

    #[test]
    fn exact_star_is_the_definition() {
        for n in [1, 2, 3, 10, 47] {
            for seed in 0..5 {
                let points = random_square(n, seed);
                let (fast, slow) = (exact_star(&points), star_by_definition(&points));
                assert!((fast - slow).abs() < 1e-14, "{n} {seed}: {fast} {slow}");
            }
        }
        // Shared coordinates and points on the rim.
        let tied: Vec<DVec2> = [(0.0, 0.0), (0.5, 0.0), (0.5, 0.5), (0.5, 0.5), (1.0, 0.25), (0.25, 0.5)]
            .map(DVec2::from)
            .into();
        assert!((exact_star(&tied) - star_by_definition(&tied)).abs() < 1e-14);
    }

    #[test]
    fn the_bounds_hold_the_exact_value() {
        for seed in 0..3 {
            let points = random_square(3000, seed);
            let exact = exact_star(&points);
            let bounds = bounded_star(&points, 256);
            assert!(bounds.lower <= exact && exact <= bounds.upper, "{exact} {bounds:?}");
            assert!(bounds.upper - bounds.lower < 4.0 / 256.0);
        }
    }

    #[test]
    fn average_discrepancy_is_the_mean_over_the_corners() {
        let points = random_square(40, 9);
        let corner = |flip_x: bool, flip_y: bool| {
            let flip = |c: f64, flip: bool| if flip { 1.0 - c } else { c };
            let turned: Vec<DVec2> =
                points.iter().map(|p| DVec2::new(flip(p.x, flip_x), flip(p.y, flip_y))).collect();
            let star = square_discrepancy(&turned).star;
            star * star
        };
        let mean =
            (corner(false, false) + corner(true, false) + corner(false, true) + corner(true, true)) / 4.0;
        let average = square_discrepancy(&points).average;
        assert!((average * average - mean).abs() < 1e-14);
    }

    #[test]
    fn random_points_have_the_random_value() {
        // The mean of the squared discrepancy over 200 sets, whose scatter is below a tenth of it.
        let mut mean = 0.0;
        let mut expected = 0.0;
        for seed in 0..200 {
            let d = square_discrepancy(&random_square(64, seed));
            mean += d.star * d.star / 200.0;
            expected = d.random * d.random;
        }
        assert!((mean / expected - 1.0).abs() < 0.25, "{mean} {expected}");
    }
}
