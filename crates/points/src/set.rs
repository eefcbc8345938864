//! A point set as a file holds it.

use crate::field::Type;
use crate::names;
use crate::sensor::Sensor;
use crate::units::Units;
use crate::upright::Upwards;
use std::collections::TryReserveError;

/// Positions and attributes of one point file, in the file's own coordinates.
///
/// All lists are of one length, at most `u32::MAX`: one entry for each point kept, in the order of
/// the file. What [`read`](crate::read) returns has at least one point. Every position is finite;
/// colours, normals and attributes may hold anything.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointSet {
    /// Positions, each coordinate exactly as the file's number type holds it.
    pub positions: Vec<[f64; 3]>,
    /// Place in the file of each point, from 0, counting dropped ones.
    pub file_index: Vec<u32>,
    /// Linear RGB, 1 at full intensity, NaN where the file has NaN. See [`ColorEncoding`] for how the
    /// file's values became it.
    pub colors: Option<Vec<[f32; 3]>>,
    /// How the file stores colours; `None` where it has none.
    pub color_encoding: Option<ColorEncoding>,
    /// Normals as the file has them: of any length, pointing either way.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Every other number of a point that was asked for, in the order of the file.
    pub attributes: Vec<Attribute>,
    /// Names of the attributes that the file has and nobody asked for.
    pub left_out: Vec<String>,
    /// How many points were dropped for a coordinate that is infinite or not a number.
    pub non_finite: u64,
    /// How many points were dropped because the file itself calls them invalid.
    pub invalid: u64,
    /// How many points with a usable position the filter left out.
    pub filtered_out: u64,
    /// The file format in words, such as `PLY 1.0, binary little-endian`.
    pub format: String,
    /// Which way is up, and why, in a few words that follow "z is up,"; `None` where nothing says that it
    /// is not +y.
    pub up: Option<(Upwards, &'static str)>,
    /// What the reader assumed where the file leaves it open, and what it left out, one sentence each,
    /// without the file's name: `taken for x y z red green blue, since …; --columns says otherwise`.
    pub notes: Vec<String>,
    /// What x and y are. Positions are the file's numbers either way.
    pub units: Units,
    /// Whether the file stores positions in floats of 32 bits.
    pub single_positions: bool,
    /// Where the scans of the file were taken from, as far as it says so, in the order of their points.
    pub sensors: Vec<Sensor>,
    /// The edge of the cubes over which points are means, in the units of the file, where nobody gave one.
    pub voxel: Option<f64>,
}

/// A number that every point has.
#[derive(Debug, Clone, PartialEq)]
pub struct Attribute {
    /// Its name in the file.
    pub name: String,
    /// One value a point.
    pub values: Values,
}

/// Values in the type that the file stores them in; integers of 64 bits become floats.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Values {
    I8(Vec<i8>),
    U8(Vec<u8>),
    I16(Vec<i16>),
    U16(Vec<u16>),
    I32(Vec<i32>),
    U32(Vec<u32>),
    F32(Vec<f32>),
    F64(Vec<f64>),
}

/// Does the same to the list of values of any type.
macro_rules! each_type {
    ($values:expr, $list:ident => $result:expr) => {
        match $values {
            Values::I8($list) => $result,
            Values::U8($list) => $result,
            Values::I16($list) => $result,
            Values::U16($list) => $result,
            Values::I32($list) => $result,
            Values::U32($list) => $result,
            Values::F32($list) => $result,
            Values::F64($list) => $result,
        }
    };
}

pub(crate) use each_type;

/// How a file stores colours: always in sRGB, and by which number at full intensity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorEncoding {
    /// Whole numbers, 255 at full intensity. Values beyond 0..=255 are clamped.
    Srgb8,
    /// Whole numbers, 65535 at full intensity.
    Srgb16,
    /// Bytes in the upper halves of 16 bits, 0xff00 at full intensity.
    Srgb16High,
    /// Floats, 1 at full intensity.
    Fraction,
    /// Floats, 255 at full intensity.
    Fraction255,
    /// Floats, 65535 at full intensity.
    Fraction65535,
}

impl PointSet {
    /// Number of points in the file.
    pub fn in_file(&self) -> u64 {
        self.positions.len() as u64 + self.non_finite + self.invalid + self.filtered_out
    }

    /// Number of points that were dropped as unusable.
    pub fn dropped(&self) -> u64 {
        self.non_finite + self.invalid
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The attribute of this name, if the points have it.
    pub fn attribute(&self, name: &str) -> Option<&Values> {
        self.attributes.iter().find(|attribute| attribute.name == name).map(|found| &found.values)
    }

    /// The attribute that a name in a scene means: the one of this name, else one in other letter
    /// case or as another program names it (docs/point-files.md, "Names").
    pub fn attribute_meant(&self, name: &str) -> Option<&Values> {
        let names = self.attributes.iter().map(|attribute| attribute.name.as_str());
        names::find(names, name).map(|place| &self.attributes[place].values)
    }

    /// The points that are to be kept, by their place in this set.
    #[must_use]
    pub fn filtered(&self, keep: impl Fn(usize) -> bool) -> Self {
        let keep: &dyn Fn(usize) -> bool = &keep;
        let attributes = self.attributes.iter().map(|attribute| Attribute {
            name: attribute.name.clone(),
            values: attribute.values.kept(keep),
        });
        Self {
            positions: kept(&self.positions, keep),
            file_index: kept(&self.file_index, keep),
            colors: self.colors.as_ref().map(|colors| kept(colors, keep)),
            color_encoding: self.color_encoding,
            normals: self.normals.as_ref().map(|normals| kept(normals, keep)),
            attributes: attributes.collect(),
            left_out: self.left_out.clone(),
            non_finite: self.non_finite,
            invalid: self.invalid,
            filtered_out: self.filtered_out,
            format: self.format.clone(),
            up: self.up,
            notes: self.notes.clone(),
            units: self.units.clone(),
            single_positions: self.single_positions,
            sensors: self.sensors.clone(),
            voxel: self.voxel,
        }
    }

    /// Where the sensor stood that measured the point in this place of the set, in the coordinates of the
    /// positions; `None` where the file does not say so. The surface that it saw faces it. Of a mean of
    /// several points ([`voxel_means`](crate::voxel_means)), it is that of the first.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn sensor_of(&self, place: usize) -> Option<[f64; 3]> {
        let index = self.file_index[place];
        let after = self.sensors.partition_point(|sensor| sensor.points.end <= index);
        let sensor = self.sensors.get(after)?;
        sensor.points.contains(&index).then_some(sensor.position)
    }

    /// Smallest and largest coordinate along each axis; `None` without points.
    pub fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        let (&first, rest) = self.positions.split_first()?;
        Some(rest.iter().fold((first, first), |(min, max), p| {
            let min = [min[0].min(p[0]), min[1].min(p[1]), min[2].min(p[2])];
            let max = [max[0].max(p[0]), max[1].max(p[1]), max[2].max(p[2])];
            (min, max)
        }))
    }
}

fn kept<T: Copy>(values: &[T], keep: &dyn Fn(usize) -> bool) -> Vec<T> {
    (0..).zip(values).filter_map(|(i, &value)| keep(i).then_some(value)).collect()
}

impl Values {
    /// No values yet, of a file's type.
    pub(crate) fn of(kind: Type) -> Self {
        match kind {
            Type::I8 => Self::I8(Vec::new()),
            Type::U8 => Self::U8(Vec::new()),
            Type::I16 => Self::I16(Vec::new()),
            Type::U16 => Self::U16(Vec::new()),
            Type::I32 => Self::I32(Vec::new()),
            Type::U32 => Self::U32(Vec::new()),
            Type::F32 => Self::F32(Vec::new()),
            Type::I64 | Type::U64 | Type::F64 => Self::F64(Vec::new()),
        }
    }

    /// Adds a value that the type holds; else the nearest that it does.
    pub(crate) fn push(&mut self, value: f64) {
        each_type!(self, list => list.push(value as _));
    }

    pub(crate) fn try_reserve_exact(&mut self, count: usize) -> Result<(), TryReserveError> {
        each_type!(self, list => list.try_reserve_exact(count))
    }

    fn kept(&self, keep: &dyn Fn(usize) -> bool) -> Self {
        match self {
            Self::I8(list) => Self::I8(kept(list, keep)),
            Self::U8(list) => Self::U8(kept(list, keep)),
            Self::I16(list) => Self::I16(kept(list, keep)),
            Self::U16(list) => Self::U16(kept(list, keep)),
            Self::I32(list) => Self::I32(kept(list, keep)),
            Self::U32(list) => Self::U32(kept(list, keep)),
            Self::F32(list) => Self::F32(kept(list, keep)),
            Self::F64(list) => Self::F64(kept(list, keep)),
        }
    }

    /// Number of values, one a point.
    pub fn len(&self) -> usize {
        each_type!(self, list => list.len())
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of the point at `index`.
    ///
    /// # Panics
    /// If there is no such point.
    #[allow(clippy::useless_conversion, reason = "one arm of several is of f64")]
    pub fn get(&self, index: usize) -> f64 {
        each_type!(self, list => f64::from(list[index]))
    }

    /// All values, in the order of the points.
    pub fn iter(&self) -> impl Iterator<Item = f64> + Clone + '_ {
        (0..self.len()).map(|index| self.get(index))
    }
}

impl ColorEncoding {
    /// The stored value at full intensity, which becomes 1.
    pub(crate) fn full(self) -> f64 {
        match self {
            Self::Fraction => 1.0,
            Self::Srgb8 | Self::Fraction255 => 255.0,
            Self::Srgb16High => 65280.0,
            Self::Srgb16 | Self::Fraction65535 => 65535.0,
        }
    }

    /// What stored values are multiples of, as far as 32 bits of linear light tell.
    fn steps_of_one(self) -> f64 {
        match self {
            Self::Srgb8 | Self::Srgb16 => 1.0,
            Self::Srgb16High => 1.0 / 256.0,
            Self::Fraction => 1e7,
            Self::Fraction255 => 1e4,
            Self::Fraction65535 => 1e2,
        }
    }

    /// A stored value as a linear one.
    pub fn decode(self, stored: f64) -> f32 {
        linear_from_srgb((stored / self.full()).clamp(0.0, 1.0)) as f32
    }

    /// The stored value that [`decode`](Self::decode) makes `linear`: exactly, for integers within
    /// their range, and to seven digits for floats.
    pub fn encode(self, linear: f32) -> f64 {
        self.rounded(srgb_from_linear(f64::from(linear)) * self.full())
    }

    /// A stored value without the digits that no 32 bits hold.
    pub(crate) fn rounded(self, stored: f64) -> f64 {
        (stored * self.steps_of_one()).round() / self.steps_of_one()
    }
}

/// The sRGB curve of IEC 61966-2-1, from the stored 0..=1 to linear light.
fn linear_from_srgb(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// The inverse of [`linear_from_srgb`].
fn srgb_from_linear(x: f64) -> f64 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_meets_its_closed_forms() {
        let decode = |stored| ColorEncoding::Srgb8.decode(stored);
        assert_eq!(decode(0.0), 0.0);
        assert_eq!(decode(255.0), 1.0);
        // 10 / 255 = 0.0392 is the last byte of the linear part.
        assert_eq!(decode(10.0), (10.0 / 255.0 / 12.92) as f32);
        assert_eq!(decode(11.0), ((11.0f64 / 255.0 + 0.055) / 1.055).powf(2.4) as f32);
        // 0.73536 is the stored value of 0.5: see the curve's inverse.
        assert!((ColorEncoding::Srgb16.decode(0.735_357 * 65535.0) - 0.5).abs() < 1e-5);
        assert_eq!(decode(300.0), 1.0);
        assert_eq!(decode(-1.0), 0.0);
    }

    #[test]
    fn every_stored_integer_comes_back() {
        for (encoding, full, step) in [
            (ColorEncoding::Srgb8, 255, 1),
            (ColorEncoding::Srgb16, 65535, 1),
            (ColorEncoding::Srgb16High, 65280, 256),
            (ColorEncoding::Fraction255, 255, 1),
            (ColorEncoding::Fraction65535, 65535, 1),
        ] {
            for stored in (0..=full).step_by(step).map(f64::from) {
                assert_eq!(encoding.encode(encoding.decode(stored)), stored);
            }
        }
        for stored in (0..=10_000).map(|i| f64::from(i) / 1e4) {
            assert_eq!(
                ColorEncoding::Fraction.encode(ColorEncoding::Fraction.decode(stored)),
                stored
            );
        }
    }
}
