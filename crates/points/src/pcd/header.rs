//! The header of a PCD file.

use crate::color;
use crate::error::{PointsError, Quoted};
use crate::field::Type;
use crate::sensor::Pose;
use crate::source::{Line, Source};
use std::path::Path;

/// Longest line of a header, most lines, and most numbers of a point.
const MAX_LINE: usize = 1 << 16;
const MAX_LINES: u64 = 1000;
const MAX_NUMBERS: usize = 1 << 16;

pub(super) struct Header {
    pub(super) version: String,
    pub(super) fields: Vec<Declared>,
    pub(super) points: u64,
    /// More than one in an organised cloud.
    pub(super) rows: u64,
    /// What VIEWPOINT says: where the sensor was and how it was turned; `None` where it says nothing.
    pub(super) viewpoint: Option<Pose>,
    pub(super) data: Data,
    /// Number of lines, so that messages about text can go on counting.
    pub(super) lines: u64,
}

/// A field as the header declares it.
pub(super) struct Declared {
    pub(super) name: String,
    pub(super) kind: Type,
    pub(super) count: usize,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Data {
    Ascii,
    Binary,
    Compressed,
}

impl Data {
    pub(super) fn in_words(self) -> &'static str {
        match self {
            Self::Ascii => "ascii",
            Self::Binary => "binary",
            Self::Compressed => "binary compressed",
        }
    }
}

impl Declared {
    /// Bytes of all its numbers.
    pub(super) fn size(&self) -> usize {
        self.kind.size() * self.count
    }

    /// Bytes between others, which mean nothing.
    pub(super) fn is_padding(&self) -> bool {
        self.name == "_"
    }

    /// A colour in the bytes of a number of 32 bits, of which PCL makes floats at times.
    pub(super) fn is_packed(&self) -> bool {
        self.count == 1 && self.kind.size() == 4 && color::is_packed(&self.name)
    }

    /// The value of a word; of a packed colour, what the collector makes bits of.
    pub(super) fn parse(&self, word: &[u8]) -> Option<f64> {
        self.kind.parse(word)
    }
}

impl Header {
    /// Bytes of a binary record, at least 1.
    pub(super) fn record_size(&self) -> usize {
        self.fields.iter().map(Declared::size).sum()
    }
}

/// Reads the header, up to and including its line DATA.
pub(super) fn read(source: &mut Source<'_>, path: &Path) -> Result<Header, PointsError> {
    let mut version = "0.7".to_owned();
    let [mut names, mut sizes, mut types, mut counts] = [const { Vec::<String>::new() }; 4];
    let (mut width, mut height, mut points) = (None, None, None);
    let mut viewpoint = None;
    for number in 1..=MAX_LINES {
        let wrong = |found: String, expected: &str| PointsError::Line {
            path: path.into(),
            line: number,
            found,
            expected: expected.to_owned(),
            help: "correct the header or export the file again",
        };
        let line = match source.line(b'\n', MAX_LINE) {
            Ok(Line::Whole(line)) => String::from_utf8_lossy(line).trim().to_owned(),
            Ok(Line::TooLong) => {
                let found = format!("more than {MAX_LINE} bytes");
                return Err(wrong(found, "a line of a PCD header"));
            }
            Ok(Line::End) => return Err(wrong("the end of the file".to_owned(), "'DATA'")),
            Err(source) => return Err(PointsError::Io { path: path.into(), source }),
        };
        let mut words = line.split_whitespace();
        let keyword = words.next().unwrap_or_default();
        let rest: Vec<String> = words.map(str::to_owned).collect();
        let quoted = || Quoted(line.as_bytes()).to_string();
        let count = |expected: &str| match rest.as_slice() {
            [number] => number.parse::<u64>().map_err(|_| wrong(quoted(), expected)),
            _ => Err(wrong(quoted(), expected)),
        };
        match keyword {
            "VERSION" => version = rest.join(" "),
            "FIELDS" | "COLUMNS" => names = rest,
            "SIZE" => sizes = rest,
            "TYPE" => types = rest,
            "COUNT" => counts = rest,
            "WIDTH" => width = Some(count("'WIDTH' and a number")?),
            "HEIGHT" => height = Some(count("'HEIGHT' and a number")?),
            "POINTS" => points = Some(count("'POINTS' and a number")?),
            "VIEWPOINT" => viewpoint = pose(&rest),
            "DATA" => {
                let data = match rest.first().map(String::as_str) {
                    Some("ascii") => Data::Ascii,
                    Some("binary") => Data::Binary,
                    Some("binary_compressed") => Data::Compressed,
                    _ => {
                        let expected = "'DATA' with ascii, binary or binary_compressed";
                        return Err(wrong(quoted(), expected));
                    }
                };
                let fields = declared(&names, &sizes, &types, &counts)
                    .map_err(|(found, expected)| wrong(found, expected))?;
                let rows = height.unwrap_or(1);
                let organised = width.map(|width| width.saturating_mul(rows));
                let points = match (points, organised) {
                    (Some(points), Some(organised)) if points != organised => {
                        let found = format!("{points} POINTS, but {organised} by WIDTH and HEIGHT");
                        return Err(wrong(found, "the same number"));
                    }
                    (points, organised) => points.or(organised).ok_or_else(|| {
                        wrong("neither POINTS nor WIDTH before 'DATA'".to_owned(), "one of them")
                    })?,
                };
                return Ok(Header {
                    version,
                    fields,
                    points,
                    rows,
                    viewpoint,
                    data,
                    lines: number,
                });
            }
            _ if keyword.is_empty() || keyword.starts_with('#') => (),
            _ => {
                let expected = "VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, \
                                POINTS or DATA";
                return Err(wrong(quoted(), expected));
            }
        }
    }
    Err(PointsError::Line {
        path: path.into(),
        line: MAX_LINES,
        found: format!("a header of more than {MAX_LINES} lines"),
        expected: "'DATA'".to_owned(),
        help: "export the file again",
    })
}

/// The pose that is no default. Words that are no pose say nothing: no point depends on them.
fn pose(words: &[String]) -> Option<Pose> {
    let numbers: Vec<f64> = words.iter().map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let &[x, y, z, qw, qx, qy, qz] = numbers.as_slice() else { return None };
    let pose = Pose::of_quaternion([qw, qx, qy, qz], [x, y, z]);
    pose.filter(|pose| *pose != Pose::IDENTITY)
}

/// The fields, or what is wrong with them: what was found, and what was expected.
fn declared(
    names: &[String],
    sizes: &[String],
    types: &[String],
    counts: &[String],
) -> Result<Vec<Declared>, (String, &'static str)> {
    if names.is_empty() {
        return Err(("no 'FIELDS' before 'DATA'".to_owned(), "the names of the fields"));
    }
    let number_of = |what: &str, list: &[String]| {
        (format!("{} of {what} for {} of FIELDS", list.len(), names.len()), "one for each field")
    };
    if sizes.len() != names.len() {
        return Err(number_of("SIZE", sizes));
    }
    if types.len() != names.len() {
        return Err(number_of("TYPE", types));
    }
    if !counts.is_empty() && counts.len() != names.len() {
        return Err(number_of("COUNT", counts));
    }
    let mut fields = Vec::new();
    let mut numbers = 0usize;
    for (index, name) in names.iter().enumerate() {
        let (size, letter) = (sizes[index].as_str(), types[index].as_str());
        let kind = match (letter, size) {
            ("I", "1") => Type::I8,
            ("I", "2") => Type::I16,
            ("I", "4") => Type::I32,
            ("I", "8") => Type::I64,
            ("U", "1") => Type::U8,
            ("U", "2") => Type::U16,
            ("U", "4") => Type::U32,
            ("U", "8") => Type::U64,
            ("F", "4") => Type::F32,
            ("F", "8") => Type::F64,
            _ => {
                let found = format!("TYPE {letter} of SIZE {size} for field '{name}'");
                return Err((found, "I or U of 1, 2, 4 or 8 bytes, or F of 4 or 8"));
            }
        };
        let count = match counts.get(index) {
            None => 1,
            Some(count) => count
                .parse::<usize>()
                .map_err(|_| (format!("COUNT {count} for field '{name}'"), "a number"))?,
        };
        numbers = numbers.saturating_add(count);
        if numbers > MAX_NUMBERS {
            return Err((format!("{numbers} numbers a point"), "at most 65536"));
        }
        fields.push(Declared { name: name.clone(), kind, count });
    }
    if numbers == 0 {
        return Err(("points without numbers".to_owned(), "a COUNT of 1 or more"));
    }
    Ok(fields)
}
