//! EXR pictures, whoever wrote them: every part with every channel, in the numbers that the file has.
//!
//! What the crate `exr` reads is read: all compressions up to OpenEXR 3.3, half, float and unsigned integers,
//! scan lines and tiles in any order, and of several resolutions the highest. Deep data and
//! subsampled channels are errors.

use crate::error::FilmError;
use crate::exr_header::{COMPRESSIONS, COMPRESSIONS_READ, ExrHeader, read_exr_headers};
use crate::plausible::too_short_for;
use exr::image::Image;
use exr::meta::MetaData;
use exr::meta::attribute::{IntegerBounds, Text};
use exr::meta::header::Header;
use exr::prelude::{AnyChannels, FlatSamples, Layers, ReadChannels, ReadLayers, Vec2, read};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, ErrorKind};
use std::path::Path;

/// Longest side of a picture in pixels.
const LONGEST: i64 = 65_536;

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

/// All of an EXR file.
#[derive(Debug, Clone)]
pub struct ExrFile {
    /// Column and row of the display window's upper left pixel.
    pub display_origin: [i32; 2],
    /// Width and height of the display window.
    pub display_size: [u32; 2],
    /// The parts, in the order of the file. At least one.
    pub parts: Vec<ExrPart>,
}

/// One part of an EXR file, with its highest resolution.
#[derive(Debug, Clone)]
pub struct ExrPart {
    /// The part's name, if it has one.
    pub name: Option<String>,
    /// Column and row of the data window's upper left pixel.
    pub data_origin: [i32; 2],
    /// Width and height of the data window.
    pub data_size: [u32; 2],
    /// Channel name to the values of the data window, row-major, row 0 at the top.
    pub channels: BTreeMap<String, Samples>,
    /// Every attribute.
    pub header: ExrHeader,
}

/// The values of a channel in the file's own number type.
#[derive(Debug, Clone)]
pub struct Samples(FlatSamples);

impl Samples {
    /// Values of 32-bit floats.
    #[must_use]
    pub fn from_f32(values: Vec<f32>) -> Self {
        Self(FlatSamples::F32(values))
    }

    #[cfg(test)]
    pub(crate) fn of(samples: FlatSamples) -> Self {
        Self(samples)
    }

    /// One value, in a type that holds all of them exactly.
    ///
    /// # Panics
    /// If there are not as many.
    #[must_use]
    pub fn at(&self, index: usize) -> f64 {
        match &self.0 {
            FlatSamples::F16(values) => values[index].to_f64(),
            FlatSamples::F32(values) => values[index].into(),
            FlatSamples::U32(values) => values[index].into(),
        }
    }

    /// Writes the values from `first` on, as many as `out` has room for, in a type that holds all of them exactly.
    ///
    /// # Panics
    /// If there are not as many.
    pub fn copy_to(&self, first: usize, out: &mut [f64]) {
        fn copy<T: Copy>(values: &[T], out: &mut [f64], exact: impl Fn(T) -> f64) {
            for (out, value) in out.iter_mut().zip(values) {
                *out = exact(*value);
            }
        }
        let range = first..first + out.len();
        match &self.0 {
            FlatSamples::F16(values) => copy(&values[range], out, |value| value.to_f64()),
            FlatSamples::F32(values) => copy(&values[range], out, f64::from),
            FlatSamples::U32(values) => copy(&values[range], out, f64::from),
        }
    }

    /// Whether `count` values from `first` on, and as many of `other` from `other_first` on, are the same bits of the
    /// same number type.
    ///
    /// # Panics
    /// If either has not as many.
    #[must_use]
    pub fn same_bits(&self, first: usize, other: &Self, other_first: usize, count: usize) -> bool {
        // Without an end in the middle, which would keep the compiler from taking several at once.
        fn same<T: Copy>(a: &[T], b: &[T], bits: impl Fn(T) -> u32) -> bool {
            a.iter().zip(b).fold(0, |found, (&a, &b)| found | (bits(a) ^ bits(b))) == 0
        }
        let (here, there) = (first..first + count, other_first..other_first + count);
        match (&self.0, &other.0) {
            (FlatSamples::F16(a), FlatSamples::F16(b)) => {
                same(&a[here], &b[there], |value| value.to_bits().into())
            }
            (FlatSamples::F32(a), FlatSamples::F32(b)) => same(&a[here], &b[there], f32::to_bits),
            (FlatSamples::U32(a), FlatSamples::U32(b)) => same(&a[here], &b[there], |value| value),
            _ => false,
        }
    }

    /// Number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// OpenEXR's name of the number type: `half`, `float` or `uint`.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self.0 {
            FlatSamples::F16(_) => "half",
            FlatSamples::F32(_) => "float",
            FlatSamples::U32(_) => "uint",
        }
    }

    /// The values in a type that holds all of them exactly.
    pub fn iter(&self) -> impl Iterator<Item = f64> {
        (0..self.len()).map(|index| self.at(index))
    }

    /// The values as f32, which rounds integers beyond 2²⁴.
    fn into_f32(self) -> Vec<f32> {
        match self.0 {
            FlatSamples::F32(values) => values,
            FlatSamples::F16(values) => values.into_iter().map(|value| value.to_f32()).collect(),
            FlatSamples::U32(values) => values.into_iter().map(|value| value as f32).collect(),
        }
    }
}

/// Reads the first part of an EXR file. Deep data and subsampled channels are not read.
///
/// # Errors
/// As [`read_exr_file()`].
pub fn read_exr(path: &Path) -> Result<ExrPicture, FilmError> {
    let file = read_exr_file(path)?;
    let (display_origin, display_size) = (file.display_origin, file.display_size);
    let Some(part) = file.parts.into_iter().next() else {
        return Err(not_exr(path, "found no picture in it"));
    };
    let strings = (part.header.attributes.iter())
        .filter_map(|attribute| Some((attribute.name.clone(), part.header.text(&attribute.name)?)));
    Ok(ExrPicture {
        display_origin,
        display_size,
        data_origin: part.data_origin,
        data_size: part.data_size,
        strings: strings.collect(),
        world_to_camera: part.header.matrix("worldToCamera"),
        world_to_ndc: part.header.matrix("worldToNDC"),
        channels: (part.channels.into_iter())
            .map(|(name, samples)| (name, samples.into_f32()))
            .collect(),
    })
}

/// Reads all parts of an EXR file. Deep data and subsampled channels are not read.
///
/// # Errors
/// [`FilmError::Read`] if the file cannot be opened, [`FilmError::NotExr`] if it is no EXR, is cut
/// off, is longer than 65536 pixels on a side, or holds what is not read.
pub fn read_exr_file(path: &Path) -> Result<ExrFile, FilmError> {
    let headers = read_exr_headers(path)?;
    check_readable(path, &headers)?;
    check_sizes(path)?;
    let file = File::open(path).map_err(|source| FilmError::Read { path: path.into(), source })?;
    let image: Image<Layers<AnyChannels<FlatSamples>>> = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(BufReader::new(file))
        .map_err(|error| exr_error(path, error))?;
    let parts = image.layer_data.into_iter().zip(headers).map(|(layer, header)| ExrPart {
        name: layer.attributes.layer_name.as_ref().map(utf8),
        data_origin: [layer.attributes.layer_position.0, layer.attributes.layer_position.1],
        data_size: [layer.size.0 as u32, layer.size.1 as u32],
        channels: (layer.channel_data.list.into_iter())
            .map(|channel| (utf8(&channel.name), Samples(channel.sample_data)))
            .collect(),
        header,
    });
    let IntegerBounds { position: Vec2(left, top), size: Vec2(columns, rows) } =
        image.attributes.display_window;
    Ok(ExrFile {
        display_origin: [left, top],
        display_size: [columns as u32, rows as u32],
        parts: parts.collect(),
    })
}

/// The text of a string attribute of an EXR's first part, if it has it. Reads no pixel.
///
/// # Errors
/// As [`read_exr_file()`], where the headers tell.
pub fn exr_text(path: &Path, name: &str) -> Result<Option<String>, FilmError> {
    let headers = read_exr_headers(path)?;
    Ok(headers.first().and_then(|header| header.text(name)))
}

/// How many bytes all pixels of an EXR file take once they are read, by its headers alone.
///
/// # Errors
/// As [`read_exr_file()`], where the headers tell.
pub fn exr_pixel_bytes(path: &Path) -> Result<u64, FilmError> {
    let headers = read_exr_headers(path)?;
    check_readable(path, &headers)?;
    Ok(headers.iter().map(ExrHeader::pixel_bytes).fold(0, u64::saturating_add))
}

/// Fails where a header announces what is not read: before memory is taken for it.
fn check_readable(path: &Path, headers: &[ExrHeader]) -> Result<(), FilmError> {
    for header in headers {
        if let Some(&number) = header.get("compression").and_then(|found| found.bytes.first())
            && number >= COMPRESSIONS_READ
        {
            let name = COMPRESSIONS.get(usize::from(number)).copied().unwrap_or("unknown");
            return Err(not_exr(
                path,
                &format!(
                    "found compression {name} (number {number}), which is not read here; save it with ZIP"
                ),
            ));
        }
        if header.text("type").is_some_and(|kind| kind.starts_with("deep")) {
            return Err(not_exr(path, "found deep data, which is not read here; flatten it"));
        }
        if let Some(name) = header.channels().into_iter().find(|channel| channel.subsampled) {
            let name = name.name;
            return Err(not_exr(
                path,
                &format!("found channel '{name}' subsampled, which is not read here"),
            ));
        }
        if let Some([left, top, right, bottom]) = header.window("dataWindow") {
            let (width, height) = (right - left + 1, bottom - top + 1);
            if !(1..=LONGEST).contains(&width) || !(1..=LONGEST).contains(&height) {
                return Err(not_exr(
                    path,
                    &format!("found {width} x {height} pixels, expected 1 to {LONGEST} on a side"),
                ));
            }
        }
    }
    let bytes = headers.iter().map(ExrHeader::pixel_bytes).fold(0, u64::saturating_add);
    let read_error = |source| FilmError::Read { path: path.into(), source };
    match too_short_for(bytes, path).map_err(read_error)? {
        Some(reason) => Err(not_exr(path, &reason)),
        None => Ok(()),
    }
}

/// The same as the crate `exr` sees it: in a damaged header it may find other sizes, and it takes memory for those.
fn check_sizes(path: &Path) -> Result<(), FilmError> {
    let meta = MetaData::read_from_file(path, false).map_err(|error| exr_error(path, error))?;
    let bytes_of = |header: &Header| {
        let pixel: usize =
            header.channels.list.iter().map(|channel| channel.sample_type.bytes_per_sample()).sum();
        let Vec2(width, height) = header.layer_size;
        (width as u64).saturating_mul(height as u64).saturating_mul(pixel as u64)
    };
    let bytes = meta.headers.iter().map(bytes_of).fold(0, u64::saturating_add);
    match too_short_for(bytes, path)
        .map_err(|source| FilmError::Read { path: path.into(), source })?
    {
        Some(reason) => Err(not_exr(path, &reason)),
        None => Ok(()),
    }
}

fn exr_error(path: &Path, error: exr::error::Error) -> FilmError {
    match error {
        exr::error::Error::Io(source) if source.kind() == ErrorKind::UnexpectedEof => {
            not_exr(path, "found a file that is cut off")
        }
        exr::error::Error::Io(source) => FilmError::Read { path: path.into(), source },
        exr::error::Error::Invalid(reason) => {
            not_exr(path, &format!("found a damaged file or one that is cut off ({reason})"))
        }
        exr::error::Error::NotSupported(reason) => {
            not_exr(path, &format!("found what is not read here ({reason})"))
        }
        exr::error::Error::Aborted => not_exr(path, "reading was aborted"),
    }
}

fn not_exr(path: &Path, reason: &str) -> FilmError {
    FilmError::NotExr { path: path.into(), reason: reason.to_owned() }
}

fn utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}
