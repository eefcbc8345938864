//! The `pointillist` binary.
fn main() {}
