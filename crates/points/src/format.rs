//! The list of formats.

use crate::error::PointsError;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use crate::upright::Upwards;
use crate::{e57, esri, gzip, las, npy, obj, off, pcd, ply, ptx, text, vtk};
use std::path::Path;

/// A format that points are read from.
pub(crate) struct Format {
    /// As the code calls it.
    pub(crate) name: &'static str,
    /// As messages list it.
    listed: &'static str,
    /// Of its files, in lower case.
    pub(crate) extensions: &'static [&'static str],
    /// Whether a file may be one, by its first few kilobytes.
    pub(crate) sniff: fn(&[u8]) -> bool,
    /// Reads the points. The path is for messages alone.
    pub(crate) read: fn(Source<'_>, &Path, &ReadOptions) -> Result<PointSet, PointsError>,
}

/// All formats; those whose beginning is a clear sign stand before those that are told by the look
/// of their lines.
pub(crate) static FORMATS: &[Format] = &[
    Format { name: "PLY", listed: "PLY", extensions: &["ply"], sniff: ply::sniff, read: ply::read },
    Format {
        name: "LAS",
        listed: "LAS, LAZ",
        extensions: &["las", "laz"],
        sniff: las::sniff,
        read: las::read,
    },
    Format { name: "E57", listed: "E57", extensions: &["e57"], sniff: e57::sniff, read: e57::read },
    Format { name: "PCD", listed: "PCD", extensions: &["pcd"], sniff: pcd::sniff, read: pcd::read },
    Format { name: "NPY", listed: "NPY", extensions: &["npy"], sniff: npy::sniff, read: npy::read },
    Format {
        name: "NPZ",
        listed: "NPZ",
        extensions: &["npz"],
        sniff: npy::sniff_archive,
        read: npy::read_archive,
    },
    Format {
        name: "VTK",
        listed: "VTK",
        extensions: &["vtk"],
        sniff: vtk::sniff_legacy,
        read: vtk::read_legacy,
    },
    Format {
        name: "VTK XML",
        listed: "VTU, VTP, VTS, VTR, VTI",
        extensions: &[
            "vtu", "vtp", "vts", "vtr", "vti", "pvtu", "pvtp", "pvts", "pvtr", "pvti", "pvd",
            "vtm", "vtmb", "vtpd", "vtpc",
        ],
        sniff: vtk::sniff_xml,
        read: vtk::read_xml,
    },
    Format {
        name: "OFF",
        listed: "OFF",
        extensions: &["off", "coff", "noff"],
        sniff: off::sniff,
        read: off::read,
    },
    Format { name: "OBJ", listed: "OBJ", extensions: &["obj"], sniff: obj::sniff, read: obj::read },
    Format {
        name: "VTK series",
        listed: "",
        extensions: &["series"],
        sniff: vtk::sniff_series,
        read: vtk::read_series,
    },
    Format { name: "PTX", listed: "PTX", extensions: &["ptx"], sniff: ptx::sniff, read: ptx::read },
    Format {
        name: "ESRI grid",
        listed: "ESRI ASCII grids",
        extensions: &[],
        sniff: esri::sniff,
        read: esri::read,
    },
    Format {
        name: "text",
        listed: "tables of text: XYZ, PTS, CSV, TXT, ASC",
        extensions: &["xyz", "pts", "csv", "tsv", "txt", "asc", "dat"],
        sniff: |start| text::sniff(start) && !ptx::sniff(start) && !esri::sniff(start),
        read: text::read,
    },
];

impl Format {
    /// Which way is up in files of this format, and why, where that is not +y.
    pub(crate) fn up(&self, path: &Path) -> Option<(Upwards, &'static str)> {
        let name = gzip::inner_name(path);
        let is_pts = || name.extension().is_some_and(|e| e.eq_ignore_ascii_case("pts"));
        match self.name {
            "LAS" | "E57" | "PTX" => Some((Upwards::Z, "as in surveys")),
            "text" if is_pts() => Some((Upwards::Z, "as around a scanner")),
            "ESRI grid" => Some((Upwards::Z, "as on maps")),
            _ => None,
        }
    }
}

/// What a file with this beginning is read as: the first format that its contents look like, of
/// several the one with its extension; where they look like none, that with its extension, whose
/// reader says what is wrong.
pub(crate) fn of(start: &[u8], path: &Path) -> Option<&'static Format> {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let called_so = |format: &&Format| {
        extension.as_deref().is_some_and(|extension| format.extensions.contains(&extension))
    };
    let looks_so = || FORMATS.iter().filter(|format| (format.sniff)(start));
    looks_so()
        .find(called_so)
        .or_else(|| looks_so().next())
        .or_else(|| FORMATS.iter().find(called_so))
}

/// Names of all formats, for messages.
pub(crate) fn names() -> String {
    let listed = FORMATS.iter().map(|format| format.listed).filter(|listed| !listed.is_empty());
    listed.collect::<Vec<_>>().join(", ")
}
