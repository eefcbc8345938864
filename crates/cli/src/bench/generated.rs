//! Points that are made for a row, in a temporary file: a simulated scan, or even points on a surface or random ones in a
//! cube, as many as asked for.
//!
//! Point `i` of `n` lies at the golden ratio's multiple around, and at the share `(i + ½) / n` of the
//! area across: a lattice without clusters or gaps, for any `n`, and the same on every machine.

use crate::errors::{Exit, Failure};
use crate::interrupt;
use points::Watch;
use scans::{Room, Scan, Scanner};
use scene::{Shape, SimulatedScan};
use std::f64::consts::TAU;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// One over the golden ratio.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Radius of the torus's tube, over that of its centre line.
const TUBE: f64 = 0.4;
/// Steps of Newton's method: from anywhere on the torus, six are exact to rounding.
const STEPS: u32 = 8;
/// Points between two looks at the clock.
const BLOCK: u32 = 1 << 16;

/// What is made.
#[derive(Debug, Clone, Copy)]
pub enum Made {
    /// So many even points.
    Even(Shape, u32),
    /// A scan of the room numbered 0.
    Scan(SimulatedScan),
}

impl Made {
    /// A file's name.
    pub fn file_name(self) -> String {
        match self {
            Self::Even(shape, count) => format!("{shape:?}-{count}.ply").to_lowercase(),
            Self::Scan(scan) => format!("{scan:?}.ply").to_lowercase(),
        }
    }

    /// About how many points, at most.
    pub fn count(self) -> u32 {
        match self {
            Self::Even(_, count) => count,
            Self::Scan(_) => MOST_SCANNED,
        }
    }
}

/// Points of the largest scan: a depth image of 640 × 480.
const MOST_SCANNED: u32 = 640 * 480;
/// Of the noise of scans.
const SEED: u64 = 1;

/// Writes points as a binary PLY file.
pub fn write(path: &Path, made: Made, watch: &dyn Watch) -> Result<(), Failure> {
    let written = match made {
        Made::Even(shape, count) => {
            watch.stage("generating points", u64::from(count));
            let point = |index| point(shape, index, count);
            let float = |x: f64| x as f32;
            if shape == Shape::Cube {
                let with_scalar = |index| {
                    let p @ [x, y, z] = point(index);
                    [x, y, z, density(p)].map(float)
                };
                write_points(path, count, "property float density\n", with_scalar, watch)
            } else {
                write_points(path, count, "", |index| point(index).map(float), watch)
            }
        }
        Made::Scan(scan) => {
            watch.stage("scanning a room", u64::from(MOST_SCANNED));
            let points = Scan::new(scanner(scan), &Room::new(0), SEED, 1.0).positions();
            write_points(path, points.len() as u32, "", |index| points[index as usize], watch)
        }
    };
    written.map_err(|error| match error.kind() {
        io::ErrorKind::Interrupted => Failure::interrupted(),
        _ => Failure {
            exit: Exit::Exhausted,
            lines: vec![format!(
                "{}: cannot hold {} generated points ({error}); make room, or set TMPDIR to a \
                 folder that has it",
                path.display(),
                made.count()
            )],
        },
    })
}

fn scanner(scan: SimulatedScan) -> Scanner {
    match scan {
        SimulatedScan::Depth => Scanner::Depth,
        SimulatedScan::Tls1 => Scanner::Laser1,
        SimulatedScan::Tls3 => Scanner::Laser3,
        SimulatedScan::Tls10 => Scanner::Laser10,
        SimulatedScan::Photo => Scanner::Photo,
    }
}

/// `scalars` says what follows the coordinates.
fn write_points<const N: usize>(
    path: &Path,
    count: u32,
    scalars: &str,
    point: impl Fn(u32) -> [f32; N],
    watch: &dyn Watch,
) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\n\
         property float y\nproperty float z\n{scalars}end_header\n"
    )?;
    for index in 0..count {
        if index % BLOCK == 0 {
            if interrupt::requested() {
                return Err(io::ErrorKind::Interrupted.into());
            }
            watch.done(u64::from(index));
        }
        for number in point(index) {
            file.write_all(&number.to_le_bytes())?;
        }
    }
    file.flush()
}

/// Point `index` of `count`.
fn point(shape: Shape, index: u32, count: u32) -> [f64; 3] {
    let (sin, cos) = (TAU * (GOLDEN * f64::from(index)).fract()).sin_cos();
    let share = (f64::from(index) + 0.5) / f64::from(count);
    match shape {
        Shape::Sphere => {
            let y = 1.0 - 2.0 * share;
            let radius = (1.0 - y * y).sqrt();
            [radius * cos, y, radius * sin]
        }
        Shape::Torus => {
            let (up, out) = across(share).sin_cos();
            let radius = 1.0 + TUBE * out;
            [radius * cos, TUBE * up, radius * sin]
        }
        Shape::Hills => {
            let [x, z] = [share - 0.5, (GOLDEN * f64::from(index)).fract() - 0.5];
            [x, hills(x, z), z]
        }
        Shape::Cube => [0, 1, 2].map(|axis| 2.0 * random(3 * u64::from(index) + axis) - 1.0),
    }
}

/// The same from 0 to 1 for the same number (splitmix64, Steele et al. 2014).
fn random(number: u64) -> f64 {
    let mut z = (number + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Two waves across the cube, from 0 to 1.
fn density([x, y, z]: [f64; 3]) -> f64 {
    0.5 + 0.25 * (3.0 * x + y).sin() + 0.25 * (2.0 * y - 4.0 * z).cos()
}

/// Of no height and no slope at the origin.
fn hills(x: f64, z: f64) -> f64 {
    0.02 * (1.0 - (11.0 * x).cos() * (7.0 * z).cos())
}

/// The angle around the tube that has this share of the torus's area below it. The area up to v goes
/// with v + TUBE sin v.
fn across(share: f64) -> f64 {
    let area = TAU * share;
    let mut v = area;
    for _ in 0..STEPS {
        v -= (v + TUBE * v.sin() - area) / (1.0 + TUBE * v.cos());
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;
    use points::Unwatched;
    use points::neighbors::median_spacing;

    /// Each point is on the surface, and the spacing is that of as many points laid out evenly: the
    /// side of a square of area / n is 1.0 to 1.1 times the distance to the nearest other of a lattice.
    #[test]
    fn points_are_even_and_on_the_surface_for_any_count() {
        for count in [1_000, 31_623] {
            // The hills are a little wider than their square.
            let shapes =
                [(Shape::Sphere, 2.0 * TAU), (Shape::Torus, TAU * TAU * TUBE), (Shape::Hills, 1.0)];
            for (shape, area) in shapes {
                let points: Vec<_> = (0..count).map(|i| point(shape, i, count)).collect();
                for [x, y, z] in &points {
                    let off = match shape {
                        Shape::Sphere => x * x + y * y + z * z - 1.0,
                        Shape::Torus => (x.hypot(*z) - 1.0).hypot(*y) - TUBE,
                        Shape::Hills => y - hills(*x, *z),
                        Shape::Cube => 0.0,
                    };
                    assert!(off.abs() < 1e-12, "{shape:?}: {off}");
                }
                let side = (area / f64::from(count)).sqrt();
                let spacing = median_spacing(&points).unwrap() / side;
                assert!((0.6..1.1).contains(&spacing), "{shape:?}, {count}: {spacing}");
            }
        }
    }

    /// Points of a cube fill it: of the eight halves of halves, each has its eighth within five deviations.
    #[test]
    fn points_in_a_cube_are_at_random_with_a_scalar() {
        let count = 80_000;
        let mut eighths = [0; 8];
        for p in (0..count).map(|i| point(Shape::Cube, i, count)) {
            assert!(p.iter().all(|x| x.abs() <= 1.0) && (0.0..=1.0).contains(&density(p)));
            eighths[p.iter().fold(0, |at, &x| 2 * at + usize::from(x > 0.0))] += 1;
        }
        let off = 5.0 * (f64::from(count) * 7.0 / 64.0).sqrt();
        for own in eighths {
            assert!((f64::from(own) - f64::from(count) / 8.0).abs() < off, "{eighths:?}");
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cube.ply");
        write(&path, Made::Even(Shape::Cube, 500), &Unwatched).unwrap();
        let set = points::read(&path, &mut |_, _| {}).unwrap();
        assert_eq!(set.attribute("density").map(|values| values.iter().count()), Some(500));
    }

    /// Half of a torus's area, seen from its axis, lies outside of the circle at 1 + TUBE · 2/π · …:
    /// a closed form of the share is what `across` inverts.
    #[test]
    fn angles_have_their_share_of_the_area_below_them() {
        for share in [0.0, 1e-9, 0.1, 0.25, 0.5, 0.75, 0.999, 1.0] {
            let v = across(share);
            // An ulp at tau is 9e-16; the sine is off by as much.
            assert!((v + TUBE * v.sin() - TAU * share).abs() < 1e-14, "{share}: {v}");
        }
    }

    #[test]
    fn the_file_is_read_back_with_every_point() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("torus.ply");
        write(&path, Made::Even(Shape::Torus, 1234), &Unwatched).unwrap();
        let set = points::read(&path, &mut |_, _| {}).unwrap();
        assert_eq!((set.len(), set.non_finite), (1234, 0));
        let last = point(Shape::Torus, 1233, 1234).map(|x| f64::from(x as f32));
        assert_eq!(set.positions.last(), Some(&last));
    }

    /// The scene that shows them has the room's camera and light.
    #[test]
    fn scans_are_of_the_room_whose_camera_their_scene_has() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("photo.ply");
        let made = Made::Scan(SimulatedScan::Photo);
        write(&path, made, &Unwatched).unwrap();
        let set = points::read(&path, &mut |_, _| {}).unwrap();
        assert!(set.len() > 130_000 && set.len() < made.count() as usize, "{}", set.len());
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/bench/scenes/room.toml");
        let shown = scene::Scene::load(&file, &[]).unwrap();
        let text = Room::new(0).scene("a.ply", [320, 240], "");
        let room = scene::Scene::from_toml(&text, "a.toml".as_ref(), &[]).unwrap();
        assert_eq!(shown.camera, room.camera);
        assert_eq!(shown.lights, room.lights);
    }
}
