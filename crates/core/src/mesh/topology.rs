//! Which triangle lies beside which: half-edges, no positions and no floating point numbers.

use crate::ids::{FaceId, HalfedgeId, VertexId};

/// Marks a half-edge at the border inside the packed array; callers see `None`.
const BORDER: u32 = u32::MAX;

/// Corners of each triangle and the neighbour across each side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topology {
    faces: Vec<[VertexId; 3]>,
    twins: Vec<u32>,
    vertex_count: usize,
    components: Components,
}

/// Edges that could not join two triangles and became borders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SplitEdges {
    /// Edges shared by more than two triangles.
    pub(crate) non_manifold: usize,
    /// Edges of two triangles that run along it in the same direction (one of them is wound the wrong way).
    pub(crate) inconsistent: usize,
}

/// The connected components of a surface (connected across edges).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    /// The component of each face, numbered from 0 in order of their first face.
    pub of_face: Vec<u32>,
    /// How many there are.
    pub count: usize,
}

impl Topology {
    /// Joins triangles along shared edges. Edges of more than two triangles, and of two that are wound against
    /// each other, become borders. Linear time, no hashing: half-edges are bucketed by their smaller vertex.
    pub(crate) fn new(vertex_count: usize, faces: Vec<[VertexId; 3]>) -> (Self, SplitEdges) {
        let ends = |h: usize| {
            let f = faces[h / 3];
            (f[h % 3], f[(h % 3 + 1) % 3])
        };
        let halfedge_count = faces.len() * 3;
        let mut start = vec![0u32; vertex_count + 1];
        for h in 0..halfedge_count {
            let (a, b) = ends(h);
            start[a.min(b).index() + 1] += 1;
        }
        for v in 0..vertex_count {
            start[v + 1] += start[v];
        }
        let mut cursor = start.clone();
        let mut bucketed = vec![(0u32, 0u32); halfedge_count];
        for h in 0..halfedge_count {
            let (a, b) = ends(h);
            let slot = &mut cursor[a.min(b).index()];
            bucketed[*slot as usize] = (a.max(b).0, h as u32);
            *slot += 1;
        }
        let mut twins = vec![BORDER; halfedge_count];
        let mut split = SplitEdges::default();
        for v in 0..vertex_count {
            let bucket = &mut bucketed[start[v] as usize..start[v + 1] as usize];
            bucket.sort_unstable();
            let mut i = 0;
            while i < bucket.len() {
                let mut j = i + 1;
                while j < bucket.len() && bucket[j].0 == bucket[i].0 {
                    j += 1;
                }
                match j - i {
                    1 => {}
                    2 => {
                        let (g, h) = (bucket[i].1, bucket[i + 1].1);
                        if ends(g as usize).0 == ends(h as usize).0 {
                            split.inconsistent += 1;
                        } else {
                            twins[g as usize] = h;
                            twins[h as usize] = g;
                        }
                    }
                    _ => split.non_manifold += 1,
                }
                i = j;
            }
        }
        let components = Components::new(&twins);
        (Self { faces, twins, vertex_count, components }, split)
    }

    /// How many vertices there are.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// How many triangles there are.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The corners of all triangles, counterclockwise seen from outside.
    pub fn faces(&self) -> &[[VertexId; 3]] {
        &self.faces
    }

    /// All face ids in order.
    pub fn face_ids(&self) -> impl ExactSizeIterator<Item = FaceId> + use<> {
        (0..self.faces.len() as u32).map(FaceId)
    }

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, face: FaceId) -> [VertexId; 3] {
        self.faces[face.index()]
    }

    /// The same edge as the neighbouring triangle sees it, in the other direction; `None` at the border.
    #[inline]
    pub fn twin(&self, halfedge: HalfedgeId) -> Option<HalfedgeId> {
        let twin = self.twins[halfedge.index()];
        (twin != BORDER).then_some(HalfedgeId(twin))
    }

    /// Where the half-edge starts and ends.
    #[inline]
    pub fn ends(&self, halfedge: HalfedgeId) -> (VertexId, VertexId) {
        let f = self.faces[halfedge.index() / 3];
        let c = halfedge.corner();
        (f[c], f[(c + 1) % 3])
    }

    /// How many edges have a triangle on one side only.
    pub fn border_edge_count(&self) -> usize {
        self.twins.iter().filter(|&&t| t == BORDER).count()
    }

    /// How many edges there are, inner and border.
    pub fn edge_count(&self) -> usize {
        (self.twins.len() + self.border_edge_count()) / 2
    }

    /// The connected components.
    pub fn components(&self) -> &Components {
        &self.components
    }
}

impl Components {
    /// Linear time.
    fn new(twins: &[u32]) -> Self {
        const UNSEEN: u32 = u32::MAX;
        let mut of_face = vec![UNSEEN; twins.len() / 3];
        let mut count = 0;
        let mut stack = Vec::new();
        for seed in 0..of_face.len() {
            if of_face[seed] != UNSEEN {
                continue;
            }
            of_face[seed] = count;
            stack.push(seed);
            while let Some(face) = stack.pop() {
                for &twin in twins[3 * face..3 * face + 3].iter().filter(|&&twin| twin != BORDER) {
                    let neighbour = twin as usize / 3;
                    if of_face[neighbour] == UNSEEN {
                        of_face[neighbour] = count;
                        stack.push(neighbour);
                    }
                }
            }
            count += 1;
        }
        Self { of_face, count: count as usize }
    }
}
