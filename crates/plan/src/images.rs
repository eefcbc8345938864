//! The images of a scene as kernels read them: all texels in one list, after a table that decodes sRGB.

use film::{Image, Texels, linear_from_srgb};
use kernels::layout::{IMAGE_LINEAR, IMAGE_SRGB8, ImageInfo};
use std::sync::Arc;

/// Largest value of an environment; what is beyond counts as infinite.
const LARGE: f32 = 1e15;
/// What infinite values of an environment become: the largest number of a half float.
const LARGEST_HALF: f32 = 65_504.0;

/// The decoded images that a scene names.
#[derive(Debug, Clone, Default)]
pub struct SceneImages {
    /// The environment, where the scene has one.
    pub environment: Option<Arc<Image>>,
    /// The texture of each object; those at the end that have none may be left out.
    pub textures: Vec<Option<Arc<Image>>>,
}

/// An image some of whose pixels hold what no picture can show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cleaned {
    /// Its file, as the scene names it.
    pub file: String,
    /// How many pixels were changed.
    pub pixels: u64,
    /// What they were changed to, in words.
    pub rule: &'static str,
}

/// What an image is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Use {
    /// Its values are shares, 0 to 1.
    Texture,
    /// Its values are radiances.
    Environment,
}

impl Use {
    fn clean(self, value: f32) -> f32 {
        match self {
            _ if value.is_nan() => 0.0,
            Self::Texture => value.clamp(0.0, 1.0),
            Self::Environment if value > LARGE => LARGEST_HALF,
            Self::Environment => value.max(0.0),
        }
    }

    fn rule(self) -> &'static str {
        match self {
            Self::Texture => "albedos lie between 0 and 1",
            Self::Environment => {
                "what is negative or no number became 0, what is infinite or over 1e15 became 65504"
            }
        }
    }
}

/// Images that are being put together, each once however often it is used.
pub(crate) struct ImageList {
    pub infos: Vec<ImageInfo>,
    pub texels: Vec<u32>,
    pub files: Vec<String>,
    pub cleaned: Vec<Cleaned>,
    known: Vec<(Arc<Image>, Use)>,
}

impl ImageList {
    pub fn new() -> Self {
        let table = (0..=255).map(|byte| linear_from_srgb(f64::from(byte) / 255.0) as f32);
        Self {
            infos: Vec::new(),
            texels: table.map(f32::to_bits).collect(),
            files: Vec::new(),
            cleaned: Vec::new(),
            known: Vec::new(),
        }
    }

    /// The place of an image; `None` where 32 bits cannot count the texels.
    pub fn add(&mut self, image: &Arc<Image>, file: &str, used: Use) -> Option<u32> {
        let known = |(other, of): &(Arc<Image>, Use)| Arc::ptr_eq(other, image) && *of == used;
        if let Some(at) = self.known.iter().position(known) {
            return Some(at as u32);
        }
        let pixels = u64::from(image.width) * u64::from(image.height);
        if self.texels.len() as u64 + 3 * pixels > u64::from(u32::MAX) {
            return None;
        }
        let first = self.texels.len() as u32;
        let format = match &image.texels {
            Texels::Srgb8(texels) => {
                assert_eq!(texels.len() as u64, pixels, "one texel a pixel");
                self.texels
                    .extend(texels.iter().map(|&[r, g, b]| u32::from_le_bytes([r, g, b, 255])));
                IMAGE_SRGB8
            }
            Texels::Linear(texels) => {
                assert_eq!(texels.len() as u64, pixels, "one texel a pixel");
                let cleaned = |texel: &[f32; 3]| texel.map(|value| used.clean(value));
                self.texels.extend(texels.iter().flat_map(cleaned).map(f32::to_bits));
                let changed = texels.iter().filter(|&texel| cleaned(texel) != *texel).count();
                if changed > 0 {
                    let (file, pixels) = (file.to_owned(), changed as u64);
                    self.cleaned.push(Cleaned { file, pixels, rule: used.rule() });
                }
                IMAGE_LINEAR
            }
        };
        self.infos.push(ImageInfo { first, width: image.width, height: image.height, format });
        self.files.push(file.to_owned());
        self.known.push((Arc::clone(image), used));
        Some(self.infos.len() as u32 - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One ulp of f32, against the curve in f64: the linear part, and (v + 0.055) / 1.055 to the 2.4.
    #[test]
    fn the_table_decodes_every_byte() {
        let list = ImageList::new();
        for byte in 0..=255u8 {
            let v = f64::from(byte) / 255.0;
            let exact = if byte <= 10 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
            let ours = f32::from_bits(list.texels[usize::from(byte)]);
            let ulp = f64::from(f32::from_bits(ours.to_bits() + 1) - ours);
            assert!((f64::from(ours) - exact).abs() <= ulp, "{byte}: {ours}, not {exact}");
        }
        assert_eq!((f32::from_bits(list.texels[0]), f32::from_bits(list.texels[255])), (0.0, 1.0));
    }

    #[test]
    fn images_lie_once_each_and_what_cannot_be_shown_is_cleaned_and_counted() {
        let linear =
            |texel| Arc::new(Image { width: 1, height: 1, texels: Texels::Linear(vec![texel]) });
        let strange = linear([f32::NAN, f32::INFINITY, -1.0]);
        let mut list = ImageList::new();
        assert_eq!(list.add(&strange, "a.exr", Use::Environment), Some(0));
        assert_eq!(list.add(&strange, "a.exr", Use::Texture), Some(1));
        assert_eq!(list.add(&strange, "a.exr", Use::Environment), Some(0));
        assert_eq!(list.add(&linear([0.0, 0.5, 1.0]), "b.exr", Use::Texture), Some(2));
        let values: Vec<f32> =
            list.texels[256..].iter().map(|&bits| f32::from_bits(bits)).collect();
        assert_eq!(values, [0.0, 65_504.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, 1.0]);
        let counts: Vec<_> = list.cleaned.iter().map(|c| (c.file.as_str(), c.pixels)).collect();
        assert_eq!(counts, [("a.exr", 1), ("a.exr", 1)]);
    }
}
