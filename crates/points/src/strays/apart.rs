//! The words about strays.

use std::fmt;

/// The strays of a set of points, in words that a message needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Apart {
    /// How many there are.
    pub count: u64,
    /// Whether these were counted; of files that are not held, only about so many.
    pub is_counted: bool,
    /// Of how many points.
    pub of: u64,
    /// How far the farthest lies from the box around all others, in units of the positions; 0 where none lies outside.
    pub farthest: f64,
    /// The longest side of that box.
    pub size: f64,
    /// Whether they are particles, of a volume or drawn one by one, and carry no surface.
    pub is_volume: bool,
    /// Whether those that lie near the others are drawn, small.
    pub is_drawn: bool,
    /// The option of the command line that leaves out those that lie outside it, if any do.
    pub filter: Option<String>,
}

impl fmt::Display for Apart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, is_counted, of, farthest, size, is_volume, is_drawn, filter } = self;
        let about = if *is_counted { "" } else { "about " };
        let (lie, they, show, count_not, are) = match count {
            1 => ("lies", "it", "shows", "does", "is"),
            _ => ("lie", "they", "show", "do", "are"),
        };
        write!(f, "{about}{count} of {of} points {lie} far from all others")?;
        if *farthest > 0.0 {
            let [farthest, size] = [short(*farthest), short(*size)];
            write!(f, ", up to {farthest} outside the rest, which is {size} wide")?;
        }
        match is_volume {
            false if *is_drawn => write!(
                f,
                "; {they} {are} drawn small if no farther off than the rest is wide, and {count_not} not count for the view"
            )?,
            false => {
                write!(f, "; {they} {show} no surface and {count_not} not count for the view")?
            }
            true => write!(
                f,
                "; {they} {count_not} not count for the view; what lies farther off than the rest is wide is not \
                 drawn either"
            )?,
        }
        match filter {
            Some(filter) => write!(f, "; {filter} leaves out what lies outside"),
            None => Ok(()),
        }
    }
}

/// A length to three digits, without an exponent where it needs none.
fn short(length: f64) -> String {
    let exponent = length.abs().log10().floor();
    match (-4.0..=6.0).contains(&exponent) {
        true => format!("{length:.*}", (2.0 - exponent).max(0.0) as usize),
        false => format!("{length:.2e}"),
    }
}

/// The longest side of a box.
pub(crate) fn size_of([low, high]: [[f64; 3]; 2]) -> f64 {
    (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max)
}

/// The option of the command line that leaves out what of an object lies outside a box, in the coordinates of its file.
pub(crate) fn filter(object: usize, [low, high]: [[f64; 3]; 2]) -> String {
    // Outwards to three digits of the size, so that the numbers are short.
    let size = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    // Of degrees beside metres, each axis has a size of its own.
    let size_of = |axis: usize| match high[axis] - low[axis] {
        own if own > 0.0 && own < 1e-2 * size => own,
        _ => size,
    };
    let corner = |corner: [f64; 3], round: fn(f64) -> f64| {
        let rounded = [0, 1, 2].map(|axis| {
            let size = size_of(axis);
            let step =
                if size > 0.0 { 10f64.powf(size.log10().floor() - 2.0) } else { f64::EPSILON };
            let digits = (-step.log10().round()).clamp(0.0, 300.0) as usize;
            format!("{:.digits$}", round(corner[axis] / step) * step)
        });
        rounded.join(", ")
    };
    format!(
        "--set 'objects.{object}.filter.box={{ min = [{}], max = [{}] }}'",
        corner(low, f64::floor),
        corner(high, f64::ceil)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_short() {
        let of = [6.905_1, 590.14, 4.627e6, 1e30, 0.004_29, 2.0, 1e-9, 123_456.0].map(short);
        assert_eq!(
            of,
            ["6.91", "590", "4627000", "1.00e30", "0.00429", "2.00", "1.00e-9", "123456"]
        );
    }

    #[test]
    fn the_line_says_how_many_lie_how_far_off() {
        let one = Apart {
            is_counted: true,
            count: 1,
            of: 501,
            farthest: 590.1,
            size: 2.0,
            is_volume: false,
            is_drawn: false,
            filter: Some("F".into()),
        };
        assert_eq!(
            one.to_string(),
            "1 of 501 points lies far from all others, up to 590 outside the rest, which is 2.00 wide; it shows \
             no surface and does not count for the view; F leaves out what lies outside"
        );
        let volume = Apart { is_volume: true, ..one.clone() };
        assert_eq!(
            volume.to_string(),
            "1 of 501 points lies far from all others, up to 590 outside the rest, which is 2.00 wide; it does not \
             count for the view; what lies farther off than the rest is wide is not drawn either; F leaves out what lies outside"
        );
        let inside = Apart { count: 3, farthest: 0.0, filter: None, ..one };
        assert_eq!(
            inside.to_string(),
            "3 of 501 points lie far from all others; they show no surface and do not count for the view"
        );
    }
}
