//! How much memory a study takes.

use super::estimators::MOST_DIAGONAL;
use crate::assembly::System;
use crate::scene::Scene;

/// Bytes that a study of n bundles may take, its pictures included.
///
/// Of size n² it holds at most T and the matrix, the factors and their copy of the nalgebra solver, or T, the tables of the walks
/// and T unrepaired: 32 bytes an entry, and 8 for what the allocator keeps after assembly. A picture is in memory three times while it
/// is gathered and encoded, once for every number of bounces, for all, and for the emission.
/// Beside the tables of all walks, those guided by the solution have 16 bytes an entry and band, those of quasi-Monte Carlo 12 and twice that
/// while their list grows; to foretell particles takes a matrix, its factors, and as many right-hand sides and answers.
pub fn memory_estimate(scene: &Scene, n_bundles: usize, n_bounces: usize, estimators: &[String]) -> u64 {
    let n = n_bundles as u64;
    let film = scene.camera().map(|camera| &camera.film);
    let n_pixels = film.map_or(0, |film| (film.width as u64).saturating_mul(film.height as u64));
    let a_pixel = 3 * 8 * scene.n_bands() as u64 * (n_bounces as u64 + 2);
    let beside = |name: &str| match name {
        "guided-walk" => 16 * scene.n_bands() as u64,
        "quasi-walk" => 24,
        name if name.ends_with("-shooting") && n_bundles <= MOST_DIAGONAL => 32,
        _ => 0,
    };
    let an_entry = 16 + estimators.iter().map(|name| beside(name)).max().unwrap_or(0);
    System::memory_estimate(n_bundles)
        .saturating_add(n.saturating_mul(n).saturating_mul(an_entry))
        .saturating_add(n_pixels.saturating_mul(a_pixel))
}
