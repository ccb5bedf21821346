//! Where a number came from.

use serde::Serialize;
use std::collections::BTreeMap;

/// Everything needed to get the same numbers again. Enters every result that is written.
#[derive(Clone, Debug, Serialize)]
pub struct Provenance {
    /// Version of this program.
    pub version: String,
    /// The command line as given.
    pub command: Vec<String>,
    /// Name of the scene.
    pub scene: String,
    /// BLAKE3 of the validated scene's content, hexadecimal.
    pub scene_hash: String,
    pub patch_size: f64,
    pub n_directions: usize,
    pub seed: u64,
    /// Every other setting that changes a number, by name: tolerances, sample counts, exchange choices.
    pub settings: BTreeMap<String, String>,
}
