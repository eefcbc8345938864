//! The exposure at which a picture's subject is mid-grey.

use crate::picture::Film;
use rayon::prelude::*;

/// Mean luminance of the subject, linear.
const MID_GREY: f64 = 0.18;
/// Of the pixels, the brightest: specks of light say nothing about the rest.
const SPECKS: f64 = 1e-3;
/// Coverage from which on a pixel shows the subject.
const COVERED: f32 = 0.5;
/// Steps of a stop that an exposure is rounded to, so that it can be typed.
const STEPS: f64 = 1000.0;
/// Pixels that one thread takes at once: most pictures are done before another has begun.
const PART: usize = 1 << 20;
/// Largest exposure either way, in stops.
const FARTHEST: f64 = 100.0;

/// The exposure in stops, rounded to thousandths, at which the arithmetic mean of the subject's luminance (linear, Rec. 709) is
/// 0.18. The subject is what is lit of the pixels that are covered by half or more, but for those that show an object, by its
/// index, that `is_beside` it; the brightest thousandth of these does not count. `None` where nothing lit is seen.
#[must_use]
pub fn mid_grey_exposure(film: &Film, is_beside: &(dyn Fn(usize) -> bool + Sync)) -> Option<f64> {
    let luminance = |(&[r, g, b, alpha], &object): (&[f32; 4], &f32)| {
        let beside = object >= 0.0 && is_beside(object as usize);
        // A transparent film is multiplied by its coverage.
        let by = if film.transparent { f64::from(alpha) } else { 1.0 };
        let [r, g, b] = [r, g, b].map(f64::from);
        let luminance = (0.2126 * r + 0.7152 * g + 0.0722 * b) / by;
        let counts = alpha >= COVERED && !beside && luminance > 0.0 && luminance.is_finite();
        counts.then_some(luminance)
    };
    let pixels = film.color.par_iter().zip(&film.object).with_min_len(PART);
    let mut lit: Vec<f64> = pixels.filter_map(luminance).collect();
    let specks = (lit.len() as f64 * SPECKS) as usize;
    let count = lit.len().checked_sub(specks).filter(|count| *count > 0)?;
    if specks > 0 {
        lit.select_nth_unstable_by(count, f64::total_cmp);
        lit.truncate(count);
    }
    let mean = lit.iter().sum::<f64>() / lit.len() as f64;
    let stops = (MID_GREY / mean).log2().clamp(-FARTHEST, FARTHEST);
    Some((stops * STEPS).round() / STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Window;

    /// Two objects side by side before a bright background.
    fn film(luminances: [f32; 2]) -> Film {
        let size = [40, 30];
        let mut film = Film::empty(size, Window::whole(size), false);
        for (at, (color, object)) in film.color.iter_mut().zip(&mut film.object).enumerate() {
            match at % 40 {
                0..10 => (*color, *object) = ([luminances[0]; 3].covered(), 0.0),
                10..20 => (*color, *object) = ([luminances[1]; 3].covered(), 1.0),
                _ => *color = [9.0, 9.0, 9.0, 0.0],
            }
        }
        film
    }

    trait Covered {
        fn covered(self) -> [f32; 4];
    }

    impl Covered for [f32; 3] {
        fn covered(self) -> [f32; 4] {
            [self[0], self[1], self[2], 1.0]
        }
    }

    fn of_all(film: &Film) -> Option<f64> {
        mid_grey_exposure(film, &|_| false)
    }

    /// 0.18 is 0.045 two stops up, to the half thousandth that exposures are rounded by.
    #[test]
    fn the_subject_becomes_mid_grey_whatever_is_beside_it() {
        let whole = film([0.03, 0.06]);
        assert_eq!(of_all(&whole), Some(2.0));
        assert_eq!(mid_grey_exposure(&whole, &|object| object == 1), Some(2.585));
        // What is unlit takes no part.
        assert_eq!(of_all(&film([0.045, 0.0])), Some(2.0));
        assert_eq!(of_all(&film([0.0, 0.0])), None);
        assert_eq!(mid_grey_exposure(&whole, &|_| true), None);
    }

    #[test]
    fn colors_count_by_their_luminance_and_transparent_ones_by_what_they_are_over_nothing() {
        let mut film = film([0.09, 0.09]);
        film.color.iter_mut().for_each(|color| *color = [0.0, 0.09, 0.0, 1.0]);
        assert_eq!(of_all(&film), Some(((2.0f64 / 0.7152).log2() * 1000.0).round() / 1000.0));
        film.transparent = true;
        film.color.iter_mut().for_each(|color| *color = [0.045, 0.045, 0.045, 0.5]);
        assert_eq!(of_all(&film), Some(1.0));
    }

    /// A pixel of 600 is less than a thousandth, and one of 1200 is not.
    #[test]
    fn a_speck_in_a_thousand_pixels_says_nothing() {
        let mut film = film([0.09, 0.09]);
        film.color.iter_mut().for_each(|color| *color = [0.09; 3].covered());
        film.color[7] = [1e6; 3].covered();
        assert_eq!(of_all(&film), Some(1.0));
        film.color[8] = [1e6; 3].covered();
        assert!(of_all(&film).is_some_and(|stops| stops < -10.0));
    }
}
