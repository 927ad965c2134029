//! The field of all cells and all points: the slope of the energy discrepancy where a point stands.
//!
//! The energy's slope at a point is the sum of the unit vectors from everywhere on the surface, less those from all other
//! points. A cell and its point have the same mass, so of a group of them little is left from afar: a dipole and a
//! quadrupole. Groups in a tree: Barnes and Hut 1986, DOI 10.1038/324446a0.

use std::ops::Range;

use glam::{DMat3, DVec3};

use super::quadrature::{Quadrature, outer, trace};
use super::sources::{Marks, Moments, Sources, Sum};

/// Bodies in a group of the finest level. They follow each other as the balanced regions do, so they lie together.
const LEAF: usize = 8;

/// Groups that make one of the next level.
const BRANCHES: usize = 2;

/// Wider leaves, as those that belong to parts far apart, are looked at from each of their points: single precision would
/// not tell from one place where all of them stand.
const WIDE: f64 = 1e3;

/// How closely is looked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    /// A group is seen as a whole if it is farther away than this many times its radius, and its radius or that of the leaf
    /// that looks, whichever is larger.
    pub(super) far: f64,
    /// From within this many times its own width a cell is seen as what it consists of.
    pub(super) near: f64,
}

/// A cell with the point that stands in it.
struct Body {
    centroid: DVec3,
    covariance: DMat3,
    /// The cell from afar.
    moments: Moments,
    /// The root mean square distance from the centroid.
    width: f64,
    point: DVec3,
}

/// Bodies that lie together: masses of cells less those of points.
struct Group {
    centre: DVec3,
    radius: f64,
    dipole: DVec3,
    quadrupole: DMat3,
}

/// All cells and points. Lengths are in one unit, in which the points are 1 apart in the mean.
pub(super) struct Field {
    far: f64,
    bodies: Vec<Body>,
    quadratures: Vec<Quadrature>,
    /// Groups of [`LEAF`] bodies; then of [`BRANCHES`] groups each, until there is one.
    levels: Vec<Vec<Group>>,
}

impl Field {
    /// Of cells by their quadratures, and their points.
    pub(super) fn new(quadratures: Vec<Quadrature>, points: &[DVec3], sight: Sight) -> Self {
        let body = |(quadrature, &point): (&Quadrature, &DVec3)| {
            let covariance = quadrature.covariance();
            let width = trace(&covariance).sqrt();
            let moments = Moments::of_cell(&covariance, sight.near * width);
            Body { centroid: quadrature.centroid, covariance, moments, width, point }
        };
        let bodies: Vec<Body> = quadratures.iter().zip(points).map(body).collect();
        let mut levels = Vec::new();
        let mut size = LEAF;
        loop {
            levels.push(bodies.chunks(size).map(Group::new).collect::<Vec<_>>());
            if size >= bodies.len() {
                break;
            }
            size *= BRANCHES;
        }
        Self { far: sight.far, bodies, quadratures, levels }
    }

    pub(super) fn point(&self, i: usize) -> DVec3 {
        self.bodies[i].point
    }

    /// How many leaves there are.
    pub(super) fn leaves(&self) -> usize {
        self.levels[0].len()
    }

    fn of_leaf(&self, leaf: usize) -> Range<usize> {
        leaf * LEAF..self.bodies.len().min((leaf + 1) * LEAF)
    }

    /// Moves a point.
    pub(super) fn put(&mut self, i: usize, to: DVec3) {
        let from = std::mem::replace(&mut self.bodies[i].point, to);
        let mut size = LEAF;
        for level in &mut self.levels {
            let group = &mut level[i / size];
            group.dipole += from - to;
            group.quadrupole += outer(from - group.centre) - outer(to - group.centre);
            size *= BRANCHES;
        }
    }

    /// Where the points of a leaf go, one after the other: `step` hears which, where it is and the slope there.
    pub(super) fn moves<T>(
        &self,
        leaf: usize,
        step: impl Fn(usize, DVec3, DVec3) -> Option<(DVec3, T)>,
    ) -> Vec<(usize, DVec3, T)> {
        let own = self.of_leaf(leaf);
        let group = &self.levels[0][leaf];
        let mut surroundings = Surroundings::of(self, leaf, group.centre);
        let mut moved: Vec<(usize, DVec3, T)> = Vec::with_capacity(LEAF);
        for i in own.clone() {
            let from = self.bodies[i].point;
            if group.radius > WIDE {
                surroundings = Surroundings::of(self, leaf, from);
                moved.iter().for_each(|(i, to, _)| surroundings.put(i - own.start, *to));
            }
            if let Some((to, what)) = step(i, from, surroundings.slope(from)) {
                surroundings.put(i - own.start, to);
                moved.push((i, to, what));
            }
        }
        moved
    }
}

/// What a leaf sees.
struct Surroundings<'a> {
    field: &'a Field,
    /// From where.
    origin: DVec3,
    groups: Sources,
    /// Cells of bodies; those of the leaf come first.
    cells: Sources,
    points: Sources,
    /// Which bodies they are.
    bodies: Vec<u32>,
    marks: Marks,
}

impl<'a> Surroundings<'a> {
    fn of(field: &'a Field, leaf: usize, origin: DVec3) -> Self {
        let mut it = Self {
            field,
            origin,
            groups: Sources::default(),
            cells: Sources::default(),
            points: Sources::default(),
            bodies: Vec::new(),
            marks: Marks::default(),
        };
        it.add_leaf(leaf);
        it.add(field.levels.len() - 1, 0, leaf);
        it
    }

    fn add_leaf(&mut self, leaf: usize) {
        for i in self.field.of_leaf(leaf) {
            let body = &self.field.bodies[i];
            self.bodies.push(i as u32);
            self.cells.push(body.centroid - self.origin, &body.moments);
            self.points.push(body.point - self.origin, &Moments::POINT);
        }
    }

    /// Adds a group but for a leaf of it: as a whole, or what it consists of.
    fn add(&mut self, level: usize, group: usize, but: usize) {
        let from = &self.field.levels[0][but];
        let it = &self.field.levels[level][group];
        let far = self.field.far * it.radius + it.radius.max(from.radius);
        if it.centre.distance_squared(from.centre) > far * far {
            self.groups.push(it.centre - self.origin, &Moments::of_group(it.dipole, &it.quadrupole));
        } else if level > 0 {
            let below = self.field.levels[level - 1].len();
            for child in group * BRANCHES..below.min((group + 1) * BRANCHES) {
                self.add(level - 1, child, but);
            }
        } else if group != but {
            self.add_leaf(group);
        }
    }

    /// The slope where a point of the leaf stands.
    fn slope(&mut self, from: DVec3) -> DVec3 {
        let mut sum = Sum::default();
        let at = (from - self.origin).as_vec3();
        // No group is near, so the marks of the cells follow.
        self.groups.add_slope(at, &mut sum, &mut self.marks);
        self.points.subtract_directions(at, &mut sum);
        self.cells.add_slope(at, &mut sum, &mut self.marks);
        let mut slope = sum.total();
        for near in self.marks.iter() {
            slope += self.field.quadratures[self.bodies[near] as usize].slope(from);
        }
        slope
    }

    fn put(&mut self, k: usize, to: DVec3) {
        self.points.put(k, to - self.origin);
    }
}

impl Group {
    fn new(bodies: &[Body]) -> Self {
        let centre = bodies.iter().map(|body| body.centroid).sum::<DVec3>() / bodies.len() as f64;
        let mut group = Self { centre, radius: 0.0, dipole: DVec3::ZERO, quadrupole: DMat3::ZERO };
        for body in bodies {
            let away = body.centroid - centre;
            group.radius = group.radius.max(away.length() + body.width);
            group.dipole += body.centroid - body.point;
            group.quadrupole += body.covariance + outer(away) - outer(body.point - centre);
        }
        group
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Slopes are those of the mean distances to all places of all cells, less those to all points, by differences.
    #[test]
    fn slopes_are_those_of_mean_distances() {
        let mut random = Random::new(3, 1);
        let mut place =
            |width: f64| DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.1 * random.unit()) * width;
        let mut cells = Vec::new();
        for i in 0..400 {
            let centre = DVec3::new(f64::from(i % 20), f64::from(i / 20), 0.0);
            cells.push((0..32).map(|_| centre + place(1.0)).collect::<Vec<DVec3>>());
        }
        // In the order of a walk that stays together: by squares of two by four.
        cells.sort_by_key(|places| {
            let [x, y] = [places[0].x + 0.5, places[0].y + 0.5].map(|v| v.max(0.0) as u32);
            (x / 10, y / 10, x / 4, y / 2)
        });
        let centroid = |places: &[DVec3]| places.iter().sum::<DVec3>() / places.len() as f64;
        let points: Vec<DVec3> = cells.iter().map(|places| centroid(places) + place(0.5)).collect();
        let quadratures =
            cells.iter().map(|places| Quadrature::of_places(centroid(places), places)).collect();
        let field = Field::new(quadratures, &points, Sight { far: 1.0, near: 3.0 });
        assert!(field.levels.len() > 2);
        for leaf in (0..field.leaves()).step_by(7) {
            let mut surroundings = Surroundings::of(&field, leaf, field.levels[0][leaf].centre);
            // Enough is seen as a whole.
            assert!(surroundings.bodies.len() < 350, "{}", surroundings.bodies.len());
            let own = field.of_leaf(leaf).start;
            let from = points[own];
            let known = surroundings.slope(from);
            let direction = |to: &DVec3| (from - *to) / (from - *to).length().max(0.1);
            let to_cells: DVec3 =
                cells.iter().map(|places| places.iter().map(direction).sum::<DVec3>() / 32.0).sum();
            let others = points.iter().enumerate().filter(|(i, _)| *i != own);
            let to_points: DVec3 = others.map(|(_, to)| (from - *to).normalize()).sum();
            let expected = to_cells - to_points;
            assert!(known.distance(expected) < 0.1, "leaf {leaf}: {known} {expected}");
        }
    }

    /// A point that has moved is felt where it is.
    #[test]
    fn moved_points_are_felt() {
        let mut random = Random::new(4, 1);
        let places: Vec<DVec3> =
            (0..100).map(|i| DVec3::new(f64::from(i), random.unit(), random.unit())).collect();
        let field_of = |points: &[DVec3]| {
            Field::new(
                places.iter().map(|&p| Quadrature::of_places(p, &[p, p + DVec3::Y])).collect(),
                points,
                Sight { far: 1.0, near: 3.0 },
            )
        };
        let mut points = places.clone();
        let mut field = field_of(&points);
        for i in [0, 17, 99] {
            points[i] += DVec3::new(0.3, -0.2, 0.1);
            field.put(i, points[i]);
        }
        let anew = field_of(&points);
        for leaf in 0..field.leaves() {
            let from = points[field.of_leaf(leaf).start];
            let [a, b] = [&field, &anew].map(|field| Surroundings::of(field, leaf, from).slope(from));
            assert!(a.distance(b) < 1e-4, "leaf {leaf}: {a} {b}");
        }
    }

    /// Two parts far apart, with points of both in the same leaf: each part is as if it were alone.
    #[test]
    fn parts_far_apart_do_not_blur_each_other() {
        let mut random = Random::new(5, 1);
        let places: Vec<DVec3> =
            (0..12).map(|i| DVec3::new(f64::from(i % 4), f64::from(i / 4), random.unit())).collect();
        let field_of = |places: &[DVec3]| {
            let quadrature = |&p: &DVec3| Quadrature::of_places(p, &[p - DVec3::X * 0.4, p + DVec3::X * 0.4]);
            let points: Vec<DVec3> = places.iter().map(|p| p + DVec3::Y * 0.2).collect();
            let sight = Sight { far: 1.0, near: 3.0 };
            Field::new(places.iter().map(quadrature).collect(), &points, sight)
        };
        let heard = |field: &Field| {
            let mut slopes = Vec::new();
            for leaf in 0..field.leaves() {
                let slope_at = |i: usize, _, slope: DVec3| Some((field.point(i), slope));
                slopes.extend(field.moves(leaf, slope_at).into_iter().map(|(_, _, slope)| slope));
            }
            slopes
        };
        let alone = heard(&field_of(&places));
        let far = places.iter().map(|p| p + DVec3::X * 3e7);
        let both: Vec<DVec3> = places.iter().copied().chain(far).collect();
        for (i, slope) in heard(&field_of(&both)).into_iter().enumerate() {
            assert!(slope.distance(alone[i % 12]) < 1e-3, "{i}: {slope} {}", alone[i % 12]);
        }
    }
}
