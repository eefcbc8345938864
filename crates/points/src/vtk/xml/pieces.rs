//! Files that hold no points but list the files that do: ParaView's collections (`.pvd`) and series, VTK's
//! files of many blocks (`.vtm`) and of a parallel run's pieces (`.pvtu`, `.pvtp`). They are errors
//! that name the files.

use crate::error::PointsError;
use crate::options::ReadOptions;
use crate::set::PointSet;
use crate::source::Source;
use crate::vtk::xml::markup::{Markup, Tag};
use std::path::Path;

/// Files that are named; others are only counted.
const SHOWN: usize = 8;
/// Longest list of ParaView's series.
const MAX_SERIES: usize = 1 << 24;

/// What kinds of lists there are, by VTK's name.
const KINDS: [(&str, &str); 12] = [
    ("Collection", "a collection of ParaView"),
    ("vtkMultiBlockDataSet", "a file of many blocks"),
    ("vtkMultiPieceDataSet", "a file of many pieces"),
    ("vtkPartitionedDataSet", "a file of many partitions"),
    ("vtkPartitionedDataSetCollection", "a file of many partitions"),
    ("vtkHierarchicalBoxDataSet", "a file of levels of boxes"),
    ("vtkOverlappingAMR", "a file of levels of boxes"),
    ("vtkNonOverlappingAMR", "a file of levels of boxes"),
    ("PPolyData", "the pieces of a parallel run"),
    ("PUnstructuredGrid", "the pieces of a parallel run"),
    ("PStructuredGrid", "the pieces of a parallel run"),
    ("PRectilinearGrid", "the pieces of a parallel run"),
];

/// What a type of VTK's XML files lists; `None` if it is no list.
pub(super) fn kind_of(root: &Tag) -> Option<&'static str> {
    let kind = root.get("type")?;
    // Of images too.
    let kind = if kind == "PImageData" { "PRectilinearGrid" } else { kind };
    KINDS.iter().find(|(name, _)| *name == kind).map(|(_, words)| *words)
}

/// The error that names the files of a list whose first tag was read.
pub(super) fn listed(markup: &mut Markup<'_, '_>, kind: &str) -> PointsError {
    let mut list = List::default();
    loop {
        match markup.next() {
            Ok(Some(tag)) => {
                if let Some(piece) = tag.get("file").or_else(|| tag.get("Source")) {
                    list.push(markup.path, piece);
                }
            }
            Ok(None) => return list.error(markup.path, kind),
            Err(error) => return error,
        }
    }
}

#[derive(Default)]
struct List {
    shown: Vec<std::path::PathBuf>,
    count: usize,
}

impl List {
    /// Pieces are relative to the folder of the list.
    fn push(&mut self, list: &Path, piece: &str) {
        self.count += 1;
        if self.shown.len() < SHOWN {
            let folder = list.parent().unwrap_or(Path::new(""));
            self.shown.push(folder.join(piece));
        }
    }

    fn error(self, path: &Path, kind: &str) -> PointsError {
        let Self { shown, count } = self;
        PointsError::Pieces { path: path.into(), kind: kind.to_owned(), pieces: shown, count }
    }
}

/// Whether a file that begins so is a series of ParaView.
pub(crate) fn sniff_series(start: &[u8]) -> bool {
    let key = b"\"file-series-version\"";
    start.trim_ascii_start().starts_with(b"{") && start.windows(key.len()).any(|part| part == key)
}

/// Names the files of a series.
pub(crate) fn read_series(
    mut source: Source<'_>,
    path: &Path,
    _: &ReadOptions,
) -> Result<PointSet, PointsError> {
    let bytes = source.fill(MAX_SERIES);
    let bytes = bytes.map_err(|source| PointsError::Io { path: path.into(), source })?;
    let json: serde_json::Value = serde_json::from_slice(bytes).map_err(|error| {
        let expected = "JSON with a list \"files\"";
        PointsError::wrong(path, "the series", format!("'{error}'"), expected, "write it again")
    })?;
    let mut list = List::default();
    let files = json["files"].as_array().map(Vec::as_slice).unwrap_or_default();
    for name in files.iter().filter_map(|file| file["name"].as_str()) {
        list.push(path, name);
    }
    Err(list.error(path, "a series of ParaView"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::read_bytes;

    /// Lists name the files that hold the points, from the folder of the list.
    #[test]
    fn lists_name_their_files() {
        let list = |kind: &str, content: &str| {
            let text =
                format!("<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\">{content}</VTKFile>");
            let name = Path::new("out/a.pvd");
            read_bytes(text.as_bytes(), name, &ReadOptions::default()).unwrap_err().to_string()
        };
        let steps: String = (0..10)
            .map(|i| format!("<DataSet timestep=\"{i}\" group=\"\" file=\"run/step_{i}.vtu\"/>\n"))
            .collect();
        let found = list("Collection", &format!("<Collection>{steps}</Collection>"));
        let names: Vec<String> = (0..8).map(|i| format!("out/run/step_{i}.vtu")).collect();
        let expected = format!(
            "out/a.pvd: found a list of 10 files (a collection of ParaView), expected points; open one of \
             them: {} and 2 more",
            names.join(", ")
        );
        assert_eq!(found, expected);
        let blocks = "<vtkMultiBlockDataSet><Block index=\"0\" name=\"a\"><DataSet index=\"0\" \
                      file=\"a/a_0.vtp\"/></Block><DataSet index=\"1\" file=\"a/a_1.vtu\"></DataSet>\
                      </vtkMultiBlockDataSet>";
        let found = list("vtkMultiBlockDataSet", blocks);
        assert!(found.ends_with("one of them: out/a/a_0.vtp, out/a/a_1.vtu"), "{found}");
        let pieces = "<PUnstructuredGrid GhostLevel='0'><PPoints><PDataArray type='Float32' \
                      NumberOfComponents='3'/></PPoints><Piece Source='b.vtu'/></PUnstructuredGrid>";
        let found = list("PUnstructuredGrid", pieces);
        assert!(found.ends_with("expected points; open that file: out/b.vtu"), "{found}");

        let series = "{\n \"file-series-version\" : \"1.0\",\n \"files\" : [ { \"name\" : \"b.vtk\", \
                      \"time\" : 0 } ]\n}";
        let read = |text: &str| {
            let name = Path::new("a.vtk.series");
            read_bytes(text.as_bytes(), name, &ReadOptions::default()).unwrap_err().to_string()
        };
        assert!(
            read(series)
                .ends_with("(a series of ParaView), expected points; open that file: b.vtk")
        );
        assert!(read(&series[..40]).contains("as the series, expected JSON with a list \"files\""));
    }
}
