//! FLIP: how visible a difference is to someone who flips between two pictures.
//!
//! After P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. D. Fairchild, "FLIP:
//! A Difference Evaluator for Alternating Images", High Performance Graphics 2020, cited as [F]; and, for
//! high dynamic range, P. Andersson, J. Nilsson, P. Shirley and T. Akenine-Möller, "Visualizing Errors in
//! Rendered High Dynamic Range Images", Eurographics 2021, cited as [H]. The tests compare with numbers
//! of the authors' own program. That program and the crates that wrap it need a C++ compiler, and those
//! know 8-bit pictures only; so the method is here in Rust.

use crate::exposure::Exposures;
use crate::lanes::{choose, cube_root, power};
use crate::measure::percentiles;
use crate::tiles::{Kernel, Shown, flip_map};
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
        Self::from_map(flip_ldr(reference, test, size), None, reference, test)
    }

    /// Of linear colours of any range, [H]: the largest FLIP of each pixel over a series of exposures,
    /// which the reference decides.
    #[must_use]
    pub fn hdr(reference: &[[f32; 3]], test: &[[f32; 3]], size: [usize; 2]) -> Self {
        let exposures = Exposures::of(reference, test);
        let shown: Vec<Shown> = exposures.stops().map(Shown::ToneMapped).collect();
        let filters = Filters::new(PIXELS_PER_DEGREE);
        let map = flip_map([reference, test], size, &filters, &shown);
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

/// FLIP of each pixel, [F]: of linear Rec. 709 colours within 0..=1, row by row, `size` columns and rows.
///
/// # Panics
/// If there are not as many colours as pixels, or none.
#[must_use]
pub fn flip_ldr(reference: &[[f32; 3]], test: &[[f32; 3]], size: [usize; 2]) -> Vec<f32> {
    flip_map([reference, test], size, &Filters::new(PIXELS_PER_DEGREE), &[Shown::Cut])
}

/// Filters of an observer.
pub(crate) struct Filters {
    /// What the eye cannot resolve: brightness, red against green.
    pub(crate) brightness: Kernel,
    pub(crate) red_green: Kernel,
    /// Blue against yellow, the sum of two with these shares.
    pub(crate) blue_yellow: [(f32, Kernel); 2],
    /// A Gaussian as wide as edges that are seen, and its first and second derivatives.
    pub(crate) smooth: Kernel,
    pub(crate) first: Kernel,
    pub(crate) second: Kernel,
}

impl Filters {
    /// How far any of them reaches from its middle.
    pub(crate) fn reach(&self) -> usize {
        let kernels = [&self.brightness, &self.red_green, &self.smooth, &self.first, &self.second];
        let widest = kernels.into_iter().chain(self.blue_yellow.iter().map(|(_, kernel)| kernel));
        widest.map(|kernel| kernel.len() / 2).max().unwrap_or(0)
    }

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

/// How visible a difference of colours is: [F] Eqs. 3 and 4.
pub(crate) struct ColorErrors {
    /// The difference at the knee, and how much there is between it and the largest.
    knee: f32,
    rest: f32,
}

/// Scaled by the two colours of the cube that are farthest apart, green and blue.
pub(crate) fn color_errors() -> ColorErrors {
    const KNEE: f32 = 0.4;
    let largest = hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0]));
    let most = power(largest, EXPONENT);
    ColorErrors { knee: KNEE * most, rest: most - KNEE * most }
}

/// Of a difference of colours: small ones count more.
const EXPONENT: f32 = 0.7;

impl ColorErrors {
    /// Difference of two colours, 0 to 1.
    #[inline(always)]
    pub(crate) fn of(&self, a: [f32; 3], b: [f32; 3]) -> f32 {
        const AT_KNEE: f32 = 0.95;
        let error = power(hyab(a, b), EXPONENT);
        let below = AT_KNEE / self.knee * error;
        let above = AT_KNEE + (error - self.knee) / self.rest * (1.0 - AT_KNEE);
        choose(error < self.knee, below, above)
    }
}

/// City-block distance of lightness and colour, Euclidean distance of colours: Abasi et al. 2020.
#[inline(always)]
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [x, y] = [a[1] - b[1], a[2] - b[2]];
    (a[0] - b[0]).abs() + (x * x + y * y).sqrt()
}

/// The white of D65: X, Y, Z of linear (1, 1, 1).
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

/// Linear Rec. 709 to CIE XYZ over that white.
#[inline(always)]
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
    [xyz[0] / WHITE[0], xyz[1] / WHITE[1], xyz[2] / WHITE[2]]
}

#[inline(always)]
pub(crate) fn ycc_from_rgb(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = xyz_from_rgb(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[inline(always)]
pub(crate) fn rgb_from_ycc([luma, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (luma + 16.0) / 116.0;
    let [x, y, z] = [(y + cx / 500.0) * WHITE[0], y * WHITE[1], (y - cz / 200.0) * WHITE[2]];
    [
        3.241_003_3 * x - 1.537_399 * y - 0.498_615_86 * z,
        -0.969_224_33 * x + 1.875_930_1 * y + 0.041_554_224 * z,
        0.055_639_423 * x - 0.204_011_2 * y + 1.057_148_9 * z,
    ]
}

/// The cube root, whose slope ends near 0: of L\*a\*b\*.
#[inline(always)]
fn root(v: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    const KNEE: f32 = DELTA * DELTA * DELTA;
    let root = cube_root(if v > KNEE { v } else { KNEE });
    choose(v > KNEE, root, v / (3.0 * DELTA * DELTA) + 4.0 / 29.0)
}

/// L\*a\*b\* whose colour fades in the dark, [F] Section 4.1.2.
#[inline(always)]
pub(crate) fn hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = xyz_from_rgb(rgb);
    let [x, y, z] = [root(x), root(y), root(z)];
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// Weights at −radius..=radius.
fn sampled(radius: i32, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| weight(f64::from(x))).collect()
}

/// Weights whose positive ones sum to 1 and whose negative ones to −1, without ends that no f32 would show.
fn balanced(weights: &[f64]) -> Kernel {
    const NOTHING: f64 = 1e-9;
    let positive: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|w| **w < 0.0).sum::<f64>();
    let scaled = |w: &f64| (if *w < 0.0 { w / negative } else { w / positive }) as f32;
    let idle = weights.iter().take_while(|w| w.abs() < NOTHING * positive).count();
    weights[idle..weights.len() - idle].iter().map(scaled).collect()
}
