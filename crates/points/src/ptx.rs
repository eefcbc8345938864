//! PTX: scans in text, one after the other, as Leica's programs write them.
//!
//! A scan has a head of ten lines: how many columns and rows it has, the scanner's position and axes,
//! and a matrix of four by four that takes its points to the coordinates of all scans, by rows whose last is
//! the shift. Then comes a line for each direction: `x y z intensity`, and a colour in some.
//! Directions without a measurement are `0 0 0`: they are counted as invalid.
//!
//! The matrix says where the scanner stands, since it takes it from the origin to there. Where it leaves points as they
//! are, position and axes do: some programs write the points of all scans in the same coordinates.

use crate::collect::Collector;
use crate::error::{PointsError, Quoted};
use crate::field::{Field, Type};
use crate::lines::{Lines, line_end_of, values, words};
use crate::number::number;
use crate::options::ReadOptions;
use crate::sensor::{self, Pixels, Pose};
use crate::set::PointSet;
use crate::source::Source;
use std::path::Path;

/// How many numbers the lines of a scan's head have, after the two counts.
const HEAD: [usize; 8] = [3, 3, 3, 3, 4, 4, 4, 4];
/// What the first of them are.
const HEAD_LINES: [&str; 4] = ["the scanner's position", "its x axis", "its y axis", "its z axis"];
/// The colour of points in scans without, where others have: that of objects without any, 0.8, in sRGB.
const NO_COLOR: f64 = 231.0;

/// Whether a file that begins so begins with the head of a scan.
pub(crate) fn sniff(start: &[u8]) -> bool {
    let end = line_end_of(start);
    let mut lines = start.split(|&byte| byte == end);
    let counts = lines.by_ref().take(2).all(|line| count(line).is_some());
    let mut row = Vec::new();
    counts
        && HEAD.iter().all(|&wanted| {
            lines.next().is_some_and(|line| numbers(line, &mut row).is_ok() && row.len() == wanted)
        })
}

/// A single whole number.
fn count(line: &[u8]) -> Option<u64> {
    std::str::from_utf8(line.trim_ascii()).ok()?.parse().ok()
}

/// All words as numbers. Fails with one that is none.
fn numbers<'a>(line: &'a [u8], row: &mut Vec<f64>) -> Result<(), &'a [u8]> {
    row.clear();
    for word in words(line) {
        row.push(number(word, true).ok_or(word)?);
    }
    Ok(())
}

/// Reads the points of all scans.
pub(crate) fn read(
    mut source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    // Where there is no way back, colours are expected from the beginning on.
    let colored = !source.can_rewind();
    match Scans::read(&mut source, path, options, colored) {
        // A scan with colours after others without.
        Err(Failed::FirstColor(error)) => match source.rewind().map_err(io_error)? {
            true => {
                if let Some(outlet) = &options.outlet {
                    outlet.begin_again();
                }
                Scans::read(&mut source, path, options, true).map_err(Failed::error)
            }
            false => Err(error),
        },
        result => result.map_err(Failed::error),
    }
}

/// Why scans cannot be read as they were begun.
enum Failed {
    /// No colour was expected, but there is one.
    FirstColor(PointsError),
    Points(PointsError),
}

impl Failed {
    fn error(self) -> PointsError {
        match self {
            Self::FirstColor(error) | Self::Points(error) => error,
        }
    }
}

impl From<PointsError> for Failed {
    fn from(error: PointsError) -> Self {
        Self::Points(error)
    }
}

/// What is read of the scans.
struct Scans<'s, 'a> {
    lines: Lines<'s, 'a>,
    path: &'s Path,
    row: Vec<f64>,
    /// Whether any point has a colour, and how many have none.
    has_colors: bool,
    uncolored: u64,
    notes: Vec<String>,
    sensors: Vec<sensor::Scan>,
}

/// The head of a scan.
struct Head {
    points: u64,
    rows: u64,
    /// Where the scanner stands.
    pose: Pose,
    /// Rows of the rotation, and the shift: points are `p · rotation + shift`.
    rotation: [[f64; 3]; 3],
    shift: [f64; 3],
}

impl<'s, 'a> Scans<'s, 'a> {
    /// Reads all; with `colored`, there are colours whatever the first scan has.
    fn read(
        source: &'s mut Source<'a>,
        path: &'s Path,
        options: &ReadOptions,
        colored: bool,
    ) -> Result<PointSet, Failed> {
        let lines = Lines::new(source, path)?;
        let (row, notes) = (Vec::new(), Vec::new());
        let (has_colors, sensors) = (false, Vec::new());
        let mut scans = Self { lines, path, row, has_colors, uncolored: 0, notes, sensors };
        let mut collector: Option<Collector<'_>> = None;
        let mut has_color = colored;
        let mut count = 0;
        while let Some(head) = scans.head(count)? {
            count += 1;
            let before = collector.as_ref().map_or(0, Collector::seen);
            let mut pixels = Pixels::new(head.points);
            for index in 0..head.points {
                scans.point(&head, index, count)?;
                let with_color = scans.row.len() == 7;
                scans.has_colors |= with_color;
                let collector = match &mut collector {
                    Some(collector) => collector,
                    None => {
                        has_color |= with_color;
                        let mut new = Collector::new(&fields(has_color), path, options)?;
                        new.expect(scans.lines.source.records(head.points, 8))?;
                        collector.insert(new)
                    }
                };
                let pixel = [index / head.rows, index % head.rows].map(|n| n as f64);
                if scans.row[..3] == [0.0; 3] {
                    pixels.see(pixel, [0.0; 3]);
                    collector.push_invalid()?;
                    continue;
                }
                match (has_color, with_color) {
                    (false, true) => {
                        let expected = "4, as in the lines before: x y z intensity";
                        return Err(Failed::FirstColor(scans.lines.wrong(values(7), expected)));
                    }
                    (true, false) => {
                        scans.row.extend([NO_COLOR; 3]);
                        scans.uncolored += 1;
                    }
                    _ => (),
                }
                head.place(&mut scans.row);
                pixels.see(pixel, collector.position_of(&scans.row));
                collector.push(&scans.row)?;
            }
            scans.sensors.push(sensor::Scan {
                pose: head.pose,
                is_posed: true,
                has_angles: false,
                pixels: Some(pixels),
                points: before..collector.as_ref().map_or(0, Collector::seen),
            });
        }
        let mut collector = match collector {
            Some(collector) => collector,
            None => Collector::new(&fields(false), path, options)?,
        };
        if !scans.has_colors {
            collector.without_colors();
        }
        let of_scans = if count == 1 { String::new() } else { format!(", {count} scans") };
        let mut set = collector.finish(&format!("PTX{of_scans}"))?;
        if scans.uncolored > 0 && set.colors.is_some() {
            scans.notes.push(format!(
                "{} points have no colour, unlike others, and get that of objects without colours, 0.8",
                scans.uncolored
            ));
        }
        set.notes.append(&mut scans.notes);
        set.sensors = sensor::of_scans(&scans.sensors);
        Ok(set)
    }

    /// The next line's numbers, now in `row`. A blank line is none.
    fn numbers(&mut self, what: &str, wanted: &[usize]) -> Result<(), PointsError> {
        let Some(line) = self.lines.next()? else {
            return Err(self.lines.wrong("the end of the file", what));
        };
        match numbers(line, &mut self.row) {
            Err(word) => {
                let found = Quoted(word).to_string();
                Err(self.lines.wrong(found, format!("a number of {what}")))
            }
            Ok(()) if wanted.contains(&self.row.len()) => Ok(()),
            Ok(()) => Err(self.lines.wrong(values(self.row.len()), what)),
        }
    }

    /// The head of the next scan; `None` at the end of the file.
    fn head(&mut self, before: u64) -> Result<Option<Head>, PointsError> {
        let columns = loop {
            let Some(line) = self.lines.next()? else { return Ok(None) };
            if !line.trim_ascii().is_empty() {
                let found = Quoted(line.trim_ascii()).to_string();
                break count(line).ok_or_else(|| {
                    let expected = match before {
                        0 => "how many columns the scan has",
                        _ => "how many columns the next scan has, as the last one is complete",
                    };
                    self.lines.wrong(found, expected)
                })?;
            }
        };
        let Some(line) = self.lines.next()? else {
            return Err(self.lines.wrong("the end of the file", "how many rows the scan has"));
        };
        let (rows, found) = (count(line), Quoted(line.trim_ascii()).to_string());
        let rows = rows.ok_or_else(|| self.lines.wrong(found, "how many rows the scan has"))?;
        let points = columns.checked_mul(rows).filter(|&points| points <= u64::from(u32::MAX));
        let points = points.ok_or_else(|| PointsError::TooMany {
            path: self.path.into(),
            found: columns.saturating_mul(rows),
        })?;
        let mut stated = [[0.0; 3]; 4];
        for (of, what) in stated.iter_mut().zip(HEAD_LINES) {
            self.numbers(&format!("3 values: {what}"), &[3])?;
            of.copy_from_slice(&self.row);
        }
        let mut matrix = [[0.0; 4]; 4];
        for row in &mut matrix {
            self.numbers("4 values: a row of the matrix", &[4])?;
            row.copy_from_slice(&self.row);
        }
        let head = self.transform([points, rows], matrix)?;
        let [position, axes @ ..] = stated;
        // What leaves all points as they are says nothing of where they were taken from.
        let unmoved = head.pose == Pose::IDENTITY;
        let pose = if unmoved { pose(axes, position).unwrap_or(head.pose) } else { head.pose };
        Ok(Some(Head { pose, ..head }))
    }

    /// What a matrix does with so many points, in so many rows.
    fn transform(
        &mut self,
        [points, rows]: [u64; 2],
        mut m: [[f64; 4]; 4],
    ) -> Result<Head, PointsError> {
        let last_column = [m[0][3], m[1][3], m[2][3]];
        if m[3] == [0.0, 0.0, 0.0, 1.0] && last_column != [0.0; 3] {
            m = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| m[j][i]));
            let note = "a matrix with the shift in its last column was read by columns";
            if !self.notes.iter().any(|other| other == note) {
                self.notes.push(note.to_owned());
            }
        }
        let straight = [m[0][3], m[1][3], m[2][3], m[3][3]] == [0.0, 0.0, 0.0, 1.0];
        if !straight || !m.as_flattened().iter().all(|value| value.is_finite()) {
            let expected = "a matrix of finite numbers, with 0 0 0 1 as its last column";
            return Err(self.lines.wrong("another matrix", expected));
        }
        let rotation = [0, 1, 2].map(|i| [m[i][0], m[i][1], m[i][2]]);
        let shift = [m[3][0], m[3][1], m[3][2]];
        let unturned = Pose { translation: shift, ..Pose::IDENTITY };
        let pose = pose(rotation, shift).unwrap_or(unturned);
        Ok(Head { points, rows, pose, rotation, shift })
    }

    /// The line of a point, now in `row`.
    fn point(&mut self, head: &Head, index: u64, scan: u64) -> Result<(), PointsError> {
        match self.numbers("4 or 7 values: x y z intensity, and red green blue", &[4, 7]) {
            Err(PointsError::Line { found, .. }) if found == "the end of the file" => {
                Err(PointsError::CutOff {
                    path: self.path.into(),
                    what: format!("points of scan {scan}"),
                    declared: head.points,
                    found: index,
                    bytes_declared: None,
                    bytes_found: None,
                })
            }
            result => result,
        }
    }
}

impl Head {
    /// Takes the point that begins a row to the coordinates of all scans.
    fn place(&self, row: &mut [f64]) {
        let [x, y, z] = [row[0], row[1], row[2]];
        let r = &self.rotation;
        for axis in 0..3 {
            row[axis] = x * r[0][axis] + y * r[1][axis] + z * r[2][axis] + self.shift[axis];
        }
    }
}

/// That of a scanner with these axes and this place; `None` where they are no axes across each other.
fn pose(axes: [[f64; 3]; 3], place: [f64; 3]) -> Option<Pose> {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let unit = axes.map(|axis| axis.map(|x| x / dot(axis, axis).sqrt()));
    let straight = |a: usize, b: usize| dot(unit[a], unit[b]).abs() < 1e-3;
    let are_axes = straight(0, 1) && straight(1, 2) && straight(2, 0);
    // Rows of a matrix that takes vectors to its right.
    let rotation = [0, 1, 2].map(|i| [unit[0][i], unit[1][i], unit[2][i]]);
    are_axes.then_some(Pose { rotation, translation: place })
}

fn fields(colored: bool) -> Vec<Field> {
    let position = ["x", "y", "z"].map(|name| Field::new(name, Type::F64));
    let color = ["red", "green", "blue"].map(|name| Field::new(name, Type::U8));
    let mut fields = position.to_vec();
    fields.push(Field::new("intensity", Type::F32));
    if colored {
        fields.extend(color);
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::read_bytes;
    use crate::set::{ColorEncoding, Values};

    fn try_read(text: &str, name: &str) -> Result<PointSet, PointsError> {
        read_bytes(text.as_bytes(), Path::new(name), &ReadOptions::default())
    }

    /// A scan of two columns and one row, turned by 90° about z and moved by (100, 200, 300).
    fn scan(points: &str) -> String {
        format!(
            "2\n1\n100 200 300\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 200 300 1\n\
             {points}"
        )
    }

    #[test]
    fn points_are_placed_by_the_matrix_and_misses_are_counted() {
        let text = scan("1 2 3 0.25\n0 0 0 0.5\n");
        for name in ["a.ptx", "a.txt", "a"] {
            let set = try_read(&text.replace('\n', "\r\n"), name).unwrap();
            // x becomes y, and y becomes -x.
            assert_eq!(set.positions, [[98.0, 201.0, 303.0]], "{name}");
            assert_eq!((set.invalid, set.format.as_str()), (1, "PTX"));
            assert_eq!(set.attribute("intensity"), Some(&Values::F32(vec![0.25])));
            assert_eq!((set.colors, set.notes), (None, vec![]));
        }
    }

    #[test]
    fn several_scans_are_read_with_their_colors() {
        let colored = scan("1 0 0 1 255 0 0\n0 1 0 0.5 0 255 0\n");
        let plain = scan("0 0 1 0\n0 0 0 0.5\n");
        for (text, order) in
            [(colored.clone() + &plain, [0, 1, 2]), (plain + "\n" + &colored, [2, 0, 1])]
        {
            let set = try_read(&text, "a.ptx").unwrap();
            let expected = [[100.0, 201.0, 300.0], [99.0, 200.0, 300.0], [100.0, 200.0, 301.0]];
            assert_eq!(set.positions, order.map(|place: usize| expected[place]));
            let grey = ColorEncoding::Srgb8.decode(NO_COLOR);
            assert!((grey - 0.8).abs() < 2e-3);
            let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [grey; 3]];
            assert_eq!(set.colors.unwrap(), order.map(|place| colors[place]));
            assert_eq!((set.invalid, set.format.as_str()), (1, "PTX, 2 scans"));
            assert!(set.notes[0].starts_with("1 points have no colour"), "{:?}", set.notes);
        }
    }

    /// What is packed or comes through a pipe has no way back to where colours were not expected.
    #[test]
    fn colors_that_come_late_are_read_from_a_stream_too() {
        let colored = scan("1 0 0 1 255 0 0\n0 1 0 0.5 0 255 0\n");
        let plain = scan("0 0 1 0\n0 0 0 0.5\n");
        for text in [plain.clone() + &colored, colored, plain.clone() + &plain] {
            let progress: &mut dyn FnMut(u64, u64) = &mut |_, _| ();
            let stream = Source::of_stream(text.as_bytes(), progress);
            let set = read(stream, Path::new("a.ptx"), &ReadOptions::default()).unwrap();
            assert!(
                set == try_read(&text, "a.ptx").map(|of| PointSet { up: None, ..of }).unwrap(),
                "{text}"
            );
        }
    }

    /// Some programs write matrices for vectors that stand to their right.
    #[test]
    fn a_shift_in_the_last_column_is_found() {
        let text = "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 -1 0 100\n1 0 0 200\n0 0 1 300\n0 0 0 1\n1 2 3 0\n";
        let set = try_read(text, "a.ptx").unwrap();
        assert_eq!(set.positions, [[98.0, 201.0, 303.0]]);
        assert_eq!(set.notes, ["a matrix with the shift in its last column was read by columns"]);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, expected) in [
            (scan("1 2 3 0\n"), "declares 2 points of scan 1, but the file ends after 1"),
            (scan("1 2 3 0\n1 2 3\n"), "a.ptx:12: found 3 values, expected 4 or 7 values: x y z"),
            (scan("1 2 3 0\n1 2 b 3\n"), "a.ptx:12: found 'b', expected a number of 4 or 7"),
            (scan("1 2 3 0\n1 2 3 0\n1 2 3 0\n"), "a.ptx:13: found '1 2 3 0', expected how many"),
            (scan("").replace("300 1", "300 2"), "a.ptx:10: found another matrix"),
            ("5\n".to_owned(), "a.ptx:2: found the end of the file, expected how many rows"),
            ("5\n-1\n".to_owned(), "a.ptx:2: found '-1', expected how many rows"),
            ("999999999\n999999999\n".to_owned(), "found 999999998000000001 points, at most"),
            (scan("").replace("2\n1\n", "0\n1\n"), "a.ptx: the file holds no points"),
            (scan("0 0 0 0\n0 0 0 0\n"), "no usable point: 2 in the file, 0 of them dropped"),
        ] {
            let found = try_read(&text, "a.ptx").unwrap_err().to_string();
            assert!(found.contains(expected), "{text:?}: {found}");
        }
    }
}
