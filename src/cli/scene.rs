//! The scene that a command is about.

use super::arguments::SceneArguments;
use super::exit::{Exit, Failure};
use super::memory::{self, Bytes};
use crate::basis::{Bundles, Resolution};
use crate::gallery;
use crate::scene::Scene;
use std::path::Path;

/// A preset for files, which have none: about this many patches.
const PRESET_PATCHES: f64 = 1500.0;

/// A scene and how finely to cut it.
pub struct Chosen {
    pub scene: Scene,
    pub resolution: Resolution,
    pub n_bundles: usize,
    /// True if the patch size is a preset and not the user's.
    pub is_preset: bool,
}

/// Finds the scene by gallery name or path, chooses the resolution, and checks that its matrices fit into memory.
pub fn choose(arguments: &SceneArguments, bytes_needed: impl Fn(usize) -> u64) -> Result<Chosen, Failure> {
    let (scene, preset) = find(arguments)?;
    let resolution = Resolution { patch_size: arguments.patch_size.unwrap_or(preset), n_directions: 1 };
    let n_bundles = Bundles::count(&scene, resolution)?;
    memory::check(Bytes(bytes_needed(n_bundles)), arguments.memory, n_bundles, resolution.patch_size)?;
    Ok(Chosen { scene, resolution, n_bundles, is_preset: arguments.patch_size.is_none() })
}

fn find(arguments: &SceneArguments) -> Result<(Scene, f64), Failure> {
    let name = &arguments.scene;
    if let Some(entry) = gallery::find(name) {
        if let Some((parameter, _)) = arguments.definitions.first() {
            return Err(Failure::new(
                Exit::Input,
                format!("-D {parameter}: gallery scenes have no parameters, only scene files do"),
            ));
        }
        return Ok(((entry.build)(), entry.patch_size));
    }
    let path = Path::new(name);
    if path.extension().is_none() && !path.exists() {
        let suggestion = gallery::closest(name).map(|entry| format!("\n  = did you mean '{}'?", entry.name));
        return Err(Failure::new(
            Exit::Input,
            format!(
                "there is no gallery scene '{name}', and no file of that name{}\n  = `etendue gallery` lists the scenes",
                suggestion.unwrap_or_default()
            ),
        ));
    }
    let scene = crate::scene::format::read(path, &arguments.definitions)
        .map_err(|error| Failure::new(Exit::Input, error.to_string()))?;
    let area: f64 = scene.surfaces().iter().map(|surface| surface.area()).sum();
    Ok((scene, (area / PRESET_PATCHES).sqrt()))
}
