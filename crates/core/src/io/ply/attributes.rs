//! What other programs write at vertices and faces of PLY files.

use glam::{DAffine2, DVec2, DVec3, DVec4};
use ply_rs_bw::ply::{
    ElementDef, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use super::{add_faces, is_corners};
use crate::attributes::{CornerValues, Filter, Material, MeshAttributes, Texture, Tint, Wrap, from_srgb};
use crate::io::detect::MeshFormat;
use crate::io::limits::Limits;
use crate::io::read::{Picture, Place, ReadError, Resolver, brief};
use crate::mesh::PolygonSoup;

/// All scalars of a vertex, in the order of the header.
pub(super) struct Record(Vec<f64>);

impl PropertyAccess for Record {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, _: &str, property: Property) -> PropertyAccessResult {
        match scalar(&property) {
            Some(value) => self.0.push(value),
            None => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

/// All scalars of a face, in the order of the header, and the lists that are known.
pub(super) struct Face {
    scalars: Vec<f64>,
    corners: Vec<i64>,
    uv: Vec<f64>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self { scalars: Vec::new(), corners: Vec::new(), uv: Vec::new() }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(value) = scalar(&property) {
            self.scalars.push(value);
            return PropertyAccessResult::Set;
        }
        if is_corners(name) {
            let Some(corners) = integers(&property) else { return PropertyAccessResult::UnsupportedType };
            self.corners = corners;
            return PropertyAccessResult::Set;
        }
        match property {
            Property::ListFloat(values) if name == "texcoord" => {
                self.uv = values.into_iter().map(f64::from).collect();
            }
            Property::ListDouble(values) if name == "texcoord" => self.uv = values,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

fn scalar(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(value) => value.into(),
        Property::UChar(value) => value.into(),
        Property::Short(value) => value.into(),
        Property::UShort(value) => value.into(),
        Property::Int(value) => value.into(),
        Property::UInt(value) => value.into(),
        Property::Float(value) => value.into(),
        Property::Double(value) => value,
        _ => return None,
    })
}

fn integers(property: &Property) -> Option<Vec<i64>> {
    Some(match property {
        Property::ListChar(values) => values.iter().map(|&v| v.into()).collect(),
        Property::ListUChar(values) => values.iter().map(|&v| v.into()).collect(),
        Property::ListShort(values) => values.iter().map(|&v| v.into()).collect(),
        Property::ListUShort(values) => values.iter().map(|&v| v.into()).collect(),
        Property::ListInt(values) => values.iter().map(|&v| v.into()).collect(),
        Property::ListUInt(values) => values.iter().map(|&v| v.into()).collect(),
        _ => return None,
    })
}

/// The scalar properties of an element: name, type.
fn scalars(element: &ElementDef) -> Vec<(&str, &ScalarType)> {
    let properties = element.properties.values();
    properties
        .filter_map(|property| match &property.data_type {
            PropertyType::Scalar(kind) => Some((property.name.as_str(), kind)),
            PropertyType::List(..) => None,
        })
        .collect()
}

/// The places of some scalars in the records, if all are there.
fn columns<const N: usize>(element: &ElementDef, names: [&str; N]) -> Option<[usize; N]> {
    let scalars = scalars(element);
    let mut columns = [0; N];
    for (column, name) in columns.iter_mut().zip(names) {
        *column = scalars.iter().position(|(known, _)| *known == name)?;
    }
    Some(columns)
}

fn vectors<const N: usize>(records: &[Record], columns: [usize; N]) -> impl Iterator<Item = [f64; N]> {
    records.iter().map(move |record| columns.map(|column| record.0.get(column).copied().unwrap_or_default()))
}

/// The positions of vertices whose element has them.
pub(super) fn positions(element: &ElementDef, vertices: &[Record]) -> Vec<DVec3> {
    let columns = columns(element, ["x", "y", "z"]).unwrap_or_default();
    vectors(vertices, columns).map(DVec3::from_array).collect()
}

/// How colours are told.
struct Colors {
    columns: [usize; 3],
    alpha: Option<usize>,
    /// What stands for the brightest.
    largest: f64,
}

impl Colors {
    fn of(element: &ElementDef) -> Option<Self> {
        let columns = columns(element, ["red", "green", "blue"])
            .or_else(|| columns(element, ["diffuse_red", "diffuse_green", "diffuse_blue"]))?;
        let largest = match scalars(element)[columns[0]].1 {
            ScalarType::Char | ScalarType::UChar => 255.0,
            ScalarType::Short | ScalarType::UShort => 65535.0,
            ScalarType::Int | ScalarType::UInt => 255.0,
            ScalarType::Float | ScalarType::Double => 1.0,
        };
        let alpha = self::columns(element, ["alpha"]).map(|[alpha]| alpha);
        Some(Self { columns, alpha, largest })
    }

    fn read(&self, scalars: &[f64]) -> DVec4 {
        let value = |column: usize| {
            let value = scalars.get(column).copied().unwrap_or_default() / self.largest;
            if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
        };
        let [r, g, b] = self.columns.map(|column| from_srgb(value(column)));
        DVec4::new(r, g, b, self.alpha.map_or(1.0, value))
    }
}

/// What faces have besides corners.
#[derive(Default)]
pub(super) struct Faces {
    uv: CornerValues<DVec2>,
    colors: CornerValues<DVec4>,
    materials: Vec<(usize, i64)>,
}

impl Faces {
    /// Adds faces to the soup.
    pub(super) fn add(
        &mut self,
        element: &ElementDef,
        faces: &[Face],
        soup: &mut PolygonSoup,
        limits: &Limits,
    ) -> Result<(), ReadError> {
        let (mut corner, mut polygon) = (soup.corners.len(), soup.polygon_count());
        add_faces(soup, 0, faces.iter().map(|face| &face.corners[..]), limits)?;
        let colors = Colors::of(element);
        let material = columns(element, ["material_index"]);
        for face in faces {
            if let Some(colors) = &colors {
                let color = self.colors.extend([colors.read(&face.scalars)]);
                (corner..corner + face.corners.len()).for_each(|corner| self.colors.set(corner, color));
            }
            if face.uv.len() >= 2 * face.corners.len() {
                let uv = face.uv.chunks_exact(2).take(face.corners.len());
                let first = self.uv.extend(uv.map(DVec2::from_slice));
                (0..face.corners.len()).for_each(|i| self.uv.set(corner + i, first + i));
            }
            if let Some([column]) = material {
                let index = face.scalars.get(column).copied().unwrap_or_default();
                self.materials.push((polygon, index as i64));
            }
            corner += face.corners.len();
            polygon += 1;
        }
        Ok(())
    }
}

/// Everything but the pictures.
pub(super) fn collect(
    header: &Header,
    vertices: &[Record],
    faces: Faces,
    soup: &PolygonSoup,
    found: &mut MeshAttributes,
) {
    found.colors = faces.colors;
    for (polygon, material) in faces.materials {
        let index = (material >= 0).then(|| found.material_of.index_of(&material.to_string()));
        found.material_of.set(polygon..polygon + 1, index);
    }
    let mut uv = faces.uv;
    if let Some(element) = header.elements.values().find(|element| element.name == "vertex") {
        if let Some(columns) = columns(element, ["nx", "ny", "nz"]) {
            let normals = vectors(vertices, columns).map(|n| DVec3::from_array(n).normalize_or_zero());
            found.normals = CornerValues::by_vertex(normals.collect(), &soup.corners);
        }
        if let Some(colors) = Colors::of(element) {
            let colors = vertices.iter().map(|record| colors.read(&record.0)).collect();
            found.colors = CornerValues::by_vertex(colors, &soup.corners);
        }
        let named = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];
        if let Some(columns) =
            named.into_iter().find_map(|names| columns(element, names)).filter(|_| uv.is_empty())
        {
            let read = vectors(vertices, columns).map(DVec2::from_array).collect();
            uv = CornerValues::by_vertex(read, &soup.corners);
        }
        for (column, (name, _)) in scalars(element).into_iter().enumerate() {
            if !["x", "y", "z"].contains(&name) {
                let values = vectors(vertices, [column]).map(|[value]| value).collect();
                found.numbers.push((name.to_owned(), CornerValues::by_vertex(values, &soup.corners)));
            }
        }
    }
    found.uv = vec![uv];
}

/// The picture that MeshLab names in a comment, for all polygons: PLY does not say which has which.
pub(super) fn texture(
    header: &Header,
    soup: &PolygonSoup,
    found: &mut MeshAttributes,
    limits: &Limits,
    resolver: &Resolver<'_>,
) -> Result<(), ReadError> {
    let mut files =
        header.comments.iter().filter_map(|c| c.trim().strip_prefix("TextureFile ")).map(str::trim);
    let Some(file) = files.next() else { return Ok(()) };
    let format = MeshFormat::Ply;
    if files.next().is_some() {
        return Err(ReadError::Unsupported {
            format,
            place: Place::File,
            what: "more than one TextureFile".to_owned(),
            advice: "export it to glTF or OBJ, which tell the picture of each face",
        });
    }
    let bytes = resolver(file).map_err(|reason| ReadError::Missing { format, uri: brief(file), reason })?;
    let picture = Picture {
        bytes: &bytes,
        format,
        place: Place::File,
        called: format!("the picture {:?}", brief(file)),
        advice: "save it as PNG or JPEG",
    };
    let image = picture.decode(found, limits)?;
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    found.material_of = Default::default();
    let index = found.material_of.push(stem);
    found.material_of.set(0..soup.polygon_count(), Some(index));
    let texture = Texture {
        image,
        uv_set: 0,
        transform: DAffine2::IDENTITY,
        wrap: [Wrap::Repeat; 2],
        filter: Filter::Linear,
    };
    found.materials =
        vec![Some(Material { base_color: DVec4::ONE, texture: Some(texture), tint: Tint::Replace })];
    Ok(())
}
