//! `--legend`: what the colours of a picture mean, as a picture of its own.

use crate::errors::Failure;
use crate::interrupt;
use film::{Canvas, ColorBar, FileFormat};
use plan::{ColorScale, Plan};
use std::path::Path;

/// Fails where the file is not to be a PNG.
pub fn check(path: &Path) -> Result<(), Failure> {
    match FileFormat::from_path(path) {
        Ok(FileFormat::Png) => Ok(()),
        _ => Err(Failure::usage(format!(
            "--legend {}: expected a name that ends in .png; rename it",
            path.display()
        ))),
    }
}

/// The legend of a plan. An error where no object has a map of colours.
pub fn of(plan: &Plan) -> Result<Canvas, Failure> {
    if plan.color_scales.is_empty() {
        return Err(Failure::usage(
            "--legend: no object of the scene is coloured by a map or a transfer function; give one material.albedo = \
             \"attribute:NAME\", or a point file --color NAME, or leave --legend out",
        ));
    }
    let several = plan.color_scales.len() > 1;
    let bar = |scale: &ColorScale| ColorBar {
        title: scale.attribute.clone(),
        subtitle: several.then(|| plan.names[scale.object].clone()),
        colors: scale.colors.clone(),
        range: scale.range,
        is_log: scale.is_log,
    };
    let bars: Vec<ColorBar> = plan.color_scales.iter().map(bar).collect();
    Ok(film::legend(&bars)?)
}

/// Writes it, whole or not at all.
pub fn write(legend: &Canvas, path: &Path) -> Result<(), Failure> {
    interrupt::writing(|| Ok(legend.write(path)?))
}
