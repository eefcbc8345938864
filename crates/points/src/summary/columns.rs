//! The numbers of points that go past block by block, once for their ranges, and where that is not
//! enough, once more for their histograms.
//!
//! Whole numbers of 8 and 16 bits are counted value by value, so that they need to go past only once.

use super::histogram::{Histogram, Range};
use crate::options::Wanted;
use crate::set::{ColorEncoding, PointSet, Values, each_type};

/// Memory for the counts of whole numbers. Beyond it, histograms are made by the second pass.
const COUNT_BYTES: usize = 1 << 25;

/// The numbers that each point has besides its position.
#[derive(Default)]
pub(super) struct Columns {
    normals: Option<[Column; 3]>,
    colors: Option<[Column; 3]>,
    attributes: Vec<Column>,
    count_bytes: usize,
    /// Known after the first pass.
    color_encoding: Option<ColorEncoding>,
}

/// Whether the colours of a block are the stored numbers, or linear as in sets that are held.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Colors {
    Stored,
    Linear,
}

/// One number of each point.
struct Column {
    name: String,
    /// Of those values that are numbers; NaN before there is one.
    range: [f64; 2],
    /// Of those that are finite, too.
    finite: [f64; 2],
    /// How often each whole number from the lowest on occurs, where that is counted.
    counts: Option<(i32, Vec<u64>)>,
    histogram: Histogram,
    /// Whether the second pass makes the histogram.
    goes_past_again: bool,
}

impl Columns {
    /// Takes the points of a block in the first pass.
    #[allow(clippy::useless_conversion, reason = "one arm of several is of f64")]
    pub(super) fn see(&mut self, block: &PointSet, colors: Colors) {
        if let Some(normals) = &block.normals {
            let columns = self.normals.get_or_insert_with(|| ["nx", "ny", "nz"].map(Column::new));
            for (axis, column) in columns.iter_mut().enumerate() {
                column.see(normals.iter().map(|normal| f64::from(normal[axis])));
            }
        }
        if let Some(list) = &block.colors {
            // As many as 16 bits have: where other numbers come, counting ends.
            let (bytes, stored) = (&mut self.count_bytes, stored(block, colors));
            let columns = self.colors.get_or_insert_with(|| {
                ["red", "green", "blue"].map(|name| Column::counting(name, 0, 1 << 16, bytes))
            });
            for (channel, column) in columns.iter_mut().enumerate() {
                column.see(list.iter().map(|color| stored(color[channel])));
            }
        }
        for (place, attribute) in block.attributes.iter().enumerate() {
            if place == self.attributes.len() {
                let (lowest, count) = match &attribute.values {
                    Values::U8(_) => (0, 1 << 8),
                    Values::I8(_) => (i8::MIN.into(), 1 << 8),
                    Values::U16(_) => (0, 1 << 16),
                    Values::I16(_) => (i16::MIN.into(), 1 << 16),
                    _ => (0, 0),
                };
                let bytes = &mut self.count_bytes;
                self.attributes.push(Column::counting(&attribute.name, lowest, count, bytes));
            }
            let column = &mut self.attributes[place];
            each_type!(&attribute.values, list => column.see(list.iter().map(|&v| f64::from(v))));
        }
    }

    /// Begins the second pass: what has to go past once more, if anything. `set` is what is known
    /// after the first.
    pub(super) fn second_pass(&mut self, set: &PointSet) -> Option<Wanted> {
        self.color_encoding = set.color_encoding;
        if set.color_encoding.is_none() {
            self.colors = None;
        }
        if set.normals.is_none() {
            self.normals = None;
        }
        let three = |columns: &mut Option<[Column; 3]>| {
            let columns = columns.iter_mut().flatten();
            columns.filter_map(|column| column.second_pass().then_some(())).count() > 0
        };
        let (normals, colors) = (three(&mut self.normals), three(&mut self.colors));
        let mut attributes = Vec::new();
        for column in &mut self.attributes {
            if column.second_pass() {
                attributes.push(column.name.clone());
            }
        }
        let any = normals || colors || !attributes.is_empty();
        any.then_some(Wanted::Some { colors, normals, attributes })
    }

    /// Forgets what went past in the second pass.
    pub(super) fn begin_again(&mut self) {
        let three = self.normals.iter_mut().flatten().chain(self.colors.iter_mut().flatten());
        for column in three.chain(&mut self.attributes).filter(|column| column.goes_past_again) {
            column.histogram = Histogram::over(column.histogram.low, column.histogram.high);
        }
    }

    /// Takes the points of a block in the second pass.
    #[allow(clippy::useless_conversion, reason = "one arm of several is of f64")]
    pub(super) fn count(&mut self, block: &PointSet, colors: Colors) {
        if let (Some(normals), Some(columns)) = (&block.normals, &mut self.normals) {
            for (axis, column) in columns.iter_mut().enumerate() {
                column.count(normals.iter().map(|normal| f64::from(normal[axis])));
            }
        }
        if let (Some(list), Some(columns)) = (&block.colors, &mut self.colors) {
            let stored = stored(block, colors);
            for (channel, column) in columns.iter_mut().enumerate() {
                column.count(list.iter().map(|color| stored(color[channel])));
            }
        }
        // What is not wanted is left out of the block, and the order is the same.
        let mut columns = self.attributes.iter_mut();
        for attribute in &block.attributes {
            if let Some(column) = columns.find(|column| column.name == attribute.name) {
                let values = &attribute.values;
                each_type!(values, list => column.count(list.iter().map(|&v| f64::from(v))));
            }
        }
    }

    /// Name, range and histogram of each: of normals, colours, and attributes.
    pub(super) fn finish(self) -> Vec<(String, Range, Histogram)> {
        let mut colors = self.colors;
        if let Some(encoding) = self.color_encoding {
            let columns = colors.iter_mut().flatten();
            columns.for_each(|column| column.round(|stored| encoding.rounded(stored)));
        }
        let normals = self.normals.into_iter().flatten();
        let all = normals.chain(colors.into_iter().flatten()).chain(self.attributes);
        all.map(Column::finish).collect()
    }
}

/// What makes the numbers of the file of the colours of a block.
fn stored(block: &PointSet, colors: Colors) -> impl Fn(f32) -> f64 {
    let encoding = block.color_encoding.filter(|_| colors == Colors::Linear);
    move |value| match encoding {
        Some(encoding) => encoding.encode(value),
        None => value.into(),
    }
}

impl Column {
    fn new(name: &str) -> Self {
        let none = [f64::NAN; 2];
        Self {
            name: name.to_owned(),
            range: none,
            finite: none,
            counts: None,
            histogram: Histogram::over(0.0, 0.0),
            goes_past_again: false,
        }
    }

    /// For `count` whole numbers from the lowest on, as long as there is memory for counts. With a
    /// count of 0, for any.
    fn counting(name: &str, lowest: i32, count: usize, bytes: &mut usize) -> Self {
        let needed = count * size_of::<u64>();
        let counted = count > 0 && *bytes + needed <= COUNT_BYTES;
        if counted {
            *bytes += needed;
        }
        Self { counts: counted.then(|| (lowest, vec![0; count])), ..Self::new(name) }
    }

    fn see(&mut self, values: impl Iterator<Item = f64>) {
        let mut values = values;
        let mut other = None;
        if let Some((lowest, counts)) = &mut self.counts {
            other = values.find(|&value| {
                let whole = value as i32;
                let place = usize::try_from(whole.wrapping_sub(*lowest)).unwrap_or(usize::MAX);
                match counts.get_mut(place).filter(|_| f64::from(whole) == value) {
                    Some(count) => *count += 1,
                    None => return true,
                }
                false
            });
            if other.is_none() {
                return;
            }
            self.range = self.counted_range().unwrap_or(self.range);
            self.finite = self.range;
            self.counts = None;
        }
        // Least and greatest of a number and NaN are the number.
        let ([mut low, mut high], [mut least, mut greatest]) = (self.range, self.finite);
        for value in other.into_iter().chain(values) {
            (low, high) = (low.min(value), high.max(value));
            let finite = if value.is_finite() { value } else { f64::NAN };
            (least, greatest) = (least.min(finite), greatest.max(finite));
        }
        (self.range, self.finite) = ([low, high], [least, greatest]);
    }

    /// The range of what was counted.
    fn counted_range(&self) -> Option<[f64; 2]> {
        let (lowest, counts) = self.counts.as_ref()?;
        let mut values = (*lowest..).zip(counts).filter(|&(_, &times)| times > 0);
        let (low, _) = values.next()?;
        let high = values.last().map_or(low, |(high, _)| high);
        Some([low, high].map(f64::from))
    }

    /// Makes the histogram, or begins it; then all values have to go past once more.
    fn second_pass(&mut self) -> bool {
        if let Some([low, high]) = self.counted_range() {
            self.range = [low, high];
            self.histogram = Histogram::over(low, high);
        }
        let Some((lowest, counts)) = self.counts.take() else {
            let [low, high] = self.finite;
            self.goes_past_again = !low.is_nan();
            if self.goes_past_again {
                self.histogram = Histogram::over(low, high);
            }
            return self.goes_past_again;
        };
        for (value, &times) in (lowest..).zip(&counts).filter(|&(_, &times)| times > 0) {
            self.histogram.add(value.into(), times);
        }
        false
    }

    fn count(&mut self, values: impl Iterator<Item = f64>) {
        if self.goes_past_again {
            values.for_each(|value| self.histogram.add(value, 1));
        }
    }

    /// Rounds what is printed.
    fn round(&mut self, rounded: impl Fn(f64) -> f64) {
        self.range = self.range.map(&rounded);
        let Histogram { low, high, .. } = &mut self.histogram;
        (*low, *high) = (rounded(*low), rounded(*high));
    }

    fn finish(self) -> (String, Range, Histogram) {
        let [low, high] = self.range;
        let range = Range((!low.is_nan()).then_some((low, high)));
        (self.name, range, self.histogram)
    }
}
