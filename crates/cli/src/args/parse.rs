//! What is typed for an argument, as a value, or what was expected instead.

use super::{Channels, Exposure, Size};
use crate::input::BOX_HINT;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use plan::{Diagnostic, Extra};
use scene::ViewFrom;

/// Names what there is in the help, and the nearest in an error.
pub(super) fn channels_parser() -> impl TypedValueParser<Value = Channels> {
    let diagnostics = Diagnostic::ALL.map(|one| (one.name(), one.meaning()));
    let extras = Extra::ALL.map(|one| (one.name(), one.meaning()));
    let all = diagnostics.into_iter().chain(extras);
    let named = |(name, meaning)| PossibleValue::new(name).help(meaning);
    PossibleValuesParser::new(all.map(named)).try_map(|name| {
        let diagnostic = Diagnostic::named(&name).map(Channels::Diagnostic);
        diagnostic.or_else(|| Extra::named(&name).map(Channels::Extra)).ok_or("no channel")
    })
}

pub(super) fn view_parser() -> impl TypedValueParser<Value = ViewFrom> {
    PossibleValuesParser::new(ViewFrom::NAMES)
        .try_map(|name| ViewFrom::named(&name).ok_or("no side"))
}

pub(super) fn parse_size(text: &str) -> Result<Size, String> {
    const EXPECTED: &str = "expected WxH, two whole numbers of pixels, e.g. 640x480";
    let numbers = |separators: &[char]| -> Option<Vec<u32>> {
        text.split(separators).map(|part| part.trim().parse().ok()).collect()
    };
    if text.chars().all(|c| c.is_ascii_digit() || "xX".contains(c))
        && let Some([width, height]) = numbers(&['x', 'X']).as_deref()
    {
        return Ok(Size(*width, *height));
    }
    Err(match numbers(&[',', 'x', 'X', '*', ' ', '\u{d7}']).as_deref() {
        Some([width, height]) => format!("{EXPECTED}; write {width}x{height}"),
        Some([_]) => format!("{EXPECTED}; found a width without a height"),
        _ => EXPECTED.to_owned(),
    })
}

pub(super) fn parse_threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(threads @ 1..=1024) => Ok(threads),
        _ => Err("expected a whole number from 1 to 1024, e.g. 4".to_owned()),
    }
}

pub(super) fn parse_exposure(text: &str) -> Result<Exposure, String> {
    if text.trim() == "auto" {
        return Ok(Exposure::Auto);
    }
    match text.parse() {
        Ok(stops) if (-100.0..=100.0).contains(&stops) => Ok(Exposure::Stops(stops)),
        _ => Err("expected auto, or a number from -100 to 100, e.g. 1.5".to_owned()),
    }
}

pub(super) fn parse_percent(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(percent) if (0.0..=1e6).contains(&percent) => Ok(percent),
        _ => Err("expected a number of at least 0, e.g. 5".to_owned()),
    }
}

pub(super) fn parse_reach(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(reach) if reach > 0.0 && reach <= 0.5 => Ok(reach),
        _ => Err("expected a number of more than 0 and at most 0.5, e.g. 0.06".to_owned()),
    }
}

pub(super) fn parse_limit(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(limit) if (0.0..f64::INFINITY).contains(&limit) => Ok(limit),
        _ => Err("expected a number of at least 0, e.g. 0.001".to_owned()),
    }
}

pub(super) fn parse_flip(text: &str) -> Result<f64, String> {
    parse_limit(text).map_err(|error| {
        format!("{error}; without a limit, --flip goes after the names of both pictures")
    })
}

/// Largest coordinate that anybody means in pixels: pictures have 16384 on a side at most.
const FARTHEST_PIXEL: f64 = 65_536.0;

pub(super) fn parse_crop(text: &str) -> Result<plan::Window, String> {
    const EXPECTED: &str = "expected X,Y,W,H, four whole numbers of pixels, e.g. 100,50,320,240";
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let Some(numbers) = numbers.filter(|numbers| numbers.iter().all(|x| x.is_finite())) else {
        return Err(EXPECTED.to_owned());
    };
    let whole = |x: &f64| x.fract() == 0.0 && x.abs() <= FARTHEST_PIXEL;
    // Two corners, decimals or northings: a box in the coordinates of a file is meant.
    if numbers.len() == 6 || !numbers.iter().all(whole) {
        return Err(format!("{EXPECTED}; --crop is in pixels of the picture. {BOX_HINT}"));
    }
    let [x, y, width, height] = numbers[..] else { return Err(EXPECTED.to_owned()) };
    if numbers.iter().any(|x| *x < 0.0) {
        return Err(format!(
            "found a number below 0; the crop lies inside the picture, whose upper left pixel is 0,0; {EXPECTED}"
        ));
    }
    let pixels = |x: f64| x as u32;
    Ok(plan::Window { origin: [x, y].map(pixels), size: [width, height].map(pixels) })
}

pub(super) fn parse_samples(text: &str) -> Result<u32, String> {
    match text.trim().parse() {
        Ok(samples) if samples > 0 => Ok(samples),
        _ => Err("expected a whole number of rays a pixel, at least 1, e.g. 16".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::Arguments;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn sizes_and_crops_are_whole_numbers_and_stops_are_numbers() {
        assert_eq!(parse_size("640x480"), Ok(Size(640, 480)));
        for wrong in ["640", "640x", "640x480x2", "-1x5", "1.5x2", "640 x 480", ""] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
        let window = plan::Window { origin: [1, 2], size: [3, 4] };
        assert_eq!(parse_crop("1,2,3,4"), Ok(window));
        for wrong in ["1,2,3", "1,2,3,4,5", "a,2,3,4", "", "nan,0,1,1", "inf,0,1,1"] {
            let error = parse_crop(wrong).expect_err(wrong);
            assert!(error.contains("X,Y,W,H"), "{error}");
        }
        for negative in ["-1,0,5,5", "0,-3,5,5", "0,0,5,-5"] {
            let error = parse_crop(negative).expect_err(negative);
            assert!(error.contains("inside the picture") && error.contains("0,0"), "{error}");
        }
        for of_file in ["0.5,0,5,5", "500000,4000000,100,100", "1,2,3,4,5,6", "-1.5,-2.5,3.5,4.5"] {
            let error = parse_crop(of_file).expect_err(of_file);
            assert!(error.contains("objects.0.filter.box") && error.contains("pixels"), "{error}");
        }
        for (wrong, word) in [("640,480", "write 640x480"), ("640", "without a height")] {
            let error = parse_size(wrong).expect_err(wrong);
            assert!(error.contains(word), "{error}");
        }
        assert_eq!(parse_samples("16"), Ok(16));
        for wrong in ["1.5", "0", "-3", "many", ""] {
            let error = parse_samples(wrong).expect_err(wrong);
            assert!(error.contains("whole number") && error.contains("at least 1"), "{error}");
        }
        assert_eq!(parse_limit("1e-3"), Ok(0.001));
        for wrong in ["", "-1", "nan", "inf", "1e999", "0,5"] {
            assert!(parse_limit(wrong).is_err(), "{wrong}");
        }
        assert_eq!(parse_exposure("-1.5"), Ok(Exposure::Stops(-1.5)));
        assert_eq!(parse_exposure("auto"), Ok(Exposure::Auto));
        for wrong in ["", "bright", "nan", "inf", "101"] {
            assert!(parse_exposure(wrong).is_err(), "{wrong}");
        }
    }
}
