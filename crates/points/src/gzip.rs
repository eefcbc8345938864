//! Files packed by gzip: what is inside them is read as if it were the file.
//!
//! A text of gigabytes may be in a file of kilobytes that was made to fill memory, so one that
//! unpacks to much more than a text does is refused, as archives of NumPy are.

use crate::columns::is_too_large;
use crate::error::PointsError;
use crate::source::Source;
use flate2::bufread::GzDecoder;
use std::cell::Cell;
use std::fmt;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Bytes that are unpacked at once.
const BUFFER: usize = 1 << 16;

/// Whether a file that begins so is packed by gzip.
pub(crate) fn sniff(start: &[u8]) -> bool {
    start.starts_with(b"\x1f\x8b\x08")
}

/// The name of a file without the ending that says that it is packed.
pub(crate) fn inner_name(path: &Path) -> PathBuf {
    let is_gz = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("gz"));
    if is_gz { path.with_extension("") } else { path.into() }
}

/// What is packed in a file, from its beginning.
pub(crate) fn unpacked(source: Source<'_>) -> Source<'_> {
    source.through(|packed, read, length| {
        let packed = BufReader::with_capacity(BUFFER, packed);
        Box::new(Unpacked { reader: Members::new(packed), unpacked: 0, read, length })
    })
}

/// What is packed in several parts, one after the other. Zeros after the last, with which tapes and some programs
/// fill blocks, are passed over, as gunzip does.
struct Members<R> {
    /// `None` at the end.
    member: Option<GzDecoder<R>>,
}

impl<R: BufRead> Members<R> {
    fn new(packed: R) -> Self {
        Self { member: Some(GzDecoder::new(packed)) }
    }
}

impl<R: BufRead> Read for Members<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while let Some(member) = &mut self.member {
            let count = member.read(buffer)?;
            if count > 0 || buffer.is_empty() {
                return Ok(count);
            }
            let Some(mut packed) = self.member.take().map(GzDecoder::into_inner) else { break };
            loop {
                let there = packed.fill_buf()?;
                let zeros = there.iter().take_while(|&&byte| byte == 0).count();
                if there.is_empty() {
                    break;
                }
                if zeros < there.len() {
                    packed.consume(zeros);
                    self.member = Some(GzDecoder::new(packed));
                    break;
                }
                packed.consume(zeros);
            }
        }
        Ok(0)
    }
}

/// Unpacked bytes, as long as they are not too many.
struct Unpacked<R> {
    reader: R,
    unpacked: u64,
    /// Packed bytes read so far.
    read: Rc<Cell<u64>>,
    /// Of the file, where that is known.
    length: Option<u64>,
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(buffer).map_err(|error| match error.kind() {
            io::ErrorKind::InvalidData
            | io::ErrorKind::InvalidInput
            | io::ErrorKind::UnexpectedEof => Trouble::Damaged(error.to_string()).into(),
            _ => error,
        })?;
        self.unpacked += count as u64;
        let length = self.length.unwrap_or(self.read.get());
        if is_too_large(self.unpacked, length) {
            return Err(Trouble::TooLarge { unpacked: self.unpacked, length }.into());
        }
        Ok(count)
    }
}

/// What is wrong with packed bytes.
#[derive(Debug)]
enum Trouble {
    Damaged(String),
    TooLarge { unpacked: u64, length: u64 },
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Damaged(message) => f.write_str(message),
            Self::TooLarge { unpacked, .. } => write!(f, "{unpacked} bytes"),
        }
    }
}

impl std::error::Error for Trouble {}

impl From<Trouble> for io::Error {
    fn from(trouble: Trouble) -> Self {
        Self::other(trouble)
    }
}

/// Words for what is wrong with packed bytes, where that is what is wrong.
pub(crate) fn explained(error: PointsError) -> PointsError {
    let PointsError::Io { path, source } = error else { return error };
    let trouble = source.get_ref().and_then(|inner| inner.downcast_ref::<Trouble>());
    match trouble {
        None => PointsError::Io { path, source },
        Some(Trouble::Damaged(message)) => PointsError::wrong(
            &path,
            "the packed bytes",
            format!("'{message}'"),
            "what gzip writes",
            "the file is damaged or cut off: copy or pack it again",
        ),
        Some(Trouble::TooLarge { unpacked, length }) => PointsError::wrong(
            &path,
            "the size unpacked",
            format!("{unpacked} bytes or more"),
            &format!("at most 100 times the file's {length}"),
            "unpack it with gunzip and open what comes out",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::ReadOptions;
    use crate::read::read_bytes;
    use crate::{PointSet, read};
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    fn try_read(bytes: &[u8], name: &str) -> Result<PointSet, PointsError> {
        read_bytes(bytes, Path::new(name), &ReadOptions::default())
    }

    /// What is inside is found by its contents, and by the name without `.gz`.
    #[test]
    fn formats_are_read_packed() {
        let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                   property float z\nend_header\n1 2 3\n";
        for (name, contents) in [
            ("a.xyz.gz", "1 2 3\n4 5 6\n"),
            ("points.csv.GZ", "x,y,z\n1,2,3\n"),
            ("a.gz", ply),
            ("a.pts.gz", "1\n1 2 3 -100 255 0 10\n"),
            ("a.obj.gz", "v 1 2 3\n"),
            ("a", "OFF\n1 0 0\n1 2 3\n"),
        ] {
            let inner = inner_name(Path::new(name));
            let plain = try_read(contents.as_bytes(), &inner.to_string_lossy()).unwrap();
            let set = try_read(&packed(contents.as_bytes()), name).unwrap();
            assert_eq!(set.positions[0], [1.0, 2.0, 3.0], "{name}");
            assert_eq!(set.format, format!("{}, packed by gzip", plain.format));
            assert!(PointSet { format: plain.format.clone(), ..set } == plain, "{name}");
        }
        // Several, one after the other, are one.
        let set = try_read(&[packed(b"1 2 3\n"), packed(b"4 5 6\n")].concat(), "a.xyz.gz").unwrap();
        assert_eq!(set.positions, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        // So are zeros after them, as in a block of a tape.
        let padded = [packed(b"1 2 3\n"), vec![0; 1000]].concat();
        assert_eq!(try_read(&padded, "a.xyz.gz").unwrap().len(), 1);
        // What is read from several places is held.
        let npy = include_bytes!("../tests/data/numpy-fields.npy");
        assert_eq!(try_read(&packed(npy), "a.npy.gz").unwrap().len(), 5);
    }

    #[test]
    fn damaged_and_expanding_files_are_refused() {
        let whole = packed("1 2 3\n4 5 6\n".repeat(1000).as_bytes());
        let message = |bytes: &[u8]| try_read(bytes, "a.xyz.gz").unwrap_err().to_string();
        let cut = message(&whole[..whole.len() / 2]);
        assert!(cut.contains("a.xyz.gz: found '") && cut.contains("as the packed bytes"), "{cut}");
        let mut sum = whole.clone();
        let end = sum.len();
        sum[end - 8] ^= 1;
        assert!(message(&sum).contains("damaged or cut off"), "{}", message(&sum));
        let more = message(&[&whole[..], b"more"].concat());
        assert!(more.contains("as the packed bytes"), "{more}");
        let inner = message(&packed(&whole));
        assert!(inner.contains("found a gzip file in a gzip file"), "{inner}");
        assert!(message(&packed(b"")).contains("the file is empty"));
    }

    /// Blanks pack a thousandfold; only more than 256 MB of them are refused.
    #[test]
    fn files_that_fill_memory_are_refused() {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(b"1 2 3\n").unwrap();
        let block = vec![b'\n'; 1 << 20];
        for _ in 0..300 {
            encoder.write_all(&block).unwrap();
        }
        let bytes = encoder.finish().unwrap();
        let error = try_read(&bytes, "a.xyz.gz").unwrap_err().to_string();
        assert!(error.contains("as the size unpacked, expected at most 100 times"), "{error}");
    }

    #[test]
    fn progress_is_that_of_the_packed_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xyz.gz");
        let text: String = (0..50_000).map(|i| format!("{i} {} 3\n", i * 7 % 1001)).collect();
        std::fs::write(&path, packed(text.as_bytes())).unwrap();
        let length = std::fs::metadata(&path).unwrap().len();
        let mut told = Vec::new();
        read(&path, &mut |read, of| told.push((read, of))).unwrap();
        assert!(told.is_sorted() && told.iter().all(|&(read, of)| read <= length && of == length));
        assert_eq!(told.last(), Some(&(length, length)));
    }
}
