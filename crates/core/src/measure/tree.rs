//! Items with a box and a weight in a binary tree: sums over balls and nearest items, with any number of equal
//! items.

use glam::DVec3;

/// Most items of a leaf.
const LEAF: usize = 8;

/// The box around some items.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    fn join(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Squared distance from `p` to the nearest place of the box.
    #[inline]
    fn nearest_squared(&self, p: DVec3) -> f64 {
        p.clamp(self.low, self.high).distance_squared(p)
    }

    /// Squared distance from `p` to the farthest corner.
    #[inline]
    fn farthest_squared(&self, p: DVec3) -> f64 {
        (p - self.low).abs().max((self.high - p).abs()).length_squared()
    }
}

/// A node; its left child follows it, its items are `start..end` of the tree's order.
#[derive(Clone, Debug)]
struct Node {
    bounds: Bounds,
    weight: f64,
    start: u32,
    end: u32,
    /// The right child of an inner node.
    right: Option<u32>,
}

/// The tree. Building takes O(m log m), a query O(log m) plus what lies on the rim of the ball.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Tree {
    /// A tree of points of weight 1.
    pub(super) fn of_points(points: &[DVec3]) -> Self {
        Self::build(points.len(), |i| Bounds { low: points[i], high: points[i] }, |_| 1.0)
    }

    /// A tree of triangles weighted by their areas.
    pub(super) fn of_triangles(count: usize, corners: impl Fn(usize) -> [DVec3; 3], areas: &[f64]) -> Self {
        let bounds = |i| {
            let [a, b, c] = corners(i);
            Bounds { low: a.min(b).min(c), high: a.max(b).max(c) }
        };
        Self::build(count, bounds, |i| areas[i])
    }

    fn build(count: usize, bounds: impl Fn(usize) -> Bounds, weight: impl Fn(usize) -> f64) -> Self {
        let boxes: Vec<Bounds> = (0..count).map(bounds).collect();
        let mut order: Vec<u32> = (0..count as u32).collect();
        let mut nodes: Vec<Node> = Vec::new();
        // Depth first, left child first: (items, the parent that waits for its right child).
        let mut stack = vec![(0, count, None::<usize>)];
        while let Some((start, end, parent)) = stack.pop() {
            let node = nodes.len();
            if let Some(parent) = parent {
                nodes[parent].right = Some(node as u32);
            }
            let items = &mut order[start..end];
            let around = items.iter().fold(Bounds::EMPTY, |all, &i| all.join(boxes[i as usize]));
            let total = items.iter().map(|&i| weight(i as usize)).sum();
            nodes.push(Node {
                bounds: around,
                weight: total,
                start: start as u32,
                end: end as u32,
                right: None,
            });
            if items.len() <= LEAF {
                continue;
            }
            // Twice the centres; their widest extent parts the items best.
            let centre = |i: u32| boxes[i as usize].low + boxes[i as usize].high;
            let (low, high) = items.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &i| {
                (l.min(centre(i)), h.max(centre(i)))
            });
            let axis = (high - low).max_position();
            let middle = items.len() / 2;
            items.select_nth_unstable_by(middle, |&i, &j| {
                centre(i)[axis].total_cmp(&centre(j)[axis]).then(i.cmp(&j))
            });
            stack.push((start + middle, end, Some(node)));
            stack.push((start, start + middle, None));
        }
        Self { nodes, order }
    }

    /// The weight inside the ball: whole nodes where their box lies inside, `part(item)` where the ball may cut an
    /// item.
    pub(super) fn weight_in_ball(&self, centre: DVec3, radius: f64, part: impl Fn(usize) -> f64) -> f64 {
        let squared = radius * radius;
        let mut sum = 0.0;
        let mut stack = vec![0usize];
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index];
            if node.bounds.nearest_squared(centre) > squared {
                continue;
            }
            if node.bounds.farthest_squared(centre) <= squared {
                sum += node.weight;
                continue;
            }
            match node.right {
                Some(right) => {
                    stack.push(right as usize);
                    stack.push(index + 1);
                }
                None => {
                    for &item in &self.order[node.start as usize..node.end as usize] {
                        sum += part(item as usize);
                    }
                }
            }
        }
        sum
    }

    /// The item with the smallest `squared(item)`, a squared distance from `p`, and that distance squared; of
    /// several the first that the tree comes to, always the same. Items with `skip(item)` do not count. `None` when
    /// none is left.
    pub(super) fn nearest(
        &self,
        p: DVec3,
        squared: impl Fn(usize) -> f64,
        skip: impl Fn(usize) -> bool,
    ) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f64)> = None;
        let mut stack = vec![(0usize, 0.0f64)];
        while let Some((index, bound)) = stack.pop() {
            // Not nearer is not enough: among many points at one place all would be visited.
            if best.is_some_and(|(_, distance)| bound >= distance) {
                continue;
            }
            let node = &self.nodes[index];
            match node.right {
                Some(right) => {
                    let right = right as usize;
                    let near = self.nodes[index + 1].bounds.nearest_squared(p);
                    let far = self.nodes[right].bounds.nearest_squared(p);
                    if near <= far {
                        stack.push((right, far));
                        stack.push((index + 1, near));
                    } else {
                        stack.push((index + 1, near));
                        stack.push((right, far));
                    }
                }
                None => {
                    for &item in &self.order[node.start as usize..node.end as usize] {
                        let item = item as usize;
                        if skip(item) {
                            continue;
                        }
                        let distance = squared(item);
                        if best.is_none_or(|(_, d)| distance < d) {
                            best = Some((item, distance));
                        }
                    }
                }
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::random::Random;

    #[test]
    fn the_nearest_is_what_a_full_search_finds() {
        let mut random = Random::new(4, 2);
        // Few different coordinates: many ties, many points at one place.
        let mut place = || DVec3::new(random.unit(), random.unit(), random.unit()).map(|x| (4.0 * x).floor());
        let points: Vec<DVec3> = (0..200).map(|_| place()).collect();
        let tree = Tree::of_points(&points);
        for _ in 0..50 {
            let p = place() * 1.1;
            for skipped in [None, Some(17), Some(180)] {
                let squared = |i: usize| points[i].distance_squared(p);
                let found = tree.nearest(p, squared, |i| Some(i) == skipped).expect("points are left");
                let all = (0..200).filter(|&i| Some(i) != skipped).map(squared).fold(f64::INFINITY, f64::min);
                assert_eq!((squared(found.0), found.1), (all, all));
                assert_ne!(Some(found.0), skipped);
            }
        }
        assert!(Tree::of_points(&[]).nearest(DVec3::ZERO, |_| 0.0, |_| false).is_none());
    }

    #[test]
    fn points_at_one_place_are_not_all_visited() {
        let points = vec![DVec3::splat(0.3); 10_000];
        let tree = Tree::of_points(&points);
        for p in [DVec3::ZERO, points[0]] {
            let visited = Cell::new(0);
            let squared = |i: usize| {
                visited.set(visited.get() + 1);
                points[i].distance_squared(p)
            };
            assert!(tree.nearest(p, squared, |i| i == 5).is_some());
            assert!(visited.get() <= 2 * LEAF, "{}", visited.get());
        }
    }
}
