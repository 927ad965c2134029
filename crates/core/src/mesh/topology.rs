//! Which triangle lies beside which: half-edges, no positions and no floating point numbers.

use prefetch_index::prefetch_index;

use crate::ids::{FaceId, HalfedgeId, VertexId};
use crate::sets::Sets;

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
        (Self::joined(vertex_count, faces, twins), split)
    }

    /// Triangles whose twins are known.
    pub(crate) fn joined(vertex_count: usize, faces: Vec<[VertexId; 3]>, twins: Vec<u32>) -> Self {
        let components = Components::new(&twins);
        Self { faces, twins, vertex_count, components }
    }

    /// The twins if no edge has more than two triangles or two that are wound against each other, and no two triangles
    /// have the same corners; else `None`. Linear time, and faster than [`new`](Self::new), which takes everything.
    pub(crate) fn clean_twins(vertex_count: usize, faces: &[[VertexId; 3]]) -> Option<Vec<u32>> {
        /// In longer buckets one is sought by halving.
        const FEW: usize = 16;
        let halfedges = || faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).zip(0_u32..);
        // Half-edges from a smaller to a larger vertex, in buckets by the smaller one.
        let mut ends = vec![0_u32; vertex_count + 1];
        for ((from, to), _) in halfedges() {
            if from < to {
                ends[from.index() + 1] += 1;
            }
        }
        for v in 0..vertex_count {
            ends[v + 1] += ends[v];
        }
        let mut upward = vec![(VertexId(0), 0_u32); ends[vertex_count] as usize];
        for ((from, to), h) in halfedges() {
            if from < to {
                let slot = &mut ends[from.index()];
                upward[*slot as usize] = (to, h);
                *slot += 1;
            }
        }
        // What were the starts of the buckets are their ends now.
        let range = |v: usize| if v == 0 { 0 } else { ends[v - 1] as usize }..ends[v] as usize;
        for v in 0..vertex_count {
            let bucket = &mut upward[range(v)];
            let repeats = if bucket.len() <= FEW {
                (1..bucket.len()).any(|i| bucket[..i].iter().any(|other| other.0 == bucket[i].0))
            } else {
                bucket.sort_unstable();
                bucket.windows(2).any(|pair| pair[0].0 == pair[1].0)
            };
            if repeats {
                return None;
            }
        }
        let mut twins = vec![BORDER; 3 * faces.len()];
        let mut alone = Vec::new();
        for ((from, to), h) in halfedges() {
            if from < to {
                continue;
            }
            let bucket = &upward[range(to.index())];
            let found = if bucket.len() <= FEW {
                bucket.iter().find(|other| other.0 == from)
            } else {
                bucket.binary_search_by_key(&from, |other| other.0).ok().map(|i| &bucket[i])
            };
            match found {
                Some(&(_, other)) if twins[other as usize] == BORDER => {
                    twins[other as usize] = h;
                    twins[h as usize] = other;
                }
                Some(_) => return None,
                None => alone.push((from, to)),
            }
        }
        alone.sort_unstable();
        if alone.windows(2).any(|pair| pair[0] == pair[1]) {
            return None;
        }
        // Two triangles that share two sides have the same corners.
        let twice = |a: u32, b: u32| a != BORDER && b != BORDER && a / 3 == b / 3;
        let repeated =
            twins.as_chunks().0.iter().any(|&[a, b, c]: &[u32; 3]| twice(a, b) || twice(b, c) || twice(c, a));
        (!repeated).then_some(twins)
    }

    /// Turns the triangles of some components over, none of which has a border: the last two corners change places.
    pub(crate) fn turn(&mut self, turned: impl Fn(FaceId) -> bool) {
        let (twins, _) = self.twins.as_chunks_mut::<3>();
        for ((corners, twins), face) in self.faces.iter_mut().zip(twins).zip((0..).map(FaceId)) {
            if turned(face) {
                corners.swap(1, 2);
                // The first side is the last one now.
                *twins = [2, 1, 0].map(|c| twins[c] / 3 * 3 + 2 - twins[c] % 3);
            }
        }
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

    /// Asks for the corners of a face, so that they are under way while other work is done.
    #[inline]
    pub(crate) fn fetch_corners(&self, face: FaceId) {
        prefetch_index(&self.faces, face.index());
    }

    /// Asks for the twin of a half-edge, so that it is under way while other work is done.
    #[inline]
    pub(crate) fn fetch_twin(&self, halfedge: HalfedgeId) {
        prefetch_index(&self.twins, halfedge.index());
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

    /// What is connected across sides for which `joins` says so; it hears each side once, as both triangles see it.
    pub(crate) fn components_across(&self, joins: impl Fn(HalfedgeId, HalfedgeId) -> bool) -> Components {
        Components::joined(&self.twins, joins)
    }
}

impl Components {
    fn new(twins: &[u32]) -> Self {
        Self::joined(twins, |_, _| true)
    }

    /// Those that are left when triangles are joined only across sides for which `joins` says so; it hears each side once,
    /// as both triangles see it, the later one first.
    ///
    /// Each triangle takes the label of a neighbour before it or a new one, and labels that meet are one component. Linear
    /// time but for an inverse Ackermann function, in the order of the triangles, which is near in space as a rule.
    fn joined(twins: &[u32], joins: impl Fn(HalfedgeId, HalfedgeId) -> bool) -> Self {
        let mut labels = Sets::new(0);
        let mut of_face: Vec<u32> = Vec::with_capacity(twins.len() / 3);
        for face in 0..twins.len() / 3 {
            let mut label = None;
            for (side, &twin) in (3 * face..).zip(&twins[3 * face..3 * face + 3]) {
                // Those that come later are not labelled yet, and borders are larger than all.
                let Some(&other) = of_face.get(twin as usize / 3) else { continue };
                if !joins(HalfedgeId(side as u32), HalfedgeId(twin)) {
                    continue;
                }
                label =
                    Some(label.map_or(
                        other,
                        |label| if label == other { label } else { labels.join(label, other) },
                    ));
            }
            of_face.push(label.unwrap_or_else(|| labels.add()));
        }
        // The least label of a component is that of its first face.
        let mut count = 0;
        let mut number = Vec::new();
        for label in 0..labels.len() as u32 {
            let root = labels.root(label);
            number.push(if root == label { count } else { number[root as usize] });
            count += u32::from(root == label);
        }
        if labels.len() > count as usize {
            for label in &mut of_face {
                *label = number[*label as usize];
            }
        }
        Self { of_face, count: count as usize }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Triangles among few vertices, which share edges and corners as they like.
    fn triangles(most: usize) -> impl Strategy<Value = Vec<[VertexId; 3]>> {
        let triangle = (0..9_u32, 1..9_u32, 1..8_u32).prop_map(|(a, b, c)| {
            let c = if c < b { c } else { c + 1 };
            [a, (a + b) % 9, (a + c) % 9].map(VertexId)
        });
        prop::collection::vec(triangle, 1..most)
    }

    fn has_repeated(faces: &[[VertexId; 3]]) -> bool {
        let sorted = |mut face: [VertexId; 3]| {
            face.sort_unstable();
            face
        };
        (1..faces.len()).any(|i| faces[..i].iter().any(|&other| sorted(other) == sorted(faces[i])))
    }

    proptest! {
        /// The short way gives what the long one gives, and tells where it cannot.
        #[test]
        fn clean_twins_are_the_twins(faces in triangles(8)) {
            let (topology, split) = Topology::new(9, faces.clone());
            let is_clean = split.non_manifold == 0 && split.inconsistent == 0 && !has_repeated(&faces);
            let expected = is_clean.then_some(topology.twins);
            prop_assert_eq!(Topology::clean_twins(9, &faces), expected);
        }

        /// Faces are of one component if a way across edges leads from one to the other; components come by their first face.
        #[test]
        fn components_are_what_edges_join(faces in triangles(14)) {
            let (topology, _) = Topology::new(9, faces);
            let mut of_face: Vec<usize> = (0..topology.face_count()).collect();
            for _ in 0..topology.face_count() {
                for (h, &twin) in topology.twins.iter().enumerate().filter(|(_, twin)| **twin != BORDER) {
                    of_face[h / 3] = of_face[h / 3].min(of_face[twin as usize / 3]);
                }
            }
            let mut firsts = of_face.clone();
            firsts.sort_unstable();
            firsts.dedup();
            let expected: Vec<u32> = of_face.iter().map(|first| firsts.binary_search(first).unwrap() as u32).collect();
            prop_assert_eq!(topology.components().count, firsts.len());
            prop_assert_eq!(&topology.components().of_face, &expected);
        }
    }

    /// Around a vertex with so many triangles that halving is the way to find one.
    #[test]
    fn a_fan_is_clean_until_one_triangle_is_there_twice() {
        let spoke = |i: u32| VertexId(1 + i % 50);
        let mut faces: Vec<_> = (0..50).map(|i| [VertexId(0), spoke(i), spoke(i + 1)]).collect();
        assert_eq!(Topology::clean_twins(51, &faces), Some(Topology::new(51, faces.clone()).0.twins));
        faces.push([spoke(31), VertexId(0), spoke(30)]);
        assert_eq!(Topology::clean_twins(51, &faces), None);
    }
}
