//! Reads the triangles of glTF 2.0 scenes and what belongs to them, with `gltf`.

mod accessor;
mod attributes;
mod buffers;
mod material;

use std::collections::BTreeMap;

use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf::mesh::{Mode, Primitive};
use gltf::{Document, Gltf, Node, Semantic};

use crate::io::detect::MeshFormat;
use crate::io::limits::Limits;
use crate::io::read::{Detail, Model, Place, ReadError, Resolver, brief, push_polygon};
use crate::mesh::PolygonSoup;
use attributes::Collector;
use buffers::Buffers;

/// Extensions that may be required because they do not change the shape, or are understood.
const HARMLESS: [&str; 7] = [
    "KHR_mesh_quantization",
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "EXT_texture_",
    "MSFT_texture_",
];

/// What to do about compressed meshes. No decoder is both established and Rust alone, which the page needs: see README.
const DECOMPRESS: &str =
    "write it without compression, as `gltf-transform copy` does (or gltfpack without -c)";

/// Whether an extension compresses meshes: `KHR_draco_mesh_compression`, `EXT_meshopt_compression` and its successors.
fn is_compression(extension: &str) -> bool {
    extension.contains("draco") || extension.contains("meshopt")
}

/// Reads a `.gltf` or `.glb` file: all triangles, strips and fans of the default scene (of the first if none is
/// the default, of all nodes if there is no scene), placed by their nodes' transforms; a mirroring transform turns
/// the triangles so that they keep their outside. Points and lines are passed over; skins and morph targets stay
/// at rest. Every node that shows a mesh adds its vertices again.
///
/// `resolver` gets the addresses of buffers that are not embedded, with `%20` and the like decoded.
///
/// # Errors
/// [`ReadError`]: with the part of the document.
pub fn read(bytes: &[u8], resolver: &Resolver<'_>) -> Result<PolygonSoup, ReadError> {
    read_model(bytes, Detail::Shape, resolver).map(|model| model.soup)
}

/// Reads a `.gltf` or `.glb` file with the normals, texture coordinates and `COLOR_0` of its corners, the names of its
/// nodes as parts (of their meshes, where a node has none) and of its materials; for [`Detail::Textures`] also the base
/// colours of materials: factor, texture (PNG or JPEG) with its sampler, and `KHR_texture_transform`.
///
/// # Errors
/// [`ReadError`]: with the part of the document.
pub fn read_model(bytes: &[u8], detail: Detail, resolver: &Resolver<'_>) -> Result<Model, ReadError> {
    read_within(bytes, detail, &Limits::default(), resolver)
}

/// A few bytes can ask for the same mesh a million times: every copy is held against the limits before it is made.
pub(super) fn read_within(
    bytes: &[u8],
    detail: Detail,
    limits: &Limits,
    resolver: &Resolver<'_>,
) -> Result<Model, ReadError> {
    let (document, blob) = parse(bytes)?;
    let buffers = Buffers::load(&document, blob, resolver)?;
    let mut soup = PolygonSoup::default();
    let mut collector = (detail >= Detail::Attributes).then(|| Collector::new(limits));
    for_each_mesh(&document, |node, mesh, transform| {
        if let Some(collector) = &mut collector {
            collector.enter(node, mesh, transform);
        }
        add_mesh(&mut soup, collector.as_mut(), mesh, transform, &buffers, limits)
    })?;
    let (mut attributes, materials) = collector.map(Collector::finish).unwrap_or_default();
    if detail >= Detail::Textures {
        material::load(&document, &materials, &mut attributes, &buffers, limits, resolver)?;
    }
    Ok(Model { soup, attributes })
}

/// The positions of all meshes of the scene, whatever they are made of.
///
/// # Errors
/// As [`read`].
#[cfg(feature = "io")]
pub(crate) fn vertices(bytes: &[u8], resolver: &Resolver<'_>) -> Result<Vec<DVec3>, ReadError> {
    let (document, blob) = parse(bytes)?;
    let buffers = Buffers::load(&document, blob, resolver)?;
    let mut vertices = Vec::new();
    let limits = Limits::default();
    for_each_mesh(&document, |_, mesh, transform| {
        let place = Place::Item("mesh", mesh.index());
        for positions in mesh.primitives().filter_map(|primitive| primitive.get(&Semantic::Positions)) {
            limits.vertices(MeshFormat::Gltf, place, positions.count().saturating_add(vertices.len()))?;
            let local = accessor::vectors(&positions, "positions", &buffers)
                .map_err(|problem| malformed(place, problem))?;
            vertices.extend(local.into_iter().map(|p| transform.transform_point3(DVec3::from_array(p))));
        }
        Ok(())
    })?;
    Ok(vertices)
}

/// Calls `f` with every node of the scene that shows a mesh, the mesh, and where it stands.
fn for_each_mesh(
    document: &Document,
    mut f: impl FnMut(&Node<'_>, &gltf::Mesh<'_>, DAffine3) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut seen = vec![false; document.nodes().len()];
    // Children are put on the stack in reverse: parts come in the order of the file.
    let mut stack: Vec<(Node<'_>, DAffine3)> =
        roots(document).into_iter().rev().map(|n| (n, DAffine3::IDENTITY)).collect();
    while let Some((node, parent)) = stack.pop() {
        if std::mem::replace(&mut seen[node.index()], true) {
            return Err(malformed(
                Place::Item("node", node.index()),
                "it has two parents, or is its own ancestor".into(),
            ));
        }
        let transform = parent * local(&node);
        if let Some(mesh) = node.mesh() {
            f(&node, &mesh, transform)?;
        }
        let children: Vec<_> = node.children().map(|child| (child, transform)).collect();
        stack.extend(children.into_iter().rev());
    }
    Ok(())
}

/// The checked document and the binary chunk.
fn parse(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), ReadError> {
    use gltf::json::validation::{Error, Validate};
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.starts_with(b"glTF") {
        let length = bytes.get(8..12).map(|l| u32::from_le_bytes([l[0], l[1], l[2], l[3]]) as usize);
        if length.is_none_or(|length| length < 20 || length > bytes.len()) {
            return Err(ReadError::Truncated {
                format: MeshFormat::Gltf,
                place: Place::Byte(8),
                problem: format!("the length in the head does not fit the {} bytes", bytes.len()),
            });
        }
    }
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes)
        .map_err(|error| malformed(Place::File, brief(&error.to_string())))?;
    let root = document.as_json();
    for extension in &root.extensions_required {
        if !HARMLESS.iter().any(|harmless| extension.starts_with(harmless)) {
            return Err(ReadError::Unsupported {
                format: MeshFormat::Gltf,
                place: Place::File,
                what: format!("the required extension {}", brief(extension)),
                advice: if is_compression(extension) { DECOMPRESS } else { "export it without extensions" },
            });
        }
    }
    // The library's validation itself relies on these.
    for (index, mesh) in root.meshes.iter().enumerate() {
        let mut accessors = mesh.primitives.iter().flat_map(|primitive| primitive.attributes.values());
        if accessors.any(|accessor| accessor.value() >= root.accessors.len()) {
            return Err(malformed(Place::Item("mesh", index), "an attribute has no accessor".into()));
        }
    }
    let mut first = None;
    root.validate(root, gltf::json::Path::new, &mut |path, error| {
        // The specification asks for positions, and for the box around them; neither is needed.
        let path = path().to_string();
        let needless = error != Error::IndexOutOfBounds && path.contains("attributes[\"POSITION\"]");
        if first.is_none() && error != Error::Unsupported && !needless {
            first = Some(format!("{}: {error}", brief(&path)));
        }
    });
    match first {
        Some(problem) => Err(malformed(Place::File, problem)),
        None => Ok((document, blob)),
    }
}

fn roots(document: &Document) -> Vec<Node<'_>> {
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        return scene.nodes().collect();
    }
    let mut is_child = vec![false; document.nodes().len()];
    for child in document.nodes().flat_map(|node| node.children()) {
        is_child[child.index()] = true;
    }
    document.nodes().filter(|node| !is_child[node.index()]).collect()
}

fn local(node: &Node<'_>) -> DAffine3 {
    match node.transform() {
        gltf::scene::Transform::Matrix { matrix } => {
            DAffine3::from_mat4(DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from))))
        }
        gltf::scene::Transform::Decomposed { translation, rotation, scale } => {
            // Stored in single precision, the quaternion's length is not exactly 1.
            let rotation = DQuat::from_array(rotation.map(f64::from));
            DAffine3::from_scale_rotation_translation(
                DVec3::from_array(scale.map(f64::from)),
                if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY },
                DVec3::from_array(translation.map(f64::from)),
            )
        }
    }
}

fn add_mesh(
    soup: &mut PolygonSoup,
    mut collector: Option<&mut Collector>,
    mesh: &gltf::Mesh<'_>,
    transform: DAffine3,
    buffers: &Buffers,
    limits: &Limits,
) -> Result<(), ReadError> {
    let turned = transform.matrix3.determinant() < 0.0;
    // Primitives may share their positions; each accessor is added once.
    let mut first_vertex = BTreeMap::new();
    for primitive in mesh.primitives() {
        let place = Place::Item("mesh", mesh.index());
        let kept = matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan);
        let Some(positions) = primitive.get(&Semantic::Positions).filter(|_| kept) else { continue };
        let count = positions.count();
        let first = match first_vertex.get(&positions.index()) {
            Some(&first) => first,
            None => {
                let first = soup.positions.len();
                limits.vertices(MeshFormat::Gltf, place, count.saturating_add(first))?;
                let local = accessor::vectors(&positions, "positions", buffers)
                    .map_err(|problem| malformed(place, problem))?;
                let local = local.into_iter().map(DVec3::from_array);
                soup.positions.extend(local.map(|p| transform.transform_point3(p)));
                first_vertex.insert(positions.index(), first);
                first
            }
        };
        let indices = match primitive.indices() {
            Some(indices) => {
                let indices =
                    accessor::indices(&indices, buffers).map_err(|problem| malformed(place, problem))?;
                if let Some(&index) = indices.iter().find(|&&index| index as usize >= count) {
                    let problem = format!(
                        "primitive {}: a corner is vertex {index}, but there are {count}",
                        primitive.index()
                    );
                    return Err(malformed(place, problem));
                }
                indices
            }
            None => (0..count as u32).collect(),
        };
        // In strips and fans every corner but two makes a triangle.
        let each = if primitive.mode() == Mode::Triangles { 1 } else { 3 };
        let corners = indices.len().saturating_mul(each).saturating_add(soup.corners.len());
        limits.corners(MeshFormat::Gltf, place, corners)?;
        let polygons = soup.polygon_count();
        if let Some(collector) = collector.as_deref_mut() {
            collector.begin(&primitive, count, buffers).map_err(|problem| malformed(place, problem))?;
        }
        for [a, b, c] in triangles(&primitive, &indices) {
            let triangle = if turned { [a, c, b] } else { [a, b, c] };
            if let Some(collector) = collector.as_deref_mut() {
                collector.triangle(soup.corners.len(), triangle);
            }
            push_polygon(soup, triangle.map(|index| index + first as u32), MeshFormat::Gltf, limits)?;
        }
        if let Some(collector) = collector.as_deref_mut() {
            collector.end(polygons..soup.polygon_count());
        }
    }
    Ok(())
}

/// The triangles of a list, strip or fan, without those that sew strips together.
fn triangles(primitive: &Primitive<'_>, indices: &[u32]) -> Vec<[u32; 3]> {
    match primitive.mode() {
        Mode::TriangleStrip => {
            let wound =
                |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
            let sews = |[a, b, c]: &[u32; 3]| a == b || b == c || c == a;
            indices.windows(3).enumerate().map(wound).filter(|t| !sews(t)).collect()
        }
        Mode::TriangleFan => indices.windows(2).skip(1).map(|w| [indices[0], w[0], w[1]]).collect(),
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}

fn malformed(place: Place, problem: String) -> ReadError {
    ReadError::Malformed { format: MeshFormat::Gltf, place, problem }
}

#[cfg(test)]
mod tests;
