//! Damaged files: thousands made from whole ones, each the same on every run. None panics, takes
//! long, or takes much memory.

use peak_alloc::PeakAlloc;
use points::{ReadOptions, read_bytes};
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Damaged files of each whole one.
const CASES: u64 = 1500;
/// Most memory for one, whose whole file has a few kilobytes.
const MOST_BYTES: usize = 64 << 20;
/// Longest time for one. A machine with other work may need several tries.
const LONGEST: Duration = Duration::from_secs(1);

/// Files beside those in `tests/data`.
const TEXTS: [(&str, &str); 16] = [
    ("a.xyz", "1 2 3\n4.5 -6e1 7\n8 9 10\n"),
    ("a.pts", "3\n1 2 3 -100 255 0 10\n4 5 6 0 1 2 3\n7 8 9 100 4 5 6\n"),
    (
        "a.csv",
        "\"x\",\"y\",\"z\",red,green,blue,name\r\n1,2,3,4,5,6,a\r\n1.5,2.5,3.5,255,0,,\"b,c\"\r\n",
    ),
    ("a.csv", "x;y;z;i\n1,5;2,5;3,5;7\n-1,5;nan;3,5;\n1;2;3;4\n"),
    (
        "a.txt",
        "//X Y Z R G B Scalar_field Nx Ny Nz\n2\n1 2 3 255 0 10 0.25 0 0 1\n1 2 3 0 0 1 1 0 1 0\n",
    ),
    ("a.asc", "# a\n\n1\t2\t3\t0.6\t0\t0.8\n4\t5\t6\t0\t1\t0\n"),
    ("a.xyz", "2\nwater\nH 0 0 1.5\nO 1 2 3\n"),
    ("a.obj", "# a\nv 1 2 3 0.5 0 1\nv 4 5 \\\n6 1 1 1\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//2 -1//-1\n"),
    ("a.obj", "v 1 2 3\nv 4 5 6 0.5 0 1\nv 7 8 9 255 0 128\n"),
    (
        "a.ptx",
        "2\n1\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n1 2 3 0.5 255 0 9\n0 0 0 \
         0.5 0 0 0\n1\n1\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n4 5 6 0.5\n",
    ),
    (
        "a.asc",
        "ncols 3\nnrows 2\nxllcorner 500000.5\nyllcenter 1e6\ncellsize 10\nNODATA_value -9999\n1 2 3\n4 \
         -9999 6\n",
    ),
    ("a.off", "CNOFF\n# a\n2 1 0\n1 2 3 0 0 1 255 0 0 255\n4 5 6 0 1 0 0 1 2 3\n2 0 1\n"),
    ("a.off", "OFF BINARY\n\0\0\0\x01\0\0\0\0\0\0\0\0?\0\0\0@\0\0\0A\0\0\0"),
    (
        "a.vtp",
        "<?xml version=\"1.0\"?><VTKFile type='PolyData' header_type='UInt64'><PolyData><Piece \
         NumberOfPoints='1'><PointData><DataArray type='Int8' Name='a' format='ascii'>1</DataArray>\
         </PointData><Points><DataArray type='Float32' NumberOfComponents='3' format='binary'>\
         DAAAAAAAAAAAAIA/AAAAQAAAQEA=</DataArray></Points></Piece><Piece NumberOfPoints='1'>\
         <PointData><DataArray type='Int8' Name='a'>2</DataArray></PointData><Points><DataArray \
         type='Float64' NumberOfComponents='3'>1 2 3</DataArray></Points></Piece></PolyData></VTKFile>",
    ),
    (
        "b.vtp",
        "<VTKFile type='PolyData' compressor='vtkLZMADataCompressor'><PolyData><Piece NumberOfPoints='3'>\
         <Points><DataArray type='Float32' NumberOfComponents='3' format='binary'>AQAAACQAAAAAAAAAVAAAAA==/Td6WFoAAATm1rRGAgAhARwAAAAQz1jM4AAj\
         ABhdAABpnmFwaF8foYEj+uqhAqSoevnJ6LSnIAD1s1Do4EMZ3QABNCQNoq+nH7bzfQEAAAAABFla</DataArray></Points></Piece></PolyData></VTKFile>",
    ),
    (
        "a.vtk",
        "# vtk DataFile Version 3.0\na\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 1\nORIGIN 0 0 \
         0\nSPACING 1 1 1\nPOINT_DATA 4\nCOLOR_SCALARS c 3\n1 0 0 1 0 0 1 0 0 1 0 0\nSCALARS s double\n\
         LOOKUP_TABLE default\n1 2 3 4\nFIELD f 1\na 2 4 int\n1 2 3 4 5 6 7 8\n",
    ),
];

/// Marsaglia's xorshift64.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 16) as usize % end.max(1)
    }

    fn range(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        start..start + self.below((length - start).min(40) + 1)
    }
}

const WORDS: [&[u8]; 16] = [
    b"0",
    b"-1",
    b"9999999999",
    b"18446744073709551615",
    b"4294967295",
    b"1e300",
    b"nan",
    b" ",
    b"\n",
    b"\"",
    b"<",
    b"(",
    b"\xff\xff\xff\xff",
    b"\x7f\xff\xff\xff\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"\xff\xff\xff\xff\xff\xff\xff\x7f",
];

/// A damaged copy.
fn damaged(whole: &[u8], random: &mut Random) -> Vec<u8> {
    let mut file = whole.to_vec();
    for _ in 0..=random.below(3) {
        let part = random.range(file.len());
        match random.below(8) {
            0 => file.truncate(part.start),
            1 => drop(file.drain(part)),
            2 => {
                let copy = file[part.clone()].to_vec();
                file.splice(part.start..part.start, copy);
            }
            3 => {
                let copy = file[part].to_vec();
                let place = random.below(file.len() + 1);
                file.splice(place..place, copy);
            }
            4 => {
                let word = WORDS[random.below(WORDS.len())];
                file.splice(part.start..part.start, word.iter().copied());
            }
            5 => {
                let word = WORDS[random.below(WORDS.len())];
                let end = (part.start + word.len()).min(file.len());
                file.splice(part.start..end, word.iter().copied());
            }
            6 => {
                if let Some(byte) = file.get_mut(part.start) {
                    *byte = random.below(256) as u8;
                }
            }
            _ => {
                if let Some(byte) = file.get_mut(part.start) {
                    *byte ^= 1 << random.below(8);
                }
            }
        }
    }
    file
}

/// One test, as memory is counted for the process.
#[test]
fn damaged_files_end_in_points_or_an_error() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let mut files: Vec<(String, Vec<u8>)> =
        TEXTS.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec())).into();
    for entry in std::fs::read_dir(data).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        files.push((name, std::fs::read(path).unwrap()));
    }
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(TEXTS[0].1.as_bytes()).unwrap();
    files.push(("a.xyz.gz".to_owned(), packed.finish().unwrap()));
    files.sort();
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let (mut read, mut refused) = (0, 0);
    for (name, whole) in &files {
        for case in 0..CASES {
            let file = damaged(whole, &mut random);
            let mut longest = Duration::MAX;
            for _ in 0..3 {
                MEMORY.reset_peak_usage();
                let before = MEMORY.current_usage();
                let start = Instant::now();
                let result = read_bytes(&file, Path::new(name), &ReadOptions::default());
                longest = longest.min(start.elapsed());
                let bytes = MEMORY.peak_usage().saturating_sub(before);
                assert!(bytes <= MOST_BYTES, "{name}, case {case}: {bytes} bytes");
                match result {
                    Ok(set) => {
                        assert!(!set.is_empty(), "{name}, case {case}");
                        read += 1;
                    }
                    Err(error) => {
                        let text = error.to_string();
                        let rest = text.strip_prefix(name.as_str());
                        assert!(rest.is_some_and(|rest| rest.starts_with(':')), "{text}");
                        assert!(!text.contains('\n') && text.len() < 3000, "{text}");
                        // Bytes in memory can always be read.
                        assert!(!text.contains("cannot read the file"), "{name}: {error:?}");
                        refused += 1;
                    }
                }
                if longest < LONGEST {
                    break;
                }
            }
            assert!(longest < LONGEST, "{name}, case {case}: {longest:?}");
        }
    }
    assert!(read > 1000 && refused > 1000, "{read} read, {refused} refused");
}
