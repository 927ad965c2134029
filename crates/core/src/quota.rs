//! Points for connected components: how many each is to get, and the density that gives it them.
//!
//! By area alone a small part of a model gets few points or none. Counts for the components are shared out first
//! ([`each`], [`at_least`]); a density made for them ([`Density::with_counts`]) then steers all stages, so equalized
//! points meet the counts exactly.
//!
//! ```
//! use ldwrap::density::Density;
//! use ldwrap::pipeline::{Options, run_weighted};
//! use ldwrap::{CheckOptions, Silent, SurfaceMesh, quota, shapes};
//!
//! // A cube and, a hundredth as large, another.
//! let mut soup = shapes::cube(2);
//! let (first, small) = (soup.positions.len() as u32, shapes::cube(1));
//! soup.positions.extend(small.positions.iter().map(|p| *p * 0.01 + glam::DVec3::X));
//! for polygon in 0..small.polygon_count() {
//!     soup.push_polygon(&small.polygon(polygon).iter().map(|v| v + first).collect::<Vec<_>>());
//! }
//! let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default())?;
//!
//! let counts = quota::at_least(&mesh, &Density::UNIFORM, 100, 10)?;
//! assert_eq!(counts, [90, 10]);
//! let density = Density::UNIFORM.with_counts(&mesh, &counts)?;
//! let samples = run_weighted(&mesh, &density, &Options::for_count(100), &Silent)?.samples;
//! let on_small = samples.iter().filter(|s| mesh.locate(&s.point).x > 0.9).count();
//! assert_eq!(on_small, 10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::density::{Density, DensityError};
use crate::mesh::SurfaceMesh;

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

impl Density {
    /// The density that gives these counts to the connected components, numbered as by
    /// [`components`](crate::Topology::components): inside each, places keep their proportions. With
    /// [`Request::Count`](crate::pipeline::Request::Count) of their sum, equalized points meet the counts exactly, others to
    /// within what wrapping gives. Linear time.
    ///
    /// # Errors
    /// [`DensityError`] when there is not one count for each component, or a component without weight is to have points,
    /// or no one is.
    ///
    /// # Panics
    /// If the density was made for a mesh with fewer faces.
    pub fn with_counts(&self, mesh: &SurfaceMesh, counts: &[usize]) -> Result<Self, DensityError> {
        let components = mesh.topology().components();
        if counts.len() != components.count {
            let (found, expected) = (counts.len(), components.count);
            return Err(DensityError::Length { found, expected, elements: "components" });
        }
        let masses = masses(mesh, self);
        if let Some(component) = (0..counts.len()).find(|&c| counts[c] > 0 && masses[c] <= 0.0) {
            return Err(DensityError::NoWeight { component });
        }
        let weights: Vec<[f64; 3]> = mesh
            .topology()
            .face_ids()
            .map(|face| {
                let component = components.of_face[face.index()] as usize;
                match counts[component] {
                    0 => [0.0; 3],
                    count => self.corners(face).map(|weight| weight * (count as f64 / masses[component])),
                }
            })
            .collect();
        Self::of_corners(mesh, &weights)
    }
}

/// The mass of each component.
fn masses(mesh: &SurfaceMesh, density: &Density) -> Vec<f64> {
    let components = mesh.topology().components();
    let mut masses = vec![0.0; components.count];
    for face in mesh.topology().face_ids() {
        masses[components.of_face[face.index()] as usize] += density.face_mass(mesh, face);
    }
    masses
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::pipeline::{Options, run_weighted};
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

    fn found(mesh: &SurfaceMesh, density: &Density, count: usize) -> Vec<usize> {
        let components = mesh.topology().components();
        let mut found = vec![0; components.count];
        let run = run_weighted(mesh, density, &Options::for_count(count), &Silent).unwrap();
        assert_eq!(run.samples.len(), count);
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
        assert_eq!(density.with_counts(&mesh, &[1, 1, 1]), Err(DensityError::NoWeight { component: 0 }));
        assert_eq!(density.with_counts(&mesh, &[0, 0, 0]), Err(DensityError::Zero));
        let length = DensityError::Length { found: 2, expected: 3, elements: "components" };
        assert_eq!(density.with_counts(&mesh, &[1, 1]), Err(length));
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
            let density = Density::UNIFORM.with_counts(&mesh, &counts).unwrap();
            assert_eq!(found(&mesh, &density, counts.iter().sum()), counts);
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
            let density = Density::UNIFORM.with_counts(&mesh, &counts).unwrap();
            prop_assert_eq!(found(&mesh, &density, count), counts);
        }
    }
}
