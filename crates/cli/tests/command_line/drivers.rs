//! Machines whose Vulkan is missing, broken or old, as the loader finds it: by its variables. What the loader
//! makes of a broken file differs from version to version; what is asserted is the same for all.
#![cfg(target_os = "linux")]

use crate::{Folder, Ran, pointillist, sphere};
use std::path::Path;
use std::process::Command;

const HELP: &str = "--device reference";

/// The binary with nothing of the caller's Vulkan but what `set` says.
fn with(folder: &Folder, set: &[(&str, &str)]) -> Command {
    let mut command = pointillist();
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_INSTANCE_LAYERS", "VK_ADD_LAYER_PATH"] {
        // The driver under test stays, unless it is what is at fault.
        if !name.contains("DRIVER") && !name.contains("ICD") {
            command.env_remove(name);
        }
    }
    command.envs(set.iter().copied()).current_dir(folder.path());
    command
}

/// `devices` and `render` fail with 3, name all of `words`, and the CPU still renders.
#[track_caller]
fn no_device(folder: &Folder, set: &[(&str, &str)], words: &[&str]) {
    let devices = Ran::of(with(folder, set).arg("devices"));
    assert_eq!(devices.code, Some(3), "{devices:?}");
    assert!(devices.stdout.contains(HELP), "{devices:?}");
    let render = ["render", "ball.ply", "-o", "a.png", "--size", "8x8"];
    let names = folder.names();
    for ran in [devices, Ran::of(with(folder, set).args(render))] {
        for word in words.iter().chain(&[HELP]) {
            assert!(ran.stderr.contains(word), "'{word}' is not in: {}", ran.stderr);
        }
        assert_eq!(ran.stderr.lines().count(), 1, "{ran:?}");
        assert_eq!(ran.code, Some(3), "{ran:?}");
    }
    assert_eq!(folder.names(), names);
    Ran::of(with(folder, set).args(render).args(["--device", "reference"])).succeeds();
    std::fs::remove_file(folder.path().join("a.png")).expect("a picture");
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
fn a_loader_without_drivers_is_3_and_names_the_variable_that_hides_them() {
    let folder = with_ball();
    std::fs::create_dir(folder.path().join("empty")).expect("a folder");
    for place in ["/nonexistent", "empty", "ball.ply/driver.json"] {
        let variable = format!("VK_DRIVER_FILES='{place}'");
        no_device(&folder, &drivers(place), &["no Vulkan device", &variable, "install a driver"]);
    }
}

/// The driver's own fault is named, as the loader tells it.
#[test]
fn a_driver_that_cannot_be_opened_is_3_and_named() {
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
fn a_loader_that_cannot_be_opened_is_3_and_names_the_packages() {
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
            match ran.code {
                Some(0) => assert!(ran.stdout.contains("           usable"), "{ran:?}"),
                Some(3) => {
                    assert!(ran.stderr.contains(names) && ran.stderr.contains(HELP), "{ran:?}")
                }
                _ => panic!("{set:?}: {ran:?}"),
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
    assert!(Path::new(place).is_dir());
}
