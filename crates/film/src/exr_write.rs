//! A film as OpenEXR: scan lines, ZIP in blocks of 16 lines, 32-bit float, linear Rec. 709.
//!
//! The crate `exr` keeps custom attributes in a hash map with a random seed, so the order in which
//! it writes them changes from run to run. [`sort_header`] puts them in alphabetical order, as the
//! OpenEXR library does. Blocks are compressed in parallel and written in the order of their lines.
//! Both together make equal films equal files: `two_writes_are_equal_to_the_byte`.

use crate::error::FilmError;
use crate::picture::{Film, Provenance, Window};
use exr::meta::attribute::{AttributeValue, Chromaticities, IntegerBounds, LineOrder, Text};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, Vec2,
    WritableImage,
};
use std::io::Cursor;
use std::path::Path;

const SOFTWARE: &str = concat!("Pointillist ", env!("CARGO_PKG_VERSION"));
const PREFIX: &str = "pointillist/";
/// Longest attribute name that OpenEXR files can hold, in bytes.
const MAX_NAME: usize = 255;

const ENCODING: Encoding = Encoding {
    compression: Compression::ZIP16,
    blocks: Blocks::ScanLines,
    // Also what makes the crate put blocks in order that were compressed in parallel.
    line_order: LineOrder::Increasing,
};

/// The film as the bytes of an EXR file. `path` is for messages.
pub(crate) fn encode(
    film: &Film,
    provenance: &Provenance,
    path: &Path,
) -> Result<Vec<u8>, FilmError> {
    let Window { x, y, width, height } = film.window;
    let header_error = |reason: String| FilmError::Header { path: path.into(), reason };

    let mut layer_attributes = LayerAttributes {
        layer_name: None,
        layer_position: Vec2(x as i32, y as i32),
        world_to_camera: Some(flat(provenance.world_to_camera)),
        world_to_normalized_device: Some(flat(provenance.world_to_ndc)),
        software_name: Some(text(SOFTWARE)),
        ..LayerAttributes::default()
    };
    for (key, value) in string_attributes(provenance).map_err(header_error)? {
        layer_attributes.other.insert(text(&key), AttributeValue::Text(text(&value)));
    }

    let mut image_attributes = ImageAttributes::new(IntegerBounds {
        position: Vec2(0, 0),
        size: Vec2(film.size[0] as usize, film.size[1] as usize),
    });
    image_attributes.chromaticities = Some(REC_709);

    let size = Vec2(width as usize, height as usize);
    let image = Image {
        attributes: image_attributes,
        layer_data: Layer {
            channel_data: channels(film),
            attributes: layer_attributes,
            size,
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
    sort_header(&mut bytes).ok_or_else(|| header_error("an attribute has no end".to_owned()))?;
    Ok(bytes)
}

/// Primaries and white point of Rec. 709, to which the colours are relative.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// All channels of a film, sorted by name as the format wants them.
fn channels(film: &Film) -> AnyChannels<FlatSamples> {
    fn channel(name: &str, samples: Vec<f32>) -> AnyChannel<FlatSamples> {
        AnyChannel::new(text(name), FlatSamples::F32(samples))
    }
    fn plane<const N: usize>(pixels: &[[f32; N]], index: usize) -> Vec<f32> {
        pixels.iter().map(|pixel| pixel[index]).collect()
    }
    let mut list = vec![
        channel("R", plane(&film.color, 0)),
        channel("G", plane(&film.color, 1)),
        channel("B", plane(&film.color, 2)),
        channel("A", plane(&film.color, 3)),
        channel("Z", film.depth.clone()),
        channel("P.X", plane(&film.position, 0)),
        channel("P.Y", plane(&film.position, 1)),
        channel("P.Z", plane(&film.position, 2)),
        channel("N.X", plane(&film.normal, 0)),
        channel("N.Y", plane(&film.normal, 1)),
        channel("N.Z", plane(&film.normal, 2)),
        channel("object", film.object.clone()),
    ];
    for (name, samples) in &film.extra {
        let extra = channel(name, samples.clone());
        let free = !name.is_empty() && list.iter().all(|channel| channel.name != extra.name);
        assert!(free, "film: the channel name '{name}' is not free");
        list.push(extra);
    }
    AnyChannels::sort(list.into())
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

/// Sorts the attributes of a file with one header by name, in place: their total length, and so
/// every offset behind them, stays. `None` if the header does not end.
fn sort_header(file: &mut [u8]) -> Option<()> {
    const START: usize = 8; // magic number and version
    let mut attributes = Vec::new();
    let mut at = START;
    // An attribute is a name and a type, each ended by a zero byte, a length, and that many bytes.
    while *file.get(at)? != 0 {
        let name_end = zero_from(file, at)?;
        let type_end = zero_from(file, name_end + 1)?;
        let length = file.get(type_end + 1..type_end + 5)?;
        let length = u32::from_le_bytes(length.try_into().ok()?) as usize;
        let end = type_end + 5 + length;
        attributes.push((file[at..name_end].to_vec(), file.get(at..end)?.to_vec()));
        at = end;
    }
    attributes.sort();
    let sorted: Vec<u8> = attributes.into_iter().flat_map(|(_, bytes)| bytes).collect();
    file.get_mut(START..at)?.copy_from_slice(&sorted);
    Some(())
}

/// Place of the first zero byte at or after `start`.
fn zero_from(bytes: &[u8], start: usize) -> Option<usize> {
    bytes.get(start..)?.iter().position(|&byte| byte == 0).map(|offset| start + offset)
}
