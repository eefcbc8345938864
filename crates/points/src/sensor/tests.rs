//! Tests of sensors in files made here: where they stand, how they are turned, which points they have.

use super::*;
use crate::filter::Filter;
use crate::options::ReadOptions;
use crate::read::read_bytes;
use crate::set::PointSet;
use crate::summary::summarize;
use crate::voxels::{Voxel, voxel_means};
use crate::watch::Unwatched;
use std::fmt::Write;
use std::path::Path;

const COLUMNS: u32 = 40;
const ROWS: u32 = 30;

/// Where a camera sees a room with a box before its wall, by column and row: x to the right, y down, z ahead.
fn seen([column, row]: [u32; 2]) -> [f64; 3] {
    let z = if (10..20).contains(&column) && row > 12 { 1.5 } else { 3.0 + 0.02 * f64::from(row) };
    let [x, y] =
        [(column, COLUMNS), (row, ROWS)].map(|(at, of)| f64::from(at) - 0.5 * f64::from(of));
    [x / 35.0 * z, y / 35.0 * z, z]
}

/// A quarter turn about x and 30 degrees about z, and survey coordinates.
fn pose() -> Pose {
    let (half, [s, c]) = (0.5f64.sqrt(), [15.0f64, 75.0].map(|angle| angle.to_radians().sin()));
    let place = [636_590.25, 4_849_216.5, 440.125];
    Pose::of_quaternion([half * c, half * c, half * s, half * s], place).unwrap()
}

fn placed(pose: &Pose, local: [f64; 3]) -> [f64; 3] {
    let turned = pose.turned(local);
    [0, 1, 2].map(|i| turned[i] + pose.translation[i])
}

/// An organised cloud, of which a few points were not measured.
fn organised(viewpoint: &str, place: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let points = COLUMNS * ROWS;
    let mut text = format!(
        "VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {COLUMNS}\nHEIGHT {ROWS}\n\
         {viewpoint}POINTS {points}\nDATA ascii\n"
    );
    for i in 0..points {
        match i % 11 {
            5 => text += "nan nan nan\n",
            _ => {
                let [x, y, z] = place(seen([i % COLUMNS, i / COLUMNS]));
                let _ = writeln!(text, "{x} {y} {z}");
            }
        }
    }
    text
}

fn read_with(text: &str, name: &str, filter: Filter) -> PointSet {
    let options = ReadOptions { filter, ..ReadOptions::default() };
    read_bytes(text.as_bytes(), Path::new(name), &options).unwrap()
}

fn read(text: &str, name: &str) -> PointSet {
    read_with(text, name, Filter::default())
}

fn close(a: [f64; 3], b: [f64; 3]) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() < 1e-9)
}

fn all_close(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> bool {
    (0..3).all(|i| close(a[i], b[i]))
}

#[test]
fn a_quaternion_is_the_rotation_of_its_half_angle() {
    let quarter = Pose::of_quaternion([2.0, 0.0, 0.0, 2.0], [1.0, 2.0, 3.0]).unwrap();
    assert!(close(quarter.turned([1.0, 0.0, 5.0]), [0.0, 1.0, 5.0]));
    assert!(close(quarter.local([1.0, 3.0, 3.0]), [1.0, 0.0, 0.0]));
    assert_eq!(Pose::of_quaternion([0.0; 4], [0.0; 3]), None);
    assert_eq!(Pose::of_quaternion([1.0, 0.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0]), None);
    // What the point lands on is what the pose says, at survey coordinates too.
    let p = [0.5, -0.25, 2.0];
    assert!(close(pose().local(placed(&pose(), p)), p));
}

#[test]
fn an_organised_cloud_shows_that_its_camera_is_in_the_origin() {
    let identity = "VIEWPOINT 0 0 0 1 0 0 0\n";
    let backwards = |[x, y, z]: [f64; 3]| [x, -y, -z];
    let back = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    for (viewpoint, text, axes) in [
        ("default", organised(identity, |p| p), CAMERA),
        ("none", organised("", |p| p), CAMERA),
        ("no pose", organised("VIEWPOINT a b\n", |p| p), CAMERA),
        ("looks along -z", organised(identity, backwards), back),
        // As the grabbers of PCL write it: points are in the camera's coordinates all the same.
        ("half a turn", organised("VIEWPOINT 0 0 0 0 1 0 0\n", |p| p), CAMERA),
        ("elsewhere", organised("VIEWPOINT 7 8 9 1 0 0 0\n", |p| p), CAMERA),
    ] {
        let set = read(&text, "a.pcd");
        let [sensor] = set.sensors.as_slice() else { panic!("{viewpoint}: {:?}", set.sensors) };
        assert_eq!(
            (sensor.position, sensor.image),
            ([0.0; 3], Some([COLUMNS, ROWS])),
            "{viewpoint}"
        );
        assert!(all_close(sensor.axes, axes), "{viewpoint}: {:?}", sensor.axes);
        assert_eq!(sensor.points, 0..COLUMNS * ROWS);
    }
}

/// What a file says of its viewpoint counts where points agree, or have no rows.
#[test]
fn a_viewpoint_is_where_the_sensor_stood() {
    let half = 0.5f64.sqrt();
    let (s, c) = (15f64.to_radians().sin(), 15f64.to_radians().cos());
    let [w, x, y, z] = [half * c, half * c, half * s, half * s];
    let viewpoint = format!("VIEWPOINT 636590.25 4849216.5 440.125 {w} {x} {y} {z}\n");
    let set = read(&organised(&viewpoint, |p| placed(&pose(), p)), "a.pcd");
    let sensor = &set.sensors[0];
    assert_eq!((sensor.position, sensor.image), (pose().translation, Some([COLUMNS, ROWS])));
    assert!(all_close(sensor.axes, CAMERA.map(|axis| pose().turned(axis))), "{:?}", sensor.axes);

    // Points that no camera there could have seen.
    let mixed = |[x, y, z]: [f64; 3]| [z * (50.0 * x).sin(), x * (70.0 * y).cos(), y * z - x];
    let set = read(&organised(&viewpoint, mixed), "a.pcd");
    assert_eq!((set.sensors[0].position, set.sensors[0].image), (pose().translation, None));
    assert_eq!(read(&organised("", mixed), "a.pcd").sensors, []);
    // A map of heights is seen from nowhere.
    let map = |[x, y, z]: [f64; 3]| [(x / z * 35.0).round(), (y / z * 35.0).round(), 20.0 + z];
    assert_eq!(read(&organised("", map), "a.pcd").sensors, []);
    let plane = |p: [f64; 3]| [map(p)[0] + 30.0, map(p)[1] + 20.0, 1.0];
    assert_eq!(read(&organised("", plane), "a.pcd").sensors, []);

    let of = |viewpoint: &str| {
        let head =
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n";
        read(&format!("{head}{viewpoint}POINTS 2\nDATA ascii\n1 2 3\n4 5 6\n"), "a.pcd").sensors
    };
    assert_eq!(of("VIEWPOINT 1 2 3 1 0 0 0\n")[0].position, [1.0, 2.0, 3.0]);
    assert_eq!(of("VIEWPOINT 0 0 0 1 0 0 0\n"), []);
    assert_eq!(of("VIEWPOINT 0 0 nan 1 0 0 0\n"), []);
    assert_eq!(of("VIEWPOINT 1 2 3 0 0 0 0\n"), []);
}

/// A scan of a scanner with these axes and place: two columns of two rows, one of them not measured.
fn scan([place, x, y, z]: [[f64; 3]; 4], matrix: [[f64; 3]; 4]) -> String {
    let three = |v: [f64; 3]| format!("{} {} {}", v[0], v[1], v[2]);
    let mut text = format!("2\n2\n{}\n{}\n{}\n{}\n", three(place), three(x), three(y), three(z));
    for (row, last) in matrix.into_iter().zip([0, 0, 0, 1]) {
        let _ = writeln!(text, "{} {last}", three(row));
    }
    text + "1 2 3 0.5\n0 0 0 0.5\n2 2 3 0.5\n1 1 3 0.5\n"
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];
const BACK: [f64; 3] = [-1.0, 0.0, 0.0];

#[test]
fn scanners_stand_where_their_scans_are_put() {
    let place = [500_000.0, 4_100_000.5, 200.0];
    // x becomes y, and y becomes -x.
    let [turned, matrix] = [[place, Y, BACK, Z], [Y, BACK, Z, place]];
    let text = scan([[0.0; 3], X, Y, Z], [X, Y, Z, [0.0; 3]]) + &scan(turned, matrix);
    let set = read(&text, "a.ptx");
    let [first, second] = set.sensors.as_slice() else { panic!("{:?}", set.sensors) };
    assert_eq!((first.position, first.points.clone()), ([0.0; 3], 0..4));
    assert_eq!((second.position, second.points.clone()), (place, 4..8));
    assert!(all_close(first.axes, SCANNER) && second.image == Some([2, 2]));
    // Ahead is x, which became y; up is z.
    assert!(all_close(second.axes, [X, Z, Y]), "{:?}", second.axes);
    for (place_in_set, index) in set.file_index.iter().enumerate() {
        let expected = if *index < 4 { [0.0; 3] } else { place };
        assert_eq!(set.sensor_of(place_in_set), Some(expected));
    }
    // A file that leaves all where it is does not say where that was measured.
    let unposed = scan([[0.0; 3], X, Y, Z], [X, Y, Z, [0.0; 3]]);
    assert_eq!(read(&unposed, "a.ptx").sensors, []);
    // Where the matrix moves nothing, the place of the scanner counts.
    let posed = scan(turned, [X, Y, Z, [0.0; 3]]);
    let set = read(&posed, "a.ptx");
    assert_eq!(set.sensors[0].position, place);
    assert!(all_close(set.sensors[0].axes, [X, Z, Y]));
}

#[test]
fn points_keep_their_sensors_through_filters_and_means() {
    let at = |place: [f64; 3]| scan([place, X, Y, Z], [X, Y, Z, place]);
    let text = at([0.0; 3]) + &at([100.0, 0.0, 0.0]) + &at([0.0, 50.0, 0.0]);
    let whole = read(&text, "a.ptx");
    assert_eq!(whole.sensors.len(), 3);
    let check = |set: &PointSet| {
        assert_eq!(set.sensors, whole.sensors);
        for (i, p) in set.positions.iter().enumerate() {
            let sensor = set.sensor_of(i).unwrap();
            assert!((0..2).all(|axis| (p[axis] - sensor[axis]).abs() < 3.0), "{p:?} {sensor:?}");
        }
    };
    check(&whole);
    check(&whole.filtered(|i| i % 2 == 1));
    check(&voxel_means(&whole, 10.0, 1));
    check(&read_with(&text, "a.ptx", Filter { every: 3, ..Filter::default() }));
    let voxel = Some(Voxel::Edge(10.0));
    check(&read_with(&text, "a.ptx", Filter { voxel, ..Filter::default() }));
    let nobody = PointSet { sensors: vec![], ..whole.clone() };
    assert_eq!(nobody.sensor_of(0), None);

    // `info` holds no points.
    let path = std::env::temp_dir().join(format!("sensors-{}.ptx", std::process::id()));
    std::fs::write(&path, &text).unwrap();
    let summary = summarize(&path, &ReadOptions::default(), &Unwatched).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(summary.sensors, whole.sensors);
    assert!(summary.to_string().contains("sensor   at 100 0 0, 4 points in 2 columns and 2 rows"));
}
