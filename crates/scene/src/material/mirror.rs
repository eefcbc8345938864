//! A perfect mirror.

use super::{Described, MaterialKind};
use crate::keys::Absent::Value;
use crate::keys::{SHARE, key};
use std::fmt::Write;

pub(super) const MIRROR: Described = Described {
    name: "mirror",
    noun: "a mirror",
    has_albedo: false,
    has_inside: false,
    keys: &[key("reflectance", SHARE, Value("[1.0, 1.0, 1.0]"), "Mirror: the share reflected.")],
    read: |table| MaterialKind::Mirror { reflectance: table.vector("reflectance") },
    check: |_| Ok(()),
    write: |kind, out| match kind {
        MaterialKind::Mirror { reflectance } => writeln!(out, "reflectance = {reflectance:?}"),
        _ => Ok(()),
    },
};
