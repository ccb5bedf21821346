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
    /// A corner and two sides, of one that is a parallelogram.
    parallelogram: Option<[Vec3; 3]>,
    /// Of the front.
    pub normal: Vec3,
    /// W m⁻² sr⁻¹, one value a band.
    pub emission: &'a [f64],
    /// Density of [`Emitters::point`] by area, m⁻².
    pub density: f64,
}

impl Emitter<'_> {
    /// A point of it, uniform by area.
    #[inline]
    pub fn point(&self, [u, v]: [f64; 2]) -> Vec3 {
        match self.parallelogram {
            Some([corner, along, up]) => corner + u * along + v * up,
            None => self.polygon.sample([u, v]),
        }
    }
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
            parallelogram: scene.polygon(facet).parallelogram(),
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
        let (_, emitter) = self.choose(choice);
        (emitter, emitter.point([u, v]))
    }

    /// An emitter in proportion to its power, and its number.
    #[inline]
    pub fn choose(&self, uniform: f64) -> (usize, &Emitter<'a>) {
        let number = self.choice.sample(uniform);
        (number, &self.emitters[number])
    }

    /// The emitter of a number.
    #[inline]
    pub fn get(&self, number: usize) -> &Emitter<'a> {
        &self.emitters[number]
    }

    /// Density of [`Emitters::point`] by area, m⁻², at any point of a facet's front.
    #[inline]
    pub fn density(&self, facet: usize) -> f64 {
        self.density[facet]
    }
}
