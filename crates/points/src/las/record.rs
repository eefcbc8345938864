//! What the bytes of a point record mean.

use super::Header;
use super::extra::Extra;
use crate::field::{Field, Type};

/// Bytes of a record of this point format, 0 to 10, without extra bytes.
pub(super) fn length_of(format: u8) -> usize {
    [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67][usize::from(format)]
}

/// How records become rows.
pub(super) struct Layout {
    scale: [f64; 3],
    offset: [f64; 3],
    columns: Vec<Column>,
    extra: Vec<Extra>,
    fields: Vec<Field>,
}

/// One number of a record behind its position.
struct Column {
    place: usize,
    how: How,
}

#[derive(Clone, Copy)]
enum How {
    /// As it is.
    Plain(Type),
    /// Some bits of a byte: how far to the right they are to go, and how many.
    Bits(u32, u32),
    /// An angle in steps of 0.006 degrees.
    Angle,
    /// Synthetic, key point and withheld of a classification byte of formats 0 to 5.
    OldFlags,
}

impl Layout {
    pub(super) fn new(header: &Header, extra: Vec<Extra>) -> Self {
        let axis = |name: &str| Field::new(name, Type::F64);
        let mut fields = vec![axis("x"), axis("y"), axis("z")];
        let mut columns = Vec::new();
        let mut add = |name: &str, kind: Type, place: usize, how: How| {
            fields.push(Field::new(name, kind));
            columns.push(Column { place, how });
        };
        let format = header.format;
        add("intensity", Type::U16, 12, How::Plain(Type::U16));
        if format < 6 {
            add("return_number", Type::U8, 14, How::Bits(0, 3));
            add("number_of_returns", Type::U8, 14, How::Bits(3, 3));
            add("scan_direction", Type::U8, 14, How::Bits(6, 1));
            add("edge_of_flight_line", Type::U8, 14, How::Bits(7, 1));
            add("classification", Type::U8, 15, How::Bits(0, 5));
            add("flags", Type::U8, 15, How::OldFlags);
            add("scan_angle", Type::I8, 16, How::Plain(Type::I8));
            add("user_data", Type::U8, 17, How::Plain(Type::U8));
            add("point_source_id", Type::U16, 18, How::Plain(Type::U16));
        } else {
            add("return_number", Type::U8, 14, How::Bits(0, 4));
            add("number_of_returns", Type::U8, 14, How::Bits(4, 4));
            add("flags", Type::U8, 15, How::Bits(0, 4));
            add("scanner_channel", Type::U8, 15, How::Bits(4, 2));
            add("scan_direction", Type::U8, 15, How::Bits(6, 1));
            add("edge_of_flight_line", Type::U8, 15, How::Bits(7, 1));
            add("classification", Type::U8, 16, How::Plain(Type::U8));
            add("user_data", Type::U8, 17, How::Plain(Type::U8));
            add("scan_angle", Type::F32, 18, How::Angle);
            add("point_source_id", Type::U16, 20, How::Plain(Type::U16));
        }
        let gps = match format {
            1 | 3 | 4 | 5 => Some(20),
            6.. => Some(22),
            _ => None,
        };
        if let Some(place) = gps {
            add("gps_time", Type::F64, place, How::Plain(Type::F64));
        }
        let color = match format {
            2 => Some(20),
            3 | 5 => Some(28),
            7 | 8 | 10 => Some(30),
            _ => None,
        };
        if let Some(place) = color {
            for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
                add(name, Type::U16, place + 2 * channel, How::Plain(Type::U16));
            }
        }
        if matches!(format, 8 | 10) {
            add("nir", Type::U16, 36, How::Plain(Type::U16));
        }
        fields.extend(extra.iter().map(|extra| extra.field.clone()));
        Self { scale: header.scale, offset: header.offset, columns, extra, fields }
    }

    pub(super) fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// The row of a record.
    pub(super) fn values(&self, record: &[u8], row: &mut Vec<f64>) {
        row.clear();
        for axis in 0..3 {
            let stored = Type::I32.read::<false>(&record[4 * axis..]);
            row.push(stored * self.scale[axis] + self.offset[axis]);
        }
        for &Column { place, how } in &self.columns {
            let bits =
                |shift: u32, count: u32| u32::from(record[place]) >> shift & ((1 << count) - 1);
            row.push(match how {
                How::Plain(kind) => kind.read::<false>(&record[place..]),
                How::Bits(shift, count) => bits(shift, count).into(),
                How::Angle => 0.006 * Type::I16.read::<false>(&record[place..]),
                How::OldFlags => bits(5, 3).into(),
            });
        }
        row.extend(self.extra.iter().map(|extra| extra.value(record)));
    }
}
