//! What belongs to the corners and triangles of a scene, collected while its meshes are walked.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{DAffine3, DMat3, DVec2, DVec3, DVec4};
use gltf::mesh::Primitive;
use gltf::{Accessor, Node, Semantic};

use super::accessor::vectors;
use super::buffers::Buffers;
use crate::attributes::{CornerValues, MeshAttributes};
use crate::io::limits::Limits;

/// The most sets of texture coordinates that are kept.
const MOST_SETS: u32 = 8;

/// The attributes so far.
#[derive(Default)]
pub(super) struct Collector {
    attributes: MeshAttributes,
    /// Turns normals of the mesh at hand into those of the scene.
    normal_matrix: DMat3,
    /// Where the values of an accessor begin; normals only for the mesh at hand, whose transform they have.
    normals: BTreeMap<usize, usize>,
    uv: BTreeMap<(u32, usize), usize>,
    colors: BTreeMap<usize, usize>,
    primitive: Values,
    /// The index of each material of the document in the names of the attributes.
    materials: BTreeMap<usize, usize>,
    part: Option<usize>,
    /// How many values of an attribute there may be.
    most: usize,
}

/// Where the values of the primitive at hand begin.
#[derive(Default)]
struct Values {
    normals: Option<usize>,
    uv: Vec<Option<usize>>,
    colors: Option<usize>,
    material: Option<usize>,
}

impl Collector {
    pub(super) fn new(limits: &Limits) -> Self {
        Self { most: limits.vertices, ..Self::default() }
    }

    /// A node shows a mesh.
    pub(super) fn enter(&mut self, node: &Node<'_>, mesh: &gltf::Mesh<'_>, transform: DAffine3) {
        // Normals are perpendicular to the surface also where it is scaled or mirrored.
        self.normal_matrix = transform.matrix3.inverse().transpose();
        self.normals.clear();
        let name = node.name().or(mesh.name());
        let name = name.map_or_else(|| format!("node {}", node.index()), str::to_owned);
        self.part = Some(self.attributes.parts.push(&name));
    }

    /// A primitive of `count` vertices begins.
    pub(super) fn begin(
        &mut self,
        primitive: &Primitive<'_>,
        count: usize,
        buffers: &Buffers,
    ) -> Result<(), String> {
        let Self { attributes, normal_matrix, most, .. } = self;
        let mut values = Values::default();
        if let Some(accessor) = wanted(primitive, &Semantic::Normals, count)? {
            let start = self.normals.get(&accessor.index()).copied();
            values.normals = Some(match start {
                Some(start) => start,
                None => {
                    room(&attributes.normals, count, *most)?;
                    let local = vectors(&accessor, "normals", buffers)?.into_iter().map(DVec3::from_array);
                    attributes.normals.extend(local.map(|n| (*normal_matrix * n).normalize_or_zero()))
                }
            });
            self.normals.extend(values.normals.map(|start| (accessor.index(), start)));
        }
        for set in 0..MOST_SETS {
            let Some(accessor) = wanted(primitive, &Semantic::TexCoords(set), count)? else { continue };
            let index = set as usize;
            if attributes.uv.len() <= index {
                attributes.uv.resize(index + 1, CornerValues::default());
            }
            values.uv.resize(index, None);
            let start = match self.uv.get(&(set, accessor.index())) {
                Some(&start) => start,
                None => {
                    room(&attributes.uv[index], count, *most)?;
                    let read = vectors(&accessor, "texture coordinates", buffers)?;
                    // The origin of glTF is the upper left corner.
                    attributes.uv[index].extend(read.into_iter().map(|[u, v]| DVec2::new(u, 1.0 - v)))
                }
            };
            self.uv.insert((set, accessor.index()), start);
            values.uv.push(Some(start));
        }
        if let Some(accessor) = wanted(primitive, &Semantic::Colors(0), count)? {
            let start = match self.colors.get(&accessor.index()) {
                Some(&start) => start,
                None => {
                    room(&attributes.colors, count, *most)?;
                    let read: Vec<DVec4> = if accessor.dimensions().multiplicity() == 3 {
                        let read = vectors(&accessor, "colours", buffers)?;
                        read.into_iter().map(|rgb| DVec3::from_array(rgb).extend(1.0)).collect()
                    } else {
                        vectors(&accessor, "colours", buffers)?.into_iter().map(DVec4::from_array).collect()
                    };
                    attributes.colors.extend(read)
                }
            };
            self.colors.insert(accessor.index(), start);
            values.colors = Some(start);
        }
        let material = primitive.material();
        values.material = material.index().map(|index| {
            *self.materials.entry(index).or_insert_with(|| {
                let name = material.name().map_or_else(|| format!("material {index}"), str::to_owned);
                attributes.material_of.push(&name)
            })
        });
        self.primitive = values;
        Ok(())
    }

    /// A triangle of the primitive's vertices stands at `corner` in the soup.
    pub(super) fn triangle(&mut self, corner: usize, vertices: [u32; 3]) {
        let Values { normals, uv, colors, .. } = &self.primitive;
        for (corner, vertex) in (corner..).zip(vertices) {
            let vertex = vertex as usize;
            if let Some(start) = normals {
                self.attributes.normals.set(corner, start + vertex);
            }
            for (set, start) in uv.iter().enumerate() {
                if let Some(start) = start {
                    self.attributes.uv[set].set(corner, start + vertex);
                }
            }
            if let Some(start) = colors {
                self.attributes.colors.set(corner, start + vertex);
            }
        }
    }

    /// The primitive had these polygons.
    pub(super) fn end(&mut self, polygons: Range<usize>) {
        self.attributes.material_of.set(polygons.clone(), self.primitive.material);
        self.attributes.parts.set(polygons, self.part);
    }

    pub(super) fn finish(self) -> (MeshAttributes, BTreeMap<usize, usize>) {
        (self.attributes, self.materials)
    }
}

/// The accessor of an attribute, which must have a value for each vertex.
fn wanted<'a>(
    primitive: &Primitive<'a>,
    semantic: &Semantic,
    count: usize,
) -> Result<Option<Accessor<'a>>, String> {
    match primitive.get(semantic) {
        Some(accessor) if accessor.count() != count => Err(format!(
            "accessor {}: it has {} items for {count} vertices",
            accessor.index(),
            accessor.count()
        )),
        accessor => Ok(accessor),
    }
}

/// A few bytes can ask for the same values a million times.
fn room<T: Copy>(values: &CornerValues<T>, count: usize, most: usize) -> Result<(), String> {
    if count > most.saturating_sub(values.value_count()) {
        return Err(format!("there are more than {most} values of an attribute"));
    }
    Ok(())
}
