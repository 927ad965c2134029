//! A walk through a triangle that passes equal areas in equal times, so that a piece of the walk is a compact part of the
//! triangle: where along it a place lies, and the centroid of what it passes in a while.

use glam::DVec3;

use crate::geometry::triangle;
use crate::ids::FaceId;
use crate::lanes::{self, LANES, Lanes};
use crate::mesh::SurfaceMesh;

/// No face is halved more often than this.
const DEEPEST: u32 = 24;

/// A triangle is long from this many times as long as high on.
const LONG: f64 = 3.0;

/// The walk through one face.
#[derive(Clone, Copy)]
pub(super) struct Walk {
    /// Where it enters, where it leaves, and the third corner.
    corners: [DVec3; 3],
    /// Which corners of the face these are.
    order: [usize; 3],
    way: Way,
}

#[derive(Clone, Copy)]
enum Way {
    /// As Sierpinski's curve: the triangle is halved from the third corner, the walk goes through one half and then the
    /// other, and so on, so many times. Halves are as long and as high as the triangle.
    Halves(u32),
    /// Each half is halved across its own longest side, so that halves of a long triangle get as high as they are long.
    Shorter(u32, Sides),
    /// A band parallel to a side moves from the corner opposite to it: for long triangles with few points.
    Band,
}

/// The squared lengths of a triangle's sides: from where a walk enters to where it leaves, from where it enters to the
/// third corner, and from there to where it leaves.
#[derive(Clone, Copy)]
struct Sides {
    through: f64,
    before: f64,
    behind: f64,
}

/// A side that is halved.
#[derive(Clone, Copy)]
enum Cut {
    Through,
    Before,
    Behind,
}

impl Sides {
    /// The longest side.
    #[inline]
    fn cut(self) -> Cut {
        let Self { through, before, behind } = self;
        if through >= before && through >= behind {
            Cut::Through
        } else if before >= behind {
            Cut::Before
        } else {
            Cut::Behind
        }
    }

    /// Those of a half. The corners of both halves are listed by [`halves`].
    #[inline]
    fn half(self, cut: Cut, second: bool) -> Self {
        let Self { through, before, behind } = self;
        // The squared length of a median.
        let median = |cut: f64, a: f64, b: f64| 0.25 * (2.0 * (a + b) - cut);
        let sides = |through, before, behind| Self { through, before, behind };
        match (cut, second) {
            (Cut::Through, false) => sides(before, 0.25 * through, median(through, before, behind)),
            (Cut::Through, true) => sides(behind, median(through, before, behind), 0.25 * through),
            (Cut::Before, false) => sides(0.25 * before, through, median(before, through, behind)),
            (Cut::Before, true) => sides(median(before, through, behind), 0.25 * before, behind),
            (Cut::Behind, false) => sides(median(behind, through, before), before, 0.25 * behind),
            (Cut::Behind, true) => sides(0.25 * behind, median(behind, through, before), through),
        }
    }
}

/// The corners of both halves: where the walk enters, where it leaves, the third. It leaves the first where it enters the
/// second.
#[inline]
fn halves([from, to, apex]: [DVec3; 3], cut: Cut) -> [[DVec3; 3]; 2] {
    match cut {
        Cut::Through => {
            let middle = (from + to) * 0.5;
            [[from, apex, middle], [apex, to, middle]]
        }
        Cut::Before => {
            let middle = (from + apex) * 0.5;
            [[from, middle, to], [middle, to, apex]]
        }
        Cut::Behind => {
            let middle = (apex + to) * 0.5;
            [[from, middle, apex], [middle, to, from]]
        }
    }
}

/// The half that holds a place with these barycentric coordinates, and its coordinates there.
#[inline]
fn half([from, to, apex]: [f64; 3], cut: Cut) -> (bool, [f64; 3]) {
    match cut {
        Cut::Through if to > from => (true, [apex, to - from, 2.0 * from]),
        Cut::Through => (false, [from - to, apex, 2.0 * to]),
        Cut::Before if apex > from => (true, [2.0 * from, to, apex - from]),
        Cut::Before => (false, [from - apex, 2.0 * apex, to]),
        Cut::Behind if to > apex => (true, [2.0 * apex, to - apex, from]),
        Cut::Behind => (false, [from, 2.0 * to, apex - to]),
    }
}

/// How far a walk through halves has come at 2^[`TableDepth`](DEPTH) times, as the integrals of its place's barycentric
/// coordinates.
pub(super) struct Table(Vec<[f64; 3]>);

const DEPTH: u32 = 8;

impl Table {
    pub(super) fn new() -> Self {
        let mut middles = Vec::new();
        middle_of_halves([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], DEPTH, &mut middles);
        let mut sum = [0.0; 3];
        let mut sums = vec![sum];
        for middle in middles {
            sum = [0, 1, 2].map(|c| sum[c] + middle[c] / f64::from(1 << DEPTH));
            sums.push(sum);
        }
        Self(sums)
    }

    /// The integral up to a share of the time.
    fn moment(&self, corners: [DVec3; 3], share: f64) -> DVec3 {
        let at = share * f64::from(1 << DEPTH);
        let before = (at as usize).min((1 << DEPTH) - 1);
        let between = at - before as f64;
        let [from, to] = [self.0[before], self.0[before + 1]];
        let [u, v, w] = [0, 1, 2].map(|c| from[c] + (to[c] - from[c]) * between);
        corners[0] * u + corners[1] * v + corners[2] * w
    }
}

/// The centroids of the parts, in the walk's order.
fn middle_of_halves([from, to, apex]: [[f64; 3]; 3], depth: u32, middles: &mut Vec<[f64; 3]>) {
    if depth == 0 {
        middles.push([0, 1, 2].map(|c| (from[c] + to[c] + apex[c]) / 3.0));
        return;
    }
    let middle = [0, 1, 2].map(|c| 0.5 * (from[c] + to[c]));
    middle_of_halves([from, apex, middle], depth - 1, middles);
    middle_of_halves([apex, to, middle], depth - 1, middles);
}

impl Walk {
    /// `mass` tells how finely places are to be told apart: to a sixteenth of it or less.
    pub(super) fn new(mesh: &SurfaceMesh, face: FaceId, mass: f64) -> Self {
        let corners = mesh.triangle(face);
        let (first, longest) = triangle::longest_side(corners);
        let turned = |first: usize| [0, 1, 2].map(|turn| (first + turn) % 3);
        let side = |c: usize| corners[c].distance_squared(corners[(c + 1) % 3]);
        // As long as high.
        let elongation = longest / (2.0 * mesh.face_area(face));
        let depth = (libm::ilogb(mass.max(1.0)) as u32 + 5).min(DEEPEST);
        let (order, way) = if elongation <= LONG {
            (turned(first), Way::Halves(depth))
        } else if mass > elongation {
            let order = turned(first);
            let sides = Sides { through: longest, before: side(order[2]), behind: side(order[1]) };
            (order, Way::Shorter(depth, sides))
        } else {
            let shortest = (1..3).fold(0, |best, c| if side(c) < side(best) { c } else { best });
            (turned((shortest + 2) % 3), Way::Band)
        };
        Self { corners: order.map(|c| corners[c]), order, way }
    }

    /// When the walk comes by a place, from 0 to 1.
    #[inline]
    pub(super) fn share(&self, barycentric: [f64; 3]) -> f64 {
        let weights = self.order.map(|c| barycentric[c]);
        match self.way {
            Way::Band => (1.0 - weights[0]) * (1.0 - weights[0]),
            Way::Halves(depth) => {
                // In whole numbers, so that nothing but arithmetic is needed: halves are chosen at random, which no
                // processor foresees.
                let [mut from, mut to, mut apex] = weights.map(|w| (w * f64::from(1 << 30)) as i32);
                let mut passed = 0_u32;
                for _ in 0..depth {
                    // The first half has the corners from, apex, middle, the second apex, to, middle.
                    let second = i32::from(to > from);
                    let rest = from.abs_diff(to) as i32;
                    let near = from.min(to);
                    let swap = (apex ^ rest) & -second;
                    (from, to, apex) = (rest ^ swap, apex ^ swap, 2 * near);
                    passed = 2 * passed + second as u32;
                }
                (f64::from(passed) + 0.5) / f64::from(1_u32 << depth)
            }
            Way::Shorter(depth, mut sides) => {
                let (mut weights, mut passed) = (weights, 0_u32);
                for _ in 0..depth {
                    let cut = sides.cut();
                    let second;
                    (second, weights) = half(weights, cut);
                    sides = sides.half(cut, second);
                    passed = 2 * passed + u32::from(second);
                }
                (f64::from(passed) + 0.5) / f64::from(1_u32 << depth)
            }
        }
    }

    /// As [`share`](Self::share), of some places.
    #[inline]
    pub(super) fn shares(&self, barycentric: &[Lanes; 3]) -> Lanes {
        let Way::Halves(depth) = self.way else {
            return std::array::from_fn(|lane| self.share(barycentric.map(|weight| weight[lane])));
        };
        let mut whole = [[0; LANES]; 3];
        for (whole, &corner) in whole.iter_mut().zip(&self.order) {
            let mut scaled = barycentric[corner];
            scaled.iter_mut().for_each(|weight| *weight *= f64::from(1 << 30));
            *whole = lanes::floor(&scaled);
        }
        let [mut from, mut to, mut apex] = whole;
        let mut passed = [0_i32; LANES];
        for _ in 0..depth {
            for lane in 0..LANES {
                let apart = from[lane] - to[lane];
                // All bits of it.
                let second = apart >> 31;
                let rest = (apart ^ second) - second;
                let near = to[lane] + (apart & second);
                let swap = (apex[lane] ^ rest) & second;
                (from[lane], to[lane], apex[lane]) = (rest ^ swap, apex[lane] ^ swap, 2 * near);
                passed[lane] = 2 * passed[lane] - second;
            }
        }
        // A power of two, so this is exact.
        let part = 1.0 / f64::from(1_u32 << depth);
        let mut shares = [0.0; LANES];
        for lane in 0..LANES {
            shares[lane] = (f64::from(passed[lane]) + 0.5) * part;
        }
        shares
    }

    /// The integral of the walk's place up to a share of the time.
    pub(super) fn moment(&self, table: &Table, share: f64) -> DVec3 {
        let [from, to, apex] = self.corners;
        match self.way {
            // Shares grow like the square of the distance from the first corner.
            Way::Band => (from + (0.5 * (to + apex) - from) * (2.0 / 3.0 * libm::sqrt(share))) * share,
            Way::Halves(depth) => {
                let mut rest = Rest::new(self.corners, share);
                for _ in DEPTH..depth {
                    rest.walk(Cut::Through);
                }
                rest.passed + table.moment(rest.corners, rest.share) * rest.scale
            }
            Way::Shorter(depth, mut sides) => {
                let mut rest = Rest::new(self.corners, share);
                for _ in 0..depth {
                    let cut = sides.cut();
                    let second = rest.walk(cut);
                    sides = sides.half(cut, second);
                }
                let [from, to, apex] = rest.corners;
                rest.passed + (from + to + apex) / 3.0 * rest.share * rest.scale
            }
        }
    }

    /// Where places of the face lie in space.
    #[inline]
    pub(super) fn positions(&self, barycentric: &[Lanes; 3]) -> [Lanes; 3] {
        let [from, to, apex] = self.corners.map(|corner| corner.to_array());
        let [at_from, at_to, at_apex] = self.order.map(|corner| &barycentric[corner]);
        let mut positions = [[0.0; LANES]; 3];
        for axis in 0..3 {
            for lane in 0..LANES {
                positions[axis][lane] =
                    from[axis] * at_from[lane] + to[axis] * at_to[lane] + apex[axis] * at_apex[lane];
            }
        }
        positions
    }
}

/// What is left of a walk: a share of the way through a part of the triangle.
struct Rest {
    corners: [DVec3; 3],
    share: f64,
    /// The part's area as a share of the whole.
    scale: f64,
    /// The integral of the place up to there.
    passed: DVec3,
}

impl Rest {
    fn new(corners: [DVec3; 3], share: f64) -> Self {
        Self { corners, share, scale: 1.0, passed: DVec3::ZERO }
    }

    /// Goes on to the half where the walk ends; whether that is the second one.
    #[inline]
    fn walk(&mut self, cut: Cut) -> bool {
        let [first, second] = halves(self.corners, cut);
        self.scale *= 0.5;
        self.share *= 2.0;
        let is_second = self.share >= 1.0;
        if is_second {
            self.passed += (first[0] + first[1] + first[2]) * (self.scale / 3.0);
            self.share -= 1.0;
        }
        self.corners = if is_second { second } else { first };
        is_second
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planted;
    use crate::shapes::Shape;

    /// The integral of the walk is that of the places that it passes, whether the face is halved or a band.
    #[test]
    fn moments_are_those_of_the_places_passed() {
        let table = Table::new();
        let flat =
            planted::mesh(&planted::moved(Shape::Tetrahedron.generate(), |p| p * DVec3::new(1.0, 0.9, 0.8)));
        let long =
            planted::mesh(&planted::moved(Shape::Tetrahedron.generate(), |p| p * DVec3::new(40.0, 1.0, 2.0)));
        for (mesh, mass) in [(&flat, 3.0), (&flat, 3000.0), (&long, 3.0), (&long, 3000.0)] {
            for face in mesh.topology().face_ids() {
                let walk = Walk::new(mesh, face, mass);
                let mut places: Vec<(f64, DVec3)> = Vec::new();
                let steps = 120;
                for i in 0..steps {
                    for j in 0..steps - i {
                        for (third, weight) in [(1.0, 1.0), (2.0, 1.0)] {
                            if third == 2.0 && i + j + 2 > steps {
                                continue;
                            }
                            let [u, v] =
                                [f64::from(i), f64::from(j)].map(|k| (k + third / 3.0) / f64::from(steps));
                            let weights = [u, v, 1.0 - u - v];
                            let [x, y, z] = walk.positions(&weights.map(|w| [w; LANES])).map(|axis| axis[0]);
                            places.push((walk.share(weights), DVec3::new(x, y, z) * weight));
                        }
                    }
                }
                let total = places.len() as f64;
                for share in [0.1, 0.25, 0.4, 0.7, 1.0] {
                    let passed = places.iter().filter(|p| p.0 < share);
                    let (count, sum) = passed.fold((0.0, DVec3::ZERO), |(n, s), p| (n + 1.0, s + p.1));
                    assert!((count / total - share).abs() < 0.02, "{share}: {}", count / total);
                    let off = (walk.moment(&table, share) - sum / total).length();
                    assert!(off < 0.02 * mesh.diagonal(), "{share}: {off}");
                }
            }
        }
    }
}
