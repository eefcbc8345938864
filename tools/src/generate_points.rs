//! Generates the point sets of the scenes.
fn main() {}
