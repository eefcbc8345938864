//! Times over the number of points, as an SVG file.

use crate::bench::report::Report;
use crate::errors::Failure;
use crate::stats::{Row, Spread};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

const SIZE: (u32, u32) = (800, 560);
const FONT: &str = "sans-serif";
const BUILD: RGBColor = RGBColor(0xc4, 0x4e, 0x23);
const TRACE: RGBColor = RGBColor(0x1f, 0x5f, 0xa8);

/// A line of the plot: its name and colour, and which time it shows.
type Series = (&'static str, RGBColor, fn(&Row) -> Spread);

const SERIES: [Series; 2] =
    [("build", BUILD, |row| row.build_ms), ("trace", TRACE, |row| row.trace_ms)];

/// Fails where a path is no SVG file's.
pub fn check_path(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg")) {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "{}: expected a plot's name to end in .svg; rename it",
        path.display()
    )))
}

/// The medians of build and trace over the number of points, both axes logarithmic, with bars from the
/// least to the largest time. Without rows, the axes alone.
pub fn svg(report: &Report) -> Result<String, Failure> {
    let mut text = String::new();
    draw(report, SVGBackend::with_string(&mut text, SIZE).into_drawing_area())
        .map_err(|error| Failure::exhausted(format!("the plot cannot be drawn: {error}")))?;
    Ok(text)
}

fn draw(
    report: &Report,
    area: DrawingArea<SVGBackend<'_>, Shift>,
) -> Result<(), Box<dyn Error + Send + Sync>> {
    let mut rows: Vec<&Row> = report.rows.iter().collect();
    rows.sort_by_key(|row| row.points);
    let points = decades(rows.iter().map(|row| row.points as f64));
    let times =
        decades(rows.iter().flat_map(|row| {
            SERIES.iter().flat_map(|series| [series.2(row).min, series.2(row).max])
        }));
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .x_label_area_size(48)
        .y_label_area_size(72)
        .caption(title(report), (FONT, 15))
        .build_cartesian_2d(points.log_scale(), times.log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(RGBColor(0xee, 0xee, 0xee))
        .bold_line_style(RGBColor(0xcc, 0xcc, 0xcc))
        .label_style((FONT, 14))
        .x_desc("points")
        .y_desc("ms")
        .x_label_formatter(&|x| power(*x))
        .y_label_formatter(&|y| power(*y))
        .draw()?;
    for (name, color, time) in SERIES {
        let medians = rows.iter().map(|row| (row.points as f64, time(row).median));
        chart
            .draw_series(LineSeries::new(medians.clone(), color.stroke_width(2)))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 24, y)], color.stroke_width(2)));
        chart.draw_series(medians.map(|at| Circle::new(at, 3, color.filled())))?;
        chart.draw_series(rows.iter().map(|row| {
            let (x, Spread { min, max, .. }) = (row.points as f64, time(row));
            PathElement::new([(x, min), (x, max)], color.stroke_width(1))
        }))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE)
        .border_style(RGBColor(0xcc, 0xcc, 0xcc))
        .label_font((FONT, 14))
        .draw()?;
    area.present()?;
    Ok(())
}

/// Whole powers of ten around all of some values.
fn decades(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (least, most) = values
        .filter(|value| *value > 0.0)
        .fold((f64::INFINITY, 0.0_f64), |(least, most), value| (least.min(value), most.max(value)));
    if least > most {
        return 1.0..10.0;
    }
    let [low, high] = [least.log10().floor(), most.log10().ceil()];
    10_f64.powf(low)..10_f64.powf(high.max(low + 1.0))
}

fn title(report: &Report) -> String {
    format!("{}: medians of {} frames, bars from least to largest", report.device, report.runs)
}

/// `10³` for 1000, and a plain number between powers.
fn power(value: f64) -> String {
    let exponent = value.log10().round();
    if (value / 10_f64.powf(exponent) - 1.0).abs() > 1e-6 || exponent.abs() > 99.0 {
        return format!("{value}");
    }
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = format!("{}", exponent.abs());
    let raised = digits.bytes().filter_map(|digit| DIGITS.get(usize::from(digit - b'0')));
    let minus = if exponent < 0.0 { "⁻" } else { "" };
    format!("10{minus}{}", raised.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_powers_of_ten_that_hold_all() {
        assert_eq!(decades([12.0, 150.0].into_iter()), 10.0..1000.0);
        assert_eq!(decades([10.0, 10.0].into_iter()), 10.0..100.0);
        assert_eq!(decades([0.0, 0.5].into_iter()), 0.1..1.0);
        assert_eq!(decades(std::iter::empty()), 1.0..10.0);
    }

    #[test]
    fn powers_are_raised() {
        assert_eq!(
            [1.0, 1000.0, 1e7, 1e12, 0.01, 50.0].map(power),
            ["10⁰", "10³", "10⁷", "10¹²", "10⁻²", "50"]
        );
    }
}
