//! The scene that a point file rendered directly means.

use crate::document::{Entry, Node, Origin, Value, parse_value};
use crate::error::Source;
use crate::load::{checked, files_exist, models_folder};
use crate::models;
use crate::{Scene, SceneError, Up};
use std::path::Path;

/// How much a picture may cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quality {
    /// One ray a pixel. Of a point file: direct light of a key light and of one in the eye.
    Draft,
    /// Several samples a pixel. Of a point file: the light of the background and of a soft key light.
    #[default]
    Good,
    /// Many samples a pixel. Of a point file: also light from surface to surface.
    Best,
}

impl Quality {
    /// `image.samples` of a scene file that is rendered in this quality.
    #[must_use]
    pub fn samples(self) -> u32 {
        match self {
            Self::Draft => 1,
            Self::Good => 16,
            Self::Best => 256,
        }
    }
}

impl Scene {
    /// The scene that a point file rendered directly means: one object with defaults, no camera
    /// (the renderer frames it), a key light, and what else `quality` gives. `overrides`
    /// apply as in [`Scene::load`], with paths relative to the working directory.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn for_point_file(
        points: &Path,
        up: Up,
        quality: Quality,
        overrides: &[String],
    ) -> Result<Scene, SceneError> {
        around(points, Lights { key: light_over(up), fill: 0.5 }, quality, overrides)
    }

    /// The same for a camera in the place of a sensor, whose right, up and ahead are these unit vectors. The key
    /// light comes from a little above and beside it, so that few of its shadows are seen. In a room, light from high
    /// above would end at the ceiling; and so does that of a background, for which the light in the eye stands in.
    ///
    /// # Errors
    /// As [`Scene::for_point_file`].
    pub fn for_sensor(
        points: &Path,
        [right, up, ahead]: [[f64; 3]; 3],
        quality: Quality,
        overrides: &[String],
    ) -> Result<Scene, SceneError> {
        let key = [0, 1, 2].map(|i| -0.2 * right[i] - 0.25 * up[i] + ahead[i]);
        around(points, Lights { key, fill: 1.5 }, quality, overrides)
    }
}

/// The lights of a point file.
#[derive(Clone, Copy)]
struct Lights {
    /// Direction of the key light.
    key: [f64; 3],
    /// Irradiance at the target of the light in the eye, beside a background that lights.
    fill: f64,
}

fn around(
    points: &Path,
    lights: Lights,
    quality: Quality,
    overrides: &[String],
) -> Result<Scene, SceneError> {
    let source = Source { file: points, text: "", overrides };
    let mut typed = document(points, lights, quality);
    for (index, text) in overrides.iter().enumerate() {
        // What is wrong is reported by the checks.
        let _ = crate::overrides::apply(&mut typed, index, text);
    }
    let quality = if takes_direct_light(&typed) { Quality::Draft } else { quality };
    let mut document = document(points, lights, quality);
    give_way(&mut document, &typed);
    let (mut scene, missing) = checked(&mut document, Path::new(""), None, &source)?;
    models::find(&mut scene, models_folder().as_deref());
    let key_light = document.get("lights").and_then(|list| list.items().first());
    let direction = key_light.and_then(|light| light.get("direction"));
    scene.key_light = direction.filter(|node| node.origin == Origin::Given).map(|_| 0);
    let written = document.get("objects").and_then(|list| list.items().first()?.get("points"));
    // The document holds text; the path itself may hold bytes that are not UTF-8.
    if let (Some(Origin::Given), [object, ..]) =
        (written.map(|node| node.origin), scene.objects.as_mut_slice())
    {
        object.points = points.to_path_buf();
    }
    files_exist(&document, &scene, &source, (None, false), missing)?;
    Ok(scene)
}

/// Whether light is asked for that comes from lights only, with which the lights of other qualities would leave
/// shadows black: by `render.integrator`, or by a preset, which is older than other integrators.
fn takes_direct_light(typed: &Node) -> bool {
    let of_render = |key: &str| typed.get("render").and_then(|render| render.get(key));
    let is_direct = |node: &Node| matches!(&node.value, Value::Text(name) if name == "direct");
    let integrator = of_render("integrator");
    let is_typed = integrator.is_some_and(|node| node.origin != Origin::Given);
    (!is_typed && of_render("preset").is_some()) || integrator.is_some_and(is_direct)
}

/// Takes the background out where another is typed.
fn give_way(document: &mut Node, typed: &Node) {
    let Some(Node { value: Value::Table(entries), .. }) = typed.get("background") else { return };
    let is_another = |entry: &Entry| {
        entry.origin != Origin::Given && KINDS_OF_BACKGROUND.contains(&entry.name.as_str())
    };
    let is_typed = entries.iter().any(is_another);
    if let (true, Some(background)) = (is_typed, document.get_mut("background")) {
        *background = Node::empty_table(Origin::Given);
    }
}

/// Of which a background has one.
const KINDS_OF_BACKGROUND: [&str; 4] = ["color", "environment", "sky", "gradient"];

/// Direction of the key light over points whose up is this.
fn light_over(up: Up) -> [f64; 3] {
    // Turned from y up by a quarter turn about x, (x, y, z) to (x, -z, y), or by half a turn, to
    // (x, -y, -z).
    match up {
        Up::Y => [-0.5, -1.0, -0.6],
        Up::Z => [-0.5, 0.6, -1.0],
        Up::MinusY => [-0.5, 1.0, 0.6],
    }
}

/// As TOML, so that overrides and checks work on it as on any scene.
fn document(points: &Path, lights: Lights, quality: Quality) -> Node {
    let key = lights.key;
    let around = match quality {
        // The dimmer light is in the eye, where no shadow of its own is seen, so that none is black.
        Quality::Draft => format!(
            "background = {{ color = [0.18, 0.18, 0.18] }}, lights = [\
             {{ kind = \"directional\", direction = {key:?}, irradiance = [2.5, 2.5, 2.5] }},\
             {{ kind = \"headlight\", at_target = [0.6, 0.6, 0.6] }}]"
        ),
        Quality::Good => in_a_studio(lights, "sky", GOOD_SAMPLES),
        Quality::Best => in_a_studio(lights, "path", Quality::Best.samples()),
    };
    let text = format!(
        "{{ {around}, objects = [{{ points = {} }}] }}",
        crate::settings::quoted(&points.to_string_lossy())
    );
    parse_value(&text, Origin::Given).unwrap_or_else(|| unreachable!("not TOML: {text}"))
}

/// Rays a pixel of a point file in good quality: as many as cost at most three times what direct light with one does.
const GOOD_SAMPLES: u32 = 4;

/// A soft key light, the light of a background that is lighter above, and a dim light in the eye, without which the inside of
/// what is open would be black. Most of the light is the key light's: exposed so that the subject is mid-grey, the background is
/// darker than a white subject and lighter than a dark one, and seldom white.
fn in_a_studio(Lights { key, fill }: Lights, integrator: &str, samples: u32) -> String {
    format!(
        "image = {{ samples = {samples} }}, render = {{ integrator = \"{integrator}\" }}, \
         background = {{ gradient = [[0.22, 0.24, 0.27], [0.62, 0.70, 0.80]] }}, lights = [\
         {{ kind = \"directional\", direction = {key:?}, irradiance = [4.5, 4.5, 4.5], angle = 20.0 }},\
         {{ kind = \"headlight\", at_target = [{fill:?}, {fill:?}, {fill:?}] }}]"
    )
}
