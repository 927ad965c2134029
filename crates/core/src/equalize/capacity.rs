//! Weights for which every cell has its wanted mass: a step of Newton's method.
//!
//! The derivative of the cells' masses by the weights is a graph Laplacian over neighbouring cells (Kitagawa, Mérigot,
//! Thibert 2019, DOI 10.4171/JEMS/889).

use glam::DVec3;

use super::laplacian::{Laplacian, Link, solve};
use super::near::Site;
use super::owners::Diagram;

/// From where mass may come when weights are fitted.
#[derive(Clone, Copy)]
pub(super) enum Reach {
    /// From some cells away, as long as sites move: to get it from farther away weights would have to slope so that
    /// cells slip off their sites, and every round of moves would have to catch up with that.
    Near,
    /// From wherever it is, at the end.
    Far,
}

impl Reach {
    /// How close the linear system is solved: the masses are not linear anyway.
    fn accuracy(self) -> f64 {
        match self {
            Self::Near => 0.1,
            Self::Far => 0.03,
        }
    }

    /// The share of the diagonal that is added to it. What has to come from k cells away is met to about
    /// 1 / (1 + k^2 share / 10).
    fn screen(self) -> f64 {
        match self {
            Self::Near => 0.03,
            Self::Far => 3e-4,
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
) -> Vec<f64> {
    let mut missing: Vec<f64> = wanted.iter().zip(&diagram.cells).map(|(w, c)| w - c.mass).collect();
    for border in &diagram.borders {
        let (a, b) = (border.a as usize, border.b as usize);
        let passed =
            border.flow * (moves[a] + moves[b]).dot(sites[b].place.position - sites[a].place.position);
        missing[a] -= passed;
        missing[b] += passed;
    }
    let links = diagram.borders.iter().map(|border| Link { rows: [border.a, border.b], flow: border.flow });
    let laplacian = Laplacian::new(sites.len(), links, reach.screen());
    solve(laplacian, missing, reach.accuracy())
}
