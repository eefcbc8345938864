//! Machines whose Vulkan is missing, broken or old, as the loader finds it: by its variables. What the loader
//! makes of a broken file differs from version to version; what is asserted is the same for all.
#![cfg(target_os = "linux")]

use crate::{Folder, Ran, pointillist, sphere};
use std::process::Command;

const HELP: &str = "--device reference";

/// The binary with nothing of the caller's layers but what `set` says.
fn with(folder: &Folder, set: &[(&str, &str)]) -> Command {
    let mut command = pointillist();
    // The driver under test stays, unless it is what is at fault.
    for name in ["VK_INSTANCE_LAYERS", "VK_ADD_LAYER_PATH"] {
        command.env_remove(name);
    }
    command.envs(set.iter().copied()).current_dir(folder.path());
    command
}

/// By default the CPU renders and says why, with all of `words`; `devices` says the same of the default; a device that is
/// asked for is 3.
#[track_caller]
fn no_device(folder: &Folder, set: &[(&str, &str)], words: &[&str]) {
    let devices = Ran::of(with(folder, set).arg("devices")).succeeds();
    let default = devices.stdout.lines().find(|line| line.starts_with("default    reference: "));
    let default = default.unwrap_or_else(|| panic!("{devices:?}"));
    let picture = folder.path().join("a.png");
    let render = ["render", "ball.ply", "-o", "a.png", "--size", "8x8"];
    let run = |options: &[&str]| Ran::of(with(folder, set).args(render).args(options));
    let names = folder.names();
    for device in ["vulkan", "Vulkan", "0", "nobody's"] {
        let asked = run(&["--device", device]).fails_with(3, &[HELP]);
        assert_eq!(asked.stderr.lines().count(), 1, "{asked:?}");
        for word in words {
            assert!(asked.stderr.contains(word), "'{word}' is not in: {}", asked.stderr);
        }
    }
    assert_eq!(folder.names(), names);
    run(&["--device", "reference"]).succeeds();
    let expected = std::fs::read(&picture).expect("a picture");
    std::fs::remove_file(&picture).expect("a picture");
    let fallen_back = run(&[]).succeeds();
    assert!(std::fs::read(&picture).expect("a picture") == expected);
    std::fs::remove_file(&picture).expect("a picture");
    // One line says so, another what was done.
    assert_eq!(fallen_back.stderr.lines().count(), 2, "{fallen_back:?}");
    let line = fallen_back.stderr.lines().next().unwrap_or_default();
    assert!(line.starts_with("rendering by the CPU reference, "), "{line}");
    for word in words.iter().chain(&[HELP, "--device vulkan"]) {
        assert!(line.contains(word), "'{word}' is not in: {line}");
    }
    for word in words {
        assert!(default.contains(word), "'{word}' is not in: {default}");
    }
    assert_eq!(run(&["--quiet"]).succeeds().stderr, "");
    std::fs::remove_file(&picture).expect("a picture");
}

/// Both names: old loaders know the second alone.
fn drivers(place: &str) -> [(&'static str, &str); 2] {
    [("VK_DRIVER_FILES", place), ("VK_ICD_FILENAMES", place)]
}

fn with_ball() -> Folder {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    folder
}

#[test]
fn without_drivers_the_cpu_renders_and_the_variable_that_hides_them_is_named() {
    let folder = with_ball();
    std::fs::create_dir(folder.path().join("empty")).expect("a folder");
    for place in ["/nonexistent", "empty", "ball.ply/driver.json"] {
        let variable = format!("VK_DRIVER_FILES='{place}'");
        no_device(&folder, &drivers(place), &["no Vulkan device", &variable, "install a driver"]);
    }
}

/// The driver's own fault is named, as the loader tells it.
#[test]
fn with_a_driver_that_cannot_be_opened_the_cpu_renders_and_it_is_named() {
    let folder = with_ball();
    let driver = "{ \"file_format_version\": \"1.0.0\", \"ICD\": { \"library_path\": \
                  \"/nonexistent/libdriver.so\", \"api_version\": \"1.3.0\" } }";
    folder.write("driver.json", driver);
    no_device(&folder, &drivers("driver.json"), &["driver.json", "/nonexistent/libdriver.so"]);
    // Some loaders give up at such a file, others pass over it.
    folder.write("driver.json", "{ \"file_format");
    no_device(&folder, &drivers("driver.json"), &["driver.json"]);
}

/// `ldconfig` is not asked where the folder has such a file, even if it is none.
#[test]
fn with_a_loader_that_cannot_be_opened_the_cpu_renders_and_packages_are_named() {
    let folder = with_ball();
    folder.write("libvulkan.so.1", "no library\n");
    let place = folder.path().to_str().expect("UTF-8").to_owned();
    let words = ["Vulkan loader was not found", "libvulkan1", "libvulkan.so.1"];
    no_device(&folder, &[("LD_LIBRARY_PATH", &place)], &words);
}

/// Either the layer is passed over, or what stands in the way is named: no crash, and nothing silent.
#[test]
fn a_broken_layer_is_passed_over_or_named() {
    let folder = with_ball();
    let layers = "home/.local/share/vulkan/implicit_layer.d";
    std::fs::create_dir_all(folder.path().join(layers)).expect("a folder");
    let home = folder.path().join("home");
    let home = home.to_str().expect("UTF-8");
    let layer = "{ \"file_format_version\": \"1.1.0\", \"layer\": { \"name\": \"VK_LAYER_X_gone\", \
                 \"type\": \"GLOBAL\", \"library_path\": \"/nonexistent/liblayer.so\", \
                 \"api_version\": \"1.3.0\", \"implementation_version\": \"1\", \"description\": \"x\", \
                 \"disable_environment\": { \"NO_X\": \"1\" } } }";
    let set: [&[(&str, &str)]; 3] = [
        &[("VK_INSTANCE_LAYERS", "VK_LAYER_nobody_has")],
        &[("HOME", home)],
        &[("HOME", home), ("VK_INSTANCE_LAYERS", "VK_LAYER_X_gone")],
    ];
    for (text, names) in [(layer, "liblayer.so"), ("no manifest", "gone.json")] {
        folder.write(format!("{layers}/gone.json"), text);
        for set in set {
            let mut command = with(&folder, set);
            let ran = Ran::of(command.env_remove("XDG_DATA_HOME").arg("devices"));
            let ran = ran.succeeds();
            if !ran.stdout.contains("           usable") {
                let is_named = ran.stdout.contains(names) && ran.stdout.contains(HELP);
                assert!(is_named, "{set:?}: {ran:?}");
            }
        }
    }
}

#[test]
fn no_home_and_no_cache_is_no_error() {
    let folder = with_ball();
    let render = |command: &mut Command, name: &str| -> Vec<u8> {
        let ran = Ran::of(command.args(["render", "ball.ply", "--size", "16x16", "-o", name]));
        // What the driver says of its cache is its own.
        assert!(!ran.stderr.contains("error"), "{ran:?}");
        ran.succeeds();
        std::fs::read(folder.path().join(name)).expect("a picture")
    };
    let cached = render(&mut with(&folder, &[]), "cached.png");
    let mut homeless = with(&folder, &[("TMPDIR", "/nonexistent")]);
    for name in ["HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_RUNTIME_DIR"] {
        homeless.env_remove(name);
    }
    assert!(render(&mut homeless, "homeless.png") == cached);
    // Nobody can make a folder there.
    let nowhere =
        ["HOME", "XDG_CACHE_HOME", "MESA_SHADER_CACHE_DIR"].map(|name| (name, "/proc/no"));
    assert!(render(&mut with(&folder, &nowhere), "nowhere.png") == cached);
}

/// Into a cache that both fill, and over each other's file: the last one wins, whole.
#[test]
fn renders_at_once_share_a_cache_and_an_output() {
    let folder = with_ball();
    let cache = Folder::new();
    let place = cache.path().to_str().expect("UTF-8");
    let start = |output: &str| {
        let mut command = with(&folder, &[("MESA_SHADER_CACHE_DIR", place)]);
        command.args(["render", "ball.ply", "--size", "16x16", "--quiet", "-o", output]);
        command.spawn().expect("the binary starts")
    };
    let mut renders: Vec<_> = (0..4).map(|_| start("a.exr")).collect();
    for render in &mut renders {
        assert!(render.wait().expect("it ends").success());
    }
    assert!(start("b.exr").wait().expect("it ends").success());
    assert_eq!(folder.names(), ["a.exr", "b.exr", "ball.ply"]);
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("a picture");
    assert!(read("a.exr") == read("b.exr"));
}
