//! Legends: what the colours of a picture mean, as a picture of their own.

use crate::canvas::{Canvas, Color, Pen};
use crate::error::FilmError;
use crate::srgb::srgb_byte;

/// One map of colours with its range.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorBar {
    /// What is shown, such as the name of an attribute.
    pub title: String,
    /// Whose it is, where there are several.
    pub subtitle: Option<String>,
    /// Linear colours, evenly from the lower value to the upper one; at least one.
    pub colors: Vec<[f32; 3]>,
    /// The values at both ends, ascending; positive where the scale is logarithmic.
    pub range: [f64; 2],
    /// Whether values lie along the bar by their logarithms.
    pub is_log: bool,
}

/// Rows and columns of a bar, without its frame.
const BAR: [i64; 2] = [28, 360];
/// Between what is drawn and the edge, and between bars.
const MARGIN: i64 = 20;
const TICK: i64 = 6;
const MINOR_TICK: i64 = 3;
const TEXT: f32 = 17.0;
/// Rows of a line of text.
const LINE: i64 = 22;
const INK: Color = [32; 3];
const PAPER: Color = [255; 3];
/// Labels of a bar at most, and at least where round numbers allow it.
const MOST_LABELS: f64 = 8.0;
/// Of a bar: how far labels are from each other at least.
const APART: f64 = 0.055;

/// A label at a place of a bar.
#[derive(Debug, Clone, PartialEq)]
struct Mark {
    /// 0 at the lower end, 1 at the upper one.
    place: f64,
    /// Empty for a tick without a label.
    label: String,
}

/// Draws bars beside each other, each with its title, and labels at round numbers.
///
/// # Panics
/// If there is no bar, or one has no colour.
///
/// # Errors
/// [`FilmError::Font`] in a damaged program.
pub fn legend(bars: &[ColorBar]) -> Result<Canvas, FilmError> {
    assert!(!bars.is_empty(), "legend: a bar");
    let pen = Pen::new()?;
    let drawn: Vec<(Vec<String>, Vec<Mark>)> =
        bars.iter().map(|bar| (lines(bar), marks(bar.range, bar.is_log))).collect();
    let width = |texts: &mut dyn Iterator<Item = &String>| {
        texts.map(|text| pen.width(text, TEXT).ceil() as i64).max().unwrap_or(0)
    };
    let widths: Vec<i64> = (drawn.iter())
        .map(|(lines, marks)| {
            let labels = width(&mut marks.iter().map(|mark| &mark.label));
            (BAR[0] + 2 * TICK + labels).max(width(&mut lines.iter()))
        })
        .collect();
    let rows = drawn.iter().map(|(lines, _)| lines.len() as i64).max().unwrap_or(0);
    let top = MARGIN + rows * LINE + LINE / 2;
    let total = widths.iter().sum::<i64>() + MARGIN * (widths.len() as i64 + 1);
    let mut canvas = Canvas::new([total as u32, (top + BAR[1] + MARGIN) as u32], PAPER);
    let mut left = MARGIN;
    for ((bar, (lines, marks)), width) in bars.iter().zip(&drawn).zip(&widths) {
        for (line, row) in lines.iter().zip(0..) {
            let base = (MARGIN + row * LINE) as f32 + TEXT;
            canvas.text(&pen, line, [left as f32, base], TEXT, INK);
        }
        draw_bar(&mut canvas, &pen, bar, marks, [left, top]);
        left += width + MARGIN;
    }
    Ok(canvas)
}

fn draw_bar(canvas: &mut Canvas, pen: &Pen, bar: &ColorBar, marks: &[Mark], [left, top]: [i64; 2]) {
    canvas.fill([left - 1, top - 1], [BAR[0] + 2, BAR[1] + 2], INK);
    for row in 0..BAR[1] {
        // The middle of a row, from below.
        let part = 1.0 - (row as f64 + 0.5) / BAR[1] as f64;
        canvas.fill([left, top + row], [BAR[0], 1], color_at(&bar.colors, part));
    }
    for mark in marks {
        let row = top + ((1.0 - mark.place) * (BAR[1] - 1) as f64).round() as i64;
        let length = if mark.label.is_empty() { MINOR_TICK } else { TICK };
        canvas.fill([left + BAR[0] + 1, row], [length, 1], INK);
        let place = [(left + BAR[0] + 2 * TICK) as f32, row as f32 + 0.33 * TEXT];
        canvas.text(pen, &mark.label, place, TEXT, INK);
    }
}

/// The nearest of even colours, in sRGB.
fn color_at(colors: &[[f32; 3]], part: f64) -> Color {
    let last = colors.len() - 1;
    colors[((part * last as f64).round() as usize).min(last)].map(srgb_byte)
}

fn lines(bar: &ColorBar) -> Vec<String> {
    let scale = bar.is_log.then(|| "log scale".to_owned());
    std::iter::once(bar.title.clone()).chain(bar.subtitle.clone()).chain(scale).collect()
}

/// Ticks at round numbers.
fn marks([low, high]: [f64; 2], is_log: bool) -> Vec<Mark> {
    if low >= high {
        return vec![Mark { place: 0.5, label: short(low) }];
    }
    let round = if is_log { log_marks([low, high]) } else { linear_marks([low, high]) };
    with_ends(round, [low, high])
}

/// The same with both ends of the range, where a round number is not there already. A label that is in the way of an end's
/// gives way, and its tick stays.
fn with_ends(mut marks: Vec<Mark>, range: [f64; 2]) -> Vec<Mark> {
    for (value, place) in range.into_iter().zip([0.0, 1.0]) {
        let is_there = |mark: &Mark| !mark.label.is_empty() && (mark.place - place).abs() < 1e-6;
        if marks.iter().any(is_there) {
            continue;
        }
        for mark in marks.iter_mut().filter(|mark| (mark.place - place).abs() < APART) {
            mark.label.clear();
        }
        marks.push(Mark { place, label: end_label(value, range) });
    }
    marks.sort_by(|a, b| a.place.total_cmp(&b.place));
    marks
}

/// An end of a range, in as many digits as it takes to see it beside the other.
fn end_label(value: f64, [low, high]: [f64; 2]) -> String {
    let size = low.abs().max(high.abs());
    // Four digits of the range, or of the value where that is little of it.
    let step = 10f64.powf((high - low).log10().floor() - 3.0);
    if !(step.is_finite() && step > 0.0 && (1e-4..1e7).contains(&size)) {
        return short(value);
    }
    let decimals = (-step.log10()).round().clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    match text.trim_start_matches(['-', '0', '.']).is_empty() {
        true if value == 0.0 => "0".to_owned(),
        true => short(value),
        false => minus(text.to_owned()),
    }
}

/// The largest of 1, 2 and 5 times a power of ten that leaves no more labels than there is room for, from a spacing on.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    steps.into_iter().find(|&step| step >= least * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

fn linear_marks([low, high]: [f64; 2]) -> Vec<Mark> {
    let span = 0.5 * high - 0.5 * low; // half of it, which is finite
    let step = round_step(span / (0.5 * MOST_LABELS));
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    if !(step > 0.0 && first.abs().max(last.abs()) < 1e15) {
        // Closer together than numbers are.
        return [low, high]
            .iter()
            .zip([0.0, 1.0])
            .map(|(x, place)| Mark { place, label: short(*x) })
            .collect();
    }
    let largest = low.abs().max(high.abs());
    let count = (last - first) as i64;
    let label = |at: f64| labeled(at, step, largest);
    (0..=count)
        .map(|i| {
            let value = (first + i as f64) * step;
            let place = ((0.5 * value - 0.5 * low) / span).clamp(0.0, 1.0);
            Mark { place, label: label(value) }
        })
        .collect()
}

/// A multiple of a step, with as many decimals as the step has.
fn labeled(value: f64, step: f64, largest: f64) -> String {
    let value = if value.abs() < 0.5 * step { 0.0 } else { value };
    let decimals = (-step.log10() - 1e-9).ceil().max(0.0) as usize;
    match largest < 1e7 && decimals <= 6 {
        true => minus(format!("{value:.decimals$}")),
        // As many digits as tell the steps apart.
        false if value == 0.0 => "0".to_owned(),
        false => {
            let digits = (value.abs().log10().floor() - step.log10().floor()).clamp(0.0, 15.0);
            powered(value, digits as usize)
        }
    }
}

fn log_marks([low, high]: [f64; 2]) -> Vec<Mark> {
    let (from, to) = (low.log10(), high.log10());
    let place = |value: f64| (value.log10() - from) / (to - from);
    // Few decades have labels between, many not at each.
    let (labels, every): (&[f64], i64) = match to - from {
        span if span < 1.0 => return narrow_log_marks([low, high]),
        span if span <= 2.5 => (&[1.0, 2.0, 5.0], 1),
        span => (&[1.0], (span / MOST_LABELS).ceil() as i64),
    };
    let mut marks = Vec::new();
    for power in from.floor() as i64..=to.ceil() as i64 {
        for digit in 1..10 {
            let digit = f64::from(digit);
            let place = place(digit * 10f64.powi(power as i32));
            if !(-1e-9..=1.0 + 1e-9).contains(&place) {
                continue;
            }
            let is_labeled = labels.contains(&digit) && power.rem_euclid(every) == 0;
            let is_tick = digit == 1.0 || to - from <= MOST_LABELS;
            if is_labeled || is_tick {
                let label = if is_labeled { power_label(digit, power) } else { String::new() };
                marks.push(Mark { place: place.clamp(0.0, 1.0), label });
            }
        }
    }
    marks
}

/// Within less than a decade, round numbers as on a linear scale, at their logarithms.
fn narrow_log_marks([low, high]: [f64; 2]) -> Vec<Mark> {
    let (from, to) = (low.ln(), high.ln());
    let linear = linear_marks([low, high]);
    let at = |mark: Mark| {
        let value = low + mark.place * (high - low);
        Mark { place: ((value.ln() - from) / (to - from)).clamp(0.0, 1.0), ..mark }
    };
    linear.into_iter().map(at).collect()
}

/// `digit` times ten to a power.
fn power_label(digit: f64, power: i64) -> String {
    match power {
        -3..=4 => {
            let decimals = (-power).max(0) as usize;
            format!("{:.decimals$}", digit * 10f64.powi(power as i32))
        }
        _ if digit == 1.0 => format!("10{}", raised(power)),
        _ => format!("{digit}⋅10{}", raised(power)),
    }
}

/// Only a number, in six digits.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        1e-4..1e7 => {
            let digits = 5.0 - value.abs().log10().floor();
            let text = format!("{value:.0$}", digits.clamp(0.0, 9.0) as usize);
            let text = if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.')
            } else {
                &text
            };
            minus(text.to_owned())
        }
        _ => powered(value, 5),
    }
}

/// 1.25⋅10⁸, without zeros at the end.
fn powered(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = match mantissa.contains('.') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.'),
        false => mantissa,
    };
    minus(format!("{mantissa}⋅10{}", raised(power.parse().unwrap_or(0))))
}

/// A whole number above the line.
fn raised(number: i64) -> String {
    let above = |letter: char| match letter {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' => '⁰',
        _ => letter.to_digit(10).and_then(|digit| char::from_u32(0x2070 + digit)).unwrap_or(letter),
    };
    number.to_string().chars().map(above).collect()
}

fn minus(text: String) -> String {
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(range: [f64; 2], is_log: bool) -> Vec<String> {
        marks(range, is_log)
            .into_iter()
            .map(|mark| mark.label)
            .filter(|label| !label.is_empty())
            .collect()
    }

    #[test]
    fn labels_are_round_numbers() {
        let cases: [([f64; 2], &[&str]); 9] = [
            ([0.0, 1.0], &["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]),
            ([-3.0, 12.0], &["−3", "−2", "0", "2", "4", "6", "8", "10", "12"]),
            ([203.7, 291.2], &["203.7", "220", "240", "260", "280", "291.2"]),
            ([0.013, 0.0171], &["0.013", "0.014", "0.015", "0.016", "0.0171"]),
            ([-0.000_123_456, 0.998_812], &["−0.0001", "0.2", "0.4", "0.6", "0.8", "0.9988"]),
            (
                [412_345.6, 412_345.9],
                &[
                    "412345.60",
                    "412345.65",
                    "412345.70",
                    "412345.75",
                    "412345.80",
                    "412345.85",
                    "412345.90",
                ],
            ),
            (
                [0.0, 65_535.0],
                &["0", "10000", "20000", "30000", "40000", "50000", "60000", "65535"],
            ),
            ([0.0, 3e9], &["0", "5⋅10⁸", "1⋅10⁹", "1.5⋅10⁹", "2⋅10⁹", "2.5⋅10⁹", "3⋅10⁹"]),
            ([7.25, 7.25], &["7.25"]),
        ];
        for (range, expected) in cases {
            assert_eq!(labels(range, false), expected, "{range:?}");
        }
    }

    #[test]
    fn logarithmic_labels_are_powers_of_ten() {
        let cases: [([f64; 2], &[&str]); 6] = [
            ([1e-4, 1e4], &["10⁻⁴", "0.001", "0.01", "0.1", "1", "10", "100", "1000", "10000"]),
            ([0.5, 60.0], &["0.5", "1", "2", "5", "10", "20", "60"]),
            ([1.2e-4, 3.8e-3], &["0.00012", "2⋅10⁻⁴", "5⋅10⁻⁴", "0.001", "0.002", "0.0038"]),
            ([2.1, 7.9], &["2.1", "3", "4", "5", "6", "7", "7.9"]),
            ([1e-30, 1e-12], &["10⁻³⁰", "10⁻²⁷", "10⁻²⁴", "10⁻²¹", "10⁻¹⁸", "10⁻¹⁵", "10⁻¹²"]),
            ([3.0, 3.0], &["3"]),
        ];
        for (range, expected) in cases {
            assert_eq!(labels(range, true), expected, "{range:?}");
        }
        let places: Vec<f64> = marks([1.0, 1000.0], true).iter().map(|mark| mark.place).collect();
        assert_eq!(places.len(), 28);
        assert!(places.windows(2).all(|pair| pair[0] < pair[1]));
        assert!((places[9] - 1.0 / 3.0).abs() < 1e-12, "10 is a third of the way");
    }

    /// Labels and ticks for whatever a file may hold; none overlap.
    #[test]
    fn any_range_has_labels_that_do_not_overlap() {
        let ends = [
            -1e300,
            -1e15,
            -5.5,
            -1e-9,
            0.0,
            1e-300,
            1e-9,
            0.3,
            1.0,
            1.000_000_000_1,
            77.0,
            1e7,
            1e15,
            1e300,
        ];
        for low in ends {
            for high in ends.into_iter().filter(|&high| high >= low) {
                for is_log in [false, true] {
                    if is_log && low <= 0.0 {
                        continue;
                    }
                    let marks = marks([low, high], is_log);
                    let labeled: Vec<&Mark> =
                        marks.iter().filter(|mark| !mark.label.is_empty()).collect();
                    assert!(
                        !labeled.is_empty() && labeled.len() <= 20,
                        "{low} {high} {is_log}: {labeled:?}"
                    );
                    assert!(
                        labeled.iter().all(|mark| (0.0..=1.0).contains(&mark.place)),
                        "{low} {high}: {labeled:?}"
                    );
                    // 17 rows of text in 360.
                    let near = |pair: &[&Mark]| pair[1].place - pair[0].place < 0.045;
                    assert!(!labeled.windows(2).any(near), "{low} {high} {is_log}: {labeled:?}");
                }
            }
        }
    }

    fn bar(colors: Vec<[f32; 3]>) -> ColorBar {
        ColorBar {
            title: "density".to_owned(),
            subtitle: None,
            colors,
            range: [0.0, 1.0],
            is_log: false,
        }
    }

    #[test]
    fn a_bar_runs_from_the_lower_end_below_to_the_upper_one() {
        let colors = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let canvas = legend(&[bar(colors.clone())]).expect("a legend");
        let [width, height] = canvas.size().map(|side| side as usize);
        let column: Vec<Color> =
            (0..height).map(|y| canvas.pixels()[y * width + MARGIN as usize + 10]).collect();
        let rows = |color: Color| column.iter().filter(|found| **found == color).count();
        assert_eq!([rows([255, 0, 0]), rows([0, 255, 0]), rows([0, 0, 255])], [90, 180, 90]);
        let first = |color: Color| column.iter().position(|found| *found == color);
        assert!(first([0, 0, 255]) < first([0, 255, 0]) && first([0, 255, 0]) < first([255, 0, 0]));
        // Two are wider, as high, and begin alike.
        let two = legend(&[bar(colors.clone()), bar(colors)]).expect("a legend");
        assert_eq!(two.size()[1] as usize, height);
        assert!(two.size()[0] as usize > 2 * width - 2 * MARGIN as usize);
    }
}
