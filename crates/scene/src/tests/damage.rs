//! Damaged scenes.

use super::{FULL, SMALL, read, read_with};

#[test]
fn no_prefix_of_a_scene_panics() {
    for end in 0..FULL.len() {
        if let Some(text) = FULL.get(..end) {
            let _ = read(text);
            let _ = read_with(SMALL, &[text]);
        }
    }
}

/// Every byte replaced by each of a few that mean something in TOML.
#[test]
fn no_corrupted_byte_panics() {
    for at in 0..FULL.len() {
        for byte in *b"\"'[]{}=.,#-0ex\n\\\0" {
            let mut bytes = FULL.as_bytes().to_vec();
            bytes[at] = byte;
            if let Ok(scene) = String::from_utf8(bytes).map(|text| read(&text)) {
                let message = scene.err().map(|error| error.to_string()).unwrap_or_default();
                assert!(message.lines().all(|line| line.starts_with("scenes/s.toml")), "{message}");
            }
        }
    }
}

#[test]
fn no_dropped_line_panics() {
    let lines: Vec<&str> = FULL.lines().collect();
    for skip in 0..lines.len() {
        let kept = lines.iter().enumerate().filter(|(index, _)| *index != skip);
        let _ = read(&kept.map(|(_, line)| format!("{line}\n")).collect::<String>());
    }
}
