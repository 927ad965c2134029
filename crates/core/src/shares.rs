//! Beyond the paper: which of the wrapped points stay when more were caught than are wanted.
//!
//! The surface is cut into as many regions of equal mass as points are wanted: halves across the widest extent, again
//! and again, and inside a face pieces of a walk through it. Of the points in each region the most central one stays. So
//! every region, and every half of halves, has its share, whatever open borders do to the wrapping; and weights are met.

mod stays;
mod walk;

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec3;

use crate::buckets::Buckets;
use crate::correct::{Caught, Pick};
use crate::density::Density;
use crate::halves::split_by_mass;
use crate::ids::FaceId;
use crate::lanes;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::SurfacePoint;
use stays::{Candidate, Stays};
use walk::{Table, Walk};

/// A face or a component as a mass in one place.
#[derive(Clone, Copy, Debug)]
struct Item {
    position: DVec3,
    /// In points.
    mass: f64,
    /// Which face or component.
    id: u32,
}

/// Where in the row a face starts.
#[derive(Clone, Copy, Debug)]
struct Start {
    along: f64,
    face: FaceId,
}

/// A face of the row: where it starts, its mass, and the walk through it.
#[derive(Clone, Copy)]
struct Part {
    along: f64,
    mass: f64,
    walk: Walk,
}

/// Regions of equal mass. Faces lie in a row along which regions follow each other; the unit is a region.
pub(crate) struct Regions<'a> {
    mesh: &'a SurfaceMesh,
    density: &'a Density,
    /// How many regions there are.
    count: usize,
    row: Vec<Start>,
    table: Table,
}

impl<'a> Regions<'a> {
    /// Cuts the surface into `count` regions, component after component. O(F log count).
    pub(crate) fn new(mesh: &'a SurfaceMesh, density: &'a Density, count: usize) -> Self {
        let masses = density.face_masses(mesh);
        let scale = count as f64 / masses.iter().sum::<f64>();
        let components = mesh.topology().components();
        let mut items: Vec<Vec<Item>> = vec![Vec::new(); components.count];
        for (face, mass) in mesh.topology().face_ids().zip(masses) {
            let [a, b, c] = mesh.triangle(face);
            let position = a / 3.0 + b / 3.0 + c / 3.0;
            items[components.of_face[face.index()] as usize].push(Item {
                position,
                mass: mass * scale,
                id: face.0,
            });
        }
        // Components are cut from each other first, so that their shares are right to within a point. Large faces are
        // cut from each other before they are cut themselves, so that theirs are.
        let mut order: Vec<Item> = (0..)
            .zip(&items)
            .map(|(c, items)| {
                let mass: f64 = items.iter().map(|i| i.mass).sum();
                let middle = items.iter().map(|i| i.position / items.len() as f64).sum();
                Item { position: middle, mass, id: c }
            })
            .collect();
        cut(&mut order, 0.0);
        let mut row = Vec::with_capacity(mesh.face_count());
        let mut along = 0.0;
        for component in order {
            let items = &mut items[component.id as usize];
            cut(items, along);
            for item in items {
                row.push(Start { along, face: FaceId(item.id) });
                along += item.mass;
            }
        }
        Self { mesh, density, count, row, table: Table::new() }
    }

    #[inline]
    fn face(&self, at: usize) -> Part {
        let Start { along, face } = self.row[at];
        let end = self.row.get(at + 1).map_or(self.count as f64, |next| next.along);
        Part { along, mass: end - along, walk: Walk::new(self.mesh, face, end - along) }
    }

    fn region_at(&self, along: f64) -> usize {
        (along as usize).min(self.count - 1)
    }

    /// The centroids of some regions; `face` gives faces of the row.
    fn centroids(&self, regions: Range<usize>, face: impl Fn(usize) -> Part) -> Vec<DVec3> {
        let mut moments = vec![DVec3::ZERO; regions.len()];
        let mut masses = vec![0.0; regions.len()];
        let first = self.row.partition_point(|start| start.along <= regions.start as f64).saturating_sub(1);
        for at in first..self.row.len() {
            let Part { along, mass, walk } = face(at);
            if along >= regions.end as f64 {
                break;
            }
            let until = |region: usize| {
                let share = ((region as f64 + 1.0 - along) / mass.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
                (share, walk.moment(&self.table, share))
            };
            let start = self.region_at(along);
            let from = start.max(regions.start);
            let mut before = if from > start { until(from - 1) } else { (0.0, DVec3::ZERO) };
            for region in from..=self.region_at(along + mass).min(regions.end - 1) {
                let (share, moment) = until(region);
                moments[region - regions.start] += (moment - before.1) * mass;
                masses[region - regions.start] += (share - before.0) * mass;
                before = (share, moment);
            }
        }
        for (moment, mass) in moments.iter_mut().zip(masses) {
            *moment /= if mass > 0.0 { mass } else { 1.0 };
        }
        moments
    }

    /// What was caught on some faces of the row, each with its region and how far it lies from the middle; `middles` are
    /// those of all regions, if they are known.
    fn candidates(
        &self,
        caught: &Caught<'_>,
        row: Range<usize>,
        middles: Option<&[DVec3]>,
    ) -> Vec<Candidate> {
        let parts: Vec<Part> = row.clone().map(|at| self.face(at)).collect();
        let end = self.row.get(row.end).map_or(self.count as f64, |next| next.along);
        let (first, last) = (self.region_at(self.row[row.start].along), self.region_at(end));
        let centroids = match middles {
            Some(middles) => Cow::Borrowed(&middles[first..=last]),
            None => Cow::Owned(self.centroids(first..last + 1, |at| {
                let part = at.checked_sub(row.start).and_then(|at| parts.get(at));
                part.map_or_else(|| self.face(at), |part| *part)
            })),
        };
        // In units of d_m, so that singles hold it.
        let unit = self.count as f64 / self.mesh.area();
        let weighed = !self.density.is_uniform();
        // As many as are due, and some more.
        let due = (end - self.row[row.start].along) * (caught.count() as f64 / self.count as f64);
        let mut candidates = Vec::with_capacity((1.1 * due) as usize + 64);
        for (at, Part { along, mass, walk }) in row.zip(parts) {
            let face = self.row[at].face;
            caught.on(face).side_by_side(caught.mended(), |slots, weights| {
                let mut alongs = walk.shares(weights);
                alongs.iter_mut().for_each(|share| *share = along + mass * *share);
                let regions = lanes::floor(&alongs);
                let positions = walk.positions(weights);
                for (lane, &slot) in slots.iter().enumerate() {
                    // Rounding may carry the end of a face over.
                    let region = (regions[lane] as usize).min(last);
                    let place = DVec3::from_array(positions.map(|axis| axis[lane]));
                    let off = place.distance_squared(centroids[region - first]) * unit;
                    let barycentric = weights.map(|weight| weight[lane]);
                    if !weighed || self.density.at(&SurfacePoint { face, barycentric }) > 0.0 {
                        let pick = Pick::new(face, slot);
                        candidates.push(Candidate { region: region as u32, off: off as f32, pick });
                    }
                }
            });
        }
        candidates
    }

    /// Of what was caught one point a region stays, the one nearest to its centroid; a region without points gets one of
    /// the next that has some to spare. `None` if less was caught than there are regions. In pieces, region after region.
    pub(crate) fn choose(&self, caught: &Caught<'_>) -> Option<Vec<Vec<Pick>>> {
        /// Candidates that are there at a time, or some more.
        const TOGETHER: usize = 1 << 20;
        match self.choose_by(caught, TOGETHER) {
            // Where the last of them are too few to give what the last regions lack, all must be there.
            None if caught.count() > TOGETHER => self.choose_by(caught, usize::MAX),
            chosen => chosen,
        }
    }

    /// As [`choose`](Self::choose), with about so many candidates at a time; `None` also if the last so many are too few.
    fn choose_by(&self, caught: &Caught<'_>, together: usize) -> Option<Vec<Vec<Pick>>> {
        /// Points a piece of work is to have, and regions of a bucket.
        const POINTS: usize = 8192;
        const REGIONS: usize = 8192;
        /// Regions for each piece from which on they are not looked at as a whole before.
        const MANY: usize = 4;
        let faces = self.row.len();
        let faces_for = |points: usize| {
            let most = points as u128 * faces as u128 / caught.count().max(1) as u128;
            most.clamp(1, faces as u128) as usize
        };
        let size = faces_for(POINTS).min(POINTS);
        let group = faces_for(together).next_multiple_of(size);
        // Few regions reach over many pieces, each of which would look for their middles.
        let middles = (self.count < MANY * faces.div_ceil(size)).then(|| {
            let middle = |region: usize| self.centroids(region..region + 1, |at| self.face(at));
            parallel::map(self.count, middle).concat()
        });
        let buckets = self.count.div_ceil(REGIONS);
        let mut stays = Stays::new(self.count, REGIONS);
        let mut is_enough = true;
        // Of buckets that reach into the next group.
        let mut carried: Vec<Candidate> = Vec::new();
        for start in (0..faces).step_by(group) {
            let end = start.saturating_add(group).min(faces);
            let first = stays.next();
            let candidates = Buckets::new(
                1 + (end - start).div_ceil(size),
                |piece| match piece.checked_sub(1).map(|piece| start + piece * size) {
                    Some(start) => {
                        self.candidates(caught, start..(start + size).min(end), middles.as_deref())
                    }
                    None => carried.clone(),
                },
                buckets - first,
                |candidate| candidate.region as usize / REGIONS - first,
            );
            // Nothing of the faces that follow lies in regions before theirs.
            let complete = match self.row.get(end) {
                Some(next) => self.region_at(next.along) / REGIONS - first,
                None => buckets - first,
            };
            is_enough = stays.add(&candidates, complete);
            carried = (complete..candidates.count()).flat_map(|b| candidates.to_vec(b)).collect();
        }
        is_enough.then(|| stays.into_picks())
    }
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
    // Once for each axis, because most of the time is spent there.
    let middle = match axis {
        0 => split_along(items, |p| p.x, border - start),
        1 => split_along(items, |p| p.y, border - start),
        _ => split_along(items, |p| p.z, border - start),
    };
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

/// Splits items across an axis so that those below have about so much mass.
fn split_along(items: &mut [Item], axis: impl Fn(DVec3) -> f64, wanted: f64) -> usize {
    let order = |a: &Item, b: &Item| axis(a.position).total_cmp(&axis(b.position)).then(a.id.cmp(&b.id));
    split_by_mass(items, order, |item| item.mass, wanted)
}

#[cfg(test)]
mod tests;
