//! FLIP: how visible a difference is to someone who flips between two pictures.
//!
//! After P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. D. Fairchild, "FLIP:
//! A Difference Evaluator for Alternating Images", High Performance Graphics 2020, cited as [F]; and, for
//! high dynamic range, P. Andersson, J. Nilsson, P. Shirley and T. Akenine-Möller, "Visualizing Errors in
//! Rendered High Dynamic Range Images", Eurographics 2021, cited as [H]. The tests compare with numbers
//! of the authors' own program. That program and the crates that wrap it need a C++ compiler, and those
//! know 8-bit pictures only; so the method is here in Rust.

use crate::convolve::{Grid, Kernel, balanced, sampled};
use crate::exposure::{Exposures, tone_mapped};
use crate::measure::percentiles;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Of a screen 0.7 m and 3840 pixels wide, seen from 0.7 m: the observer of both papers.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// FLIP of two pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Flip {
    /// The mean over all pixels: 0 for no visible difference, 1 for the largest.
    pub mean: f64,
    /// The largest value.
    pub max: f64,
    /// The values that so many per cent of pixels do not exceed, for each of
    /// [`PERCENTILES`](crate::PERCENTILES).
    pub percentiles: [f64; 3],
    /// First and last exposure in stops, and how many, where the pictures have a high dynamic range.
    pub exposures: Option<([f64; 2], usize)>,
    /// The value of each pixel, row by row.
    pub map: Vec<f32>,
}

impl Flip {
    /// Of linear colours as a screen shows them: cut at 0 and 1.
    #[must_use]
    pub fn ldr(reference: &[[f32; 3]], test: &[[f32; 3]], size: [usize; 2]) -> Self {
        let [a, b] = [reference, test].map(|pixels| -> Vec<[f32; 3]> {
            pixels.iter().map(|pixel| pixel.map(|c| finite(c).clamp(0.0, 1.0))).collect()
        });
        Self::from_map(flip_ldr(&a, &b, size), None, reference, test)
    }

    /// Of linear colours of any range, [H]: the largest FLIP of each pixel over a series of exposures,
    /// which the reference decides.
    #[must_use]
    pub fn hdr(reference: &[[f32; 3]], test: &[[f32; 3]], size: [usize; 2]) -> Self {
        let exposures = Exposures::of(reference, test);
        let mut map = vec![0.0f32; reference.len()];
        for stops in exposures.stops() {
            let [a, b] = [reference, test].map(|pixels| -> Vec<[f32; 3]> {
                let shown = |pixel: &[f32; 3]| pixel.map(|c| tone_mapped(finite(c), stops));
                pixels.par_iter().map(shown).collect()
            });
            for (most, value) in map.iter_mut().zip(flip_ldr(&a, &b, size)) {
                *most = most.max(value);
            }
        }
        let series = (exposures.range, exposures.count);
        Self::from_map(map, Some(series), reference, test)
    }

    fn from_map(
        mut map: Vec<f32>,
        exposures: Option<([f64; 2], usize)>,
        reference: &[[f32; 3]],
        test: &[[f32; 3]],
    ) -> Self {
        // No number against a number is as visible as can be, whatever it is shown as.
        for (value, (a, b)) in map.iter_mut().zip(reference.iter().zip(test)) {
            if a.iter().zip(b).any(|(a, b)| a.is_nan() != b.is_nan()) {
                *value = 1.0;
            }
        }
        let mean = map.iter().map(|&value| f64::from(value)).sum::<f64>() / map.len() as f64;
        let max = f64::from(map.iter().copied().fold(0.0, f32::max));
        let percentiles = percentiles(&mut map.clone()).map(f64::from);
        Self { mean, max, percentiles, exposures, map }
    }
}

/// What is no number is shown black.
fn finite(c: f32) -> f32 {
    if c.is_nan() { 0.0 } else { c }
}

/// FLIP of each pixel, [F]: of linear Rec. 709 colours within 0..=1, row by row, `size` columns and rows.
///
/// # Panics
/// If there are not as many colours as pixels, or none.
#[must_use]
pub fn flip_ldr(reference: &[[f32; 3]], test: &[[f32; 3]], size: [usize; 2]) -> Vec<f32> {
    let filters = Filters::new(PIXELS_PER_DEGREE);
    let [reference, test] =
        [reference, test].map(|pixels| Opponent::of(pixels, size).seen(&filters));
    let largest = largest_color_difference();
    (0..size[0] * size[1])
        .into_par_iter()
        .map(|at| {
            let color = color_error(&reference.lab[at], &test.lab[at], largest);
            let edge = (reference.edges[at] - test.edges[at]).abs();
            let point = (reference.points[at] - test.points[at]).abs();
            // [F] Eqs. 5 and 6: features make a difference of colours more visible.
            let feature = (edge.max(point) / std::f32::consts::SQRT_2).sqrt();
            color.powf(1.0 - feature)
        })
        .collect()
}

/// A picture in Y, Cx, Cz: one channel of brightness, two of colour, linear in the colours of the picture.
struct Opponent([Grid; 3]);

/// What is left of a picture for an observer.
struct Seen {
    /// L\*a\*b\* with Hunt's adjustment.
    lab: Vec<[f32; 3]>,
    /// How strong edges are, 0 to √2.
    edges: Vec<f32>,
    /// How strong points are.
    points: Vec<f32>,
}

/// Filters of an observer.
struct Filters {
    /// What the eye cannot resolve: brightness, red against green.
    brightness: Kernel,
    red_green: Kernel,
    /// Blue against yellow, the sum of two with these shares.
    blue_yellow: [(f32, Kernel); 2],
    /// A Gaussian as wide as edges that are seen, and its first and second derivatives.
    smooth: Kernel,
    first: Kernel,
    second: Kernel,
}

impl Filters {
    /// [F] Sections 4.1.1 and 4.2.
    fn new(pixels_per_degree: f64) -> Self {
        // Amplitude and width of the Gaussians of the contrast sensitivity functions, [F] Table 1.
        const BRIGHTNESS: f64 = 0.0047;
        const RED_GREEN: f64 = 0.0053;
        const BLUE_YELLOW: [[f64; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];
        let widest = (0.04 / (2.0 * PI * PI)).sqrt();
        let radius = (3.0 * widest * pixels_per_degree).ceil() as i32;
        let gaussian =
            |width: f64| sampled(radius, |x| (-(PI * x / pixels_per_degree).powi(2) / width).exp());
        let shares = BLUE_YELLOW.map(|[amplitude, width]| {
            let sum: f64 = gaussian(width).iter().sum();
            amplitude * (PI / width).sqrt() * sum * sum
        });
        let both = shares[0] + shares[1];
        // Peak to trough of edges that are seen, 0.082 degrees, is two standard deviations.
        let deviation = 0.5 * 0.082 * pixels_per_degree;
        let reach = (3.0 * deviation).ceil() as i32;
        let bell = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        Self {
            brightness: balanced(&gaussian(BRIGHTNESS)),
            red_green: balanced(&gaussian(RED_GREEN)),
            blue_yellow: [0, 1]
                .map(|i| ((shares[i] / both) as f32, balanced(&gaussian(BLUE_YELLOW[i][1])))),
            smooth: balanced(&sampled(reach, bell)),
            first: balanced(&sampled(reach, |x| -x * bell(x))),
            second: balanced(&sampled(reach, |x| {
                (x * x / (deviation * deviation) - 1.0) * bell(x)
            })),
        }
    }
}

impl Opponent {
    fn of(pixels: &[[f32; 3]], size: [usize; 2]) -> Self {
        let converted: Vec<[f32; 3]> = pixels.par_iter().map(|&rgb| ycc_from_rgb(rgb)).collect();
        Self([0, 1, 2].map(|i| Grid::new(size, converted.iter().map(|color| color[i]).collect())))
    }

    fn seen(&self, filters: &Filters) -> Seen {
        let [y, cx, cz] = &self.0;
        let [by_one, by_two] = [&filters.blue_yellow[0], &filters.blue_yellow[1]]
            .map(|(share, kernel)| (*share, cz.along_both(kernel)));
        let brightness = y.along_both(&filters.brightness);
        let red_green = cx.along_both(&filters.red_green);
        let lab = (0..y.values.len()).into_par_iter().map(|at| {
            let cz = by_one.0 * by_one.1.values[at] + by_two.0 * by_two.1.values[at];
            let color = [brightness.values[at], red_green.values[at], cz];
            hunt_lab(rgb_from_ycc(color).map(|c| c.clamp(0.0, 1.0)))
        });
        let light = Grid::new(y.size, y.values.iter().map(|y| (y + 16.0) / 116.0).collect());
        let smooth = light.along_rows(&filters.smooth);
        Seen {
            lab: lab.collect(),
            edges: strength(&light, &smooth, &filters.first, &filters.smooth),
            points: strength(&light, &smooth, &filters.second, &filters.smooth),
        }
    }
}

/// Length of the vector of what a filter and the same filter on its side find. `smooth` is `light`
/// smoothed along its rows.
fn strength(light: &Grid, smooth: &Grid, filter: &Kernel, across: &Kernel) -> Vec<f32> {
    let horizontal = light.along_rows(filter).along_columns(across);
    let vertical = smooth.along_columns(filter);
    horizontal.values.iter().zip(&vertical.values).map(|(x, y)| x.hypot(*y)).collect()
}

/// Difference of two colours, 0 to 1: [F] Eqs. 3 and 4. `largest` is the largest there is.
fn color_error(a: &[f32; 3], b: &[f32; 3], largest: f32) -> f32 {
    const EXPONENT: f32 = 0.7;
    const KNEE: f32 = 0.4;
    const AT_KNEE: f32 = 0.95;
    let most = largest.powf(EXPONENT);
    let (error, knee) = (hyab(a, b).powf(EXPONENT), KNEE * most);
    match error < knee {
        true => AT_KNEE / knee * error,
        false => AT_KNEE + (error - knee) / (most - knee) * (1.0 - AT_KNEE),
    }
}

/// Of green and blue, the two colours of the cube that are farthest apart.
fn largest_color_difference() -> f32 {
    hyab(&hunt_lab([0.0, 1.0, 0.0]), &hunt_lab([0.0, 0.0, 1.0]))
}

/// City-block distance of lightness and colour, Euclidean distance of colours: Abasi et al. 2020.
fn hyab(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// The white of D65: X, Y, Z of linear (1, 1, 1).
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

/// Linear Rec. 709 to CIE XYZ over that white.
fn xyz_from_rgb([r, g, b]: [f32; 3]) -> [f32; 3] {
    let xyz = [
        10_135_552.0 / 24_577_794.0 * r
            + 8_788_810.0 / 24_577_794.0 * g
            + 4_435_075.0 / 24_577_794.0 * b,
        2_613_072.0 / 12_288_897.0 * r
            + 8_788_810.0 / 12_288_897.0 * g
            + 887_015.0 / 12_288_897.0 * b,
        1_425_312.0 / 73_733_382.0 * r
            + 8_788_810.0 / 73_733_382.0 * g
            + 70_074_185.0 / 73_733_382.0 * b,
    ];
    [0, 1, 2].map(|i| xyz[i] / WHITE[i])
}

fn ycc_from_rgb(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = xyz_from_rgb(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn rgb_from_ycc([luma, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (luma + 16.0) / 116.0;
    let [x, y, z] = [(y + cx / 500.0) * WHITE[0], y * WHITE[1], (y - cz / 200.0) * WHITE[2]];
    [
        3.241_003_3 * x - 1.537_399 * y - 0.498_615_86 * z,
        -0.969_224_33 * x + 1.875_930_1 * y + 0.041_554_224 * z,
        0.055_639_423 * x - 0.204_011_2 * y + 1.057_148_9 * z,
    ]
}

/// L\*a\*b\* whose colour fades in the dark, [F] Section 4.1.2.
fn hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    const DELTA: f32 = 6.0 / 29.0;
    let [x, y, z] = xyz_from_rgb(rgb).map(|v| match v > DELTA * DELTA * DELTA {
        true => v.cbrt(),
        false => v / (3.0 * DELTA * DELTA) + 4.0 / 29.0,
    });
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}
