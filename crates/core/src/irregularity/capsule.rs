//! The points within a distance of a segment, and how much of a triangle they cover.

use glam::DVec2;

use crate::geometry::plane::segment_distance;

/// A segment of a border in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    /// Where it starts.
    pub(super) from: DVec2,
    /// Where it ends.
    pub(super) to: DVec2,
}

/// Which part of a segment is nearest to all points of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Nearest {
    /// The start.
    From,
    /// The end.
    To,
    /// The inside, seen from one side: the distance is linear over the triangle.
    Inside,
    /// Not the same for all points.
    Mixed,
}

impl Segment {
    #[inline]
    pub(super) fn distance(&self, p: DVec2) -> f64 {
        segment_distance(self.from, self.to, p)
    }

    /// Whether the point of the segment that is nearest to `p` lies between its ends.
    #[inline]
    pub(super) fn lies_beside(&self, p: DVec2) -> bool {
        let along = self.to - self.from;
        let place = (p - self.from).dot(along);
        place > 0.0 && place < along.length_squared()
    }

    /// Whether it is one point, and that an end of a segment with a length: never nearer than that one.
    fn is_end_of(&self, other: &Segment) -> bool {
        self.from == self.to && other.from != other.to && (self.from == other.from || self.from == other.to)
    }

    fn nearest(&self, triangle: &[DVec2; 3]) -> Nearest {
        let along = self.to - self.from;
        let squared = along.length_squared();
        let [a, b, c] = *triangle;
        let place = |p: DVec2| (p - self.from).dot(along);
        let places = [place(a), place(b), place(c)];
        if places.iter().all(|&t| t <= 0.0) {
            return Nearest::From;
        }
        if places.iter().all(|&t| t >= squared) {
            return Nearest::To;
        }
        let side = |p: DVec2| along.perp_dot(p - self.from);
        let sides = [side(a), side(b), side(c)];
        let one_side = sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0);
        if one_side && places.iter().all(|&t| (0.0..=squared).contains(&t)) {
            return Nearest::Inside;
        }
        Nearest::Mixed
    }
}

/// The most segments that are held against each other.
pub(super) const FEW: usize = 16;

/// Drops every segment that another one is at least as near as everywhere in the triangle (up to `slack`), so far
/// as that can be told from its corners: the difference of two distances that are both linear, or of the squares
/// of two distances to points, is linear over the triangle. Ends of other segments are dropped too. `far` holds the
/// distances of the first [`FEW`] segments from the corners; more are not looked at. Gives how many are kept, which
/// are moved to the front.
pub(super) fn drop_dominated(
    segments: &mut [Segment],
    far: &[[f64; 3]; FEW],
    triangle: &[DVec2; 3],
    slack: f64,
) -> usize {
    let mut kinds = [None; FEW];
    for (kind, segment) in kinds.iter_mut().zip(&*segments) {
        *kind = match segment.nearest(triangle) {
            Nearest::From | Nearest::To => Some(true),
            Nearest::Inside => Some(false),
            Nearest::Mixed => None,
        };
    }
    let mut kept = [true; FEW];
    for i in (0..segments.len()).rev() {
        let Some(kind) = kinds[i] else { continue };
        kept[i] = !(0..segments.len()).any(|j| {
            let nearer = kinds[j] == Some(kind) && (0..3).all(|c| far[j][c] <= far[i][c] + slack);
            j != i && kept[j] && (nearer || segments[i].is_end_of(&segments[j]))
        });
    }
    let mut count = 0;
    for i in 0..segments.len() {
        if kept[i] {
            segments[count] = segments[i];
            count += 1;
        }
    }
    count
}

/// The area of the part of a counterclockwise triangle that lies within `radius` of a segment.
pub(super) fn covered_area(triangle: &[DVec2; 3], segment: &Segment, radius: f64) -> f64 {
    Polygon::new(triangle).covered_area(segment, radius)
}

/// The same for the union of what two segments cover, if they meet at an end and no point of the triangle is nearest
/// to the other end of the segment on whose side it lies; else `None`.
///
/// The line that halves the angle between two rays parts the points nearer to the one from those nearer to the
/// other, so each side needs to be measured against one segment only.
pub(super) fn covered_area_of_pair(
    triangle: &[DVec2; 3],
    one: &Segment,
    other: &Segment,
    radius: f64,
) -> Option<f64> {
    let (corner, one_end, other_end) = if one.to == other.from {
        (one.to, one.from, other.to)
    } else if one.from == other.to {
        (one.from, one.to, other.from)
    } else {
        return None;
    };
    let toward_one = (one_end - corner).try_normalize()?;
    let toward_other = (other_end - corner).try_normalize()?;
    // Its points have the same product with both directions.
    let across = toward_one - toward_other;
    let line = across.dot(corner);
    let whole = Polygon::new(triangle);
    let (near_one, near_other) = (whole.clip(across, line), whole.clip(-across, -line));
    let within = |part: &Polygon, direction: DVec2, length: f64| {
        part.sides().all(|(p, _)| direction.dot(p - corner) <= length)
    };
    let rays = within(&near_one, toward_one, corner.distance(one_end))
        && within(&near_other, toward_other, corner.distance(other_end));
    rays.then(|| near_one.covered_area(one, radius) + near_other.covered_area(other, radius))
}

/// A convex polygon with few corners. A triangle cut by five half-planes has at most eight.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [DVec2; 8],
    count: usize,
}

impl Polygon {
    fn new(triangle: &[DVec2; 3]) -> Self {
        let mut corners = [DVec2::ZERO; 8];
        corners[..3].copy_from_slice(triangle);
        Self { corners, count: 3 }
    }

    fn sides(&self) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        (0..self.count).map(|i| (self.corners[i], self.corners[(i + 1) % self.count]))
    }

    /// The part where `normal . p >= least` (Sutherland and Hodgman, DOI 10.1145/360767.360802).
    fn clip(&self, normal: DVec2, least: f64) -> Self {
        let mut part = Self { corners: [DVec2::ZERO; 8], count: 0 };
        for (p, q) in self.sides() {
            let (hp, hq) = (normal.dot(p) - least, normal.dot(q) - least);
            if hp >= 0.0 {
                part.push(p);
            }
            if (hp >= 0.0) != (hq >= 0.0) {
                part.push(p + (q - p) * (hp / (hp - hq)));
            }
        }
        part
    }

    /// The area of its part within `radius` of a segment: beside it, and around its two ends.
    fn covered_area(&self, segment: &Segment, radius: f64) -> f64 {
        let Some(direction) = (segment.to - segment.from).try_normalize() else {
            return disc_area(self, segment.from, radius);
        };
        let across = direction.perp();
        let start = direction.dot(segment.from);
        let end = direction.dot(segment.to);
        let line = across.dot(segment.from);
        let before = self.clip(-direction, -start);
        let after = self.clip(direction, end);
        let beside = self
            .clip(direction, start)
            .clip(-direction, -end)
            .clip(across, line - radius)
            .clip(-across, -line - radius);
        disc_area(&before, segment.from, radius) + beside.area() + disc_area(&after, segment.to, radius)
    }

    fn push(&mut self, p: DVec2) {
        // Rounding could give a sliver one corner more than there can be; dropping it costs no area.
        if self.count < self.corners.len() {
            self.corners[self.count] = p;
            self.count += 1;
        }
    }

    fn area(&self) -> f64 {
        let origin = self.corners[0];
        0.5 * self.sides().map(|(p, q)| (p - origin).perp_dot(q - origin)).sum::<f64>()
    }
}

/// The area of the part of a polygon within `radius` of `centre`: over its sides, the signed areas of the disc's
/// part of the triangle between the side and the centre.
fn disc_area(polygon: &Polygon, centre: DVec2, radius: f64) -> f64 {
    polygon.sides().map(|(p, q)| disc_side(p - centre, q - centre, radius)).sum()
}

/// The signed area of the triangle from the origin to `p` and `q` inside the disc around the origin.
fn disc_side(p: DVec2, q: DVec2, radius: f64) -> f64 {
    let side = q - p;
    let squared = side.length_squared();
    if squared == 0.0 {
        return 0.0;
    }
    let sector = |a: DVec2, b: DVec2| 0.5 * radius * radius * libm::atan2(a.perp_dot(b), a.dot(b));
    let middle = -p.dot(side) / squared;
    let half_squared = (radius * radius - (p + side * middle).length_squared()) / squared;
    if half_squared <= 0.0 {
        return sector(p, q);
    }
    let half = half_squared.sqrt();
    let (enter, leave) = (middle - half, middle + half);
    if leave <= 0.0 || enter >= 1.0 {
        return sector(p, q);
    }
    let a = if enter > 0.0 { p + side * enter } else { p };
    let b = if leave < 1.0 { p + side * leave } else { q };
    let outside_before = if enter > 0.0 { sector(p, a) } else { 0.0 };
    let outside_after = if leave < 1.0 { sector(b, q) } else { 0.0 };
    outside_before + 0.5 * a.perp_dot(b) + outside_after
}
