//! What stands above the data of a NumPy array.

use crate::columns::{Coding, Place, fill};
use crate::field::Type;
use crate::meaning::spread;
use crate::npy::literal::{self, Literal};
use crate::npy::{MAX_COLUMNS, Trouble};
use std::io::Read;

/// Longest header.
const MAX_HEADER: usize = 1 << 16;
/// Most bytes of a record.
const MAX_RECORD: usize = 1 << 20;

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// What a header says.
pub(super) struct Header {
    pub(super) shape: Vec<u64>,
    /// Whether the first index is the fastest.
    pub(super) fortran: bool,
    pub(super) record: Record,
    /// Bytes up to the data.
    pub(super) length: u64,
}

/// An element of an array.
pub(super) struct Record {
    /// In bytes.
    pub(super) size: usize,
    /// The numbers in it, by name where it has named fields. What is no number is left out.
    pub(super) numbers: Vec<(String, Place)>,
    pub(super) has_names: bool,
    has_objects: bool,
}

impl Header {
    /// Reads a header, up to the data.
    pub(super) fn read(reader: &mut dyn Read) -> Result<Self, Trouble> {
        let mut start = [0; 12];
        let mut reader = reader;
        fill(&mut reader, &mut start[..10])?;
        if !start.starts_with(MAGIC) {
            return Err(Trouble::header("no NumPy array", "one, which begins with '\\x93NUMPY'"));
        }
        let (before, length) = match start[6] {
            1 => (10, usize::from(u16::from_le_bytes([start[8], start[9]]))),
            2 | 3 => {
                fill(&mut reader, &mut start[10..])?;
                let length = u32::from_le_bytes([start[8], start[9], start[10], start[11]]);
                (12, length as usize)
            }
            version => {
                return Err(Trouble::header(format!("version {version}"), "version 1, 2 or 3"));
            }
        };
        if length > MAX_HEADER {
            let found = format!("a length of {length} bytes");
            return Err(Trouble::header(found, format!("at most {MAX_HEADER}")));
        }
        let mut text = Vec::new();
        reader.take(length as u64).read_to_end(&mut text)?;
        if text.len() < length {
            let found = format!("the end of the file after {} of {length} bytes", text.len());
            return Err(Trouble::header(found, "the header"));
        }
        // Version 3 is UTF-8, others are Latin 1.
        let text = match String::from_utf8(text) {
            Ok(text) => text,
            Err(error) => error.as_bytes().iter().map(|&byte| char::from(byte)).collect(),
        };
        let no_header = || {
            let short: String = text.trim().chars().take(60).collect();
            let expected = "a dictionary with descr, fortran_order and shape";
            Trouble::header(format!("'{}'", short.escape_debug()), expected)
        };
        let Some(Literal::Dict(entries)) = literal::parse(&text) else { return Err(no_header()) };
        let entry = |name: &str| {
            let found = entries.iter().find(|(key, _)| *key == Literal::Text(name.to_owned()));
            found.map(|(_, value)| value).ok_or_else(no_header)
        };
        let &Literal::Bool(fortran) = entry("fortran_order")? else { return Err(no_header()) };
        let shape = lengths(entry("shape")?).ok_or_else(no_header)?;
        let record = Record::of(entry("descr")?)?;
        Ok(Self { shape, fortran, record, length: (before + length) as u64 })
    }

    /// The shape as Python writes it.
    pub(super) fn shape_in_words(&self) -> String {
        const MOST: usize = 8;
        let shown: Vec<String> = self.shape.iter().take(MOST).map(u64::to_string).collect();
        match shown.as_slice() {
            [one] => format!("({one},)"),
            _ if self.shape.len() > MOST => format!("({}, …)", shown.join(", ")),
            _ => format!("({})", shown.join(", ")),
        }
    }
}

/// Lengths as a shape has them: one number, or several.
fn lengths(literal: &Literal) -> Option<Vec<u64>> {
    let length = |literal: &Literal| match literal {
        &Literal::Number(number) => u64::try_from(number).ok(),
        _ => None,
    };
    match literal {
        Literal::List(items) => items.iter().map(length).collect(),
        one => Some(vec![length(one)?]),
    }
}

impl Record {
    fn of(descr: &Literal) -> Result<Self, Trouble> {
        let mut record =
            Self { size: 0, numbers: Vec::new(), has_names: false, has_objects: false };
        match descr {
            Literal::List(fields) => {
                record.has_names = true;
                record.fields(fields, "")?;
            }
            Literal::Text(name) => {
                let (coding, big, size) = number_type(name)?;
                record.has_objects |= is_object(name);
                record.push("", coding, big, size, 1)?;
            }
            _ => return Err(Trouble::header("no type of elements", "one such as '<f4'")),
        }
        // Arrays with Python's objects are pickled as a whole.
        if record.has_objects {
            record.numbers.clear();
        }
        Ok(record)
    }

    /// Named fields, one behind the other. Names of fields in fields are joined.
    fn fields(&mut self, fields: &[Literal], before: &str) -> Result<(), Trouble> {
        let wrong = || {
            Trouble::header(
                "a field that is none",
                "fields such as ('x', '<f4') or ('rgb', 'u1', 3)",
            )
        };
        for field in fields {
            let Literal::List(parts) = field else { return Err(wrong()) };
            let (name, kind, shape) = match parts.as_slice() {
                [name, kind] => (name, kind, Vec::new()),
                [name, kind, shape] => (name, kind, lengths(shape).ok_or_else(wrong)?),
                _ => return Err(wrong()),
            };
            // A title may stand before the name.
            let name = match name {
                Literal::List(names) => names.last().ok_or_else(wrong)?,
                name => name,
            };
            let Literal::Text(name) = name else { return Err(wrong()) };
            let name = if before.is_empty() { name.clone() } else { format!("{before}_{name}") };
            let count = shape.iter().try_fold(1u64, |all, &length| all.checked_mul(length));
            let count = count.and_then(|count| usize::try_from(count).ok());
            let count = count.filter(|&count| count <= MAX_RECORD).ok_or_else(too_large)?;
            match kind {
                Literal::Text(kind) => {
                    let (coding, big, size) = number_type(kind)?;
                    self.has_objects |= is_object(kind);
                    self.push(&name, coding, big, size, count)?;
                }
                Literal::List(inner) => {
                    for repeat in 0..count {
                        let name =
                            if count == 1 { name.clone() } else { format!("{name}_{repeat}") };
                        self.fields(inner, &name)?;
                    }
                }
                _ => return Err(wrong()),
            }
        }
        Ok(())
    }

    /// Adds `count` elements of `size` bytes, under the names that stand for them.
    fn push(
        &mut self,
        name: &str,
        coding: Option<Coding>,
        big: bool,
        size: usize,
        count: usize,
    ) -> Result<(), Trouble> {
        let end = size.checked_mul(count).and_then(|bytes| self.size.checked_add(bytes));
        let end = end.filter(|&end| end <= MAX_RECORD).ok_or_else(too_large)?;
        if let Some(coding) = coding.filter(|_| self.numbers.len() + count <= MAX_COLUMNS) {
            for (i, name) in spread(name, count).into_iter().enumerate() {
                let place = Place { offset: self.size + i * size, coding, big };
                self.numbers.push((name, place));
            }
        }
        self.size = end;
        Ok(())
    }
}

fn too_large() -> Trouble {
    Trouble::header(format!("an element of more than {MAX_RECORD} bytes"), "a smaller one")
}

/// Whether a type is that of Python's objects.
fn is_object(name: &str) -> bool {
    name.trim_start_matches(['<', '=', '|', '>']).starts_with('O')
}

/// How a type's numbers are stored, whether their bytes are in big-endian order, and its size in
/// bytes. Text, dates, complex numbers and the like are no numbers.
fn number_type(name: &str) -> Result<(Option<Coding>, bool, usize), Trouble> {
    let wrong = || {
        let short: String = name.chars().take(20).collect();
        let expected = "a type of numbers such as '<f4', '>f8' or '|u1'";
        Trouble::header(format!("the type '{}'", short.escape_debug()), expected)
    };
    let (big, rest) = match name.strip_prefix(['<', '=', '|']) {
        Some(rest) => (false, rest),
        None => name.strip_prefix('>').map_or((false, name), |rest| (true, rest)),
    };
    let mut chars = rest.chars();
    let letter = chars.next().ok_or_else(wrong)?;
    let rest = chars.as_str();
    // Dates have a unit: M8[ns].
    let digits = rest.split('[').next().unwrap_or(rest);
    let count: usize = if digits.is_empty() { 1 } else { digits.parse().map_err(|_| wrong())? };
    let number = |kind| Some(Coding::Number(kind));
    let coding = match (letter, count) {
        ('b' | 'u', 1) => number(Type::U8),
        ('i', 1) => number(Type::I8),
        ('i', 2) => number(Type::I16),
        ('u', 2) => number(Type::U16),
        ('i', 4) => number(Type::I32),
        ('u', 4) => number(Type::U32),
        ('i', 8) => number(Type::I64),
        ('u', 8) => number(Type::U64),
        ('f', 2) => Some(Coding::Half),
        ('f', 4) => number(Type::F32),
        ('f', 8) => number(Type::F64),
        ('?', _) => number(Type::U8),
        ('f' | 'c' | 'S' | 'a' | 'V' | 'M' | 'm' | 'U' | 'O', _) => None,
        _ => return Err(wrong()),
    };
    let bytes = if letter == 'U' { count.checked_mul(4) } else { Some(count) };
    Ok((coding, big, bytes.ok_or_else(too_large)?))
}
