//! View discrepancy: the visible share of the points against the visible share of the area. What the paper is for.

mod camera;
mod occluder;

use glam::DVec3;

use self::camera::Viewpoint;
use self::occluder::Occluders;
use super::{Norms, Shares};
use crate::baseline::HilbertOrder;
use crate::ids::FaceId;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::random::Random;
use crate::sample::SurfacePoint;
use crate::spatial::{Camera, Caster};

/// Which views are looked at, and how exactly the visible area is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ViewOptions {
    /// How many cameras, half of them orthographic. `l2` scatters by about 1 / sqrt(2 views) of itself between
    /// values of `seed`. Default: 128.
    pub views: usize,
    /// How many times each view is also taken with random occluders in the way; costs little. Default: 2.
    pub occlusions: usize,
    /// At how many places of the surface the visible area is sampled. More lower the reference error at cost in
    /// proportion, 32 bytes each. Default: 400,000: on the horse a tenth of what the best sets of 10,000 points measure.
    pub nodes: usize,
    /// Turns the cameras and chooses occluders and places. Default: 0.
    pub seed: u64,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self { views: 128, occlusions: 2, nodes: 400_000, seed: 0 }
    }
}

impl ViewOptions {
    /// The default, with as many nodes as sets of up to `count` points need for a reference error of a tenth of what
    /// the best of them measure: 128 a point up to 800,000 in all, at least 40 a point, and never fewer than 64,000 nor
    /// more than 4,000,000 (128 MB). Errors of points and of nodes fall alike with their number, so that holds up to
    /// 100,000 points; beyond, [`ViewReport::is_sharp`] says whether it does.
    pub fn for_count(count: usize) -> Self {
        let few = count.saturating_mul(128).clamp(64_000, 800_000);
        let many = count.saturating_mul(40).min(4_000_000);
        Self { nodes: few.max(many), ..Self::default() }
    }
}

/// How far the visible shares of points are from those of the area.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ViewReport {
    /// Over the views.
    pub view: Norms,
    /// Over the views with occluders.
    pub view_occluded: Norms,
    /// The root mean square error of the visible share of the area over the views: to be compared with `l2`, whose
    /// square it enlarges by its own.
    pub reference_error: f64,
    /// The same with occluders.
    pub occluded_reference_error: f64,
}

impl ViewReport {
    /// Whether the visible areas are known to a tenth of what is measured, without and with occluders: else `l2`
    /// is too large by more than half a percent, and more nodes are needed.
    pub fn is_sharp(&self) -> [bool; 2] {
        let sharp = |error: f64, norms: &Norms| error <= 0.1 * norms.l2;
        [sharp(self.reference_error, &self.view), sharp(self.occluded_reference_error, &self.view_occluded)]
    }
}

/// Keeps the random streams of the views apart.
mod purpose {
    pub(super) const TURN: u64 = 0x76_69_65_01;
    pub(super) const NODES: u64 = 0x76_69_65_02;
    pub(super) const OCCLUDERS: u64 = 0x76_69_65_03;
}

/// How many places of the surface occluders are put in front of.
const ANCHORS: usize = 4096;

/// A visible share of the area, with an estimate of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AreaShare {
    share: f64,
    error: f64,
}

#[derive(Clone, Debug)]
struct View {
    viewpoint: Viewpoint,
    occluders: Vec<Occluders>,
    area: AreaShare,
    occluded_areas: Vec<AreaShare>,
}

/// Views of one mesh with their visible areas: made once, then any number of point sets are measured by it.
///
/// Cameras: the directions of a spherical Fibonacci lattice, turned at random by the seed; every other one is
/// orthographic, the others are perspective from 1.5, 2.5 or 4 times the radius of the sphere around the box of the
/// mesh. Occluders: one to three discs between camera and mesh, parallel to the image, as wide in it as 0.1 to 0.6
/// times that sphere and placed so that they hide some place of the surface.
///
/// The visible share of the area is the exact share of the faces turned towards the camera less the hidden part of
/// it, which is sampled at the nodes: two independent sets of points in Hilbert order, each with random shifts, so
/// the estimate has no bias and half the difference of the two estimates its error. With occluders all of it is
/// sampled. What counts as visible is said at [`Caster`]; its bias is 2e-7 of the extent of the mesh along concave
/// edges, far below the reference error.
#[derive(Clone, Debug)]
pub struct Views {
    caster: Caster,
    views: Vec<View>,
}

impl Views {
    /// Finds the visible areas, in O(views (nodes + faces)): about 60 ms a view for the horse (97k faces) and 400,000
    /// nodes on one core. `progress` counts views; when cancelled the result is not to be used.
    pub fn new(mesh: &SurfaceMesh, options: &ViewOptions, progress: &dyn Progress) -> Self {
        let caster = Caster::new(mesh);
        let order = HilbertOrder::new(mesh);
        let mut random = Random::new(options.seed, purpose::NODES);
        let half = options.nodes.div_ceil(2);
        let nodes = [(); 2].map(|()| order.points(half, random.unit(), random.unit())).concat();
        let nodes = places(mesh, &nodes);
        // Places of their own, so that the same seed gives the same occluders whatever the number of nodes.
        let anchors = places(mesh, &order.points(ANCHORS, 0.5, 0.0));
        let viewpoints = camera::viewpoints(mesh, options.views, options.seed);
        progress.begin("view", viewpoints.len() as u64);
        let views = parallel::map(viewpoints.len(), |i| {
            let viewpoint = viewpoints[i];
            let mut random = Random::new(options.seed, purpose::OCCLUDERS + i as u64);
            let occluders: Vec<Occluders> = (0..options.occlusions)
                .filter_map(|_| Occluders::random(&viewpoint, &anchors, &mut random))
                .collect();
            let unknown = AreaShare { share: f64::NAN, error: f64::NAN };
            let mut view = View { viewpoint, occluders, area: unknown, occluded_areas: Vec::new() };
            if !progress.is_cancelled() {
                view.find_areas(mesh, &caster, &nodes);
                progress.advance(1);
            }
            view
        });
        Self { caster, views }
    }

    /// Measures points: O(views points), at most a microsecond each. `progress` counts views.
    pub fn measure(
        &self,
        mesh: &SurfaceMesh,
        points: &[SurfacePoint],
        progress: &dyn Progress,
    ) -> ViewReport {
        let places = places(mesh, points);
        progress.begin("view", self.views.len() as u64);
        let tallies = parallel::map(self.views.len(), |i| {
            let view = &self.views[i];
            if progress.is_cancelled() {
                return Tally { facing: 0, visible: 0, unoccluded: vec![0; view.occluders.len()] };
            }
            let seen = self.caster.visible(&view.viewpoint.camera, &places);
            let tally = view.tally(&self.caster, &places, &seen);
            progress.advance(1);
            tally
        });
        let share = |count: usize| count as f64 / points.len() as f64;
        let (mut plain, mut occluded) = (Vec::new(), Vec::new());
        for (view, tally) in self.views.iter().zip(&tallies) {
            plain.push(Shares { area: view.area.share, points: share(tally.visible) });
            for (area, &count) in view.occluded_areas.iter().zip(&tally.unoccluded) {
                occluded.push(Shares { area: area.share, points: share(count) });
            }
        }
        ViewReport {
            view: Norms::over(&plain, points.len()),
            view_occluded: Norms::over(&occluded, points.len()),
            reference_error: root_mean_square(self.views.iter().map(|v| v.area.error)),
            occluded_reference_error: root_mean_square(
                self.views.iter().flat_map(|v| v.occluded_areas.iter().map(|a| a.error)),
            ),
        }
    }

    /// The cameras, in order.
    pub fn cameras(&self) -> impl ExactSizeIterator<Item = Camera> + '_ {
        self.views.iter().map(|view| view.viewpoint.camera)
    }

    /// The visible share of the area from each camera, in order, without occluders.
    pub fn visible_areas(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.views.iter().map(|view| view.area.share)
    }

    /// What answers whether a place is seen.
    pub fn caster(&self) -> &Caster {
        &self.caster
    }
}

/// The norms of visible share of points - visible share of area over views and over views with occluders: see
/// [`Views`], which measures several sets on one mesh at the price of one. `progress` counts views, twice: for the
/// areas and for the points.
pub fn view(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    options: &ViewOptions,
    progress: &dyn Progress,
) -> ViewReport {
    Views::new(mesh, options, progress).measure(mesh, points, progress)
}

/// The cameras of [`Views`] without the visible areas: for optimising points for views other than those that
/// judge them, take another seed.
pub fn cameras(mesh: &SurfaceMesh, views: usize, seed: u64) -> Vec<Camera> {
    camera::viewpoints(mesh, views, seed).iter().map(|viewpoint| viewpoint.camera).collect()
}

/// A face and a place on it, in units of the mesh.
type Place = (FaceId, DVec3);

fn places(mesh: &SurfaceMesh, points: &[SurfacePoint]) -> Vec<Place> {
    parallel::map(points.len(), |i| (points[i].face, mesh.locate(&points[i])))
}

/// How many places are turned towards a camera, how many of them it sees, and how many behind no occluder.
struct Tally {
    facing: usize,
    visible: usize,
    unoccluded: Vec<usize>,
}

impl View {
    /// Counts places, given which of them the camera sees.
    fn tally(&self, caster: &Caster, places: &[Place], seen: &[bool]) -> Tally {
        let camera = &self.viewpoint.camera;
        let facing = places.iter().filter(|&&(face, at)| caster.is_facing(camera, face, at)).count();
        let mut tally = Tally { facing, visible: 0, unoccluded: vec![0; self.occluders.len()] };
        for (&(_, at), _) in places.iter().zip(seen).filter(|&(_, &seen)| seen) {
            tally.visible += 1;
            let image = self.viewpoint.image(at);
            for (count, occluders) in tally.unoccluded.iter_mut().zip(&self.occluders) {
                *count += usize::from(!occluders.hide(image));
            }
        }
        tally
    }

    /// Finds the visible areas from nodes of which each half is a sample of the whole surface.
    fn find_areas(&mut self, mesh: &SurfaceMesh, caster: &Caster, nodes: &[Place]) {
        let camera = &self.viewpoint.camera;
        let mut facing = 0.0;
        for face in mesh.topology().face_ids() {
            let [a, _, _] = mesh.triangle(face);
            if caster.is_facing(camera, face, a) {
                facing += mesh.face_area(face);
            }
        }
        let facing = facing / mesh.area();
        let seen = caster.visible(camera, nodes);
        let half = nodes.len() / 2;
        let tallies = [0..half, half..nodes.len()].map(|h| self.tally(caster, &nodes[h.clone()], &seen[h]));
        let hidden = |h: usize| (tallies[h].facing - tallies[h].visible) as f64 / half as f64;
        self.area = AreaShare::from_halves(facing - hidden(0), facing - hidden(1));
        self.occluded_areas = (0..self.occluders.len())
            .map(|o| {
                let share = |h: usize| tallies[h].unoccluded[o] as f64 / half as f64;
                AreaShare::from_halves(share(0), share(1))
            })
            .collect();
    }
}

impl AreaShare {
    /// Their mean; half their difference is an unbiased estimate of its error.
    fn from_halves(a: f64, b: f64) -> Self {
        Self { share: (0.5 * (a + b)).clamp(0.0, 1.0), error: 0.5 * (a - b).abs() }
    }
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        count += 1.0;
    }
    (sum / count).sqrt()
}

#[cfg(test)]
mod tests;
