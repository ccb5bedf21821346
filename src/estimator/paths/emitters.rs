//! Points on what emits, chosen by power.

use super::super::EstimatorError;
use crate::geometry::{Polygon, Vec3};
use crate::sampling::{AliasTable, Stream};
use crate::scene::Scene;

/// Samples points of the emitting fronts with a density by area in proportion to the largest band's emission.
#[derive(Clone, Debug)]
pub(super) struct Emitters<'a> {
    emitters: Vec<Emitter<'a>>,
    choice: AliasTable,
    /// Density of [`Emitters::point`] on each facet of the scene, m⁻²; 0 where nothing is emitted.
    density: Vec<f64>,
}

/// A facet whose front emits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emitter<'a> {
    pub facet: usize,
    pub polygon: &'a Polygon,
    /// Of the front.
    pub normal: Vec3,
    /// W m⁻² sr⁻¹, one value a band.
    pub emission: &'a [f64],
    /// Density of [`Emitters::point`] by area, m⁻².
    pub density: f64,
}

impl<'a> Emitters<'a> {
    /// Cost O(facets).
    pub fn new(scene: &'a Scene) -> Result<Self, EstimatorError> {
        let strength = |facet: usize| scene.surface_of(facet).emission.iter().copied().fold(0.0, f64::max);
        let facets: Vec<usize> = (0..scene.facets().len()).filter(|facet| strength(*facet) > 0.0).collect();
        let power: Vec<f64> = facets.iter().map(|facet| strength(*facet) * scene.polygon(*facet).area()).collect();
        let choice = AliasTable::new(&power).map_err(EstimatorError::Emitters)?;
        let total: f64 = power.iter().sum();
        let density: Vec<f64> = (0..scene.facets().len()).map(|facet| strength(facet) / total).collect();
        let emitter = |facet: usize| Emitter {
            facet,
            polygon: scene.polygon(facet),
            normal: scene.polygon(facet).normal(),
            emission: &scene.surface_of(facet).emission,
            density: density[facet],
        };
        Ok(Self { emitters: facets.into_iter().map(emitter).collect(), choice, density })
    }

    /// An emitter and a point of it. Draws three numbers.
    #[inline]
    pub fn point(&self, stream: &mut Stream) -> (&Emitter<'a>, Vec3) {
        let [choice, u, v] = stream.uniform3();
        let emitter = &self.emitters[self.choice.sample(choice)];
        (emitter, emitter.polygon.sample([u, v]))
    }

    /// Density of [`Emitters::point`] by area, m⁻², at any point of a facet's front.
    #[inline]
    pub fn density(&self, facet: usize) -> f64 {
        self.density[facet]
    }
}
