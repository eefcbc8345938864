//! Differences as colours, for whoever wants to see where they are.

use crate::measure::difference;
use crate::pair::Pair;
use crate::picture::Rect;

/// The colour of pixels where one picture has a number and the other has none, or an infinity stands
/// against something else: in no place of the colour map.
pub const NOT_A_NUMBER: [u8; 3] = [0, 255, 255];

/// A picture of differences.
#[derive(Debug, Clone, PartialEq)]
pub struct FalseColor {
    /// Colours in sRGB, row by row: of the map magma, black for 0, pale yellow for `scale` and more.
    pub pixels: Vec<[u8; 3]>,
    /// The difference that has the map's last colour.
    pub scale: f64,
}

impl FalseColor {
    /// The largest difference over `channels` of each pixel, over `scale`, or over the largest finite
    /// one of all pixels where no positive scale is given.
    ///
    /// # Panics
    /// As [`Pair::measure`].
    #[must_use]
    pub fn of(pair: &Pair, channels: &[&str], region: Rect, scale: Option<f64>) -> Self {
        let mut largest = vec![0.0f64; region.pixels()];
        for name in channels {
            let [a, b] = pair.planes(name).map(|plane| plane.values(region));
            for (most, (a, b)) in largest.iter_mut().zip(a.zip(b)) {
                *most = most.max(difference(a, b));
            }
        }
        let finite = largest.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max);
        let scale = scale.filter(|scale| *scale > 0.0).unwrap_or(finite);
        let color = |d: f64| {
            if d.is_infinite() {
                return NOT_A_NUMBER;
            }
            let part = if d > 0.0 { (d / scale).min(1.0) } else { 0.0 };
            let colorous::Color { r, g, b } = colorous::MAGMA.eval_continuous(part);
            [r, g, b]
        };
        Self { pixels: largest.into_iter().map(color).collect(), scale }
    }
}
