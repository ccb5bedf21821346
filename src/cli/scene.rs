//! The scene that a command is about.

use super::arguments::{Arguments, SceneArguments};
use super::exit::{Exit, Failure};
use super::memory::{self, Demand};
use super::output;
use super::progress::Bars;
use crate::assembly::{Exchange, System, assemble_watched};
use crate::basis::{Bundles, Resolution};
use crate::gallery;
use crate::scene::Scene;
use crate::study::{Watch, tessellations};
use std::path::Path;

/// A preset for files, which have none: about this many patches.
const PRESET_PATCHES: f64 = 1500.0;

/// A scene and how finely to cut it.
pub struct Chosen {
    pub scene: Scene,
    pub resolution: Resolution,
    pub demand: Demand,
    is_preset: bool,
}

/// Finds the scene by gallery name or path, chooses the resolution, and checks that the run will fit into memory.
pub fn choose(arguments: &SceneArguments, bytes_needed: impl Fn(&Scene, usize) -> u64) -> Result<Chosen, Failure> {
    let (scene, preset) = find(arguments)?;
    let resolution = Resolution { patch_size: arguments.patch_size.unwrap_or(preset), n_directions: 1 };
    let demand = memory::check(&scene, resolution, arguments.memory, |n| bytes_needed(&scene, n))?;
    Ok(Chosen { scene, resolution, demand, is_preset: arguments.patch_size.is_none() })
}

impl Chosen {
    /// Cuts the scene and assembles it, having said what will be computed.
    pub fn assemble(
        &self,
        arguments: &Arguments,
        exchange: Exchange,
        bars: &Bars,
    ) -> Result<(Bundles, System), Failure> {
        if !arguments.quiet {
            self.announce();
        }
        let bundles = Bundles::new(&self.scene, self.resolution)?;
        let system = assemble_watched(&self.scene, &bundles, exchange, &|done| bars.progress("assemble", done))?;
        Ok((bundles, system))
    }

    /// Says on standard error what will be computed, and which of its numbers are presets.
    pub fn announce(&self) {
        let Self { scene, resolution, demand, is_preset } = self;
        let preset = if *is_preset { " (preset; --patch-size chooses another)" } else { "" };
        output::error(&format!(
            "{}: {} bundles at patch size {}{preset}, at most {} of memory",
            scene.name(),
            demand.n_bundles,
            resolution.patch_size,
            demand.bytes
        ));
        tessellations(scene).iter().for_each(|sentence| output::error(&format!("note: {sentence}")));
    }
}

fn find(arguments: &SceneArguments) -> Result<(Scene, f64), Failure> {
    let name = arguments.scene.as_deref().ok_or_else(|| Failure::new(Exit::Usage, "which scene?"))?;
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
                "there is no gallery scene '{name}', and no file of that name{}\n  \
                 = `etendue gallery` lists the scenes; a scene file is a Mitsuba 3 scene, NAME.xml",
                suggestion.unwrap_or_default()
            ),
        ));
    }
    let scene = crate::scene::format::read(path, &arguments.definitions)
        .map_err(|error| Failure::new(Exit::Input, error.to_string()))?;
    let area: f64 = scene.surfaces().iter().map(|surface| surface.area()).sum();
    let patch_size = format!("{:.1e}", (area / PRESET_PATCHES).sqrt()).parse();
    let patch_size = patch_size.map_err(|_| Failure::new(Exit::Internal, "the scene's area is no number"))?;
    Ok((scene, patch_size))
}
