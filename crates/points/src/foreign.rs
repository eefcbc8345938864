//! Formats that are not read, by name, each with what makes a point file of it.
//!
//! One table, one row a format: its name, the endings of its files, how its contents begin, and what to
//! do. docs/point-files.md has the same table, which a test compares. Contents count before endings.

use crate::error::{PointsError, Quoted};
use crate::ply;
use std::path::Path;

/// A format that is not read.
pub(crate) struct Foreign {
    /// As messages call it: `a Draco file`.
    name: &'static str,
    /// Of its files, in lower case.
    extensions: &'static [&'static str],
    /// What its contents look like.
    looks: Looks,
    /// What to do.
    help: &'static str,
}

/// How a format is recognised by its contents.
enum Looks {
    /// Not at all.
    Anyhow,
    /// By these bytes at this place, or others at another.
    Has(&'static [(usize, &'static [u8])]),
    /// By text that begins with the first word, after blanks, and has all others.
    Text(&'static str, &'static [&'static str]),
    Fits(fn(&[u8]) -> bool),
}

use Looks::{Anyhow, Fits, Has, Text};

const SPLAT: &str = "save it as PLY, which SuperSplat and splat-transform do";
const MESH: &str = "open it in MeshLab, Blender or CloudCompare and save it as PLY or OBJ";
const CAD: &str = "export its surface as a mesh from the CAD program, and save that as PLY or OBJ";
const SCAN: &str = "export it as E57, LAS or PTX from the scanner's program";
const SCIENCE: &str =
    "read the positions in Python (h5py, netCDF4, scipy.io, meshio) and save them with numpy.savez";
const RASTER: &str = "make points of it: gdal_translate -of XYZ in.tif out.xyz";
const TABLE: &str = "save the table as CSV, with pandas or the program that wrote it";
const ROBOT: &str = "write one message of points to a PCD file, with ROS or Foxglove's tools";
const PICTURE: &str = "name a point file; a depth map must be turned into points first";
pub(crate) const UNPACK: &str = "unpack it and open the point file inside";
const PARAVIEW: &str = "open it in ParaView and save the data as VTU or VTP";
const TILES: &str = "write its points to one file: pdal translate in out.laz, or CloudCompare";

/// All rows; of several that fit, the first one with the file's ending counts, else the first.
#[rustfmt::skip]
static FOREIGN: &[Foreign] = &[
    // 3D Gaussians.
    row("an SPZ file of 3D Gaussians", &["spz"], Has(&[(0, b"NGSP")]), SPLAT),
    row("SuperSplat's compressed PLY", &["compressed.ply"], Fits(is_compressed_ply), SPLAT),
    row("a .splat file of 3D Gaussians", &["splat"], Anyhow, SPLAT),
    row("a .ksplat file of 3D Gaussians", &["ksplat"], Anyhow, SPLAT),
    row("an SOG archive of 3D Gaussians", &["sog"], Has(&[(0, ZIP)]), SPLAT),
    row("the description of 3D Gaussians in SOG", &[], Text("{", &["\"means\"", "\"quats\""]), SPLAT),
    // Meshes and scenes.
    row("a binary glTF file", &["glb"], Has(&[(0, b"glTF")]), MESH),
    row("a glTF file", &["gltf"], Text("{", &["\"asset\"", "\"accessors\""]), MESH),
    row("a Draco file", &["drc"], Has(&[(0, b"DRACO")]), "decode it to PLY: draco_decoder -i in.drc -o out.ply"),
    row("an STL file", &["stl"], Text("solid", &["facet"]), MESH),
    row("a 3MF file", &["3mf"], Has(&[(0, ZIP)]), MESH),
    row("an FBX file", &["fbx"], Has(&[(0, b"Kaydara FBX")]), MESH),
    row("a USD file", &["usd", "usda", "usdc", "usdz"], Has(&[(0, b"PXR-USDC"), (0, b"#usda")]), MESH),
    row("a Blender file", &["blend"], Has(&[(0, b"BLENDER")]), MESH),
    row("a COLLADA file", &["dae"], Text("<", &["<COLLADA"]), MESH),
    row("a VRML or X3D file", &["wrl", "x3d", "x3dv"], Has(&[(0, b"#VRML"), (0, b"#X3D")]), MESH),
    row("a 3DS file", &["3ds"], Anyhow, MESH),
    row("an Alembic file", &["abc"], Has(&[(0, b"Ogawa")]), MESH),
    row("an OpenCTM file", &["ctm"], Has(&[(0, b"OCTM")]), MESH),
    row("a STEP file", &["step", "stp"], Has(&[(0, b"ISO-10303-21")]), CAD),
    row("an IGES, IFC or DWG file", &["iges", "igs", "ifc", "dwg"], Has(&[(0, b"AC10")]), CAD),
    row("a DXF file", &["dxf"], Fits(is_dxf), CAD),
    row("a Houdini file", &["bgeo", "geo", "bgeo.sc", "bgeogz", "hip"], Has(&[(0, b"\x7fNSJb"), (0, b"BgeoV"), (0, b"[\"fileversion\""), (0, b"scf1")]),
        "save it as PLY in Houdini, or convert it with partconvert of Partio"),
    row("a Krakatoa file", &["prt"], Has(&[(0, b"\xc0PRT\r\n\x1a\n")]), "save it as PLY or CSV, with Krakatoa or partconvert of Partio"),
    row("an OpenVDB volume", &["vdb", "nvdb"], Has(&[(0, b" BDV"), (0, b"NanoVDB")]), "write the active voxels as points with a value, to NPZ for example"),
    // Scanners.
    row("an Autodesk ReCap file", &["rcp", "rcs"], Anyhow, "export it as E57 from ReCap"),
    row("a FARO scan", &["fls", "fws", "lsproj"], Anyhow, "export it as E57 from FARO SCENE"),
    row("a Leica scan", &["ptg", "imp", "lgs", "lgsx", "ptz"], Has(&[(0, b"PTG")]), "export it as E57 or PTX from Cyclone or Register"),
    row("a RIEGL scan", &["3dd", "rxp", "rdb", "rdbx", "4dd"], Anyhow, "export it as LAS or E57 from RiSCAN"),
    row("another scanner's own file", &["zfs", "zfc", "zfprj", "cl3", "clr", "dp", "fsproj", "tzf", "rwp", "pod", "swl"], Anyhow, SCAN),
    row("an Esri zLAS file", &["zlas"], Anyhow, "unpack it to LAS with EzLAS of Esri"),
    row("a capture of a lidar's packets", &["pcap", "pcapng"], Has(&[(0, b"\xd4\xc3\xb2\xa1"), (0, b"\xa1\xb2\xc3\xd4"), (0, b"\x4d\x3c\xb2\xa1"), (0, b"\n\r\r\n")]),
        "save a frame as LAS, CSV or PCD with the lidar's viewer (VeloView, ouster-cli)"),
    row("a ROS bag", &["bag"], Has(&[(0, b"#ROSBAG")]), ROBOT),
    row("an MCAP recording", &["mcap"], Has(&[(0, b"\x89MCAP")]), ROBOT),
    row("an SQLite database", &["db3", "gpkg", "sqlite", "mbtiles"], Has(&[(0, b"SQLite format 3\0")]), "export its points; those of a ROS 2 bag to PCD"),
    row("bare numbers without a header, as those of KITTI and nuScenes", &["bin", "raw", "pcd.bin"], Anyhow,
        "give them a header: numpy.save('out.npy', numpy.fromfile('in.bin', 'f4').reshape(-1, 4)), with 5 for nuScenes"),
    // Tiles.
    row("the description of an Entwine (EPT) data set", &[], Text("{", &["\"hierarchyType\""]), TILES),
    row("a description of 3D Tiles", &[], Text("{", &["\"geometricError\""]), TILES),
    row("a tile of 3D Tiles", &["pnts", "b3dm", "i3dm", "cmpt"], Has(&[(0, b"pnts"), (0, b"b3dm"), (0, b"i3dm"), (0, b"cmpt")]), TILES),
    row("a description of a Potree data set", &[], Text("{", &["\"octreeDir\""]), TILES),
    row("a description of a Potree data set", &[], Text("{", &["\"hierarchy\"", "\"spacing\"", "\"encoding\""]), TILES),
    row("a list of point files of PDAL or GeoJSON", &["vpc", "geojson"], Text("{", &["\"FeatureCollection\""]), "open the point files that it lists"),
    row("an Esri scene layer", &["slpk"], Anyhow, TILES),
    // Science.
    row("an HDF5 file", &["h5", "hdf5", "hdf", "he5", "cgns"], Has(&[(0, HDF), (512, HDF), (1024, HDF), (2048, HDF)]), SCIENCE),
    row("a VTKHDF file", &["vtkhdf"], Has(&[(0, HDF)]), PARAVIEW),
    row("a MATLAB file", &["mat"], Has(&[(0, b"MATLAB 5.0"), (0, b"MATLAB 7"), (0, HDF)]), "read it with scipy.io.loadmat or h5py and save the positions with numpy.savez"),
    row("a NetCDF file", &["nc", "nc4", "cdf"], Has(&[(0, b"CDF\x01"), (0, b"CDF\x02"), (0, b"CDF\x05"), (0, HDF)]), SCIENCE),
    row("a snapshot of Gadget", &["gadget"], Fits(is_gadget), "read the positions with yt or pynbody and save them with numpy.savez"),
    row("a dump or data file of LAMMPS", &["lammpstrj", "lammps", "dump"], Fits(is_lammps), "save it in OVITO as extended XYZ"),
    row("a Bundler or VisualSFM model", &["nvm"], Has(&[(0, b"# Bundle file"), (0, b"NVM_V3")]), "open it in MeshLab or COLMAP and save the points as PLY"),
    row("an XDMF file", &["xdmf", "xmf"], Text("<", &["<Xdmf"]), PARAVIEW),
    row("an Exodus or EnSight file", &["exo", "ex2", "e", "case", "encas"], Anyhow, PARAVIEW),
    row("a Tecplot file", &["plt", "szplt", "tec"], Has(&[(0, b"#!TDV"), (0, b"#!SZPLT")]), PARAVIEW),
    row("a Gmsh or Medit mesh", &["msh", "mesh", "meshb"], Has(&[(0, b"$MeshFormat"), (0, b"MeshVersionFormatted")]), "convert it with meshio: meshio convert in.msh out.vtu"),
    row("a Python pickle", &["pkl", "pickle", "p"], Has(&[(0, b"\x80\x02}"), (0, b"\x80\x03"), (0, b"\x80\x04\x95"), (0, b"\x80\x05\x95")]), "load it in Python and save the positions with numpy.savez; pickles are never run"),
    row("a file of PyTorch", &["pt", "pth", "ckpt"], Has(&[(0, ZIP)]), "load it in Python and save the positions with numpy.savez; pickles are never run"),
    row("a file of tensors", &["safetensors"], Anyhow, "load it in Python and save the positions with numpy.savez"),
    row("a Parquet, Arrow or Feather table", &["parquet", "arrow", "feather", "orc"], Has(&[(0, b"PAR1"), (0, b"ARROW1"), (0, b"FEA1"), (0, b"ORC")]), TABLE),
    row("a spreadsheet", &["xlsx", "xls", "ods"], Has(&[(0, b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"), (0, ZIP)]), TABLE),
    // Rasters and pictures.
    row("a TIFF picture or GeoTIFF raster", &["tif", "tiff"], Has(&[(0, b"II*\0"), (0, b"MM\0*"), (0, b"II+\0"), (0, b"MM\0+")]), RASTER),
    row("a raster of heights", &["dem", "hgt", "flt", "adf", "grd", "bil", "dt0", "dt1", "dt2", "img"], Has(&[(0, b"DSAA"), (0, b"DSBB"), (0, b"DSRB"), (0, b"EHFA_HEADER_TAG")]), RASTER),
    row("a shapefile", &["shp"], Has(&[(0, b"\0\0\x27\x0a")]), "save its points as CSV: ogr2ogr -lco GEOMETRY=AS_XYZ out.csv in.shp"),
    row("a KML, GML or LandXML file", &["kml", "kmz", "gml", "gpx", "landxml"], Text("<", &["<kml"]), "save its points as CSV"),
    row("a PNG picture", &["png"], Has(&[(0, b"\x89PNG")]), PICTURE),
    row("a JPEG picture", &["jpg", "jpeg"], Has(&[(0, b"\xff\xd8\xff")]), PICTURE),
    row("an OpenEXR picture", &["exr"], Has(&[(0, b"\x76\x2f\x31\x01")]), PICTURE),
    row("a picture", &["hdr", "gif", "bmp", "webp", "psd"], Has(&[(0, b"#?RADIANCE"), (0, b"GIF8"), (8, b"WEBP"), (0, b"8BPS")]), PICTURE),
    row("a PDF document", &["pdf"], Has(&[(0, b"%PDF")]), "name a point file"),
    row("a scene file", &["toml"], Fits(is_scene), "render it as a scene: the file's name must end with .toml"),
    // What holds files.
    row("a web page, perhaps instead of a file that was downloaded", &["html", "htm"], Fits(is_web_page), "download the file again"),
    row("a pointer of Git LFS instead of the file", &[], Has(&[(0, b"version https://git-lfs")]), "fetch the file itself: git lfs pull"),
    row("a tar archive", &["tar", "tgz"], Has(&[(257, b"ustar")]), UNPACK),
    row("a 7z archive", &["7z"], Has(&[(0, b"7z\xbc\xaf\x27\x1c")]), UNPACK),
    row("a RAR archive", &["rar"], Has(&[(0, b"Rar!\x1a\x07")]), UNPACK),
    row("a file packed by bzip2", &["bz2"], Has(&[(0, b"BZh91AY"), (0, b"BZh61AY")]), UNPACK),
    row("a file packed by xz", &["xz", "lzma"], Has(&[(0, b"\xfd7zXZ\0")]), UNPACK),
    row("a file packed by Zstandard", &["zst"], Has(&[(0, b"\x28\xb5\x2f\xfd")]), UNPACK),
    row("a file packed by LZ4", &["lz4"], Has(&[(0, b"\x04\x22\x4d\x18")]), UNPACK),
    row("a file packed by compress", &["z"], Has(&[(0, b"\x1f\x9d")]), UNPACK),
];

const ZIP: &[u8] = b"PK\x03\x04";
const HDF: &[u8] = b"\x89HDF\r\n\x1a\n";

const fn row(
    name: &'static str,
    extensions: &'static [&'static str],
    looks: Looks,
    help: &'static str,
) -> Foreign {
    Foreign { name, extensions, looks, help }
}

/// Positions of SuperSplat's are numbers of 11, 10 and 11 bits within a box.
fn is_compressed_ply(start: &[u8]) -> bool {
    ply::sniff(start) && has(start, "packed_position")
}

/// A scene is TOML.
fn is_scene(start: &[u8]) -> bool {
    has(start, "[[objects]]") && has(start, "points")
}

fn is_web_page(start: &[u8]) -> bool {
    let start = start.trim_ascii_start();
    [&b"<!doctype html"[..], b"<html"]
        .iter()
        .any(|sign| start.get(..sign.len()).is_some_and(|word| word.eq_ignore_ascii_case(sign)))
}

/// Pairs of a number and a word, of which the first are 0 and SECTION, or 999 and a remark.
fn is_dxf(start: &[u8]) -> bool {
    let mut lines = start.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    start.starts_with(b"AutoCAD Binary DXF")
        || lines.next().is_some_and(|line| line == b"0" || line == b"999")
            && lines.take(4).any(|line| line == b"SECTION")
}

/// Blocks of a Gadget snapshot stand between their lengths; the first, of 256 bytes, is the header, or
/// 8 bytes name it.
fn is_gadget(start: &[u8]) -> bool {
    let length =
        |place: usize| start.get(place..place + 4)?.try_into().ok().map(u32::from_le_bytes);
    (length(0) == Some(256) && length(260) == Some(256))
        || (length(0) == Some(8) && start.get(4..8) == Some(b"HEAD"))
}

/// Records of a dump begin with `ITEM:`; of data, the title of the first line mostly says LAMMPS.
fn is_lammps(start: &[u8]) -> bool {
    start.starts_with(b"ITEM: ")
        || (start.starts_with(b"LAMMPS ") && has(start, " atoms") && has(start, " atom types"))
}

fn has(start: &[u8], word: &str) -> bool {
    start.windows(word.len()).any(|part| part == word.as_bytes())
}

impl Looks {
    fn fit(&self, start: &[u8]) -> bool {
        match self {
            Anyhow => false,
            Has(signs) => signs.iter().any(|(place, sign)| {
                start.get(*place..).is_some_and(|rest| rest.starts_with(sign))
            }),
            Text(first, words) => {
                let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
                text.starts_with(first.as_bytes()) && words.iter().all(|word| has(text, word))
            }
            Fits(fits) => fits(start),
        }
    }

    /// Whether nothing else than this format begins so. Zip archives hold anything.
    fn is_clear(&self) -> bool {
        !matches!(self, Has(signs) if signs.iter().any(|(_, sign)| *sign == ZIP))
    }
}

impl Foreign {
    fn is_called(&self, name: &Path) -> bool {
        let name = name.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        self.extensions
            .iter()
            .any(|end| name.strip_suffix(end).is_some_and(|stem| stem.ends_with('.')))
    }

    /// The file is of this format.
    pub(crate) fn error(&self, path: &Path) -> PointsError {
        let (found, help) = (self.name.to_owned(), self.help.to_owned());
        PointsError::UnknownKind { path: path.into(), found, help }
    }
}

/// The format that a file begins like, if it is one that is not read.
pub(crate) fn by_contents(start: &[u8], name: &Path) -> Option<&'static Foreign> {
    let fit = || FOREIGN.iter().filter(|row| row.looks.fit(start));
    fit().find(|row| row.is_called(name)).or_else(|| fit().find(|row| row.looks.is_clear()))
}

/// The row of a zip archive with these files, where they tell it.
pub(crate) fn of_archive<S: AsRef<str>>(names: &[S]) -> Option<&'static Foreign> {
    let has = |end: &str| names.iter().any(|name| name.as_ref().ends_with(end));
    let is_splat = has("meta.json") && has(".webp");
    let row = |name: &str| FOREIGN.iter().find(|row| row.is_called(Path::new(name)));
    if is_splat { row("a.sog") } else { None }
}

/// A file that neither begins like a format that is read nor is called so.
pub(crate) fn unknown(start: &[u8], name: &Path, path: &Path) -> PointsError {
    if let Some(row) = FOREIGN.iter().find(|row| row.is_called(name)) {
        return row.error(path);
    }
    let is_text = |&byte: &u8| byte >= b' ' || byte.is_ascii_whitespace();
    let found = if start.iter().all(is_text) {
        format!("a file that begins with {}", Quoted(start))
    } else {
        let bytes: Vec<String> = start.iter().take(8).map(|byte| format!("{byte:02x}")).collect();
        format!("a binary file that begins with the bytes {}", bytes.join(" "))
    };
    let help = "convert it to one of these".to_owned();
    PointsError::UnknownKind { path: path.into(), found, help }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::ReadOptions;
    use crate::read::read_bytes;

    fn message(bytes: &[u8], name: &str) -> String {
        let error = read_bytes(bytes, Path::new(name), &ReadOptions::default()).unwrap_err();
        let message = error.to_string();
        assert!(!message.chars().any(char::is_control), "{message:?}");
        message
    }

    #[test]
    fn formats_are_named_by_their_contents_or_their_endings() {
        let supersplat = "ply\nformat binary_little_endian 1.0\nelement chunk 1\nproperty float \
                          min_x\nelement vertex 256\nproperty uint packed_position\nend_header\n";
        let mut gadget = vec![0; 300];
        gadget[1] = 1;
        gadget[261] = 1;
        for (bytes, name, expected) in [
            (supersplat.as_bytes(), "a.ply", "found SuperSplat's compressed PLY, expected"),
            (b"NGSP\x02\0\0\0", "a", "found an SPZ file of 3D Gaussians"),
            (&[0x80; 64], "scene.splat", "found a .splat file of 3D Gaussians"),
            (b"\0\x01\0\0", "a.KSPLAT", "found a .ksplat file"),
            (b"\x89HDF\r\n\x1a\n\0", "a.ply", "found an HDF5 file"),
            (b"\x89HDF\r\n\x1a\n\0", "a.vtkhdf", "found a VTKHDF file"),
            (b"\x89HDF\r\n\x1a\n\0", "a.nc", "found a NetCDF file"),
            (&[0, 0, 0x80, 0x3f], "000000.bin", "numpy.fromfile('in.bin', 'f4')"),
            (&[0, 0, 0x80, 0x3f], "a.pcd.bin", "found bare numbers without a header"),
            (b"\x7fNSJb", "a.bgeo", "found a Houdini file"),
            (b"glTF\x02\0\0\0", "a", "found a binary glTF file"),
            (b" {\"asset\":{}, \"accessors\":[]}", "a.gltf", "found a glTF file"),
            (b"DRACO\x02\x02", "a.drc", "draco_decoder -i in.drc -o out.ply"),
            (b"\0\x01", "a.rcp", "export it as E57 from ReCap"),
            (b"solid a\nfacet normal 0 0 1\n", "a.stl", "found an STL file"),
            (b"version https://git-lfs.github.com/spec/v1\n", "a.las", "git lfs pull"),
            (b"<!DOCTYPE html><html>", "a.ply", "found a web page"),
            (b"\x89PNG\r\n\x1a\n", "a.xyz", "found a PNG picture"),
            (b"%PDF-1.7\n1 2 3\n", "a.txt", "found a PDF document"),
            (b"0\nSECTION\n2\nHEADER\n", "a.dxf", "found a DXF file"),
            (&gadget, "snap_005", "found a snapshot of Gadget"),
            (b"{\"root\":{},\"geometricError\":5}", "tileset.json", "found a description of 3D"),
            (b"PK\x03\x04\0\0", "a.sog", "found an SOG archive"),
            (b"[camera]\n[[objects]]\npoints = 'a'\n", "a.txt", "must end with .toml"),
        ] {
            let found = message(bytes, name);
            assert!(found.contains(expected), "{name}: {found}");
        }
    }

    #[test]
    fn unknown_files_are_quoted_and_all_formats_listed() {
        let list = "expected a point file (PLY, LAS, LAZ, E57, PCD, NPY, NPZ, VTK, VTU, VTP, VTS, VTR, \
                    VTI, OFF, OBJ, PTX, ESRI ASCII grids, tables of text: XYZ, PTS, CSV, TXT, ASC); convert";
        let found = message(b"\x01\x02a\xff", "a");
        let bytes = "found a binary file that begins with the bytes 01 02 61 ff, ";
        assert!(found.contains(&format!("{bytes}{list}")), "{found}");
        assert!(message(b"plywood", "a").contains("begins with 'plywood', expected a point file"));
        assert!(message(b"plywood", "a\x1b[2Jb\nc").starts_with("a\\u{1b}[2Jb\\nc: found"));
    }

    /// Of one name, contents decide: `by_contents` of each row's own beginning finds a row of its name.
    #[test]
    fn no_row_hides_another() {
        for row in FOREIGN {
            let Has(signs) = &row.looks else { continue };
            for (place, sign) in *signs {
                let start = [&vec![b'\n'; *place][..], sign].concat();
                let ending = row.extensions.first().map_or(String::new(), |end| format!("a.{end}"));
                let found = by_contents(&start, Path::new(&ending)).map(|row| row.name);
                assert_eq!(found, Some(row.name));
            }
        }
    }

    #[test]
    fn the_table_of_the_docs_is_this_one() {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/point-files.md");
        let docs = std::fs::read_to_string(docs).unwrap();
        let mut names = Vec::new();
        let mut table = String::new();
        for row in FOREIGN.iter() {
            let by = match row.extensions {
                [] => "its contents".to_owned(),
                ends => ends.iter().map(|end| format!("`.{end}`")).collect::<Vec<_>>().join(" "),
            };
            if !names.contains(&row.name) {
                table += &format!("| {} | {by} | {} |\n", row.name, row.help);
            }
            names.push(row.name);
        }
        assert!(docs.contains(&table), "docs/point-files.md lacks this table:\n{table}");
    }
}
