//! Beyond the paper: an order of points in which the first k are well spread, for every k.
//!
//! The energy discrepancy of the first k and one more point x is least where the mean distance from x to the k exceeds the
//! mean distance from x to the whole surface most. Taking that point next, again and again, is the greedy order; of n
//! points the mean distance to all of them stands for that to the surface, weights included.

use glam::DVec3;

use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::SurfacePoint;

/// At most so many points are ordered together; more are cut into parts of the surface whose orders are interleaved.
const TOGETHER: usize = 1 << 13;

/// The indices of the points in an order in which the first k are well spread for every k. The energy error of the first k is
/// about 1.2 times that of a set made for k (horse, equalized).
///
/// Cost: O(n min(n, 8192)) time, O(n) memory.
pub fn progressive(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> Vec<usize> {
    let mut items: Vec<(DVec3, usize)> =
        points.iter().enumerate().map(|(i, p)| (mesh.locate(p), i)).collect();
    let mut parts = Vec::new();
    cut(&mut items, &mut parts);
    let orders = parallel::map(parts.len(), |p| greedy(parts[p]));
    let count = parts.len() as u64;
    let mut merged: Vec<(f64, u64, usize)> = Vec::with_capacity(points.len());
    for (p, (part, order)) in (0u64..).zip(parts.iter().zip(orders)) {
        let size = part.len() as f64;
        // Parts take turns in the order of the reversed bits, so that near parts do not follow each other.
        let turn = if count > 1 { p.reverse_bits() >> (64 - count.next_power_of_two().ilog2()) } else { 0 };
        merged.extend((0..).zip(order).map(|(k, own)| ((f64::from(k) + 0.5) / size, turn, part[own].1)));
    }
    merged.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    merged.into_iter().map(|(_, _, i)| i).collect()
}

/// Cuts points into halves across the widest extent until the parts are small.
fn cut<'a>(items: &'a mut [(DVec3, usize)], parts: &mut Vec<&'a [(DVec3, usize)]>) {
    if items.len() <= TOGETHER {
        parts.push(items);
        return;
    }
    let low = items.iter().fold(DVec3::INFINITY, |m, i| m.min(i.0));
    let high = items.iter().fold(DVec3::NEG_INFINITY, |m, i| m.max(i.0));
    let extent = high - low;
    let axis = (1..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    let (below, above) = items.split_at_mut(middle);
    cut(below, parts);
    cut(above, parts);
}

/// The greedy order of a few points.
fn greedy(part: &[(DVec3, usize)]) -> Vec<usize> {
    struct Free {
        position: DVec3,
        place: usize,
        /// The mean distance to all points of the part.
        mean: f64,
        /// The sum of distances to the points taken.
        sum: f64,
    }
    let count = part.len() as f64;
    let mut free: Vec<Free> = part
        .iter()
        .enumerate()
        .map(|(place, &(position, _))| {
            let mean = part.iter().map(|(other, _)| position.distance(*other)).sum::<f64>() / count;
            Free { position, place, mean, sum: 0.0 }
        })
        .collect();
    let mut order = Vec::with_capacity(part.len());
    while !free.is_empty() {
        // Before the first point all sums are zero: it is the most central.
        let scale = 1.0 / (order.len() as f64 + 1.0);
        let best = |best: (f64, usize), (i, f): (usize, &Free)| {
            let gain = f.sum * scale - f.mean;
            // Ties go to the first place, wherever removals have put it.
            let wins = gain > best.0 || (gain == best.0 && f.place < free[best.1].place);
            if wins { (gain, i) } else { best }
        };
        let (_, next) = free.iter().enumerate().fold((f64::NEG_INFINITY, 0), best);
        let taken = free.swap_remove(next);
        for f in &mut free {
            f.sum += f.position.distance(taken.position);
        }
        order.push(taken.place);
    }
    order
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Silent;
    use crate::baseline::Baseline;
    use crate::ids::FaceId;
    use crate::measure::{EnergyOptions, EnergyPlanes};
    use crate::planted;
    use crate::shapes::Shape;

    #[test]
    fn seven_points_on_a_line_by_hand() {
        let mesh = planted::mesh(&Shape::Square.generate());
        // Places 0 to 6 on the first corner's side: the middle first, then an end; the other end follows.
        let points: Vec<SurfacePoint> = (0..7)
            .map(|i| {
                let along = f64::from(i) / 6.0;
                SurfacePoint { face: FaceId(0), barycentric: [1.0 - along, along, 0.0] }
            })
            .collect();
        let order = progressive(&mesh, &points);
        assert_eq!(order[0], 3);
        // Beside the middle, x gains |x - 3| / 2 less the mean distance to all: most at 0 and 6 or 1 and 5.
        assert_eq!(order[1] + order[2], 6, "{order:?}");
    }

    #[test]
    fn prefixes_have_at_most_twice_the_error_of_sets_made_for_them() {
        let mesh = planted::mesh(&Shape::Sphere.generate());
        let made = |n: usize| Baseline::SphereFibonacci.place(&mesh, n, 1).unwrap();
        let n = 1024;
        let points = made(n);
        let order = progressive(&mesh, &points);
        for k in [n / 8, n / 6, n / 4, n / 3, n / 2, 3 * n / 4] {
            let prefix: Vec<_> = order[..k].iter().map(|&i| points[i]).collect();
            let planes = EnergyPlanes::new(&mesh, k, &EnergyOptions::default(), &Silent);
            let error = |points: &[SurfacePoint]| planes.measure(&mesh, points, &Silent).mc;
            let (ours, best) = (error(&prefix), error(&made(k)));
            assert!(ours < 1.5 * best, "{k}: {ours} against {best}");
        }
    }

    #[test]
    fn many_points_are_ordered_in_parts() {
        let mesh = planted::mesh(&Shape::Sphere.generate());
        let n = 20_000;
        let points = Baseline::SphereFibonacci.place(&mesh, n, 1).unwrap();
        let order = progressive(&mesh, &points);
        let half = |k: usize| order[..k].iter().filter(|&&i| mesh.locate(&points[i]).x > 0.0).count();
        for k in [100, 1000, 5000, 12_345] {
            assert!(half(k).abs_diff(k / 2) <= 2 + k / 100, "{} of {k}", half(k));
        }
        let mut sorted = order;
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..n));
    }

    proptest! {
        #[test]
        fn every_point_comes_once(n in 0..200usize, seed: u64) {
            let mesh = planted::mesh(&Shape::Cube.generate());
            let points = Baseline::Random.place(&mesh, n, seed).unwrap();
            let mut order = progressive(&mesh, &points);
            order.sort_unstable();
            prop_assert!(order.into_iter().eq(0..n));
        }
    }
}
