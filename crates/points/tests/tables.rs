//! Files that NumPy 2.4, meshio 5.3 and VTK 9.7 wrote of the same few points.

use points::{ColorEncoding, PointSet, PointsError, Values};
use std::path::Path;

const POINTS: [[f64; 3]; 5] = [
    [1.0, 2.0, 3.0],
    [4.0, 5.0, 6.5],
    [-7.0, 8e3, 9.25],
    [0.1, 0.2, 0.3],
    [636_001.76, 4_918_340.25, 2322.5],
];

fn read(name: &str) -> Result<PointSet, PointsError> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    points::read(&path, &mut |_, _| ())
}

fn has_density(set: &PointSet) {
    let values: Vec<f64> = (0..set.len()).map(|i| 0.125 * i as f64 + 0.1).collect();
    assert_eq!(set.attribute("density"), Some(&Values::F64(values)), "{}", set.format);
}

/// Of each point, three bytes: 16 more than those before them.
fn has_colors(set: &PointSet) {
    assert_eq!(set.color_encoding, Some(ColorEncoding::Srgb8), "{}", set.format);
    let bytes = set.colors.iter().flatten().flatten().map(|&c| ColorEncoding::Srgb8.encode(c));
    for (i, byte) in bytes.enumerate() {
        assert_eq!(byte, f64::from(16 * i as u32 % 256), "{}: {i}", set.format);
    }
}

fn has_normals(set: &PointSet) {
    assert_eq!(set.normals, Some(vec![[0.0, 0.0, 1.0]; set.len()]), "{}", set.format);
}

#[test]
fn files_of_numpy_hold_what_was_put_in() {
    for name in ["numpy-fields.npy", "numpy-fortran-be.npy", "numpy-plain.npz", "numpy-packed.npz"]
    {
        let set = read(name).unwrap();
        assert_eq!(set.positions, POINTS, "{name}");
        if name.contains("fortran") {
            continue;
        }
        has_density(&set);
        has_colors(&set);
        if name.ends_with("npz") {
            has_normals(&set);
        } else {
            assert_eq!(set.attribute("n_1"), Some(&Values::F32(vec![0.5; 5])));
        }
    }
    let set = read("numpy-savetxt.csv").unwrap();
    assert_eq!(set.positions, POINTS);
    has_colors(&set);
}

#[test]
fn files_of_meshio_hold_what_was_put_in() {
    for name in ["meshio-lzma.vtu", "meshio-51.vtk", "meshio.obj", "meshio.off"] {
        let set = read(name).unwrap();
        assert_eq!(set.positions, POINTS, "{name}");
        if name.contains('-') {
            has_density(&set);
            let v: Vec<f64> = (0..5).map(|i| f64::from(3 * i + 1)).collect();
            assert_eq!(set.attribute("v_1"), Some(&Values::F64(v)), "{name}");
        }
    }
}

#[test]
fn files_of_vtk_hold_what_was_put_in() {
    let lattice = |origin: [f64; 3], step: [f64; 3]| {
        let node = move |i: u32| {
            let place = [i % 3, i / 3 % 2, i / 6].map(f64::from);
            [0, 1, 2].map(|axis| origin[axis] + step[axis] * place[axis])
        };
        (0..12).map(node).collect::<Vec<_>>()
    };
    for name in [
        "vtk-ascii-none-32-le.vtp",
        "vtk-inline-zlib-32-le.vtp",
        "vtk-raw-zlib-64-be.vtp",
        "vtk-base64-lzma-32-be.vtp",
        "vtk-raw-lz4-64-be.vtu",
        "vtk-raw-none-64-le.vtu",
        "vtk-base64-none-32-le.vtu",
        "vtk-poly-ascii-42.vtk",
        "vtk-ug-binary-51.vtk",
        "vtk-raw-zlib-32-le.vti",
        "vtk-image-binary-42.vtk",
        "vtk-inline-lz4-64-le.vtr",
        "vtk-rect-ascii-51.vtk",
        "vtk-base64-zlib-32-be.vts",
        "vtk-sgrid-binary-51.vtk",
    ] {
        let set = read(name).unwrap();
        let image = lattice([10.5, 20.0, 30.0], [0.5, 1.0, 2.0]);
        let mut rectilinear = lattice([1.0, 0.0, -1.0], [1.0, 5.0, 2.0]);
        rectilinear.iter_mut().skip(2).step_by(3).for_each(|node| node[0] = 4.0);
        let curved: Vec<_> = (0..12).map(f64::from).map(|i| [i, 2.0 * i, i * i]).collect();
        let expected = match name {
            name if name.ends_with("vti") || name.contains("image") => &image[..],
            name if name.ends_with("vtr") || name.contains("rect") => &rectilinear,
            name if name.ends_with("vts") || name.contains("sgrid") => &curved,
            _ => &POINTS,
        };
        assert_eq!(set.positions, expected, "{name}");
        has_density(&set);
        has_colors(&set);
        has_normals(&set);
        let velocity: Vec<f32> = (0..set.len()).map(|i| 3.0 * i as f32 + 2.0).collect();
        assert_eq!(set.attribute("velocity_2"), Some(&Values::F32(velocity)), "{name}");
        assert_eq!(set.attribute("id").map(|id| id.get(4)), Some(40.0), "{name}");
        assert_eq!(set.attributes.len(), 5, "{name}");
    }
}

/// Files that are gone through twice tell so only once.
#[test]
fn progress_never_goes_back() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let length = std::fs::metadata(&path).unwrap().len();
        let mut told = Vec::new();
        points::read(&path, &mut |read, of| told.push((read, of))).unwrap();
        assert!(told.is_sorted() && !told.is_empty(), "{}: {told:?}", path.display());
        assert!(told.iter().all(|&(read, of)| read <= length && of == length), "{told:?}");
    }
}
