//! Extra bytes: numbers beyond those of a point format, which a variable length record describes.

use crate::field::{Field, Type};

/// Of the record with the descriptions.
pub(super) const RECORD_ID: u16 = 4;
/// Bytes of a description.
const DESCRIPTION: usize = 192;
/// Bytes of all descriptions that are read.
pub(super) const MAX_BYTES: u64 = 1 << 20;

/// Bits of a description's options.
const HAS_SCALE: u8 = 1 << 3;
const HAS_OFFSET: u8 = 1 << 4;

const TYPES: [Type; 10] = [
    Type::U8,
    Type::I8,
    Type::U16,
    Type::I16,
    Type::U32,
    Type::I32,
    Type::U64,
    Type::I64,
    Type::F32,
    Type::F64,
];

/// An extra number.
pub(super) struct Extra {
    pub(super) field: Field,
    stored: Type,
    place: usize,
    /// Factor and summand, where there is either.
    scaled: Option<[f64; 2]>,
}

impl Extra {
    pub(super) fn value(&self, record: &[u8]) -> f64 {
        let stored = self.stored.read::<false>(&record[self.place..]);
        self.scaled.map_or(stored, |[factor, summand]| stored * factor + summand)
    }
}

/// The extra numbers that are described and lie within a record, whose own bytes end at `first` and
/// which ends at `end`.
pub(super) fn fields(descriptions: &[u8], first: usize, end: usize) -> Vec<Extra> {
    let mut fields = Vec::new();
    let mut place = first;
    for description in descriptions.chunks_exact(DESCRIPTION) {
        let (kind, options) = (usize::from(description[2]), description[3]);
        // Single numbers are 1 to 10; 11 to 30 were arrays of two and three.
        let (kind, count) = match kind {
            // No number: its options are how many bytes it has.
            0 => {
                place += usize::from(options);
                continue;
            }
            1..=30 => (TYPES[(kind - 1) % 10], (kind - 1) / 10 + 1),
            _ => break,
        };
        let name = description[4..36].split(|&byte| byte == 0).next().unwrap_or_default();
        let name = String::from_utf8_lossy(name).trim().to_owned();
        let name = if name.is_empty() { format!("extra_{}", fields.len()) } else { name };
        for index in 0..count {
            if place + kind.size() > end {
                return fields;
            }
            let number = |at: usize| Type::F64.read::<false>(&description[at + 8 * index..]);
            let factor = if options & HAS_SCALE != 0 { number(112) } else { 1.0 };
            let summand = if options & HAS_OFFSET != 0 { number(136) } else { 0.0 };
            let scaled = (options & (HAS_SCALE | HAS_OFFSET) != 0).then_some([factor, summand]);
            let name = if count == 1 { name.clone() } else { format!("{name}_{index}") };
            let held = if scaled.is_some() { Type::F64 } else { kind };
            fields.push(Extra { field: Field::new(name, held), stored: kind, place, scaled });
            place += kind.size();
        }
    }
    fields
}
