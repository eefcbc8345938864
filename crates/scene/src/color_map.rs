//! Colours for values.

use crate::document::Value;
use crate::keys::{Fault, plain};
use crate::read::Reader;

/// Colours for values, from low to high.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorMap {
    /// Of matplotlib: dark blue, green, yellow.
    Viridis,
    /// Of Google: a rainbow of even brightness.
    Turbo,
    /// Of matplotlib: black, purple, cream.
    Magma,
    /// Of matplotlib: black, red, pale yellow.
    Inferno,
    /// Of matplotlib: blue, red, yellow.
    Plasma,
    /// Blue, grey, yellow; the same to colour-blind eyes.
    Cividis,
    /// Black to white in even steps of sRGB.
    Gray,
}

impl ColorMap {
    /// All, in the order of their names.
    pub const ALL: [Self; 7] = [
        Self::Viridis,
        Self::Turbo,
        Self::Magma,
        Self::Inferno,
        Self::Plasma,
        Self::Cividis,
        Self::Gray,
    ];
    /// Their names in scene files.
    pub const NAMES: [&str; 7] =
        ["viridis", "turbo", "magma", "inferno", "plasma", "cividis", "gray"];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// How values lie between the ends of a colour map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// Their logarithms do. Values that are not positive have the colour of the lower end.
    Log,
}

impl Scale {
    /// Their names in scene files.
    pub const NAMES: [&str; 2] = ["linear", "log"];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

impl ColorMap {
    pub(crate) fn read(name: &str) -> Self {
        Self::ALL.into_iter().find(|map| map.name() == name).unwrap_or(Self::Viridis)
    }
}

impl Scale {
    pub(crate) fn read(name: &str) -> Self {
        if name == Self::Log.name() { Self::Log } else { Self::Linear }
    }
}

/// A logarithmic scale has positive ends.
pub(crate) fn range_fits_scale(table: &Reader<'_>) -> Result<(), Fault> {
    let is_auto =
        matches!(table.written("value_range").map(|node| &node.value), Some(Value::Text(_)));
    if table.text("scale") != "log" || is_auto {
        return Ok(());
    }
    let range = table.written_range("value_range");
    match range.and_then(|range| range.into_iter().find(|end| *end <= 0.0)) {
        Some(end) => Err((
            "value_range",
            format!(
                "found {} beside scale = \"log\", expected numbers over 0; raise it, or leave scale out",
                plain(end)
            ),
        )),
        None => Ok(()),
    }
}
