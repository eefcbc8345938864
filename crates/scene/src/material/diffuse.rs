//! Lambert's law.

use super::{Described, MaterialKind, albedo};

pub(super) const DIFFUSE: Described = Described {
    name: "diffuse",
    noun: "a diffuse surface",
    has_albedo: true,
    has_inside: false,
    keys: albedo::KEYS,
    read: |_| MaterialKind::Diffuse,
    check: albedo::albedo_is_one,
    write: |_, _| Ok(()),
};
