//! The header of a PLY file.

use crate::error::{PointsError, Quoted};
use crate::field::Type;
use crate::source::{Line, Source};
use std::collections::HashSet;
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

/// The type of this name in a header.
fn type_named(name: &str) -> Option<Type> {
    Some(match name {
        "char" | "int8" => Type::I8,
        "uchar" | "uint8" => Type::U8,
        "short" | "int16" => Type::I16,
        "ushort" | "uint16" => Type::U16,
        "int" | "int32" => Type::I32,
        "uint" | "uint32" => Type::U32,
        "float" | "float32" => Type::F32,
        "double" | "float64" => Type::F64,
        _ => return None,
    })
}

/// The name of a type in a header. Integers of 64 bits are no PLY type.
pub(super) fn type_name(kind: Type) -> &'static str {
    match kind {
        Type::I8 => "char",
        Type::U8 => "uchar",
        Type::I16 => "short",
        Type::U16 => "ushort",
        Type::I32 | Type::I64 => "int",
        Type::U32 | Type::U64 => "uint",
        Type::F32 => "float",
        Type::F64 => "double",
    }
}

/// Reads the header, up to and including its last line.
pub(super) fn read(source: &mut Source<'_>, path: &Path) -> Result<Header, PointsError> {
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
    // Of elements, and of the last one's properties.
    let (mut element_names, mut names) = (HashSet::new(), HashSet::new());
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
            _ if number == 1 => return Err(wrong(quoted(), "'ply'")),
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
                if !element_names.insert(name.clone()) {
                    return Err(wrong(format!("a second element '{name}'"), "names that differ"));
                }
                names.clear();
                elements.push(Element { name, count, properties: Vec::new() });
            }
            "property" => {
                let property =
                    parse_property(rest).map_err(|expected| wrong(quoted(), expected))?;
                let Some(element) = elements.last_mut() else {
                    return Err(wrong(quoted(), "an 'element' before its properties"));
                };
                if !names.insert(property.name.clone()) {
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
        let length = type_named(length).ok_or(TYPES)?;
        if length.is_float() {
            return Err("an integer type for a list's length");
        }
        (Kind::List { length, item: type_named(item).ok_or(TYPES)? }, name)
    } else {
        (Kind::Number(type_named(first).ok_or(TYPES)?), rest)
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
