//! The check that turns a soup into a surface.

use glam::DVec3;

use crate::geometry::triangle;
use crate::ids::{HalfedgeId, PolygonId, VertexId};
use crate::mesh::defect::{MeshError, RepairReport};
use crate::mesh::polygon::{self, Cut};
use crate::mesh::soup::PolygonSoup;
use crate::mesh::surface::{FaceSource, SurfaceMesh};
use crate::mesh::topology::Topology;
use crate::mesh::weld;
use crate::parallel;

/// The largest coordinate: its fourth power, which squared areas need, is far inside the range of `f64`.
const LARGEST: f64 = 1e60;
/// The smallest width of a mesh, for the same reason.
const SMALLEST: f64 = 1e-60;
/// A triangle whose height is not more than this many times the spacing of `f64` at its coordinates has no area:
/// rounding alone could have made it.
const FLAT: f64 = 16.0;
/// A component whose volume is below this part of the volume's summands is flat: it has no inside.
const HOLLOW: f64 = 1e-12;

/// What checking may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CheckOptions {
    /// Turn closed components that are wound inward outward. Default: true.
    pub turn_outward: bool,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self { turn_outward: true }
    }
}

impl SurfaceMesh {
    /// Checks a soup and joins its polygons into a surface of triangles:
    ///
    /// 1. vertices at exactly the same position become one (`-0.0` is `0.0`);
    /// 2. polygons with more than three corners are cut by constrained Delaunay triangulation in their best-fit
    ///    plane, concave ones too, without new vertices;
    /// 3. triangles without area and repeated triangles are left out, then vertices that no triangle uses;
    /// 4. triangles are joined across edges; an edge of more than two triangles, or of two wound against each
    ///    other, becomes a border;
    /// 5. closed components that enclose a negative volume are turned, if the options say so. The wall of a cavity
    ///    is a component of its own and is turned as well.
    ///
    /// What remains keeps its order, so a clean triangle mesh keeps its vertex and face numbers. Everything that
    /// changed is counted in the report. A needle keeps its place as long as its height is more than 16 times the
    /// spacing of `f64` at its coordinates; coordinates as small as 1e-60 and as large as 1e60 are taken.
    /// Linear time and memory, but for sorting some thousands of vertices at a time.
    ///
    /// # Errors
    /// [`MeshError`]: a coordinate that is not finite, an index out of range, no face, no area, or coordinates
    /// whose squared areas overflow or underflow.
    ///
    /// # Example
    /// ```
    /// use ldwrap::{CheckOptions, PolygonSoup, SurfaceMesh};
    /// let mut soup = PolygonSoup::default();
    /// soup.positions = [[0, 0], [2, 0], [2, 1], [0, 1]].map(|[x, y]| glam::dvec3(x as f64, y as f64, 0.0)).to_vec();
    /// soup.push_polygon(&[0, 1, 2, 3]);
    /// let (mesh, report) = SurfaceMesh::from_soup(&soup, &CheckOptions::default())?;
    /// assert_eq!((mesh.face_count(), mesh.area()), (2, 2.0));
    /// assert!(report.is_clean() && report.polygons_triangulated == 1);
    /// # Ok::<(), ldwrap::MeshError>(())
    /// ```
    pub fn from_soup(soup: &PolygonSoup, options: &CheckOptions) -> Result<(Self, RepairReport), MeshError> {
        check_counts(soup)?;
        check_coordinates(&soup.positions)?;
        let mut report = RepairReport::default();
        let repeated = weld::repeated(&soup.positions);
        let first = first_at(&repeated, soup.positions.len());
        let mut faces = match Faces::of_triangles(soup, first.as_deref()) {
            Some(faces) => faces,
            None => Faces::of_polygons(soup, first.as_deref(), &mut report)?,
        };
        if faces.twins.is_none() {
            faces.drop_duplicates(soup.positions.len(), &mut report);
        }
        if faces.corners.is_empty() {
            return Err(MeshError::NoArea { polygons: soup.polygon_count() });
        }
        let positions = faces.drop_isolated(&soup.positions);
        report.welded_vertices = repeated.len();
        report.isolated_vertices = soup.positions.len() - repeated.len() - positions.len();

        let Faces { corners, mut sources, areas, mut normals, twins } = faces;
        let mut topology = match twins {
            Some(twins) => Topology::joined(positions.len(), corners, twins),
            None => {
                let (topology, split) = Topology::new(positions.len(), corners);
                report.non_manifold_edges = split.non_manifold;
                report.inconsistent_edges = split.inconsistent;
                topology
            }
        };
        if options.turn_outward {
            let inward = inward_components(&positions, &topology, &areas, &normals);
            report.turned_components = inward.iter().filter(|inward| **inward).count();
            if report.turned_components > 0 {
                turn(&inward, &positions, &mut topology, &mut sources, &mut normals);
            }
        }
        Ok((Self::measured(positions, topology, sources, areas, normals), report))
    }
}

/// Everything must be countable with 32 bits, half-edges too, and the ends must cut all corners into polygons.
fn check_counts(soup: &PolygonSoup) -> Result<(), MeshError> {
    let limit = u32::MAX as usize - 1;
    for (what, count) in [("vertices", soup.positions.len()), ("corners", soup.corners.len())] {
        if count > limit {
            return Err(MeshError::TooMany { what, count, limit });
        }
    }
    if soup.ends.is_empty() {
        return Err(MeshError::NoFace);
    }
    let mut start = 0;
    for (polygon, &end) in soup.ends.iter().enumerate() {
        if end < start || end as usize > soup.corners.len() {
            return Err(MeshError::BrokenEnds { polygon });
        }
        start = end;
    }
    if start as usize != soup.corners.len() {
        return Err(MeshError::BrokenEnds { polygon: soup.ends.len() });
    }
    Ok(())
}

/// Coordinates must be finite, and neither too large nor all too close together for squared areas.
fn check_coordinates(positions: &[DVec3]) -> Result<(), MeshError> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (vertex, &p) in positions.iter().enumerate() {
        if !p.is_finite() {
            return Err(MeshError::NotFinite { vertex, position: p.to_array() });
        }
        let coordinate = p.abs().max_element();
        if coordinate > LARGEST {
            return Err(MeshError::TooLarge { vertex, coordinate });
        }
        low = low.min(p);
        high = high.max(p);
    }
    let size = (high - low).max_element();
    if size > 0.0 && size < SMALLEST {
        return Err(MeshError::TooSmall { size });
    }
    Ok(())
}

/// For each vertex the first one at the same position; `None` if that is itself everywhere.
fn first_at(repeated: &[(VertexId, VertexId)], count: usize) -> Option<Vec<VertexId>> {
    if repeated.is_empty() {
        return None;
    }
    let mut first: Vec<VertexId> = (0..count).map(VertexId::new).collect();
    for &(vertex, same) in repeated {
        first[vertex.index()] = same;
    }
    Some(first)
}

/// The triangles that are kept, with where they came from.
#[derive(Default)]
struct Faces {
    corners: Vec<[VertexId; 3]>,
    sources: Vec<FaceSource>,
    areas: Vec<f64>,
    normals: Vec<DVec3>,
    /// The twins, as long as nothing has to be left out to join the triangles.
    twins: Option<Vec<u32>>,
}

impl Faces {
    /// All polygons, if they are triangles with three corners and an area. `first` names the vertex to take for each of
    /// the soup's.
    fn of_triangles(soup: &PolygonSoup, first: Option<&[VertexId]>) -> Option<Self> {
        let (polygons, remainder) = soup.corners.as_chunks::<3>();
        let vertices = soup.positions.len();
        let triangles = remainder.is_empty()
            && soup.ends.len() == polygons.len()
            && soup.ends.iter().zip(1..).all(|(&end, i)| end == 3 * i);
        if !triangles || soup.corners.iter().any(|&corner| corner as usize >= vertices) {
            return None;
        }
        let vertex = |corner: u32| first.map_or(VertexId(corner), |first| first[corner as usize]);
        let corners = parallel::map(polygons.len(), |polygon| {
            let [a, b, c] = polygons[polygon];
            [vertex(a), vertex(b), vertex(c)]
        });
        if corners.iter().any(|&[a, b, c]| a == b || b == c || c == a) {
            return None;
        }
        let source = |polygon: usize| {
            let start = 3 * polygon as u32;
            FaceSource {
                polygon: PolygonId::new(polygon),
                corners: [start, start + 1, start + 2],
                turned: false,
            }
        };
        let (((areas, normals), sources), twins) = parallel::join(
            || (measure(&corners, &soup.positions), parallel::map(corners.len(), source)),
            || Topology::clean_twins(vertices, &corners),
        );
        let all = areas.iter().all(|&area| area > 0.0);
        all.then_some(Self { corners, sources, areas, normals, twins })
    }

    /// The triangles with an area of all polygons.
    fn of_polygons(
        soup: &PolygonSoup,
        first: Option<&[VertexId]>,
        report: &mut RepairReport,
    ) -> Result<Self, MeshError> {
        let mut faces = Self::default();
        faces.add_polygons(soup, first, report)?;
        (faces.areas, faces.normals) = measure(&faces.corners, &soup.positions);
        faces.twins = Topology::clean_twins(soup.positions.len(), &faces.corners);
        Ok(faces)
    }

    /// Adds the triangles with an area of all polygons.
    fn add_polygons(
        &mut self,
        soup: &PolygonSoup,
        first: Option<&[VertexId]>,
        report: &mut RepairReport,
    ) -> Result<(), MeshError> {
        // Every triangle has three half-edges, which are numbered with 32 bits.
        let limit = (u32::MAX - 1) as usize / 3;
        self.corners.reserve(soup.polygon_count());
        self.sources.reserve(soup.polygon_count());
        let (mut corners, mut places, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        for polygon in 0..soup.polygon_count() {
            corners.clear();
            places.clear();
            triangles.clear();
            for (corner, place) in soup.corner_range(polygon).enumerate() {
                let index = soup.corners[place];
                let vertices = soup.positions.len();
                if index as usize >= vertices {
                    return Err(MeshError::IndexOutOfRange { polygon, corner, index, vertices });
                }
                let v = first.map_or(VertexId(index), |first| first[index as usize]);
                if corners.last() != Some(&v) {
                    corners.push(v);
                    places.push(place as u32);
                }
            }
            while corners.len() > 1 && corners.first() == corners.last() {
                corners.pop();
            }
            // Neighbouring corners differ, so a third one shows up by being neither of the first two.
            if corners.iter().all(|v| corners[..2.min(corners.len())].contains(v)) {
                report.degenerate_polygons += 1;
                continue;
            }
            let cut = polygon::triangulate(&soup.positions, &corners, &mut triangles);
            report.polygons_triangulated += usize::from(corners.len() > 3);
            report.fanned_polygons += usize::from(cut == Cut::Fan);
            for triangle in &triangles {
                let face = triangle.map(|i| corners[i]);
                let [a, b, c] = face.map(|v| soup.positions[v.index()]);
                if !has_area(a, b, c) {
                    report.zero_area_faces += 1;
                    continue;
                }
                self.corners.push(face);
                self.sources.push(FaceSource {
                    polygon: PolygonId::new(polygon),
                    corners: triangle.map(|i| places[i]),
                    turned: false,
                });
            }
            if self.corners.len() > limit {
                return Err(MeshError::TooMany { what: "triangles", count: self.corners.len(), limit });
            }
        }
        Ok(())
    }

    /// Keeps the first of all triangles with the same three corners; linear time.
    fn drop_duplicates(&mut self, vertices: usize, report: &mut RepairReport) {
        // Triangles by their smallest corner: few have the same, so all that is sorted is short.
        let mut starts = vec![0u32; vertices + 1];
        let smallest = |corners: &[VertexId; 3]| corners[0].min(corners[1]).min(corners[2]).index();
        for corners in &self.corners {
            starts[smallest(corners) + 1] += 1;
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut cursor = starts.clone();
        let mut order = vec![([VertexId(0); 2], 0u32); self.corners.len()];
        for (corners, face) in self.corners.iter().zip(0..) {
            let mut sorted = *corners;
            sorted.sort_unstable();
            let slot = &mut cursor[sorted[0].index()];
            order[*slot as usize] = ([sorted[1], sorted[2]], face);
            *slot += 1;
        }
        let mut repeated: Vec<u32> = Vec::new();
        for vertex in 0..vertices {
            let same = &mut order[starts[vertex] as usize..starts[vertex + 1] as usize];
            same.sort_unstable();
            repeated.extend(same.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1].1));
        }
        if repeated.is_empty() {
            return;
        }
        report.duplicate_faces = repeated.len();
        repeated.sort_unstable();
        let keep = |face: u32| repeated.binary_search(&face).is_err();
        fn retain<T>(items: &mut Vec<T>, keep: impl Fn(u32) -> bool) {
            let mut face = 0..;
            items.retain(|_| face.next().is_none_or(&keep));
        }
        retain(&mut self.corners, keep);
        retain(&mut self.sources, keep);
        retain(&mut self.areas, keep);
        retain(&mut self.normals, keep);
    }

    /// Renumbers the corners without gaps and gives the positions they stand for, in the old order.
    fn drop_isolated(&mut self, positions: &[DVec3]) -> Vec<DVec3> {
        let mut used = vec![false; positions.len()];
        for v in self.corners.iter().flatten() {
            used[v.index()] = true;
        }
        if used.iter().all(|&used| used) {
            return positions.to_vec();
        }
        let mut kept = Vec::with_capacity(positions.len());
        let number: Vec<VertexId> = positions
            .iter()
            .zip(&used)
            .map(|(&position, &used)| {
                let number = VertexId::new(kept.len());
                if used {
                    kept.push(position);
                }
                number
            })
            .collect();
        for v in self.corners.iter_mut().flatten() {
            *v = number[v.index()];
        }
        kept
    }
}

/// The areas and unit normals of triangles; both 0 where there is no area beyond rounding.
fn measure(corners: &[[VertexId; 3]], positions: &[DVec3]) -> (Vec<f64>, Vec<DVec3>) {
    parallel::map_pairs(corners.len(), |face| {
        let [a, b, c] = corners[face];
        let [a, b, c] = [positions[a.index()], positions[b.index()], positions[c.index()]];
        if !has_area(a, b, c) {
            return (0.0, DVec3::ZERO);
        }
        let vector = triangle::area_vector(a, b, c);
        let length = vector.length();
        (0.5 * length, vector / length)
    })
}

/// Whether the triangle has an area beyond rounding, and a normal.
fn has_area(a: DVec3, b: DVec3, c: DVec3) -> bool {
    let vector = triangle::area_vector(a, b, c);
    let longest = triangle::longest_side([a, b, c]).1.sqrt();
    let coordinate = a.abs().max(b.abs()).max(c.abs()).max_element();
    // Twice the area is the longest side times the height over it. Its square must not be denormal, for the length
    // is taken from it.
    vector.length_squared().is_normal() && vector.length() > FLAT * f64::EPSILON * coordinate * longest
}

/// Which components are closed and have a negative volume.
fn inward_components(
    positions: &[DVec3],
    topology: &Topology,
    areas: &[f64],
    normals: &[DVec3],
) -> Vec<bool> {
    let components = topology.components();
    let mut closed = vec![true; components.count];
    for face in topology.face_ids() {
        if (0..3).any(|c| topology.twin(HalfedgeId::of(face, c)).is_none()) {
            closed[components.of_face[face.index()] as usize] = false;
        }
    }
    if !closed.contains(&true) {
        return closed;
    }
    let mut boxes = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); components.count];
    let hold = |(low, high): &mut (DVec3, DVec3), p: DVec3| (*low, *high) = (low.min(p), high.max(p));
    if let [all] = &mut boxes[..] {
        // Every vertex belongs to it.
        positions.iter().for_each(|&p| hold(all, p));
    } else {
        for (corners, &component) in topology.faces().iter().zip(&components.of_face) {
            corners.iter().for_each(|v| hold(&mut boxes[component as usize], positions[v.index()]));
        }
    }
    // From the component's own centre: far from the origin the summands would swallow the volume.
    let centres: Vec<DVec3> = boxes.iter().map(|&(low, high)| low + (high - low) * 0.5).collect();
    let mut volumes = vec![(0.0, 0.0); components.count];
    for (face, &component) in components.of_face.iter().enumerate() {
        let from_centre = positions[topology.faces()[face][0].index()] - centres[component as usize];
        let summand = areas[face] * from_centre.dot(normals[face]);
        let (volume, summands) = &mut volumes[component as usize];
        *volume += summand;
        *summands += summand.abs();
    }
    closed
        .iter()
        .zip(volumes)
        .map(|(&closed, (volume, summands))| closed && volume < -HOLLOW * summands)
        .collect()
}

/// Turns the triangles of some components over, their sources and normals with them.
fn turn(
    turned: &[bool],
    positions: &[DVec3],
    topology: &mut Topology,
    sources: &mut [FaceSource],
    normals: &mut [DVec3],
) {
    let components = topology.components().of_face.clone();
    let is_turned = |face: usize| turned[components[face] as usize];
    topology.turn(|face| is_turned(face.index()));
    for (_, source) in sources.iter_mut().enumerate().filter(|(face, _)| is_turned(*face)) {
        source.corners.swap(1, 2);
        source.turned = true;
    }
    const PIECE: usize = 1 << 12;
    parallel::change_chunks(normals, PIECE, |start, normals| {
        for (face, normal) in (start..).zip(normals).filter(|(face, _)| is_turned(*face)) {
            let [a, b, c] = topology.faces()[face].map(|v| positions[v.index()]);
            let vector = triangle::area_vector(a, b, c);
            *normal = vector / vector.length();
        }
    });
}

#[cfg(test)]
#[path = "check_tests.rs"]
mod tests;
