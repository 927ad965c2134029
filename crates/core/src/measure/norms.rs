//! The norms of the discrepancy function (paper, eq. 1 to 3) over a finite set of sample figures.

/// One sample figure: which part of the area and which part of the points it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Shares {
    /// Its area over the total area, 0 to 1.
    pub area: f64,
    /// Its number of points over the number of all points, 0 to 1.
    pub points: f64,
}

/// The norms of (share of points - share of area) over a set of sample figures: eq. 1 to 3 of the paper divided
/// by the number of points, the integral over the figures being their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Norms {
    /// The largest absolute difference, 0 to 1.
    pub linf: f64,
    /// The mean absolute difference.
    pub l1: f64,
    /// The root of the mean squared difference.
    pub l2: f64,
    /// `l2` over the root mean square that as many independent uniform points have over the same figures,
    /// sqrt(mean v (1 - v) / n) with v the share of area: 1 is as good as random, smaller is better.
    pub mc: f64,
}

impl Norms {
    /// The norms over these figures, for `count` points. All NaN without figures or without points; `mc` is NaN
    /// when every figure is empty or the whole surface.
    pub fn over(figures: &[Shares], count: usize) -> Self {
        if figures.is_empty() || count == 0 {
            return Self { linf: f64::NAN, l1: f64::NAN, l2: f64::NAN, mc: f64::NAN };
        }
        let (mut linf, mut l1, mut squared, mut variance) = (0.0f64, 0.0, 0.0, 0.0);
        for figure in figures {
            let difference = (figure.points - figure.area).abs();
            linf = linf.max(difference);
            l1 += difference;
            squared += difference * difference;
            variance += figure.area * (1.0 - figure.area);
        }
        let figures = figures.len() as f64;
        let random = (variance / figures / count as f64).sqrt();
        let l2 = (squared / figures).sqrt();
        let mc = if random > 0.0 { l2 / random } else { f64::NAN };
        Self { linf, l1: l1 / figures, l2, mc }
    }
}

/// The figure with the largest difference, the first of several; `None` when no difference is a number.
pub(super) fn worst<F>(shares: &[Shares], figures: impl Iterator<Item = F>) -> Option<F> {
    let mut worst: Option<(f64, F)> = None;
    for (share, figure) in shares.iter().zip(figures) {
        let difference = (share.points - share.area).abs();
        // A comparison with NaN is false.
        if difference > worst.as_ref().map_or(-1.0, |(largest, _)| *largest) {
            worst = Some((difference, figure));
        }
    }
    worst.map(|(_, figure)| figure)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_figures_by_hand() {
        let figures = [Shares { area: 0.5, points: 0.75 }, Shares { area: 0.25, points: 0.125 }];
        let norms = Norms::over(&figures, 8);
        assert_eq!(norms.linf, 0.25);
        assert_eq!(norms.l1, 0.1875);
        assert_eq!(norms.l2, (0.078125f64 / 2.0).sqrt());
        let random = ((0.25f64 + 0.1875) / 2.0 / 8.0).sqrt();
        assert!((norms.mc - norms.l2 / random).abs() < 1e-15);
    }

    #[test]
    fn no_points_give_no_number() {
        assert!(Norms::over(&[Shares { area: 0.5, points: 0.0 }], 0).l2.is_nan());
        assert!(Norms::over(&[], 5).mc.is_nan());
        assert!(Norms::over(&[Shares { area: 1.0, points: 1.0 }], 5).mc.is_nan());
    }
}
