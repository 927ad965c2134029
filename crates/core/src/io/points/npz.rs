//! Points as NumPy's NPZ: a ZIP archive of NPY arrays.

use std::io::{self, Cursor, Read, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::io::Limits;
use crate::io::points::field::origin_number;
use crate::io::points::{Field, FieldData, PointPlace, Points, PointsError, Precision, npy};

/// Arrays that hold positions, as programs call them.
const POSITIONS: [&str; 5] = ["position", "positions", "points", "xyz", "vertices"];

pub(super) fn write(fields: &[Field], out: &mut dyn Write) -> io::Result<()> {
    // Not compressed, as `numpy.savez`: the same bits on every system, and arrays can be mapped into memory. Without a
    // clock every array is of 1980.
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for field in fields {
        write_array(&mut archive, &field.key, &array(field)?)?;
        let names = match &field.data {
            FieldData::Name { names, .. } => names.clone(),
            FieldData::Origin(_) => ["wrapped", "projected", "equalized"].map(str::to_owned).to_vec(),
            _ => continue,
        };
        write_array(&mut archive, &format!("{}_names", field.key), &name_array(&names)?)?;
    }
    out.write_all(archive.finish()?.get_ref())
}

fn write_array(archive: &mut ZipWriter<Cursor<Vec<u8>>>, key: &str, bytes: &[u8]) -> io::Result<()> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .large_file(bytes.len() as u64 >= u64::from(u32::MAX));
    archive.start_file(format!("{key}.npy"), options)?;
    archive.write_all(bytes)
}

/// The array of a field.
fn array(field: &Field) -> io::Result<Vec<u8>> {
    let count = field.point_count();
    let shape = if field.columns.len() == 1 { vec![count] } else { vec![count, field.columns.len()] };
    let mut bytes = Vec::new();
    match &field.data {
        FieldData::Real(values, Precision::Double) => {
            npy::write_head("<f8", &shape, &mut bytes)?;
            bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
        }
        FieldData::Real(values, Precision::Single) => {
            npy::write_head("<f4", &shape, &mut bytes)?;
            bytes.extend(values.iter().flat_map(|&x| (x as f32).to_le_bytes()));
        }
        FieldData::Id(values) => {
            npy::write_head("<u4", &shape, &mut bytes)?;
            bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
        }
        FieldData::Byte(values) => {
            npy::write_head("|u1", &shape, &mut bytes)?;
            bytes.extend(values);
        }
        FieldData::Name { ids, .. } => {
            npy::write_head("<i4", &shape, &mut bytes)?;
            let ids = ids.iter().map(|id| id.and_then(|id| i32::try_from(id).ok()).unwrap_or(-1));
            bytes.extend(ids.flat_map(i32::to_le_bytes));
        }
        FieldData::Origin(origins) => {
            npy::write_head("|u1", &shape, &mut bytes)?;
            bytes.extend(origins.iter().map(|&origin| origin_number(origin)));
        }
    }
    Ok(bytes)
}

/// An array of strings: 32 bits a character, all as long as the longest.
fn name_array(names: &[String]) -> io::Result<Vec<u8>> {
    let longest = names.iter().map(|name| name.chars().count()).max().unwrap_or(0).max(1);
    let mut bytes = Vec::new();
    npy::write_head(&format!("<U{longest}"), &[names.len()], &mut bytes)?;
    for name in names {
        let characters = name.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest);
        bytes.extend(characters.flat_map(u32::to_le_bytes));
    }
    Ok(bytes)
}

pub(super) fn read(bytes: &[u8], points: &mut Points) -> Result<(), PointsError> {
    let broken = |problem: String| points.malformed(PointPlace::File, problem);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| broken(error.to_string()))?;
    let found = POSITIONS.iter().find(|name| archive.index_for_name(&format!("{name}.npy")).is_some());
    let Some(name) = found else {
        return Err(broken(format!("none of its arrays is called {}", POSITIONS.join(", "))));
    };
    let file = archive.by_name(&format!("{name}.npy")).map_err(|error| broken(error.to_string()))?;
    let mut array = Vec::new();
    // A few bytes can unpack to a thousand times as many.
    let most_unpacked = Limits::default().bytes;
    file.take(most_unpacked + 1).read_to_end(&mut array).map_err(|error| broken(error.to_string()))?;
    if array.len() as u64 > most_unpacked {
        return Err(broken(format!("{name} unpacks to more than {most_unpacked} bytes: split it")));
    }
    npy::read(&array, points)
}
