//! FLIP tile by tile, so that what is in between stays in a processor's cache, on all cores.
//!
//! Each tile is filtered with what surrounds it, as far as the widest filter reaches; the border of the picture goes on
//! with its last value. Tiles whose surroundings are the same in both pictures are not looked at: FLIP is 0 there.

use crate::exposure::tone_mapped_by;
use crate::flip::{Filters, color_errors, hunt_lab, rgb_from_ycc, ycc_from_rgb};
use crate::lanes::{power, wide};
use rayon::prelude::*;

/// Columns and rows of a tile: with what surrounds it, a plane is 90 KB.
const SIDE: usize = 128;
/// Columns that are filtered at a time: four registers of eight.
const LANES: usize = 32;

/// Weights of a filter in one direction; an odd number, the middle one for the pixel itself.
pub(crate) type Kernel = Vec<f32>;

/// How linear colours become those of a screen.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Shown {
    /// Cut at 0 and 1.
    Cut,
    /// By a tone curve at this exposure in stops.
    ToneMapped(f64),
}

/// A place in the picture with what surrounds it.
#[derive(Debug, Clone, Copy)]
struct Tile {
    x: usize,
    y: usize,
    /// Columns and rows of the picture.
    columns: usize,
    rows: usize,
    /// Columns that are computed: `columns`, up to whole lanes.
    width: usize,
    /// How far its surroundings reach on each side.
    halo: usize,
}

/// Planes that one tile after another is worked out in.
#[derive(Default)]
struct Scratch {
    /// Linear red, green and blue of both pictures, with surroundings.
    linear: [[Vec<f32>; 3]; 2],
    /// Y, Cx, Cz, and Y from 0 to 1, with surroundings.
    opponent: [Vec<f32>; 4],
    /// Filtered along rows, with rows above and below.
    along_rows: Vec<f32>,
    smooth: Vec<f32>,
    /// Filtered in both directions.
    both: [Vec<f32>; 4],
    seen: [Seen; 2],
}

/// What is left of a tile for an observer.
#[derive(Default)]
struct Seen {
    /// L\*a\*b\* with Hunt's adjustment.
    lab: [Vec<f32>; 3],
    /// How strong edges are, 0 to √2.
    edges: Vec<f32>,
    /// How strong points are.
    points: Vec<f32>,
}

/// FLIP of each pixel, the largest over all ways of showing the pictures.
pub(crate) fn flip_map(
    pictures: [&[[f32; 3]]; 2],
    size: [usize; 2],
    filters: &Filters,
    shown: &[Shown],
) -> Vec<f32> {
    let [width, height] = size;
    assert!(pictures.iter().all(|pixels| pixels.len() == width * height), "compare: colours");
    let halo = filters.reach();
    let starts = |end: usize| (0..end).step_by(SIDE);
    let tiles: Vec<Tile> = starts(height)
        .flat_map(|y| starts(width).map(move |x| (x, y)))
        .map(|(x, y)| {
            let [columns, rows] = [(width - x).min(SIDE), (height - y).min(SIDE)];
            Tile { x, y, columns, rows, width: columns.next_multiple_of(LANES), halo }
        })
        .collect();
    let found = tiles.par_iter().map_init(Scratch::default, |scratch, tile| {
        if tile.is_equal(pictures, size) {
            return None;
        }
        scratch.load(tile, pictures, size);
        let mut most = vec![0.0f32; tile.width * tile.rows];
        for shown in shown {
            for picture in 0..2 {
                scratch.see(tile, picture, *shown, filters);
            }
            scratch.compare(&mut most);
        }
        Some(most)
    });
    let found: Vec<Option<Vec<f32>>> = found.collect();
    let mut map = vec![0.0; width * height];
    for (tile, values) in tiles.iter().zip(found) {
        let Some(values) = values else { continue };
        for (row, values) in values.chunks_exact(tile.width).enumerate() {
            let first = (tile.y + row) * width + tile.x;
            map[first..first + tile.columns].copy_from_slice(&values[..tile.columns]);
        }
    }
    map
}

impl Tile {
    /// Columns and rows with surroundings.
    fn extent(&self) -> [usize; 2] {
        [self.width + 2 * self.halo, self.rows + 2 * self.halo]
    }

    /// Whether both pictures are the same here and as far around as filters reach.
    fn is_equal(&self, [a, b]: [&[[f32; 3]]; 2], [width, height]: [usize; 2]) -> bool {
        let left = self.x.saturating_sub(self.halo);
        let right = (self.x + self.columns + self.halo).min(width);
        let rows = self.y.saturating_sub(self.halo)..(self.y + self.rows + self.halo).min(height);
        rows.into_iter().all(|row| {
            let range = row * width + left..row * width + right;
            let bits = |values: &[f32; 3]| values.map(f32::to_bits);
            let pairs = a[range.clone()].iter().zip(&b[range]);
            pairs.fold(0, |found, (a, b)| {
                let ([r, g, b], [s, t, u]) = (bits(a), bits(b));
                found | (r ^ s) | (g ^ t) | (b ^ u)
            }) == 0
        })
    }
}

impl Scratch {
    /// Takes the colours of both pictures, with surroundings.
    fn load(&mut self, tile: &Tile, pictures: [&[[f32; 3]]; 2], [width, height]: [usize; 2]) {
        let [columns, rows] = tile.extent();
        for (planes, pixels) in self.linear.iter_mut().zip(pictures) {
            for plane in planes.iter_mut() {
                plane.clear();
            }
            for row in 0..rows {
                let y = (tile.y + row).saturating_sub(tile.halo).min(height - 1);
                let line = &pixels[y * width..][..width];
                for column in 0..columns {
                    let x = (tile.x + column).saturating_sub(tile.halo).min(width - 1);
                    for (plane, &value) in planes.iter_mut().zip(&line[x]) {
                        // What is no number is shown black.
                        plane.push(if value.is_nan() { 0.0 } else { value });
                    }
                }
            }
        }
    }

    /// What an observer sees of a picture that is shown so.
    fn see(&mut self, tile: &Tile, picture: usize, shown: Shown, filters: &Filters) {
        let Self { linear, opponent, along_rows, smooth, both, seen } = self;
        let seen = &mut seen[picture];
        opponents(&linear[picture], shown, opponent);
        let [y, cx, cz, light] = opponent;
        let blurred = [
            (&*y, &filters.brightness),
            (cx, &filters.red_green),
            (cz, &filters.blue_yellow[0].1),
            (cz, &filters.blue_yellow[1].1),
        ];
        for ((plane, kernel), out) in blurred.into_iter().zip(both.iter_mut()) {
            filter_rows(tile, plane, kernel, along_rows);
            filter_columns(tile, along_rows, kernel, out);
        }
        let shares = [filters.blue_yellow[0].0, filters.blue_yellow[1].0];
        adapted(both, shares, &mut seen.lab);
        filter_rows(tile, light, &filters.smooth, smooth);
        for (kernel, out) in
            [(&filters.first, &mut seen.edges), (&filters.second, &mut seen.points)]
        {
            filter_rows(tile, light, kernel, along_rows);
            let [horizontal, vertical, ..] = both;
            filter_columns(tile, along_rows, &filters.smooth, horizontal);
            filter_columns(tile, smooth, kernel, vertical);
            lengths(horizontal, vertical, out);
        }
    }

    /// Raises each value to FLIP of both pictures as they were seen last.
    fn compare(&self, most: &mut [f32]) {
        let count = most.len();
        let [a, b] = self.seen.each_ref().map(|seen| {
            let [l, a, b] = &seen.lab;
            [l, a, b, &seen.edges, &seen.points].map(|plane| &plane[..count])
        });
        let errors = color_errors();
        wide(
            #[inline(always)]
            || {
                for at in 0..count {
                    let [p, q] = [[a[0][at], a[1][at], a[2][at]], [b[0][at], b[1][at], b[2][at]]];
                    let edge = (a[3][at] - b[3][at]).abs();
                    let point = (a[4][at] - b[4][at]).abs();
                    // [F] Eqs. 5 and 6: features make a difference of colours more visible.
                    let feature = if edge > point { edge } else { point };
                    let feature = (feature * std::f32::consts::FRAC_1_SQRT_2).sqrt();
                    let exponent = if feature < 1.0 { 1.0 - feature } else { 0.0 };
                    let value = power(errors.of(p, q), exponent);
                    most[at] = if value > most[at] { value } else { most[at] };
                }
            },
        );
    }
}

/// Makes a plane this long.
fn sized(plane: &mut Vec<f32>, length: usize) -> &mut [f32] {
    plane.resize(length, 0.0);
    // A length that the compiler sees: loops over it have no checks.
    &mut plane[..length]
}

/// Y, Cx, Cz, and Y from 0 to 1, of linear colours that are shown so.
fn opponents(linear: &[Vec<f32>; 3], shown: Shown, out: &mut [Vec<f32>; 4]) {
    let count = linear[0].len();
    let [r, g, b] = linear.each_ref().map(|plane| &plane[..count]);
    let [y, cx, cz, light] = out.each_mut().map(|plane| sized(plane, count));
    let factor = match shown {
        Shown::Cut => None,
        Shown::ToneMapped(stops) => Some(stops.exp2()),
    };
    wide(
        #[inline(always)]
        || {
            for at in 0..count {
                // Written out: what an array's `map` calls is not always inlined.
                let [r, g, b] = [r[at], g[at], b[at]];
                let colors = match factor {
                    None => [r.clamp(0.0, 1.0), g.clamp(0.0, 1.0), b.clamp(0.0, 1.0)],
                    Some(f) => [tone_mapped_by(r, f), tone_mapped_by(g, f), tone_mapped_by(b, f)],
                };
                let [luma, red_green, blue_yellow] = ycc_from_rgb(colors);
                (y[at], cx[at], cz[at]) = (luma, red_green, blue_yellow);
                light[at] = (luma + 16.0) / 116.0;
            }
        },
    );
}

/// L\*a\*b\* of what is left of Y, Cx and, with these shares, two of Cz.
fn adapted(blurred: &[Vec<f32>; 4], shares: [f32; 2], lab: &mut [Vec<f32>; 3]) {
    let count = blurred[0].len();
    let [y, cx, one, two] = blurred.each_ref().map(|plane| &plane[..count]);
    let [l, a, b] = lab.each_mut().map(|plane| sized(plane, count));
    wide(
        #[inline(always)]
        || {
            for at in 0..count {
                let cz = shares[0] * one[at] + shares[1] * two[at];
                let [red, green, blue] = rgb_from_ycc([y[at], cx[at], cz]);
                let rgb = [red.clamp(0.0, 1.0), green.clamp(0.0, 1.0), blue.clamp(0.0, 1.0)];
                [l[at], a[at], b[at]] = hunt_lab(rgb);
            }
        },
    );
}

/// Lengths of vectors.
fn lengths(x: &[f32], y: &[f32], out: &mut Vec<f32>) {
    let out = sized(out, x.len());
    wide(
        #[inline(always)]
        || {
            for (out, (x, y)) in out.iter_mut().zip(x.iter().zip(y)) {
                *out = (x * x + y * y).sqrt();
            }
        },
    );
}

/// From left to right, of all rows with surroundings.
fn filter_rows(tile: &Tile, plane: &[f32], kernel: &Kernel, out: &mut Vec<f32>) {
    let [columns, rows] = tile.extent();
    let out = sized(out, tile.width * rows);
    let first = tile.halo - kernel.len() / 2;
    wide(
        #[inline(always)]
        || {
            let lines = plane.chunks_exact(columns).zip(out.chunks_exact_mut(tile.width));
            for (line, out) in lines {
                let (blocks, _) = out.as_chunks_mut::<LANES>();
                for (block, out) in blocks.iter_mut().enumerate() {
                    *out = weighted(line, first + block * LANES, 1, kernel);
                }
            }
        },
    );
}

/// From top to bottom, of the tile only.
fn filter_columns(tile: &Tile, plane: &[f32], kernel: &Kernel, out: &mut Vec<f32>) {
    let width = tile.width;
    let out = sized(out, width * tile.rows);
    let first = tile.halo - kernel.len() / 2;
    wide(
        #[inline(always)]
        || {
            for (row, out) in out.chunks_exact_mut(width).enumerate() {
                let (blocks, _) = out.as_chunks_mut::<LANES>();
                for (block, out) in blocks.iter_mut().enumerate() {
                    let start = (first + row) * width + block * LANES;
                    *out = weighted(plane, start, width, kernel);
                }
            }
        },
    );
}

/// Sums of values that are `step` apart, in the order of the weights: side by side from `start` on.
#[inline(always)]
fn weighted(values: &[f32], start: usize, step: usize, kernel: &[f32]) -> [f32; LANES] {
    let mut sums = [0.0; LANES];
    for (tap, weight) in kernel.iter().enumerate() {
        let Some(window) = values[start + tap * step..].first_chunk::<LANES>() else { break };
        for (sum, value) in sums.iter_mut().zip(window) {
            *sum += value * weight;
        }
    }
    sums
}
