//! Transfer functions as kernels take them: stops, and integrals up to each (docs/method.md, section 7).

use crate::colors::{counts_in_range, mapped};
use kernels::layout::VolumeStop;
use scene::{ColorMap, Scale, Transfer};

/// Stops that a map of colours becomes.
const MAP_STOPS: u32 = 65;

/// The transfer function of a volume that has none.
const NO_STOP: VolumeStop = stop_at(0.0, [0.8; 3], 0.0, [0.0; 3]);

/// A stop without its integrals.
const fn stop_at(value: f32, color: [f32; 3], extinction: f32, emission: [f32; 3]) -> VolumeStop {
    VolumeStop {
        color,
        extinction,
        value,
        emission,
        scattering_integral: [0.0; 4],
        scattering_rest: [0.0; 4],
        emission_integral: [0.0; 4],
        emission_rest: [0.0; 4],
    }
}

/// A transfer function as stops. `own` is the range of the data, for one that has none.
pub(crate) fn stops_of(
    transfer: Option<&Transfer>,
    scale: Scale,
    own: impl Fn() -> [f64; 2],
) -> Vec<VolumeStop> {
    with_integrals(match transfer {
        None => vec![NO_STOP],
        Some(Transfer::Stops(stops)) => stops
            .iter()
            .map(|stop| {
                let [color, emission] = [stop.color, stop.emission].map(|of| of.map(|c| c as f32));
                stop_at(stop.value as f32, color, stop.extinction as f32, emission)
            })
            .collect(),
        Some(Transfer::Map { color_map, range, extinction }) => {
            map_stops(*color_map, range.unwrap_or_else(own), *extinction, scale)
        }
    })
}

/// The stops with the integrals from the first to each, which are made of what kernels have of the stops: in f64, as
/// two numbers of 32 bits.
fn with_integrals(mut stops: Vec<VolumeStop>) -> Vec<VolumeStop> {
    let mut sums = [0.0f64; 7];
    for at in 1..stops.len() {
        let (from, to) = (stops[at - 1], stops[at]);
        let width = f64::from(to.value) - f64::from(from.value);
        let [extinction_from, extinction_to] = [from, to].map(|stop| f64::from(stop.extinction));
        for channel in 0..3 {
            let [a, b] = [from, to].map(|stop| f64::from(stop.color[channel]));
            // Of the product of two linear functions.
            let ends = a * extinction_from + b * extinction_to;
            sums[channel] += width * (2.0 * ends + a * extinction_to + b * extinction_from) / 6.0;
            let [a, b] = [from, to].map(|stop| f64::from(stop.emission[channel]));
            sums[4 + channel] += width * 0.5 * (a + b);
        }
        sums[3] += width * 0.5 * (extinction_from + extinction_to);
        let highs = sums.map(|sum| sum.min(f64::from(f32::MAX)) as f32);
        let rests = [0, 1, 2, 3, 4, 5, 6].map(|i| {
            let rest = sums[i] - f64::from(highs[i]);
            if highs[i] < f32::MAX { rest as f32 } else { 0.0 }
        });
        let [r, g, b, s, x, y, z] = highs;
        (stops[at].scattering_integral, stops[at].emission_integral) =
            ([r, g, b, s], [x, y, z, 0.0]);
        let [r, g, b, s, x, y, z] = rests;
        (stops[at].scattering_rest, stops[at].emission_rest) = ([r, g, b, s], [x, y, z, 0.0]);
    }
    stops
}

/// The same stops with all extinctions multiplied.
pub(crate) fn scaled(mut stops: Vec<VolumeStop>, factor: f64) -> Vec<VolumeStop> {
    for stop in &mut stops {
        stop.extinction = (f64::from(stop.extinction) * factor) as f32;
    }
    with_integrals(stops)
}

/// From the lowest scalar to the highest; on a logarithmic scale, from the lowest positive one, and `None` without any.
pub(crate) fn own_range(scalars: &[f64], scale: Scale) -> Option<[f64; 2]> {
    let counts = |scalar: f64| (scalar as f32).is_finite() && counts_in_range(scalar, scale);
    let finite = || scalars.iter().copied().filter(|scalar| counts(*scalar));
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    match (low <= high, scale) {
        (true, _) => Some([low, high]),
        (false, Scale::Linear) => Some([0.0, 1.0]),
        (false, Scale::Log) => None,
    }
}

/// Even stops on a map; the middle of the map alone where all scalars are one. Between stops kernels are linear, so on a
/// logarithmic scale there are 16 a decade at least.
fn map_stops(
    map: ColorMap,
    [low, high]: [f64; 2],
    extinction: [f64; 2],
    scale: Scale,
) -> Vec<VolumeStop> {
    // Scalars are f32.
    let least = f64::from(f32::MIN_POSITIVE);
    let [low, high] = match scale {
        Scale::Linear => [low, high],
        Scale::Log => [low.max(least), high.max(least)],
    };
    let stop = |part: f64| {
        let extinction = extinction[0] + part * (extinction[1] - extinction[0]);
        let value = match scale {
            Scale::Linear => low + part * (high - low),
            Scale::Log => (low.ln() + part * (high.ln() - low.ln())).exp(),
        };
        stop_at(value as f32, mapped(map, part), extinction as f32, [0.0; 3])
    };
    if low >= high {
        return vec![stop(0.5)];
    }
    let count = match scale {
        Scale::Linear => MAP_STOPS,
        Scale::Log => MAP_STOPS.max((16.0 * (high / low).log10()).ceil() as u32 + 1),
    };
    (0..count).map(|i| stop(f64::from(i) / f64::from(count - 1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Stop;

    /// Of the product of two linear functions, by Simpson's rule, which is exact for cubics; and the two numbers hold
    /// it to 2^-47.
    #[test]
    fn integrals_are_those_of_the_function() {
        let stop = |value: f64, red: f64, extinction, emission| Stop {
            value,
            color: [red, 0.5, 0.0],
            extinction,
            emission: [emission, 0.0, 1.0],
        };
        let given = [
            stop(0.0, 0.2, 1e4, 0.0),
            stop(0.25, 1.0, 0.0, 3.0),
            stop(0.25, 0.0, 1e-9, 7.0),
            stop(2.0, 0.7, 3e-10, 0.125),
        ];
        let stops = stops_of(Some(&Transfer::Stops(given.to_vec())), Scale::Linear, || [0.0, 1.0]);
        let mut sums = [0.0f64; 3];
        for at in 1..stops.len() {
            let (from, to) = (&stops[at - 1], &stops[at]);
            let width = f64::from(to.value) - f64::from(from.value);
            let of = |part: f64| {
                let mix = |a: f32, b: f32| f64::from(a) + part * (f64::from(b) - f64::from(a));
                let extinction = mix(from.extinction, to.extinction);
                let red = mix(from.color[0], to.color[0]);
                [red * extinction, extinction, mix(from.emission[0], to.emission[0])]
            };
            let (low, middle, high) = (of(0.0), of(0.5), of(1.0));
            for i in 0..3 {
                sums[i] += width * (low[i] + 4.0 * middle[i] + high[i]) / 6.0;
            }
            let found = [
                (to.scattering_integral[0], to.scattering_rest[0]),
                (to.scattering_integral[3], to.scattering_rest[3]),
                (to.emission_integral[0], to.emission_rest[0]),
            ];
            for ((high, rest), sum) in found.into_iter().zip(sums) {
                let found = f64::from(high) + f64::from(rest);
                assert!((found - sum).abs() <= 2f64.powi(-47) * sum, "{found} for {sum}");
            }
        }
    }
}
