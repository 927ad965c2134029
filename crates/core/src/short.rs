//! The short path: points of a mesh with nothing to decide but their number.

use glam::DVec3;

use crate::equalize::EqualizeOptions;
use crate::mesh::SurfaceMesh;
use crate::pipeline::{Options, OptionsError, Request, Run, run};
use crate::progress::Silent;
use crate::sample::{Sample, SurfacePoint};

/// Exactly `count` low-discrepancy points of a mesh, equalized: what `ldwrap-cli wrap -n` makes, to the bit. Everything
/// else is decided by [`Options::for_count`]; [`pipeline::run`](crate::pipeline::run) takes other options and keeps what
/// the stages made.
///
/// Cost: O((F + n) log n).
///
/// # Errors
/// [`OptionsError`] when `count` is 0 or too large.
///
/// # Example
/// ```
/// use ldwrap::shapes::Shape;
/// use ldwrap::{CheckOptions, SurfaceMesh};
/// let (mesh, _) = SurfaceMesh::from_soup(&Shape::Torus.generate(), &CheckOptions::default())?;
/// let samples = ldwrap::sample(&mesh, 250)?;
/// assert_eq!(samples.len(), 250);
/// let upper = mesh.locate_all(&samples).filter(|place| place.z > 0.0).count();
/// assert!((120..=130).contains(&upper));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sample(mesh: &SurfaceMesh, count: usize) -> Result<Vec<Sample>, OptionsError> {
    run(mesh, &Options::for_count(count), &Silent).map(|run| run.samples)
}

impl Options {
    /// Exactly `count` points, equalized, else the default: what [`sample`] and the program take. Start from it to change
    /// some: `Options { seed: 7, ..Options::for_count(500) }`.
    pub fn for_count(count: usize) -> Self {
        Self { request: Request::Count(count), equalize: Some(EqualizeOptions::default()), ..Self::default() }
    }
}

impl Run {
    /// The points alone, which measures take; nothing is allocated.
    pub fn points(&self) -> impl ExactSizeIterator<Item = SurfacePoint> + '_ {
        self.samples.iter().map(|sample| sample.point)
    }

    /// Where the points are, in units of the mesh that was run on; nothing is allocated.
    pub fn places<'a>(&'a self, mesh: &'a SurfaceMesh) -> impl ExactSizeIterator<Item = DVec3> + 'a {
        mesh.locate_all(&self.samples)
    }
}

impl SurfaceMesh {
    /// The places of samples or of points in space, in their order; nothing is allocated.
    pub fn locate_all<'a, P: AsRef<SurfacePoint>>(
        &'a self,
        points: &'a [P],
    ) -> impl ExactSizeIterator<Item = DVec3> + 'a {
        points.iter().map(|point| self.locate(point.as_ref()))
    }

    /// The corners of all faces in their order; nothing is allocated.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = [DVec3; 3]> + '_ {
        self.topology().face_ids().map(|face| self.triangle(face))
    }
}

impl AsRef<SurfacePoint> for SurfacePoint {
    fn as_ref(&self) -> &SurfacePoint {
        self
    }
}

impl AsRef<SurfacePoint> for Sample {
    fn as_ref(&self) -> &SurfacePoint {
        &self.point
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planted;
    use crate::shapes::Shape;

    #[test]
    fn the_short_path_is_the_run_of_its_options() {
        let mesh = planted::mesh(&Shape::Sphere.generate());
        let run = run(&mesh, &Options::for_count(77), &Silent).unwrap();
        assert_eq!(sample(&mesh, 77).unwrap(), run.samples);
        assert!(run.equalize.is_some());
        assert!(run.points().eq(run.samples.iter().map(|s| s.point)));
        assert!(run.places(&mesh).eq(run.samples.iter().map(|s| mesh.locate(&s.point))));
        let points: Vec<SurfacePoint> = run.points().collect();
        assert!(mesh.locate_all(&points).eq(run.places(&mesh)));
        assert_eq!(mesh.triangles().len(), mesh.face_count());
        assert_eq!(mesh.triangles().nth(5), Some(mesh.triangle(crate::FaceId(5))));
        assert!(matches!(sample(&mesh, 0), Err(OptionsError::OutOfRange { name: "count", .. })));
    }
}
