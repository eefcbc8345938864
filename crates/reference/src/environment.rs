//! Twin of `glsl/shared/environment.glsl`: what rays that hit nothing see.

use crate::image::Images;
use crate::real::{Real, V3};
use kernels::layout::{BackgroundInfo, IMAGES_OF_TURN, ImageInfo, NONE};
use std::f64::consts::{FRAC_1_PI, PI};

/// The colour of an equirectangular image in a direction of any length: +y is its top row, −z its
/// middle, +x right of that.
#[must_use]
pub fn environment<R: Real>(images: Images<'_>, image: &ImageInfo, direction: V3<R>) -> V3<R> {
    let V3([x, y, z]) = direction;
    let level = (x * x + z * z).sqrt();
    let u = R::of(0.5) + x.arc_tangent(-z) * R::of(0.5 / PI);
    let v = level.arc_tangent(y) * R::of(FRAC_1_PI);
    images.image_at(image, u, v, true)
}

/// The background in a direction, without its sun.
#[must_use]
pub fn background_at<R: Real>(
    images: Images<'_>,
    background: &BackgroundInfo,
    direction: V3<R>,
) -> V3<R> {
    match background.environment {
        NONE => V3::of_f32(background.color),
        at => {
            let at = at as usize;
            environment(images, &images.infos[at], turned(&images.infos[at + 1..at + 4], direction))
        }
    }
}

/// The numbers that lie in place of an image.
fn numbers_of(info: &ImageInfo) -> [f32; 3] {
    [info.first, info.width, info.height].map(f32::from_bits)
}

/// The rows of the matrix that turns the environment; `None` where it does not: kernels leave it out.
fn turn_of(rows: &[ImageInfo]) -> Option<[[f32; 3]; 3]> {
    let rows = [0, 1, 2].map(|i| numbers_of(&rows[i]));
    (rows != [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).then_some(rows)
}

/// What a direction of the world is in the environment's own frame.
pub(crate) fn turned<R: Real>(rows: &[ImageInfo], direction: V3<R>) -> V3<R> {
    match turn_of(rows) {
        Some(rows) => V3(rows.map(|row| V3::of_f32(row).dot(direction))),
        None => direction,
    }
}

/// And back.
pub(crate) fn turned_back<R: Real>(rows: &[ImageInfo], own: V3<R>) -> V3<R> {
    let Some(rows) = turn_of(rows) else { return own };
    let [x, y, z] = rows.map(V3::of_f32);
    (x.times(own.x()) + y.times(own.y())) + z.times(own.z())
}

/// What is seen of the sun in a direction of the world. `at` is the environment's place among the images.
pub(crate) fn sun_at<R: Real>(images: Images<'_>, at: u32, direction: V3<R>) -> V3<R> {
    let [place, light] = [1, 2].map(|i| &images.infos[(at + IMAGES_OF_TURN + i) as usize]);
    let towards = V3::of_f32(numbers_of(place));
    let off = towards.cross(direction);
    let within = towards.dot(direction) > R::of(0.0)
        && off.dot(off) <= R::of_f32(f32::from_bits(place.format));
    if within { V3::of_f32(numbers_of(light)) } else { V3::splat(R::of(0.0)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::layout::IMAGE_LINEAR;

    /// 64 x 32 texels that hold their own column, row and 7.
    fn places() -> (ImageInfo, Vec<u32>) {
        let texels = (0..64 * 32u32)
            .flat_map(|i| [(i % 64) as f32, (i / 64) as f32, 7.0].map(f32::to_bits))
            .collect();
        (ImageInfo { first: 0, width: 64, height: 32, format: IMAGE_LINEAR }, texels)
    }

    fn seen<R: Real>(direction: [f64; 3]) -> [f64; 3] {
        let (info, texels) = places();
        let images = Images { infos: &[info], texels: &texels };
        let color: V3<R> = environment(images, &info, V3(direction.map(R::of)));
        color.0.map(|c| f64::from(c.to_f32()))
    }

    /// u = 1/2 + atan2(x, -z) / 2 pi of 64 columns, v = acos(y) / pi of 32 rows, half a texel less.
    #[test]
    fn each_axis_sees_its_texel() {
        let cases = [
            ([0.0, 0.0, -1.0], [31.5, 15.5]),
            ([1.0, 0.0, 0.0], [47.5, 15.5]),
            ([-1.0, 0.0, 0.0], [15.5, 15.5]),
            // On the seam: between column 63 and column 0.
            ([0.0, 0.0, 1.0], [31.5, 15.5]),
            ([0.0, 1.0, 0.0], [31.5, 0.0]),
            ([0.0, -1.0, 0.0], [31.5, 31.0]),
            ([1.0, 1.0, 0.0], [47.5, 7.5]),
            // Just beside the seam: the last column, and the first.
            ([(PI / 64.0).sin(), 0.0, (PI / 64.0).cos()], [63.0, 15.5]),
            ([-(PI / 64.0).sin(), 0.0, (PI / 64.0).cos()], [0.0, 15.5]),
        ];
        for (direction, [column, row]) in cases {
            for [found_column, found_row, seven] in [seen::<f32>(direction), seen::<f64>(direction)]
            {
                // f32 rounds u to 1.2e-7, which are 8e-6 columns; at the seam one column is 63.
                assert!((found_column - column).abs() < 6e-4, "{direction:?}: {found_column}");
                assert!((found_row - row).abs() < 1e-5, "{direction:?}: {found_row}");
                assert_eq!(seven, 7.0);
            }
        }
    }

    /// Near the poles the arc cosine of y would be off by up to sqrt(2^-24) = 2.4e-4 rad, or 2.5e-3 rows.
    #[test]
    fn rows_are_right_up_to_the_poles() {
        for i in 0..10_000 {
            let angle = PI * (f64::from(i) + 0.5) / 10_000.0;
            let direction = [0.6 * angle.sin(), angle.cos(), 0.8 * angle.sin()];
            let row = (32.0 * angle / PI - 0.5).clamp(0.0, 31.0);
            let [_, found, _] = seen::<f32>(direction);
            assert!((found - row).abs() < 2e-5, "angle {angle}: row {found}, not {row}");
        }
    }
}
