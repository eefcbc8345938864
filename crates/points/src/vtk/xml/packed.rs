//! The bytes of an array: as they are or in base64, packed in blocks or not.
//!
//! Before the bytes stands how many there are; where they are packed, how many blocks, their length
//! unpacked, that of the last, and of each its length packed. None of that is believed: a block is
//! unpacked as far as it is asked for.

use crate::columns::fill;
use flate2::Crc;
use flate2::read::ZlibDecoder;
use lzma_rust2::XzReader;
use std::io::{self, BufRead, Cursor, Read};

/// Longest block of LZ4, which is unpacked as a whole.
const MAX_LZ4_BLOCK: u64 = 1 << 24;
/// Most memory for unpacking LZMA, in units of 1024 bytes: the dictionary of the highest preset, and
/// what comes with it. A block asks for no more than its own length.
const MAX_LZMA_MEMORY: u32 = (64 << 10) + 256;

/// How blocks are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    Zlib,
    Lz4,
    Lzma,
}

/// How lengths are stored.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lengths {
    /// Whether they have 64 bits.
    pub(super) long: bool,
    pub(super) big: bool,
}

/// The unpacked bytes of an array.
pub(super) struct Packed<R> {
    reader: R,
    lengths: Lengths,
    packing: Option<Packing>,
    /// Of the array, as far as is asked for.
    needed: u64,
    state: State,
}

enum State {
    /// Before the first length.
    Start,
    /// So many bytes are left.
    Plain(u64),
    Blocks(Blocks),
}

struct Blocks {
    /// Packed lengths of those to come, the next one last.
    packed: Vec<u64>,
    /// Unpacked length of each, and of the last one.
    length: u64,
    last: u64,
    /// The block that is being read.
    block: Box<dyn Read>,
    /// Bytes of it that are to come.
    left: u64,
}

fn damaged(message: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, message.into())
}

/// Packed in a way that is sound but not read.
fn unread(error: &io::Error) -> io::Error {
    let message = format!(
        "LZMA blocks with a dictionary beyond 64 MiB, or of a kind that is not read ({error})"
    );
    io::Error::new(io::ErrorKind::Unsupported, message)
}

impl<R: Read> Packed<R> {
    /// The bytes behind the lengths that come next. `needed` of them will be read.
    pub(super) fn new(reader: R, lengths: Lengths, packing: Option<Packing>, needed: u64) -> Self {
        Self { reader, lengths, packing, needed, state: State::Start }
    }

    fn length(&mut self) -> io::Result<u64> {
        let mut bytes = [0; 8];
        let size = if self.lengths.long { 8 } else { 4 };
        self.reader.read_exact(&mut bytes[..size])?;
        Ok(match (self.lengths.long, self.lengths.big) {
            (true, false) => u64::from_le_bytes(bytes),
            (true, true) => u64::from_be_bytes(bytes),
            (false, false) => u64::from_le_bytes(bytes),
            (false, true) => u64::from_be_bytes(bytes) >> 32,
        })
    }

    fn start(&mut self) -> io::Result<State> {
        if self.packing.is_none() {
            let length = self.length()?;
            if length < self.needed {
                let needed = self.needed;
                return Err(damaged(format!(
                    "a length of {length} bytes where {needed} are needed"
                )));
            }
            return Ok(State::Plain(self.needed));
        }
        let [count, length, last] = [self.length()?, self.length()?, self.length()?];
        let last = if last == 0 { length } else { last };
        let unpacked = count.saturating_sub(1).saturating_mul(length);
        let unpacked = unpacked.saturating_add(if count == 0 { 0 } else { last });
        if unpacked < self.needed || count > self.needed.max(1) {
            let needed = self.needed;
            return Err(damaged(format!(
                "{count} blocks of {length} bytes, the last one of {last}, where {needed} bytes \
                 are needed"
            )));
        }
        let mut packed = Vec::new();
        for _ in 0..count {
            packed.push(self.length()?);
        }
        packed.reverse();
        Ok(State::Blocks(Blocks { packed, length, last, block: Box::new(io::empty()), left: 0 }))
    }
}

impl<R: Read> Read for Packed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if matches!(self.state, State::Start) {
            self.state = self.start()?;
        }
        let short = |left: u64| usize::try_from(left).unwrap_or(usize::MAX).min(buffer.len());
        match &mut self.state {
            State::Start => Ok(0),
            State::Plain(left) => {
                let wanted = short(*left);
                let count = self.reader.read(&mut buffer[..wanted])?;
                *left -= count as u64;
                Ok(count)
            }
            State::Blocks(blocks) => {
                while blocks.left == 0 {
                    let Some(packed) = blocks.packed.pop() else { return Ok(0) };
                    let length = if blocks.packed.is_empty() { blocks.last } else { blocks.length };
                    let mut bytes = Vec::new();
                    (&mut self.reader).take(packed).read_to_end(&mut bytes)?;
                    if (bytes.len() as u64) < packed {
                        return Err(io::ErrorKind::UnexpectedEof.into());
                    }
                    blocks.block = open(bytes, self.packing, length)?;
                    blocks.left = length;
                }
                let wanted = short(blocks.left);
                let count =
                    fill(&mut blocks.block, &mut buffer[..wanted]).map_err(|error| match error
                        .kind()
                    {
                        io::ErrorKind::OutOfMemory | io::ErrorKind::Unsupported => unread(&error),
                        _ => damaged(format!("a block that cannot be unpacked: {error}")),
                    })?;
                if count < wanted {
                    return Err(damaged("a block that is shorter than its length"));
                }
                blocks.left -= count as u64;
                Ok(count)
            }
        }
    }
}

/// Unpacks a block whose unpacked length should be `length`.
fn open(bytes: Vec<u8>, packing: Option<Packing>, length: u64) -> io::Result<Box<dyn Read>> {
    Ok(match packing {
        None => Box::new(Cursor::new(bytes)),
        Some(Packing::Zlib) => Box::new(ZlibDecoder::new(Cursor::new(bytes))),
        Some(Packing::Lzma) => {
            let mut bytes = bytes;
            needed_dictionary(&mut bytes, length);
            Box::new(XzReader::new_mem_limit(Cursor::new(bytes), false, MAX_LZMA_MEMORY))
        }
        Some(Packing::Lz4) => {
            if length > MAX_LZ4_BLOCK {
                let message = format!("a block of LZ4 of {length} bytes, beyond {MAX_LZ4_BLOCK}");
                return Err(io::Error::new(io::ErrorKind::Unsupported, message));
            }
            let unpacked = lz4_flex::block::decompress(&bytes, length as usize);
            Box::new(Cursor::new(unpacked.map_err(|error| damaged(error.to_string()))?))
        }
    })
}

/// Lowers the dictionary of a block of LZMA to what `length` unpacked bytes can refer to.
///
/// The dictionary is memory that a decoder asks for at once: 64 MiB by the highest preset, however
/// short the block is, and every array of a file has a decoder. The format is that of xz: a header of
/// 12 bytes, then that of the first block with its own length, flags, lengths, filters and checksum.
fn needed_dictionary(bytes: &mut [u8], length: u64) {
    const STREAM: usize = 12;
    const LZMA2: u8 = 0x21;
    let Some(&words) = bytes.get(STREAM).filter(|&&words| words > 0) else { return };
    let Some(header) = bytes.get_mut(STREAM..STREAM + 4 * (usize::from(words) + 1)) else { return };
    let (header, checksum) = header.split_at_mut(header.len() - 4);
    if checksum_of(header).to_le_bytes() != *checksum {
        return; // damaged, which unpacking finds
    }
    let mut place = 2;
    let mut number = |header: &[u8]| {
        while header.get(place).is_some_and(|byte| byte & 0x80 != 0) {
            place += 1;
        }
        place += 1;
        place
    };
    // One filter, which must be the last; before it, the lengths that there are.
    let flags = header[1];
    for bit in [0x40, 0x80] {
        if flags & bit != 0 {
            number(header);
        }
    }
    let end = number(header);
    let is_lzma = header.get(end - 1..=end) == Some(&[LZMA2, 1]);
    let Some(dictionary) = header.get_mut(end + 1).filter(|_| flags & 3 == 0 && is_lzma) else {
        return;
    };
    // 4096, 6144, 8192, 12288, …
    let size = |code: u8| (2 | u64::from(code & 1)) << (code / 2 + 11);
    let Some(enough) = (0..40).find(|&code| size(code) >= length) else { return };
    *dictionary = enough.min(*dictionary);
    let sum = checksum_of(header);
    checksum.copy_from_slice(&sum.to_le_bytes());
}

fn checksum_of(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

/// Bytes in base64. Blanks between the signs are passed over, and after the padding that ends one
/// text another may follow.
pub(super) struct Base64<R> {
    reader: R,
    /// Bits that are no whole byte yet, and how many.
    bits: u32,
    count: u32,
}

/// What is no sign of base64.
const NONE: u8 = 0x80;
/// The value of each sign.
const VALUES: [u8; 256] = {
    let mut values = [NONE; 256];
    let signs = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut value = 0;
    while value < signs.len() {
        values[signs[value] as usize] = value as u8;
        value += 1;
    }
    values
};

impl<R: BufRead> Base64<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, bits: 0, count: 0 }
    }
}

impl<R: BufRead> Read for Base64<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut written = 0;
        while written == 0 && !buffer.is_empty() {
            let there = self.reader.fill_buf()?;
            if there.is_empty() {
                return Ok(0);
            }
            let mut read = 0;
            if self.count == 0 {
                // Four signs are three bytes.
                for (signs, bytes) in there.chunks_exact(4).zip(buffer.chunks_exact_mut(3)) {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|i| VALUES[usize::from(signs[i])]);
                    if (a | b | c | d) & NONE != 0 {
                        break;
                    }
                    let bits =
                        [a, b, c, d].iter().fold(0, |bits, &value| bits << 6 | u32::from(value));
                    bytes.copy_from_slice(&bits.to_be_bytes()[1..]);
                    read += 4;
                    written += 3;
                }
            }
            for &sign in &there[read..] {
                if written == buffer.len() {
                    break;
                }
                read += 1;
                let value = match VALUES[usize::from(sign)] {
                    NONE if sign == b'=' => {
                        self.count = 0;
                        continue;
                    }
                    NONE if sign.is_ascii_whitespace() => continue,
                    NONE => return Err(damaged(format!("'{}' in base64", sign.escape_ascii()))),
                    value => value,
                };
                self.bits = self.bits << 6 | u32::from(value);
                self.count += 6;
                if self.count >= 8 {
                    self.count -= 8;
                    buffer[written] = (self.bits >> self.count) as u8;
                    written += 1;
                }
                if self.count == 0 {
                    break; // back to four at a time
                }
            }
            self.reader.consume(read);
        }
        Ok(written)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lzma_rust2::{XzOptions, XzWriter};
    use std::io::Write;

    fn decoded(text: &str) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        Base64::new(text.as_bytes()).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    #[test]
    fn base64_goes_on_behind_padding() {
        assert_eq!(decoded("").unwrap(), b"");
        assert_eq!(decoded(" AQID\n").unwrap(), [1, 2, 3]);
        assert_eq!(decoded("AQ==AgM=\tBA==").unwrap(), [1, 2, 3, 4]);
        assert_eq!(decoded("+/+/").unwrap(), [0xfb, 0xff, 0xbf]);
        assert_eq!(decoded("AQ<").unwrap_err().to_string(), "'<' in base64");
    }

    fn unpacked(bytes: &[u8], needed: u64, packing: Option<Packing>) -> io::Result<Vec<u8>> {
        let lengths = Lengths { long: false, big: false };
        let mut out = Vec::new();
        let mut packed = Packed::new(bytes, lengths, packing, needed);
        (&mut packed).take(needed).read_to_end(&mut out)?;
        Ok(out)
    }

    fn words(words: &[u32]) -> Vec<u8> {
        words.iter().flat_map(|word| word.to_le_bytes()).collect()
    }

    /// A block asks for no more memory than it has bytes, whatever the preset; a dictionary beyond
    /// that of the highest is refused by name.
    #[test]
    fn every_preset_of_lzma_is_read() {
        let contents: Vec<u8> = (0..10_000u32).flat_map(|i| (i * i % 251).to_le_bytes()).collect();
        let length = contents.len() as u32;
        let packed = |options: XzOptions| {
            let mut writer = XzWriter::new(Vec::new(), options).unwrap();
            writer.write_all(&contents).unwrap();
            writer.finish().unwrap()
        };
        let block =
            |bytes: &[u8]| [words(&[1, length, 0, bytes.len() as u32]), bytes.to_vec()].concat();
        for preset in 0..=9 {
            let bytes = packed(XzOptions::with_preset(preset));
            let found = unpacked(&block(&bytes), length.into(), Some(Packing::Lzma)).unwrap();
            assert!(found == contents, "preset {preset}");
            let mut lowered = bytes.clone();
            needed_dictionary(&mut lowered, length.into());
            // 4096 is code 0, and 49152 is the first that holds 40 000 bytes.
            assert_eq!(lowered[12 + 4], 7.min(bytes[12 + 4]), "preset {preset}");
        }
        let mut options = XzOptions::with_preset(0);
        options.lzma_options.dict_size = 1 << 27;
        let bytes = packed(options);
        let mut claim = block(&bytes);
        claim[4..8].copy_from_slice(&(1u32 << 30).to_le_bytes());
        let error = unpacked(&claim, length.into(), Some(Packing::Lzma)).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::Unsupported);
        assert!(error.to_string().contains("a dictionary beyond 64 MiB"), "{error}");
        for cut in 0..bytes.len() {
            needed_dictionary(&mut bytes[..cut].to_vec(), 10);
        }
    }

    #[test]
    fn lengths_are_not_believed() {
        let message = |bytes: &[u8], needed, packing| {
            unpacked(bytes, needed, packing).unwrap_err().to_string()
        };
        assert_eq!(message(&words(&[5, 0, 0]), 6, None), "a length of 5 bytes where 6 are needed");
        assert_eq!(unpacked(&words(&[u32::MAX, 1]), 100, None).unwrap(), [1, 0, 0, 0]);
        let zlib = Some(Packing::Zlib);
        assert!(message(&words(&[1, 5, 0, 9]), 6, zlib).starts_with("1 blocks of 5 bytes"));
        assert!(message(&words(&[u32::MAX, 1, 1]), 6, zlib).contains("where 6 bytes are needed"));
        assert_eq!(
            unpacked(&words(&[1, u32::MAX, 0, u32::MAX, 7]), 6, zlib).unwrap_err().kind(),
            io::ErrorKind::UnexpectedEof
        );
        assert!(message(&words(&[1, 6, 0, 4, 7]), 6, zlib).contains("cannot be unpacked"));
        let lz4 = Some(Packing::Lz4);
        let long = unpacked(&words(&[1, 1 << 30, 0, 4, 7]), 6, lz4).unwrap_err();
        assert_eq!(long.kind(), io::ErrorKind::Unsupported);
        assert_eq!(long.to_string(), "a block of LZ4 of 1073741824 bytes, beyond 16777216");
        let lzma = Some(Packing::Lzma);
        assert!(message(&words(&[1, 6, 0, 4, 7]), 6, lzma).contains("cannot be unpacked"));
    }
}
