//! Light tracing: photons from the emitters, scored where they are reflected. Shooting, one start for all bundles.
//!
//! ```text
//! L_b = E_b + (1/μ_b) Σ over hits in b of  Φ a(ω),      Φ the power that arrives from ω, a the directional albedo there
//! ```
//!
//! A sample is a photon: it leaves a point drawn on the emitters in proportion to their power, with density cosθ/π, and carries
//! Φ = π E / (density by area) in every band, the power of all emitters. At each hit, the albedo's share of what it carries leaves the
//! surface, spread over the one bin of directions of its bundle, whose radiance is that power over the étendue. Then the BRDF turns the
//! photon, and a [`Roulette`] decides whether it goes on. Bounce k is the k-th hit; bounce 0, what is emitted, is known.
//!
//! Variance: a hit scores no more than the emitters' power over μ_b, and the number of hits of a photon falls off geometrically where
//! light is absorbed or escapes, so all moments exist. It grows as bundles get smaller, for fewer photons find them: a bundle that is
//! hit by one photon in N rests on n/N scores.
//!
//! Cost: a closest-hit ray a vertex and no shadow rays. Source: Arvo 1986; Pattanaik & Mudur 1992; Veach 1997, §4.7 (importance).

use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::Roulette;
use super::photon;
use super::stage::Stage;
use crate::basis::Bundles;
use crate::linalg::Block;
use crate::sampling::Stream;
use crate::scene::Scene;
use std::ops::Range;

/// Photons whose mean is the continuous radiance of every bundle.
pub struct LightTracer<'a> {
    stage: Stage<'a>,
    roulette: Roulette,
    columns: Columns,
    /// What is emitted.
    known: Block,
}

impl<'a> LightTracer<'a> {
    /// Cost O(facets log facets + bundles).
    ///
    /// # Errors
    /// As for [`PathTracer::new`](super::PathTracer::new).
    pub fn new(scene: &'a Scene, bundles: &'a Bundles) -> Result<Self, EstimatorError> {
        let columns = Columns { n_bands: scene.n_bands(), bounces: Bounces::All };
        let stage = Stage::new(scene, bundles)?;
        Ok(Self { known: stage.emitted(columns), stage, roulette: Roulette::default(), columns })
    }

    /// The same photons, ended so.
    ///
    /// # Errors
    /// A survival probability outside (0, 1].
    pub fn with_roulette(self, roulette: Roulette) -> Result<Self, EstimatorError> {
        roulette.checked().map(|roulette| Self { roulette, ..self })
    }

    /// The same photons, scored for these bounces.
    pub fn with_bounces(self, bounces: Bounces) -> Self {
        let columns = Columns { bounces, ..self.columns };
        Self { columns, known: self.stage.emitted(columns), ..self }
    }
}

impl Estimator for LightTracer<'_> {
    fn name(&self) -> &'static str {
        "light-tracer"
    }

    fn truth(&self) -> Truth {
        Truth::Continuous
    }

    fn n_bundles(&self) -> usize {
        self.stage.patches.len()
    }

    fn n_columns(&self) -> usize {
        self.columns.count()
    }

    fn n_starts(&self) -> usize {
        1
    }

    fn reach(&self, _: usize) -> Range<usize> {
        0..self.n_bundles()
    }

    fn known(&self) -> Option<&Block> {
        Some(&self.known)
    }

    fn sample(&self, _: usize, stream: &mut Stream, score: &mut Score) {
        let stage = &self.stage;
        let etendue = stage.bundles.etendue();
        let n_rays = photon::fly(stage, self.roulette, self.columns, stream, |vertex, bounce, arriving| {
            let (Some(bundle), Some(here)) = (stage.locate(vertex), self.columns.of(bounce)) else { return };
            let mut reflected = arriving.clone();
            vertex.reflection.absorb(vertex.given, &mut reflected);
            let totals = &mut score.totals(bundle)[here];
            totals.iter_mut().zip(reflected.iter()).for_each(|(total, power)| *total += power / etendue[bundle]);
        });
        score.count_steps(n_rays);
    }
}
