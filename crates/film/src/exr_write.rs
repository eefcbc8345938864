//! A film as OpenEXR: scan lines, ZIP in blocks of 16 lines, linear Rec. 709, in 32-bit float or, where
//! asked for, colours and normals in 16-bit.
//!
//! The crate `exr` keeps custom attributes in a hash map with a random seed, so the order in which
//! it writes them changes from run to run. [`sort_attributes`] puts them in alphabetical order, as the
//! OpenEXR library does. Blocks are compressed in parallel and written in the order of their lines.
//! Both together make equal films equal files: `two_writes_are_equal_to_the_byte`.

use crate::error::FilmError;
use crate::exr_header::sort_attributes;
use crate::picture::{Film, Provenance, Window};
use exr::meta::attribute::{AttributeValue, Chromaticities, IntegerBounds, LineOrder, Text};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, Vec2,
    WritableImage, f16,
};
use std::io::Cursor;
use std::path::Path;

const SOFTWARE: &str = concat!("Pointillist ", env!("CARGO_PKG_VERSION"));
const PREFIX: &str = "pointillist/";
/// Largest finite number of 16 bits.
pub const HALF_MAX: f32 = 65_504.0;
/// Longest attribute name that OpenEXR files can hold, in bytes.
const MAX_NAME: usize = 255;

const ENCODING: Encoding = Encoding {
    compression: Compression::ZIP16,
    blocks: Blocks::ScanLines,
    // Also what makes the crate put blocks in order that were compressed in parallel.
    line_order: LineOrder::Increasing,
};

/// What a file is to hold: windows, attributes, and planes of the data window.
struct Contents {
    /// Width and height of the display window.
    size: [u32; 2],
    /// Column and row of the data window's upper left pixel.
    origin: [i32; 2],
    /// Width and height of the data window.
    extent: [u32; 2],
    /// Without name and position.
    attributes: LayerAttributes,
    channels: Vec<AnyChannel<FlatSamples>>,
}

/// The film as the bytes of an EXR file. `path` is for messages.
pub(crate) fn encode(
    film: &Film,
    provenance: &Provenance,
    half: bool,
    path: &Path,
) -> Result<Vec<u8>, FilmError> {
    let mut attributes = LayerAttributes {
        world_to_camera: Some(flat(provenance.world_to_camera)),
        world_to_normalized_device: Some(flat(provenance.world_to_ndc)),
        ..LayerAttributes::default()
    };
    let strings = string_attributes(provenance)
        .map_err(|reason| FilmError::Header { path: path.into(), reason })?;
    for (key, value) in strings {
        attributes.other.insert(text(&key), AttributeValue::Text(text(&value)));
    }
    let channels = channels(film, half);
    let Window { x, y, width, height } = film.window;
    let (origin, extent) = ([x as i32, y as i32], [width, height]);
    encode_contents(Contents { size: film.size, origin, extent, attributes, channels }, path)
}

/// Planes of 32-bit floats as the bytes of an EXR file, as [`write_planes`](crate::write_planes)
/// takes them.
pub(crate) fn encode_planes(
    size: [u32; 2],
    origin: [i32; 2],
    extent: [u32; 2],
    planes: Vec<(String, Vec<f32>)>,
    path: &Path,
) -> Result<Vec<u8>, FilmError> {
    let channels = planes.into_iter().map(|(name, samples)| float(&name, samples)).collect();
    let attributes = LayerAttributes::default();
    encode_contents(Contents { size, origin, extent, attributes, channels }, path)
}

fn encode_contents(contents: Contents, path: &Path) -> Result<Vec<u8>, FilmError> {
    let ([x, y], [width, height]) = (contents.origin, contents.extent);
    let mut image_attributes = ImageAttributes::new(IntegerBounds {
        position: Vec2(0, 0),
        size: Vec2(contents.size[0] as usize, contents.size[1] as usize),
    });
    image_attributes.chromaticities = Some(REC_709);
    let image = Image {
        attributes: image_attributes,
        layer_data: Layer {
            channel_data: AnyChannels::sort(contents.channels.into()),
            attributes: LayerAttributes {
                layer_name: None,
                layer_position: Vec2(x, y),
                software_name: Some(text(SOFTWARE)),
                ..contents.attributes
            },
            size: Vec2(width as usize, height as usize),
            encoding: ENCODING,
        },
    };
    let mut file = Cursor::new(Vec::new());
    image.write().to_buffered(&mut file).map_err(|error| FilmError::Encode {
        path: path.into(),
        width,
        height,
        reason: error.to_string(),
    })?;
    let mut bytes = file.into_inner();
    sort_attributes(&mut bytes).ok_or_else(|| FilmError::Header {
        path: path.into(),
        reason: "an attribute has no end".to_owned(),
    })?;
    Ok(bytes)
}

/// Primaries and white point of Rec. 709, to which the colours are relative.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// All channels of a film. With `half`, what is looked at is in 16 bits: R, G, B, their alphas and N. What is
/// measured or counted stays: a half has three decimal digits, and no index over 2048.
fn channels(film: &Film, half: bool) -> Vec<AnyChannel<FlatSamples>> {
    fn plane<const N: usize>(pixels: &[[f32; N]], index: usize) -> Vec<f32> {
        pixels.iter().map(|pixel| pixel[index]).collect()
    }
    let shown = |name: &str, samples: Vec<f32>| match half {
        true => AnyChannel::new(text(name), FlatSamples::F16(halves(&samples))),
        false => float(name, samples),
    };
    let mut list = vec![
        shown("R", plane(&film.color, 0)),
        shown("G", plane(&film.color, 1)),
        shown("B", plane(&film.color, 2)),
        shown("A", plane(&film.color, 3)),
        float("Z", film.depth.clone()),
        float("P.X", plane(&film.position, 0)),
        float("P.Y", plane(&film.position, 1)),
        float("P.Z", plane(&film.position, 2)),
        shown("N.X", plane(&film.normal, 0)),
        shown("N.Y", plane(&film.normal, 1)),
        shown("N.Z", plane(&film.normal, 2)),
        float("object", film.object.clone()),
    ];
    if let Some(alpha) = &film.channel_alpha {
        list.extend(
            [("AR", 0), ("AG", 1), ("AB", 2)].map(|(name, at)| shown(name, plane(alpha, at))),
        );
    }
    for (name, samples) in &film.extra {
        let extra = float(name, samples.clone());
        let free = !name.is_empty() && list.iter().all(|channel| channel.name != extra.name);
        assert!(free, "film: the channel name '{name}' is not free");
        list.push(extra);
    }
    list
}

fn float(name: &str, samples: Vec<f32>) -> AnyChannel<FlatSamples> {
    AnyChannel::new(text(name), FlatSamples::F32(samples))
}

/// Values in 16 bits, rounded to nearest. A finite value stays finite: beyond [`HALF_MAX`] it becomes
/// that. Infinities and NaN stay what they are.
fn halves(samples: &[f32]) -> Vec<f16> {
    let within = |value: f32| match value.is_finite() {
        true => value.clamp(-HALF_MAX, HALF_MAX),
        false => value,
    };
    samples.iter().map(|&value| f16::from_f32(within(value))).collect()
}

/// How many colour values of a film are finite and beyond what 16 bits hold.
pub(crate) fn beyond_half(film: &Film) -> usize {
    let values = film.color.iter().flatten();
    values.filter(|value| value.is_finite() && value.abs() > HALF_MAX).count()
}

/// The origin and the settings under the names they have in the file. Fails with what is wrong.
fn string_attributes(provenance: &Provenance) -> Result<Vec<(String, String)>, String> {
    let [x, y, z] = provenance.origin;
    // `{:?}` prints the shortest decimal that parses back to the same f64.
    let mut attributes = vec![(format!("{PREFIX}origin"), format!("{x:?} {y:?} {z:?}"))];
    for (key, value) in &provenance.settings {
        assert!(!key.is_empty() && key != "origin", "provenance: the setting '{key}' is not free");
        let name = format!("{PREFIX}{key}");
        assert!(attributes.iter().all(|(n, _)| *n != name), "provenance: '{key}' given twice");
        if name.contains('\0') || name.len() > MAX_NAME {
            let length = name.len();
            return Err(format!(
                "the name of attribute '{name}' has {length} bytes, at most {MAX_NAME} without \
                 zero bytes are possible"
            ));
        }
        attributes.push((name, value.clone()));
    }
    Ok(attributes)
}

/// The crate's own conversion takes Latin-1 alone and panics at other letters; files of today hold
/// UTF-8.
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}

/// OpenEXR stores matrices row by row.
fn flat(matrix: [[f32; 4]; 4]) -> [f32; 16] {
    let mut values = [0.0; 16];
    values.copy_from_slice(matrix.as_flattened());
    values
}
