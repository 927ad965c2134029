//! Equalizing: beyond the paper, every point ends up standing for the same area.
//!
//! Coarse to fine: whole numbers of points for components, segments and planes (`patches`), a hierarchy of balanced
//! splits down to a region for each point (`balance`), then relaxation of power cells on the surface (`relax`).

mod balance;
mod capacity;
mod diagram;
mod normals;
mod patches;
mod relax;
mod sites;
mod tiles;

#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::geometry::triangle;
use crate::ids::{FaceId, StripId};
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::progress::Progress;
use crate::sample::SurfacePoint;
use balance::{Item, Region, balance};
use diagram::{diagram, owned_tiles};
use patches::Patches;
use relax::relax;
use sites::{Candidates, Site};
use tiles::Tiles;

/// How points are equalized.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EqualizeOptions {
    /// Rounds of relaxation. More come closer to equal cells; the time is proportional. Default: 20.
    pub rounds: u32,
    /// What a difference of normals counts for: the length of a unit of normal, in d_m. Keeps the two sides of sheets
    /// thinner than about twice this apart; more costs evenness. Default: 0.4.
    pub bend: f64,
}

impl Default for EqualizeOptions {
    fn default() -> Self {
        Self { rounds: 20, bend: 0.4 }
    }
}

/// What equalizing did. The spread of cell areas is their standard deviation over their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EqualizeReport {
    /// The spread of the areas of the points' nearest-point cells before.
    pub spread_before: f64,
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

/// Tiles are cut so that no side is longer than this many d_m.
const TILE: f64 = 0.7;

/// A point nearer than this many d_m to the centroid of its balanced region starts from where it is.
const KEEP: f64 = 0.4;

/// Moves points along the surface until each stands for the same area; `strip_of_face` says which segment each face
/// belongs to. Hears cancellation between rounds.
///
/// Cost: O((F + n) (rounds + log n)).
pub fn equalize(
    mesh: &SurfaceMesh,
    points: &[SurfacePoint],
    strip_of_face: &[StripId],
    options: &EqualizeOptions,
    progress: &dyn Progress,
) -> Equalized {
    let n = points.len();
    if n == 0 {
        let report = EqualizeReport { spread_before: 0.0, spread_after: 0.0, moved: 0.0 };
        return Equalized { points: Vec::new(), cells: Vec::new(), report };
    }
    let mass = mesh.face_areas();
    let d_m = libm::sqrt(mesh.area() / n as f64);
    let bend = options.bend * d_m;
    let patches = Patches::new(mesh, strip_of_face, mass, n);
    let tiles = Tiles::cut(mesh, &patches.of_face, |_| 1.0, bend, TILE * d_m, TILE * d_m);
    let start = start(mesh, &tiles, &patches, points, d_m, bend);
    let sites_at =
        |start: &Start| Site { position: mesh.locate(&points[start.point as usize]), ..start.site };
    let spread_before = spread(&nearest_cells(&tiles, start.iter().map(sites_at).collect(), d_m));
    let mut patch_mass = vec![0.0; patches.counts.len()];
    for tile in &tiles.tiles {
        patch_mass[tile.patch as usize] += tile.mass;
    }
    let wanted: Vec<f64> = start
        .iter()
        .map(|s| patch_mass[s.site.patch as usize] / patches.counts[s.site.patch as usize] as f64)
        .collect();
    let sites = start.iter().map(|s| s.site).collect();
    let relaxed = relax(&tiles, sites, &wanted, d_m, options.rounds, progress);
    let settled = settle(mesh, &tiles, &relaxed);
    let mut moved = 0.0;
    let mut result = points.to_vec();
    let mut cells = vec![0.0; n];
    for ((start, place), cell) in start.iter().zip(settled).zip(&relaxed.diagram.cells) {
        let slot = start.point as usize;
        cells[slot] = cell.mass;
        if let Some(point) = place {
            moved += mesh.locate(&point).distance_squared(mesh.locate(&points[slot]));
            result[slot] = point;
        }
    }
    let report = EqualizeReport {
        spread_before,
        spread_after: spread(&cells),
        moved: libm::sqrt(moved / n as f64) / d_m,
    };
    Equalized { points: result, cells, report }
}

/// The masses of the cells of places that no weights correct.
fn nearest_cells(tiles: &Tiles, sites: Vec<Site>, d_m: f64) -> Vec<f64> {
    let candidates = Candidates::find(tiles, &sites, d_m, 0.0);
    diagram(tiles, &candidates, &sites).cells.iter().map(|c| c.mass).collect()
}

/// A site and the point that it moves.
struct Start {
    point: u32,
    site: Site,
}

/// Shares out the points over the patches and balances them in each.
fn start(
    mesh: &SurfaceMesh,
    tiles: &Tiles,
    patches: &Patches,
    points: &[SurfacePoint],
    d_m: f64,
    bend: f64,
) -> Vec<Start> {
    let count = patches.counts.len();
    let mut items: Vec<Vec<Item>> = vec![Vec::new(); count];
    for (id, tile) in (0..).zip(&tiles.tiles) {
        let normal = tile.normal();
        items[tile.patch as usize].push(Item { position: tile.centre(), normal, mass: tile.mass, id });
    }
    // Points in the order of their patches; what one patch has too many of, the next ones get.
    let mut order: Vec<(u32, u32)> =
        (0..).zip(points).map(|(i, p)| (patches.of_face[p.face.index()].unwrap_or(0), i)).collect();
    order.sort_unstable();
    let place = |i: u32| mesh.locate(&points[i as usize]);
    let mut next = order.into_iter().map(|(_, i)| Item {
        position: place(i),
        normal: mesh.face_normal(points[i as usize].face) * bend,
        mass: 0.0,
        id: i,
    });
    let mut jobs: Vec<(Vec<Item>, Vec<Item>)> = items
        .into_iter()
        .zip(&patches.counts)
        .map(|(tiles, &k)| (tiles, next.by_ref().take(k).collect()))
        .collect();
    let mut starts = Vec::with_capacity(points.len());
    for (patch, (tiles, points)) in (0..).zip(&mut jobs) {
        let mut regions = vec![Region { point: 0, position: DVec3::ZERO, normal: DVec3::ZERO }; points.len()];
        balance(tiles, points, &mut regions);
        starts.extend(regions.into_iter().map(|region| {
            let own = place(region.point);
            // A point that lies well in its region stays: that is what a good wrapping saves.
            let stays = own.distance_squared(region.position) <= KEEP * KEEP * d_m * d_m;
            let position = if stays { own } else { region.position };
            Start { point: region.point, site: Site { position, normal: region.normal, weight: 0.0, patch } }
        }));
    }
    starts
}

/// The point of each cell's tiles that lies nearest to its centroid; `None` for an empty cell.
fn settle(mesh: &SurfaceMesh, tiles: &Tiles, relaxed: &relax::Relaxed) -> Vec<Option<SurfacePoint>> {
    let mut best: Vec<Option<(f64, FaceId, DVec3)>> = vec![None; relaxed.sites.len()];
    for (site, tile) in owned_tiles(tiles, &relaxed.candidates, &relaxed.sites) {
        let cell = &relaxed.diagram.cells[site as usize];
        if cell.mass <= 0.0 {
            continue;
        }
        let centroid = cell.moment / cell.mass;
        let tile = &tiles.tiles[tile as usize];
        let [a, b, c] = tile.corners;
        let nearest = triangle::at(a, b, c, triangle::nearest(a, b, c, centroid));
        let distance = nearest.distance_squared(centroid);
        let best = &mut best[site as usize];
        if best.is_none_or(|b| distance < b.0) {
            *best = Some((distance, tile.face, nearest));
        }
    }
    parallel::map(best.len(), |i| {
        best[i].map(|(_, face, place)| {
            let [a, b, c] = mesh.triangle(face);
            SurfacePoint { face, barycentric: triangle::nearest(a, b, c, place) }
        })
    })
}

/// Standard deviation over mean.
fn spread(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count;
    libm::sqrt(variance) / mean
}
