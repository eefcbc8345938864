//! The file's pages: each ends with a checksum, which is no part of what is read.

use super::Fault;
use crate::error::Quoted;
use crate::source::Seekable;
use std::io::{self, Read, Seek, SeekFrom};

/// Bytes of the header, and of a checksum.
const HEADER: u64 = 48;
const CHECKSUM: u64 = 4;
/// Pages have 1024 bytes; others are possible.
const SIZES: std::ops::RangeInclusive<u64> = 64..=1 << 20;
/// Longest description of a file.
const MAX_XML: u64 = 64 << 20;

/// A file without its checksums.
pub(super) struct Pages<'a> {
    file: Seekable<'a>,
    version: [u32; 2],
    /// Of a page, with its checksum.
    size: u64,
    /// Where the description is, physically, and how many bytes of it there are.
    xml: (u64, u64),
    /// The page in `buffer`.
    page: Option<u64>,
    buffer: Vec<u8>,
    /// Logical place that is read next.
    at: u64,
    table: [u32; 256],
}

impl<'a> Pages<'a> {
    pub(super) fn new(mut file: Seekable<'a>) -> Result<Self, Fault> {
        if file.length() < HEADER {
            let found = format!("{} bytes", file.length());
            return Err(Fault::wrong("the file", found, "an E57 header of 48 bytes"));
        }
        let header = file.bytes_at(0, HEADER)?;
        if !super::sniff(&header) {
            let found = format!("bytes that begin with {}", Quoted(&header[..8]));
            return Err(Fault::unread("the file", found, "ASTM-E57, as E57 files begin"));
        }
        let u32_at = |place: usize| {
            let mut array = [0; 4];
            array.copy_from_slice(&header[place..place + 4]);
            u32::from_le_bytes(array)
        };
        let u64_at = |place: usize| u64::from(u32_at(place)) | u64::from(u32_at(place + 4)) << 32;
        let version = [u32_at(8), u32_at(12)];
        if version[0] != 1 {
            let found = format!("{}.{}", version[0], version[1]);
            return Err(Fault::unread("the version", found, "1.0"));
        }
        let size = u64_at(40);
        if !SIZES.contains(&size) {
            return Err(Fault::unread("the size of a page", size, "64 to 1048576"));
        }
        Ok(Self {
            file,
            version,
            size,
            xml: (u64_at(24), u64_at(32)),
            page: None,
            buffer: vec![0; size as usize],
            at: 0,
            table: checksum_table(),
        })
    }

    pub(super) fn version(&self) -> String {
        format!("{}.{}", self.version[0], self.version[1])
    }

    /// Bytes of the file.
    pub(super) fn length(&self) -> u64 {
        self.file.length()
    }

    /// The description.
    pub(super) fn xml(&mut self) -> Result<String, Fault> {
        let (place, length) = self.xml;
        if length > MAX_XML.min(self.file.length()) {
            let expected = format!("at most {}", MAX_XML.min(self.file.length()));
            return Err(Fault::wrong("the length of the XML section", length, expected));
        }
        self.seek(self.logical(place));
        let mut bytes = vec![0; length as usize];
        self.read(&mut bytes)?;
        String::from_utf8(bytes)
            .map_err(|_| Fault::wrong("the XML section", "bytes that are no text", "UTF-8"))
    }

    /// Place without checksums of a place in the file.
    pub(super) fn logical(&self, physical: u64) -> u64 {
        let (page, within) = (physical / self.size, physical % self.size);
        page * (self.size - CHECKSUM) + within.min(self.size - CHECKSUM)
    }

    pub(super) fn seek(&mut self, logical: u64) {
        self.at = logical;
    }

    pub(super) fn position(&self) -> u64 {
        self.at
    }

    /// Fills the buffer.
    pub(super) fn read(&mut self, mut buffer: &mut [u8]) -> Result<(), Fault> {
        let contents = self.size - CHECKSUM;
        while !buffer.is_empty() {
            let (page, within) = (self.at / contents, self.at % contents);
            if self.page != Some(page) {
                self.load(page)?;
            }
            let step = buffer.len().min((contents - within) as usize);
            let (now, later) = buffer.split_at_mut(step);
            now.copy_from_slice(&self.buffer[within as usize..within as usize + step]);
            self.at += step as u64;
            buffer = later;
        }
        Ok(())
    }

    fn load(&mut self, page: u64) -> Result<(), Fault> {
        let place = page.saturating_mul(self.size);
        if place.saturating_add(self.size) > self.file.length() {
            return Err(Fault::Io(io::ErrorKind::UnexpectedEof.into()));
        }
        self.page = None;
        if self.file.stream_position()? != place {
            self.file.seek(SeekFrom::Start(place))?;
        }
        self.file.read_exact(&mut self.buffer)?;
        let (contents, stored) = self.buffer.split_at((self.size - CHECKSUM) as usize);
        let sum = !contents.iter().fold(!0, |sum, &byte| {
            self.table[((sum ^ u32::from(byte)) & 0xff) as usize] ^ sum >> 8
        });
        if sum.to_be_bytes() != stored {
            let found = format!("{stored:02x?}");
            let place = format!("the checksum of page {page}");
            return Err(Fault::wrong(place, found, format!("{:02x?}", sum.to_be_bytes())));
        }
        self.page = Some(page);
        Ok(())
    }
}

/// CRC-32C by bytes.
pub(super) fn checksum_table() -> [u32; 256] {
    let mut table = [0; 256];
    for (entry, byte) in table.iter_mut().zip(0u32..) {
        *entry = (0..8)
            .fold(byte, |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0x82f6_3b78 } else { sum >> 1 });
    }
    table
}
