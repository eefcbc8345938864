//! `.npz` archives: the array of positions, and all others of its length.

use crate::collect::Collector;
use crate::columns::{Part, Shared, SideBySide, check_expansion, data_error, fill};
use crate::error::PointsError;
use crate::field::Type;
use crate::foreign;
use crate::meaning::{self, printable};
use crate::npy::header::Header;
use crate::npy::{HELP, MAX_COLUMNS, Rows, bits_of_colors, named};
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use flate2::Crc;
use flate2::read::DeflateDecoder;
use std::cell::RefCell;
use std::io::{self, Read};
use std::path::Path;
use zip::{CompressionMethod, ZipArchive};

/// Most arrays of an archive.
const MAX_ARRAYS: usize = 1000;

/// Most bytes that are unpacked more than once.
const MAX_AGAIN: u64 = 1 << 32;

const HELP_ORDER: &str = "save numpy.ascontiguousarray of it, or do not compress";

/// Whether a file that begins so is an archive.
pub(crate) fn sniff(start: &[u8]) -> bool {
    start.starts_with(b"PK\x03\x04") || start.starts_with(b"PK\x05\x06")
}

/// An array of the archive.
struct Member {
    name: String,
    start: u64,
    end: u64,
    /// Bytes unpacked, as the archive says.
    size: u64,
    crc: u32,
    deflated: bool,
}

impl Member {
    /// The array from its beginning.
    fn open<'f>(&self, file: &'f Shared<'_>) -> Box<dyn Read + 'f> {
        let stored = Part::new(file, self.start, self.end).buffered();
        let reader: Box<dyn Read + 'f> = match self.deflated {
            true => Box::new(DeflateDecoder::new(stored)),
            false => Box::new(stored),
        };
        Box::new(Checked { reader, left: self.size, crc: Crc::new(), expected: self.crc })
    }

    /// The array from a place on, which takes unpacking what is before it. Without, the checksum is
    /// left alone if more than a header is before it.
    fn open_at<'f>(
        &self,
        file: &'f Shared<'_>,
        place: u64,
        header: &Header,
    ) -> io::Result<Box<dyn Read + 'f>> {
        if !self.deflated && place > header.length {
            let start = self.start.saturating_add(place);
            return Ok(Box::new(Part::new(file, start, self.end).buffered()));
        }
        let mut reader = self.open(file);
        io::copy(&mut reader.by_ref().take(place), &mut io::sink())?;
        Ok(reader)
    }
}

/// Reads so many bytes and no more, and compares their checksum at the end.
struct Checked<R> {
    reader: R,
    left: u64,
    crc: Crc,
    expected: u32,
}

impl<R: Read> Read for Checked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let wanted = usize::try_from(self.left).unwrap_or(usize::MAX).min(buffer.len());
        let count = fill(&mut self.reader, &mut buffer[..wanted])?;
        self.crc.update(&buffer[..count]);
        self.left -= count as u64;
        if self.left == 0 && count > 0 && self.crc.sum() != self.expected {
            let message = "bytes whose checksum is not the archive's";
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        Ok(count)
    }
}

/// An array, as far as it is of use.
struct Entry<'a> {
    member: &'a Member,
    header: Header,
    rows: Rows,
}

/// Reads the points of an archive.
pub(crate) fn read(
    source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let file: Shared<'_> = RefCell::new(source.seekable().map_err(io_error)?);
    file.borrow_mut().begin_pass(false);
    let members = members(&file, path)?;
    let mut entries = Vec::new();
    let mut left_out = Vec::new();
    for member in &members {
        let header =
            Header::read(&mut member.open(&file)).map_err(|e| e.at(path, Some(&member.name)))?;
        // What has a shape of no points is of no use.
        match Rows::of(&header) {
            Ok(mut rows) => {
                if let [place] = rows.places.as_mut_slice() {
                    *place = bits_of_colors(&member.name, *place);
                }
                entries.push(Entry { member, header, rows });
            }
            Err(_) => left_out.push(format!("{} {}", member.name, header.shape_in_words())),
        }
    }
    let (points, chosen) = choose(&entries, path)?;

    let mut columns = 0;
    let mut bytes = 0u64;
    let mut taken = Vec::new();
    for (place, entry) in entries.iter().enumerate() {
        let Entry { member, header, rows } = entry;
        let chosen = chosen.contains(&place);
        let too_wide = columns + rows.names.len() > MAX_COLUMNS;
        if rows.points != points || (too_wide && !chosen) {
            left_out.push(format!("{} {}", member.name, header.shape_in_words()));
            continue;
        }
        let needed = points.saturating_mul(rows.point_size(header));
        if needed.saturating_add(header.length) > member.size {
            let left = member.size.saturating_sub(header.length);
            return Err(PointsError::CutOff {
                path: path.into(),
                what: format!("values of '{}'", member.name),
                declared: points,
                found: left / rows.point_size(header).max(1),
                bytes_declared: Some(needed.into()),
                bytes_found: Some(left),
            });
        }
        // The columns that come first are unpacked again for each that follows.
        let again = needed.saturating_mul(rows.names.len() as u64) / 2;
        if member.deflated && rows.apart && again > MAX_AGAIN {
            let place = format!("the order of '{}'", member.name);
            let found = format!("{} columns one after the other", rows.names.len());
            let expected = "one row after the other, as the array is packed";
            return Err(PointsError::wrong(path, &place, found, expected, HELP_ORDER));
        }
        columns += rows.names.len();
        bytes = bytes.saturating_add(needed);
        taken.push((entry, chosen));
    }
    let length = file.borrow().length();
    check_expansion(path, bytes, length)?;

    file.borrow_mut().begin_pass(true);
    let mut names = Vec::new();
    let mut kinds: Vec<Type> = Vec::new();
    let mut arrays = Vec::new();
    for (entry, chosen) in taken {
        let Entry { member, header, rows } = entry;
        names.extend(entry.names(chosen));
        kinds.extend(rows.kinds());
        let open = |place: u64| member.open_at(&file, place, header);
        let opened = rows.arrays(header, &member.name, &open);
        arrays.extend(opened.map_err(|error| data_error(path, &member.name, error))?);
    }
    let table = SideBySide::new(arrays, points, path)?;
    let sample = table.sample(kinds.iter().map(|kind| kind.is_float()).collect());
    let fields = named(&names, &kinds, &sample, path, &options.columns)?;
    let mut collector = Collector::of_named(&fields, path, options)?;
    collector.expect(points)?;
    table.collect(&mut collector)?;
    let from: Vec<&str> = chosen.iter().map(|&place| &*entries[place].member.name).collect();
    let left_out = match left_out.as_slice() {
        [] => String::new(),
        _ if left_out.len() > 8 => format!("; left out: {} arrays", left_out.len()),
        some => format!("; left out: {}", some.join(" ")),
    };
    collector.finish(&format!("NPZ, positions from {}{left_out}", from.join(" ")))
}

impl Entry<'_> {
    /// Names of the numbers of a point.
    fn names(&self, chosen: bool) -> Vec<String> {
        let Self { member, header, rows } = self;
        match (header.record.has_names, rows.names.len(), chosen) {
            (true, _, true) => rows.names.clone(),
            (true, ..) => rows.names.iter().map(|name| format!("{}_{name}", member.name)).collect(),
            // Positions whatever the array is called.
            (false, 3, true) => meaning::spread("xyz", 3),
            (false, width, _) => meaning::spread(&member.name, width),
        }
    }

    fn has_positions(&self) -> bool {
        if self.header.record.has_names {
            return meaning::name_positions(self.rows.names.iter().map(String::as_str));
        }
        self.rows.names.len() == 3
    }
}

/// How many points there are, and the arrays that hold their positions: one with a name that says
/// so; three that are called x, y and z; the only one of three columns or with fields x, y and z.
fn choose(entries: &[Entry<'_>], path: &Path) -> Result<(u64, Vec<usize>), PointsError> {
    let points = |place: usize| entries[place].rows.points;
    let places = || 0..entries.len();
    let fit: Vec<usize> = places().filter(|&place| entries[place].has_positions()).collect();
    let called_so = |&&place: &&usize| meaning::is_position(&entries[place].member.name);
    if let Some(&place) = fit.iter().find(called_so) {
        return Ok((points(place), vec![place]));
    }
    let names: Vec<&str> = entries.iter().map(|entry| &*entry.member.name).collect();
    let single = |place: &usize| entries[*place].rows.names.len() == 1;
    let alike = |axes: &[usize; 3]| {
        axes.iter().all(single) && axes.iter().all(|&axis| points(axis) == points(axes[0]))
    };
    if let Some(axes) = meaning::positions_among(&names).filter(alike) {
        return Ok((points(axes[0]), axes.into()));
    }
    match fit.as_slice() {
        [one] => Ok((points(*one), vec![*one])),
        _ => {
            let listed: Vec<String> = entries
                .iter()
                .take(12)
                .map(|entry| format!("'{}' {}", entry.member.name, entry.header.shape_in_words()))
                .collect();
            let listed = if listed.is_empty() { "none".to_owned() } else { listed.join(", ") };
            Err(PointsError::Missing {
                path: path.into(),
                missing: "positions".to_owned(),
                place: format!("among the arrays ({listed})"),
                help: "save them under the name 'xyz' with the shape (n, 3)",
            })
        }
    }
}

/// The arrays that the archive lists.
fn members(file: &Shared<'_>, path: &Path) -> Result<Vec<Member>, PointsError> {
    let wrong = |place: &str, found: String, expected: &str| {
        PointsError::wrong(path, place, found, expected, HELP)
    };
    let damaged = |error: zip::result::ZipError| match error {
        zip::result::ZipError::Io(source) if source.kind() != io::ErrorKind::UnexpectedEof => {
            PointsError::Io { path: path.into(), source }
        }
        error => wrong("the archive's directory", format!("'{error}'"), "that of a zip archive"),
    };
    let whole = Part::new(file, 0, u64::MAX).buffered();
    let mut archive = ZipArchive::new(whole).map_err(damaged)?;
    let names: Vec<_> = archive.file_names().filter_map(Result::ok).collect();
    if !names.is_empty() && !names.iter().any(|name| name.ends_with(".npy")) {
        const SHOWN: usize = 4;
        let shown = names.iter().take(SHOWN).map(|name| format!("'{}'", printable(name)));
        let shown = shown.collect::<Vec<String>>().join(", ");
        let more = if names.len() > SHOWN { ", …" } else { "" };
        let found = format!("a zip archive without NumPy arrays ({shown}{more})");
        return Err(foreign::of_archive(&names).map_or_else(
            || PointsError::UnknownKind {
                path: path.into(),
                found,
                help: foreign::UNPACK.to_owned(),
            },
            |foreign| foreign.error(path),
        ));
    }
    drop(names);
    if archive.len() > MAX_ARRAYS {
        let found = format!("{} entries", archive.len());
        return Err(wrong("the archive's directory", found, &format!("at most {MAX_ARRAYS}")));
    }
    let mut members = Vec::new();
    for index in 0..archive.len() {
        let entry = archive.by_index_raw(index).map_err(damaged)?;
        let name = entry.name().map_err(damaged)?;
        let Some(name) = name.strip_suffix(".npy") else { continue };
        let place = format!("the packing of '{}'", printable(name));
        if entry.encrypted() {
            return Err(wrong(&place, "encryption".to_owned(), "none"));
        }
        let deflated = match entry.compression() {
            CompressionMethod::Stored => false,
            CompressionMethod::DEFLATE => true,
            other => {
                let found = format!("the method {other}");
                let expected = "store or deflate, which NumPy writes";
                return Err(wrong(&place, found, expected));
            }
        };
        let Some(start) = entry.data_start() else { continue };
        members.push(Member {
            name: printable(name),
            start,
            end: start.saturating_add(entry.compressed_size()),
            size: entry.size(),
            crc: entry.crc32(),
            deflated,
        });
    }
    Ok(members)
}
