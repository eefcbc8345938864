//! The header of a PLY file.

use crate::ply::source::{Line, Source};
use crate::read::{PointsError, Quoted};
use std::io::Read;
use std::path::Path;

/// Longest line of a header.
const MAX_LINE: usize = 1 << 16;
/// A header with more lines is taken for damage.
const MAX_LINES: u64 = 1 << 16;

/// What a header declares.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Number of lines, so that messages about text can go on counting.
    pub(super) lines: u64,
    /// The byte that ends a line: a line feed, or a carriage return where no line feed follows it.
    pub(super) line_end: u8,
}

/// How values are stored.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A kind of record, and how many there are.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// One entry of a record.
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Number(Type),
    List { length: Type, item: Type },
}

/// A number's type. 64-bit integers are no PLY type.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

const TYPES: &str = "a type: char, uchar, short, ushort, int, uint, float, double, int8, uint8, \
                     int16, uint16, int32, uint32, float32 or float64";

impl Encoding {
    pub(super) fn in_words(self) -> &'static str {
        match self {
            Self::Ascii => "PLY 1.0, ascii",
            Self::LittleEndian => "PLY 1.0, binary little-endian",
            Self::BigEndian => "PLY 1.0, binary big-endian",
        }
    }
}

impl Element {
    /// Bytes of a binary record; `None` if lists make them differ.
    pub(super) fn record_size(&self) -> Option<usize> {
        self.properties.iter().try_fold(0, |size, property| match property.kind {
            Kind::Number(kind) => Some(size + kind.size()),
            Kind::List { .. } => None,
        })
    }

    /// Bytes that a record takes at least.
    pub(super) fn least_record_size(&self, encoding: Encoding) -> u64 {
        self.properties
            .iter()
            .map(|property| match (encoding, property.kind) {
                // A digit and a blank; the last one's may be missing where the file ends.
                (Encoding::Ascii, _) => 2,
                (_, Kind::Number(kind) | Kind::List { length: kind, .. }) => kind.size() as u64,
            })
            .sum::<u64>()
            - u64::from(encoding == Encoding::Ascii && !self.properties.is_empty())
    }
}

impl Type {
    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::I8 => "char",
            Self::U8 => "uchar",
            Self::I16 => "short",
            Self::U16 => "ushort",
            Self::I32 => "int",
            Self::U32 => "uint",
            Self::F32 => "float",
            Self::F64 => "double",
        }
    }

    /// In bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// Smallest and largest value of the type.
    fn limits(self) -> (f64, f64) {
        match self {
            Self::I8 => (i8::MIN.into(), i8::MAX.into()),
            Self::U8 => (0.0, u8::MAX.into()),
            Self::I16 => (i16::MIN.into(), i16::MAX.into()),
            Self::U16 => (0.0, u16::MAX.into()),
            Self::I32 => (i32::MIN.into(), i32::MAX.into()),
            Self::U32 => (0.0, u32::MAX.into()),
            Self::F32 | Self::F64 => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// A word of a text file as the value that a binary file of this type would hold. Integers may
    /// be written as floats.
    pub(super) fn parse(self, word: &[u8]) -> Option<f64> {
        let text = std::str::from_utf8(word).ok()?;
        match self {
            Self::F32 => text.parse::<f32>().map(f64::from).ok().or_else(|| not_finite(text)),
            Self::F64 => text.parse().ok().or_else(|| not_finite(text)),
            _ => {
                let (min, max) = self.limits();
                let value: f64 = text.parse().ok()?;
                (value >= min && value <= max && value.fract() == 0.0).then_some(value)
            }
        }
    }
}

/// The ways in which C libraries print what is not finite: `-nan(ind)`, `1.#QNAN`, `-1.#IND`,
/// `1.#INF`.
fn not_finite(text: &str) -> Option<f64> {
    let text = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    if text.starts_with("nan") || text.starts_with("1.#") { Some(f64::NAN) } else { None }
}

/// Reads the header, up to and including its last line.
pub(super) fn read<R: Read>(
    source: &mut Source<'_, R>,
    path: &Path,
) -> Result<Header, PointsError> {
    let io_error = |error| PointsError::Io { path: path.into(), source: error };
    // "ply" was seen; what follows it tells how lines end.
    let start = source.fill(5).map_err(io_error)?;
    let line_end = match (start.get(3), start.get(4)) {
        (Some(b'\r'), Some(b'\n')) => b'\n',
        (Some(b'\r'), _) => b'\r',
        _ => b'\n',
    };

    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    for number in 1..=MAX_LINES {
        let wrong = |found: String, expected: &str| PointsError::Line {
            path: path.into(),
            line: number,
            found,
            expected: expected.to_owned(),
            help: "correct the header or export the file again",
        };
        let line = match source.line(line_end, MAX_LINE).map_err(io_error)? {
            Line::Whole(line) => String::from_utf8_lossy(line),
            Line::TooLong => {
                return Err(wrong(format!("more than {MAX_LINE} bytes"), "a line of a PLY header"));
            }
            Line::End => return Err(wrong("the end of the file".to_owned(), "'end_header'")),
        };
        let line = line.trim();
        let quoted = || Quoted(line.as_bytes()).to_string();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "ply" if number == 1 => (),
            "" | "comment" | "obj_info" => (),
            "format" => {
                let expected = "'format' with ascii, binary_little_endian or binary_big_endian, \
                                and 1.0";
                let mut words = rest.split_whitespace();
                let found = match words.next() {
                    Some("ascii") => Some(Encoding::Ascii),
                    Some("binary_little_endian") => Some(Encoding::LittleEndian),
                    Some("binary_big_endian") => Some(Encoding::BigEndian),
                    _ => None,
                };
                let version = words.next();
                if found.is_none() || version != Some("1.0") || words.next().is_some() {
                    return Err(wrong(quoted(), expected));
                }
                if encoding.is_some() {
                    return Err(wrong("a second 'format'".to_owned(), "one"));
                }
                encoding = found;
            }
            "element" => {
                let expected = "'element', a name, and a count of 0 or more";
                let (name, count) = rest
                    .trim()
                    .rsplit_once(char::is_whitespace)
                    .ok_or_else(|| wrong(quoted(), expected))?;
                let count = count.parse().map_err(|_| wrong(quoted(), expected))?;
                let name = name.trim().to_owned();
                if elements.iter().any(|element| element.name == name) {
                    return Err(wrong(format!("a second element '{name}'"), "names that differ"));
                }
                elements.push(Element { name, count, properties: Vec::new() });
            }
            "property" => {
                let property =
                    parse_property(rest).map_err(|expected| wrong(quoted(), expected))?;
                let Some(element) = elements.last_mut() else {
                    return Err(wrong(quoted(), "an 'element' before its properties"));
                };
                if element.properties.iter().any(|other| other.name == property.name) {
                    let found = format!("a second property '{}'", property.name);
                    return Err(wrong(found, "names that differ"));
                }
                element.properties.push(property);
            }
            "end_header" => {
                let Some(encoding) = encoding else {
                    return Err(wrong("no 'format' before 'end_header'".to_owned(), "one"));
                };
                return Ok(Header { encoding, elements, lines: number, line_end });
            }
            _ => {
                let expected = "format, element, property, comment, obj_info or end_header";
                return Err(wrong(quoted(), expected));
            }
        }
    }
    Err(PointsError::Line {
        path: path.into(),
        line: MAX_LINES,
        found: format!("a header of more than {MAX_LINES} lines"),
        expected: "'end_header'".to_owned(),
        help: "export the file again",
    })
}

/// What follows the word `property`. Fails with what was expected.
fn parse_property(text: &str) -> Result<Property, &'static str> {
    let (first, rest) = split_word(text);
    let (kind, name) = if first == "list" {
        let (length, rest) = split_word(rest);
        let (item, name) = split_word(rest);
        let length = Type::from_name(length).ok_or(TYPES)?;
        if length.is_float() {
            return Err("an integer type for a list's length");
        }
        (Kind::List { length, item: Type::from_name(item).ok_or(TYPES)? }, name)
    } else {
        (Kind::Number(Type::from_name(first).ok_or(TYPES)?), rest)
    };
    if name.is_empty() {
        return Err("'property', a type, and a name");
    }
    Ok(Property { name: name.to_owned(), kind })
}

/// The first word of a text, and what follows it.
fn split_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
    (word, rest.trim())
}
