//! Twin of `glsl/shared/image.glsl`: colours of textures and of the environment, decoded to linear RGB
//! before they are blended.

use crate::real::{Real, V3};
use kernels::layout::{IMAGE_SRGB8, ImageInfo};

/// The images of a plan.
#[derive(Debug, Clone, Copy)]
pub struct Images<'a> {
    /// Where each lies among the texels.
    pub infos: &'a [ImageInfo],
    /// The linear value of each byte of sRGB; then the texels of all images.
    pub texels: &'a [u32],
}

impl Images<'_> {
    fn texel_of<R: Real>(&self, image: &ImageInfo, column: u32, row: u32) -> V3<R> {
        let at = row * image.width + column;
        let is_srgb = image.format == IMAGE_SRGB8;
        let first = image.first + if is_srgb { at } else { 3 * at };
        let word = self.texels[first as usize];
        let place = match is_srgb {
            true => [word, word >> 8, word >> 16].map(|byte| byte & 255),
            false => [first, first + 1, first + 2],
        };
        V3(place.map(|at| R::of_f32(f32::from_bits(self.texels[at as usize]))))
    }

    /// The colour at u of the width of an image and v of its height, from the upper left corner,
    /// bilinear. Where it does not wrap in u, it goes on beyond its edges with its outer texels.
    #[must_use]
    pub fn image_at<R: Real>(&self, image: &ImageInfo, u: R, v: R, wraps: bool) -> V3<R> {
        let ([left, right], across) = texels_around(u, image.width, wraps);
        let ([above, below], down) = texels_around(v, image.height, false);
        let texel = |column, row| self.texel_of::<R>(image, column, row);
        let between = |a: V3<R>, b: V3<R>, part: R| a + (b - a).times(part);
        let upper = between(texel(left, above), texel(right, above), across);
        let lower = between(texel(left, below), texel(right, below), across);
        between(upper, lower, down)
    }
}

/// The two texels on either side of a place along one axis, and how far it is from the first to the
/// second.
fn texels_around<R: Real>(at: R, count: u32, wraps: bool) -> ([u32; 2], R) {
    let (zero, one) = (R::of(0.0), R::of(1.0));
    let last = R::of_u32(count) - one;
    let place = at * R::of_u32(count) - R::of(0.5);
    let (low, high) = if wraps { (R::of(-1.0), R::of_u32(count)) } else { (zero, last) };
    let place = place.max(low).min(high);
    let below = place.floor();
    let first = match () {
        () if below < zero => last,
        () if below > last => zero,
        () => below,
    };
    let second = match () {
        () if first < last => first + one,
        () if wraps => zero,
        () => last,
    };
    ([first.to_u32(), second.to_u32()], place - below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kernels::layout::IMAGE_LINEAR;

    /// Four columns, two rows, all channels alike: 0 1 2 3 over 10 11 12 13.
    fn ramp() -> (ImageInfo, Vec<u32>) {
        let values = [0.0f32, 1.0, 2.0, 3.0, 10.0, 11.0, 12.0, 13.0];
        let texels = values.iter().flat_map(|v| [v.to_bits(); 3]).collect();
        (ImageInfo { first: 0, width: 4, height: 2, format: IMAGE_LINEAR }, texels)
    }

    fn at(u: f32, v: f32, wraps: bool) -> f32 {
        let (info, texels) = ramp();
        let images = Images { infos: &[info], texels: &texels };
        let exact: V3<f64> = images.image_at(&info, f64::from(u), f64::from(v), wraps);
        let color: V3<f32> = images.image_at(&info, u, v, wraps);
        assert!((exact.x() - f64::from(color.x())).abs() < 1e-5, "{exact:?} {color:?}");
        color.x()
    }

    #[test]
    fn bilinear_is_exact_at_texels_and_halfway() {
        for (column, u) in [0.125, 0.375, 0.625, 0.875].into_iter().enumerate() {
            assert_eq!(at(u, 0.25, false), column as f32);
            assert_eq!(at(u, 0.75, false), column as f32 + 10.0);
            assert_eq!(at(u, 0.5, true), column as f32 + 5.0);
        }
        assert_eq!(at(0.25, 0.25, false), 0.5);
        assert_eq!(at(0.5, 0.5, false), 6.5);
    }

    #[test]
    fn images_end_at_their_edges_or_wrap() {
        for far in [0.0, -7.0, -3e38] {
            assert_eq!(at(far, far, false), 0.0);
            assert_eq!(at(1.0 - far, 1.0 - far, false), 13.0);
        }
        // Halfway between 3 and 0.
        assert_eq!(at(0.0, 0.0, true), 1.5);
        assert_eq!(at(1.0, 0.0, true), 1.5);
        assert_eq!(at(0.0625, 0.0, true), 0.75);
    }
}
