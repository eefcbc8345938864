//! Which of the collected point sets, and of those that the project generates, fill a volume.
#![allow(clippy::expect_used, reason = "tests panic")]

use points::{Dimension, Sign};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The collected point sets, where `POINTILLIST_DATA` names their folder.
fn collected(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("POINTILLIST_DATA").map(PathBuf::from);
    if folder.is_some() {
        return folder;
    }
    // Not captured, so that nobody takes it for a pass.
    let line =
        format!("SKIPPED: {test}: POINTILLIST_DATA names no folder of collected point sets\n");
    let _ = std::io::stderr().write_all(line.as_bytes());
    None
}

fn of(file: &Path) -> Dimension {
    let set = points::read(file, &mut |_, _| {}).expect("a readable file");
    Dimension::of(&set)
}

/// Particles, nodes of grids and of a mesh, samples of a lattice.
#[test]
fn all_volumes_are_volumes() {
    let Some(folder) = collected("all_volumes_are_volumes") else { return };
    for name in [
        "blunt_fin",
        "combustor",
        "disk_out",
        "ironprot_100k",
        "lox_post",
        "sph_dam_break",
        "sph_hilbert",
        "sph_mhd",
        "sph_shock",
    ] {
        let found = of(&folder.join(format!("volumes/{name}.ply")));
        assert!(found.is_volume(), "{name}: {found}");
    }
    let nodes = |name: &str| of(&folder.join(format!("volumes/{name}.ply")));
    assert_eq!(nodes("lox_post"), Dimension::Volume(Sign::Nodes([38, 76, 38])));
    assert_eq!(nodes("blunt_fin"), Dimension::Volume(Sign::Nodes([40, 32, 32])));
    assert_eq!(nodes("combustor"), Dimension::Volume(Sign::Nodes([57, 33, 25])));
}

#[test]
fn no_scan_model_or_terrain_is_a_volume() {
    let Some(folder) = collected("no_scan_model_or_terrain_is_a_volume") else { return };
    let mut looked_at = 0;
    for kind in ["scans", "surfaces", "surfaces/originals", "terrain"] {
        for entry in std::fs::read_dir(folder.join(kind)).expect("a folder") {
            let file = entry.expect("an entry").path();
            let is_points = file.extension().is_some_and(|extension| extension != "png");
            if file.is_file() && is_points {
                assert_eq!(of(&file), Dimension::Surface, "{}", file.display());
                looked_at += 1;
            }
        }
    }
    assert!(looked_at >= 16, "{looked_at} files");
}

#[test]
fn of_generated_points_what_is_a_volume_is_one() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/points");
    // The hare's inside is sparse beside its skin, and is left to whoever asks.
    for name in
        ["dunes", "filled-hare", "floor", "hare", "room", "slab", "sphere", "terrain", "trefoil"]
    {
        assert_eq!(of(&folder.join(format!("{name}.ply"))), Dimension::Surface, "{name}");
    }
    for name in ["molecule", "smoke", "splash", "stream", "swirl"] {
        let found = of(&folder.join(format!("{name}.ply")));
        assert!(found.is_volume(), "{name}: {found}");
    }
}
