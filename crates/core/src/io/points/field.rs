//! Fields: what a point file holds, column by column.

use crate::sample::Origin;

/// A value for each point, with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// What JSON and NPZ call it.
    pub key: String,
    /// What CSV and PLY call its numbers.
    pub columns: Vec<String>,
    /// The values, point by point; as many for each as there are columns.
    pub data: FieldData,
}

/// The values of a field.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FieldData {
    /// Real numbers; NaN where a point has none. Text holds all digits, binary files what the precision says.
    Real(Vec<f64>, Precision),
    /// Indices.
    Id(Vec<u32>),
    /// Numbers from 0 to 255.
    Byte(Vec<u8>),
    /// Names, of which points may have none.
    Name {
        /// The names.
        names: Vec<String>,
        /// For each point its name: an index into `names`.
        ids: Vec<Option<u32>>,
    },
    /// What put the points where they are.
    Origin(Vec<Origin>),
}

/// How binary files hold real numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 32 bits.
    Single,
    /// 64 bits.
    Double,
}

impl Field {
    pub(super) fn new(key: &str, columns: &[&str], data: FieldData) -> Self {
        Self { key: key.to_owned(), columns: columns.iter().map(|&column| column.to_owned()).collect(), data }
    }

    /// The same field of no points.
    pub(super) fn without_values(&self) -> Self {
        let data = match &self.data {
            FieldData::Real(_, precision) => FieldData::Real(Vec::new(), *precision),
            FieldData::Id(_) => FieldData::Id(Vec::new()),
            FieldData::Byte(_) => FieldData::Byte(Vec::new()),
            FieldData::Name { names, .. } => FieldData::Name { names: names.clone(), ids: Vec::new() },
            FieldData::Origin(_) => FieldData::Origin(Vec::new()),
        };
        Self { key: self.key.clone(), columns: self.columns.clone(), data }
    }

    /// How many points it has values for.
    pub fn point_count(&self) -> usize {
        let values = match &self.data {
            FieldData::Real(values, _) => values.len(),
            FieldData::Id(values) => values.len(),
            FieldData::Byte(values) => values.len(),
            FieldData::Name { ids, .. } => ids.len(),
            FieldData::Origin(values) => values.len(),
        };
        values / self.columns.len().max(1)
    }
}

/// The name of an origin in text files.
pub(super) fn origin_name(origin: Origin) -> &'static str {
    match origin {
        Origin::Wrapped => "wrapped",
        Origin::Projected => "projected",
        Origin::Equalized => "equalized",
    }
}

/// The number of an origin in binary files.
pub(super) fn origin_number(origin: Origin) -> u8 {
    match origin {
        Origin::Wrapped => 0,
        Origin::Projected => 1,
        Origin::Equalized => 2,
    }
}

/// The field of this key and number of columns, if it holds real numbers.
pub(super) fn reals<'a>(fields: &'a [Field], key: &str, columns: usize) -> Option<&'a [f64]> {
    fields.iter().find(|f| f.key == key && f.columns.len() == columns).and_then(|field| match &field.data {
        FieldData::Real(values, _) => Some(&values[..]),
        _ => None,
    })
}

/// The colours, red, green, blue and alpha of each point.
pub(super) fn colors(fields: &[Field]) -> Option<&[u8]> {
    fields.iter().find(|f| f.key == "color" && f.columns.len() == 4).and_then(|field| match &field.data {
        FieldData::Byte(values) => Some(&values[..]),
        _ => None,
    })
}

/// The name, with as many `property_` before it as it takes so that no other has it.
pub(super) fn unique(mut name: String, is_taken: impl Fn(&str) -> bool) -> String {
    while is_taken(&name) {
        name.insert_str(0, "property_");
    }
    name
}
