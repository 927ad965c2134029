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
    /// several the one with the lowest number. Items with `skip(item)` do not count. `None` when none is left.
    pub(super) fn nearest(
        &self,
        p: DVec3,
        squared: impl Fn(usize) -> f64,
        skip: impl Fn(usize) -> bool,
    ) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f64)> = None;
        let mut stack = vec![(0usize, 0.0f64)];
        while let Some((index, bound)) = stack.pop() {
            if best.is_some_and(|(_, distance)| bound > distance) {
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
                        if best.is_none_or(|(i, d)| distance < d || (distance == d && item < i)) {
                            best = Some((item, distance));
                        }
                    }
                }
            }
        }
        best
    }
}
