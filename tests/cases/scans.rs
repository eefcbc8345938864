//! Simulated scans of rooms, rendered with no surface key set, against the rooms.

#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use harness::judge::{Truth, Verdict};
use harness::{Bench, plan_of, said, set_of};
use scans::{Room, Scan, Scanner};
use std::path::{Path, PathBuf};

/// Of a quarter of the pixels that the limits were set for.
const SIZE: [usize; 2] = [160, 120];
/// 0 is laid out by hand, the others are drawn by chance.
const ROOMS: [u32; 3] = [0, 1, 2];
const SEEDS: [u64; 3] = [1, 2, 3];

/// A picture of the part of a scan that it shows, judged: as dense as the whole scan, and with as many edges to its area.
/// Where `POINTILLIST_SCANS_TO` names a folder, points, scene and picture are written there.
fn judged(scanner: Scanner, room: u32, seed: u64) -> Verdict {
    let name = format!("{}-room{room}-seed{seed}", scanner.name());
    let room = Room::new(room);
    let aspect = SIZE[0] as f64 / SIZE[1] as f64;
    let scan = Scan::new(scanner, &room, seed, 1.0).in_view(aspect);
    let positions = scan.positions();
    let scene = room.scene(&format!("{name}.ply"), SIZE, "");
    let wide = positions.iter().map(|p| p.map(f64::from)).collect();
    let plan = plan_of(&scene, &[set_of(wide)]);
    let film = Bench::open().render(&plan).film;
    if let Some(folder) = std::env::var_os("POINTILLIST_SCANS_TO").map(PathBuf::from) {
        write_ply(&folder.join(format!("{name}.ply")), &positions);
        std::fs::write(folder.join(format!("{name}.toml")), &scene).expect("a written scene");
        film::write(&film, plan.provenance(), &folder.join(format!("{name}.exr")))
            .expect("a written picture");
    }
    let verdict = Truth::new(&room, &scan, SIZE).judge(&film);
    said(&format!("{name}: {} points, {verdict}", positions.len()));
    verdict
}

fn write_ply(path: &Path, positions: &[[f32; 3]]) {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nend_header\n",
        positions.len()
    )
    .into_bytes();
    bytes.extend(positions.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    std::fs::write(path, bytes).expect("written points");
}

/// Percent and degrees that no scan's picture may miss.
struct Limits {
    coverage: f64,
    normal: [f64; 2],
    wrong: f64,
    phantoms: f64,
    speckle: f64,
}

impl Limits {
    fn of(scanner: Scanner) -> Self {
        let (coverage, normal, wrong, phantoms, speckle) = match scanner {
            Scanner::Laser1 => (97.0, [2.0, 5.0], 4.0, 1.5, 1.5),
            Scanner::Laser3 => (98.0, [3.0, 7.0], 5.0, 2.0, 2.5),
            Scanner::Laser10 => (98.0, [4.5, 20.0], 10.0, 6.0, 5.0),
            Scanner::Photo => (95.0, [3.5, 12.0], 7.0, 2.5, 3.0),
            Scanner::Depth => (98.0, [5.0, 12.0], 4.0, 2.0, 2.0),
        };
        Self { coverage, normal, wrong, phantoms, speckle }
    }

    fn hold(&self, verdict: &Verdict) -> bool {
        verdict.coverage >= self.coverage
            && verdict.normal[0] <= self.normal[0]
            && verdict.normal[1] <= self.normal[1]
            && verdict.wrong <= self.wrong
            && verdict.phantoms <= self.phantoms
            && verdict.speckle <= self.speckle
    }
}

/// Every seed in every room, so that one run says of all which fail.
fn check(scanner: Scanner) {
    let limits = Limits::of(scanner);
    let each = ROOMS.into_iter().flat_map(|room| SEEDS.map(|seed| [u64::from(room), seed]));
    let over = each.filter(|&[room, seed]| !limits.hold(&judged(scanner, room as u32, seed)));
    let over: Vec<_> = over.collect();
    assert!(over.is_empty(), "{}: [room, seed] over the limits: {over:?}", scanner.name());
}

#[test]
fn a_laser_scan_of_little_noise_is_shown_as_it_is() {
    check(Scanner::Laser1);
}

#[test]
fn a_laser_scan_of_some_noise_is_shown_as_it_is() {
    check(Scanner::Laser3);
}

#[test]
fn a_laser_scan_of_much_noise_is_shown_as_it_is() {
    check(Scanner::Laser10);
}

#[test]
fn photogrammetry_is_shown_as_it_is() {
    check(Scanner::Photo);
}

#[test]
fn a_depth_image_is_shown_as_it_is() {
    check(Scanner::Depth);
}
