//! EXR pictures as planes of f32, whoever wrote them.

use crate::error::FilmError;
use exr::meta::attribute::{AttributeValue, IntegerBounds, Text};
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, Vec2, read};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// An EXR picture: the first part of the file with its highest resolution.
#[derive(Debug, Clone, PartialEq)]
pub struct ExrPicture {
    /// Column and row of the display window's upper left pixel.
    pub display_origin: [i32; 2],
    /// Width and height of the display window.
    pub display_size: [u32; 2],
    /// Column and row of the data window's upper left pixel.
    pub data_origin: [i32; 2],
    /// Width and height of the data window.
    pub data_size: [u32; 2],
    /// Channel name to the values of the data window, row-major, row 0 at the top. Half floats and
    /// integers are converted.
    pub channels: BTreeMap<String, Vec<f32>>,
    /// Name to value of each string attribute, `software` among them.
    pub strings: BTreeMap<String, String>,
    /// `worldToCamera`, for row vectors.
    pub world_to_camera: Option<[[f32; 4]; 4]>,
    /// `worldToNDC`, for row vectors.
    pub world_to_ndc: Option<[[f32; 4]; 4]>,
}

/// Reads an EXR file. Deep data and subsampled channels are not read.
///
/// # Errors
/// [`FilmError::Read`] if the file cannot be opened, [`FilmError::NotExr`] if it is no EXR, is cut
/// off, or holds what is not read.
pub fn read_exr(path: &Path) -> Result<ExrPicture, FilmError> {
    let read_error = |source| FilmError::Read { path: path.into(), source };
    let not_exr = |reason: String| FilmError::NotExr { path: path.into(), reason };

    let file = File::open(path).map_err(read_error)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(BufReader::new(file))
        .map_err(|error| match error {
            exr::error::Error::Io(source) => read_error(source),
            other => not_exr(other.to_string()),
        })?;

    let layer = image.layer_data;
    let Vec2(width, height) = layer.size;
    let mut channels = BTreeMap::new();
    for channel in layer.channel_data.list {
        let name = utf8(&channel.name);
        if channel.sampling != Vec2(1, 1) {
            return Err(not_exr(format!("channel '{name}' is subsampled, which is not read")));
        }
        let samples = match channel.sample_data {
            FlatSamples::F32(samples) => samples,
            FlatSamples::F16(samples) => samples.into_iter().map(|value| value.to_f32()).collect(),
            FlatSamples::U32(samples) => samples.into_iter().map(|value| value as f32).collect(),
        };
        channels.insert(name, samples);
    }

    let attributes = layer.attributes;
    let mut strings = BTreeMap::new();
    for (name, value) in attributes.other.iter().chain(&image.attributes.other) {
        if let AttributeValue::Text(value) = value {
            strings.insert(utf8(name), utf8(value));
        }
    }
    for (name, value) in [
        ("software", &attributes.software_name),
        ("owner", &attributes.owner),
        ("comments", &attributes.comments),
        ("name", &attributes.layer_name),
    ] {
        if let Some(value) = value {
            strings.insert(name.to_owned(), utf8(value));
        }
    }

    let IntegerBounds { position: Vec2(left, top), size: Vec2(columns, rows) } =
        image.attributes.display_window;
    Ok(ExrPicture {
        display_origin: [left, top],
        display_size: [columns as u32, rows as u32],
        data_origin: [attributes.layer_position.0, attributes.layer_position.1],
        data_size: [width as u32, height as u32],
        channels,
        strings,
        world_to_camera: attributes.world_to_camera.map(rows_of),
        world_to_ndc: attributes.world_to_normalized_device.map(rows_of),
    })
}

fn utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

fn rows_of(matrix: [f32; 16]) -> [[f32; 4]; 4] {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[4 * row + column]))
}
