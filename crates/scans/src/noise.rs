//! What images of depths have: mixed pixels, and noise that neighbours share.

use crate::random::Random;

/// A ray's depth, and whether it is of an edge, where it may be anything between both sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mixed {
    pub value: f64,
    pub is_mixed: bool,
}

/// Rays of which one of the eight around them is off by more than `limit` of the depth: every second of them gets a depth
/// anywhere between its own and the farthest off of those.
pub(crate) fn mixed(
    depths: &[Option<f64>],
    width: usize,
    limit: f64,
    random: &mut Random,
) -> Vec<Option<Mixed>> {
    let height = depths.len() / width.max(1);
    let each = |at: usize| {
        // Drawn of each ray, so that none depends on others.
        let [chance, share] = [0; 2].map(|_| random.unit());
        let own = depths[at]?;
        let (x, y) = (at % width, at / width);
        let mut farthest = own;
        for row in y.saturating_sub(1)..height.min(y + 2) {
            for column in x.saturating_sub(1)..width.min(x + 2) {
                let depth = depths[row * width + column].unwrap_or(own);
                farthest =
                    if (depth - own).abs() > (farthest - own).abs() { depth } else { farthest };
            }
        }
        let is_mixed = (farthest - own).abs() > limit * own && chance < 0.5;
        let value = if is_mixed { own + (farthest - own) * share } else { own };
        Some(Mixed { value, is_mixed })
    };
    (0..depths.len()).map(each).collect()
}

/// Sums over 5 × 5 values divided by 5: the variance stays. Rows and columns go around.
pub(crate) fn smoothed(values: &[f64], width: usize) -> Vec<f64> {
    let height = values.len() / width.max(1);
    let sums = |values: &[f64], step: usize, count: usize| -> Vec<f64> {
        let of = |at: usize| {
            let place = at / step % count;
            let first = at - place * step;
            (0..5).map(|k| values[first + (place + count + k - 2) % count * step]).sum()
        };
        (0..values.len()).map(of).collect()
    };
    let rows = sums(values, 1, width);
    sums(&rows, width, height).into_iter().map(|sum| sum / 5.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An edge of 1 against 2: of its four columns two mix, half of the time, to anything between; nothing else moves.
    #[test]
    fn every_second_pixel_at_an_edge_is_mixed() {
        let depth = |at: usize| Some(if at % 10 < 5 { 1.0 } else { 2.0 });
        let depths: Vec<_> = (0..20_000).map(depth).collect();
        let all = mixed(&depths, 10, 0.04, &mut Random::new(1, 1));
        let mut count = 0;
        for (at, found) in all.iter().enumerate() {
            let Mixed { value, is_mixed } = found.unwrap();
            assert!((1.0..=2.0).contains(&value));
            assert!(is_mixed || Some(value) == depths[at]);
            assert!(!is_mixed || [4, 5].contains(&(at % 10)), "{at}");
            count += usize::from(is_mixed);
        }
        // 4000 by a coin: the deviation is 32.
        assert!((1900..2100).contains(&count), "{count} of 4000");
    }

    /// 40 000 values, of which 1600 are independent: the deviation of the variance is 0.035.
    #[test]
    fn smoothed_noise_keeps_its_variance() {
        let mut random = Random::new(2, 1);
        let white: Vec<f64> = (0..40_000).map(|_| random.normal()).collect();
        let soft = smoothed(&white, 200);
        let variance = soft.iter().map(|x| x * x).sum::<f64>() / 4e4;
        assert!((variance - 1.0).abs() < 0.12, "{variance}");
        let next = (0..39_999).map(|i| soft[i] * soft[i + 1]).sum::<f64>() / 4e4 / variance;
        assert!((next - 0.8).abs() < 0.03, "neighbours share four of five columns: {next}");
    }
}
