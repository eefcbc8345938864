//! Goes through a VTK XML file, tag by tag, and notes where what is.

use crate::columns::Shared;
use crate::error::{PointsError, Quoted};
use crate::field::Type;
use crate::meaning;
use crate::vtk::lattice::{Axis, MAX_BARE_NODES, too_many_nodes};
use crate::vtk::xml::markup::{Markup, Tag, TagKind};
use crate::vtk::xml::packed::{Lengths, Packing};
use crate::vtk::xml::pieces;
use crate::vtk::xml::{Outline, Piece, Place, Positions, Stored};
use crate::vtk::{Described, MAX_COLUMNS, Role};
use std::path::Path;

/// Deepest nesting of tags.
const DEEPEST: usize = 64;
/// Most pieces of a file.
const MAX_PIECES: usize = 1 << 16;

const KINDS: [&str; 5] =
    ["PolyData", "UnstructuredGrid", "StructuredGrid", "ImageData", "RectilinearGrid"];

/// Finds what a file has.
pub(super) fn outline(file: &Shared<'_>, path: &Path) -> Result<Outline, PointsError> {
    let mut markup = Markup::new(file, path);
    let mut scan = Scan::default();
    let mut open: Vec<String> = Vec::new();
    loop {
        let Some(tag) = markup.next()? else {
            // What is not closed may have gone on, with other pieces too.
            let Some(last) = open.last() else { break };
            let expected = format!("'</{}>': the file is cut off", meaning::printable(last));
            return Err(markup.wrong("the end of the file", expected));
        };
        if let (true, Some(list)) = (scan.kind.is_empty(), pieces::kind_of(&tag)) {
            return Err(pieces::listed(&mut markup, list));
        }
        match tag.kind {
            TagKind::Close => {
                scan.close(&markup, &tag)?;
                if open.pop().as_ref() != Some(&tag.name) {
                    let found = Quoted(format!("</{}>", tag.name).as_bytes()).to_string();
                    return Err(markup.wrong(found, "the end of the tag that was opened last"));
                }
                continue;
            }
            TagKind::Open if open.len() == DEEPEST => {
                let expected = format!("at most {DEEPEST} tags in each other");
                return Err(markup.wrong("more tags in each other", expected));
            }
            TagKind::Open => open.push(tag.name.clone()),
            TagKind::Empty => (),
        }
        let parent = open.len().checked_sub(if tag.kind == TagKind::Open { 2 } else { 1 });
        let parent = parent.and_then(|parent| open.get(parent)).cloned().unwrap_or_default();
        if tag.name == "AppendedData" {
            let base64 = tag.get("encoding") != Some("raw");
            if tag.kind == TagKind::Open && markup.skip_to(b'_')? {
                scan.appended = Some((markup.at, base64));
            }
            break;
        }
        scan.open(&markup, &tag, &parent)?;
    }
    scan.finish(&markup, path)
}

#[derive(Default)]
struct Scan {
    kind: String,
    lengths: Option<Lengths>,
    packing: Option<Packing>,
    appended: Option<(u64, bool)>,
    origin: [f64; 3],
    spacing: [f64; 3],
    /// The piece that was opened last.
    piece: Option<Open>,
    pieces: Vec<Piece>,
    /// Names that `PointData` gives to arrays of some meaning.
    normals: Option<String>,
    /// Whether the text that comes is that of an array.
    array: Option<(Stored, Owner)>,
}

/// Whose an array is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Owner {
    Points,
    Coordinates,
    PointData,
}

/// A piece as far as it is known.
#[derive(Default)]
struct Open {
    points: u64,
    extent: Option<[i64; 6]>,
    positions: Option<Stored>,
    coordinates: Vec<Stored>,
    arrays: Vec<Stored>,
}

impl Scan {
    /// A tag that opens something.
    fn open(
        &mut self,
        markup: &Markup<'_, '_>,
        tag: &Tag,
        parent: &str,
    ) -> Result<(), PointsError> {
        if self.kind.is_empty() {
            return self.root(markup, tag);
        }
        match tag.name.as_str() {
            "ImageData" => {
                self.origin = numbers(markup, tag, "Origin", [0.0; 3])?;
                self.spacing = numbers(markup, tag, "Spacing", [1.0; 3])?;
                let straight = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
                if numbers(markup, tag, "Direction", straight)? != straight {
                    let expected = "1 0 0 0 1 0 0 0 1: a lattice along the axes";
                    return Err(markup.unread("another Direction", expected));
                }
            }
            "Piece" => {
                if self.pieces.len() == MAX_PIECES {
                    let found = format!("more than {MAX_PIECES} pieces");
                    return Err(markup.wrong(found, "fewer"));
                }
                let piece = Open {
                    points: match tag.get("NumberOfPoints") {
                        Some(count) => count.trim().parse().map_err(|_| {
                            markup.wrong(attribute("NumberOfPoints", count), "0 or more")
                        })?,
                        None => 0,
                    },
                    extent: match tag.get("Extent") {
                        Some(_) => Some(numbers(markup, tag, "Extent", [0; 6])?),
                        None => None,
                    },
                    ..Open::default()
                };
                self.piece = Some(piece);
                if tag.kind == TagKind::Empty {
                    self.close_piece(markup)?;
                }
            }
            "PointData" => self.normals = tag.get("Normals").map(str::to_owned),
            "DataArray" => {
                let owner = match parent {
                    "Points" => Owner::Points,
                    "Coordinates" => Owner::Coordinates,
                    "PointData" => Owner::PointData,
                    _ => return Ok(()),
                };
                self.array(markup, tag, owner)?;
                if tag.kind == TagKind::Empty {
                    self.close_array(markup.at);
                }
            }
            _ => (),
        }
        Ok(())
    }

    /// A tag that closes something.
    fn close(&mut self, markup: &Markup<'_, '_>, tag: &Tag) -> Result<(), PointsError> {
        match tag.name.as_str() {
            "DataArray" => self.close_array(tag.start),
            "Piece" => self.close_piece(markup)?,
            _ => (),
        }
        Ok(())
    }

    /// The outermost tag.
    fn root(&mut self, markup: &Markup<'_, '_>, tag: &Tag) -> Result<(), PointsError> {
        if tag.name != "VTKFile" {
            let found = Quoted(format!("<{}>", tag.name).as_bytes()).to_string();
            return Err(markup.wrong(found, "'<VTKFile>'"));
        }
        let kind = tag.get("type").unwrap_or_default();
        if !KINDS.contains(&kind) {
            let found = attribute("type", kind);
            return Err(markup.unread(found, KINDS.join(", ")));
        }
        let big = match tag.get("byte_order") {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            Some(other) => {
                let found = attribute("byte_order", other);
                return Err(markup.wrong(found, "LittleEndian or BigEndian"));
            }
        };
        let long = match tag.get("header_type") {
            None | Some("UInt32") => false,
            Some("UInt64") => true,
            Some(other) => {
                let found = attribute("header_type", other);
                return Err(markup.wrong(found, "UInt32 or UInt64"));
            }
        };
        self.packing = match tag.get("compressor") {
            None | Some("") => None,
            Some("vtkZLibDataCompressor") => Some(Packing::Zlib),
            Some("vtkLZ4DataCompressor") => Some(Packing::Lz4),
            Some("vtkLZMADataCompressor") => Some(Packing::Lzma),
            Some(other) => {
                let found = attribute("compressor", other);
                let expected =
                    "vtkZLibDataCompressor, vtkLZ4DataCompressor or vtkLZMADataCompressor";
                return Err(markup.unread(found, expected));
            }
        };
        self.kind = kind.to_owned();
        self.lengths = Some(Lengths { long, big });
        Ok(())
    }

    /// An array that belongs to points.
    fn array(
        &mut self,
        markup: &Markup<'_, '_>,
        tag: &Tag,
        owner: Owner,
    ) -> Result<(), PointsError> {
        let Some(kind) = tag.get("type").and_then(type_of) else {
            if owner == Owner::PointData {
                return Ok(()); // text and the like
            }
            let found = attribute("type", tag.get("type").unwrap_or_default());
            return Err(markup.wrong(found, "a type such as Float32 or Float64"));
        };
        let width = match tag.get("NumberOfComponents") {
            None => 1,
            Some(text) => {
                let width = text.trim().parse().ok().filter(|&width| width <= MAX_COLUMNS);
                let found = || attribute("NumberOfComponents", text);
                width.ok_or_else(|| markup.wrong(found(), format!("0 to {MAX_COLUMNS}")))?
            }
        };
        let expected = match owner {
            Owner::Points => 3,
            Owner::Coordinates => 1,
            Owner::PointData => width,
        };
        if width != expected {
            let found = attribute("NumberOfComponents", width);
            return Err(markup.wrong(found, expected.to_string()));
        }
        let name = tag.get("Name").unwrap_or_default().to_owned();
        let role = match owner {
            Owner::Points => Role::Position,
            _ if width == 3 && self.normals.as_ref() == Some(&name) => Role::Normal,
            _ => Role::Other,
        };
        let name = if owner == Owner::Points { "points".to_owned() } else { name };
        let place = match tag.get("format") {
            None | Some("ascii") => Place::Text(markup.at, markup.at),
            Some("binary") => Place::Inline(markup.at, markup.at),
            Some("appended") => {
                let offset = tag.get("offset").unwrap_or_default();
                let found = || attribute("offset", offset);
                let parsed = offset.trim().parse();
                Place::Appended(parsed.map_err(|_| markup.wrong(found(), "0 or more"))?)
            }
            Some(other) => {
                let found = attribute("format", other);
                return Err(markup.wrong(found, "ascii, binary or appended"));
            }
        };
        let described = Described { name, width, kind, role };
        self.array = Some((Stored { described, place }, owner));
        Ok(())
    }

    /// The text of an array ends here.
    fn close_array(&mut self, end: u64) {
        let (Some((mut stored, owner)), Some(piece)) = (self.array.take(), &mut self.piece) else {
            return;
        };
        match &mut stored.place {
            Place::Text(_, until) | Place::Inline(_, until) => *until = end,
            Place::Appended(_) => (),
        }
        let columns: usize = piece.arrays.iter().map(|array| array.described.width).sum();
        let width = stored.described.width;
        match owner {
            Owner::Points => piece.positions = Some(stored),
            Owner::Coordinates => piece.coordinates.push(stored),
            Owner::PointData if width == 0 || 3 + columns + width > MAX_COLUMNS => (),
            Owner::PointData => piece.arrays.push(stored),
        }
    }

    fn close_piece(&mut self, markup: &Markup<'_, '_>) -> Result<(), PointsError> {
        let Some(piece) = self.piece.take() else { return Ok(()) };
        let lattice = matches!(self.kind.as_str(), "ImageData" | "RectilinearGrid");
        let mut points = piece.points;
        let mut counts = [0; 3];
        if lattice || self.kind == "StructuredGrid" {
            let Some([x0, x1, y0, y1, z0, z1]) = piece.extent else {
                return Err(markup.wrong("a piece without Extent", "one with it"));
            };
            let nodes = |from: i64, to: i64| {
                to.checked_sub(from)?.checked_add(1).and_then(|count| u64::try_from(count).ok())
            };
            let found = || format!("Extent=\"{x0} {x1} {y0} {y1} {z0} {z1}\"");
            let wrong = || markup.wrong(found(), "ends that do not lie before beginnings");
            let count = |from, to| nodes(from, to).ok_or_else(wrong);
            counts = [count(x0, x1)?, count(y0, y1)?, count(z0, z1)?];
            let all = counts.iter().try_fold(1u64, |all, &count| all.checked_mul(count));
            points = all.ok_or_else(wrong)?;
        }
        if points == 0 {
            return Ok(());
        }
        let positions = if self.kind == "ImageData" {
            let start = piece.extent.unwrap_or_default();
            Positions::Lattice([0, 1, 2].map(|axis| Axis::Even {
                origin: self.origin[axis] + self.spacing[axis] * start[2 * axis] as f64,
                step: self.spacing[axis],
                count: counts[axis],
            }))
        } else if self.kind == "RectilinearGrid" {
            let found = format!("{} arrays of coordinates", piece.coordinates.len());
            let arrays = piece.coordinates.try_into();
            Positions::Listed(arrays.map_err(|_| markup.wrong(found, "3"))?, counts)
        } else {
            let stored = piece.positions;
            let wrong = || markup.wrong("a piece without Points", "one with an array in them");
            Positions::Stored(stored.ok_or_else(wrong)?)
        };
        // Whether the arrays' bytes are there shows when they are read; without any, nothing does.
        if lattice && piece.arrays.is_empty() && points > MAX_BARE_NODES {
            return Err(too_many_nodes(markup.path, counts, MAX_BARE_NODES));
        }
        self.pieces.push(Piece { points, positions, arrays: piece.arrays });
        Ok(())
    }

    fn finish(self, markup: &Markup<'_, '_>, path: &Path) -> Result<Outline, PointsError> {
        let Some(lengths) = self.lengths else {
            return Err(markup.wrong("the end of the file", "'<VTKFile>'"));
        };
        let is_appended = |stored: &Stored| matches!(stored.place, Place::Appended(_));
        let needs_appended = self.pieces.iter().any(|piece| {
            let positions: &[Stored] = match &piece.positions {
                Positions::Stored(stored) => std::slice::from_ref(stored),
                Positions::Lattice(_) => &[],
                Positions::Listed(arrays, _) => arrays,
            };
            piece.arrays.iter().chain(positions).any(is_appended)
        });
        if needs_appended && self.appended.is_none() {
            return Err(PointsError::Missing {
                path: path.into(),
                missing: "'_' in the tag AppendedData".to_owned(),
                place: "behind the description of the arrays, before their data".to_owned(),
                help: "the file is cut off: copy or export it again",
            });
        }
        let Self { kind, packing, pieces, appended, .. } = self;
        Ok(Outline { kind, lengths, packing, pieces, appended })
    }
}

/// The numbers of an attribute, if it is there.
fn numbers<T: std::str::FromStr + Copy, const N: usize>(
    markup: &Markup<'_, '_>,
    tag: &Tag,
    name: &str,
    default: [T; N],
) -> Result<[T; N], PointsError> {
    let Some(text) = tag.get(name) else { return Ok(default) };
    let parsed: Option<Vec<T>> =
        text.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
    let parsed = parsed.and_then(|numbers| <[T; N]>::try_from(numbers).ok());
    let found = || attribute(name, text);
    parsed.ok_or_else(|| markup.wrong(found(), format!("{N} numbers")))
}

/// An attribute as a message has it.
fn attribute(name: &str, value: impl ToString) -> String {
    format!("{name}={}", Quoted(value.to_string().as_bytes()))
}

fn type_of(name: &str) -> Option<Type> {
    Some(match name {
        "Int8" => Type::I8,
        "UInt8" => Type::U8,
        "Int16" => Type::I16,
        "UInt16" => Type::U16,
        "Int32" => Type::I32,
        "UInt32" => Type::U32,
        "Int64" => Type::I64,
        "UInt64" => Type::U64,
        "Float32" => Type::F32,
        "Float64" => Type::F64,
        _ => return None,
    })
}
