//! How values are spread: their range, and how many of them are where in it.

use std::fmt;

/// Smallest and largest of some values, of those that are numbers; `None` if none is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range(pub Option<(f64, f64)>);

/// How often values lie where, between the lowest finite one and the highest.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Lower end of the first part; 0 where no value is finite.
    pub low: f64,
    /// Upper end of the last part.
    pub high: f64,
    /// Values in each of the even parts; an end between two counts for the upper one.
    pub counts: [u64; BINS],
}

/// Parts of a histogram.
pub(super) const BINS: usize = 16;
/// Characters of its longest bar.
const BAR: u64 = 40;

impl Histogram {
    /// Without values, over the range of those to come.
    pub(super) fn over(low: f64, high: f64) -> Self {
        Self { low, high, counts: [0; BINS] }
    }

    /// Adds a value, as often as it occurs. One that is not finite is passed over.
    pub(super) fn add(&mut self, value: f64, times: u64) {
        if !value.is_finite() {
            return;
        }
        // Halves, so that no difference of two numbers overflows.
        let span = 0.5 * self.high - 0.5 * self.low;
        let part = if span > 0.0 { (0.5 * value - 0.5 * self.low) / span } else { 0.0 };
        // The highest value is in the last part.
        self.counts[((part * BINS as f64) as usize).min(BINS - 1)] += times;
    }
}

impl fmt::Display for Histogram {
    /// One line a part: its lower end, how many, and a bar.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let most = self.counts.iter().copied().max().unwrap_or(0).max(1);
        let width = most.to_string().len();
        for (bin, &count) in self.counts.iter().enumerate() {
            let part = bin as f64 / BINS as f64;
            let from = self.low * (1.0 - part) + self.high * part;
            // What is there at all shows.
            let bar = "#".repeat((count * BAR).div_ceil(most) as usize);
            let line = format!("{from:>12.5e}  {count:width$}  {bar}");
            write!(f, "\n      {}", line.trim_end())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0 to 159 in sixteen parts of 9.9375: each has its tens but for what the ends round.
    #[test]
    fn a_histogram_counts_every_finite_value_once() {
        let histogram = |low, high, values: &[f64]| {
            let mut histogram = Histogram::over(low, high);
            values.iter().for_each(|&value| histogram.add(value, 1));
            histogram
        };
        let values: Vec<f64> = (0..160).map(f64::from).chain([f64::NAN, f64::INFINITY]).collect();
        let far = histogram(-f64::MAX, f64::MAX, &[-f64::MAX, f64::MAX]);
        let histogram = histogram(0.0, 159.0, &values);
        assert_eq!((histogram.low, histogram.high), (0.0, 159.0));
        assert_eq!(histogram.counts, [10; BINS]);
        let text = histogram.to_string();
        assert_eq!(text.lines().count(), BINS + 1);
        assert!(text.contains("   9.93750e0  10  ####"), "{text}");
        assert_eq!((far.counts[0], far.counts[BINS - 1]), (1, 1));
    }
}
