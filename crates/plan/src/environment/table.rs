//! Where an environment is bright: what directions are drawn by, in proportion to its brightness (docs/method.md,
//! section 6; Pharr, Jakob and Humphreys, Physically Based Rendering, 4th ed., section 12.5).

use kernels::layout::{IMAGE_SRGB8, ImageInfo};
use std::f64::consts::{PI, TAU};

/// Most columns and rows of cells.
const MOST_CELLS: [u32; 2] = [512, 256];

/// How likely the directions of an equirectangular image are drawn, cell by cell, in the image's own frame.
///
/// Densities follow from the numbers as f32 has them, so that drawing and density agree: the share of a cell is the
/// difference of the marginal distribution over the solid angle's rows times that of the conditional one, and inside a cell
/// the cosine of the angle from the top and the azimuth are evenly distributed. A cell whose share is too
/// small for f32 is never drawn and has the density 0: at most 5e-5 of the light in all.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentTable {
    /// The bits of `columns` and `rows` as u32; `rows + 1` cosines of the angle from the top at the borders of rows, from
    /// 1 to -1; `rows` values of the marginal distribution, each row included, the last 1; for each row `columns` of its
    /// conditional one, in the same way; for each row `columns` densities per steradian.
    pub values: Vec<f32>,
    /// Cells along the azimuth, from that of the image's left edge to the right.
    pub columns: u32,
    /// Cells from the top down, evenly spaced in the angle.
    pub rows: u32,
    /// The mean luminance over all directions, in the image's units.
    pub mean: f64,
    /// How much brighter than that its brightest cell is on average.
    pub peak_over_mean: f64,
}

impl EnvironmentTable {
    /// The table of an image that is looked up bilinear, among the `texels` of a plan. `None` where it is black.
    #[must_use]
    pub fn of(image: &ImageInfo, texels: &[u32]) -> Option<Self> {
        let columns = image.width.min(MOST_CELLS[0]);
        let rows = image.height.min(MOST_CELLS[1]);
        let borders: Vec<f32> = (0..=rows).map(|row| cosine_of_border(row, rows)).collect();
        let cell_angle = |row: usize| {
            TAU / f64::from(columns) * (f64::from(borders[row]) - f64::from(borders[row + 1]))
        };
        let brightness = mean_luminances(image, texels, [columns, rows]);
        let of_row = |row: usize| &brightness[row * columns as usize..][..columns as usize];
        let row_sums: Vec<f64> = (0..rows as usize)
            .map(|row| of_row(row).iter().sum::<f64>() * cell_angle(row))
            .collect();
        let total: f64 = row_sums.iter().sum();
        if total <= 0.0 {
            return None;
        }
        let marginal = distribution(&row_sums);
        let mut conditional = Vec::with_capacity(brightness.len());
        let mut densities = Vec::with_capacity(brightness.len());
        for (row, share_of_row) in shares(&marginal).enumerate() {
            let of_columns = distribution(of_row(row));
            let density = |share: f64| (share_of_row * share / cell_angle(row)) as f32;
            densities.extend(shares(&of_columns).map(density));
            conditional.extend(of_columns);
        }
        let mut values = vec![f32::from_bits(columns), f32::from_bits(rows)];
        for part in [borders, marginal, conditional, densities] {
            values.extend(part);
        }
        let mean = total / (4.0 * PI);
        let peak = brightness.iter().copied().fold(0.0, f64::max);
        Some(Self { values, columns, rows, mean, peak_over_mean: peak / mean })
    }
}

/// The cosine of the angle from the top at which a row of cells begins.
fn cosine_of_border(row: u32, rows: u32) -> f32 {
    (PI * f64::from(row) / f64::from(rows)).cos() as f32
}

/// The cumulative shares of weights that are at least 0, each one's own included; even where all are 0.
fn distribution(weights: &[f64]) -> Vec<f32> {
    let total: f64 = weights.iter().sum();
    let count = weights.len() as f64;
    let mut so_far = 0.0;
    let share = |(index, weight): (usize, &f64)| {
        so_far += weight;
        if total > 0.0 { (so_far / total) as f32 } else { ((index as f64 + 1.0) / count) as f32 }
    };
    weights.iter().enumerate().map(share).collect()
}

/// What each adds to a cumulative distribution.
fn shares(cumulative: &[f32]) -> impl Iterator<Item = f64> {
    let before = std::iter::once(&0.0).chain(cumulative);
    cumulative.iter().zip(before).map(|(&to, &from)| f64::from(to) - f64::from(from))
}

/// The mean luminance of the image in each cell, row by row, evenly over its rectangle of the image.
fn mean_luminances(image: &ImageInfo, texels: &[u32], [columns, rows]: [u32; 2]) -> Vec<f64> {
    let width = image.width as usize;
    let across: Vec<Vec<(usize, f64)>> = (0..columns)
        .map(|column| weights_of(column, columns, image.width, |at, of| at.rem_euclid(of)))
        .collect();
    let mut means = Vec::with_capacity(columns as usize * rows as usize);
    let mut line = vec![0.0; width];
    for row in 0..rows {
        line.fill(0.0);
        for (at, weight) in weights_of(row, rows, image.height, |at, of| at.clamp(0, of - 1)) {
            for (column, sum) in line.iter_mut().enumerate() {
                *sum += weight * luminance_at(image, texels, at * width + column);
            }
        }
        let mean = |weights: &Vec<(usize, f64)>| weights.iter().map(|&(at, w)| w * line[at]).sum();
        means.extend(across.iter().map(mean).map(|mean: f64| mean.max(0.0)));
    }
    means
}

/// How much each texel along an axis counts in the mean over the cell `cell` of `cells`. `inside` brings one beyond the
/// edges to the one that is looked up there.
fn weights_of(
    cell: u32,
    cells: u32,
    texels: u32,
    inside: impl Fn(i64, i64) -> i64,
) -> Vec<(usize, f64)> {
    let border = |cell: u32| f64::from(cell) * f64::from(texels) / f64::from(cells);
    let (from, to) = (border(cell), border(cell + 1));
    // A texel's part of the mean reaches from the middle of the one before to the middle of the next.
    let (first, last) = ((from - 0.5).floor() as i64, (to - 0.5).floor() as i64 + 1);
    let weight = |at: i64| {
        let middle = at as f64 + 0.5;
        (hat_up_to(to - middle) - hat_up_to(from - middle)) / (to - from)
    };
    let placed = |at: i64| (inside(at, i64::from(texels)) as usize, weight(at));
    (first..=last).map(placed).filter(|&(_, weight)| weight > 0.0).collect()
}

/// The integral of max(0, 1 - |x|) up to `x`.
fn hat_up_to(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    if x < 0.0 { 0.5 * (1.0 + x) * (1.0 + x) } else { 1.0 - 0.5 * (1.0 - x) * (1.0 - x) }
}

/// The luminance of a texel by its place in the image.
fn luminance_at(image: &ImageInfo, texels: &[u32], at: usize) -> f64 {
    let first = image.first as usize;
    let value = |place: usize| f64::from(f32::from_bits(texels[place]));
    luminance(if image.format == IMAGE_SRGB8 {
        let word = texels[first + at];
        [word, word >> 8, word >> 16].map(|byte| value(byte as usize & 255))
    } else {
        [0, 1, 2].map(|channel| value(first + 3 * at + channel))
    })
}

/// Luminance of linear Rec. 709.
fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests;
