//! Environments that are made rather than read: skies and gradients.

use crate::PlanError;
use crate::sky;
use film::{Image, Texels};
use scene::{Background, Light};
use std::f64::consts::PI;
use std::sync::Arc;

/// Rows of the image of a gradient: so many that the bilinear lookup between them errs by less than 1e-5 of the
/// difference of its ends.
const ROWS: u32 = 512;

/// The image of a background that is neither a colour nor a file, in the environment's own frame, and what it is called in
/// messages. It is turned like any other.
///
/// # Errors
/// A sun that is below the horizon where up is the camera's `up`.
pub(crate) fn made_image(
    background: &Background,
    up: [f64; 3],
) -> Result<Option<(Arc<Image>, &'static str)>, PlanError> {
    if let Some(sky) = &background.sky {
        return Ok(Some((sky::image(sky, up)?, "background.sky")));
    }
    Ok(background.gradient.map(|ends| (gradient(ends), "background.gradient")))
}

/// The sun of a background that has one, as a light of the world, where up is the camera's `up`.
pub(crate) fn sun_of(background: &Background, up: [f64; 3]) -> Option<Light> {
    background.sky.as_ref().and_then(|sky| sky::sun(sky, up))
}

/// One column, since it is the same all around.
fn gradient([down, up]: [[f64; 3]; 2]) -> Arc<Image> {
    let row = |row: u32| {
        let height = (PI * (f64::from(row) + 0.5) / f64::from(ROWS)).cos();
        let share = sky::smooth(0.5 + 0.5 * height);
        [0, 1, 2].map(|i| (down[i] + share * (up[i] - down[i])) as f32)
    };
    let texels = Texels::Linear((0..ROWS).map(row).collect());
    Arc::new(Image { width: 1, height: ROWS, texels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Sky;

    /// Straight down and up within the half row that the outer rows' middles are off, in whose square the course begins
    /// (3 t² with t = 2.4e-6); halfway at the horizon.
    #[test]
    fn a_gradient_has_its_ends_and_the_middle_between_them() {
        let ends = [[0.0, 0.25, 3.0], [1.0, 0.75, 1.0]];
        let background = Background { gradient: Some(ends), ..Background::default() };
        let (image, name) = made_image(&background, [0.0, 1.0, 0.0]).unwrap().unwrap();
        assert_eq!((name, image.width, image.height), ("background.gradient", 1, 512));
        let Texels::Linear(texels) = &image.texels else { panic!("a gradient is linear") };
        for i in 0..3 {
            assert!((f64::from(texels[0][i]) - ends[1][i]).abs() < 1e-6);
            assert!((f64::from(texels[511][i]) - ends[0][i]).abs() < 1e-6);
            let middle = 0.5 * (texels[255][i] + texels[256][i]);
            assert!((f64::from(middle) - 0.5 * (ends[0][i] + ends[1][i])).abs() < 1e-6);
        }
    }

    #[test]
    fn only_skies_have_a_sun_and_colours_no_image() {
        let up = [0.0, 1.0, 0.0];
        let of = |background: &Background| {
            (made_image(background, up).unwrap().is_some(), sun_of(background, up).is_some())
        };
        let plain = Background::default();
        assert_eq!(of(&plain), (false, false));
        assert_eq!(
            of(&Background { gradient: Some([[1.0; 3]; 2]), ..plain.clone() }),
            (true, false)
        );
        assert_eq!(of(&Background { sky: Some(Sky::default()), ..plain }), (true, true));
    }
}
