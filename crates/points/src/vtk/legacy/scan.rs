//! Goes through a legacy VTK file, keyword by keyword, and notes where what is.

use crate::columns::Shared;
use crate::error::PointsError;
use crate::vtk::lattice::{Axis, MAX_BARE_NODES, too_many_nodes};
use crate::vtk::legacy::cursor::Cursor;
use crate::vtk::legacy::{Encoding, Outline, Positions, Stored};
use crate::vtk::{Described, MAX_COLUMNS, Role};
use std::io;
use std::path::Path;

const DATASETS: [&str; 5] =
    ["POLYDATA", "UNSTRUCTURED_GRID", "STRUCTURED_GRID", "STRUCTURED_POINTS", "RECTILINEAR_GRID"];
const GEOMETRY: &str = "POINTS, DIMENSIONS, CELLS, POINT_DATA or another keyword of a dataset";
const DATA: &str = "SCALARS, VECTORS, NORMALS, FIELD or another keyword for data";

/// Whose the arrays are that come next.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Owner {
    Points(u64),
    Cells(u64),
}

/// Finds what a file has.
pub(super) fn outline(file: &Shared<'_>, path: &Path) -> Result<Outline, PointsError> {
    let mut cursor = Cursor::new(file, path);
    let version = cursor.required("# vtk DataFile Version")?;
    cursor.line()?; // the title
    let encoding = cursor.required("ASCII or BINARY")?;
    cursor.binary = match encoding.trim().to_ascii_uppercase().as_str() {
        "ASCII" => false,
        "BINARY" => true,
        _ => return Err(cursor.wrong(&encoding, "ASCII or BINARY")),
    };
    let encoding = if cursor.binary { "binary" } else { "ascii" };
    let mut scan = Scan {
        cursor,
        file,
        dataset: None,
        dimensions: None,
        origin: [0.0; 3],
        spacing: [1.0; 3],
        axes: [None, None, None],
        positions: None,
        owner: None,
        arrays: Vec::new(),
    };
    while let Some(line) = scan.cursor.next_line()? {
        if !scan.take(&line)? {
            break;
        }
    }
    let version = version.rsplit(' ').next().unwrap_or_default();
    let dataset = scan.dataset.as_deref().unwrap_or_default().to_lowercase();
    let in_words = format!("VTK {version}, {encoding}, {}", dataset.replace('_', " "));
    scan.finish(in_words)
}

struct Scan<'f, 'a> {
    cursor: Cursor<'f, 'a>,
    file: &'f Shared<'a>,
    dataset: Option<String>,
    dimensions: Option<[u64; 3]>,
    origin: [f64; 3],
    spacing: [f64; 3],
    /// Coordinates of a rectilinear grid.
    axes: [Option<Vec<f64>>; 3],
    positions: Option<Stored>,
    owner: Option<Owner>,
    /// For points.
    arrays: Vec<Stored>,
}

impl Scan<'_, '_> {
    /// Takes a keyword and what follows it. Tells whether to go on.
    fn take(&mut self, line: &str) -> Result<bool, PointsError> {
        let mut words = line.split_ascii_whitespace();
        let keyword = words.next().unwrap_or_default().to_ascii_uppercase();
        let words: Vec<&str> = words.collect();
        match keyword.as_str() {
            "DATASET" => {
                let kind = words.first().copied().unwrap_or_default().to_ascii_uppercase();
                if !DATASETS.contains(&kind.as_str()) {
                    let expected = format!("DATASET and one of {}", DATASETS.join(", "));
                    return Err(self.cursor.wrong(line, &expected));
                }
                self.dataset = Some(kind);
            }
            "FIELD" => self.field(line, &words)?,
            "METADATA" => self.cursor.skip_paragraph()?,
            _ if self.dataset.is_none() => return Err(self.cursor.wrong(line, "DATASET")),
            "POINT_DATA" => self.owner = Some(Owner::Points(self.count(line, words.first())?)),
            // Behind the points' data, nothing is missing.
            "CELL_DATA" if matches!(self.owner, Some(Owner::Points(_))) => return Ok(false),
            "CELL_DATA" => self.owner = Some(Owner::Cells(self.count(line, words.first())?)),
            _ => match self.owner {
                None => self.geometry(&keyword, line, &words)?,
                Some(Owner::Points(count) | Owner::Cells(count)) => {
                    self.data(&keyword, line, &words, count)?;
                }
            },
        }
        Ok(true)
    }

    /// A keyword before the data.
    fn geometry(&mut self, keyword: &str, line: &str, words: &[&str]) -> Result<(), PointsError> {
        match keyword {
            "POINTS" => {
                let count = self.count(line, words.first())?;
                let kind = words.get(1).copied();
                let stored = self.array(line, "points", kind, 3, count, Role::Position)?;
                self.positions = Some(stored);
            }
            "DIMENSIONS" => self.dimensions = Some(self.triple(line, words)?),
            "ORIGIN" => self.origin = self.triple(line, words)?,
            "SPACING" | "ASPECT_RATIO" => self.spacing = self.triple(line, words)?,
            "X_COORDINATES" | "Y_COORDINATES" | "Z_COORDINATES" => {
                let count = self.count(line, words.first())?;
                let kind = words.get(1).copied();
                let stored = self.array(line, keyword, kind, 1, count, Role::Other)?;
                let axis = usize::from(keyword.as_bytes()[0] - b'X');
                self.axes[axis] = Some(self.coordinates(stored)?);
            }
            "VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" | "CELLS" => {
                let cells = self.count(line, words.first())?;
                let size = self.count(line, words.get(1))?;
                // Since version 5.1, two arrays.
                match self.cursor.line_if("OFFSETS")? {
                    None => self.skip(line, Some("int"), size)?,
                    Some(offsets) => {
                        let kind = offsets.split_ascii_whitespace().nth(1);
                        self.skip(&offsets, kind, cells)?;
                        let line = self.cursor.required("CONNECTIVITY and a type")?;
                        self.skip(&line, line.split_ascii_whitespace().nth(1), size)?;
                    }
                }
            }
            "CELL_TYPES" => {
                let count = self.count(line, words.first())?;
                self.skip(line, Some("int"), count)?;
            }
            "BLANKING" => {
                let count = self.count(line, words.first())?;
                self.skip(line, words.get(1).copied(), count)?;
            }
            _ => return Err(self.cursor.wrong(line, GEOMETRY)),
        }
        Ok(())
    }

    /// All values of an array.
    fn coordinates(&self, stored: Stored) -> Result<Vec<f64>, PointsError> {
        // Each takes a bit of the file at least, as it is known to be there.
        let mut values = vec![0.0; usize::try_from(stored.values).unwrap_or(usize::MAX)];
        let found = stored.open(self.file).1.next(&mut values);
        match found {
            Ok(_) => Ok(values),
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                Err(self.cursor.wrong(&error.to_string(), "coordinates"))
            }
            Err(source) => Err(self.cursor.io_error(source)),
        }
    }

    /// A keyword for data of points or cells.
    fn data(
        &mut self,
        keyword: &str,
        line: &str,
        words: &[&str],
        count: u64,
    ) -> Result<(), PointsError> {
        let second = words.get(1).copied();
        let (kind, width, role) = match keyword {
            "SCALARS" => {
                let width = words.get(2).map_or(Ok(1), |width| self.count(line, Some(width)))?;
                (second, width, Role::Other)
            }
            "COLOR_SCALARS" => {
                let width = self.count(line, words.get(1))?;
                let role = if matches!(width, 3 | 4) { Role::Color } else { Role::Other };
                (Some("unsigned_char"), width, role)
            }
            "LOOKUP_TABLE" => {
                let size = self.count(line, words.get(1))?.saturating_mul(4);
                return self.skip(line, Some("unsigned_char"), size);
            }
            "TEXTURE_COORDINATES" => {
                (words.get(2).copied(), self.count(line, words.get(1))?, Role::Other)
            }
            "VECTORS" => (second, 3, Role::Other),
            "NORMALS" => (second, 3, Role::Normal),
            "TENSORS" => (second, 9, Role::Other),
            "TENSORS6" => (second, 6, Role::Other),
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => (second, 1, Role::Other),
            _ => return Err(self.cursor.wrong(line, DATA)),
        };
        if keyword == "SCALARS" {
            self.cursor.line_if("LOOKUP_TABLE")?;
        }
        let name = decoded(words.first().copied().unwrap_or_default());
        let mut stored = self.array(line, &name, kind, width, count, role)?;
        if keyword == "COLOR_SCALARS" && stored.encoding == Encoding::Text {
            stored.encoding = Encoding::Fractions;
        }
        self.keep(stored, count);
        Ok(())
    }

    /// Arrays under one name: each has a line of its own.
    fn field(&mut self, line: &str, words: &[&str]) -> Result<(), PointsError> {
        for _ in 0..self.count(line, words.get(1))? {
            let line = loop {
                let line = self.cursor.required("an array of the field")?;
                if !line.trim().eq_ignore_ascii_case("METADATA") {
                    break line;
                }
                self.cursor.skip_paragraph()?;
            };
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let [name, width, count, kind] = words[..] else {
                let expected = "an array's name, components, length and type";
                return Err(self.cursor.wrong(&line, expected));
            };
            let width = self.count(&line, Some(&width))?;
            let count = self.count(&line, Some(&count))?;
            let stored =
                self.array(&line, &decoded(name), Some(kind), width, count, Role::Other)?;
            self.keep(stored, count);
        }
        Ok(())
    }

    /// Keeps an array if it is one of numbers for the points.
    fn keep(&mut self, stored: Stored, count: u64) {
        let is_theirs = self.owner == Some(Owner::Points(count));
        let width = stored.described.width;
        let columns: usize = self.arrays.iter().map(|array| array.described.width).sum();
        let fits = width > 0 && 3 + columns + width <= MAX_COLUMNS;
        if is_theirs && fits && stored.encoding != Encoding::Strings {
            self.arrays.push(stored);
        }
    }

    /// Notes where an array is, and goes on behind it.
    fn array(
        &mut self,
        line: &str,
        name: &str,
        kind: Option<&str>,
        width: u64,
        count: u64,
        role: Role,
    ) -> Result<Stored, PointsError> {
        let encoding = kind.and_then(Encoding::of_type);
        let encoding = encoding.filter(|&e| role != Role::Position || e != Encoding::Strings);
        let Some(encoding) = encoding else {
            return Err(self.cursor.wrong(line, "a type such as float or double"));
        };
        let sizes = count.checked_mul(width).zip(usize::try_from(width).ok());
        let Some((values, width)) = sizes else {
            return Err(self.cursor.wrong(line, "an array that fits into a file"));
        };
        let kind = encoding.kind();
        let encoding = match encoding {
            Encoding::Binary(_) | Encoding::Bits if !self.cursor.binary => Encoding::Text,
            encoding => encoding,
        };
        let at = self.cursor.at;
        self.cursor.skip(encoding, name, count, values)?;
        let described = Described { name: name.to_owned(), width, kind, role };
        Ok(Stored { described, values, encoding, at })
    }

    /// Goes on behind an array that is not needed.
    fn skip(&mut self, line: &str, kind: Option<&str>, values: u64) -> Result<(), PointsError> {
        let name = line.split_ascii_whitespace().next().unwrap_or_default();
        self.array(line, name, kind, 1, values, Role::Other).map(|_| ())
    }

    fn count(&self, line: &str, word: Option<&&str>) -> Result<u64, PointsError> {
        let count = word.and_then(|word| word.parse().ok());
        count.ok_or_else(|| self.cursor.wrong(line, "counts of 0 or more behind the keyword"))
    }

    fn triple<T: std::str::FromStr>(
        &self,
        line: &str,
        words: &[&str],
    ) -> Result<[T; 3], PointsError> {
        let wrong = || self.cursor.wrong(line, "three numbers behind the keyword");
        let &[x, y, z] = words else { return Err(wrong()) };
        let parse = |word: &str| word.parse().map_err(|_| wrong());
        Ok([parse(x)?, parse(y)?, parse(z)?])
    }

    /// Sees whether all fits together.
    fn finish(self, in_words: String) -> Result<Outline, PointsError> {
        let path = self.cursor.path;
        let missing = |missing: &str| PointsError::Missing {
            path: path.into(),
            missing: missing.to_owned(),
            place: "among the keywords of the file".to_owned(),
            help: "export the points again",
        };
        let (points, positions) = match self.dataset.as_deref() {
            None => return Err(missing("DATASET")),
            Some("STRUCTURED_POINTS") => {
                let dimensions = self.dimensions.ok_or_else(|| missing("DIMENSIONS"))?;
                self.lattice([0, 1, 2].map(|axis| Axis::Even {
                    origin: self.origin[axis],
                    step: self.spacing[axis],
                    count: dimensions[axis],
                }))?
            }
            Some("RECTILINEAR_GRID") => {
                let [x, y, z] = &self.axes;
                let lists = x.clone().zip(y.clone()).zip(z.clone());
                let ((x, y), z) = lists.ok_or_else(|| missing("X_, Y_ or Z_COORDINATES"))?;
                self.lattice([x, y, z].map(Axis::Listed))?
            }
            Some(_) => {
                let stored = self.positions.ok_or_else(|| missing("POINTS"))?;
                (stored.values / 3, Positions::Stored(stored))
            }
        };
        let nodes = |[x, y, z]: [u64; 3]| x.saturating_mul(y).saturating_mul(z);
        let in_data = match self.owner {
            Some(Owner::Points(count)) => Some(count),
            _ => None,
        };
        for (keyword, count) in
            [("POINT_DATA", in_data), ("DIMENSIONS", self.dimensions.map(nodes))]
        {
            if let Some(count) = count.filter(|&count| count != points) {
                return Err(PointsError::wrong(
                    path,
                    &format!("the number of points in {keyword}"),
                    count,
                    &format!("{points}, as there are points"),
                    "export the points again",
                ));
            }
        }
        Ok(Outline { points, positions, arrays: self.arrays, in_words })
    }

    /// The nodes of a lattice, if the file has data for as many, or they are few.
    fn lattice(&self, axes: [Axis; 3]) -> Result<(u64, Positions), PointsError> {
        let [x, y, z] = [0, 1, 2].map(|axis| axes[axis].count());
        let values = |array: &Stored| array.values / array.described.width as u64;
        let most = self.arrays.iter().map(values).max().unwrap_or(0).max(MAX_BARE_NODES);
        let nodes = x.checked_mul(y).and_then(|nodes| nodes.checked_mul(z));
        match nodes.filter(|&nodes| nodes <= most) {
            Some(nodes) => Ok((nodes, Positions::Lattice(axes))),
            None => Err(too_many_nodes(self.cursor.path, [x, y, z], most)),
        }
    }
}

/// A name without the escapes for blanks and the like: `a%20b` is `a b`.
fn decoded(name: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = name.as_bytes();
    while let [first, others @ ..] = rest {
        let code = match (first, others) {
            (b'%', [a, b, ..]) => std::str::from_utf8(&[*a, *b])
                .ok()
                .and_then(|digits| u8::from_str_radix(digits, 16).ok()),
            _ => None,
        };
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &others[2..] } else { others };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
