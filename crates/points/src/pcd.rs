//! PCD files of the Point Cloud Library: ascii, binary and binary_compressed.
//!
//! Organised clouds are read like others: their points without a measurement are NaN, and so are
//! dropped and counted. Coordinates stay as they are in the file: its VIEWPOINT says where the
//! sensor was, which is no transform of the points. Programs disagree about that: where rows and columns
//! show that points are in the sensor's own coordinates, it was in the origin. A field with COUNT n gives n numbers, `name_0` to
//! `name_n-1`. Colours are in fields `rgb` or `rgba`, the bytes of a 32-bit number whatever its type.

mod header;
mod lzf;

use crate::collect::Collector;
use crate::error::{PointsError, Quoted};
use crate::field::{Field, Type};
use crate::options::ReadOptions;
use crate::pcd::header::{Data, Header};
use crate::sensor::{CAMERA, Pixels, Pose, Sensor};
use crate::set::PointSet;
use crate::source::{Line, Source};
use crate::upright::{self, Upwards};
use std::path::Path;

/// Longest line of a text file.
const MAX_LINE: usize = 1 << 20;

const EXPORT: &str = "the file is damaged: copy or export it again";

/// PCD begins with comments, or with VERSION where somebody took them away.
pub(crate) fn sniff(start: &[u8]) -> bool {
    start.starts_with(b"# .PCD") || start.starts_with(b"VERSION ") || start.starts_with(b"# .pcd")
}

pub(crate) fn read(
    mut source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let header = header::read(&mut source, path)?;
    let mut collector = Collector::new(&header.fields(), path, options)?;
    collector.expect(source.records(header.points, header.least_record()))?;
    let mut image = Image::new(&header, &mut collector);
    match header.data {
        Data::Ascii => text(&mut source, &header, path, &mut image)?,
        Data::Binary => binary(&mut source, &header, path, &mut image)?,
        Data::Compressed => compressed(&mut source, &header, path, &mut image)?,
    }
    let sensors = image.sensor(&header).into_iter().collect();
    let organised = if header.rows > 1 { ", organised" } else { "" };
    let words = header.data.in_words();
    let mut set = collector.finish(&format!("PCD {}, {words}{organised}", header.version))?;
    if header.rows > 1 {
        // Cameras wrote the first of them.
        let camera = (Upwards::MinusY, "as organised files of depth cameras have it");
        set.up = upright::of_map(&set, [header.points / header.rows, header.rows], false)
            .or(Some(camera));
    }
    set.sensors = sensors;
    Ok(set)
}

/// Points on their way, which rows and columns may show to be those of a sensor.
struct Image<'c, 'a> {
    collector: &'c mut Collector<'a>,
    /// Of an organised cloud.
    pixels: Option<Pixels>,
    columns: u64,
    done: u64,
}

impl<'c, 'a> Image<'c, 'a> {
    fn new(header: &Header, collector: &'c mut Collector<'a>) -> Self {
        let columns = (header.points / header.rows.max(1)).max(1);
        let pixels = (header.rows > 1).then(|| Pixels::new(header.points));
        Self { collector, pixels, columns, done: 0 }
    }

    fn push(&mut self, row: &[f64]) -> Result<(), PointsError> {
        if let Some(pixels) = &mut self.pixels {
            let pixel = [self.done % self.columns, self.done / self.columns].map(|n| n as f64);
            pixels.see(pixel, self.collector.position_of(row));
        }
        self.done += 1;
        self.collector.push(row)
    }

    /// What the file says of its sensor, or its points show.
    fn sensor(&self, header: &Header) -> Option<Sensor> {
        let points = 0..self.done as u32;
        let poses = header.viewpoint.into_iter().chain([Pose::IDENTITY]);
        let shown = poses.filter_map(|pose| {
            let pixels = self.pixels.as_ref()?;
            let axes = pixels.axes(&pose, true)?;
            Some(pose.sensor(axes, points.clone(), pixels.size()))
        });
        let said = || Some(header.viewpoint?.sensor(CAMERA, points.clone(), None));
        shown.into_iter().next().or_else(said)
    }
}

/// One number of a record.
struct Column {
    kind: Type,
    place: usize,
}

impl Header {
    /// The numbers of a row.
    fn fields(&self) -> Vec<Field> {
        let named = |field: &header::Declared| {
            let name = field.name.clone();
            let kind = if field.is_packed() { Type::U32 } else { field.kind };
            let count = field.count;
            (0..count).map(move |index| match count {
                1 => Field::new(&name, kind),
                _ => Field::new(format!("{name}_{index}"), kind),
            })
        };
        self.fields.iter().filter(|field| !field.is_padding()).flat_map(named).collect()
    }

    /// Where they lie in a binary record.
    fn columns(&self) -> Vec<Column> {
        let mut columns = Vec::new();
        let mut place = 0;
        for field in &self.fields {
            let kind = if field.is_packed() { Type::U32 } else { field.kind };
            for index in 0..if field.is_padding() { 0 } else { field.count } {
                columns.push(Column { kind, place: place + index * field.kind.size() });
            }
            place += field.size();
        }
        columns
    }

    fn least_record(&self) -> u64 {
        match self.data {
            Data::Ascii => (2 * self.fields.iter().map(|field| field.count as u64).sum::<u64>())
                .saturating_sub(1),
            Data::Binary => self.record_size() as u64,
            // LZF makes at most 264 bytes of 3.
            Data::Compressed => (self.record_size() as u64).div_ceil(88),
        }
    }

    fn cut_off(&self, path: &Path, found: u64, bytes: Option<u64>) -> PointsError {
        let size = self.record_size() as u128;
        PointsError::CutOff {
            path: path.into(),
            what: "points".to_owned(),
            declared: self.points,
            found,
            bytes_declared: bytes.map(|_| u128::from(self.points) * size),
            bytes_found: bytes,
        }
    }
}

fn binary(
    source: &mut Source<'_>,
    header: &Header,
    path: &Path,
    image: &mut Image<'_, '_>,
) -> Result<(), PointsError> {
    let size = header.record_size();
    let columns = header.columns();
    if let Some(left) = source.left().filter(|left| left / (size as u64) < header.points) {
        return Err(header.cut_off(path, left / size as u64, Some(left)));
    }
    let mut row = vec![0.0; columns.len()];
    let mut done = 0;
    while done < header.points {
        let there =
            source.fill(size).map_err(|source| PointsError::Io { path: path.into(), source })?;
        let wanted = usize::try_from(header.points - done).unwrap_or(usize::MAX);
        let records = (there.len() / size).min(wanted);
        if records == 0 {
            let bytes = done * size as u64 + there.len() as u64;
            return Err(header.cut_off(path, done, Some(bytes)));
        }
        for record in there[..records * size].chunks_exact(size) {
            for (value, column) in row.iter_mut().zip(&columns) {
                *value = column.kind.read::<false>(&record[column.place..]);
            }
            image.push(&row)?;
        }
        source.consume(records * size);
        done += records as u64;
    }
    Ok(())
}

/// All points in one block, field after field.
fn compressed(
    source: &mut Source<'_>,
    header: &Header,
    path: &Path,
    image: &mut Image<'_, '_>,
) -> Result<(), PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let wrong = |place: &str, found: String, expected: &str| {
        PointsError::wrong(path, place, found, expected, EXPORT)
    };
    let there = source.fill(8).map_err(io_error)?;
    if there.len() < 8 {
        return Err(header.cut_off(path, 0, None));
    }
    let [packed, whole] = [0, 4].map(|place| Type::U32.read::<false>(&there[place..]) as u64);
    source.consume(8);
    let needed = u128::from(header.points) * header.record_size() as u128;
    if u128::from(whole) != needed {
        let expected = format!("{needed} for {} points", header.points);
        return Err(wrong("the uncompressed size", whole.to_string(), &expected));
    }
    if source.left().is_some_and(|left| left < packed) {
        return Err(header.cut_off(path, 0, None));
    }
    if whole > packed.saturating_mul(lzf::MOST) {
        let expected = format!("no more than {packed} bytes of LZF could hold");
        return Err(wrong("the uncompressed size", whole.to_string(), &expected));
    }
    let mut bytes = Vec::new();
    while (bytes.len() as u64) < packed {
        let there = source.fill(1).map_err(io_error)?;
        if there.is_empty() {
            return Err(header.cut_off(path, 0, None));
        }
        let step = there.len().min((packed - bytes.len() as u64) as usize);
        bytes.extend_from_slice(&there[..step]);
        source.consume(step);
    }
    let bytes = lzf::decompress(&bytes, whole as usize)
        .ok_or_else(|| wrong("the compressed points", "bytes without meaning".to_owned(), "LZF"))?;

    // Where each field's values begin, one point after another.
    let mut columns = Vec::new();
    let mut place = 0;
    let points = header.points as usize;
    for field in &header.fields {
        let kind = if field.is_packed() { Type::U32 } else { field.kind };
        for index in 0..if field.is_padding() { 0 } else { field.count } {
            columns.push((kind, place + index * field.kind.size(), field.size()));
        }
        place += points * field.size();
    }
    let mut row = vec![0.0; columns.len()];
    for point in 0..points {
        for (value, &(kind, place, stride)) in row.iter_mut().zip(&columns) {
            *value = kind.read::<false>(&bytes[place + point * stride..]);
        }
        image.push(&row)?;
    }
    Ok(())
}

fn text(
    source: &mut Source<'_>,
    header: &Header,
    path: &Path,
    image: &mut Image<'_, '_>,
) -> Result<(), PointsError> {
    // Padding is written too.
    let columns: Vec<&header::Declared> =
        header.fields.iter().flat_map(|field| std::iter::repeat_n(field, field.count)).collect();
    let mut row = Vec::with_capacity(columns.len());
    let (mut done, mut number) = (0, header.lines);
    while done < header.points {
        number += 1;
        let wrong = |found: String, expected: String| PointsError::Line {
            path: path.into(),
            line: number,
            found,
            expected,
            help: "correct the line or export the file again",
        };
        let line = match source.line(b'\n', MAX_LINE) {
            Ok(Line::Whole(line)) => line,
            Ok(Line::End) => return Err(header.cut_off(path, done, None)),
            Ok(Line::TooLong) => {
                let found = format!("more than {MAX_LINE} bytes");
                return Err(wrong(found, format!("the values of point {done}")));
            }
            Err(source) => return Err(PointsError::Io { path: path.into(), source }),
        };
        let words =
            || line.split(|byte| byte.is_ascii_whitespace()).filter(|word| !word.is_empty());
        if words().next().is_none() {
            continue;
        }
        row.clear();
        let mut rest = words();
        for field in &columns {
            let Some(word) = rest.next() else {
                let expected = format!("the {} values of point {done}", columns.len());
                return Err(wrong(format!("only {} values", words().count()), expected));
            };
            let Some(value) = field.parse(word) else {
                let name = &field.name;
                let expected = format!("a number for field '{name}' of point {done}");
                return Err(wrong(Quoted(word).to_string(), expected));
            };
            if !field.is_padding() {
                row.push(value);
            }
        }
        if rest.next().is_some() {
            let expected = format!("the {} values of point {done}", columns.len());
            return Err(wrong(format!("{} values", words().count()), expected));
        }
        image.push(&row)?;
        done += 1;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
