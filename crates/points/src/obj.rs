//! Wavefront OBJ: its vertices are the points.
//!
//! A vertex is `v x y z`, then a weight, a colour, or both; some vertices may have a colour and others
//! none, which get that of objects without colours. Normals belong to corners of faces, not
//! to vertices; they are taken for the vertices' where there are as many of them and no face says
//! otherwise, and are left out elsewhere, which `format` says. Of faces nothing else is read.

use crate::collect::Collector;
use crate::error::{PointsError, Quoted};
use crate::field::{Field, Type};
use crate::lines::{Lines, SAMPLE, values, words};
use crate::meaning::{self, SAMPLE_ROWS, Sample};
use crate::number::number;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use crate::stream::{BLOCK_POINTS, Outlet};
use std::path::Path;

/// What lines above the vertices begin with.
const KEYWORDS: [&[u8]; 10] =
    [b"v", b"vn", b"vt", b"vp", b"f", b"o", b"g", b"s", b"mtllib", b"usemtl"];

/// The linear colour of vertices without one, where others have: that of objects without colours.
const NO_COLOR: f32 = 0.8;

const EXPECTED: &str = "3, 4, 6 or 7 values: x y z, then a weight, a colour, or both";

/// Whether a file that begins so is OBJ: its first line that is no comment begins with a keyword,
/// and one begins with `v`.
pub(crate) fn sniff(start: &[u8]) -> bool {
    let mut keywords = start.split(|byte| matches!(byte, b'\n' | b'\r')).filter_map(keyword);
    let first = keywords.clone().next();
    first.is_some_and(|first| KEYWORDS.contains(&first)) && keywords.any(|word| word == b"v")
}

/// The first word of a line that is no comment.
fn keyword(line: &[u8]) -> Option<&[u8]> {
    words(line).next().filter(|word| !word.starts_with(b"#"))
}

/// Reads the vertices.
pub(crate) fn read(
    mut source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let mut sample = sample(source.fill(SAMPLE).map_err(io_error)?);
    if !source.can_rewind() && matches!(sample.columns, 3 | 4) {
        // Colours may come later, and there is no way back then.
        sample = Sample::of_columns(sample.columns + 3, Vec::new());
    }
    loop {
        match read_as(&mut source, &sample, path, options) {
            // The first megabyte was without the colours that came then.
            Err(Failed::FirstColor(first)) if source.rewind().map_err(io_error)? => {
                if let Some(outlet) = &options.outlet {
                    outlet.begin_again();
                }
                sample = Sample::of_columns(first.0.len(), first.0);
            }
            Err(Failed::FirstColor(first)) => return Err(first.1),
            Err(Failed::Points(error)) => return Err(error),
            Ok(set) => return Ok(set),
        }
    }
}

/// Why vertices cannot be read as those of the sample.
enum Failed {
    /// This one is the first with a colour.
    FirstColor(Box<(Vec<f64>, PointsError)>),
    Points(PointsError),
}

impl From<PointsError> for Failed {
    fn from(error: PointsError) -> Self {
        Self::Points(error)
    }
}

/// Reads vertices that are like those of the sample.
fn read_as(
    source: &mut Source<'_>,
    sample: &Sample,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, Failed> {
    let fields = fields(sample);
    let mut collector = Collector::new(&fields, path, options)?;
    let mut vertices = Vertices::of(&fields, options);
    let mut lines = Lines::new(source, path)?;
    // A line that goes on in the next one, without the backslash.
    let mut joined = Vec::new();
    while let Some(line) = lines.next()? {
        let line = match (line.strip_suffix(b"\\"), joined.is_empty()) {
            (None, true) => line,
            (Some(part), _) if joined.len() + part.len() < SAMPLE => {
                joined.extend_from_slice(part);
                joined.push(b' ');
                continue;
            }
            (Some(_), _) => {
                let found = format!("more than {SAMPLE} bytes");
                return Err(lines.wrong(found, "a shorter line").into());
            }
            (None, false) => {
                joined.extend_from_slice(line);
                &joined
            }
        };
        match vertices.see(line) {
            Ok(true) => {
                let kept = collector.kept();
                collector.push(&vertices.row)?;
                if collector.kept() == kept {
                    vertices.normals.leave_out(vertices.found - 1);
                }
            }
            Ok(false) => (),
            Err((found, expected)) => {
                let error = lines.wrong(found, expected);
                return Err(
                    match matches!((vertices.columns, vertices.row.len()), (3, 6) | (4, 7)) {
                        true => Failed::FirstColor(Box::new((vertices.row, error))),
                        false => error.into(),
                    },
                );
            }
        }
        joined.clear();
    }
    let Vertices { found: vertices, normals, uncolored, uncolored_count, .. } = vertices;
    if vertices == 0 {
        let error = PointsError::Missing {
            path: path.into(),
            missing: "vertex".to_owned(),
            place: "in lines that begin with 'v'".to_owned(),
            help: "export the points as vertices",
        };
        return Err(error.into());
    }
    if uncolored_count == vertices {
        collector.without_colors();
    }
    let mut set = collector.finish("OBJ")?;
    give_no_color(&mut set, &uncolored, uncolored_count, vertices);
    let normals = normals.give_to(&mut set, vertices);
    set.format += &normals;
    Ok(set)
}

/// What is found in the lines.
struct Vertices {
    columns: usize,
    /// The last vertex.
    row: Vec<f64>,
    found: u64,
    normals: Normals,
    wants_normals: bool,
    wants_colors: bool,
    /// How many have no colour, where others have one.
    uncolored_count: u64,
    /// Their places, where points are held.
    uncolored: Vec<u32>,
}

impl Vertices {
    fn of(fields: &[Field], options: &ReadOptions) -> Self {
        Self {
            columns: fields.len(),
            row: Vec::new(),
            found: 0,
            normals: Normals { outlet: options.outlet.clone(), ..Normals::default() },
            wants_normals: options.wanted.normals(),
            wants_colors: options.wanted.colors(),
            uncolored_count: 0,
            uncolored: Vec::new(),
        }
    }

    /// Takes what a line has. Tells whether that is a vertex, now in `row`; fails with what was
    /// found and what was expected.
    fn see(&mut self, line: &[u8]) -> Result<bool, (String, String)> {
        let mut words = words(line).take_while(|word| !word.starts_with(b"#"));
        match words.next() {
            Some(b"v") => {
                numbers(words, &mut self.row)?;
                match self.row.len() {
                    count if count == self.columns => (),
                    count @ (3 | 4) if count + 3 == self.columns => {
                        self.row.resize(self.columns, f64::NAN);
                        self.uncolored_count += 1;
                        let holds_colors = self.wants_colors && self.normals.outlet.is_none();
                        if let Some(place) = u32::try_from(self.found).ok().filter(|_| holds_colors)
                        {
                            self.uncolored.push(place);
                        }
                    }
                    3 | 4 | 6 | 7 => {
                        let expected = format!("{} as in the first vertex", values(self.columns));
                        return Err((values(self.row.len()), expected));
                    }
                    count => return Err((values(count), EXPECTED.to_owned())),
                }
                self.found += 1;
                return Ok(true);
            }
            Some(b"vn") if self.wants_normals => {
                numbers(words, &mut self.row)?;
                self.normals.push(&self.row)?;
            }
            Some(b"f") => self.normals.check_face(words, self.found),
            _ => (),
        }
        Ok(false)
    }
}

/// Gives vertices without a colour that of objects without any, and says how many there are.
fn give_no_color(set: &mut PointSet, uncolored: &[u32], count: u64, vertices: u64) {
    let Some(colors) = set.colors.as_mut().filter(|_| count > 0) else { return };
    for (color, index) in colors.iter_mut().zip(&set.file_index) {
        if uncolored.binary_search(index).is_ok() {
            *color = [NO_COLOR; 3];
        }
    }
    set.notes.push(format!(
        "{count} of {vertices} vertices have no colour and get that of objects without colours, {NO_COLOR}"
    ));
}

/// The fields of a vertex, by how many numbers the first has, and what colours look like.
fn fields(sample: &Sample) -> Vec<Field> {
    let color = ["red", "green", "blue"];
    let names: &[&[&str]] = match sample.columns {
        4 => &[&["x", "y", "z", "w"]],
        6 => &[&["x", "y", "z"], &color],
        7 => &[&["x", "y", "z", "w"], &color],
        _ => &[&["x", "y", "z"]],
    };
    let names: Vec<String> = names.concat().iter().map(|&name| name.to_owned()).collect();
    match sample.columns {
        3 | 4 | 6 | 7 => meaning::by_names(&names, None, sample),
        _ => names.iter().map(|name| Field::new(name, Type::F64)).collect(),
    }
}

/// The first vertices, and of those with a colour only these. Whole numbers up to 1 are fractions,
/// as the format has it.
fn sample(start: &[u8]) -> Sample {
    let mut sample = Sample::default();
    let mut row = Vec::new();
    let mut rows = 0;
    for line in start.split(|byte| matches!(byte, b'\n' | b'\r')) {
        let mut words = words(line).take_while(|word| !word.starts_with(b"#"));
        if words.next() != Some(b"v") || numbers(words, &mut row).is_err() {
            continue;
        }
        if sample.columns == 0 || (sample.columns < 5 && row.len() == sample.columns + 3) {
            sample = Sample::of_columns(row.len(), Vec::new());
            rows = 0;
        }
        if row.len() == sample.columns {
            sample.values.extend(&row);
            rows += 1;
        }
        if rows == SAMPLE_ROWS && sample.columns > 5 {
            break;
        }
    }
    sample.values.truncate(SAMPLE_ROWS * sample.columns);
    sample
}

/// All words as numbers. Fails with what was found and what was expected.
fn numbers<'a>(
    words: impl Iterator<Item = &'a [u8]>,
    row: &mut Vec<f64>,
) -> Result<(), (String, String)> {
    row.clear();
    for word in words {
        let value = number(word, false);
        row.push(value.ok_or_else(|| (Quoted(word).to_string(), "a number".to_owned()))?);
        if row.len() > 8 {
            return Err(("more than 8 values".to_owned(), EXPECTED.to_owned()));
        }
    }
    Ok(())
}

/// The normals of a file.
#[derive(Default)]
struct Normals {
    normals: Vec<[f32; 3]>,
    found: u64,
    /// Whether a face has a corner whose normal is not in its vertex's place.
    belong_to_corners: bool,
    /// Where normals go, block by block, if they are not held.
    outlet: Option<Outlet>,
    /// Places of vertices without use, whose normals do not go there.
    left_out: Vec<u64>,
}

impl Normals {
    fn push(&mut self, row: &[f64]) -> Result<(), (String, String)> {
        let &[x, y, z] = row else {
            return Err((values(row.len()), "3 values: a normal".to_owned()));
        };
        self.found += 1;
        if self.left_out.binary_search(&(self.found - 1)).is_ok() {
            return Ok(());
        }
        self.normals.push([x as f32, y as f32, z as f32]);
        if self.normals.len() >= BLOCK_POINTS {
            self.hand_over();
        }
        Ok(())
    }

    /// The vertex of this place is not kept.
    fn leave_out(&mut self, place: u64) {
        if self.outlet.is_some() {
            self.left_out.push(place);
        }
    }

    fn hand_over(&mut self) {
        if let Some(outlet) = &self.outlet {
            outlet.take_normals(std::mem::take(&mut self.normals));
        }
    }

    fn check_face<'a>(&mut self, corners: impl Iterator<Item = &'a [u8]>, vertices: u64) {
        if self.found == 0 || self.belong_to_corners {
            return;
        }
        let normals = self.found;
        // From 1, or from the last one backwards.
        let place = |word: Option<&[u8]>, count: u64| {
            let index: i64 = std::str::from_utf8(word?).ok()?.parse().ok()?;
            if index < 0 { count.checked_add_signed(index + 1) } else { u64::try_from(index).ok() }
        };
        for corner in corners {
            let mut parts = corner.split(|&byte| byte == b'/');
            let vertex = place(parts.next(), vertices);
            let normal = place(parts.nth(1), normals);
            self.belong_to_corners |= normal.is_some() && normal != vertex;
        }
    }

    /// Gives the points their normals, if they have any, and says what was done.
    fn give_to(mut self, set: &mut PointSet, vertices: u64) -> String {
        match self.found {
            0 => String::new(),
            count if self.belong_to_corners || count != vertices => {
                format!("; left out: {count} normals, which are not the vertices'")
            }
            _ => {
                self.hand_over();
                let of = |&index: &u32| self.normals[index as usize];
                set.normals = Some(set.file_index.iter().map(of).collect());
                ", normals".to_owned()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::read_bytes;
    use crate::set::{ColorEncoding, Values};

    fn try_read(text: impl AsRef<[u8]>) -> Result<PointSet, PointsError> {
        read_bytes(text.as_ref(), Path::new("a.obj"), &ReadOptions::default())
    }

    fn read(text: impl AsRef<[u8]>) -> PointSet {
        try_read(text).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn vertices_are_read_whatever_stands_between() {
        for text in [
            "v 1 2 3\nv 4 5 6\n",
            "# a\nmtllib a.mtl\no b\nv 1 2 3 # c\nvt 0 0\n  v\t4  5 6\nf 1 2 2\nl 1 2\nend",
            "v 1 2 3\r\nv 4 5 6",
            "v 1 2 3\rv 4 5 6\r",
            "v 1 \\\n2 3\nv \\\r\n4\\\r\n5 \\\r\n6\n",
            "g a\nv 1e0 2.0 +3\n\n\nusemtl c\nv 4 5 6\nvp 1 2\ncurv 1 2 3\n",
        ] {
            let set = read(text);
            assert_eq!(set.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{text:?}");
            assert_eq!(set.format, "OBJ");
        }
    }

    #[test]
    fn colors_that_come_late_are_read_from_a_stream_too() {
        let plain = "v 1 2 3\n".repeat(200_000);
        for text in [plain.clone() + "v 1 2 3 1 0 0.5\n", plain, "v 1 2 3 1\n".to_owned()] {
            let progress: &mut dyn FnMut(u64, u64) = &mut |_, _| ();
            let stream = Source::of_stream(text.as_bytes(), progress);
            let set = super::read(stream, Path::new("a.obj"), &ReadOptions::default()).unwrap();
            assert!(set == read(&text), "{:?} {:?}", set.notes, set.color_encoding);
        }
    }

    #[test]
    fn weights_and_colors_come_along() {
        let set = read("v 1 2 3 0.5\n");
        assert_eq!(set.attribute("w"), Some(&Values::F64(vec![0.5])));
        let set = read("v 1 2 3 0.25 0 1\nv 1 2 3 1 1 1\n");
        let quarter = ColorEncoding::Fraction.decode(0.25);
        assert_eq!(set.colors, Some(vec![[quarter, 0.0, 1.0], [1.0; 3]]));
        assert_eq!(read("v 1 2 3 1 1 0\n").colors, Some(vec![[1.0, 1.0, 0.0]]));
        let set = read("v 1 2 3 1 255 128 0\n");
        assert_eq!(set.attribute("w"), Some(&Values::F64(vec![1.0])));
        assert_eq!(set.color_encoding, Some(ColorEncoding::Srgb8));
    }

    /// Of the vertices of several objects, some may have been painted.
    #[test]
    fn vertices_without_a_color_among_others_get_that_of_objects_without() {
        let painted = [ColorEncoding::Fraction.decode(0.25), 0.0, 1.0];
        let set = read("v 1 2 3\nv 4 5 6 0.25 0 1\nv nan 0 0\nv 7 8 9\n");
        assert_eq!(set.colors, Some(vec![[0.8; 3], painted, [0.8; 3]]));
        let note = "3 of 4 vertices have no colour and get that of objects without colours, 0.8";
        assert_eq!(set.notes, [note]);
        let set = read("v 1 2 3 1 255 128 0\nv 4 5 6 0.5\n");
        assert_eq!(set.color_encoding, Some(ColorEncoding::Srgb8));
        assert_eq!(set.colors.as_ref().unwrap()[1], [0.8; 3]);
        assert_eq!(set.attribute("w"), Some(&Values::F64(vec![1.0, 0.5])));
        assert_eq!(read("v 1 2 3 1 1 0\n").notes, [""; 0]);
        // Nine values are too many, wherever they come.
        let nine = "v 1 2 3 4 5 6 7 8 9\n";
        for text in [format!("v 1 2 3 1 1 0\n{nine}"), format!("v 1 2 3\n{nine}")] {
            assert!(try_read(text).unwrap_err().to_string().contains("more than 8 values"));
        }
        // The first colour may come after the part that is looked at.
        let plain = "v 1 2 3\n".repeat(SAMPLE / 8 + 10);
        let set = read(plain + "v 4 5 6 0.25 0 1\n");
        assert_eq!(set.colors.as_ref().unwrap()[SAMPLE / 8 + 9..], [[0.8; 3], painted]);
        assert_eq!(set.len(), SAMPLE / 8 + 11);
    }

    #[test]
    fn normals_are_taken_where_they_are_the_vertices() {
        let vertices = "v 1 2 3\nv nan 0 0\nv 4 5 6\n";
        let normals = "vn 1 0 0\nvn 0 1 0\nvn 0 0 1\n";
        for faces in ["", "f 1//1 2//2 3//3\n", "f 1/9/1 -2/9/-2 3\n", "f 1 2 3\n"] {
            let set = read([vertices, normals, faces].concat());
            assert_eq!(set.normals, Some(vec![[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), "{faces}");
            assert_eq!(set.format, "OBJ, normals");
        }
        let left_out = "OBJ; left out: 3 normals, which are not the vertices'";
        let set = read([vertices, normals, "f 1//2 2//1 3//3\n"].concat());
        assert_eq!((set.normals, set.format.as_str()), (None, left_out));
        let set = read([vertices, normals, "v 7 8 9\n"].concat());
        assert_eq!((set.normals, set.format.as_str()), (None, left_out));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let weights = "3, 4, 6 or 7 values: x y z, then a weight, a colour, or both; correct the \
                       line or export the file again";
        for (text, expected) in [
            ("v 1 2\n", format!("a.obj:1: found 2 values, expected {weights}")),
            ("v 1 2 3\nv\n", format!("a.obj:2: found 0 values, expected {weights}")),
            ("v 1 2 3 4 5\n", format!("a.obj:1: found 5 values, expected {weights}")),
            (
                "v 1 2 3 4 5 6 7 8 9\n",
                format!("a.obj:1: found more than 8 values, expected {weights}"),
            ),
            (
                "v 1 2 3\n# a\nv 1 2 3 4\n",
                "a.obj:3: found 4 values, expected 3 values as in the first vertex".to_owned(),
            ),
            ("v 1 2 3\nv 1 b 3\n", "a.obj:2: found 'b', expected a number;".to_owned()),
            (
                "v 1 2 3\nvn 1 2\n",
                "a.obj:2: found 2 values, expected 3 values: a normal".to_owned(),
            ),
            ("v 1 \\\n\\\n2 x\n", "a.obj:3: found 'x', expected a number".to_owned()),
            (
                "vn 1 2 3\n",
                "a.obj: found no vertex, expected it in lines that begin with 'v'".to_owned(),
            ),
            ("# nothing\n", "a.obj: found no vertex".to_owned()),
            ("v inf 0 0\n", "found no usable point: 1 in the file, 1 of them dropped".to_owned()),
        ] {
            let found = try_read(text).unwrap_err().to_string();
            assert!(found.contains(&expected), "{text:?}: {found}");
        }
        let long = try_read("v 1 2 3\n".to_owned() + &"0 \\\n".repeat(600_000)).unwrap_err();
        assert!(long.to_string().contains("found more than 1048576 bytes"), "{long}");
    }
}
