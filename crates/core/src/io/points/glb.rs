//! Points as binary glTF 2.0. Written by hand: the container is a head and two chunks, the document a few objects.

use std::io;

use serde_json::{Map, Value, json};

use crate::attributes::from_srgb8;
use crate::io::points::field::origin_number;
use crate::io::points::stream::invalid;
use crate::io::points::{Field, FieldData, PointPlace, Points, PointsError};

/// Component types of accessors.
const FLOAT: u32 = 5126;
const UNSIGNED_BYTE: u32 = 5121;
/// The mode of a primitive that is made of points.
const POINTS: u32 = 0;

/// The document and the buffer so far.
#[derive(Default)]
struct Document {
    buffer: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    attributes: Map<String, Value>,
    names: Map<String, Value>,
}

pub(super) fn write(fields: &[Field], out: &mut dyn io::Write) -> io::Result<()> {
    let mut document = Document::default();
    for field in fields {
        document.add(field)?;
    }
    let Document { mut buffer, views, accessors, attributes, names } = document;
    let mut mesh = json!({ "primitives": [{ "attributes": attributes, "mode": POINTS }] });
    if !names.is_empty() {
        mesh["extras"] = json!({ "names": names });
    }
    // glTF allows no mesh without points, and no empty lists.
    let mut root = json!({ "asset": { "version": "2.0", "generator": "ldwrap" } });
    if !buffer.is_empty() {
        root["scene"] = json!(0);
        root["scenes"] = json!([{ "nodes": [0] }]);
        root["nodes"] = json!([{ "mesh": 0, "name": "points" }]);
        root["meshes"] = json!([mesh]);
        root["accessors"] = json!(accessors);
        root["bufferViews"] = json!(views);
        root["buffers"] = json!([{ "byteLength": buffer.len() }]);
    }
    let mut text = serde_json::to_vec(&root)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let chunks: [(&[u8; 4], &[u8]); 2] = [(b"JSON", &text), (b"BIN\0", &buffer)];
    let total = 12 + chunks.iter().map(|(_, bytes)| 8 + bytes.len()).sum::<usize>();
    let total =
        u32::try_from(total).map_err(|_| invalid("a GLB file cannot be longer than 4 GiB".to_owned()))?;
    out.write_all(b"glTF")?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&total.to_le_bytes())?;
    for (kind, bytes) in chunks {
        out.write_all(&(bytes.len() as u32).to_le_bytes())?;
        out.write_all(kind)?;
        out.write_all(bytes)?;
    }
    Ok(())
}

impl Document {
    fn add(&mut self, field: &Field) -> io::Result<()> {
        let width = field.columns.len();
        // Attributes of applications start with an underscore (section 3.7.2.1).
        let own = || {
            let letter = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' };
            format!("_{}", field.key.chars().map(letter).collect::<String>())
        };
        let name = match (&*field.key, width) {
            ("position", 3) => "POSITION".to_owned(),
            ("normal", 3) => "NORMAL".to_owned(),
            ("uv", 2) => "TEXCOORD_0".to_owned(),
            ("color", 4) => "COLOR_0".to_owned(),
            _ => own(),
        };
        match &field.data {
            FieldData::Real(values, _) if name == "TEXCOORD_0" => {
                // The origin of glTF is the upper left corner; numbers must be numbers.
                let turned = values.iter().enumerate().map(|(i, &x)| match i % 2 {
                    _ if x.is_nan() => 0.0,
                    0 => x,
                    _ => 1.0 - x,
                });
                self.floats(name, width, turned.map(|x| x as f32).collect())
            }
            FieldData::Real(values, _) => {
                let single = |&x: &f64| if x.is_nan() { 0.0 } else { x as f32 };
                self.floats(name, width, values.iter().map(single).collect())
            }
            FieldData::Byte(values) if width == 4 => {
                let linear =
                    values.chunks_exact(4).flat_map(|c| from_srgb8([c[0], c[1], c[2], c[3]]).to_array());
                self.floats(name, width, linear.map(|x| x as f32).collect())
            }
            FieldData::Byte(values) => {
                self.floats(name, width, values.iter().map(|&x| f32::from(x)).collect())
            }
            // Integers of 32 bits are for indices of primitives only; single precision holds 2^24 exactly.
            FieldData::Id(values) => self.floats(name, width, values.iter().map(|&x| x as f32).collect()),
            FieldData::Name { names, ids } => {
                self.names.insert(field.key.clone(), json!(names));
                self.floats(name, width, ids.iter().map(|id| id.map_or(-1.0, |id| id as f32)).collect())
            }
            FieldData::Origin(origins) => {
                self.names.insert(field.key.clone(), json!(["wrapped", "projected", "equalized"]));
                // Items start at multiples of four bytes.
                let bytes = origins.iter().flat_map(|&origin| [origin_number(origin), 0, 0, 0]).collect();
                self.push(name, bytes, json!({ "componentType": UNSIGNED_BYTE, "type": "SCALAR" }), Some(4));
                Ok(())
            }
        }
    }

    fn floats(&mut self, name: String, width: usize, values: Vec<f32>) -> io::Result<()> {
        if let Some(index) = values.iter().position(|x| !x.is_finite()) {
            let point = index / width.max(1);
            return Err(invalid(format!(
                "{name} of point {point} is beyond single precision, which GLB has"
            )));
        }
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width.clamp(1, 4) - 1];
        let mut accessor = json!({ "componentType": FLOAT, "type": kind });
        if name == "POSITION" {
            let bound = |f: fn(f32, f32) -> f32, start: f32| {
                let rows = values.chunks_exact(3);
                rows.fold([start; 3], |b, p| [f(b[0], p[0]), f(b[1], p[1]), f(b[2], p[2])])
            };
            if !values.is_empty() {
                accessor["min"] = json!(bound(f32::min, f32::INFINITY).map(f64::from));
                accessor["max"] = json!(bound(f32::max, f32::NEG_INFINITY).map(f64::from));
            }
        }
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        self.push(name, bytes, accessor, None);
        Ok(())
    }

    fn push(&mut self, name: String, bytes: Vec<u8>, mut accessor: Value, stride: Option<usize>) {
        if bytes.is_empty() {
            return;
        }
        let components = match accessor["type"].as_str() {
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4") => 4,
            _ => 1,
        };
        const ARRAY_BUFFER: u32 = 34962;
        let mut view = json!({
            "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len(), "target": ARRAY_BUFFER
        });
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        accessor["bufferView"] = json!(self.views.len());
        accessor["count"] = json!(bytes.len() / stride.unwrap_or(4 * components));
        self.buffer.extend(bytes);
        self.attributes.insert(name, json!(self.accessors.len()));
        self.views.push(view);
        self.accessors.push(accessor);
    }
}

pub(super) fn read(bytes: &[u8], points: &mut Points) -> Result<(), PointsError> {
    let vertices = crate::io::gltf::vertices(bytes, &|uri| Err(format!("{uri} is not looked for")))
        .map_err(|error| points.malformed(PointPlace::File, error.to_string()))?;
    for (index, position) in vertices.into_iter().enumerate() {
        points.push(position, PointPlace::Point(index))?;
    }
    Ok(())
}
