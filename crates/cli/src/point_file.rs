//! How a point file is shown that no scene speaks of: as a surface or as spheres, and by which colours.
//!
//! What is chosen are values of the scene, like those of `--set`, before which they stand: what a user says wins, and
//! the header of an EXR file has all of them.

mod scalars;

use crate::errors::Failure;
use crate::progress::Progress;
use points::{Dimension, PointSet, ReadOptions, Sign, Wanted, Watch};
use scalars::{first_scalar, part_of};
use scene::{Albedo, Object, Quality, Scene, SurfaceKind, Up};
use serde_json::json;
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// Between the first and the last of these, intensities are shown.
const OF_INTENSITIES: [f64; 3] = [0.02, 0.5, 0.98];
/// What heights are shown between: strays and birds lie beyond.
const OF_HEIGHTS: [f64; 2] = [0.005, 0.995];
/// How often light is dimmed by e across a volume in the values that a note proposes.
const DEPTHS: f64 = 8.0;
/// Over the distance of the nearest nodes, the edge of a cube for each from which on cells are called flat.
const FLAT: f64 = 2.0;

/// What `--color` says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColorBy {
    /// The points' own colours.
    Points,
    /// Their height along the axis that points upwards.
    Height,
    /// Their intensity, in grey.
    Intensity,
    /// An attribute.
    Attribute(String),
}

impl ColorBy {
    /// As typed.
    pub fn parse(text: &str) -> Result<Self, String> {
        Ok(match text.trim() {
            "" => {
                return Err("expected points, height, intensity or the name of an attribute".into());
            }
            "points" => Self::Points,
            "height" => Self::Height,
            "intensity" => Self::Intensity,
            name => Self::Attribute(name.strip_prefix("attribute:").unwrap_or(name).trim().into()),
        })
    }

    fn name(&self) -> &str {
        match self {
            Self::Points => "points",
            Self::Height => "height",
            Self::Intensity => "intensity",
            Self::Attribute(name) => name,
        }
    }
}

/// A point file without a scene.
#[derive(Debug, Clone)]
pub struct PointFile {
    /// `PATH=VALUE`, as typed.
    pub values: Vec<String>,
    /// What scene it means.
    pub quality: Quality,
    /// Whether its points decide which way is up.
    pub up_is_open: bool,
    /// `--color`.
    pub color: Option<ColorBy>,
}

impl PointFile {
    /// How it is read first.
    pub fn options(&self, object: &Object) -> ReadOptions {
        let mut options = plan::read_options(object);
        if !can_be_read_again(&object.points) {
            options.wanted = Wanted::All;
            return options;
        }
        let attribute = match &self.color {
            None if self.has_open_colors(object) => Some("intensity"),
            None | Some(ColorBy::Points | ColorBy::Height) => None,
            Some(by) => Some(by.name()),
        };
        let attributes = attribute.map(str::to_owned).into_iter().collect();
        let wanted = Wanted::Some { colors: false, normals: false, attributes };
        options.wanted = options.wanted.or(&wanted);
        options
    }

    /// The values of the scene that stand before those typed, now that the points are known. `read_all` reads them again
    /// with all attributes, of which the set keeps the one that is shown.
    pub fn choose(
        &self,
        scene: &Scene,
        set: &mut Arc<PointSet>,
        up: Up,
        read_all: impl Fn() -> Result<PointSet, Failure>,
        progress: &Progress,
    ) -> Result<Vec<String>, Failure> {
        let objects: Vec<&Object> =
            scene.objects.iter().filter(|object| !object.is_ground()).collect();
        let [object] = objects[..] else { return Ok(Vec::new()) };
        let file = object.points.display();
        let mut chosen = Vec::new();
        let dimension = self.dimension(object, set, progress);
        let fills = dimension.as_ref().is_some_and(Dimension::is_volume);
        let color = match &self.color {
            Some(by) => Some(asked(by, set, up).map_err(|what| {
                Failure::usage(format!("{file}: --color {}: {what}", by.name()))
            })?),
            None if !self.has_open_colors(object) || set.colors.is_some() => None,
            None if fills => scalar_of(set, read_all)?,
            None => by_intensity(set).filter(|_| is_picture(set)).inspect(|color| {
                let [_, high] = color.range.unwrap_or_default();
                progress.note(&format!(
                    "{file}: the points have no colours and are shown in grey by '{}', white from {high}; \
                     --color height shows how high they lie",
                    color.name
                ));
            }),
        };
        if let Some(Dimension::Volume(sign)) = dimension.filter(|_| !self.says("objects.0.surface"))
        {
            chosen.push("objects.0.surface.kind=\"spheres\"".to_owned());
            let radius = radius_of(&sign, object, set);
            chosen.extend(radius.map(|radius| format!("objects.0.surface.radius={radius:?}")));
            let fill = match sign {
                Sign::Residuals(_) => "fill a volume".to_owned(),
                Sign::Nodes(_) | Sign::Lattice(_) => format!("fill a volume ({sign})"),
            };
            let by = color
                .as_ref()
                .map_or_else(String::new, |color| format!(", coloured by '{}'", color.name));
            let volume = volume_of(object, set, color.as_ref().map(|color| color.name.as_str()));
            progress.note(&format!(
                "{file}: the points {fill}; they are shown as spheres{by}; \
                 --set objects.0.surface.kind=points draws a surface through them{volume}"
            ));
        }
        chosen.extend(color.iter().flat_map(Color::values));
        Ok(chosen)
    }

    /// What the points fill, where that decides how they are shown.
    fn dimension(&self, object: &Object, set: &PointSet, progress: &Progress) -> Option<Dimension> {
        let is_shapes = object.surface.kind != SurfaceKind::Points;
        let is_open = is_shapes || !self.says("objects.0.surface");
        (is_open && object.volume.is_none()).then(|| {
            progress.stage("looking for volumes", set.len() as u64);
            let dimension = Dimension::of(set);
            progress.clear();
            dimension
        })
    }

    /// Whether a value was typed for what is at a path, in it or around it.
    fn says(&self, path: &str) -> bool {
        let is_in = |inner: &str, outer: &str| {
            inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        self.values.iter().any(|value| {
            let typed: String =
                value.split('=').next().unwrap_or_default().split_whitespace().collect();
            is_in(&typed, path) || is_in(path, &typed)
        })
    }

    /// Whether nothing that was typed decides which colours there are.
    fn has_open_colors(&self, object: &Object) -> bool {
        let material = &object.material;
        material.kind.has_albedo()
            && matches!(material.albedo, Albedo::Default)
            && !["albedo", "texture"]
                .iter()
                .any(|key| self.says(&format!("objects.0.material.{key}")))
    }
}

/// Whether a file is one, and no pipe, which is empty after it was read.
pub fn can_be_read_again(file: &Path) -> bool {
    fs::metadata(file).is_ok_and(|file| file.is_file())
}

/// How points are coloured.
struct Color {
    /// Of an attribute, or of a coordinate.
    name: String,
    range: Option<[f64; 2]>,
    is_gray: bool,
    /// Their own.
    is_own: bool,
}

impl Color {
    fn own() -> Self {
        Self { name: "points".to_owned(), range: None, is_gray: false, is_own: true }
    }

    fn of(name: &str) -> Self {
        Self { name: name.to_owned(), range: None, is_gray: false, is_own: false }
    }

    /// As `--set` takes them.
    fn values(&self) -> Vec<String> {
        let of_material = |key: &str, value: String| format!("objects.0.material.{key}={value}");
        if self.is_own {
            return vec![of_material("albedo", json!("points").to_string())];
        }
        let albedo = json!(format!("attribute:{}", self.name)).to_string();
        let mut values = vec![of_material("albedo", albedo)];
        if self.is_gray {
            values.push(of_material("color_map", json!("gray").to_string()));
        }
        let range = self
            .range
            .map(|[low, high]| of_material("value_range", format!("[{low:?}, {high:?}]")));
        values.extend(range);
        values
    }
}

/// The colours that `--color` asks for, or what is missing.
fn asked(by: &ColorBy, set: &PointSet, up: Up) -> Result<Color, String> {
    let known = || {
        let names = set.attributes.iter().map(|attribute| attribute.name.as_str());
        let own = set.colors.iter().map(|_| "points");
        let all: Vec<&str> = ["height", "x", "y", "z"]
            .into_iter()
            .chain(own)
            .chain(names)
            .chain(set.left_out.iter().map(String::as_str))
            .collect();
        all.join(", ")
    };
    match by {
        ColorBy::Points if set.colors.is_some() => Ok(Color::own()),
        ColorBy::Points => Err(format!("the points have no colours; there are {}", known())),
        ColorBy::Height => {
            let (name, axis) = match up {
                Up::Z => ("z", 2),
                Up::Y | Up::MinusY => ("y", 1),
            };
            let heights = part_of(set.positions.iter().map(|p| p[axis]), set.len(), OF_HEIGHTS);
            let range =
                heights.map(|[low, high]| if up == Up::MinusY { [high, low] } else { [low, high] });
            Ok(Color { range, ..Color::of(name) })
        }
        ColorBy::Intensity => match (set.attribute_meant("intensity"), by_intensity(set)) {
            (_, Some(color)) => Ok(color),
            (None, None) => Err(format!("the points have no intensity; there are {}", known())),
            (Some(_), None) => Err(format!("all intensities are the same; there are {}", known())),
        },
        ColorBy::Attribute(name) => {
            let is_axis = ["x", "y", "z"].contains(&name.as_str());
            match is_axis || set.attribute_meant(name).is_some() {
                true => Ok(Color::of(name)),
                false => Err(format!("the points have no such attribute; there are {}", known())),
            }
        }
    }
}

/// Intensities in grey, where the points have several: the least in a dark grey rather than in black, on which no shape is
/// seen.
fn by_intensity(set: &PointSet) -> Option<Color> {
    let values = set.attribute_meant("intensity")?;
    let [low, _, high] = part_of(values.iter(), values.len(), OF_INTENSITIES)?;
    let range = Some([low - 0.5 * (high - low), high]).filter(|_| low < high)?;
    Some(Color { range: Some(range), is_gray: true, ..Color::of("intensity") })
}

/// Whether intensities are a picture: where half of them are the same, as in models with the trust in each point under
/// this name, they are specks.
fn is_picture(set: &PointSet) -> bool {
    let values = set.attribute_meant("intensity");
    let parts = values.and_then(|values| part_of(values.iter(), values.len(), OF_INTENSITIES));
    parts.is_some_and(|[low, middle, high]| low < middle && middle < high)
}

/// The first scalar of points that are read again for it.
fn scalar_of(
    set: &mut Arc<PointSet>,
    read_all: impl Fn() -> Result<PointSet, Failure>,
) -> Result<Option<Color>, Failure> {
    if set.left_out.is_empty() {
        return Ok(first_scalar(set).map(|place| Color::of(&set.attributes[place].name)));
    }
    let mut all = read_all()?;
    let Some(place) = first_scalar(&all) else { return Ok(None) };
    let name = all.attributes[place].name.clone();
    all.attributes = vec![all.attributes.swap_remove(place)];
    all.normals = None;
    *set = Arc::new(all);
    Ok(Some(Color::of(&name)))
}

/// The box that holds all but a few points.
fn sides_of(set: &PointSet) -> [f64; 3] {
    [0, 1, 2].map(|axis| {
        let part = part_of(set.positions.iter().map(|p| p[axis]), set.len(), OF_HEIGHTS);
        part.map_or(0.0, |[low, high]| high - low)
    })
}

/// The radius of spheres at the nodes of a grid, in scene units, where cells are so flat that spheres as wide as these
/// would not be seen: half the edge of a cube of which the box around them holds one a node.
fn radius_of(sign: &Sign, object: &Object, set: &PointSet) -> Option<f64> {
    if matches!(sign, Sign::Residuals(_)) {
        return None;
    }
    let spacing = points::neighbors::median_spacing(&set.positions)?;
    let edge = (sides_of(set).iter().product::<f64>() / set.len() as f64).cbrt();
    let radius: f64 = format!("{:.2e}", 0.5 * edge * object.transform.scale).parse().ok()?;
    (edge > FLAT * spacing && (1e-12..=1e15).contains(&radius)).then_some(radius)
}

/// What shows a volume in place of spheres, as words that follow.
fn volume_of(object: &Object, set: &PointSet, scalar: Option<&str>) -> String {
    let Some(scalar) = scalar else { return String::new() };
    let size = sides_of(set).into_iter().fold(0.0, f64::max) * object.transform.scale;
    let extinction = if size > 0.0 { format!("{:.1e}", DEPTHS / size) } else { "1".to_owned() };
    let number: f64 = extinction.parse().unwrap_or(1.0);
    let scalar = json!(scalar);
    format!(
        ", --set 'objects.0.volume={{ scalar = {scalar}, color_map = \"viridis\", extinction = [0.0, {number:?}] }}' \
         a volume"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[&str]) -> PointFile {
        let values = values.iter().map(|value| (*value).to_owned()).collect();
        PointFile { values, quality: Quality::Draft, up_is_open: true, color: None }
    }

    #[test]
    fn what_was_typed_is_found_in_and_around_a_path() {
        for (value, path, says) in [
            ("objects.0.surface.trust=0.7", "objects.0.surface", true),
            ("objects.0.surface={ trust = 0.7 }", "objects.0.surface", true),
            (" objects . 0.surface.kind = \"points\"", "objects.0.surface", true),
            ("objects=[]", "objects.0.surface", true),
            ("objects.0.material.color_map=gray", "objects.0.material.albedo", false),
            ("objects.0.surfaces=1", "objects.0.surface", false),
            ("image.size=[4, 4]", "objects.0.surface", false),
        ] {
            assert_eq!(of(&[value]).says(path), says, "{value} of {path}");
        }
    }

    #[test]
    fn colors_are_asked_for_by_name() {
        assert_eq!(ColorBy::parse("height"), Ok(ColorBy::Height));
        assert_eq!(ColorBy::parse("attribute:height"), Ok(ColorBy::Attribute("height".into())));
        assert_eq!(ColorBy::parse("rho"), Ok(ColorBy::Attribute("rho".into())));
        assert!(ColorBy::parse(" ").is_err());
    }
}
