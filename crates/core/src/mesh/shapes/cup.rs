//! The paper's cup: a turned body with an inner and an outer wall, and a handle.

use glam::{DVec2, DVec3};

use crate::mesh::shapes::grid::{Surface, between_poles, on_circle, open_tube};
use crate::mesh::soup::PolygonSoup;

/// Half the width of the block of cells that makes room for an end of the handle.
const HOLE: i64 = 3;
/// Up to this many cells from the middle of a hole the grid gives way to it.
const REACH: i64 = 6;
/// Rings below the middles of the two holes.
const HOLE_RINGS: [u32; 2] = [18, 30];
const SEGMENTS: u32 = 80;
const RINGS: u32 = 78;
const HANDLE_SEGMENTS: u32 = 24;
const HANDLE_RINGS: u32 = 37;
const HANDLE_RADIUS: f64 = 0.075;
/// How far the ends of the handle reach into the wall, which is 0.05 thick.
const INSERTION: f64 = 0.02;
/// The middle of the floor.
const END: DVec2 = DVec2::new(0.0, 0.06);

/// A cup of height 1 with the counts of the paper's (figure 5): 7,024 vertices, 20,976 edges, 13,952 triangles, so its
/// Euler characteristic is 0, and 96 border edges. A handle that had grown together with the body would leave no
/// border; here body and handle are two pieces, as block-structured generators make them: the body has a round hole of
/// 24 edges for each end of the handle, and each end of the handle, itself a border of 24 edges, sticks in its hole.
/// `refinement` (at least 1) multiplies the number of cells along every line of the grids; 1 is the paper's.
pub fn cup(refinement: u32) -> PolygonSoup {
    let refinement = refinement.max(1);
    let profile = Profile::new();
    let mut surface = body(&profile, refinement);
    surface.append(&handle(&profile, refinement));
    surface.into_soup()
}

/// The wall around the z-axis, (rho, z) by arc length: from the middle of the foot outside up, over the rim and
/// down to the middle of the floor.
struct Profile {
    /// Each with its length.
    pieces: Vec<(Piece, f64)>,
    length: f64,
}

enum Piece {
    Line {
        from: DVec2,
        direction: DVec2,
    },
    Arc {
        centre: DVec2,
        /// From the centre to where it starts.
        start: DVec2,
        /// Radians for each unit of length; positive to the left.
        rate: f64,
    },
}

impl Profile {
    fn new() -> Self {
        // The corners of the wall with the radius of the arc that rounds each off.
        let corners = [
            (DVec2::new(0.0, 0.0), 0.0),
            (DVec2::new(0.33, 0.0), 0.06),
            (DVec2::new(0.42, 1.0), 0.024),
            (DVec2::new(0.37, 1.0), 0.024),
            (DVec2::new(0.29, 0.06), 0.08),
            (END, 0.0),
        ];
        let mut pieces = Vec::new();
        let mut from = corners[0].0;
        for window in corners.windows(3) {
            let [(before, _), (corner, radius), (after, _)] = [window[0], window[1], window[2]];
            let (arriving, leaving) = ((corner - before).normalize(), (after - corner).normalize());
            let turn = libm::atan2(arriving.perp_dot(leaving), arriving.dot(leaving));
            let cut = radius * libm::tan(0.5 * turn.abs());
            let touch = corner - arriving * cut;
            pieces.push((Piece::Line { from, direction: arriving }, from.distance(touch)));
            let start = -arriving.perp() * radius * turn.signum();
            pieces.push((
                Piece::Arc { centre: touch - start, start, rate: turn.signum() / radius },
                radius * turn.abs(),
            ));
            from = corner + leaving * cut;
        }
        pieces.push((Piece::Line { from, direction: (END - from).normalize() }, from.distance(END)));
        let length = pieces.iter().map(|(_, length)| length).sum();
        Self { pieces, length }
    }

    /// The wall after this length.
    fn at(&self, mut along: f64) -> DVec2 {
        for (piece, length) in &self.pieces {
            if along <= *length {
                return match *piece {
                    Piece::Line { from, direction } => from + direction * along,
                    Piece::Arc { centre, start, rate } => {
                        let (sin, cos) = libm::sincos(along * rate);
                        centre + DVec2::new(cos, sin).rotate(start)
                    }
                };
            }
            along -= length;
        }
        END
    }
}

/// The length of the wall up to the middle of a hole.
fn hole_length(profile: &Profile, hole: usize) -> f64 {
    profile.length * f64::from(HOLE_RINGS[hole]) / f64::from(RINGS)
}

fn body(profile: &Profile, refinement: u32) -> Surface {
    let (segments, rings) = (SEGMENTS * refinement, RINGS * refinement);
    let (hole, reach) = (HOLE * i64::from(refinement), REACH * i64::from(refinement));
    // How many cells a vertex lies beside and above the middle of a hole, the hole at segment 0.
    let offset = |ring: u32, segment: u32, at: u32| {
        let segment = i64::from(segment);
        let beside = if segment > i64::from(segments / 2) { segment - i64::from(segments) } else { segment };
        (beside, i64::from(ring) - i64::from(at * refinement))
    };
    let mut surface =
        between_poles(DVec3::ZERO, DVec3::new(END.x, 0.0, END.y), rings - 1, segments, |ring, segment| {
            let ring = ring + 1;
            let along = profile.length * f64::from(ring) / f64::from(rings);
            for (which, at) in HOLE_RINGS.into_iter().enumerate() {
                let (beside, above) = offset(ring, segment, at);
                let cells = beside.abs().max(above.abs());
                if (hole..reach).contains(&cells) {
                    // From the grid at the reach to a circle at the hole: y across the wall, the other along it.
                    let rho = profile.at(along).x;
                    let middle = hole_length(profile, which);
                    let on_grid = DVec2::new(rho * on_circle(segment, segments).y, along - middle);
                    let round = DVec2::new(beside as f64, above as f64).normalize()
                        * (HANDLE_RADIUS * cells as f64 / hole as f64);
                    let p = round.lerp(on_grid, (cells - hole) as f64 / (reach - hole) as f64);
                    let wall = profile.at(middle + p.y);
                    return DVec3::new((wall.x * wall.x - p.x * p.x).sqrt(), p.x, wall.y);
                }
            }
            let wall = profile.at(along);
            (on_circle(segment, segments) * wall.x).extend(wall.y)
        });
    // A face lies in a hole when all its corners do; the border itself has two of them at most on a side.
    let place = |v: u32| ((v - 1) / segments + 1, (v - 1) % segments);
    let last = surface.positions.len() as u32 - 1;
    surface.faces.retain(|face| {
        let inside = |at: u32| {
            face.iter().all(|&v| {
                let (ring, segment) = place(v.clamp(1, last - 1));
                let (beside, above) = offset(ring, segment, at);
                beside.abs().max(above.abs()) <= hole
            })
        };
        !HOLE_RINGS.into_iter().any(inside)
    });
    surface.compact();
    surface
}

fn handle(profile: &Profile, refinement: u32) -> Surface {
    let (segments, rings) = (HANDLE_SEGMENTS * refinement, HANDLE_RINGS * refinement);
    // A Bezier curve in the plane y = 0 that leaves the wall at right angles to the axis at both ends.
    let [low, high] = [0, 1].map(|hole| profile.at(hole_length(profile, hole)) - DVec2::X * INSERTION);
    let curve = [low, low + DVec2::X * 0.34, high + DVec2::new(0.46, 0.0), high];
    open_tube(rings + 1, segments, |ring, segment| {
        let t = f64::from(ring) / f64::from(rings);
        let s = 1.0 - t;
        let place = curve[0] * (s * s * s)
            + curve[1] * (3.0 * s * s * t)
            + curve[2] * (3.0 * s * t * t)
            + curve[3] * (t * t * t);
        let tangent = ((curve[1] - curve[0]) * (s * s)
            + (curve[2] - curve[1]) * (2.0 * s * t)
            + (curve[3] - curve[2]) * (t * t))
            .normalize();
        let across = on_circle(segment, segments) * HANDLE_RADIUS;
        // Counterclockwise around the tangent: from y to the curve's left in the plane of x and z.
        let p = place + tangent.perp() * across.y;
        DVec3::new(p.x, across.x, p.y)
    })
}
