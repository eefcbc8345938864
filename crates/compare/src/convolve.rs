//! Separable filters over planes of f32, whose border goes on with its last value.

use rayon::prelude::*;

/// A plane of values, row by row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    pub size: [usize; 2],
    pub values: Vec<f32>,
}

/// Weights of a filter in one direction; an odd number, the middle one for the pixel itself.
pub(crate) type Kernel = Vec<f32>;

impl Grid {
    pub fn new(size: [usize; 2], values: Vec<f32>) -> Self {
        assert_eq!(values.len(), size[0] * size[1], "compare: values of a plane");
        Self { size, values }
    }

    /// Filtered from left to right.
    pub fn along_rows(&self, kernel: &Kernel) -> Self {
        let [width, _] = self.size;
        let radius = kernel.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(width).zip(self.values.par_chunks(width)).for_each(|(out, row)| {
            // The row with what is beyond its ends, so that the loop has no conditions.
            let ends = [row[0], row[width - 1]].map(|end| vec![end; radius]);
            let wide = [&ends[0], row, &ends[1]].concat();
            for (value, window) in out.iter_mut().zip(wide.windows(kernel.len())) {
                *value = window.iter().zip(kernel).map(|(v, w)| v * w).sum();
            }
        });
        Self { size: self.size, values }
    }

    /// Filtered from top to bottom.
    pub fn along_columns(&self, kernel: &Kernel) -> Self {
        let [width, height] = self.size;
        let radius = kernel.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
            for (offset, weight) in kernel.iter().enumerate() {
                let row = (y + offset).saturating_sub(radius).min(height - 1);
                let row = &self.values[row * width..][..width];
                for (value, v) in out.iter_mut().zip(row) {
                    *value += v * weight;
                }
            }
        });
        Self { size: self.size, values }
    }

    /// Filtered in both directions.
    pub fn along_both(&self, kernel: &Kernel) -> Self {
        self.along_rows(kernel).along_columns(kernel)
    }
}

/// Weights at −radius..=radius.
pub(crate) fn sampled(radius: i32, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| weight(f64::from(x))).collect()
}

/// Weights whose positive ones sum to 1 and whose negative ones to −1.
pub(crate) fn balanced(weights: &[f64]) -> Kernel {
    let positive: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|w| **w < 0.0).sum::<f64>();
    let scaled = |w: &f64| (if *w < 0.0 { w / negative } else { w / positive }) as f32;
    weights.iter().map(scaled).collect()
}
