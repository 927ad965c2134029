//! Values at the corners and names of the polygons of a soup.

use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::ops::{Add, Mul};

/// An index that may be missing, in 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Link(Option<NonZeroU32>);

impl Link {
    const NONE: Self = Self(None);

    /// None also for an index that 32 bits cannot count; readers refuse files with so many values.
    fn new(index: usize) -> Self {
        Self(index.checked_add(1).and_then(|i| u32::try_from(i).ok()).and_then(NonZeroU32::new))
    }

    fn index(self) -> Option<usize> {
        self.0.map(|i| i.get() as usize - 1)
    }
}

/// Values that corners of polygons refer to; corners may share one, and have none.
#[derive(Clone, Debug, PartialEq)]
pub struct CornerValues<T> {
    values: Vec<T>,
    of_corner: Vec<Link>,
}

impl<T> Default for CornerValues<T> {
    fn default() -> Self {
        Self { values: Vec::new(), of_corner: Vec::new() }
    }
}

impl<T: Copy> CornerValues<T> {
    /// No corner refers to them yet.
    pub fn new(values: Vec<T>) -> Self {
        Self { values, of_corner: Vec::new() }
    }

    /// Whether no corner has a value.
    pub fn is_empty(&self) -> bool {
        self.of_corner.iter().all(|link| link.index().is_none())
    }

    /// How many values there are.
    pub fn value_count(&self) -> usize {
        self.values.len()
    }

    /// Appends values; gives the index of the first.
    pub fn extend(&mut self, values: impl IntoIterator<Item = T>) -> usize {
        let first = self.values.len();
        self.values.extend(values);
        first
    }

    /// Corner `corner` of the soup (a place in [`PolygonSoup::corners`](crate::PolygonSoup::corners)) has value `index`.
    pub fn set(&mut self, corner: usize, index: usize) {
        if self.of_corner.len() <= corner {
            self.of_corner.resize(corner + 1, Link::NONE);
        }
        self.of_corner[corner] = Link::new(index);
    }

    /// Every corner has the value of its vertex.
    pub fn by_vertex(values: Vec<T>, corners: &[u32]) -> Self {
        Self { values, of_corner: corners.iter().map(|&v| Link::new(v as usize)).collect() }
    }

    /// The value of a corner.
    pub fn get(&self, corner: u32) -> Option<T> {
        let index = self.of_corner.get(corner as usize)?.index()?;
        self.values.get(index).copied()
    }

    /// Keeps what these corners refer to, in this order.
    pub(super) fn select(&mut self, corners: &[usize]) {
        self.of_corner =
            corners.iter().map(|&c| self.of_corner.get(c).copied().unwrap_or(Link::NONE)).collect();
    }

    /// The values of a triangle's corners weighted with barycentric coordinates; `None` if one of them has none.
    pub fn at(&self, corners: [u32; 3], barycentric: [f64; 3]) -> Option<T>
    where
        T: Add<Output = T> + Mul<f64, Output = T>,
    {
        let [a, b, c] = corners.map(|corner| self.get(corner));
        let [i, j, k] = barycentric;
        Some(a? * i + b? * j + c? * k)
    }
}

/// A name for each polygon, or none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolygonNames {
    names: Vec<String>,
    /// The index of the last of each name.
    index_of: BTreeMap<String, usize>,
    of_polygon: Vec<Link>,
}

impl PolygonNames {
    /// Whether no polygon has a name.
    pub fn is_empty(&self) -> bool {
        self.of_polygon.iter().all(|link| link.index().is_none())
    }

    /// The names; several may be equal, as those of glTF's materials.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The index in `names` of a polygon's name.
    pub fn get(&self, polygon: usize) -> Option<usize> {
        self.of_polygon.get(polygon)?.index()
    }

    /// Names these polygons; those before them that were not named stay without.
    pub fn set(&mut self, polygons: std::ops::Range<usize>, index: Option<usize>) {
        if self.of_polygon.len() < polygons.end {
            self.of_polygon.resize(polygons.end, Link::NONE);
        }
        self.of_polygon[polygons].fill(index.map_or(Link::NONE, Link::new));
    }

    /// Keeps the names of these polygons, in this order.
    pub(super) fn select(&mut self, polygons: &[usize]) {
        self.of_polygon =
            polygons.iter().map(|&p| self.of_polygon.get(p).copied().unwrap_or(Link::NONE)).collect();
    }

    /// The index of a name, which is added if it is new.
    pub fn index_of(&mut self, name: &str) -> usize {
        self.find(name).unwrap_or_else(|| self.push(name))
    }

    /// The index of a name; the last of several equal ones.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.index_of.get(name).copied()
    }

    /// Adds a name, also if it is not new; gives its index.
    pub fn push(&mut self, name: &str) -> usize {
        let index = self.names.len();
        self.names.push(name.to_owned());
        self.index_of.insert(name.to_owned(), index);
        index
    }
}
