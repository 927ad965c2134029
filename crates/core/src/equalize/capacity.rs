//! Weights for which every cell has its wanted mass: a step of Newton's method.
//!
//! The derivative of the cells' masses by the weights is a graph Laplacian over neighbouring cells (Kitagawa, Mérigot,
//! Thibert 2019, DOI 10.4171/JEMS/889).

use glam::DVec3;

use super::laplacian::{Laplacian, Link, Solved, solve};
use super::near::Site;
use super::owners::{Border, Diagram};
use crate::parallel;

/// From where mass may come when weights are fitted.
#[derive(Clone, Copy)]
pub(super) enum Reach {
    /// From some cells away, as long as sites move: to get it from farther away weights would have to slope so that
    /// cells slip off their sites, and every round of moves would have to catch up with that.
    Near,
    /// From far away, at the end; the farther, the more rounds have gone that way.
    Far { round: u32 },
}

impl Reach {
    /// How close the linear system is solved: the masses are not linear anyway.
    fn accuracy(self) -> f64 {
        match self {
            Self::Near => 0.1,
            Self::Far { .. } => 0.03,
        }
    }

    /// The share of the diagonal that is added to it. What has to come from k cells away is met to about
    /// 1 / (1 + k^2 share / 10).
    fn screen(self) -> f64 {
        match self {
            Self::Near => 0.03,
            Self::Far { round } => 3e-4 * libm::exp2(-3.0 * f64::from(round)),
        }
    }
}

/// Changes of the weights that bring the cells' masses to `wanted`, to first order, when the sites move by `moves` at
/// the same time.
///
/// A border between two sites moves by the mean of their moves, so what the moves do to the masses is known before
/// they are made. Without this term large waves of moves and weights answer each other and do not die away.
pub(super) fn weight_steps(
    diagram: &Diagram,
    sites: &[Site],
    moves: &[DVec3],
    wanted: &[f64],
    reach: Reach,
) -> Vec<Solved> {
    let missing = || {
        let mut missing: Vec<f64> = wanted.iter().zip(&diagram.cells).map(|(w, c)| w - c.mass).collect();
        for border in diagram.borders.iter().flatten() {
            let (a, b) = (border.a as usize, border.b as usize);
            let passed =
                border.flow * (moves[a] + moves[b]).dot(sites[b].place.position - sites[a].place.position);
            missing[a] -= passed;
            missing[b] += passed;
        }
        missing
    };
    let laplacian = || {
        let link = |border: &Border| Link { rows: [border.a, border.b], flow: border.flow };
        let pieces = &diagram.borders;
        Laplacian::new(sites.len(), pieces.len(), |piece| pieces[piece].iter().map(link), reach.screen())
    };
    let (missing, laplacian) = parallel::join(missing, laplacian);
    solve(laplacian, missing, reach.accuracy())
}
