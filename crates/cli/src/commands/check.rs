//! `check`: everything that `render` checks before it needs a device.

use crate::args::CheckArgs;
use crate::console;
use crate::errors::Failure;
use crate::input::{Input, SceneValues, check_preset};
use crate::progress::Progress;
use serde_json::json;

/// Loads the scene, reads its points and plans its render: what passes here does not fail there
/// for the scene's sake.
pub fn run(args: &CheckArgs) -> Result<(), Failure> {
    check_preset(args.preset.as_deref(), &args.set)?;
    let mut values = SceneValues::set(&args.set).below(args.root.as_deref());
    values.add_preset(args.preset.as_deref());
    let mut input = Input::load(&args.scene, &values, &args.view)?;
    let progress = Progress::new(&args.progress);
    let sets = input.read_points(&progress)?;
    let plan = input.plan(&sets, None, &progress)?;
    for line in plan::nothing_seen(&input.scene, &sets, &plan) {
        progress.warn(&line);
    }
    progress.refuse_warnings(args.strict, ", which render would give too")?;
    let objects = match sets.len() {
        1 => "1 object".to_owned(),
        count => format!("{count} objects"),
    };
    let line = format!("{}: ok, {objects}", input.path.display());
    progress.result_object(&line, json!({ "objects": sets.len() }));
    console::result(&format!("{line}\n"))
}
