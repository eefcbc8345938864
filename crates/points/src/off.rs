//! OFF, the format of Geomview: its vertices are the points.
//!
//! The first word says what a vertex has beside its position: `N` a normal, `C` a colour, `ST`
//! texture coordinates, in this order in the line. Colours that the word does not announce are read
//! all the same, as several programs write them. Faces are not read.

use crate::collect::Collector;
use crate::error::{PointsError, Quoted};
use crate::field::{Field, Type};
use crate::lines::{Lines, SAMPLE, line_end_of, values, words};
use crate::meaning::{self, SAMPLE_ROWS, Sample};
use crate::number::number;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use std::path::Path;

const WORD: &str = "OFF, with ST, C or N before it";

/// What the first word says.
#[derive(Default, Clone, Copy)]
struct Kind {
    normal: bool,
    color: bool,
    texture: bool,
    /// Positions in 4 numbers, or in any number of them.
    other_space: bool,
}

impl Kind {
    fn of(word: &[u8]) -> Option<Self> {
        let mut kind = Self::default();
        let mut rest = word.strip_suffix(b"OFF")?;
        while !rest.is_empty() {
            rest = match rest {
                [b'S', b'T', rest @ ..] => {
                    kind.texture = true;
                    rest
                }
                [b'C', rest @ ..] => {
                    kind.color = true;
                    rest
                }
                [b'N', rest @ ..] => {
                    kind.normal = true;
                    rest
                }
                [b'4' | b'n', rest @ ..] => {
                    kind.other_space = true;
                    rest
                }
                _ => return None,
            };
        }
        Some(kind)
    }

    /// The numbers of a vertex that has so many; `None` if it cannot have.
    fn names(self, count: usize) -> Option<Vec<String>> {
        let [normal, texture] =
            [(self.normal, 3), (self.texture, 2)].map(|(has, count)| if has { count } else { 0 });
        let color = count.checked_sub(3 + normal + texture)?;
        if !matches!((self.color, color), (true, 3 | 4) | (false, 0 | 3 | 4)) {
            return None;
        }
        let xyz = ["x", "y", "z"].iter();
        let names = xyz
            .chain(["nx", "ny", "nz"].iter().take(normal))
            .chain(["red", "green", "blue", "alpha"].iter().take(color))
            .chain(["s", "t"].iter().take(texture));
        Some(names.map(|&name| name.to_owned()).collect())
    }

    fn expected(self) -> String {
        let normal = if self.normal { ", a normal" } else { "" };
        let color = if self.color { ", a colour of 3 or 4 values" } else { "" };
        let texture = if self.texture { ", 2 texture coordinates" } else { "" };
        format!("x y z{normal}{color}{texture}")
    }
}

/// Whether a file that begins so is OFF.
pub(crate) fn sniff(start: &[u8]) -> bool {
    let mut lines = start.split(|byte| matches!(byte, b'\n' | b'\r')).map(content);
    let first = lines.find_map(|line| words(line).next());
    first.is_some_and(|word| Kind::of(word).is_some())
}

/// A line without its comment.
fn content(line: &[u8]) -> &[u8] {
    line.split(|&byte| byte == b'#').next().unwrap_or(line)
}

/// The next line with words, copied.
fn next_line(lines: &mut Lines<'_, '_>) -> Result<Vec<u8>, PointsError> {
    while let Some(line) = lines.next()? {
        if words(content(line)).next().is_some() {
            return Ok(content(line).trim_ascii().to_vec());
        }
    }
    Err(lines.wrong("the end of the file", format!("{WORD}, and the number of vertices")))
}

/// Reads the vertices.
pub(crate) fn read(
    mut source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let mut lines = Lines::new(&mut source, path)?;
    let first = next_line(&mut lines)?;
    let word = words(&first).next().unwrap_or_default();
    let Some(kind) = Kind::of(word) else {
        return Err(lines.wrong(Quoted(word).to_string(), WORD));
    };
    let word = String::from_utf8_lossy(word).into_owned();
    if kind.other_space {
        return Err(lines.wrong(word, "points in three dimensions: OFF without 4 or n"));
    }
    let rest = first[word.len()..].trim_ascii();
    if rest == b"BINARY" {
        return binary(lines.source, path, options, kind, &word);
    }
    let counts = if rest.is_empty() { next_line(&mut lines)? } else { rest.to_vec() };
    let declared =
        words(&counts).next().and_then(|word| std::str::from_utf8(word).ok()?.parse().ok());
    let Some(declared): Option<u64> = declared else {
        return Err(lines.wrong(Quoted(&counts).to_string(), "the numbers of vertices and faces"));
    };
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let sample = sample(lines.source.fill(SAMPLE).map_err(io_error)?);
    let names = if declared == 0 { kind.names(3 + usize::from(kind.normal) * 3) } else { None };
    let names = names.or_else(|| kind.names(sample.columns));
    let fields = match &names {
        Some(names) if sample.columns == names.len() => meaning::by_names(names, None, &sample),
        _ => ["x", "y", "z"].map(|name| Field::new(name, Type::F64)).into(),
    };
    let mut collector = Collector::new(&fields, path, options)?;
    collector.expect(lines.source.records(declared, 2 * fields.len() as u64))?;

    let mut row = Vec::new();
    let mut found = 0;
    while found < declared {
        let Some(line) = lines.next()? else { return Err(cut_off(path, declared, found)) };
        let line = content(line);
        row.clear();
        if let Some(word) = numbers(line, &mut row) {
            let found = Quoted(word).to_string();
            return Err(lines.wrong(found, "a number"));
        }
        match (row.len(), &names) {
            (0, _) => continue,
            (count, Some(_)) if count == fields.len() => collector.push(&row)?,
            (count, Some(names)) => {
                let expected = format!("{} as in the first vertex", values(names.len()));
                return Err(lines.wrong(values(count), expected));
            }
            (count, None) => return Err(lines.wrong(values(count), kind.expected())),
        }
        found += 1;
    }
    collector.finish(&format!("{word}, ascii"))
}

/// Binary OFF: three counts of 32 bits, then vertices of floats, all big-endian.
fn binary(
    source: &mut Source<'_>,
    path: &Path,
    options: &ReadOptions,
    kind: Kind,
    word: &str,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let start = source.fill(12).map_err(io_error)?;
    let Some(&[a, b, c, d, ..]) = start.first_chunk::<12>() else {
        let found = format!("the end of the file after {} bytes", start.len());
        return Err(PointsError::wrong(
            path,
            "the number of vertices",
            found,
            "12 bytes of counts",
            "copy or export the file again",
        ));
    };
    let declared = u64::from(u32::from_be_bytes([a, b, c, d]));
    source.consume(12);
    let numbers = 3
        + 3 * usize::from(kind.normal)
        + 4 * usize::from(kind.color)
        + 2 * usize::from(kind.texture);
    let names = kind.names(numbers).unwrap_or_default();
    let fields: Vec<Field> = names.into_iter().map(|name| Field::new(name, Type::F32)).collect();
    let mut collector = Collector::new(&fields, path, options)?;
    collector.expect(source.records(declared, 4 * numbers as u64))?;
    let mut row = vec![0.0; numbers];
    for found in 0..declared {
        let record = source.fill(4 * numbers).map_err(io_error)?;
        if record.len() < 4 * numbers {
            return Err(cut_off(path, declared, found));
        }
        for (value, bytes) in row.iter_mut().zip(record.chunks_exact(4)) {
            *value = Type::F32.read::<true>(bytes);
        }
        source.consume(4 * numbers);
        collector.push(&row)?;
    }
    collector.finish(&format!("{word}, binary"))
}

fn cut_off(path: &Path, declared: u64, found: u64) -> PointsError {
    PointsError::CutOff {
        path: path.into(),
        what: "vertices".to_owned(),
        declared,
        found,
        bytes_declared: None,
        bytes_found: None,
    }
}

/// Reads all words as numbers; gives back the first that is none.
fn numbers<'a>(line: &'a [u8], row: &mut Vec<f64>) -> Option<&'a [u8]> {
    for word in words(line) {
        match number(word, false) {
            Some(value) => row.push(value),
            None => return Some(word),
        }
    }
    None
}

/// The first vertices.
fn sample(start: &[u8]) -> Sample {
    let mut sample = Sample::default();
    let mut row = Vec::new();
    let mut rows = 0;
    let end = line_end_of(start);
    for line in start.split(|&byte| byte == end).map(content) {
        row.clear();
        if numbers(line, &mut row).is_some() {
            break;
        }
        if row.is_empty() {
            continue;
        }
        if sample.columns == 0 {
            sample.columns = row.len();
            sample.floats = vec![false; row.len()];
        }
        // Others are errors, or faces behind the last vertex.
        if row.len() == sample.columns {
            sample.values.extend(&row);
            for (float, word) in sample.floats.iter_mut().zip(words(line)) {
                *float |= word.iter().any(|byte| matches!(byte, b'.' | b'e' | b'E'));
            }
        }
        rows += 1;
        if rows == SAMPLE_ROWS {
            break;
        }
    }
    sample
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::read_bytes;
    use crate::set::{ColorEncoding, Values};

    fn try_read(text: impl AsRef<[u8]>) -> Result<PointSet, PointsError> {
        read_bytes(text.as_ref(), Path::new("a.off"), &ReadOptions::default())
    }

    fn read(text: impl AsRef<[u8]>) -> PointSet {
        try_read(text).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn vertices_are_read_and_faces_are_not() {
        for text in [
            "OFF\n2 1 0\n1 2 3\n4 5 6\n2 0 1\n",
            "OFF 2 1 0\n1 2 3\n4 5 6",
            "OFF # a\n# b\n\n2 1\n\n1 2 3 # c\n4 5 6\nwhat follows is not read",
            "OFF\r\n2 1 0\r\n1 2 3\r\n4 5 6\r\n",
            "OFF\r2 0 0\r1 2 3\r4 5 6\r",
            "  OFF\n 2 0 0\n 1.0\t2e0 +3\n 4 5 6\n",
        ] {
            let set = read(text);
            assert_eq!(set.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{text:?}");
            assert_eq!(set.format, "OFF, ascii");
        }
    }

    #[test]
    fn colors_normals_and_textures_come_along() {
        for (text, encoding) in [
            ("COFF\n1 0 0\n1 2 3 255 0 0 255\n", ColorEncoding::Srgb8),
            ("COFF\n1 0 0\n1 2 3 255 0 0\n", ColorEncoding::Srgb8),
            ("OFF\n1 0 0\n1 2 3 255 0 0\n", ColorEncoding::Srgb8),
            ("COFF\n1 0 0\n1 2 3 1.0 0.0 0.0 1.0\n", ColorEncoding::Fraction),
        ] {
            let set = read(text);
            assert_eq!(set.color_encoding, Some(encoding), "{text}");
            assert_eq!(set.colors, Some(vec![[1.0, 0.0, 0.0]]), "{text}");
        }
        for word in ["STCNOFF", "CNSTOFF"] {
            let set = read(format!("{word}\n1 0 0\n1 2 3 0 0 1 0.5 0 0 1 0.25 0.75\n"));
            assert_eq!(set.normals, Some(vec![[0.0, 0.0, 1.0]]));
            assert_eq!(set.colors, Some(vec![[ColorEncoding::Fraction.decode(0.5), 0.0, 0.0]]));
            assert_eq!(set.attribute("t"), Some(&Values::F64(vec![0.75])));
        }
    }

    #[test]
    fn binary_vertices_are_read() {
        let mut file = b"NOFF BINARY\n".to_vec();
        file.extend([2, 0, 0].map(u32::to_be_bytes).as_flattened());
        let floats = [1.0f32, 2.0, 3.0, 0.0, 0.0, 1.0, 4.0, 5.0, 6.0, 0.0, 1.0, 0.0];
        file.extend(floats.map(f32::to_be_bytes).as_flattened());
        let set = read(&file);
        assert_eq!(set.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        assert_eq!(set.normals, Some(vec![[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]));
        assert_eq!(set.format, "NOFF, binary");
        let cut = try_read(&file[..40]).unwrap_err().to_string();
        assert!(cut.contains("declares 2 vertices, but the file ends after 0"), "{cut}");
        let cut = try_read(&file[..14]).unwrap_err().to_string();
        assert!(cut.contains("found the end of the file after 2 bytes as the number"), "{cut}");
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, expected) in [
            (
                "4OFF\n1 0 0\n1 2 3 4\n",
                "a.off:1: found 4OFF, expected points in three dimensions: OFF without 4 or n; \
                 correct the line or export the file again",
            ),
            ("nOFF\n5\n1 0 0\n", "a.off:1: found nOFF"),
            ("OFFS\n1 0 0\n", "a.off:1: found 'OFFS', expected OFF, with ST, C or N before it"),
            ("OFF\n", "a.off:2: found the end of the file, expected OFF"),
            ("OFF\nx 6 12\n0 0 0\n", "a.off:2: found 'x 6 12', expected the numbers of vertices"),
            ("OFF\n-2 6 12\n0 0 0\n", "a.off:2: found '-2 6 12'"),
            (
                "OFF\n3 0 0\n0 0 0\n1 1 1\n",
                "a.off: the header declares 3 vertices, but the file ends after 2; the file is cut",
            ),
            ("OFF\n9999999999999999999 0 0\n0 0 0\n", "but the file ends after 1"),
            ("OFF\n2 0 0\n0 0 0\n1 1\n", "a.off:4: found 2 values, expected 3 values as in the"),
            ("OFF\n2 0 0\n0 0\n1 1\n", "a.off:3: found 2 values, expected x y z;"),
            (
                "CNOFF\n1 0 0\n1 2 3\n",
                "a.off:3: found 3 values, expected x y z, a normal, a colour",
            ),
            ("OFF\n1 0 0\n0 0 zero\n", "a.off:3: found 'zero', expected a number"),
            ("OFF\n0 0 0\n", "a.off: the file holds no points"),
            ("OFF\n1 0 0\nnan 0 0\n", "a.off: found no usable point: 1 in the file, 1 of them"),
        ] {
            let found = try_read(text).unwrap_err().to_string();
            assert!(found.contains(expected), "{text:?}: {found}");
        }
    }
}
