//! Opens point files, and finds out what they are.

use crate::error::PointsError;
use crate::format;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use crate::{foreign, gzip};
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

/// How much of a file tells its format.
const START: usize = 4096;

/// Reads all that a point file has. As [`read_with`] otherwise.
///
/// # Errors
/// As [`read_with`].
pub fn read(path: &Path, progress: &mut dyn FnMut(u64, u64)) -> Result<PointSet, PointsError> {
    read_with(path, &ReadOptions::default(), progress)
}

/// Reads the points of a file of any format in the list of docs/point-files.md, told apart by its
/// contents, and by its name where the contents leave it open.
///
/// `progress` is told from time to time how many bytes were read, and how many the file has: 0 if
/// the system does not know, as for a pipe. Points with a coordinate that is infinite or not a
/// number are dropped and counted.
///
/// # Errors
/// [`PointsError`] if the file cannot be read, is of another kind, is damaged, has no usable point,
/// or none that the filter keeps.
pub fn read_with(
    path: &Path,
    options: &ReadOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<PointSet, PointsError> {
    let io_error = |source| PointsError::Io { path: path.into(), source };
    let file = File::open(path).map_err(io_error)?;
    let metadata = file.metadata().map_err(io_error)?;
    if metadata.is_dir() {
        return Err(PointsError::IsFolder { path: path.into() });
    }
    let source = match metadata.is_file() {
        true => Source::of_file(file, metadata.len(), progress),
        false => Source::of_stream(file, progress),
    };
    read_source(source, path, options)
}

/// As [`read_with`], of bytes in memory. `name` stands in messages, and its extension tells the format where
/// the contents leave it open.
///
/// # Errors
/// As [`read_with`].
pub fn read_bytes(
    bytes: &[u8],
    name: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let progress: &mut dyn FnMut(u64, u64) = &mut |_, _| ();
    read_source(Source::of_file(Cursor::new(bytes), bytes.len() as u64, progress), name, options)
}

/// What can be read several times.
pub(crate) enum Input {
    /// A file of so many bytes.
    File(u64),
    /// What came through a pipe.
    Held(Vec<u8>),
}

impl Input {
    /// Reads a pipe whole, if it begins like a point file.
    pub(crate) fn open(path: &Path) -> Result<Self, PointsError> {
        let io_error = |source| PointsError::Io { path: path.into(), source };
        let metadata = path.metadata().map_err(io_error)?;
        if metadata.is_file() || metadata.is_dir() {
            return Ok(Self::File(metadata.len()));
        }
        let mut pipe = File::open(path).map_err(io_error)?;
        let mut bytes = Vec::new();
        pipe.by_ref().take(START as u64).read_to_end(&mut bytes).map_err(io_error)?;
        if gzip::sniff(&bytes) || format::of(&bytes, path).is_some() {
            pipe.read_to_end(&mut bytes).map_err(io_error)?;
        }
        Ok(Self::Held(bytes))
    }

    /// In bytes.
    pub(crate) fn length(&self) -> u64 {
        match self {
            Self::File(length) => *length,
            Self::Held(bytes) => bytes.len() as u64,
        }
    }

    /// Reads the points, as [`read_with`] does.
    pub(crate) fn read(
        &self,
        path: &Path,
        options: &ReadOptions,
        progress: &mut dyn FnMut(u64, u64),
    ) -> Result<PointSet, PointsError> {
        match self {
            Self::File(_) => read_with(path, options, progress),
            Self::Held(bytes) => {
                let source = Source::of_file(Cursor::new(bytes), bytes.len() as u64, progress);
                read_source(source, path, options)
            }
        }
    }
}

fn read_source(
    mut source: Source<'_>,
    path: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let start = start_of(&mut source, path)?;
    if !gzip::sniff(&start) {
        return read_contents(source, &start, path, path, options);
    }
    let mut source = gzip::unpacked(source);
    let start = start_of(&mut source, path).map_err(gzip::explained)?;
    if gzip::sniff(&start) {
        let found = "a gzip file in a gzip file".to_owned();
        let help = "unpack it once with gunzip".to_owned();
        return Err(PointsError::UnknownKind { path: path.into(), found, help });
    }
    let set = read_contents(source, &start, path, &gzip::inner_name(path), options);
    let mut set = set.map_err(gzip::explained)?;
    set.format += ", packed by gzip";
    Ok(set)
}

/// What tells the format, of which there must be some.
fn start_of(source: &mut Source<'_>, path: &Path) -> Result<Vec<u8>, PointsError> {
    let start =
        source.fill(START).map_err(|source| PointsError::Io { path: path.into(), source })?;
    if start.is_empty() {
        return Err(PointsError::Empty { path: path.into() });
    }
    Ok(start[..start.len().min(START)].to_vec())
}

/// Reads a file that begins so. `name` is that of what is in it where it is packed.
fn read_contents(
    source: Source<'_>,
    start: &[u8],
    path: &Path,
    name: &Path,
    options: &ReadOptions,
) -> Result<PointSet, PointsError> {
    if let Some(foreign) = foreign::by_contents(start, name) {
        return Err(foreign.error(path));
    }
    match format::of(start, name) {
        Some(format) => {
            let mut set = (format.read)(source, path, options)?;
            set.up = set.up.or_else(|| format.up(name));
            Ok(set)
        }
        None => Err(foreign::unknown(start, name, path)),
    }
}
