//! Wrapping (paper, 4.2 steps 2 and 4): points of the planar domain mapped back to the surface.

use glam::DVec2;

use crate::domain::{DomainPoints, PlanarDomain};
use crate::geometry::plane;
use crate::ids::FaceId;
use crate::parallel;
use crate::sample::SurfacePoint;
use crate::unfold::{Strip, Strips};

/// A point of the domain caught by a face of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrappedPoint {
    /// Which point of the sequence it is.
    pub index: u64,
    /// Where it is on the surface.
    pub point: SurfacePoint,
    /// Where it lies in the planar domain.
    pub place: DVec2,
}

/// What each strip caught.
#[derive(Clone, Debug, PartialEq)]
pub struct Wrapping {
    /// For each strip its points, ordered by `index`; where a strip covers a place twice, an index occurs twice.
    pub strips: Vec<Vec<WrappedPoint>>,
}

impl Wrapping {
    /// How many points were caught.
    pub fn count(&self) -> usize {
        self.strips.iter().map(Vec::len).sum()
    }
}

/// Maps the points inside each planar triangle back to the surface. A point in a region covered once gives exactly
/// one surface point, also when it falls on an edge or a corner.
///
/// Cost: O(F + points).
pub fn wrap(strips: &Strips, domain: &PlanarDomain, points: &DomainPoints) -> Wrapping {
    // Few large strips are cut into pieces, many small ones are taken together, so that all cores have work.
    const CHUNK: usize = 1 << 12;
    let work: Vec<(usize, std::ops::Range<usize>)> = (0..strips.strips.len())
        .flat_map(|s| {
            let count = strips.strips[s].faces.len();
            (0..count).step_by(CHUNK).map(move |start| (s, start..(start + CHUNK).min(count)))
        })
        .collect();
    let caught = parallel::map(work.len(), |w| {
        let (s, range) = &work[w];
        let mut caught = Vec::new();
        for index in range.clone() {
            catch(&strips.strips[*s], index, domain.offsets[*s], points, &mut caught);
        }
        caught
    });
    let mut of_strip: Vec<Vec<WrappedPoint>> = vec![Vec::new(); strips.strips.len()];
    for ((s, _), caught) in work.iter().zip(caught) {
        of_strip[*s].extend(caught);
    }
    for points in &mut of_strip {
        points.sort_by_key(|p| (p.index, p.point.face));
    }
    Wrapping { strips: of_strip }
}

fn catch(strip: &Strip, index: usize, offset: DVec2, points: &DomainPoints, caught: &mut Vec<WrappedPoint>) {
    let [a, b, c] = strip.triangle(index).map(|v| v + offset);
    for run in points.in_triangle([a, b, c]) {
        for slot in run {
            let (place, domain_index) = points.at(slot);
            if plane::triangle_holds(a, b, c, place) {
                let barycentric = plane::barycentric(a, b, c, place);
                let point = SurfacePoint { face: strip.faces[index], barycentric };
                caught.push(WrappedPoint { index: domain_index, point, place });
            }
        }
    }
}

/// The face of a strip that holds a place of the domain, if any.
pub fn locate(strip: &Strip, offset: DVec2, place: DVec2) -> Option<FaceId> {
    (0..strip.faces.len()).find_map(|i| {
        let [a, b, c] = strip.triangle(i).map(|v| v + offset);
        plane::triangle_holds(a, b, c, place).then(|| strip.faces[i])
    })
}
