//! A file read in blocks, as bytes and as lines, or from any place.

use std::cell::Cell;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::rc::Rc;

/// How much is asked of the file at once.
const BLOCK: usize = 1 << 20;

/// A point file, read from its beginning on, that tells how far it is.
pub(crate) struct Source<'a> {
    file: Bytes<'a>,
    /// The file's length where it is known.
    length: Option<u64>,
    progress: &'a mut dyn FnMut(u64, u64),
    buffer: Vec<u8>,
    /// The part of the buffer that was read from the file and not yet consumed.
    start: usize,
    end: usize,
    /// Bytes read from the file so far.
    read: u64,
    /// Bytes read before it was begun again.
    before: u64,
    /// Where the file is packed: bytes of it that were read, and how many it has.
    packed: Option<(Rc<Cell<u64>>, Option<u64>)>,
}

/// Where bytes come from.
enum Bytes<'a> {
    /// A pipe.
    Stream(Box<dyn Read + 'a>),
    File(Box<dyn ReadSeek + 'a>),
}

trait ReadSeek: Read + Seek {}
impl<T: Read + Seek> ReadSeek for T {}

/// A point file that is read from any place. A pipe is held in memory.
pub(crate) struct Seekable<'a> {
    file: Box<dyn ReadSeek + 'a>,
    length: u64,
    progress: &'a mut dyn FnMut(u64, u64),
    at: u64,
    /// As far as any read has come.
    farthest: u64,
    /// What counts instead where the file is read at several places in turn.
    passes: Option<Passes>,
}

/// A file that is gone through several times.
struct Passes {
    /// What was reported before this pass.
    before: u64,
    /// What a whole file read in this pass adds to it.
    share: u64,
    /// Bytes read in this pass.
    read: u64,
}

/// What stands in the file up to the next line end.
pub(crate) enum Line<'a> {
    /// A line without its end, which may be the file's end.
    Whole(&'a [u8]),
    /// It is longer than was asked for.
    TooLong,
    /// Nothing is left in the file.
    End,
}

impl<'a> Source<'a> {
    /// A file whose length is known, at its beginning.
    pub(crate) fn of_file(
        file: impl Read + Seek + 'a,
        length: u64,
        progress: &'a mut dyn FnMut(u64, u64),
    ) -> Self {
        Self::new(Bytes::File(Box::new(file)), Some(length), progress)
    }

    /// What has no length and no way back.
    pub(crate) fn of_stream(file: impl Read + 'a, progress: &'a mut dyn FnMut(u64, u64)) -> Self {
        Self::new(Bytes::Stream(Box::new(file)), None, progress)
    }

    fn new(file: Bytes<'a>, length: Option<u64>, progress: &'a mut dyn FnMut(u64, u64)) -> Self {
        // A small file needs no large buffer; one byte more, to meet the end at once.
        let known = length.and_then(|length| usize::try_from(length).ok()).unwrap_or(BLOCK);
        let buffer = vec![0; known.clamp(63, BLOCK - 1) + 1];
        Self { file, length, progress, buffer, start: 0, end: 0, read: 0, before: 0, packed: None }
    }

    /// The whole file, to be read from any place, whatever was consumed of it.
    pub(crate) fn seekable(mut self) -> io::Result<Seekable<'a>> {
        let (file, length): (Box<dyn ReadSeek + 'a>, u64) = match self.file {
            Bytes::File(mut file) => {
                let length = file.seek(SeekFrom::End(0))?;
                file.rewind()?;
                (file, length)
            }
            Bytes::Stream(ref mut stream) => {
                debug_assert_eq!(self.read, self.end as u64, "source: bytes of a pipe are gone");
                let mut bytes = self.buffer[..self.end].to_vec();
                stream.read_to_end(&mut bytes)?;
                let length = bytes.len() as u64;
                (Box::new(Cursor::new(bytes)), length)
            }
        };
        Ok(Seekable {
            file,
            length,
            progress: self.progress,
            at: 0,
            farthest: self.read,
            passes: None,
        })
    }

    /// What `unpack` makes of the file, from its beginning, whatever was shown of it. It gets the file,
    /// how many bytes of that were read, and how many it has.
    pub(crate) fn through(
        self,
        unpack: impl FnOnce(Box<dyn Read + 'a>, Rc<Cell<u64>>, Option<u64>) -> Box<dyn Read + 'a>,
    ) -> Self {
        debug_assert_eq!(self.read, self.end as u64, "source: bytes of the file are gone");
        let Self { file, length, progress, mut buffer, end, read: before, .. } = self;
        buffer.truncate(end);
        let rest: Box<dyn Read + 'a> = match file {
            Bytes::Stream(stream) => stream,
            Bytes::File(file) => Box::new(file),
        };
        let read = Rc::new(Cell::new(0));
        let counted = Counted { reader: Cursor::new(buffer).chain(rest), read: read.clone() };
        let unpacked = unpack(Box::new(counted), read.clone(), length);
        let unpacked = Self::new(Bytes::Stream(unpacked), None, progress);
        Self { before, packed: Some((read, length)), ..unpacked }
    }

    /// Whether [`rewind`](Self::rewind) can go back to the beginning: not in what is unpacked or a pipe.
    pub(crate) fn can_rewind(&self) -> bool {
        matches!(self.file, Bytes::File(_))
    }

    /// Goes back to the beginning, and says whether it can.
    pub(crate) fn rewind(&mut self) -> io::Result<bool> {
        let Bytes::File(file) = &mut self.file else { return Ok(false) };
        file.rewind()?;
        self.before = self.read;
        (self.start, self.end, self.read) = (0, 0, 0);
        Ok(true)
    }

    /// Bytes of the file that are not consumed, where its length is known.
    pub(crate) fn left(&self) -> Option<u64> {
        let consumed = self.read - (self.end - self.start) as u64;
        self.length.map(|length| length.saturating_sub(consumed))
    }

    /// For how many records memory may be asked: as many as declared, but no more than the file has
    /// bytes for, at `least` bytes each; none where its length is not known.
    pub(crate) fn records(&self, declared: u64, least: u64) -> u64 {
        self.left().map_or(0, |left| declared.min(left / least.max(1)))
    }

    /// What is not yet consumed: at least `wanted` bytes, unless the file ends before.
    pub(crate) fn fill(&mut self, wanted: usize) -> io::Result<&[u8]> {
        if self.end - self.start < wanted {
            self.buffer.copy_within(self.start..self.end, 0);
            self.end -= self.start;
            self.start = 0;
            if self.buffer.len() < wanted {
                self.buffer.resize(wanted.next_power_of_two(), 0);
            }
            while self.end < wanted {
                let free = &mut self.buffer[self.end..];
                let read = match &mut self.file {
                    Bytes::Stream(stream) => stream.read(free),
                    Bytes::File(file) => file.read(free),
                };
                match read {
                    Ok(0) => break,
                    Ok(count) => {
                        self.end += count;
                        self.read += count as u64;
                        match &self.packed {
                            None => (self.progress)(
                                self.read.max(self.before),
                                self.length.unwrap_or(0),
                            ),
                            Some((read, length)) => {
                                let read = read.get().max(self.before);
                                (self.progress)(read, length.unwrap_or(0));
                            }
                        }
                    }
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => (),
                    Err(error) => return Err(error),
                }
            }
        }
        Ok(&self.buffer[self.start..self.end])
    }

    /// Passes over bytes that [`fill`](Self::fill) has shown.
    pub(crate) fn consume(&mut self, count: usize) {
        self.start += count;
        debug_assert!(self.start <= self.end, "source: consumed what was not filled");
    }

    /// Passes over bytes, and says how many there were.
    pub(crate) fn skip(&mut self, count: u64) -> io::Result<u64> {
        let mut skipped = 0;
        while skipped < count {
            let there = self.fill(1)?.len();
            if there == 0 {
                break;
            }
            let step = there.min(usize::try_from(count - skipped).unwrap_or(usize::MAX));
            self.consume(step);
            skipped += step as u64;
        }
        Ok(skipped)
    }

    /// The next line, which ends with the byte `line_end`. A carriage return before that belongs
    /// to the line's end.
    pub(crate) fn line(&mut self, line_end: u8, longest: usize) -> io::Result<Line<'_>> {
        let mut searched = 0;
        let (length, end) = loop {
            let there = self.fill(searched + 1)?;
            if there.len() == searched {
                break (searched, 0); // the file ends
            }
            let found = there[searched..].iter().position(|&byte| byte == line_end);
            if let Some(found) = found {
                break (searched + found, 1);
            }
            searched = there.len();
            if searched > longest {
                return Ok(Line::TooLong);
            }
        };
        if length > longest {
            return Ok(Line::TooLong);
        }
        if length + end == 0 {
            return Ok(Line::End);
        }
        let start = self.start;
        self.consume(length + end);
        let line = &self.buffer[start..start + length];
        Ok(Line::Whole(line.strip_suffix(b"\r").unwrap_or(line)))
    }
}

/// Counts what is read.
struct Counted<R> {
    reader: R,
    read: Rc<Cell<u64>>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer)?;
        self.read.set(self.read.get() + count as u64);
        Ok(count)
    }
}

impl Passes {
    fn reported(&self, length: u64) -> u64 {
        let part = u128::from(self.share) * u128::from(self.read.min(length));
        self.before + (part / u128::from(length.max(1))) as u64
    }
}

impl Seekable<'_> {
    /// From now on, progress is how much was read, wherever it was. A first pass is worth half of
    /// the file at most, the last one what is left.
    pub(crate) fn begin_pass(&mut self, last: bool) {
        let before = match &self.passes {
            Some(passes) => passes.reported(self.length),
            None => self.farthest.min(self.length),
        };
        let left = self.length.saturating_sub(before);
        let share = if last { left } else { left / 2 };
        self.passes = Some(Passes { before, share, read: 0 });
    }

    /// Bytes of the file.
    pub(crate) fn length(&self) -> u64 {
        self.length
    }

    /// So many bytes from a place on. Fails with `UnexpectedEof` before any memory is asked for,
    /// where the file has fewer.
    pub(crate) fn bytes_at(&mut self, place: u64, count: u64) -> io::Result<Vec<u8>> {
        if place.checked_add(count).is_none_or(|end| end > self.length) {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        self.seek(SeekFrom::Start(place))?;
        let mut bytes = Vec::new();
        let wanted = usize::try_from(count).map_err(|_| io::ErrorKind::OutOfMemory)?;
        bytes.try_reserve_exact(wanted).map_err(|_| io::ErrorKind::OutOfMemory)?;
        bytes.resize(wanted, 0);
        self.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

impl Read for Seekable<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.at += count as u64;
        if let Some(passes) = &mut self.passes {
            passes.read += count as u64;
            (self.progress)(passes.reported(self.length), self.length);
            return Ok(count);
        }
        if self.at > self.farthest {
            self.farthest = self.at;
            (self.progress)(self.farthest.min(self.length), self.length);
        }
        Ok(count)
    }
}

impl Seek for Seekable<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = self.file.seek(to)?;
        Ok(self.at)
    }
}
