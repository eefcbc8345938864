//! The colour of a point, however its file stores it.
//!
//! Colours of vertices are sRGB in every format. How large the number at full intensity is, the
//! values of the whole file decide, those of points that a filter leaves out included, so that a
//! point has one colour whatever comes with it. Until the file ends, the stored numbers are held.

use crate::field::{Field, Type};
use crate::set::ColorEncoding;

/// Names that exporters give to the three numbers of a colour, in any letter case.
const COLOR: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["r", "g", "b"], ["diffuse_red", "diffuse_green", "diffuse_blue"]];
/// Names of a colour in one number, 0xAARRGGBB, of 32 bits.
const PACKED: [&str; 2] = ["rgb", "rgba"];

/// Fractions beyond this are no rounding of 1.
const ONE: f64 = 1.001;
/// Fractions of 1 that go beyond it stay below this; averages of bytes do not, but for a picture that
/// is black.
const MOST_FRACTION: f64 = 10.0;
/// Floats, and integers for which bytes would do, are bytes up to this.
const MOST_BYTE: f64 = 256.0;

/// Where the colours of rows are, and what was seen of them.
pub(crate) struct Color {
    place: Place,
    kind: Type,
    seen: Seen,
}

enum Place {
    Three([usize; 3]),
    /// One number, 0xAARRGGBB.
    Packed(usize),
}

/// What the colours of all points of a file have in common.
#[derive(Default)]
struct Seen {
    greatest: f64,
    /// Bits that are set in any whole number below 256 times a power of two.
    low_bits: u32,
    /// Whether a number has a fraction.
    fraction: bool,
    /// Numbers between 0 and 1, over 1, and over a byte.
    inside: u64,
    over: u64,
    beyond: u64,
    /// A number that holds no packed colour.
    not_packed: Option<f64>,
}

/// What colours turned out to be.
#[derive(Default)]
pub(crate) struct Verdict {
    /// `None` where nobody wrote any.
    pub(crate) encoding: Option<ColorEncoding>,
    /// What a user may doubt in it.
    pub(crate) note: Option<String>,
}

impl Color {
    /// The colour among the fields: three numbers of one type, or a packed one.
    pub(crate) fn find(fields: &[Field]) -> Option<Self> {
        let place = |name: &str| fields.iter().position(|f| f.name.eq_ignore_ascii_case(name));
        let exact = |name: &str| fields.iter().position(|f| f.name == name).or_else(|| place(name));
        let three = COLOR.into_iter().find_map(|[r, g, b]| {
            let places = [exact(r)?, exact(g)?, exact(b)?];
            let [kind, others @ ..] = places.map(|place| fields[place].kind);
            let alike = others.iter().all(|&other| other == kind);
            alike.then_some((Place::Three(places), kind))
        });
        let packed = || {
            let place = PACKED.into_iter().find_map(exact)?;
            let kind = fields[place].kind;
            (kind.size() >= 4).then_some((Place::Packed(place), kind))
        };
        let (place, kind) = three.or_else(packed)?;
        Some(Self { place, kind, seen: Seen::default() })
    }

    /// Whether the field at this place belongs to the colour.
    pub(crate) fn contains(&self, place: usize) -> bool {
        match self.place {
            Place::Three(places) => places.contains(&place),
            Place::Packed(packed) => packed == place,
        }
    }

    /// The numbers that a row stores.
    pub(crate) fn stored(&self, row: &[f64]) -> [f64; 3] {
        match self.place {
            // Of bytes with a sign, the bits count.
            Place::Three(places) if self.kind == Type::I8 => {
                places.map(|place| f64::from(row[place] as i8 as u8))
            }
            Place::Three(places) => places.map(|place| row[place]),
            Place::Packed(place) => match bits_of(row[place]) {
                Some(bits) => [16, 8, 0].map(|shift| f64::from(bits >> shift & 0xff)),
                None => [f64::NAN; 3],
            },
        }
    }

    /// Notes what a point of the file holds, whether it is kept or not.
    pub(crate) fn see(&mut self, row: &[f64]) {
        let stored = self.stored(row);
        if let Place::Packed(place) = self.place
            && stored[0].is_nan()
            && !row[place].is_nan()
        {
            self.seen.not_packed.get_or_insert(row[place]);
        }
        for value in stored {
            self.seen.take(value);
        }
    }

    /// What the colours are, once all points were seen.
    pub(crate) fn verdict(&self) -> Verdict {
        let seen = &self.seen;
        let none = |note: Option<String>| Verdict { encoding: None, note };
        if let Some(found) = seen.not_packed {
            return none(Some(format!(
                "the numbers called rgb hold no colours (found {found}, expected 0xRRGGBB in 32 bits), \
                 so the points count as without"
            )));
        }
        if seen.greatest <= 0.0 {
            // Formats that always have the fields write zeros of 16 bits.
            let note = (self.kind != Type::U16)
                .then(|| "no colour is above 0, so the points count as without colours".to_owned());
            return none(note);
        }
        let plain = |encoding| Verdict { encoding: Some(encoding), note: None };
        if matches!(self.place, Place::Packed(_)) || matches!(self.kind, Type::U8 | Type::I8) {
            return plain(ColorEncoding::Srgb8);
        }
        let floats = self.kind.is_float() || seen.fraction;
        if floats && seen.over == 0 {
            return plain(ColorEncoding::Fraction);
        }
        let few = seen.inside > 100 * seen.over;
        if floats && (few || seen.fraction && seen.greatest < MOST_FRACTION) {
            let note = format!(
                "colours are taken for fractions of 1, although {} of their numbers are above, up to \
                 {}; those count as 1",
                seen.over, seen.greatest
            );
            return Verdict { encoding: Some(ColorEncoding::Fraction), note: Some(note) };
        }
        let bytes = match floats {
            // One number that is no colour makes no picture black.
            true => seen.beyond == 0 || 1000 * seen.beyond < seen.over,
            false if self.kind.size() == 2 => seen.greatest <= 255.0,
            false => seen.greatest <= MOST_BYTE,
        };
        match (bytes, seen.fraction) {
            (true, false) => plain(ColorEncoding::Srgb8),
            (true, true) => plain(ColorEncoding::Fraction255),
            (false, _) if seen.low_bits == 0 => plain(ColorEncoding::Srgb16High),
            (false, false) => plain(ColorEncoding::Srgb16),
            (false, true) => plain(ColorEncoding::Fraction65535),
        }
    }
}

impl Seen {
    fn take(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.greatest = self.greatest.max(value);
        if value.fract() == 0.0 {
            self.low_bits |= value as u32 & 0xff;
        } else {
            self.fraction = true;
            self.low_bits |= 1;
            self.inside += u64::from(value > 0.0 && value < 1.0);
        }
        self.over += u64::from(value > ONE);
        self.beyond += u64::from(value > MOST_BYTE);
    }
}

/// Makes stored numbers linear. What is no number stays none.
pub(crate) fn decode(encoding: ColorEncoding, colors: &mut [[f32; 3]]) {
    let entries = match encoding {
        ColorEncoding::Srgb8 => 1 << 8,
        ColorEncoding::Srgb16 | ColorEncoding::Srgb16High => 1 << 16,
        _ => 0,
    };
    let table: Vec<f32> = (0..entries).map(|stored| encoding.decode(f64::from(stored))).collect();
    for value in colors.iter_mut().flatten() {
        *value = match table.last() {
            // Negative numbers become 0 in the cast.
            Some(&brightest) if !value.is_nan() => {
                *table.get(*value as usize).unwrap_or(&brightest)
            }
            _ => encoding.decode(f64::from(*value)),
        };
    }
}

/// All that stored numbers may turn out to mean, for those who cannot hold them until that is known.
pub(crate) struct Meanings {
    /// An encoding, and the linear values of whole numbers from 0 on.
    list: Vec<(ColorEncoding, Vec<f32>)>,
    /// Of the last colour.
    linear: Vec<[f32; 3]>,
}

impl Meanings {
    /// Those that the verdict about this colour can be.
    pub(crate) fn of(color: &Color) -> Self {
        let is_byte = matches!(color.place, Place::Packed(_)) || color.kind.size() == 1;
        // One encoding for each number at full intensity, which is all that counts.
        let of_others = [
            (ColorEncoding::Fraction, 2),
            (ColorEncoding::Srgb16High, 1 << 16),
            (ColorEncoding::Srgb16, 1 << 16),
        ];
        let byte = std::iter::once((ColorEncoding::Srgb8, 1 << 8));
        let list = byte.chain(of_others.into_iter().filter(|_| !is_byte));
        let table = |encoding: ColorEncoding, entries: u32| {
            (encoding, (0..entries).map(|stored| encoding.decode(f64::from(stored))).collect())
        };
        Self { list: list.map(|(of, entries)| table(of, entries)).collect(), linear: Vec::new() }
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    /// Which of them an encoding is.
    pub(crate) fn place(&self, encoding: ColorEncoding) -> usize {
        self.list.iter().position(|(of, _)| of.full() == encoding.full()).unwrap_or(0)
    }

    /// The linear colour by each of them, as [`decode`] has it.
    pub(crate) fn linear(&mut self, stored: [f32; 3]) -> &[[f32; 3]] {
        let one = |(encoding, table): &(ColorEncoding, Vec<f32>)| {
            stored.map(|value| match table.get(value as usize) {
                Some(&linear) if value.fract() == 0.0 && value >= 0.0 => linear,
                _ => encoding.decode(f64::from(value)),
            })
        };
        self.linear.clear();
        self.linear.extend(self.list.iter().map(one));
        &self.linear
    }
}

/// Whether a field of this name holds a packed colour.
pub(crate) fn is_packed(name: &str) -> bool {
    PACKED.iter().any(|packed| packed.eq_ignore_ascii_case(name))
}

/// The type by which a field of a binary file is to be read: of floats that hold the bits of a
/// packed colour, the bits, since many of them are no numbers.
pub(crate) fn kind_in_binary(name: &str, kind: Type) -> Type {
    if kind == Type::F32 && is_packed(name) { Type::U32 } else { kind }
}

/// The 32 bits of a packed colour, from an integer or from a float that holds them; `None` where it
/// cannot be one.
pub(crate) fn bits_of(value: f64) -> Option<u32> {
    // Of a negative integer, the bits of its 32 count.
    if value.fract() == 0.0 && value.abs() <= f64::from(u32::MAX) {
        return Some(value as i64 as u32);
    }
    let bits = (value as f32).to_bits();
    // An alpha of 0 or 255: others make numbers of ordinary size, which nobody writes.
    matches!(bits >> 24, 0 | 0xff).then_some(bits)
}

#[cfg(test)]
mod tests;
