//! Convex polygons in a tile, in coordinates along the tile's two sides, clipped by bisectors.

/// A corner of a polygon, and which of the tile's sites is behind the edge that starts there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) u: f64,
    pub(super) v: f64,
    pub(super) behind: Option<usize>,
}

/// The powers of a site at the three corners of a tile; affine between them.
pub(super) type Powers = [f64; 3];

/// Drops the sites that another one beats at all corners: cells are convex, so they own nothing of the tile. Of equal
/// sites the first stays. `sites` keeps its order.
pub(super) fn prune<T>(sites: &mut Vec<(Powers, T)>) {
    let mut k = 0;
    while k < sites.len() {
        let own = sites[k].0;
        let beaten = sites.iter().enumerate().any(|(j, (other, _))| {
            j != k && (0..3).all(|c| if j < k { other[c] <= own[c] } else { other[c] < own[c] })
        });
        if beaten {
            sites.remove(k);
        } else {
            k += 1;
        }
    }
}

/// Makes `polygon` the part of the tile that site `k` owns; false if there is none.
pub(super) fn cell<T>(
    sites: &[(Powers, T)],
    k: usize,
    polygon: &mut Vec<Corner>,
    spare: &mut Vec<Corner>,
) -> bool {
    let corner = |u, v| Corner { u, v, behind: None };
    polygon.clear();
    polygon.extend([corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]);
    let own = sites[k].0;
    for (j, (other, _)) in sites.iter().enumerate() {
        // How much nearer this site is than the other, affine over the tile.
        let lead = [other[0] - own[0], other[1] - own[1], other[2] - own[2]];
        if j == k || (lead[0] > 0.0 && lead[1] > 0.0 && lead[2] > 0.0) {
            continue;
        }
        let at = |p: &Corner| lead[0] + p.u * (lead[1] - lead[0]) + p.v * (lead[2] - lead[0]);
        if polygon.iter().all(|p| at(p) > 0.0) {
            continue;
        }
        clip(polygon, at, j, spare);
        std::mem::swap(polygon, spare);
        if polygon.len() < 3 {
            return false;
        }
    }
    true
}

/// How a line cuts a tile in two.
pub(super) struct Halves {
    /// The first site's share of the tile.
    pub(super) share: f64,
    /// That times the mean barycentric coordinates.
    pub(super) weights: [f64; 3],
    /// As [`border_length`].
    pub(super) length: f64,
}

impl Halves {
    /// The weights of the second site.
    pub(super) fn rest(&self) -> [f64; 3] {
        self.weights.map(|weight| 1.0 / 3.0 - weight)
    }
}

/// What two sites own of a tile that no other site owns a part of.
pub(super) fn halves(own: &Powers, theirs: &Powers) -> Halves {
    let lead = [theirs[0] - own[0], theirs[1] - own[1], theirs[2] - own[2]];
    let ahead = lead.map(|l| l >= 0.0);
    // The corner on one side of the line by itself.
    let Some(c) = (0..3).find(|&c| ahead[c] != ahead[(c + 1) % 3] && ahead[c] != ahead[(c + 2) % 3]) else {
        let share = if ahead[0] { 1.0 } else { 0.0 };
        return Halves { share, weights: [share / 3.0; 3], length: 0.0 };
    };
    let (b, a) = ((c + 1) % 3, (c + 2) % 3);
    // How far along its two sides the line lies.
    let (along_b, along_a) = (lead[c] / (lead[c] - lead[b]), lead[c] / (lead[c] - lead[a]));
    let share = along_b * along_a;
    let mut weights = [0.0; 3];
    weights[c] = share * (1.0 - (along_b + along_a) / 3.0);
    weights[b] = share * along_b / 3.0;
    weights[a] = share * along_a / 3.0;
    let length = (along_b / (lead[c] - lead[a])).abs();
    if ahead[c] {
        Halves { share, weights, length }
    } else {
        Halves { share: 1.0 - share, weights: weights.map(|weight| 1.0 / 3.0 - weight), length }
    }
}

/// The length of the border between two corners over the slope of the difference of the powers across it, over twice
/// the area of the tile: along the line where `lead` does not change, (du, dv) is this many times its slope, turned.
pub(super) fn border_length(own: &Powers, theirs: &Powers, from: &Corner, to: &Corner) -> f64 {
    let lead = [0, 1, 2].map(|c| theirs[c] - own[c]);
    let (by_u, by_v) = (lead[1] - lead[0], lead[2] - lead[0]);
    let length = if by_v.abs() > by_u.abs() { (to.u - from.u) / by_v } else { (to.v - from.v) / by_u };
    if length.is_finite() { length.abs() } else { 0.0 }
}

/// Keeps the part of a convex polygon where the affine function is not negative.
fn clip(polygon: &[Corner], at: impl Fn(&Corner) -> f64, behind: usize, clipped: &mut Vec<Corner>) {
    clipped.clear();
    let Some(last) = polygon.last() else { return };
    let mut previous = *last;
    let mut before = at(&previous);
    for &next in polygon {
        let value = at(&next);
        if (before >= 0.0) != (value >= 0.0) {
            let t = before / (before - value);
            let (u, v) = (previous.u + (next.u - previous.u) * t, previous.v + (next.v - previous.v) * t);
            // Leaving the part that is kept, the new edge runs along the bisector; entering it, along the old edge.
            let behind = if before >= 0.0 { Some(behind) } else { previous.behind };
            clipped.push(Corner { u, v, behind });
        }
        if value >= 0.0 {
            clipped.push(next);
        }
        previous = next;
        before = value;
    }
}

/// The polygon's share of the tile and its centroid.
pub(super) fn measure(polygon: &[Corner]) -> (f64, f64, f64) {
    let first = polygon[0];
    let (mut doubled, mut u, mut v) = (0.0, 0.0, 0.0);
    for pair in polygon[1..].windows(2) {
        let (du, dv) = (pair[0].u - first.u, pair[0].v - first.v);
        let (eu, ev) = (pair[1].u - first.u, pair[1].v - first.v);
        let cross = du * ev - dv * eu;
        doubled += cross;
        u += cross * (du + eu);
        v += cross * (dv + ev);
    }
    if doubled <= 0.0 {
        return (0.0, first.u, first.v);
    }
    // The tile itself has doubled area 1 in these coordinates.
    (doubled, first.u + u / (3.0 * doubled), first.v + v / (3.0 * doubled))
}
