//! Numbers out of buffers, checked. Own code: the library's iterators panic when a view is too short, and take
//! positions for single precision where `KHR_mesh_quantization` stores small integers.

use gltf::Accessor;
use gltf::accessor::sparse::IndexType;
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::View;

use crate::io::gltf::buffers::Buffers;

/// An accessor without a view is all zeros, however large: no file needs more of them.
const MOST_ZEROS: usize = 1 << 24;

/// The vectors of `N` numbers of an accessor of `what`, or what is wrong with it.
pub(super) fn vectors<const N: usize>(
    accessor: &Accessor<'_>,
    what: &str,
    buffers: &Buffers,
) -> Result<Vec<[f64; N]>, String> {
    let error = |problem: &str| format!("accessor {}: {problem}", accessor.index());
    let is_vector = !matches!(accessor.dimensions(), Dimensions::Mat2 | Dimensions::Mat3 | Dimensions::Mat4);
    if accessor.dimensions().multiplicity() != N || !is_vector {
        return Err(error(&format!("{what} must be vectors of {N} numbers")));
    }
    let kind = accessor.data_type();
    let vector = |bytes: &[u8]| {
        let (size, normalized) = (kind.size(), accessor.normalized());
        std::array::from_fn(|axis| component(&bytes[axis * size..][..size], kind, normalized))
    };
    let outside = || error("it reaches beyond its buffer");
    let mut vectors: Vec<[f64; N]> = match accessor.view() {
        Some(view) => items(&view, accessor.offset(), accessor.count(), N * kind.size(), buffers)
            .ok_or_else(outside)?
            .map(vector)
            .collect(),
        None if accessor.count() <= MOST_ZEROS => vec![[0.0; N]; accessor.count()],
        None => return Err(error("it has no data")),
    };
    if let Some(sparse) = accessor.sparse() {
        let (indices, values) = (sparse.indices(), sparse.values());
        let size = match indices.index_type() {
            IndexType::U8 => 1,
            IndexType::U16 => 2,
            IndexType::U32 => 4,
        };
        let places =
            items(&indices.view(), indices.offset(), sparse.count(), size, buffers).ok_or_else(outside)?;
        let values = items(&values.view(), values.offset(), sparse.count(), N * kind.size(), buffers)
            .ok_or_else(outside)?;
        for (place, value) in places.zip(values) {
            let place = unsigned(place) as usize;
            *vectors.get_mut(place).ok_or_else(|| error("a sparse index is too large"))? = vector(value);
        }
    }
    Ok(vectors)
}

/// The numbers of an accessor of indices, or what is wrong with it.
pub(super) fn indices(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<u32>, String> {
    let error = |problem: &str| format!("accessor {}: {problem}", accessor.index());
    let kind = accessor.data_type();
    let fits = matches!(kind, DataType::U8 | DataType::U16 | DataType::U32);
    if accessor.dimensions() != Dimensions::Scalar || !fits {
        return Err(error("indices must be unsigned integers"));
    }
    let view = accessor.view().filter(|_| accessor.sparse().is_none());
    let view = view.ok_or_else(|| error("sparse indices cannot be read"))?;
    let items = items(&view, accessor.offset(), accessor.count(), kind.size(), buffers);
    Ok(items.ok_or_else(|| error("it reaches beyond its buffer"))?.map(unsigned).collect())
}

/// `count` items of `size` bytes; `None` if they are not all there.
fn items<'a>(
    view: &View<'_>,
    offset: usize,
    count: usize,
    size: usize,
    buffers: &'a Buffers,
) -> Option<impl Iterator<Item = &'a [u8]> + use<'a>> {
    let bytes = buffers.view(view)?;
    let stride = view.stride().unwrap_or(size);
    if count > 0 {
        let last = (count - 1).checked_mul(stride)?.checked_add(offset)?;
        bytes.get(last..last.checked_add(size)?)?;
    }
    Some((0..count).map(move |i| &bytes[offset + i * stride..][..size]))
}

fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}

/// One number; normalized integers as section 3.6.2.2 of the specification converts them.
fn component(bytes: &[u8], kind: DataType, normalized: bool) -> f64 {
    let raw = unsigned(bytes);
    let (value, largest) = match kind {
        DataType::I8 => (f64::from(raw as u8 as i8), 127.0),
        DataType::U8 => (f64::from(raw), 255.0),
        DataType::I16 => (f64::from(raw as u16 as i16), 32767.0),
        DataType::U16 => (f64::from(raw), 65535.0),
        DataType::U32 => (f64::from(raw), f64::from(u32::MAX)),
        DataType::F32 => return f64::from(f32::from_bits(raw)),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}
