//! Point files in blocks, and files for which there is no room.

use std::io;
use std::ops::Range;

use super::tests::fields;
use super::*;

/// Some points of fields.
fn cut(fields: &[Field], points: Range<usize>) -> Vec<Field> {
    let cut = |field: &Field| {
        let width = field.columns.len();
        let place = points.start * width..points.end * width;
        let data = match &field.data {
            FieldData::Real(values, precision) => FieldData::Real(values[place].to_vec(), *precision),
            FieldData::Id(values) => FieldData::Id(values[place].to_vec()),
            FieldData::Byte(values) => FieldData::Byte(values[place].to_vec()),
            FieldData::Name { names, ids } => {
                FieldData::Name { names: names.clone(), ids: ids[place].to_vec() }
            }
            FieldData::Origin(values) => FieldData::Origin(values[place].to_vec()),
        };
        Field { data, ..field.clone() }
    };
    fields.iter().map(cut).collect()
}

/// The two points of [`fields`] again and again, at other places.
fn many(count: usize) -> Vec<Field> {
    let mut all = fields();
    for field in &mut all {
        let times = count.div_ceil(2);
        match &mut field.data {
            FieldData::Real(values, _) => {
                *values = (0..times).flat_map(|k| values.iter().map(move |v| v / (k as f64 + 1.0))).collect();
            }
            FieldData::Id(values) => *values = values.repeat(times),
            FieldData::Byte(values) => *values = values.repeat(times),
            FieldData::Name { ids, .. } => *ids = ids.repeat(times),
            FieldData::Origin(values) => *values = values.repeat(times),
        }
    }
    cut(&all, 0..count)
}

fn whole(format: PointFormat, fields: &[Field]) -> Vec<u8> {
    let mut out = Vec::new();
    write_fields(format, fields, &mut out).expect("memory takes every byte");
    out
}

fn in_blocks(format: PointFormat, fields: &[Field], size: usize) -> Vec<u8> {
    let count = fields[0].point_count();
    let mut writer = PointWriter::new(format, fields, count, Vec::new()).expect("memory takes every byte");
    for start in (0..count).step_by(size) {
        writer.write(&cut(fields, start..(start + size).min(count))).expect("memory takes every byte");
    }
    writer.finish().expect("all points")
}

#[test]
fn blocks_have_the_bytes_of_all_points_at_once() {
    for count in [0, 1, 2, 7, 150_001] {
        let fields = many(count);
        for format in PointFormat::ALL {
            let refused = PointWriter::new(format, &fields, count, Vec::new()).err().map(|e| e.kind());
            assert_eq!(refused.is_none(), format.takes_blocks(), "{format}");
            if !format.takes_blocks() {
                assert_eq!(refused, Some(io::ErrorKind::InvalidInput));
                continue;
            }
            let whole = whole(format, &fields);
            for size in [1, 2, 5000, 70_000].into_iter().filter(|&size| count / size < 100) {
                let blocks = in_blocks(format, &fields, size);
                assert!(blocks == whole, "{count} points as {format} in blocks of {size}");
            }
        }
    }
}

#[test]
fn ply_is_as_the_library_writes_it() {
    use ply_rs_bw::ply::{DefaultElement, Property};
    use ply_rs_bw::{parser::Parser, writer::Writer};
    for format in [PointFormat::Ply, PointFormat::PlyAscii] {
        let mut fields = many(101);
        // Its reader takes no NaN in text.
        fields.retain(|field| field.key != "uv");
        let bytes = whole(format, &fields);
        let mut ply = Parser::<DefaultElement>::new().read_ply(&mut &bytes[..]).expect("a PLY file");
        let (Some(Property::Double(y)), FieldData::Real(places, _)) =
            (ply.payload["vertex"][100].get("y"), &fields[0].data)
        else {
            panic!("a place")
        };
        assert_eq!(*y, places[301]);
        let mut again = Vec::new();
        Writer::new().write_ply(&mut again, &mut ply).expect("memory takes every byte");
        assert!(bytes == again, "{format}");
    }
}

#[test]
fn blocks_that_do_not_fit_are_refused() {
    let fields = many(4);
    let refused = |result: io::Result<()>, words: &str| {
        let error = result.expect_err(words);
        assert_eq!(error.kind(), io::ErrorKind::InvalidInput);
        assert!(error.to_string().contains(words), "{error}");
    };
    for format in PointFormat::ALL.into_iter().filter(|format| format.takes_blocks()) {
        let writer = || PointWriter::new(format, &fields, 3, Vec::new()).expect("a head");
        refused(writer().write(&fields), "more than the 3 points");
        refused(writer().write(&fields[1..]), "other fields");
        refused(writer().finish().map(drop), "3 of the 3 points are missing");
        let mut other = many(2);
        let FieldData::Name { names, .. } = &mut other[4].data else { panic!("names") };
        names.pop();
        refused(writer().write(&other), "other fields");
        let mut uneven = many(2);
        uneven[5] = many(1).remove(5);
        refused(writer().write(&uneven), "different numbers of points");
        refused(write_fields(format, &uneven, &mut Vec::new()), "different numbers of points");
    }
    let large = [fields[0].clone(), Field::new("face", &["face"], FieldData::Id(vec![1, 2, 1 << 31, 4]))];
    for format in [PointFormat::Ply, PointFormat::PlyAscii] {
        refused(write_fields(format, &large, &mut Vec::new()), "2147483648");
    }
}

/// Takes so many bytes, then no more.
struct Full(usize);

impl io::Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = bytes.len().min(self.0);
        self.0 -= taken;
        if taken > 0 { Ok(taken) } else { Err(io::ErrorKind::StorageFull.into()) }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_told() {
    let fields = many(30);
    for format in PointFormat::ALL {
        let bytes = whole(format, &fields).len();
        for room in [0, 1, bytes / 2, bytes - 1] {
            let full = write_fields(format, &fields, &mut Full(room)).expect_err("no room");
            assert_eq!(full.kind(), io::ErrorKind::StorageFull, "{format}, {room} bytes");
        }
        write_fields(format, &fields, &mut Full(bytes)).expect("room");
    }
}
