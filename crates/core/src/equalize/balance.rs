//! Hierarchical balancing: the surface is split again and again across its widest extent, so that mass and number of points agree
//! on both sides; at the end a region of equal mass is there for every point. Points are dealt out afterwards, by the same splits.

use std::cmp::Ordering;
use std::ops::Range;

use glam::DVec3;

use crate::halves::split_by_mass;
use crate::parallel;

/// A clump of tiles or a point in the space of positions and scaled normals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    /// 0 for a point.
    pub(super) mass: f64,
    pub(super) id: u32,
}

impl Item {
    fn coordinate(&self, axis: u8) -> f64 {
        let axis = usize::from(axis);
        if axis < 3 { self.position[axis] } else { self.normal[axis - 3] }
    }
}

/// A piece of the surface with the number of points that are due there: one, or more where it is a single clump.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// Which clumps, in their new order.
    pub(super) clumps: Range<usize>,
    pub(super) points: u32,
}

/// How the regions came about.
#[derive(Clone, Copy, Debug)]
enum Node {
    /// What lies here was split across an axis: the lower half comes next, the upper one so many nodes farther on.
    Split {
        axis: u8,
        upper: u32,
    },
    Region,
}

/// A patch of the surface in regions that are due the same mass for each of their points.
#[derive(Debug, Default)]
pub(super) struct Balanced {
    pub(super) regions: Vec<Region>,
    nodes: Vec<Node>,
}

/// Below this many clumps or points a piece is not worth another thread.
const ALONE: usize = 1 << 11;

impl Balanced {
    /// Shares out the clumps over so many points: reorders them so that each region's stand together.
    ///
    /// O(clumps log points).
    pub(super) fn new(clumps: &mut [Item], points: usize) -> Self {
        let mut balanced = Self::default();
        balanced.share(clumps, points, 0);
        balanced
    }

    /// `start` says where the clumps stand in the whole.
    fn share(&mut self, clumps: &mut [Item], points: usize, start: usize) {
        if points < 2 || clumps.len() < 2 {
            self.nodes.push(Node::Region);
            self.regions.push(Region { clumps: start..start + clumps.len(), points: points as u32 });
            return;
        }
        let axis = widest_axis(clumps);
        let lower = points / 2;
        let total: f64 = clumps.iter().map(|t| t.mass).sum();
        let wanted = total * lower as f64 / points as f64;
        let cut = split_by_mass(clumps, |a, b| order(a, b, axis), |clump| clump.mass, wanted);
        let (below, above) = clumps.split_at_mut(cut);
        let node = self.nodes.len();
        self.nodes.push(Node::Split { axis, upper: 0 });
        if below.len() > ALONE {
            let mut other = Self::default();
            parallel::join(
                || self.share(below, lower, start),
                || other.share(above, points - lower, start + cut),
            );
            self.nodes[node] = Node::Split { axis, upper: (self.nodes.len() - node) as u32 };
            self.regions.append(&mut other.regions);
            self.nodes.append(&mut other.nodes);
            return;
        }
        self.share(below, lower, start);
        self.nodes[node] = Node::Split { axis, upper: (self.nodes.len() - node) as u32 };
        self.share(above, points - lower, start + cut);
    }

    /// Reorders the points so that those due in each region stand together, region after region. There are as many as
    /// the surface was shared out over.
    ///
    /// O(points log points).
    pub(super) fn deal(&self, points: &mut [Item]) {
        deal(points, &self.nodes);
    }
}

fn deal(points: &mut [Item], nodes: &[Node]) {
    let Some(&Node::Split { axis, upper }) = nodes.first() else { return };
    let lower = points.len() / 2;
    points.select_nth_unstable_by(lower, |a, b| order(a, b, axis));
    let (below, above) = points.split_at_mut(lower);
    let (nodes_below, nodes_above) = (&nodes[1..upper as usize], &nodes[upper as usize..]);
    if below.len() > ALONE {
        parallel::join(|| deal(below, nodes_below), || deal(above, nodes_above));
    } else {
        deal(below, nodes_below);
        deal(above, nodes_above);
    }
}

fn order(a: &Item, b: &Item, axis: u8) -> Ordering {
    a.coordinate(axis).total_cmp(&b.coordinate(axis)).then(a.id.cmp(&b.id))
}

fn widest_axis(items: &[Item]) -> u8 {
    let mut low = [DVec3::INFINITY; 2];
    let mut high = [DVec3::NEG_INFINITY; 2];
    for item in items {
        low = [low[0].min(item.position), low[1].min(item.normal)];
        high = [high[0].max(item.position), high[1].max(item.normal)];
    }
    let extent = |axis: u8| {
        let axis = usize::from(axis);
        (high[axis / 3] - low[axis / 3])[axis % 3]
    };
    (0..6).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clumps of equal mass in a row and as many points, both in disorder: each region has the clump in whose place its point is.
    #[test]
    fn points_are_dealt_out_along_a_row() {
        // Prime to 7.
        const COUNT: u32 = 8 * ALONE as u32 + 5;
        let item = |mass: f64| {
            move |id: u32| {
                let place = f64::from(id * 7 % COUNT);
                Item { position: DVec3::X * place, normal: DVec3::ZERO, mass, id }
            }
        };
        let mut clumps: Vec<Item> = (0..COUNT).map(item(1.0)).collect();
        let mut points: Vec<Item> = (0..COUNT).map(item(0.0)).collect();
        let balanced = Balanced::new(&mut clumps, points.len());
        balanced.deal(&mut points);
        assert_eq!(balanced.regions.len(), points.len());
        for (k, region) in balanced.regions.iter().enumerate() {
            assert_eq!((region.clumps.clone(), region.points), (k..k + 1, 1));
            assert_eq!((clumps[k].position.x, points[k].position.x), (k as f64, k as f64));
        }
    }
}
