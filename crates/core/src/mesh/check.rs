//! The check that turns a soup into a surface.

use glam::DVec3;

use crate::buckets::Buckets;
use crate::geometry::triangle;
use crate::ids::{FaceId, HalfedgeId, PolygonId, VertexId};
use crate::mesh::defect::{MeshError, RepairReport};
use crate::mesh::polygon::{self, Cut};
use crate::mesh::soup::PolygonSoup;
use crate::mesh::surface::{FaceSource, SurfaceMesh};
use crate::mesh::topology::Topology;
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
        let vertex = weld(&soup.positions);
        let mut faces = Faces::default();
        faces.add_polygons(soup, &vertex, &mut report)?;
        faces.drop_duplicates(vertex.len(), &mut report);
        if faces.corners.is_empty() {
            return Err(MeshError::NoArea { polygons: soup.polygon_count() });
        }
        let positions = faces.drop_isolated(&soup.positions);
        report.welded_vertices = vertex.iter().zip(0..).filter(|&(&v, own)| v != VertexId(own)).count();
        report.isolated_vertices = vertex.len() - report.welded_vertices - positions.len();

        let Faces { corners, mut sources } = faces;
        let (mut topology, split) = Topology::new(positions.len(), corners);
        report.non_manifold_edges = split.non_manifold;
        report.inconsistent_edges = split.inconsistent;
        if options.turn_outward {
            let (turned, count) = inward_faces(&positions, &topology);
            report.turned_components = count;
            if count > 0 {
                topology = turn(&topology, &mut sources, &turned);
            }
        }
        Ok((Self::assemble(positions, topology, sources), report))
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

/// For each vertex the first one at the same position.
fn weld(positions: &[DVec3]) -> Vec<VertexId> {
    // Adding 0.0 turns -0.0 into 0.0.
    let bits_of = |v: usize| positions[v].to_array().map(|x| (x + 0.0).to_bits());
    let hash = |v: usize| {
        bits_of(v)
            .iter()
            .fold(0u64, |h, x| ((h ^ x) ^ (h >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(32))
    };
    // Hashes in buckets, each sorted by itself: one a vertex is several times faster than three coordinates.
    const PIECE: usize = 1 << 14;
    let pieces = positions.len().div_ceil(PIECE);
    let bits = pieces.next_power_of_two().ilog2();
    let buckets = Buckets::new(
        pieces,
        |p| (p * PIECE..((p + 1) * PIECE).min(positions.len())).map(|v| (hash(v), v as u32)).collect(),
        1 << bits,
        // The lower half of a hash has what the product mixed best.
        |&(hash, _)| (u64::from(hash as u32) << bits >> 32) as usize,
    );
    let welded = parallel::map(buckets.count(), |bucket| {
        let mut order: Vec<(u64, u32)> = buckets.bucket(bucket).copied().collect();
        order.sort_unstable();
        let mut welded = Vec::new();
        for group in order.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            let mut same_hash: Vec<_> = group.iter().map(|&(_, v)| (bits_of(v as usize), v)).collect();
            same_hash.sort_unstable();
            for same in same_hash.chunk_by(|a, b| a.0 == b.0) {
                welded.extend(same[1..].iter().map(|&(_, v)| (v, same[0].1)));
            }
        }
        welded
    });
    let mut first: Vec<VertexId> = (0..positions.len()).map(VertexId::new).collect();
    for (vertex, same) in welded.into_iter().flatten() {
        first[vertex as usize] = VertexId(same);
    }
    first
}

/// The triangles that are kept, with where they came from.
#[derive(Default)]
struct Faces {
    corners: Vec<[VertexId; 3]>,
    sources: Vec<FaceSource>,
}

impl Faces {
    /// Adds the triangles with an area of all polygons; `vertex` names the vertex to take for each of the soup's.
    fn add_polygons(
        &mut self,
        soup: &PolygonSoup,
        vertex: &[VertexId],
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
                let v = *vertex.get(index as usize).ok_or(MeshError::IndexOutOfRange {
                    polygon,
                    corner,
                    index,
                    vertices: vertex.len(),
                })?;
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
        let mut face = 0..;
        self.corners.retain(|_| face.next().is_none_or(keep));
        let mut face = 0..;
        self.sources.retain(|_| face.next().is_none_or(keep));
    }

    /// Renumbers the corners without gaps and gives the positions they stand for, in the old order.
    fn drop_isolated(&mut self, positions: &[DVec3]) -> Vec<DVec3> {
        let mut used = vec![false; positions.len()];
        for v in self.corners.iter().flatten() {
            used[v.index()] = true;
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

/// Whether the triangle has an area beyond rounding, and a normal.
fn has_area(a: DVec3, b: DVec3, c: DVec3) -> bool {
    let vector = triangle::area_vector(a, b, c);
    let longest = triangle::longest_side([a, b, c]).1.sqrt();
    let coordinate = a.abs().max(b.abs()).max(c.abs()).max_element();
    // Twice the area is the longest side times the height over it. Its square must not be denormal, for the length
    // is taken from it.
    vector.length_squared().is_normal() && vector.length() > FLAT * f64::EPSILON * coordinate * longest
}

/// Which faces belong to a closed component with a negative volume, and how many such components there are.
fn inward_faces(positions: &[DVec3], topology: &Topology) -> (Vec<bool>, usize) {
    #[derive(Clone, Copy)]
    struct Component {
        closed: bool,
        low: DVec3,
        high: DVec3,
        volume: f64,
        summands: f64,
    }
    let start = Component {
        closed: true,
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
        volume: 0.0,
        summands: 0.0,
    };
    let components = topology.components();
    let mut of = vec![start; components.count];
    let triangle = |face: FaceId| topology.corners(face).map(|v| positions[v.index()]);
    for face in topology.face_ids() {
        let component = &mut of[components.of_face[face.index()] as usize];
        component.closed &= (0..3).all(|c| topology.twin(HalfedgeId::of(face, c)).is_some());
        for p in triangle(face) {
            component.low = component.low.min(p);
            component.high = component.high.max(p);
        }
    }
    for face in topology.face_ids() {
        let component = &mut of[components.of_face[face.index()] as usize];
        if component.closed {
            // From the component's own centre: far from the origin the summands would swallow the volume.
            let centre = component.low + (component.high - component.low) * 0.5;
            let [a, b, c] = triangle(face).map(|p| p - centre);
            let summand = a.dot(b.cross(c));
            component.volume += summand;
            component.summands += summand.abs();
        }
    }
    let inward = |c: &Component| c.closed && c.volume < -HOLLOW * c.summands;
    let turned = components.of_face.iter().map(|&c| inward(&of[c as usize])).collect();
    (turned, of.iter().filter(|c| inward(c)).count())
}

/// The same triangles with those marked turned over, their sources with them.
fn turn(topology: &Topology, sources: &mut [FaceSource], turned: &[bool]) -> Topology {
    let mut corners = topology.faces().to_vec();
    for ((corners, source), _) in corners.iter_mut().zip(sources).zip(turned).filter(|(_, turned)| **turned) {
        corners.swap(1, 2);
        source.corners.swap(1, 2);
        source.turned = true;
    }
    Topology::new(topology.vertex_count(), corners).0
}

#[cfg(test)]
#[path = "check_tests.rs"]
mod tests;
