//! A scene as canonical TOML, for the header of the pictures it makes.

use crate::background::write_background;
use crate::light::write_light;
use crate::object::write_object;
use crate::render_settings::write_render;
use crate::{Filter, Scene};
use std::borrow::Cow;
use std::fmt::{self, Write};

impl Scene {
    /// Canonical TOML of everything that changes a picture, defaults included: all but
    /// `cells_per_pass`, `loop`, `primary` and `secondary`. Loading it as the same file gives the same scene up
    /// to those four, and the same bytes again.
    pub fn settings_toml(&self) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_settings(&mut out);
        out
    }

    fn write_settings(&self, out: &mut String) -> fmt::Result {
        self.camera.write(self.inside.as_deref(), out)?;
        writeln!(out, "[image]")?;
        writeln!(out, "size = {:?}", self.image.size)?;
        writeln!(out, "samples = {}", self.image.samples)?;
        let filter = match self.image.filter {
            Filter::Gaussian => "gaussian",
            Filter::Triangle => "triangle",
            Filter::Box => "box",
        };
        writeln!(out, "filter = \"{filter}\"")?;
        if let Some(width) = self.image.filter_width {
            writeln!(out, "filter_width = {width:?}")?;
        }
        writeln!(out, "transparent = {}\n", self.image.transparent)?;
        write_render(out, &self.render)?;
        write_background(out, &self.background)?;
        for light in &self.lights {
            write_light(out, light)?;
        }
        for object in &self.objects {
            write_object(out, object)?;
        }
        Ok(())
    }
}

/// Keys of `[render]` that programs of earlier days had not, with what they did.
const EARLIER: [(&str, &str); 1] = [("shadows", "\"opaque\"")];

/// The scene of a picture's header, as [`Scene::settings_toml`] has written it, with the keys that the program had not
/// when it wrote it: they say what it did then, so that the picture renders again. Any other text stays as it is.
#[must_use]
pub fn settings_of_header(text: &str) -> Cow<'_, str> {
    const TABLE: &str = "\n[render]\n";
    let Some(at) = text.find(TABLE) else { return Cow::Borrowed(text) };
    let (before, keys) = text.split_at(at + TABLE.len());
    let table = keys.split("\n[").next().unwrap_or(keys);
    let has = |name: &str| table.lines().any(|line| line.starts_with(&format!("{name} = ")));
    let added: String = (EARLIER.iter().filter(|(name, _)| !has(name)))
        .map(|(name, value)| format!("{name} = {value}\n"))
        .collect();
    if added.is_empty() {
        Cow::Borrowed(text)
    } else {
        Cow::Owned(format!("{before}{added}{keys}"))
    }
}

/// A TOML basic string.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
