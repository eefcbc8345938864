//! What a key of a scene file has: type, range, unit, default, meaning.
//!
//! Each table of keys stands in the file of what it describes (`camera_keys.rs`, `light.rs`, `material.rs` ...), the one
//! place where its keys are stated. The checker, the defaults of the public types, the JSON Schema and the tables of
//! docs/scene.md all come from [`SCENE`]. What is known here but not built is listed in `not_built.rs`.

use crate::background::BACKGROUND;
use crate::camera_keys::CAMERA;
use crate::image::IMAGE;
use crate::light::LIGHTS;
use crate::object::OBJECTS;
use crate::read::Reader;
use crate::render_settings::RENDER;

/// A key's name and what is wrong with its value.
pub(crate) type Fault = (&'static str, String);

/// A check that needs several keys of a table.
pub(crate) type WholeCheck = fn(&Reader<'_>) -> Result<(), Fault>;

/// A table of the file.
pub(crate) struct Table {
    /// As a file writes it: `[camera]`, `[[lights]]`.
    pub(crate) header: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) keys: &'static [Key],
    /// What no key can say alone. Runs when each key is right by itself; names the key at fault.
    pub(crate) whole: Option<WholeCheck>,
}

impl Table {
    pub(crate) fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }
}

/// A key of a table.
#[derive(Clone, Copy)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) absent: Absent,
    pub(crate) doc: &'static str,
    /// The value of `kind` beside it that the key belongs to, if only to one.
    pub(crate) only: Option<&'static str>,
}

/// What a key that is left out means. Values are TOML.
#[derive(Clone, Copy)]
pub(crate) enum Absent {
    /// It may not be left out; an example of a value.
    Required(&'static str),
    /// This value.
    Value(&'static str),
    /// What these words say; an example of a value.
    Words(&'static str, &'static str),
    /// The defaults of the table's own keys, or an empty list.
    Table,
}

/// What a value has to be.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Bool,
    Integer {
        min: i64,
        max: i64,
        unit: &'static str,
    },
    Number(Numbers),
    /// Three numbers.
    Vector(Numbers),
    /// Two times three numbers.
    Vectors(Numbers),
    /// Three numbers that are not all zero.
    Direction,
    /// Width and height.
    Size {
        max: i64,
    },
    /// Two numbers, the first under the second.
    Range(Numbers),
    Choice(&'static [&'static str]),
    /// This word and what it goes before, which is what the second says.
    Prefixed(&'static str, &'static str),
    Text(&'static str),
    /// One of several, told apart by TOML type.
    Either(&'static [Kind]),
    Table(&'static Table),
    /// Two numbers.
    Pair(Numbers),
    Tables {
        table: &'static Table,
        min: usize,
        max: usize,
        /// The path of a file that has them under the same key will do.
        in_file: bool,
    },
    /// One value or more that are no tables.
    List {
        of: &'static Kind,
        max: usize,
    },
    /// A table of any names, each with two numbers, the second no less than the first.
    Ranges(Numbers),
    /// A table of any names, each with a column's name or number; `_` with a list of numbers.
    Columns,
    /// One name, or a list of names, which may be empty; what has them.
    Names(&'static str),
}

/// A closed range and its unit, which may be empty.
#[derive(Clone, Copy)]
pub(crate) struct Numbers {
    pub(crate) min: f64,
    pub(crate) max: f64,
    pub(crate) unit: &'static str,
}

/// Largest magnitude of a coordinate or radiometric value: its square is still far inside f32.
pub(crate) const LARGE: f64 = 1e15;

/// Shortest length that counts as one.
pub(crate) const SHORT: f64 = 1e-12;

pub(crate) const fn numbers(min: f64, max: f64, unit: &'static str) -> Numbers {
    Numbers { min, max, unit }
}

/// The vertical angle of a camera whose eye and target are given, in degrees.
pub(crate) const DEFAULT_FOV: f64 = 35.0;

/// The key of `[objects.columns]` that lists columns which are passed over.
pub(crate) const LEFT_OUT: &str = "_";

/// Greatest number of a column.
pub(crate) const MOST_COLUMNS: u32 = 1_000_000;

pub(crate) const POSITION: Kind = Kind::Vector(numbers(-LARGE, LARGE, "scene units"));

pub(crate) const RADIANCE: Kind = Kind::Vector(numbers(0.0, LARGE, "W sr⁻¹ m⁻², linear RGB"));

pub(crate) const SHARE: Kind = Kind::Vector(numbers(0.0, 1.0, "in linear RGB"));

pub(crate) const LENGTH: Kind = Kind::Number(numbers(SHORT, LARGE, "scene units"));

pub(crate) const fn key(name: &'static str, kind: Kind, absent: Absent, doc: &'static str) -> Key {
    Key { name, kind, absent, doc, only: None }
}

pub(crate) const fn key_of(
    only: &'static str,
    name: &'static str,
    kind: Kind,
    absent: Absent,
    doc: &'static str,
) -> Key {
    Key { name, kind, absent, doc, only: Some(only) }
}

pub(crate) const fn count(min: i64, max: i64, unit: &'static str) -> Kind {
    Kind::Integer { min, max, unit }
}
use Absent::{Required, Value, Words};

/// The whole file.
pub(crate) static SCENE: Table = Table {
    header: "the scene",
    doc: "",
    whole: None,
    keys: &[
        key("camera", Kind::Table(&CAMERA), Absent::Table, CAMERA.doc),
        key("image", Kind::Table(&IMAGE), Absent::Table, IMAGE.doc),
        key("render", Kind::Table(&RENDER), Absent::Table, RENDER.doc),
        key("background", Kind::Table(&BACKGROUND), Absent::Table, BACKGROUND.doc),
        key(
            "lights",
            Kind::Tables { table: &LIGHTS, min: 0, max: 1024, in_file: false },
            Absent::Table,
            LIGHTS.doc,
        ),
        key(
            "objects",
            Kind::Tables { table: &OBJECTS, min: 1, max: 65_536, in_file: false },
            Required("[{ points = \"points/knot.ply\" }]"),
            OBJECTS.doc,
        ),
    ],
};

impl Kind {
    /// What a value has to be, in words.
    pub(crate) fn expected(&self) -> String {
        match self {
            Kind::Bool => "true or false".into(),
            Kind::Integer { min, max, unit } => {
                format!("an integer from {min} to {max}{}", spaced(unit))
            }
            Kind::Number(n) => format!("a number {n}"),
            Kind::Vector(n) => format!("three numbers {n}"),
            Kind::Vectors(n) => format!("two lists of three numbers {n}"),
            Kind::Direction => {
                format!(
                    "a direction of three numbers from {} to {}, not all zero",
                    plain(-LARGE),
                    plain(LARGE)
                )
            }
            Kind::Size { max } => format!("width and height, two integers from 1 to {max} pixels"),
            Kind::Range(n) => format!("two numbers {n}, the second greater"),
            Kind::Choice(names) => choice(names),
            Kind::Prefixed(before, what) => format!("\"{before}\" and {what}"),
            Kind::Text(what) => format!("{what}, a string"),
            Kind::Either(kinds) => {
                kinds.iter().map(Kind::expected).collect::<Vec<_>>().join(", or ")
            }
            Kind::Table(_) => "a table".into(),
            Kind::Pair(n) => format!("two numbers {n}"),
            Kind::Tables { min, max, in_file: true, .. } => {
                format!("a list of {min} to {max} tables, or the path of a file that has it")
            }
            Kind::Tables { min: 0, max, .. } => format!("a list of up to {max} tables"),
            Kind::Tables { min, max, .. } => format!("a list of {min} to {max} tables"),
            Kind::List { of, max } => format!("a list of 1 to {max}, each {}", of.expected()),
            Kind::Ranges(n) => {
                format!("a table of names, each with two numbers {n}, the second no less")
            }
            Kind::Columns => {
                "a table of names, each with a column's name or its number from 1".into()
            }
            Kind::Names(of) => format!("the name of {of}, or a list of such names"),
        }
    }
}

/// The component range of a direction.
pub(crate) const DIRECTION: Numbers = numbers(-LARGE, LARGE, "");

impl std::fmt::Display for Numbers {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "from {} to {}{}", plain(self.min), plain(self.max), spaced(self.unit))
    }
}

impl Key {
    /// A value to imitate, as TOML.
    pub(crate) fn example(&self) -> &'static str {
        match self.absent {
            Required(example) | Value(example) | Words(_, example) => example,
            Absent::Table => "{}",
        }
    }
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// `"a"`, `"a" or "b"`, or `"a", "b" or "c"`.
fn choice(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

/// A number as a person would write it.
pub(crate) fn plain(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e6).contains(&x.abs()) { format!("{x:e}") } else { format!("{x}") }
}
