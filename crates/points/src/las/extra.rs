//! Extra bytes: numbers beyond those of a point format, which variable length records describe.
//!
//! One record should describe all of them, but programs that add a number to a file add a record of
//! their own, plain or extended.

use crate::field::{Field, Type};

/// Of the record with the descriptions.
pub(super) const RECORD_ID: u16 = 4;
/// Bytes of a description.
const DESCRIPTION: usize = 192;
/// Bytes of a record that are read.
pub(super) const MAX_BYTES: u64 = 1 << 20;
/// Records that are read.
pub(super) const MAX_RECORDS: usize = 16;

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

/// Bytes of a point that these numbers take.
pub(super) fn bytes_of(extra: &[Extra]) -> usize {
    extra.iter().map(|extra| extra.stored.size()).sum()
}

/// The extra numbers that several records describe, one record after the other. Where that is more
/// than a point has, and the last record that does so describes all by itself, a program has
/// written the description anew and left the old one in place.
pub(super) fn of_records(records: &[Vec<u8>], first: usize, end: usize) -> Vec<Extra> {
    let bytes = |record: &Vec<u8>| record.chunks_exact(DESCRIPTION).map(size_of).sum::<usize>();
    let extra = end - first;
    let replaces = |record: &&Vec<u8>| bytes(record) == extra;
    if records.iter().map(bytes).sum::<usize>() > extra
        && let Some(last) = records.iter().rev().find(replaces)
    {
        return fields(last, first, end);
    }
    // A record cut off within a description says nothing there.
    let whole = |record: &Vec<u8>| record[..record.len() / DESCRIPTION * DESCRIPTION].to_vec();
    fields(&records.iter().flat_map(whole).collect::<Vec<u8>>(), first, end)
}

/// Bytes of a point that a description is about.
fn size_of(description: &[u8]) -> usize {
    match usize::from(description[2]) {
        0 => description[3].into(),
        kind @ 1..=30 => TYPES[(kind - 1) % 10].size() * ((kind - 1) / 10 + 1),
        _ => 0,
    }
}

/// The extra numbers that are described and lie within a record, whose own bytes end at `first` and
/// which ends at `end`.
fn fields(descriptions: &[u8], first: usize, end: usize) -> Vec<Extra> {
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
