//! Equalizing: beyond the paper, every point ends up standing for the same area.
//!
//! Coarse to fine: whole numbers of points for components (`patches`), a hierarchy of balanced splits down to a region for
//! each point (`balance`), then relaxation of power cells on the surface (`relax`); at last the side of a crease on which a
//! point stands, so that planes and segments have their shares (`sides`), its place there (`energy`), and
//! the face of its cell, so that as many points face every way as the surface asks for (`facing`). docs/METHOD.md explains
//! each.

mod balance;
mod capacity;
mod clip;
mod diagram;
mod energy;
mod facing;
mod field;
mod harmonics;
mod holdings;
mod laplacian;
mod layout;
mod near;
mod normals;
mod owners;
mod patches;
mod places;
mod quadrature;
mod relax;
mod settle;
mod sides;
mod sources;
mod spacing;
mod tiles;
mod views;

#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::density::Density;
use crate::geometry::triangle;
use crate::ids::{FaceId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::sample::SurfacePoint;
use balance::Item;
use energy::homes;
use facing::{Normals, face_evenly};
use layout::{Due, Layout, Place, Splits, lay_out};
use near::{Near, Site};
use owners::diagram;
use patches::Patches;
use places::Spot;
use relax::relax;
use settle::{Cells, settle};
use sides::Sides;
use tiles::{Scale, tiles};

pub use views::{Cameras, ForViews};

/// How points are equalized.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct EqualizeOptions {
    /// Rounds of relaxation. More come closer to equal cells; the time is proportional. Default: 4.
    pub rounds: u32,
    /// What a difference of normals counts for: the length of a unit of normal, in d_m. Keeps the two sides of sheets
    /// thinner than about twice this apart; more costs evenness. Default: 0.4.
    pub bend: f64,
    /// Whether [`EqualizeReport::spread_before`] is wanted, for the time of a round. It changes no point. Default: no.
    pub spread_before: bool,
    /// After that, the place in its cell that serves views best; costs some evenness. Default: `None`.
    pub for_views: Option<ForViews>,
}

impl Default for EqualizeOptions {
    fn default() -> Self {
        Self { rounds: 4, bend: 0.4, spread_before: false, for_views: None }
    }
}

/// What equalizing did. The spread of cell areas is their standard deviation over their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EqualizeReport {
    /// The spread of the areas of the points' nearest-point cells before, where [`EqualizeOptions::spread_before`] asks for it.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub spread_before: Option<f64>,
    /// The spread of the cells' areas after.
    pub spread_after: f64,
    /// How far points moved, root mean square, in units of d_m.
    pub moved: f64,
}

/// Points with the areas that they stand for.
#[derive(Clone, Debug, PartialEq)]
pub struct Equalized {
    /// The points, exactly on the surface, in the order of the input.
    pub points: Vec<SurfacePoint>,
    /// The mass (area, or area times density) of each point's cell.
    pub cells: Vec<f64>,
    /// What was done.
    pub report: EqualizeReport,
}

impl Equalized {
    /// Of no points.
    pub(crate) fn nothing(options: &EqualizeOptions) -> Self {
        let spread_before = options.spread_before.then_some(0.0);
        let report = EqualizeReport { spread_before, spread_after: 0.0, moved: 0.0 };
        Self { points: Vec::new(), cells: Vec::new(), report }
    }
}

/// Cells that spread more than before, and by more than this share, are no improvement: the points stay.
const UNEVEN: f64 = 0.1;

/// A point nearer than this many d_m to the centre of the block where it is due starts from where it is.
const KEEP: f64 = 0.4;

/// A surface allotted to a number of points: what does not depend on where these are, so that they can be made at
/// the same time.
pub(crate) struct Allotment<'a> {
    scale: Scale<'a>,
    patches: Patches,
    layout: Layout,
    splits: Splits,
    /// The mass that each point of a patch is to stand for.
    share: Vec<f64>,
    normals: Normals,
}

impl<'a> Allotment<'a> {
    /// For `n` points, at least one. O((F + n) log n).
    pub(crate) fn new(mesh: &SurfaceMesh, density: &'a Density, n: usize, options: &EqualizeOptions) -> Self {
        let d_m = libm::sqrt(mesh.area() / n as f64);
        let (low, high) = mesh.bounds();
        let scale = Scale { density, d_m, bend: options.bend, middle: (low + high) * 0.5 };
        let patches = Patches::new(mesh, density, n);
        let (layout, splits) = lay_out(tiles(mesh, &patches, &scale), &patches.counts);
        let mut share = vec![0.0; patches.counts.len()];
        for block in &layout.blocks {
            for tile in &layout.tiles[block.tiles.clone()] {
                share[block.patch as usize] += tile.mass;
            }
        }
        for (share, &count) in share.iter_mut().zip(&patches.counts) {
            *share /= count as f64;
        }
        Self { scale, patches, layout, splits, share, normals: Normals::new(mesh) }
    }

    /// To how many points.
    pub(crate) fn count(&self) -> usize {
        self.patches.counts.iter().sum()
    }
}

/// Moves points along the surface until each stands for the same mass: area times density. `strip_of_face` says which
/// segment each face belongs to. Hears cancellation between rounds.
///
/// Cost: O((F + n) (rounds + log n)).
pub fn equalize(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    strip_of_face: &[StripId],
    density: &Density,
    options: &EqualizeOptions,
    progress: &dyn Progress,
) -> Equalized {
    if points.is_empty() {
        return Equalized::nothing(options);
    }
    let allotment = Allotment::new(mesh, density, points.len(), options);
    equalize_allotted(mesh, allotment, points, |face| strip_of_face[face.index()], options, progress)
}

/// As [`equalize`], with what was allotted to as many points by the same options.
pub(crate) fn equalize_allotted(
    mesh: &SurfaceMesh,
    allotment: Allotment<'_>,
    points: &[SurfacePoint],
    strip_of_face: impl Fn(FaceId) -> StripId + Send,
    options: &EqualizeOptions,
    progress: &dyn Progress,
) -> Equalized {
    let n = points.len();
    let Allotment { scale, patches, layout, splits, share, normals } = allotment;
    let Scale { density, d_m, middle, .. } = scale;
    let layout = &layout;
    let places: Vec<DVec3> = parallel::map(n, |i| mesh.locate(&points[i]) - middle);
    let dues = splits.dues(items(mesh, &patches, points, &places, options.bend * d_m), &layout.blocks);
    drop(splits);
    let sites = |at: &(dyn Fn(&Due) -> DVec3 + Sync)| -> Vec<Site> {
        let site = |due: &Due| {
            let block = &layout.blocks[due.block as usize];
            let place = Place { position: at(due), ..block.centre };
            Site { place, weight: 0.0, patch: block.patch, distance: block.distance }
        };
        parallel::map(dues.len(), |i| site(&dues[i]))
    };
    let nearest = || -> Vec<f64> {
        let before = sites(&|due| places[due.point as usize]);
        diagram(layout, &Near::find(layout, &before), &before).cells.iter().map(|cell| cell.mass).collect()
    };
    let before = options.spread_before.then(nearest);
    let start = sites(&|due| {
        let block = &layout.blocks[due.block as usize];
        let (own, centre) = (places[due.point as usize], block.centre.position);
        // A point that lies well in its block stays: that is what a good wrapping saves. Of several points that share
        // a block each stays, so that they do not fall together.
        let stays = own.distance(centre) <= KEEP * block.distance || block.points > 1;
        if stays { own } else { centre }
    });
    let wanted: Vec<f64> = start.iter().map(|site| share[site.patch as usize]).collect();
    let centres: Vec<Place> = dues.iter().map(|due| layout.blocks[due.block as usize].centre).collect();
    let near = Near::find(layout, &start);
    let (relaxed, sides) = parallel::join(
        || relax(layout, near, start, &centres, &wanted, options.rounds, progress),
        || Sides::new(mesh, strip_of_face, density, n),
    );
    let mut settled = settle(layout, &relaxed, sides.as_ref());
    let homes = homes(layout, &relaxed, sides.as_ref(), &mut settled);
    let cells = Cells { layout, relaxed: &relaxed, sides: sides.as_ref(), homes };
    face_evenly(&normals, &cells, &mut settled);
    spacing::make_way(&cells, &mut settled);
    if let Some(options) = &options.for_views {
        views::choose(mesh, middle, &cells, &mut settled, options, progress);
        spacing::make_way(&cells, &mut settled);
    }
    let masses: Vec<f64> = relaxed.cells.iter().map(|cell| cell.mass).collect();
    // A point without a place of its own stays, or goes where it is due if that is in another patch: its number counts there.
    let stays = |due: &Due| {
        let point = points[due.point as usize];
        let block = &layout.blocks[due.block as usize];
        let is_there = patches.of(point.face) == Some(block.patch);
        let spot = if is_there {
            None
        } else {
            settle::nearest(block.tiles.clone().map(|tile| layout.ground(tile)), block.centre.position)
        };
        spot.map_or(point, |spot| on_surface(mesh, &spot, middle))
    };
    let spread_before = before.as_deref().map(spread);
    if spread(&masses) > UNEVEN {
        let nearest = before.unwrap_or_else(nearest);
        if spread(&masses) > spread(&nearest) {
            return unmoved(points, &dues, nearest, spread_before, stays);
        }
    }
    let places_now = parallel::map(n, |i| {
        let point = settled[i].map_or_else(|| stays(&dues[i]), |spot| on_surface(mesh, &spot, middle));
        (point, mesh.locate(&point) - middle)
    });
    let mut moved = 0.0;
    let mut result = points.to_vec();
    let mut cells = vec![0.0; n];
    for ((due, (point, place)), mass) in dues.iter().zip(places_now).zip(masses) {
        let slot = due.point as usize;
        cells[slot] = mass;
        moved += place.distance_squared(places[slot]);
        result[slot] = point;
    }
    let report = EqualizeReport {
        spread_before,
        spread_after: spread(&cells),
        moved: libm::sqrt(moved / n as f64) / d_m,
    };
    Equalized { points: result, cells, report }
}

/// A place of the surface as a point of the mesh.
fn on_surface(mesh: &SurfaceMesh, spot: &Spot, middle: DVec3) -> SurfacePoint {
    let [a, b, c] = mesh.triangle(spot.face);
    SurfacePoint { face: spot.face, barycentric: triangle::nearest(a, b, c, spot.place + middle) }
}

/// The points as they were, with the cells that they have: where relaxation does not find its way, nothing is better.
fn unmoved(
    points: &[SurfacePoint],
    dues: &[Due],
    nearest: Vec<f64>,
    spread_before: Option<f64>,
    stays: impl Fn(&Due) -> SurfacePoint,
) -> Equalized {
    let spread_after = spread(&nearest);
    let mut cells = vec![0.0; points.len()];
    let mut points = points.to_vec();
    for (due, mass) in dues.iter().zip(nearest) {
        cells[due.point as usize] = mass;
        points[due.point as usize] = stays(due);
    }
    let report = EqualizeReport { spread_before, spread_after, moved: 0.0 };
    Equalized { points, cells, report }
}

/// The points in the order of their patches; what one patch has too many of, the next ones get.
fn items(
    mesh: &SurfaceMesh,
    patches: &Patches,
    points: &[SurfacePoint],
    places: &[DVec3],
    bend: f64,
) -> Vec<Item> {
    let mut order: Vec<(u32, u32)> =
        (0..).zip(points).map(|(i, p)| (patches.of(p.face).unwrap_or(0), i)).collect();
    order.sort_unstable();
    let item = |(_, id): (u32, u32)| Item {
        position: places[id as usize],
        normal: mesh.face_normal(points[id as usize].face) * bend,
        mass: 0.0,
        id,
    };
    order.into_iter().map(item).collect()
}

/// Standard deviation over mean.
fn spread(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count;
    libm::sqrt(variance) / mean
}
