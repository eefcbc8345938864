//! A picture as planes by name, wherever it comes from.

use film::{ExrFile, ExrHeader, FilmError, Raster, Samples, linear_from_srgb};
use std::collections::BTreeMap;
use std::path::Path;

/// A picture as planes by name.
///
/// A channel keeps its name where only one part of an EXR has it: so the same channels are the same picture,
/// in one part or in several. A name that several parts have becomes `part.channel`, unless it begins with its
/// part's already. PNG, JPEG and Radiance HDR have `R`, `G`, `B`, and `A` where the file has one.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Width and height of the display window, which is the whole of a file that has none.
    pub size: [u32; 2],
    /// Channel name to values.
    pub channels: BTreeMap<String, Plane>,
    /// Bits of each value where they are integers in sRGB: colours are within 0..=1, and not
    /// multiplied by alpha. `None` where colours are linear.
    pub srgb_bits: Option<u32>,
    /// The headers of an EXR's parts; empty for other files.
    pub headers: Vec<ExrHeader>,
}

/// The values of one channel.
#[derive(Debug, Clone)]
pub struct Plane {
    /// Where the values lie: the data window, relative to the display window's upper left corner.
    pub window: Rect,
    /// Row by row, the top row first.
    pub samples: Samples,
}

/// A rectangle of pixels; x to the right, y downwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    /// Column of the left edge.
    pub x: i64,
    /// Row of the upper edge.
    pub y: i64,
    /// Columns.
    pub width: i64,
    /// Rows.
    pub height: i64,
}

impl Rect {
    /// What two rectangles have in common, if anything.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let (x, y) = (self.x.max(other.x), self.y.max(other.y));
        let width = (self.x + self.width).min(other.x + other.width) - x;
        let height = (self.y + self.height).min(other.y + other.height) - y;
        (width > 0 && height > 0).then_some(Self { x, y, width, height })
    }

    /// How many pixels it has.
    #[must_use]
    pub fn pixels(&self) -> usize {
        usize::try_from(self.width * self.height).unwrap_or(0)
    }

    /// Column and row of each pixel, row by row.
    pub fn places(self) -> impl Iterator<Item = [i64; 2]> {
        let columns = move |y| (self.x..self.x + self.width).map(move |x| [x, y]);
        (self.y..self.y + self.height).flat_map(columns)
    }
}

impl Plane {
    /// The values within `region`, row by row, in a type that holds all of them exactly.
    ///
    /// # Panics
    /// If the region leaves the plane's window.
    pub fn values(&self, region: Rect) -> impl Iterator<Item = f64> {
        assert!(
            self.window.intersection(&region) == Some(region),
            "compare: the region {region:?} leaves the window {:?}",
            self.window
        );
        let start =
            move |row: i64| (row - self.window.y) * self.window.width + region.x - self.window.x;
        (region.y..region.y + region.height).flat_map(move |row| {
            let first = start(row) as usize;
            (first..first + region.width as usize).map(|at| self.samples.at(at))
        })
    }
}

impl Plane {
    /// Where the value of a pixel is.
    pub(crate) fn index(&self, x: i64, y: i64) -> usize {
        ((y - self.window.y) * self.window.width + x - self.window.x) as usize
    }

    /// The value of a pixel within the window.
    pub(crate) fn at(&self, x: i64, y: i64) -> f64 {
        self.samples.at(self.index(x, y))
    }

    /// A row of a region that both planes have. Reports whether both are the same, bit for bit: then `b` is left as
    /// it was.
    pub(crate) fn row(
        planes: [&Self; 2],
        region: Rect,
        y: i64,
        a: &mut Vec<f64>,
        b: &mut Vec<f64>,
    ) -> bool {
        let count = region.width as usize;
        let [first, second] = planes.map(|plane| plane.index(region.x, y));
        a.resize(count, 0.0);
        planes[0].samples.copy_to(first, a);
        let same = std::ptr::eq(planes[0], planes[1])
            || planes[0].samples.same_bits(first, &planes[1].samples, second, count);
        if !same {
            b.resize(count, 0.0);
            planes[1].samples.copy_to(second, b);
        }
        same
    }
}

impl Picture {
    /// Reads an EXR, PNG, JPEG or Radiance HDR file, told apart by their first bytes.
    ///
    /// # Errors
    /// A file that cannot be read, is none of these, or is damaged.
    pub fn read(path: &Path) -> Result<Self, FilmError> {
        if film::is_exr(path)? {
            Ok(Self::from_exr(film::read_exr_file(path)?))
        } else {
            Ok(Self::from_raster(film::read_raster(path)?))
        }
    }

    /// Reads two at a time; where both fail, the first failure counts.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_both([a, b]: [&Path; 2]) -> Result<[Self; 2], FilmError> {
        let (a, b) = rayon::join(|| Self::read(a), || Self::read(b));
        Ok([a?, b?])
    }

    /// The channels of all parts.
    #[must_use]
    pub fn from_exr(file: ExrFile) -> Self {
        let mut parts_with: BTreeMap<String, usize> = BTreeMap::new();
        for name in file.parts.iter().flat_map(|part| part.channels.keys()) {
            *parts_with.entry(name.clone()).or_default() += 1;
        }
        let mut picture = Self {
            size: file.display_size,
            channels: BTreeMap::new(),
            srgb_bits: None,
            headers: Vec::new(),
        };
        for (index, part) in file.parts.into_iter().enumerate() {
            let offset = |axis: usize| {
                i64::from(part.data_origin[axis]) - i64::from(file.display_origin[axis])
            };
            let [width, height] = part.data_size.map(i64::from);
            let window = Rect { x: offset(0), y: offset(1), width, height };
            let prefix = format!("{}.", part.name.unwrap_or_else(|| index.to_string()));
            for (name, samples) in part.channels {
                let name = match parts_with[&name] > 1 && !name.starts_with(&prefix) {
                    true => format!("{prefix}{name}"),
                    false => name,
                };
                picture.channels.insert(name, Plane { window, samples });
            }
            picture.headers.push(part.header);
        }
        picture
    }

    /// The channels `R`, `G`, `B`, and `A` where there is one.
    #[must_use]
    pub fn from_raster(raster: Raster) -> Self {
        let [width, height] = raster.size.map(i64::from);
        let window = Rect { x: 0, y: 0, width, height };
        let names = ["R", "G", "B", "A"].into_iter().take(if raster.alpha { 4 } else { 3 });
        let plane = |channel: usize| {
            let values = raster.pixels.iter().map(|pixel| pixel[channel]).collect();
            Plane { window, samples: Samples::from_f32(values) }
        };
        Self {
            size: raster.size,
            channels: names.zip(0..).map(|(name, i)| (name.to_owned(), plane(i))).collect(),
            srgb_bits: (!raster.linear).then_some(raster.bits),
            headers: Vec::new(),
        }
    }

    /// The same picture with linear colours, multiplied by alpha, as an EXR has them.
    #[must_use]
    pub fn into_linear(mut self) -> Self {
        if self.srgb_bits.take().is_none() {
            return self;
        }
        let alpha: Option<Vec<f64>> =
            self.channels.get("A").map(|plane| plane.samples.iter().collect());
        for name in ["R", "G", "B"] {
            let Some(plane) = self.channels.get_mut(name) else { continue };
            let linear = plane.samples.iter().enumerate().map(|(at, value)| {
                let alpha = alpha.as_ref().map_or(1.0, |alpha| alpha[at]);
                (linear_from_srgb(value) * alpha) as f32
            });
            plane.samples = Samples::from_f32(linear.collect());
        }
        self
    }
}
