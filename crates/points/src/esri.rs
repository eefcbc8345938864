//! ESRI ASCII grids: heights on a lattice, as GIS programs write them.
//!
//! A head of words and numbers, then the heights, from the row in the north to that in the south.
//! Each cell is a point in its middle. Cells without data are counted as invalid.

use crate::collect::Collector;
use crate::error::{PointsError, Quoted};
use crate::field::{Field, Type};
use crate::lines::{line_end_of, words, wrong_line};
use crate::number::number;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::{Line, Source};
use std::path::Path;

/// Longest line: a row of heights may be one.
const MAX_LINE: usize = 1 << 26;
/// Longest head.
const MAX_HEAD: u64 = 100;

/// The words of a head, in lower case.
const KEYS: [&str; 10] = [
    "ncols",
    "nrows",
    "xllcorner",
    "xllcenter",
    "yllcorner",
    "yllcenter",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
];
/// What stands for no data where the head is silent.
const NO_DATA: f64 = -9999.0;

/// Whether a file that begins so is a grid: it begins with a word of the head and has both counts.
pub(crate) fn sniff(start: &[u8]) -> bool {
    let end = line_end_of(start);
    let keys = || start.split(|&byte| byte == end).filter_map(|line| words(line).next()).take(12);
    let has = |key: &str| keys().any(|word| word.eq_ignore_ascii_case(key.as_bytes()));
    keys().next().is_some_and(|word| key_of(word).is_some()) && has("ncols") && has("nrows")
}

fn key_of(word: &[u8]) -> Option<usize> {
    KEYS.iter().position(|key| word.eq_ignore_ascii_case(key.as_bytes()))
}

/// What the head says.
struct Grid {
    columns: u64,
    rows: u64,
    /// The middle of the cell in the south-west.
    origin: [f64; 2],
    step: [f64; 2],
    no_data: f64,
}

impl Grid {
    /// From the numbers of the head, in the order of [`KEYS`]. Fails with a word that is missing.
    fn of(head: &[Option<f64>; 10]) -> Result<Self, &'static str> {
        let one = |key: usize, other: usize, missing| head[key].or(head[other]).ok_or(missing);
        let count = |key: usize| head[key].ok_or(KEYS[key]);
        let step = [one(7, 6, "cellsize")?, one(8, 6, "cellsize")?];
        let (x, y) = (one(2, 3, "xllcorner")?, one(4, 5, "yllcorner")?);
        // A corner is half a cell from the middle.
        let half = |key: usize, step: f64| if head[key].is_some() { step / 2.0 } else { 0.0 };
        Ok(Self {
            columns: count(0)? as u64,
            rows: count(1)? as u64,
            origin: [x + half(2, step[0]), y + half(4, step[1])],
            step,
            no_data: head[9].unwrap_or(NO_DATA),
        })
    }

    fn is_missing(&self, height: f64) -> bool {
        // Programs print the lowest float with more or fewer digits.
        let lowest = self.no_data.abs() > 1e30 && (height / self.no_data - 1.0).abs() < 1e-5;
        height == self.no_data || lowest
    }

    /// The middle of a cell, counted from the north-west.
    fn place(&self, cell: u64) -> [f64; 2] {
        let (column, row) = (cell % self.columns, self.rows - 1 - cell / self.columns);
        [self.origin[0] + self.step[0] * column as f64, self.origin[1] + self.step[1] * row as f64]
    }
}

/// Reads a point of each cell.
pub(crate) fn read(
    mut source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let end = line_end_of(source.fill(MAX_HEAD as usize * 40).map_err(io_error)?);
    let mut head = [None; 10];
    let mut reading: Option<Cells<'_>> = None;
    let mut number_of_line = 0;
    loop {
        number_of_line += 1;
        let left = source.records(u64::MAX, 2);
        let line = match source.line(end, MAX_LINE).map_err(io_error)? {
            Line::Whole(line) => line,
            Line::End => break,
            Line::TooLong => {
                let found = format!("more than {MAX_LINE} bytes");
                return Err(wrong_line(path, number_of_line, found, "a shorter line"));
            }
        };
        let wrong = |found: &[u8], expected: String| {
            wrong_line(path, number_of_line, Quoted(found).to_string(), expected)
        };
        let mut words = words(line).peekable();
        let Some(&first) = words.peek() else { continue };
        let in_head = reading.is_none() && first[0].is_ascii_alphabetic();
        if in_head && !first.eq_ignore_ascii_case(b"nan") {
            let key = key_of(first)
                .ok_or_else(|| wrong(first, format!("a word of the head: {}", KEYS.join(", "))))?;
            let value = words.nth(1).and_then(|word| number(word, true));
            head[key] = Some(value.filter(|&value| fits(key, value)).ok_or_else(|| {
                wrong(line.trim_ascii(), format!("{} and {}", KEYS[key], kind_of(key)))
            })?);
            continue;
        }
        let cells = match &mut reading {
            Some(cells) => cells,
            None => {
                let grid = Grid::of(&head).map_err(|missing| PointsError::Missing {
                    path: path.into(),
                    missing: format!("'{missing}'"),
                    place: format!("above the heights, which begin in line {number_of_line}"),
                    help: "export the grid again",
                })?;
                reading.insert(Cells::new(grid, left, path, options)?)
            }
        };
        for word in words {
            let height = number(word, true).ok_or_else(|| wrong(word, "a height".to_owned()))?;
            if !cells.take(height)? {
                let Grid { columns, rows, .. } = cells.grid;
                let expected = format!("no more than {columns} x {rows} heights");
                return Err(wrong(word, expected));
            }
        }
    }
    match reading {
        Some(cells) => cells.finish(path),
        None => Err(wrong_line(path, number_of_line, "the end of the file", "the heights")),
    }
}

fn fits(key: usize, value: f64) -> bool {
    match KEYS[key] {
        "ncols" | "nrows" => value.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&value),
        "cellsize" | "dx" | "dy" => value.is_finite() && value > 0.0,
        "nodata_value" => true,
        _ => value.is_finite(),
    }
}

fn kind_of(key: usize) -> &'static str {
    match KEYS[key] {
        "ncols" | "nrows" => "a whole number of at least 1",
        "cellsize" | "dx" | "dy" => "a number above 0",
        _ => "a number",
    }
}

/// The cells that were read.
struct Cells<'a> {
    grid: Grid,
    collector: Collector<'a>,
    next: u64,
}

impl<'a> Cells<'a> {
    /// `most` is how many heights the file can have.
    fn new(
        grid: Grid,
        most: u64,
        path: &'a Path,
        options: &ReadOptions,
    ) -> Result<Self, PointsError> {
        let fields = ["x", "y", "z"].map(|name| Field::new(name, Type::F64));
        let mut collector = Collector::new(&fields, path, options)?;
        collector.expect(grid.columns.saturating_mul(grid.rows).min(most))?;
        Ok(Self { grid, collector, next: 0 })
    }

    /// Takes the next height; says whether there is a cell for it.
    fn take(&mut self, height: f64) -> Result<bool, PointsError> {
        let cell = self.next;
        if cell >= self.grid.columns.saturating_mul(self.grid.rows) {
            return Ok(false);
        }
        self.next += 1;
        if self.grid.is_missing(height) {
            self.collector.push_invalid()?;
        } else {
            let [x, y] = self.grid.place(cell);
            self.collector.push(&[x, y, height])?;
        }
        Ok(true)
    }

    fn finish(self, path: &Path) -> Result<PointSet, PointsError> {
        let Grid { columns, rows, .. } = self.grid;
        let declared = columns.saturating_mul(rows);
        if self.next < declared {
            return Err(PointsError::CutOff {
                path: path.into(),
                what: "heights".to_owned(),
                declared,
                found: self.next,
                bytes_declared: None,
                bytes_found: None,
            });
        }
        self.collector.finish(&format!("ESRI ASCII grid, {columns} x {rows}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::read_bytes;

    fn try_read(text: &str) -> Result<PointSet, PointsError> {
        read_bytes(text.as_bytes(), Path::new("a.asc"), &ReadOptions::default())
    }

    const HEAD: &str = "ncols 3\nnrows 2\nxllcorner 500000\nyllcorner 4600000\ncellsize 10\n";

    #[test]
    fn cells_are_points_in_their_middles() {
        let expected = [
            [500_005.0, 4_600_015.0, 1.0],
            [500_015.0, 4_600_015.0, 2.5],
            [500_005.0, 4_600_005.0, -4.0],
            [500_025.0, 4_600_005.0, 6.0],
        ];
        let centre = HEAD.replace("xllcorner 500000", "XLLCENTER\t500005");
        let centre = centre.replace("yllcorner 4600000", "YLLCENTER 4600005");
        let comma = HEAD.replace("cellsize 10", "cellsize 10,0");
        for text in [
            format!("{HEAD}NODATA_value -9999\n1 2.5 -9999\n-4 -9999 6\n"),
            format!("{HEAD}1 2.5 -9999\n-4 -9999.0 6"),
            format!("{HEAD}nodata_value 0\n1 2.5\n0 -4\n\n0 6\n").replace('\n', "\r\n"),
            format!(
                "{centre}NODATA_VALUE -3.402823466e+38\n1 2.5 -3.4028235e+38 -4 -3.40282e38 6\n"
            ),
            format!("{comma}1,0 2,5 -9999\n-4 -9999 6\n"),
            format!("{}1 2.5 -9999 -4 -9999 6", HEAD.replace("cellsize 10", "dx 10\ndy 10")),
        ] {
            let set = try_read(&text).unwrap();
            assert_eq!(set.positions, expected, "{text}");
            assert_eq!((set.invalid, set.format.as_str()), (2, "ESRI ASCII grid, 3 x 2"));
            assert!(set.notes.is_empty());
        }
        let set = try_read(&format!("{HEAD}nodata_value nan\nnan 2 3\n4 5 6\n")).unwrap();
        assert_eq!((set.len(), set.non_finite), (5, 1));
        let wide =
            try_read(&format!("{}1 2\n3 4 5 6", HEAD.replace("cellsize 10", "dx 10\ndy 20")));
        assert_eq!(wide.unwrap().positions[0], [500_005.0, 4_600_030.0, 1.0]);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, expected) in [
            (format!("{HEAD}1 2 3\n4 5\n"), "declares 6 heights, but the file ends after 5"),
            (format!("{HEAD}1 2 3\n4 5 6 7\n"), "a.asc:7: found '7', expected no more than 3 x 2"),
            (format!("{HEAD}1 2 b\n"), "a.asc:6: found 'b', expected a height"),
            (HEAD.to_owned(), "a.asc:6: found the end of the file, expected the heights"),
            (
                HEAD.replace("ncols 3", "ncols -3"),
                "a.asc:1: found 'ncols -3', expected ncols and a",
            ),
            (HEAD.replace("10", "0"), "found 'cellsize 0', expected cellsize and a number above 0"),
            (format!("{HEAD}units m\n1\n"), "a.asc:6: found 'units', expected a word of the head"),
            (HEAD.replace("cellsize 10\n", "1 2 3\n"), "found no 'cellsize', expected it above"),
            (
                HEAD.replace("ncols 3", "ncols 4294967295").replace("nrows 2", "nrows 9") + "1\n",
                "but the file ends after 1",
            ),
            (format!("{HEAD}{}", "-9999 ".repeat(6)), "no usable point: 6 in the file"),
        ] {
            let found = try_read(&text).unwrap_err().to_string();
            assert!(found.contains(expected), "{text:?}: {found}");
        }
    }
}
