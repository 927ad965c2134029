//! Points for connected components: how many each is to get, and the density that gives it them.
//!
//! By area alone a small part of a model gets few points or none. Counts for the components are shared out first
//! ([`each`], [`at_least`]); [`run`] then meets them exactly. It wraps similar copies of the components, each as large as its
//! count asks for, with the same density everywhere; a sample of a copy is one of the mesh, because similar triangles have
//! the same barycentric coordinates. So a part a millionth as large costs no more than any other.
//!
//! ```
//! use ldwrap::density::Density;
//! use ldwrap::pipeline::Options;
//! use ldwrap::{CheckOptions, Silent, SurfaceMesh, quota, shapes};
//!
//! // A cube and, a hundredth as large, another.
//! let mut soup = shapes::cube(2);
//! let (first, small) = (soup.positions.len() as u32, shapes::cube(1));
//! soup.positions.extend(small.positions.iter().map(|p| *p * 0.01 + glam::DVec3::X * 5.0));
//! for polygon in 0..small.polygon_count() {
//!     soup.push_polygon(&small.polygon(polygon).iter().map(|v| v + first).collect::<Vec<_>>());
//! }
//! let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default())?;
//!
//! let counts = quota::at_least(&mesh, &Density::UNIFORM, 100, 10)?;
//! assert_eq!(counts, [90, 10]);
//! let samples = quota::run(&mesh, &Density::UNIFORM, &counts, &Options::for_count(100), &Silent)?.samples;
//! let on_small = samples.iter().filter(|s| mesh.locate(&s.point).x > 4.0).count();
//! assert_eq!(on_small, 10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use glam::DVec3;

use crate::density::{Density, DensityError};
use crate::ids::{FaceId, VertexId};
use crate::mesh::{SurfaceMesh, Topology};
use crate::pipeline::{Options, OptionsError, Request, Run, run_weighted};
use crate::progress::Progress;
use crate::selection::Selection;

/// Why components do not get their counts.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QuotaError {
    /// The counts do not fit the mesh and its density.
    #[error(transparent)]
    Density(#[from] DensityError),
    /// The other options cannot be met.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// Only equalizing meets counts exactly, and not where the components stand is looked at.
    #[error("counts for components need points that are equalized, not for views and not extensible")]
    NotEqualized,
}

/// Fewer points than the components need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{count} points are fewer than {least} for each of {components} connected components: {needed} or more are needed"
)]
pub struct TooFewPoints {
    /// How many points there are.
    pub count: usize,
    /// How many each component is to get at least.
    pub least: usize,
    /// How many components there are that have weight.
    pub components: usize,
    /// How many points they need together, unless that is too many to count.
    pub needed: usize,
}

/// As many points for each connected component, numbered as by [`components`](crate::Topology::components); none for
/// those without weight. Linear time.
///
/// # Panics
/// If the density was made for a mesh with fewer faces.
pub fn each(mesh: &SurfaceMesh, density: &Density, count: usize) -> Vec<usize> {
    masses(mesh, density).into_iter().map(|mass| if mass > 0.0 { count } else { 0 }).collect()
}

/// Shares `count` points out by mass (area times density), but at least `least` for each connected component that has
/// weight: those with a larger share give what the others lack. Largest remainders round; counts add up to `count`.
/// O(F + C log C) for C components.
///
/// # Errors
/// [`TooFewPoints`] when there are not `least` for each.
///
/// # Panics
/// As [`each`].
pub fn at_least(
    mesh: &SurfaceMesh,
    density: &Density,
    count: usize,
    least: usize,
) -> Result<Vec<usize>, TooFewPoints> {
    let masses = masses(mesh, density);
    let mut order: Vec<usize> = (0..masses.len()).filter(|&c| masses[c] > 0.0).collect();
    let components = order.len();
    let needed = components.saturating_mul(least);
    if needed > count {
        return Err(TooFewPoints { count, least, components, needed });
    }
    // The lightest first: whoever has not enough by its share gets the least, and the rest is shared by the others.
    order.sort_by(|&a, &b| masses[a].total_cmp(&masses[b]).then(a.cmp(&b)));
    let mut counts = vec![0; masses.len()];
    let mut left = count;
    // The mass of each in the order and of all behind it.
    let mut onward = vec![0.0; components + 1];
    for i in (0..components).rev() {
        onward[i] = onward[i + 1] + masses[order[i]];
    }
    let mut lighter = 0;
    while lighter < components && masses[order[lighter]] / onward[lighter] * (left as f64) < least as f64 {
        counts[order[lighter]] = least;
        left -= least;
        lighter += 1;
    }
    let heavier = &order[lighter..];
    let mass = onward[lighter];
    let mut remainders = Vec::with_capacity(heavier.len());
    let mut given = 0;
    for &c in heavier {
        let due = masses[c] / mass * left as f64;
        counts[c] = (due.floor() as usize).max(least);
        given += counts[c];
        remainders.push((due - due.floor(), c));
    }
    remainders.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    // Rounding of the shares themselves may have given a point too many.
    for &(_, c) in remainders.iter().cycle().take(left.saturating_sub(given)) {
        counts[c] += 1;
    }
    for &c in heavier.iter().rev().cycle().take(given.saturating_sub(left)) {
        counts[c] -= 1;
    }
    Ok(counts)
}

/// As [`run_weighted`], with exactly these numbers of points on the connected components, numbered as by
/// [`components`](crate::Topology::components); inside each they follow the density. The request of the options does not
/// count. Points must be equalized; `d_m`, strips and places in the plane are those of similar copies of the components,
/// which together have the area of the mesh. Cost: that of [`run_weighted`].
///
/// # Errors
/// [`QuotaError`] when there is not one count for each component, a component without weight is to have points, no one is, or
/// the options cannot be met.
///
/// # Panics
/// If the density was made for a mesh with fewer faces.
pub fn run(
    mesh: &SurfaceMesh,
    density: &Density,
    counts: &[usize],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Run, QuotaError> {
    let equalized = options.equalize.is_some_and(|equalize| equalize.for_views.is_none());
    if !equalized || options.selection == Selection::Extensible {
        return Err(QuotaError::NotEqualized);
    }
    let (copies, weights) = copies(mesh, density, counts)?;
    let options = Options { request: Request::Count(counts.iter().sum()), ..*options };
    if counts.len() == 1 {
        // To the bit as without counts.
        return Ok(run_weighted(mesh, density, &options, progress)?);
    }
    let density = match weights {
        Some(weights) => Density::of_corners(&copies, &weights)?,
        None => Density::UNIFORM,
    };
    Ok(run_weighted(&copies, &density, &options, progress)?)
}

/// For each corner of each face its weight.
type Weights = Vec<[f64; 3]>;

/// The mesh with each component as large as its count asks for, apart from each other, in faces of the same numbers; and
/// the weights there, if not all are the same.
fn copies(
    mesh: &SurfaceMesh,
    density: &Density,
    counts: &[usize],
) -> Result<(SurfaceMesh, Option<Weights>), DensityError> {
    let components = mesh.topology().components();
    if counts.len() != components.count {
        let (found, expected) = (counts.len(), components.count);
        return Err(DensityError::Length { found, expected, elements: "components" });
    }
    let masses = masses(mesh, density);
    if let Some(component) = (0..counts.len()).find(|&c| counts[c] > 0 && masses[c] <= 0.0) {
        return Err(DensityError::NoWeight { component });
    }
    let total: f64 = counts.iter().map(|&count| count as f64).sum();
    if total == 0.0 {
        return Err(DensityError::Zero);
    }
    let areas = masses_of(mesh, &components.of_face, components.count, |face| mesh.face_area(face));
    let mut bounds = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); components.count];
    for (corners, &component) in mesh.triangles().zip(&components.of_face) {
        let (low, high) = &mut bounds[component as usize];
        for corner in corners {
            (*low, *high) = (low.min(corner), high.max(corner));
        }
    }
    // A component that gets no point is as large as for one, and weighs nothing.
    let scale = |c: usize| libm::sqrt(counts[c].max(1) as f64 / total * mesh.area() / areas[c]);
    let scales: Vec<f64> = (0..components.count).map(scale).collect();
    let size = bounds
        .iter()
        .zip(&scales)
        .fold(0.0, |size: f64, ((low, high), s)| size.max((*high - *low).max_element() * s));
    // In the cells of a cube, none of which reaches into another.
    let row = (1..).find(|&row: &u64| row.saturating_pow(3) >= components.count as u64).unwrap_or(1);
    let place = |c: usize| {
        let c = c as u64;
        DVec3::new((c % row) as f64, (c / row % row) as f64, (c / (row * row)) as f64) * (1.25 * size)
    };
    let mut positions = Vec::with_capacity(mesh.vertex_count());
    let mut faces = vec![[VertexId(0); 3]; mesh.face_count()];
    // Components may share vertices where they touch. A vertex's copy is that of the component that was copied last.
    let mut copy_of: Vec<Option<(u32, VertexId)>> = vec![None; mesh.vertex_count()];
    let mut order: Vec<usize> = (0..mesh.face_count()).collect();
    order.sort_by_key(|&face| components.of_face[face]);
    for face in order {
        let component = components.of_face[face];
        faces[face] = mesh.topology().faces()[face].map(|vertex| match copy_of[vertex.index()] {
            Some((of, copy)) if of == component => copy,
            _ => {
                let c = component as usize;
                let copy = VertexId::new(positions.len());
                positions.push((mesh.position(vertex) - bounds[c].0) * scales[c] + place(c));
                copy_of[vertex.index()] = Some((component, copy));
                copy
            }
        });
    }
    let (topology, _) = Topology::new(positions.len(), faces);
    let copies = SurfaceMesh::assemble(positions, topology, mesh.sources().to_vec());
    let uniform = density.is_uniform() && counts.iter().all(|&count| count > 0);
    let weights = (!uniform).then(|| {
        let weights = mesh.topology().face_ids().zip(&components.of_face).map(|(face, &component)| {
            let c = component as usize;
            let share = if counts[c] > 0 { areas[c] / masses[c] } else { 0.0 };
            density.corners(face).map(|weight| weight * share)
        });
        weights.collect()
    });
    Ok((copies, weights))
}

/// The mass of each component.
fn masses(mesh: &SurfaceMesh, density: &Density) -> Vec<f64> {
    let components = mesh.topology().components();
    masses_of(mesh, &components.of_face, components.count, |face| density.face_mass(mesh, face))
}

fn masses_of(mesh: &SurfaceMesh, of_face: &[u32], count: usize, mass: impl Fn(FaceId) -> f64) -> Vec<f64> {
    let mut masses = vec![0.0; count];
    for face in mesh.topology().face_ids() {
        masses[of_face[face.index()] as usize] += mass(face);
    }
    masses
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::planted;
    use crate::progress::Silent;
    use crate::shapes::{self, Shape};

    /// Cubes of these sizes in a row.
    fn cubes(sizes: &[f64]) -> SurfaceMesh {
        let mut soup = crate::PolygonSoup::default();
        for (i, &size) in sizes.iter().enumerate() {
            let at = DVec3::X * (3.0 * i as f64);
            planted::join(&mut soup, &planted::moved(shapes::cube(2), |p| p * size + at));
        }
        planted::mesh(&soup)
    }

    fn found(mesh: &SurfaceMesh, density: &Density, counts: &[usize]) -> Vec<usize> {
        let components = mesh.topology().components();
        let mut found = vec![0; components.count];
        let run = run(mesh, density, counts, &Options::for_count(1), &Silent).unwrap();
        assert_eq!(run.samples.len(), counts.iter().sum::<usize>());
        for point in run.points() {
            found[components.of_face[point.face.index()] as usize] += 1;
        }
        found
    }

    #[test]
    fn counts_by_hand() {
        // Areas 1 : 4 : 0.01.
        let mesh = cubes(&[1.0, 2.0, 0.1]);
        let shared = |count, least| at_least(&mesh, &Density::UNIFORM, count, least);
        // Of 502 points the shares are 100.2, 400.8 and 1.002.
        assert_eq!(shared(502, 0), Ok(vec![100, 401, 1]));
        assert_eq!(shared(502, 1), Ok(vec![100, 401, 1]));
        assert_eq!(shared(502, 2), Ok(vec![100, 400, 2]));
        assert_eq!(shared(502, 150), Ok(vec![150, 202, 150]));
        assert_eq!(shared(6, 2), Ok(vec![2, 2, 2]));
        let error = shared(5, 2).unwrap_err();
        assert_eq!(error, TooFewPoints { count: 5, least: 2, components: 3, needed: 6 });
        assert_eq!(
            error.to_string(),
            "5 points are fewer than 2 for each of 3 connected components: 6 or more are needed"
        );
        // A component without weight is left out.
        let mut weights = vec![1.0; mesh.face_count()];
        weights[..mesh.face_count() / 3].fill(0.0);
        let density = Density::of_faces(&mesh, &weights).unwrap();
        assert_eq!(at_least(&mesh, &density, 5, 2), Ok(vec![0, 3, 2]));
        assert_eq!(each(&mesh, &density, 7), [0, 7, 7]);
        let refused =
            |counts: &[usize], options| run(&mesh, &density, counts, &options, &Silent).unwrap_err();
        let options = Options::for_count(1);
        assert_eq!(refused(&[1, 1, 1], options), DensityError::NoWeight { component: 0 }.into());
        assert_eq!(refused(&[0, 0, 0], options), DensityError::Zero.into());
        let length = DensityError::Length { found: 2, expected: 3, elements: "components" };
        assert_eq!(refused(&[1, 1], options), length.into());
        assert_eq!(refused(&[0, 1, 1], Options { equalize: None, ..options }), QuotaError::NotEqualized);
        let wrong = refused(&[0, 1, 1], Options { tolerance: -1.0, ..options });
        assert!(matches!(wrong, QuotaError::Options(OptionsError::OutOfRange { name: "tolerance", .. })));
        assert_eq!(found(&mesh, &density, &[0, 30, 4]), [0, 30, 4]);
    }

    #[test]
    fn one_component_is_as_without_counts() {
        let mesh = planted::mesh(&Shape::Torus.generate());
        let options = Options::for_count(123);
        let with = run(&mesh, &Density::UNIFORM, &[123], &options, &Silent).unwrap().samples;
        let without = crate::pipeline::run(&mesh, &options, &Silent).unwrap().samples;
        assert_eq!(with, without);
    }

    #[test]
    fn inside_a_component_points_follow_the_density() {
        // Two squares that touch in an edge's end, one a thousandth as large; both are three times as dense on the right.
        let mut soup = crate::PolygonSoup::default();
        for (size, at) in [(1.0, 0.0), (1e-3, 1.0)] {
            let square = planted::moved(shapes::square(16), |p| p * size + DVec3::new(at, at, 0.0));
            planted::join(&mut soup, &square);
        }
        let mesh = planted::mesh(&soup);
        assert_eq!(mesh.topology().components().count, 2);
        let middle = |p: DVec3, c: u32| p.x - if c == 0 { 0.5 } else { 1.0005 };
        let of_face = &mesh.topology().components().of_face;
        let weights: Vec<f64> = mesh
            .triangles()
            .zip(of_face)
            .map(|([a, b, c], &component)| if middle((a + b + c) / 3.0, component) > 0.0 { 3.0 } else { 1.0 })
            .collect();
        let density = Density::of_faces(&mesh, &weights).unwrap();
        let run = run(&mesh, &density, &[400, 400], &Options::for_count(1), &Silent).unwrap();
        for component in 0..2 {
            let here = run.points().filter(|p| of_face[p.face.index()] == component);
            let right = here.filter(|p| middle(mesh.locate(p), component) > 0.0).count();
            assert!((297..=303).contains(&right), "{right} of 400 in component {component}");
        }
    }

    #[test]
    fn equalized_points_meet_the_counts() {
        // Areas as 1 to 1e-8, and shapes whose strips are many or one; the cup has two components.
        let mut soup = Shape::Sphere.generate();
        planted::join(&mut soup, &planted::moved(Shape::Cup.generate(), |p| p * 0.1 + DVec3::X * 5.0));
        planted::join(&mut soup, &planted::moved(Shape::Torus.generate(), |p| p * 1e-4 - DVec3::X * 5.0));
        planted::join(&mut soup, &planted::moved(shapes::tetrahedron(), |p| p * 1e-3 - DVec3::Y * 5.0));
        let mesh = planted::mesh(&soup);
        for counts in [[50; 5], [1; 5], [200, 3, 4, 2, 1], [1, 2, 7, 300, 40], [0, 5, 0, 0, 7]] {
            assert_eq!(found(&mesh, &Density::UNIFORM, &counts), counts);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        #[test]
        fn every_component_has_its_quota(
            sizes in prop::collection::vec(0.01..1.0f64, 1..8), least in 0..20usize, more in 0..200usize,
        ) {
            let mesh = cubes(&sizes);
            let count = (sizes.len() * least + more).max(1);
            let counts = at_least(&mesh, &Density::UNIFORM, count, least).unwrap();
            prop_assert_eq!(counts.iter().sum::<usize>(), count);
            prop_assert!(counts.iter().all(|&c| c >= least));
            prop_assert_eq!(found(&mesh, &Density::UNIFORM, &counts), counts);
        }
    }
}
