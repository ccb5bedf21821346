//! Where the numbers of a run came from.

use super::scene::Chosen;
use crate::assembly::{Exchange, Occlusion};
use crate::study::Provenance;

/// The provenance of a command; `settings` are those that only it has.
pub fn provenance<const N: usize>(
    chosen: &Chosen,
    command: Vec<String>,
    exchange: &Exchange,
    settings: [(&str, String); N],
) -> Provenance {
    let shared = [
        ("quadrature_tolerance", format!("{:e}", exchange.tolerance)),
        ("closure_repair", exchange.repair.to_string()),
    ];
    let occlusion = match exchange.occlusion {
        Occlusion::Exact { tolerance } => vec![("visibility_error", format!("{tolerance:e}"))],
        Occlusion::Sampled { rays, sink_rays } => {
            vec![("visibility_rays_a_pair", rays.to_string()), ("sink_rays_a_patch", sink_rays.to_string())]
        }
    };
    let settings = settings.into_iter().chain(shared).chain(occlusion);
    Provenance {
        version: env!("CARGO_PKG_VERSION").to_string(),
        command,
        scene: chosen.scene.name().to_string(),
        scene_hash: chosen.scene.hash(),
        patch_size: chosen.resolution.patch_size,
        n_directions: chosen.resolution.n_directions,
        seed: exchange.seed,
        settings: settings.map(|(name, value)| (name.to_string(), value)).collect(),
    }
}
