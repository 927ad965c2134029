//! Planted answers: every attribute is known where it is looked up.

use std::collections::BTreeMap;

use base64::Engine as _;
use glam::{DVec2, DVec3, DVec4};

use super::*;
use crate::io::{Detail, Model, ReadError, read_model};
use crate::mesh::shapes::Shape;
use crate::mesh::{CheckOptions, SurfaceMesh};
use crate::sample::SurfacePoint;
use crate::spatial::nearest;

/// A picture of 4 x 2 texels, all different, as PNG: row by row from the upper left.
fn texels() -> Vec<[u8; 4]> {
    (0..8u8).map(|i| [30 * i, 255 - 20 * i, 3 * i * i, 255]).collect()
}

fn png(width: u32, texels: &[[u8; 4]]) -> Vec<u8> {
    let height = texels.len() as u32 / width;
    let picture = image::RgbaImage::from_raw(width, height, texels.concat()).expect("enough bytes");
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("a PNG");
    bytes.into_inner()
}

struct Read {
    mesh: SurfaceMesh,
    attributes: MeshAttributes,
}

fn read_with(bytes: &[u8], files: &BTreeMap<&str, Vec<u8>>) -> Result<Read, ReadError> {
    let resolver = |name: &str| files.get(name).cloned().ok_or_else(|| "it is not there".to_owned());
    let Model { soup, attributes } = read_model(bytes, None, Detail::Textures, &resolver)?;
    let (mesh, _) = SurfaceMesh::from_soup(&soup, &CheckOptions::default()).expect("a mesh");
    Ok(Read { mesh, attributes })
}

fn read(bytes: &[u8]) -> Read {
    read_with(bytes, &BTreeMap::new()).unwrap_or_else(|error| panic!("{error}"))
}

impl Read {
    fn point(&self, place: DVec3) -> SurfacePoint {
        let found = nearest(&self.mesh, &[place])[0];
        assert!(found.distance < 1e-9, "{place} is not on the surface");
        found.point
    }

    fn color_at(&self, x: f64, y: f64) -> [u8; 4] {
        let point = self.point(DVec3::new(x, y, 0.0));
        to_srgb8(Places::new(&self.mesh, &self.attributes).color(&self.mesh, &point).expect("a colour"))
    }
}

/// A square of 2 x 1 whose texture coordinates are `scale` times its place, origin at the lower left; the node is moved
/// by `x`, the material has these JSON members.
fn gltf(scale: f32, material: &str, sampler: &str, extra_attributes: &str, extra: &[f32]) -> Vec<u8> {
    let mut floats: Vec<f32> = [[0., 0., 0.], [2., 0., 0.], [2., 1., 0.], [0., 1., 0.]].concat();
    floats.extend([[0., 1.], [1., 1.], [1., 0.], [0., 0.]].concat().iter().map(|x| x * scale));
    floats.extend(extra);
    let mut bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    let indices = bytes.len();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let base64 = |bytes: &[u8]| base64::engine::general_purpose::STANDARD.encode(bytes);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0,"name":"plate"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1{extra_attributes}}},"indices":2,"material":0}}]}}],
        "materials":[{{"name":"paint","pbrMetallicRoughness":{{{material}}}}}],
        "textures":[{{"source":0,"sampler":0}}],"samplers":[{{{sampler}}}],
        "images":[{{"uri":"data:image/png;base64,{}"}}],
        "accessors":[
          {{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[2,1,0]}},
          {{"bufferView":0,"byteOffset":48,"componentType":5126,"count":4,"type":"VEC2"}},
          {{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}},
          {{"bufferView":0,"byteOffset":80,"componentType":5126,"count":4,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{indices}}},{{"buffer":0,"byteOffset":{indices},"byteLength":12}}],
        "buffers":[{{"byteLength":{},"uri":"data:;base64,{}"}}]}}"#,
        base64(&png(4, &texels())),
        bytes.len(),
        base64(&bytes),
    )
    .replace(if extra.is_empty() { ",\n          {\"bufferView\":0,\"byteOffset\":80" } else { "\0" }, ",{\"bufferView\":0,\"byteOffset\":0")
    .into_bytes()
}

/// The middle of a texel in the plane of the square.
fn middle(column: usize, row: usize) -> (f64, f64) {
    ((column as f64 + 0.5) / 2.0, 1.0 - (row as f64 + 0.5) / 2.0)
}

const TEXTURE: &str = r#""baseColorTexture":{"index":0}"#;

#[test]
fn texels_of_a_gltf_square() {
    for sampler in ["", r#""magFilter":9728"#, r#""magFilter":9729"#, r#""wrapS":33071,"wrapT":33071"#] {
        let square = read(&gltf(1.0, TEXTURE, sampler, "", &[]));
        for (index, texel) in texels().into_iter().enumerate() {
            let (x, y) = middle(index % 4, index / 4);
            assert_eq!(square.color_at(x, y), texel, "texel {index} with {sampler}");
        }
    }
    // Away from the middles: the nearest texel, or linear light between two.
    let near = read(&gltf(1.0, TEXTURE, r#""magFilter":9728"#, "", &[]));
    assert_eq!(near.color_at(0.45, 0.95), texels()[0]);
    let linear = read(&gltf(1.0, TEXTURE, r#""magFilter":9729"#, "", &[]));
    let between = (from_srgb8(texels()[0]) + from_srgb8(texels()[1])) * 0.5;
    assert_eq!(linear.color_at(0.5, 0.75), to_srgb8(between));
}

#[test]
fn textures_go_on_beyond_their_edges() {
    // Texture coordinates run to 3; the middle of texel (column, row) of the repetition (i, j).
    let at = |column: usize, row: usize, i: f64, j: f64| {
        let (x, y) = middle(column, row);
        // The rows go down from the upper edge, where v of glTF is 0.
        ((x + 2.0 * i) / 3.0, 1.0 - (1.0 - y + j) / 3.0)
    };
    let repeat = read(&gltf(3.0, TEXTURE, "", "", &[]));
    let mirror = read(&gltf(3.0, TEXTURE, r#""wrapS":33648,"wrapT":33648"#, "", &[]));
    let clamp = read(&gltf(3.0, TEXTURE, r#""wrapS":33071,"wrapT":33071"#, "", &[]));
    for (i, j) in [(0.0, 0.0), (1.0, 0.0), (0.0, 2.0), (2.0, 1.0)] {
        for (column, row) in [(0, 0), (2, 1), (3, 0)] {
            let (x, y) = at(column, row, i, j);
            assert_eq!(repeat.color_at(x, y), texels()[row * 4 + column]);
            let turned =
                |index: usize, count: usize, k: f64| if k == 1.0 { count - 1 - index } else { index };
            assert_eq!(mirror.color_at(x, y), texels()[turned(row, 2, j) * 4 + turned(column, 4, i)]);
            let held = |index: usize, count: usize, k: f64| if k > 0.0 { count - 1 } else { index };
            assert_eq!(clamp.color_at(x, y), texels()[held(row, 2, j) * 4 + held(column, 4, i)]);
        }
    }
}

#[test]
fn pictures_go_on_by_their_own_rule_to_the_side_and_up() {
    let mixed = read(&gltf(3.0, TEXTURE, r#""wrapS":33071,"wrapT":10497"#, "", &[]));
    for (column, row) in [(0, 0), (1, 1), (3, 0)] {
        let (x, y) = middle(column, row);
        // In the second repetition to the side the last column goes on; in the third one down all is as in the first.
        let at = ((x + 2.0) / 3.0, 1.0 - (1.0 - y + 2.0) / 3.0);
        assert_eq!(mixed.color_at(at.0, at.1), texels()[row * 4 + 3]);
    }
}

#[test]
fn factor_and_vertex_colors_multiply_in_linear_light() {
    let factor = r#""baseColorFactor":[0.5,0.25,1.0,0.5],"baseColorTexture":{"index":0}"#;
    let colors = [[1.0, 0.5, 0.25]; 4].concat();
    let square = read(&gltf(1.0, factor, "", r#","COLOR_0":3"#, &colors));
    let (x, y) = middle(1, 0);
    let linear = from_srgb8(texels()[1]) * DVec4::new(0.5, 0.125, 0.25, 0.5);
    assert_eq!(square.color_at(x, y), to_srgb8(linear));
    let point = square.point(DVec3::new(x, y, 0.0));
    let places = Places::new(&square.mesh, &square.attributes);
    assert_eq!(places.vertex_color(&square.mesh, &point), Some(DVec4::new(1.0, 0.5, 0.25, 1.0)));
    assert_eq!(square.attributes.material_of.names(), ["paint"]);
    assert_eq!(square.attributes.parts.names(), ["plate"]);
    assert_eq!(
        (places.material(&square.mesh, point.face), places.part(&square.mesh, point.face)),
        (Some(0), Some(0))
    );
    let uv = places.uv(&square.mesh, &point).expect("coordinates");
    assert!(uv.distance(DVec2::new(x / 2.0, y)) < 1e-12, "{uv}");
}

#[test]
fn texture_transform_turns_counterclockwise() {
    // A quarter turn: what was at (u, v) is looked up at (v, -u) from the upper left; then the offset.
    let moved = r#""baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":
        {"offset":[0.0,1.0],"rotation":1.5707963267948966,"scale":[1.0,1.0]}}}"#;
    let square = read(&gltf(1.0, moved, r#""magFilter":9728"#, "", &[]));
    // (u, v) = (0.3, 0.4) leads to (0.4, 0.7): column 1, row 1.
    assert_eq!(square.color_at(0.6, 0.6), texels()[5]);
}

const OBJ: &str = "mtllib a b.mtl\no plate\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                   usemtl paint\nf 1/1 2/2 3/3 4/4\ng other\nusemtl plain\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\n";

#[test]
fn texels_of_an_obj_square() {
    let mtl =
        "newmtl paint\nKd 1 1 1\nmap_Kd pictures\\four by two.png\nnewmtl plain\nKd 0.2 0.4 0.6\nd 0.5\n";
    let mut files = BTreeMap::from([
        ("a b.mtl", mtl.as_bytes().to_vec()),
        ("pictures/four by two.png", png(4, &texels())),
    ]);
    let square = read_with(OBJ.as_bytes(), &files).expect("a model");
    for (index, texel) in texels().into_iter().enumerate() {
        let (x, y) = middle(index % 4, index / 4);
        assert_eq!(square.color_at(x, y), texel, "texel {index}");
    }
    assert_eq!(square.color_at(5.25, 0.25), [51, 102, 153, 128]);
    let places = Places::new(&square.mesh, &square.attributes);
    let names = |x: f64| {
        let face = square.point(DVec3::new(x, 0.25, 0.0)).face;
        let name = |names: &PolygonNames, index: Option<usize>| names.names()[index.expect("a name")].clone();
        let (attributes, mesh) = (&square.attributes, &square.mesh);
        (
            name(&attributes.material_of, places.material(mesh, face)),
            name(&attributes.parts, places.part(mesh, face)),
        )
    };
    assert_eq!(names(1.0), ("paint".to_owned(), "plate".to_owned()));
    assert_eq!(names(5.1), ("plain".to_owned(), "other".to_owned()));
    assert_eq!(places.uv(&square.mesh, &square.point(DVec3::new(5.1, 0.1, 0.0))), None);

    // Kd is sRGB, and multiplied in linear light.
    files.insert("a b.mtl", mtl.replace("Kd 1 1 1", "Kd 0.5 1 1").into_bytes());
    let darker = read_with(OBJ.as_bytes(), &files).expect("a model");
    let (x, y) = middle(2, 0);
    let expected = from_srgb8(texels()[2]) * DVec4::new(from_srgb(0.5), 1.0, 1.0, 1.0);
    assert_eq!(darker.color_at(x, y), to_srgb8(expected));

    // Twice as small, and moved by a texel to the left and half the picture down.
    files.insert("a b.mtl", mtl.replace("map_Kd ", "map_Kd -s 2 2 1 -o 0.25 0.5 0 ").into_bytes());
    let scaled = read_with(OBJ.as_bytes(), &files).expect("a model");
    // u = 1/16 leads to 3/8, the middle of column 1; v = 5/8 to 7/4, the upper row.
    assert_eq!(scaled.color_at(0.125, 0.625), texels()[1]);

    files.remove("pictures/four by two.png");
    let error = read_with(OBJ.as_bytes(), &files).err().expect("no picture").to_string();
    assert!(error.contains("\"pictures/four by two.png\" is needed too"), "{error}");
    files.insert("pictures/four by two.png", b"GIF89a".to_vec());
    let error = read_with(OBJ.as_bytes(), &files).err().expect("no picture").to_string();
    assert!(error.contains("save it as PNG or JPEG"), "{error}");
}

#[test]
fn pictures_of_an_obj_repeat_or_are_clamped() {
    let obj = OBJ.replace("vt 1 0", "vt 3 0").replace("vt 1 1", "vt 3 3").replace("vt 0 1", "vt 0 3");
    let with = |option: &str| {
        let mtl = format!("newmtl paint\nmap_Kd {option} t.png\nnewmtl plain\n");
        let files = BTreeMap::from([("a b.mtl", mtl.into_bytes()), ("t.png", png(4, &texels()))]);
        read_with(obj.as_bytes(), &files).expect("a model")
    };
    let (repeat, clamp) = (with(""), with("-clamp on"));
    for (column, row) in [(0, 0), (2, 1), (3, 0)] {
        // In the third repetition to the right, the second up.
        let (x, y) = middle(column, row);
        let at = ((x + 4.0) / 3.0, (y + 1.0) / 3.0);
        assert_eq!(repeat.color_at(at.0, at.1), texels()[row * 4 + column]);
        assert_eq!(clamp.color_at(at.0, at.1), texels()[3], "the upper right corner goes on");
    }
}

#[test]
fn a_jpeg_picture_has_its_colors_to_rounding() {
    let color = [200, 100, 40];
    let picture = image::RgbImage::from_pixel(16, 16, image::Rgb(color));
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Jpeg).expect("a JPEG");
    let files = BTreeMap::from([
        ("a b.mtl", b"newmtl paint\nmap_Kd t.jpg\nnewmtl plain\n".to_vec()),
        ("t.jpg", bytes.into_inner()),
    ]);
    let found = read_with(OBJ.as_bytes(), &files).expect("a model").color_at(0.7, 0.3);
    assert!((0..3).all(|i| found[i].abs_diff(color[i]) <= 2) && found[3] == 255, "{found:?}");
}

/// The square of 2 x 1 with all its numbers as small integers (`KHR_mesh_quantization`): positions in halves, set right by
/// the node; normals and texture coordinates normalized.
fn quantized(required: &str) -> Vec<u8> {
    let base64 = |bytes: &[u8]| base64::engine::general_purpose::STANDARD.encode(bytes);
    let mut bytes: Vec<u8> = [[100u16, 7, 3, 0], [104, 7, 3, 0], [104, 9, 3, 0], [100, 9, 3, 0]]
        .as_flattened()
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend([[0i8, 76, 102, 0]; 4].as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend([[0u8, 255, 0, 0], [255, 255, 0, 0], [255, 0, 0, 0], [0, 0, 0, 0]].concat());
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":[{required}],"extensionsRequired":[{required}],
        "nodes":[{{"mesh":0,"scale":[0.5,0.5,0.5],"translation":[-50,-3.5,-1.5]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}},"indices":3,"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],
        "textures":[{{"source":0}}],"images":[{{"uri":"data:image/png;base64,{}"}}],
        "accessors":[
          {{"bufferView":0,"componentType":5123,"count":4,"type":"VEC3","min":[100,7,3],"max":[104,9,3]}},
          {{"bufferView":1,"componentType":5120,"normalized":true,"count":4,"type":"VEC3"}},
          {{"bufferView":2,"componentType":5121,"normalized":true,"count":4,"type":"VEC2"}},
          {{"bufferView":3,"componentType":5123,"count":6,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":32,"byteStride":8}},{{"buffer":0,"byteOffset":32,"byteLength":16,"byteStride":4}},
          {{"buffer":0,"byteOffset":48,"byteLength":16,"byteStride":4}},{{"buffer":0,"byteOffset":64,"byteLength":12}}],
        "buffers":[{{"byteLength":{},"uri":"data:;base64,{}"}}]}}"#,
        base64(&png(4, &texels())),
        bytes.len(),
        base64(&bytes),
    )
    .into_bytes()
}

#[test]
fn a_quantized_square_is_the_square() {
    let square = read(&quantized(r#""KHR_mesh_quantization""#));
    assert_eq!(square.mesh.bounds(), (DVec3::ZERO, DVec3::new(2.0, 1.0, 0.0)));
    for (index, texel) in texels().into_iter().enumerate() {
        let (x, y) = middle(index % 4, index / 4);
        assert_eq!(square.color_at(x, y), texel, "texel {index}");
    }
    let point = square.point(DVec3::new(0.7, 0.3, 0.0));
    let places = Places::new(&square.mesh, &square.attributes);
    assert!(places.normal(&square.mesh, &point).distance(DVec3::new(0.0, 76.0, 102.0).normalize()) < 1e-12);
    assert!(places.uv(&square.mesh, &point).expect("coordinates").distance(DVec2::new(0.35, 0.3)) < 1e-12);
}

#[test]
fn compressed_scenes_are_refused_by_name() {
    for extension in ["EXT_meshopt_compression", "KHR_draco_mesh_compression", "KHR_meshopt_compression"] {
        let bytes = quantized(&format!(r#""KHR_mesh_quantization","{extension}""#));
        let error = read_with(&bytes, &BTreeMap::new()).err().expect("it is compressed");
        let ReadError::Unsupported { what, advice, .. } = &error else { panic!("{error}") };
        assert!(what.contains(extension) && advice.contains("without compression"), "{error}");
    }
}

#[test]
fn corners_of_one_vertex_differ() {
    // Two triangles share an edge and have normals, coordinates of their own there; welding keeps them apart.
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 9 9\nvn 0 0 2\nvn 1 0 0\n\
                f 1/1/1 2/2/1 3/3/1\nf 5/4/2 3/4/2 4/4/2\n";
    let read = read(text.as_bytes());
    assert_eq!((read.mesh.vertex_count(), read.mesh.face_count()), (4, 2));
    let places = Places::new(&read.mesh, &read.attributes);
    for (place, normal, uv) in [
        (DVec3::new(0.75, 0.25, 0.0), DVec3::Z, DVec2::new(0.5, 0.25)),
        (DVec3::new(0.25, 0.75, 0.0), DVec3::X, DVec2::new(9.0, 9.0)),
    ] {
        let point = read.point(place);
        assert!(places.normal(&read.mesh, &point).distance(normal) < 1e-12);
        assert!(places.uv(&read.mesh, &point).expect("coordinates").distance(uv) < 1e-12);
    }
    let wrong = text.replace("4/4/2", "4/4/7");
    let error = read_with(wrong.as_bytes(), &BTreeMap::new()).err().expect("no normal").to_string();
    assert!(error.starts_with("OBJ, line 13: the corner \"4/4/7\" names what does not exist"), "{error}");
}

#[test]
fn smooth_and_flat_normals_of_a_sphere() {
    let (mesh, _) =
        SurfaceMesh::from_soup(&Shape::Sphere.generate(), &CheckOptions::default()).expect("a mesh");
    let attributes = MeshAttributes::default();
    let places = Places::new(&mesh, &attributes);
    let (mut smooth, mut flat) = (0.0f64, 0.0f64);
    for face in mesh.topology().face_ids() {
        for barycentric in [[1.0, 0.0, 0.0], [0.25, 0.5, 0.25], [1.0 / 3.0; 3]] {
            let point = SurfacePoint { face, barycentric };
            let outward = mesh.locate(&point).normalize();
            let normal = places.normal(&mesh, &point);
            assert!((normal.length() - 1.0).abs() < 1e-12);
            smooth = smooth.max(normal.angle_between(outward));
            flat = flat.max(mesh.face_normal(face).angle_between(outward));
        }
    }
    assert!(smooth < 0.03, "{smooth}");
    assert!(flat > 5.0 * smooth, "{flat} against {smooth}");
}

#[test]
fn normals_follow_the_surface() {
    // An octahedron wound inward with normals inward: both are turned outward.
    let octahedron = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\nvn -1 0 0\nvn 1 0 0\nvn 0 -1 0\nvn 0 1 0\n\
        vn 0 0 -1\nvn 0 0 1\nf 5//5 3//3 1//1\nf 5//5 2//2 3//3\nf 5//5 4//4 2//2\nf 5//5 1//1 4//4\n\
        f 6//6 1//1 3//3\nf 6//6 3//3 2//2\nf 6//6 2//2 4//4\nf 6//6 4//4 1//1\n";
    let turned = read(octahedron.as_bytes());
    let places = Places::new(&turned.mesh, &turned.attributes);
    for place in [DVec3::new(0.5, 0.25, 0.25), DVec3::new(-0.2, -0.3, 0.5), DVec3::X] {
        let point = turned.point(place);
        assert!(places.normal(&turned.mesh, &point).distance(place.normalize()) < 1e-9);
        assert!(turned.mesh.face_normal(point.face).dot(place) > 0.0);
    }
    // A node that squeezes and mirrors: normals stay perpendicular, and outside.
    let normals: Vec<f32> = [[0.0, 0.6, 0.8]; 4].concat();
    let text = String::from_utf8(gltf(1.0, "", "", r#","NORMAL":3"#, &normals)).expect("text");
    let text = text.replace("\"mesh\":0", "\"mesh\":0,\"scale\":[-1,2,1]");
    let squeezed = read(text.as_bytes());
    let point = squeezed.point(DVec3::new(-1.5, 1.0, 0.0));
    let normal = Places::new(&squeezed.mesh, &squeezed.attributes).normal(&squeezed.mesh, &point);
    assert!(normal.distance(DVec3::new(0.0, 0.3, 0.8).normalize()) < 1e-7, "{normal}");
    assert!(squeezed.mesh.face_normal(point.face).distance(DVec3::Z) < 1e-12);
}

#[test]
fn vertices_of_ply_and_off() {
    let head =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    let faces = "element face 1\nproperty list uchar int vertex_indices\n";
    let body = "end_header\n0 0 0 0 0 2 255 0 0 0.5 0 7\n4 0 0 0 0 1 0 255 0 1 0 3\n0 4 0 0 0 1 0 0 255 0 1 -1\n3 0 1 2\n";
    let ply = format!(
        "{head}property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n\
         property uchar blue\nproperty double s\nproperty double t\nproperty float quality\n{faces}{body}"
    );
    let triangle = read(ply.as_bytes());
    let places = Places::new(&triangle.mesh, &triangle.attributes);
    let corner = triangle.point(DVec3::new(4.0, 0.0, 0.0));
    assert_eq!(places.color(&triangle.mesh, &corner).map(to_srgb8), Some([0, 255, 0, 255]));
    assert_eq!(places.normal(&triangle.mesh, &corner), DVec3::Z);
    let inside = triangle.point(DVec3::new(1.0, 1.0, 0.0));
    let uv = places.uv(&triangle.mesh, &inside).expect("coordinates");
    assert!(uv.distance(DVec2::new(0.5, 0.25)) < 1e-12, "{uv}");
    let quality =
        triangle.attributes.numbers.iter().position(|(name, _)| name == "quality").expect("a number");
    let value = places.number(&triangle.mesh, &inside, quality).expect("a value");
    assert!((value - (3.5 + 0.75 - 0.25)).abs() < 1e-12, "{value}");
    let mixed = places.vertex_color(&triangle.mesh, &inside).expect("a colour");
    assert!(mixed.distance(DVec4::new(0.5, 0.25, 0.25, 1.0)) < 1e-12, "linear light, {mixed}");

    for (head, vertex) in [
        ("STNCOFF", "0 0 1 0 1 0 0.5 0.25 0.75"),
        ("NCOFF", "0 0 1 0 1 0 1"),
        ("NCOFF", "0 0 1 0 255 0"),
        ("COFF", "0 255 0 255"),
    ] {
        let off = format!("{head}\n3 1 0\n0 0 0 {vertex}\n4 0 0 {vertex}\n0 4 0 {vertex}\n3 0 1 2\n");
        let triangle = read(off.as_bytes());
        let places = Places::new(&triangle.mesh, &triangle.attributes);
        let inside = triangle.point(DVec3::new(1.0, 1.0, 0.0));
        let alpha = if head == "STNCOFF" { 128 } else { 255 };
        assert_eq!(places.color(&triangle.mesh, &inside).map(to_srgb8), Some([0, 255, 0, alpha]), "{head}");
        assert_eq!(places.normal(&triangle.mesh, &inside), DVec3::Z);
        let uv = (head == "STNCOFF").then_some(DVec2::new(0.25, 0.75));
        assert_eq!(places.uv(&triangle.mesh, &inside), uv);
    }
}

#[test]
fn solids_of_stl_are_parts() {
    let solid = |name: &str, z: f64| {
        format!(
            "solid {name}\nfacet normal 0 0 1\nouter loop\nvertex 0 0 {z}\nvertex 1 0 {z}\nvertex 0 1 {z}\nendloop\n\
             endfacet\nendsolid {name}\n"
        )
    };
    let both = read((solid("Lower Part", 0.0) + &solid("upper", 1.0)).as_bytes());
    let places = Places::new(&both.mesh, &both.attributes);
    let part = |z: f64| places.part(&both.mesh, both.point(DVec3::new(0.2, 0.2, z)).face);
    assert_eq!(both.attributes.parts.names(), ["Lower Part", "upper"]);
    assert_eq!((part(0.0), part(1.0)), (Some(0), Some(1)));
}

#[test]
fn all_bytes_of_srgb_come_back() {
    for byte in 0..=255u8 {
        let color = [byte, 255 - byte, byte / 2, byte];
        assert_eq!(to_srgb8(from_srgb8(color)), color);
    }
    // IEC 61966-2-1: half of the light is 188.
    assert_eq!(to_srgb8(DVec4::splat(0.5)), [188, 188, 188, 128]);
    assert_eq!(to_srgb8(DVec4::new(-1.0, 2.0, f64::NAN, 1.0)), [0, 255, 0, 255]);
}
