//! Scene files, checked.
