//! Beyond the paper: which of the wrapped points stay when more were caught than are wanted.
//!
//! The surface is cut into as many regions of equal mass as points are wanted: halves across the widest extent, again
//! and again. Of the points in each region the most central one stays. So every region, and every half of halves, has
//! its share, whatever open borders do to the wrapping; and weights are met.

use std::ops::Range;

use glam::DVec3;

use crate::correct::Corrected;
use crate::density::Density;
use crate::geometry::triangle::longest_side;
use crate::halves::split_by_mass;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::SurfacePoint;

/// A leaf, a face or a component as a mass in one place.
#[derive(Clone, Copy, Debug)]
struct Item {
    position: DVec3,
    /// In points.
    mass: f64,
    /// Which leaf, face or component.
    id: u32,
}

/// The largest mass of a leaf, in points.
const LEAF: f64 = 0.5;

/// No face is halved more often than this.
const DEEPEST: u32 = 24;

/// Halves of a triangle are as slender as it is, so one with a longest side whose square is so many times the area is not
/// halved: regions are bands across it.
const SLENDER: f64 = 32.0;

fn is_slender(mesh: &SurfaceMesh, face: FaceId) -> bool {
    let (_, longest) = longest_side(mesh.triangle(face));
    longest > SLENDER * mesh.face_area(face)
}

/// The leaves of a face: the face, halved across its longest side until no part holds more than [`LEAF`].
#[derive(Clone, Copy, Debug)]
struct Leaves {
    /// The number of its first leaf.
    first: u32,
    /// How often it is halved.
    depth: u32,
}

/// A part of a face, with the barycentric coordinates of a place in it.
#[derive(Clone, Copy)]
struct Part {
    corners: [DVec3; 3],
    weights: [f64; 3],
}

impl Part {
    /// Its half that holds the place, and whether that is the second one.
    fn half(&self) -> (Self, bool) {
        let (from, _) = longest_side(self.corners);
        let (to, apex) = ((from + 1) % 3, (from + 2) % 3);
        let middle = (self.corners[from] + self.corners[to]) * 0.5;
        let second = self.weights[to] > self.weights[from];
        let (kept, gone) = if second { (to, from) } else { (from, to) };
        let part = Self {
            corners: [self.corners[kept], middle, self.corners[apex]],
            weights: [self.weights[kept] - self.weights[gone], 2.0 * self.weights[gone], self.weights[apex]],
        };
        (part, second)
    }
}

/// The corners of the leaves below a part, in the order of their numbers.
fn leaves(corners: [DVec3; 3], depth: u32, emit: &mut impl FnMut([DVec3; 3])) {
    if depth == 0 {
        emit(corners);
        return;
    }
    let (first, _) = longest_side(corners);
    let [from, to, apex] = [0, 1, 2].map(|turn| corners[(first + turn) % 3]);
    let middle = (from + to) * 0.5;
    leaves([from, middle, apex], depth - 1, emit);
    leaves([to, middle, apex], depth - 1, emit);
}

/// Regions of equal mass. Leaves lie in a row along which regions follow each other.
#[derive(Clone, Debug)]
pub(crate) struct Regions {
    of_face: Vec<Leaves>,
    /// For each leaf where in the row it lies; the unit is a region.
    along: Vec<Range<f64>>,
    /// The centroids of the regions.
    centroids: Vec<DVec3>,
}

impl Regions {
    /// Cuts the surface into `n` regions, component after component. O(F log n).
    pub(crate) fn new(mesh: &SurfaceMesh, density: &Density, n: usize) -> Self {
        let scale = n as f64 / density.face_masses(mesh).iter().sum::<f64>();
        let components = mesh.topology().components();
        let mut items: Vec<Vec<Item>> = vec![Vec::new(); components.count];
        let mut of_face = Vec::with_capacity(mesh.face_count());
        let mut corners = Vec::with_capacity(mesh.face_count());
        for face in mesh.topology().face_ids() {
            let mass = density.face_mass(mesh, face) * scale;
            let depth = if is_slender(mesh, face) {
                0
            } else {
                (libm::ceil(libm::log2((mass / LEAF).max(1.0))) as u32).min(DEEPEST)
            };
            of_face.push(Leaves { first: corners.len() as u32, depth });
            let [a, b, c] = mesh.triangle(face);
            let position = a / 3.0 + b / 3.0 + c / 3.0;
            items[components.of_face[face.index()] as usize].push(Item { position, mass, id: face.0 });
            leaves([a, b, c], depth, &mut |leaf| corners.push(leaf));
        }
        // Components are cut from each other first, so that their shares are right to within a point.
        let mut row: Vec<Item> = (0..)
            .zip(&items)
            .map(|(c, items)| {
                let mass: f64 = items.iter().map(|i| i.mass).sum();
                let middle = items.iter().map(|i| i.position / items.len() as f64).sum();
                Item { position: middle, mass, id: c }
            })
            .collect();
        cut(&mut row, 0.0);
        let mut before = 0.0;
        let mut starts = vec![0.0; components.count];
        for component in row {
            starts[component.id as usize] = before;
            before += component.mass;
        }
        for (items, start) in items.iter_mut().zip(&starts) {
            cut(items, *start);
        }
        let last = n - 1;
        let mut along = vec![0.0..0.0; corners.len()];
        // The moments and masses of the regions.
        let mut sums = vec![(DVec3::ZERO, 0.0); n];
        let mut parts = Vec::new();
        for (items, start) in items.iter().zip(starts) {
            let mut before = start;
            for face in items {
                // Large faces are cut from each other before they are cut themselves, so that their shares are right.
                let Leaves { first, depth } = of_face[face.id as usize];
                let mass = face.mass / f64::from(1u32 << depth);
                parts.clear();
                parts.extend((first..first + (1 << depth)).map(|id| {
                    let [a, b, c] = corners[id as usize];
                    Item { position: a / 3.0 + b / 3.0 + c / 3.0, mass, id }
                }));
                cut(&mut parts, before);
                for item in &parts {
                    let range = before..before + item.mass;
                    before = range.end;
                    let (first, end) = ((range.start as usize).min(last), (range.end as usize).min(last) + 1);
                    for (region, sum) in (first..end).zip(&mut sums[first..end]) {
                        let from = range.start.max(region as f64);
                        let shared = (range.end.min(region as f64 + 1.0) - from).max(0.0);
                        let mass = item.mass.max(f64::MIN_POSITIVE);
                        let from = (from - range.start) / mass;
                        sum.0 += band_middle(corners[item.id as usize], from..from + shared / mass) * shared;
                        sum.1 += shared;
                    }
                    along[item.id as usize] = range;
                }
            }
        }
        let middle = |(moment, mass): (DVec3, f64)| if mass > 0.0 { moment / mass } else { moment };
        Self { of_face, along, centroids: sums.into_iter().map(middle).collect() }
    }

    fn region_at(&self, along: f64) -> usize {
        (along as usize).min(self.centroids.len() - 1)
    }

    /// The region of a place.
    fn region_of(&self, mesh: &SurfaceMesh, point: &SurfacePoint) -> usize {
        let Leaves { first, depth } = self.of_face[point.face.index()];
        let mut part = Part { corners: mesh.triangle(point.face), weights: point.barycentric };
        let mut leaf = 0;
        for _ in 0..depth {
            let (half, second) = part.half();
            part = half;
            leaf = 2 * leaf + u32::from(second);
        }
        let range = &self.along[(first + leaf) as usize];
        // The share of the leaf's area nearer to its first corner.
        let along = 1.0 - part.weights[0];
        self.region_at(range.start + (range.end - range.start) * along * along)
    }

    /// Of points caught, in any order, one a region stays, the one nearest to its centroid; a region without points gets
    /// one of the next that has some to spare. All stay if there are not more than regions. The order is kept.
    pub(crate) fn choose(&self, mesh: &SurfaceMesh, caught: Vec<Corrected>) -> Vec<Corrected> {
        const CHUNK: usize = 1 << 13;
        let n = self.centroids.len();
        if caught.len() <= n {
            return caught;
        }
        let mut keyed: Vec<(usize, f64, usize)> = parallel::map_chunks(caught.len(), CHUNK, |range| {
            range
                .map(|i| {
                    let point = &caught[i].sample.point;
                    let region = self.region_of(mesh, point);
                    (region, mesh.locate(point).distance_squared(self.centroids[region]), i)
                })
                .collect::<Vec<_>>()
        })
        .concat();
        keyed.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut stays = vec![false; caught.len()];
        let mut spare = Vec::new();
        let mut taken = 0;
        for (region, _, i) in keyed {
            if taken <= region {
                stays[i] = true;
                taken += 1;
            } else {
                spare.push(i);
            }
        }
        // What the last regions lack those before them give.
        for i in spare.into_iter().rev().take(n - taken) {
            stays[i] = true;
        }
        caught.into_iter().zip(stays).filter(|(_, stays)| *stays).map(|(c, _)| c).collect()
    }
}

/// The centroid of the band of a triangle that lies between these shares of its area, seen from its first corner.
fn band_middle([a, b, c]: [DVec3; 3], shares: Range<f64>) -> DVec3 {
    // Shares grow like the square of the distance.
    let [p, q] = [shares.start, shares.end].map(|s| libm::sqrt(s.clamp(0.0, 1.0)));
    let along = if p + q > 0.0 { 2.0 / 3.0 * (p * p + p * q + q * q) / (p + q) } else { 0.0 };
    a + (0.5 * (b + c) - a) * along
}

/// Puts items in order so that whole regions lie together: the first lies at `start` of the row.
fn cut(items: &mut [Item], start: f64) {
    let mass: f64 = items.iter().map(|i| i.mass).sum();
    if items.len() < 2 || mass <= 1.0 {
        return;
    }
    let border = (start + 0.5 * mass).round();
    let low = items.iter().fold(DVec3::INFINITY, |m, i| m.min(i.position));
    let high = items.iter().fold(DVec3::NEG_INFINITY, |m, i| m.max(i.position));
    let extent = high - low;
    let axis = (1..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best });
    let order = |a: &Item, b: &Item| a.position[axis].total_cmp(&b.position[axis]).then(a.id.cmp(&b.id));
    let middle = split_by_mass(items, order, |item| item.mass, border - start);
    let (below, above) = items.split_at_mut(middle);
    let between = start + below.iter().map(|i| i.mass).sum::<f64>();
    #[cfg(feature = "parallel")]
    {
        /// Below this many items a half is not worth another thread.
        const ALONE: usize = 1 << 12;
        if below.len().max(above.len()) > ALONE {
            rayon::join(|| cut(below, start), || cut(above, between));
            return;
        }
    }
    cut(below, start);
    cut(above, between);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correct::Corrected;
    use crate::ids::StripId;
    use crate::planted;
    use crate::sample::{Origin, Sample, SurfacePoint};
    use crate::shapes::{self, Shape};

    fn caught(mesh: &SurfaceMesh, each: u32) -> Vec<Corrected> {
        // On each face `each` points along the line from its first corner through its middle.
        let point = |face, k: u32| {
            let along = (f64::from(k) + 0.5) / f64::from(each);
            let barycentric = [1.0 - along, 0.5 * along, 0.5 * along];
            let sample = Sample {
                point: SurfacePoint { face, barycentric },
                strip: StripId(0),
                place: glam::DVec2::ZERO,
                origin: Origin::Wrapped,
            };
            Corrected { index: u64::from(face.0 * each + k), copies_removed: 0, sample }
        };
        mesh.topology().face_ids().flat_map(|face| (0..each).map(move |k| point(face, k))).collect()
    }

    #[test]
    fn regions_of_a_square_are_quarters_of_quarters() {
        let mesh = planted::mesh(&shapes::square(16));
        let (low, high) = mesh.bounds();
        let regions = Regions::new(&mesh, &Density::UNIFORM, 16);
        let mut expected: Vec<(i32, i32)> = Vec::new();
        let mut found: Vec<(i32, i32)> = Vec::new();
        for i in 0..4 {
            for j in 0..4 {
                expected.push((250 * i + 125, 250 * j + 125));
            }
        }
        for centroid in &regions.centroids {
            let at = (*centroid - low) / (high - low).max_element() * 1000.0;
            found.push((at.x.round() as i32, at.y.round() as i32));
        }
        found.sort_unstable();
        assert_eq!(found, expected);
    }

    #[test]
    fn one_point_stays_in_each_region_and_every_component_has_its_share() {
        let mut soup = Shape::Cube.generate();
        planted::join(
            &mut soup,
            &planted::moved(Shape::Sphere.generate(), |p| p * 1.3 + DVec3::new(5.0, 0.0, 0.0)),
        );
        planted::join(
            &mut soup,
            &planted::moved(Shape::Tetrahedron.generate(), |p| p * 0.1 - DVec3::new(5.0, 0.0, 0.0)),
        );
        let mesh = planted::mesh(&soup);
        let components = mesh.topology().components();
        let mut areas = vec![0.0; components.count];
        for face in mesh.topology().face_ids() {
            areas[components.of_face[face.index()] as usize] += mesh.face_area(face);
        }
        for n in [1, 2, 10, 77, 500] {
            let regions = Regions::new(&mesh, &Density::UNIFORM, n);
            let chosen = regions.choose(&mesh, caught(&mesh, 900));
            assert_eq!(chosen.len(), n);
            assert!(chosen.windows(2).all(|w| w[0].index < w[1].index), "the order is kept");
            let mut counts = vec![0.0; components.count];
            for c in &chosen {
                counts[components.of_face[c.sample.point.face.index()] as usize] += 1.0;
            }
            for (count, area) in counts.iter().zip(&areas) {
                let due = area / mesh.area() * n as f64;
                assert!((count - due).abs() <= 1.0 + 1e-9, "{n}: {counts:?} of {areas:?}");
            }
        }
    }

    #[test]
    fn regions_without_points_take_from_the_next() {
        let mesh = planted::mesh(&shapes::square(4));
        let mut caught = caught(&mesh, 8);
        caught.retain(|c| c.sample.point.face.index() >= 16);
        let regions = Regions::new(&mesh, &Density::UNIFORM, 100);
        assert_eq!(regions.choose(&mesh, caught.clone()).len(), 100);
        caught.truncate(60);
        assert_eq!(regions.choose(&mesh, caught).len(), 60);
    }
}
