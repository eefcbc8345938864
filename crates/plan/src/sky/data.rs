//! The coefficients of the model, as its authors published them (LICENSE-hosek-wilkie.txt).

use std::sync::LazyLock;

/// Turbidities 1 to 10.
pub(super) const TURBIDITIES: usize = 10;
/// Albedos of the ground, 0 and 1.
const ALBEDOS: usize = 2;
/// Control points along the sun's elevation.
const ELEVATIONS: usize = 6;
const CHANNELS: usize = 3;
/// Coefficients of the sky's course, the paper's A to I as its program numbers them.
pub(super) const SKY_NUMBERS: usize = 9;
/// Pieces of the sun's course along the elevation.
pub(super) const SUN_PIECES: usize = 45;
/// Wavelengths of the sun.
pub(super) const WAVELENGTHS: usize = 11;
/// Coefficients of a cubic polynomial.
const CUBIC: usize = 4;
/// Coefficients of the sun's course from its middle to its rim.
pub(super) const LIMB: usize = 6;

/// Little-endian f32, one table after another, the last index fastest: the course of the sky by turbidity, albedo,
/// elevation, channel and number; its radiance by the first four; the sun by turbidity, piece, wavelength and power; its
/// limb by wavelength and power.
static BYTES: &[u8] = include_bytes!("hosek_wilkie.f32");

const COURSE_END: usize = TURBIDITIES * ALBEDOS * ELEVATIONS * CHANNELS * SKY_NUMBERS;
const RADIANCE_END: usize = COURSE_END + TURBIDITIES * ALBEDOS * ELEVATIONS * CHANNELS;
const SUN_END: usize = RADIANCE_END + TURBIDITIES * SUN_PIECES * WAVELENGTHS * CUBIC;
const END: usize = SUN_END + WAVELENGTHS * LIMB;

static NUMBERS: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let (words, _) = BYTES.as_chunks::<4>();
    let numbers: Vec<f64> = words.iter().map(|word| f64::from(f32::from_le_bytes(*word))).collect();
    assert_eq!(numbers.len(), END, "the file has every number");
    numbers
});

/// The six control points of a coefficient of the sky's course, or, where `number` is `None`, of its radiance.
pub(super) fn sky(
    turbidity: usize,
    albedo: usize,
    channel: usize,
    number: Option<usize>,
) -> [f64; ELEVATIONS] {
    std::array::from_fn(|elevation| {
        let at = ((turbidity * ALBEDOS + albedo) * ELEVATIONS + elevation) * CHANNELS + channel;
        match number {
            Some(number) => NUMBERS[at * SKY_NUMBERS + number],
            None => NUMBERS[COURSE_END + at],
        }
    })
}

/// The polynomial of the sun's radiance in W sr⁻¹ m⁻² nm⁻¹, over a piece of the elevation from where that begins, in
/// radians.
pub(super) fn sun(turbidity: usize, piece: usize, wavelength: usize) -> [f64; CUBIC] {
    let at = (turbidity * SUN_PIECES + piece) * WAVELENGTHS + wavelength;
    std::array::from_fn(|power| NUMBERS[RADIANCE_END + at * CUBIC + power])
}

/// The polynomial of the sun's radiance relative to its middle, over the cosine of the angle at which its surface is seen.
pub(super) fn limb(wavelength: usize) -> [f64; LIMB] {
    std::array::from_fn(|power| NUMBERS[SUN_END + wavelength * LIMB + power])
}
