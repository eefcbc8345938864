//! Errors that name what was meant, where something else was typed.

use crate::{Folder, Ran, run_in, sphere};

fn render(folder: &Folder, arguments: &[&str]) -> Ran {
    run_in(folder.path(), &[&["render", "ball.ply", "-o", "out.png"], arguments].concat())
}

#[test]
fn options_say_what_they_take_and_what_else_was_meant() {
    let folder = Folder::new();
    folder.write("ball.ply", &sphere(100));
    for (arguments, words) in [
        (&["--samples", "1.5"][..], &["--samples", "whole number", "at least 1"][..]),
        (&["--samples", "0"], &["--samples", "at least 1"]),
        (&["--samples", "-4"], &["--samples", "at least 1"]),
        (&["--set", "image.samples=1.5"], &["image.samples", "1.5", "integer", "from 1"]),
        (&["--set", "image.samples=0"], &["image.samples", "from 1"]),
        (&["--crop", "-1,0,5,5"], &["--crop", "inside the picture", "0,0"]),
        (&["--crop=-1,0,5,5"], &["--crop", "inside the picture"]),
        (&["--crop", "500000.5,4000000,510000,4010000"], &["pixels", "objects.0.filter.box"]),
        (&["--crop", "0,0,0,10,10,5"], &["pixels", "objects.0.filter.box"]),
        (&["--crop", "-3.5,-2,1.5,2"], &["pixels", "objects.0.filter.box"]),
        (&["--crop", "600,400,100,100"], &["640x480"]),
        (&["--size", "640,480"], &["--size", "write 640x480"]),
        (&["--size", "640"], &["--size", "height"]),
    ] {
        render(&folder, arguments).fails_with(2, words);
    }
    assert_eq!(folder.names(), ["ball.ply"]);
}
