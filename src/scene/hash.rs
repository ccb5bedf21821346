//! A fingerprint of everything in a scene that changes its light.

use super::Scene;
use crate::geometry::Vec3;

impl Scene {
    /// BLAKE3 of the scene's content, hexadecimal: equal scenes hash alike on every machine, and the name does not count.
    pub fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        let mut text = |s: &str| {
            hasher.update(&(s.len() as u64).to_le_bytes());
            hasher.update(s.as_bytes());
        };
        for band in self.bands() {
            text(band);
        }
        for surface in self.surfaces() {
            text(&surface.name);
            text(&surface.front.description());
            text(&surface.back.as_ref().map(|b| b.description()).unwrap_or_default());
        }
        if let Some(camera) = self.camera() {
            text(&format!("{camera:?}"));
        }

        let mut numbers = |values: &[f64]| {
            hasher.update(&(values.len() as u64).to_le_bytes());
            values.iter().for_each(|v| {
                hasher.update(&v.to_bits().to_le_bytes());
            });
        };
        for surface in self.surfaces() {
            numbers(&surface.emission);
            for polygon in &surface.polygons {
                numbers(&polygon.vertices().iter().flat_map(|v: &Vec3| v.to_array()).collect::<Vec<_>>());
            }
        }
        hasher.finalize().to_hex().to_string()
    }
}
