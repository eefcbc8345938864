//! The headers of an EXR file as they stand in it: every attribute of every part, with its type and its
//! bytes, whether this program knows the type or not.
//!
//! The crate `exr` keeps some attributes in fields and drops the order, so it cannot tell whether two
//! headers are equal. The layout is that of "OpenEXR File Layout" (openexr.com): a name and a type, each
//! ended by a zero byte, a length, and that many bytes.

use crate::error::FilmError;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What bytes an EXR file begins with.
pub(crate) const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Bytes before the first header: magic number, version and flags.
const START: usize = 8;
/// Flag of the version field: the file has several parts.
const MULTIPART: u32 = 0x1000;
/// Largest header that is looked at, in bytes: previews and long provenance stay far below.
const LONGEST: u64 = 64 << 20;

/// The header of one part.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExrHeader {
    /// In the order of the file.
    pub attributes: Vec<ExrAttribute>,
}

/// One attribute.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExrAttribute {
    /// Its name, such as `worldToCamera`.
    pub name: String,
    /// OpenEXR's name of its type, such as `m44f`.
    pub kind: String,
    /// Its value as the file holds it, little-endian.
    pub bytes: Vec<u8>,
}

impl ExrHeader {
    /// The attribute of this name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&ExrAttribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// The text of the string attribute of this name.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<String> {
        let attribute = self.get(name).filter(|attribute| attribute.kind == "string")?;
        Some(String::from_utf8_lossy(&attribute.bytes).into_owned())
    }

    /// The channels that the header lists.
    pub(crate) fn channels(&self) -> Vec<ExrChannel> {
        self.get("channels").and_then(ExrAttribute::channels).unwrap_or_default()
    }

    /// Left, top, right and bottom of the window of this name, the last two inside of it. Wide
    /// enough that their differences do not overflow.
    #[must_use]
    pub fn window(&self, name: &str) -> Option<[i64; 4]> {
        let (words, _) = self.get(name)?.bytes.as_chunks::<4>();
        let numbers: Vec<i64> = words.iter().map(|&word| i32::from_le_bytes(word).into()).collect();
        numbers.try_into().ok()
    }

    /// The 4 x 4 matrix of this name, row by row.
    #[must_use]
    pub fn matrix(&self, name: &str) -> Option<[[f32; 4]; 4]> {
        let (words, _) = self.get(name)?.bytes.as_chunks::<4>();
        let numbers: Vec<f32> = words.iter().map(|&word| f32::from_le_bytes(word)).collect();
        let (rows, _) = numbers.as_chunks::<4>();
        rows.try_into().ok()
    }

    /// Bytes of all pixels of the part's highest resolution, once they are read.
    pub(crate) fn pixel_bytes(&self) -> u64 {
        let Some([left, top, right, bottom]) = self.window("dataWindow") else { return 0 };
        let side = |first: i64, last: i64| u64::try_from(last - first + 1).unwrap_or(0);
        let pixels = side(left, right).saturating_mul(side(top, bottom));
        let sizes =
            self.channels().into_iter().map(|channel| if channel.kind == "half" { 2 } else { 4 });
        pixels.saturating_mul(sizes.sum())
    }
}

/// A channel as a header lists it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ExrChannel {
    /// Its name, such as `N.X`.
    pub name: String,
    /// `half`, `float` or `uint`.
    pub kind: &'static str,
    /// Whether it has fewer pixels than the data window.
    pub subsampled: bool,
}

/// Reads the headers of all parts, and no pixel.
///
/// # Errors
/// [`FilmError::Read`] if the file cannot be opened, [`FilmError::NotExr`] if it is no EXR or ends
/// within its headers.
pub fn read_exr_headers(path: &Path) -> Result<Vec<ExrHeader>, FilmError> {
    let read_error = |source| FilmError::Read { path: path.into(), source };
    let mut file = File::open(path).map_err(read_error)?.take(LONGEST);
    let mut bytes = Vec::new();
    // Headers are short and pictures are not: more is read only where the headers go on.
    let mut wanted = 1 << 16;
    loop {
        let read = (&mut file).take(wanted).read_to_end(&mut bytes).map_err(read_error)?;
        let ended = (read as u64) < wanted;
        match parse(&bytes) {
            Ok(headers) => return Ok(headers),
            Err(Fault::Short) if !ended => wanted *= 4,
            Err(fault) => {
                return Err(FilmError::NotExr { path: path.into(), reason: fault.reason() });
            }
        }
    }
}

/// Why bytes are no headers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    /// They begin otherwise.
    Magic,
    /// They end too early.
    Short,
}

impl Fault {
    fn reason(self) -> String {
        match self {
            Self::Magic => "found a file that does not begin as one",
            Self::Short => "found a file that ends within its header",
        }
        .to_owned()
    }
}

/// The headers that a file begins with.
pub(crate) fn parse(file: &[u8]) -> Result<Vec<ExrHeader>, Fault> {
    let magic = file.get(..EXR_MAGIC.len());
    if magic.is_none_or(|magic| magic != EXR_MAGIC) {
        return Err(Fault::Magic);
    }
    let several = word(file, 4).ok_or(Fault::Short)? & MULTIPART != 0;
    let mut headers = Vec::new();
    let mut at = START;
    loop {
        // Of several headers, the last is followed by an empty one.
        if several && *file.get(at).ok_or(Fault::Short)? == 0 {
            return Ok(headers);
        }
        let (header, end) = parse_one(file, at).ok_or(Fault::Short)?;
        headers.push(header);
        if !several {
            return Ok(headers);
        }
        at = end;
    }
}

/// The header that begins at `at`, and where what follows it begins.
fn parse_one(file: &[u8], mut at: usize) -> Option<(ExrHeader, usize)> {
    let mut attributes = Vec::new();
    while *file.get(at)? != 0 {
        let name_end = zero_from(file, at)?;
        let kind_end = zero_from(file, name_end + 1)?;
        let start = kind_end + 5;
        let end = start.checked_add(word(file, kind_end + 1)? as usize)?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        attributes.push(ExrAttribute {
            name: text(&file[at..name_end]),
            kind: text(&file[name_end + 1..kind_end]),
            bytes: file.get(start..end)?.to_vec(),
        });
        at = end;
    }
    Some((ExrHeader { attributes }, at + 1))
}

/// Sorts the attributes of a file with one header by name, in place: their total length, and so every
/// offset behind them, stays. `None` if the header does not end.
pub(crate) fn sort_attributes(file: &mut [u8]) -> Option<()> {
    let (mut header, end) = parse_one(file, START)?;
    header.attributes.sort_by(|a, b| a.name.cmp(&b.name));
    let sorted: Vec<u8> = header.attributes.iter().flat_map(ExrAttribute::stored).collect();
    file.get_mut(START..end - 1)?.copy_from_slice(&sorted);
    Some(())
}

impl ExrAttribute {
    /// As it stands in a file.
    fn stored(&self) -> Vec<u8> {
        let length = (self.bytes.len() as u32).to_le_bytes();
        [self.name.as_bytes(), &[0], self.kind.as_bytes(), &[0], &length, &self.bytes].concat()
    }

    /// The value in words: numbers with spaces between, strings as they are; of types without a
    /// short form, how many bytes there are.
    #[must_use]
    pub fn shown(&self) -> String {
        self.typed().unwrap_or_else(|| format!("{} bytes", self.bytes.len()))
    }

    /// `None` where the bytes are not what the type's name says, or have no short form.
    fn typed(&self) -> Option<String> {
        let bytes = self.bytes.as_slice();
        let name = |names: &[&str]| {
            let index = usize::from(*bytes.first().filter(|_| bytes.len() == 1)?);
            Some(names.get(index).map_or_else(|| index.to_string(), |&name| name.to_owned()))
        };
        match self.kind.as_str() {
            "string" => Some(String::from_utf8_lossy(bytes).into_owned()),
            "int" => numbers(bytes, i32::from_le_bytes, 1),
            "float" => numbers(bytes, f32::from_le_bytes, 1),
            "double" => numbers(bytes, f64::from_le_bytes, 1),
            "v2i" => numbers(bytes, i32::from_le_bytes, 2),
            "v3i" => numbers(bytes, i32::from_le_bytes, 3),
            "v2f" => numbers(bytes, f32::from_le_bytes, 2),
            "v3f" => numbers(bytes, f32::from_le_bytes, 3),
            "v2d" => numbers(bytes, f64::from_le_bytes, 2),
            "v3d" => numbers(bytes, f64::from_le_bytes, 3),
            "box2i" => numbers(bytes, i32::from_le_bytes, 4),
            "box2f" => numbers(bytes, f32::from_le_bytes, 4),
            "m33f" => numbers(bytes, f32::from_le_bytes, 9),
            "m33d" => numbers(bytes, f64::from_le_bytes, 9),
            "m44f" => numbers(bytes, f32::from_le_bytes, 16),
            "m44d" => numbers(bytes, f64::from_le_bytes, 16),
            "chromaticities" => numbers(bytes, f32::from_le_bytes, 8),
            "rational" => {
                let (above, below) = (word(bytes, 0)?.cast_signed(), word(bytes, 4)?);
                Some(format!("{above}/{below}"))
            }
            "timecode" | "keycode" => numbers(bytes, u32::from_le_bytes, bytes.len() / 4),
            "compression" => name(&COMPRESSIONS),
            "lineOrder" => name(&["increasing y", "decreasing y", "random"]),
            "envmap" => name(&["latitude and longitude", "cube"]),
            "tiledesc" => self.tiles(),
            "stringvector" => self.strings(),
            "chlist" => {
                let listed = |channel: ExrChannel| format!("{} {}", channel.name, channel.kind);
                Some(self.channels()?.into_iter().map(listed).collect::<Vec<_>>().join(", "))
            }
            _ => None,
        }
    }

    fn tiles(&self) -> Option<String> {
        let (width, height) = (word(&self.bytes, 0)?, word(&self.bytes, 4)?);
        let levels = match self.bytes.get(8)? & 0x0f {
            0 => "one level",
            1 => "mip-maps",
            _ => "rip-maps",
        };
        Some(format!("{width}x{height}, {levels}"))
    }

    fn strings(&self) -> Option<String> {
        let (mut at, mut strings) = (0, Vec::new());
        while at < self.bytes.len() {
            let end = (at + 4).checked_add(word(&self.bytes, at)? as usize)?;
            strings.push(String::from_utf8_lossy(self.bytes.get(at + 4..end)?).into_owned());
            at = end;
        }
        Some(strings.join(", "))
    }

    /// What a list of channels says.
    fn channels(&self) -> Option<Vec<ExrChannel>> {
        let (mut at, mut channels) = (0, Vec::new());
        while *self.bytes.get(at)? != 0 {
            let end = zero_from(&self.bytes, at)?;
            let kind = match word(&self.bytes, end + 1)? {
                0 => "uint",
                1 => "half",
                2 => "float",
                _ => return None,
            };
            // Between type and steps: linearity, with three bytes of padding.
            let steps = [word(&self.bytes, end + 9)?, word(&self.bytes, end + 13)?];
            let name = String::from_utf8_lossy(&self.bytes[at..end]).into_owned();
            channels.push(ExrChannel { name, kind, subsampled: steps != [1, 1] });
            at = end + 17;
        }
        Some(channels)
    }
}

/// OpenEXR's compressions by their number in files.
pub(crate) const COMPRESSIONS: [&str; 14] = [
    "none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB", "HTJ2K256",
    "HTJ2K32", "LJ2K", "ZSTD",
];
/// How many of them are read, from the first on.
pub(crate) const COMPRESSIONS_READ: u8 = 10;

/// So many numbers with spaces between, if the bytes are just these. `{:?}` prints the shortest
/// decimal that parses back to the same number.
fn numbers<const N: usize, T: std::fmt::Debug>(
    bytes: &[u8],
    number: impl Fn([u8; N]) -> T,
    count: usize,
) -> Option<String> {
    let (chunks, rest) = bytes.as_chunks::<N>();
    let shown = || {
        let texts: Vec<String> =
            chunks.iter().map(|&chunk| format!("{:?}", number(chunk))).collect();
        texts.join(" ")
    };
    (chunks.len() == count && rest.is_empty()).then(shown)
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

/// Place of the first zero byte at or after `start`.
fn zero_from(bytes: &[u8], start: usize) -> Option<usize> {
    bytes.get(start..)?.iter().position(|&byte| byte == 0).map(|offset| start + offset)
}
