//! What points can carry, and the columns that hold it.

use std::fmt;
use std::str::FromStr;
use std::sync::OnceLock;

use glam::DVec4;

use crate::attributes::{MeshAttributes, Places, to_srgb8};
use crate::io::points::PointFormat;
use crate::io::points::field::{Field, FieldData, Precision, unique};
use crate::measure::cell_areas;
use crate::mesh::SurfaceMesh;
use crate::parallel;
use crate::sample::{Sample, SurfacePoint};

/// Something that a point can carry besides its position.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "String", into = "String"))]
#[non_exhaustive]
pub enum Attribute {
    /// The unit normal of the face. In the columns nx, ny, nz; in flat_nx, flat_ny, flat_nz beside smooth normals.
    FlatNormal,
    /// The interpolated unit normal ([`Places::normal`]): nx, ny, nz.
    SmoothNormal,
    /// Texture coordinates of the first set, origin at the lower left of the picture: u, v (in PLY s, t).
    Uv,
    /// The base colour ([`Places::color`]) as 8-bit sRGB with alpha: red, green, blue, alpha.
    Color,
    /// The interpolated colour of the corners, in the same way: vertex_red and so on.
    VertexColor,
    /// The name of the material.
    Material,
    /// The name of the part: node, object, group or solid.
    Part,
    /// The triangle of the checked mesh.
    Face,
    /// The polygon of the file, from 0.
    Polygon,
    /// Barycentric coordinates in the face: b0, b1, b2.
    Barycentric,
    /// The strip.
    Strip,
    /// The place in the planar domain: place_x, place_y.
    Place,
    /// What put the point there: `wrapped`, `projected` or `equalized` (in PLY 0, 1, 2).
    Origin,
    /// The area that the point stands for ([`cell_areas`]), in squared units of the mesh.
    CellArea,
    /// A number that the file has at its corners, such as a property of PLY, under its name there; with `property_` before
    /// it where something else that is wanted has this name, in whatever case.
    Number(String),
}

/// What stands before the name of a number.
const NUMBER: &str = "property:";

impl Attribute {
    /// All but the numbers, which depend on the file.
    pub const FIXED: [Self; 14] = [
        Self::SmoothNormal,
        Self::FlatNormal,
        Self::Uv,
        Self::Color,
        Self::VertexColor,
        Self::Material,
        Self::Part,
        Self::Face,
        Self::Polygon,
        Self::Barycentric,
        Self::Strip,
        Self::Place,
        Self::Origin,
        Self::CellArea,
    ];

    /// Whether points on the surface of a file with these attributes have it.
    pub fn is_in(&self, attributes: &MeshAttributes) -> bool {
        match self {
            Self::Uv => attributes.uv.first().is_some_and(|uv| !uv.is_empty()),
            Self::Color => !attributes.colors.is_empty() || attributes.materials.iter().any(Option::is_some),
            Self::VertexColor => !attributes.colors.is_empty(),
            Self::Material => !attributes.material_of.is_empty(),
            Self::Part => !attributes.parts.is_empty(),
            Self::Number(name) => attributes.numbers.iter().any(|(known, _)| known == name),
            _ => true,
        }
    }

    /// Whether its value at a point depends on all the other points, so that it cannot be told block by block.
    pub fn is_of_all_points(&self) -> bool {
        matches!(self, Self::CellArea)
    }

    /// Whether files of this format can hold it.
    pub fn fits(&self, format: PointFormat) -> bool {
        match format {
            PointFormat::Npy => false,
            PointFormat::Obj => {
                matches!(self, Self::FlatNormal | Self::SmoothNormal | Self::Uv | Self::Color)
            }
            PointFormat::Xyz => !matches!(self, Self::Material | Self::Part | Self::Origin),
            _ => true,
        }
    }
}

impl fmt::Display for Attribute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FlatNormal => "flat-normal",
            Self::SmoothNormal => "smooth-normal",
            Self::Uv => "uv",
            Self::Color => "color",
            Self::VertexColor => "vertex-color",
            Self::Material => "material",
            Self::Part => "part",
            Self::Face => "face",
            Self::Polygon => "polygon",
            Self::Barycentric => "barycentric",
            Self::Strip => "strip",
            Self::Place => "place",
            Self::Origin => "origin",
            Self::CellArea => "cell-area",
            Self::Number(name) => return write!(f, "{NUMBER}{name}"),
        })
    }
}

impl FromStr for Attribute {
    type Err = AttributeError;

    fn from_str(text: &str) -> Result<Self, AttributeError> {
        if let Some(name) = text.strip_prefix(NUMBER).filter(|name| !name.is_empty()) {
            return Ok(Self::Number(name.to_owned()));
        }
        let found = Self::FIXED.into_iter().find(|known| known.to_string() == text);
        found.ok_or_else(|| AttributeError::Unknown(text.to_owned()))
    }
}

impl TryFrom<String> for Attribute {
    type Error = AttributeError;

    fn try_from(text: String) -> Result<Self, AttributeError> {
        text.parse()
    }
}

impl From<Attribute> for String {
    fn from(attribute: Attribute) -> Self {
        attribute.to_string()
    }
}

/// Why points do not get an attribute.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AttributeError {
    /// There is none of this name.
    #[error("no attribute is called {0:?}")]
    Unknown(String),
    /// The file does not have it.
    #[error("the mesh has no {0}")]
    Absent(Attribute),
    /// Two columns would have the same name.
    #[error("two columns would be called {0:?}: leave one out")]
    Twice(String),
}

/// The position and the attributes of samples on `mesh`, as fields of a point file, in the order in which they are
/// wanted. `attributes` are those of the file that the mesh was made from. O(n) lookups; cell areas are dearer.
///
/// # Errors
/// [`AttributeError`] when the file does not have what is wanted, or two columns would have the same name.
pub fn gather(
    mesh: &SurfaceMesh,
    attributes: &MeshAttributes,
    samples: &[Sample],
    wanted: &[Attribute],
) -> Result<Vec<Field>, AttributeError> {
    Ok(Gatherer::new(mesh, attributes, wanted)?.fields(samples))
}

/// Gathers the fields of block after block of samples, as [`gather`] does those of all.
#[derive(Clone, Debug)]
pub struct Gatherer<'a> {
    mesh: &'a SurfaceMesh,
    attributes: &'a MeshAttributes,
    /// Made when something is looked up, because it may take memory.
    places: OnceLock<Places<'a>>,
    wanted: Vec<Attribute>,
}

impl<'a> Gatherer<'a> {
    /// Not to be called by pieces of parallel work: the first call does such work itself.
    fn places(&self) -> &Places<'a> {
        self.places.get_or_init(|| Places::new(self.mesh, self.attributes))
    }

    /// For samples on `mesh`, which was made from a file with these attributes. What is looked up in the attributes takes
    /// linear time in the mesh once.
    ///
    /// # Errors
    /// As [`gather`].
    pub fn new(
        mesh: &'a SurfaceMesh,
        attributes: &'a MeshAttributes,
        wanted: &[Attribute],
    ) -> Result<Self, AttributeError> {
        if let Some(absent) = wanted.iter().find(|attribute| !attribute.is_in(attributes)) {
            return Err(AttributeError::Absent(absent.clone()));
        }
        let gatherer = Self { mesh, attributes, places: OnceLock::new(), wanted: wanted.to_vec() };
        let fields = gatherer.fields(&[]);
        let mut columns: Vec<&String> = fields.iter().flat_map(|field| &field.columns).collect();
        columns.sort_unstable();
        match columns.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(AttributeError::Twice(pair[0].clone())),
            None => Ok(gatherer),
        }
    }

    /// The position and the attributes of some samples; those that are of all points as if there were no others.
    pub fn fields(&self, samples: &[Sample]) -> Vec<Field> {
        let Self { mesh, wanted, .. } = self;
        let points: Vec<SurfacePoint> = samples.iter().map(|sample| sample.point).collect();
        let gathering = Gathering { gatherer: self, samples, points };
        let position = |p: &SurfacePoint| mesh.locate(p).to_array();
        let mut fields = vec![gathering.reals("position", &["x", "y", "z"], Precision::Double, position)];
        let smooth = wanted.contains(&Attribute::SmoothNormal);
        fields.extend(wanted.iter().map(|attribute| gathering.field(attribute, smooth)));
        rename_numbers(&mut fields, wanted);
        fields
    }
}

/// Gives numbers of the file other names where those of something else are the same: in some formats the columns count,
/// in others the keys, in capitals.
fn rename_numbers(fields: &mut [Field], wanted: &[Attribute]) {
    let is_number: Vec<bool> =
        [false].into_iter().chain(wanted.iter().map(|one| matches!(one, Attribute::Number(_)))).collect();
    let names = |field: &Field| -> Vec<String> {
        field.columns.iter().chain([&field.key]).map(|name| name.to_ascii_lowercase()).collect()
    };
    let fixed = fields.iter().zip(&is_number).filter(|(_, number)| !**number);
    let mut taken: Vec<String> = fixed.flat_map(|(field, _)| names(field)).collect();
    let mut meeting = Vec::new();
    for (field, _) in fields.iter_mut().zip(&is_number).filter(|(_, number)| **number) {
        let name = field.key.to_ascii_lowercase();
        if taken.contains(&name) {
            meeting.push(field);
        } else {
            taken.push(name);
        }
    }
    for field in meeting {
        let name = unique(field.key.clone(), |name| taken.contains(&name.to_ascii_lowercase()));
        taken.push(name.to_ascii_lowercase());
        field.columns = vec![name.clone()];
        field.key = name;
    }
}

/// What is gathered of some samples.
struct Gathering<'g, 'a> {
    gatherer: &'g Gatherer<'a>,
    samples: &'g [Sample],
    points: Vec<SurfacePoint>,
}

impl Gathering<'_, '_> {
    fn field(&self, attribute: &Attribute, smooth: bool) -> Field {
        let Self { gatherer, samples, points } = self;
        let Gatherer { mesh, attributes, .. } = gatherer;
        let single = Precision::Single;
        match attribute {
            Attribute::FlatNormal => {
                let normal = |p: &SurfacePoint| mesh.face_normal(p.face).to_array();
                if smooth {
                    self.reals("flat_normal", &["flat_nx", "flat_ny", "flat_nz"], single, normal)
                } else {
                    self.reals("normal", &["nx", "ny", "nz"], single, normal)
                }
            }
            Attribute::SmoothNormal => {
                let places = gatherer.places();
                self.reals("normal", &["nx", "ny", "nz"], single, |p| places.normal(mesh, p).to_array())
            }
            Attribute::Uv => {
                let places = gatherer.places();
                let uv = |p: &SurfacePoint| places.uv(mesh, p).map_or([f64::NAN; 2], |uv| uv.to_array());
                self.reals("uv", &["u", "v"], single, uv)
            }
            Attribute::Color => {
                let places = gatherer.places();
                self.colors("color", ["red", "green", "blue", "alpha"], |p| places.color(mesh, p))
            }
            Attribute::VertexColor => {
                let places = gatherer.places();
                let columns = ["vertex_red", "vertex_green", "vertex_blue", "vertex_alpha"];
                self.colors("vertex_color", columns, |p| places.vertex_color(mesh, p))
            }
            Attribute::Material => {
                let places = gatherer.places();
                let ids = points.iter().map(|p| places.material(mesh, p.face)).collect();
                names("material", attributes.material_of.names(), ids)
            }
            Attribute::Part => {
                let places = gatherer.places();
                let ids = points.iter().map(|p| places.part(mesh, p.face)).collect();
                names("part", attributes.parts.names(), ids)
            }
            Attribute::Face => self.ids("face", |s| s.point.face.0),
            Attribute::Polygon => self
                .ids("polygon", |s| attributes.polygon_number(mesh.sources()[s.point.face.index()].polygon)),
            Attribute::Barycentric => {
                self.reals("barycentric", &["b0", "b1", "b2"], Precision::Double, |p| p.barycentric)
            }
            Attribute::Strip => self.ids("strip", |s| s.strip.0),
            Attribute::Place => {
                let values = samples.iter().flat_map(|s| s.place.to_array()).collect();
                Field::new("place", &["place_x", "place_y"], FieldData::Real(values, Precision::Double))
            }
            Attribute::Origin => {
                let origins = samples.iter().map(|s| s.origin).collect();
                Field::new("origin", &["origin"], FieldData::Origin(origins))
            }
            Attribute::CellArea => {
                let areas = FieldData::Real(cell_areas(mesh, points), Precision::Double);
                Field::new("cell_area", &["cell_area"], areas)
            }
            Attribute::Number(name) => {
                let places = gatherer.places();
                let index = attributes.numbers.iter().position(|(known, _)| known == name);
                self.reals(name, &[name], Precision::Double, |p| {
                    [index.and_then(|index| places.number(mesh, p, index)).unwrap_or(f64::NAN)]
                })
            }
        }
    }

    fn reals<const N: usize>(
        &self,
        key: &str,
        columns: &[&str],
        precision: Precision,
        value: impl Fn(&SurfacePoint) -> [f64; N] + Sync + Send,
    ) -> Field {
        let values = parallel::map(self.points.len(), |i| value(&self.points[i]));
        Field::new(key, columns, FieldData::Real(values.into_iter().flatten().collect(), precision))
    }

    fn colors(
        &self,
        key: &str,
        columns: [&str; 4],
        color: impl Fn(&SurfacePoint) -> Option<DVec4> + Sync + Send,
    ) -> Field {
        // Where there is no colour, it is transparent.
        let bytes = parallel::map(self.points.len(), |i| color(&self.points[i]).map_or([0; 4], to_srgb8));
        Field::new(key, &columns, FieldData::Byte(bytes.into_iter().flatten().collect()))
    }

    fn ids(&self, key: &str, id: impl Fn(&Sample) -> u32) -> Field {
        Field::new(key, &[key], FieldData::Id(self.samples.iter().map(id).collect()))
    }
}

fn names(key: &str, names: &[String], ids: Vec<Option<usize>>) -> Field {
    let ids = ids.into_iter().map(|id| id.map(|id| id as u32)).collect();
    Field::new(key, &[key], FieldData::Name { names: names.to_vec(), ids })
}
