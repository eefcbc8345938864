//! `[objects.material]`: how a surface scatters light.
//!
//! Each kind of material has a file below `material/`, with its keys and how they are read, checked and written. Here
//! they are listed: a new one adds its file, its variant of [`MaterialKind`], its row of [`KINDS`] and its arm of
//! [`MaterialKind::described`].

mod albedo;
mod diffuse;
mod glass;
mod mirror;

pub use albedo::{Albedo, TextureAxis};

use crate::keys::Absent::Value;
use crate::keys::{Fault, Key, Kind, Table, key};
use crate::read::Reader;
use diffuse::DIFFUSE;
use glass::GLASS;
use mirror::MIRROR;
use std::fmt::{self, Write};
use std::path::Path;

/// How a surface scatters light.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// What becomes of a ray.
    pub kind: MaterialKind,
    /// The share of light that a diffuse surface scatters back.
    pub albedo: Albedo,
}

/// What becomes of a ray at a surface (docs/method.md, section 4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaterialKind {
    /// Lambert's law on both sides.
    Diffuse,
    /// A perfect mirror.
    Mirror {
        /// The share reflected, linear RGB, each 0 to 1.
        reflectance: [f64; 3],
    },
    /// Smooth glass.
    Glass {
        /// Refractive index of red, green and blue, each 0.1 to 10.
        ior: [f64; 3],
        /// The highest counts where media overlap, -1000000 to 1000000; ties go to the last object.
        priority: i32,
        /// σ in exp(−σℓ) over the length ℓ inside, per scene unit, each 0 to 1e15.
        absorption: [f64; 3],
    },
}

/// The kinds, in the order of their keys.
const KINDS: [Described; 3] = [DIFFUSE, MIRROR, GLASS];

/// What the file of a kind of material says.
struct Described {
    /// Its word in scene files.
    name: &'static str,
    /// For sentences.
    noun: &'static str,
    /// Whether it shows an albedo, and with it colours and attributes of points, and textures.
    has_albedo: bool,
    /// Whether its surface encloses a medium.
    has_inside: bool,
    /// Its own keys. A key that several kinds have is stated by the first of them.
    keys: &'static [Key],
    read: fn(&Reader<'_>) -> MaterialKind,
    /// What its keys say together. Asked of every material, since keys of other kinds may stand in it.
    check: fn(&Reader<'_>) -> Result<(), Fault>,
    /// The keys of a material of this kind, as canonical TOML.
    write: fn(&MaterialKind, &mut String) -> fmt::Result,
}

impl MaterialKind {
    fn described(&self) -> &'static Described {
        match self {
            Self::Diffuse => &DIFFUSE,
            Self::Mirror { .. } => &MIRROR,
            Self::Glass { .. } => &GLASS,
        }
    }

    /// Whether it shows an albedo, and with it colours and attributes of points, and textures.
    #[must_use]
    pub fn has_albedo(&self) -> bool {
        self.described().has_albedo
    }

    /// Whether its surface encloses a medium, so that a ray is inside or outside.
    #[must_use]
    pub fn has_inside(&self) -> bool {
        self.described().has_inside
    }

    /// For sentences: "a mirror".
    #[must_use]
    pub fn noun(&self) -> &'static str {
        self.described().noun
    }
}

const NAMES: [&str; KINDS.len()] = {
    let mut names = [""; KINDS.len()];
    let mut at = 0;
    while at < KINDS.len() {
        names[at] = KINDS[at].name;
        at += 1;
    }
    names
};

const KIND: Key = key(
    "kind",
    Kind::Choice(&NAMES),
    Value("\"diffuse\""),
    "Lambert on both sides, perfect mirror, or smooth glass.",
);

const KEY_COUNT: usize = {
    let (mut count, mut at) = (1, 0);
    while at < KINDS.len() {
        count += KINDS[at].keys.len();
        at += 1;
    }
    count
};

/// `kind`, then the keys of each kind.
const KEYS: [Key; KEY_COUNT] = {
    let (mut keys, mut to, mut at) = ([KIND; KEY_COUNT], 1, 0);
    while at < KINDS.len() {
        let own = KINDS[at].keys;
        let mut from = 0;
        while from < own.len() {
            keys[to] = own[from];
            (from, to) = (from + 1, to + 1);
        }
        at += 1;
    }
    keys
};

pub(crate) static MATERIAL: Table = Table {
    header: "[objects.material]",
    doc: "How the surface scatters light. Keys of another kind than the material's have no effect.",
    whole: Some(|material| KINDS.iter().try_for_each(|kind| (kind.check)(material))),
    keys: &KEYS,
};

impl Material {
    pub(crate) fn read(table: &Reader<'_>, folder: &Path) -> Self {
        let name = table.text("kind");
        let kind = KINDS.iter().find(|kind| kind.name == name);
        let kind = kind.unwrap_or_else(|| unreachable!("'{name}' passed the checks of `kind`"));
        Self { kind: (kind.read)(table), albedo: Albedo::read(table, folder) }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::read(&Reader::defaults(&MATERIAL), Path::new(""))
    }
}

pub(crate) fn write_material(out: &mut String, material: &Material) -> fmt::Result {
    let described = material.kind.described();
    writeln!(out, "\n[objects.material]")?;
    writeln!(out, "kind = \"{}\"", described.name)?;
    (described.write)(&material.kind, out)?;
    albedo::write(out, &material.albedo)
}
