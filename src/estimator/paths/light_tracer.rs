//! Light tracing: photons from the emitters, scored where they are reflected. Shooting, one start for all bundles.
//!
//! ```text
//! L_b = E_b + (1/μ_b) Σ over hits in b of  Φ a(ω),      Φ the power that arrives from ω, a the directional albedo there
//! ```
//!
//! A photon leaves a point drawn on the emitters in proportion to their power, with density cosθ/π, and carries Φ = π E / (density by
//! area) / (photons a sample) in every band. At each hit, the albedo's share of what it carries leaves the surface, spread over the one
//! bin of directions of its bundle, whose radiance is that power over the étendue. Then the BRDF turns the photon, and a [`Roulette`]
//! decides whether it goes on. Bounce k is the k-th hit; bounce 0, what is emitted, is added without noise.
//!
//! A sample is a photon a bundle, so that it costs about what a path tracer's sample of every bundle costs. The photons of a sample are
//! stratified over the emitters; samples are independent.
//!
//! Variance: a hit scores no more than the emitters' power over μ_b, and the number of hits of a photon falls off geometrically where
//! light is absorbed or escapes, so all moments exist. It grows as bundles get smaller, for fewer photons find them.
//!
//! Cost: a closest-hit ray a vertex and no shadow rays. Source: Arvo 1986; Pattanaik & Mudur 1992; Veach 1997, §4.7 (importance).

use super::super::bands::Bands;
use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::Roulette;
use super::stage::{Stage, Vertex};
use crate::basis::Bundles;
use crate::sampling::{Stream, Streams};
use crate::scene::Scene;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::Range;

/// Samples drawn in parallel between two scorings: bounds the tallies held at once.
const SAMPLES_A_WAVE: usize = 16;

/// Photons whose mean is the continuous radiance of every bundle.
pub struct LightTracer<'a> {
    stage: Stage<'a>,
    roulette: Roulette,
    columns: Columns,
}

impl<'a> LightTracer<'a> {
    /// Cost O(facets log facets + bundles).
    ///
    /// # Errors
    /// As for [`PathTracer::new`](super::PathTracer::new).
    pub fn new(scene: &'a Scene, bundles: &'a Bundles) -> Result<Self, EstimatorError> {
        let columns = Columns { n_bands: scene.n_bands(), bounces: Bounces::All };
        Ok(Self { stage: Stage::new(scene, bundles)?, roulette: Roulette::default(), columns })
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
        Self { columns: Columns { bounces, ..self.columns }, ..self }
    }

    /// One sample, bundle by bundle, one number a column.
    fn tally(&self, stream: &mut Stream) -> Vec<f64> {
        let n_columns = self.n_columns();
        let mut tally = vec![0.0; self.n_bundles() * n_columns];

        // Every bundle sends out what it emits.
        let Some(emitted) = self.columns.of(0) else { return tally };
        for (totals, patch) in tally.chunks_exact_mut(n_columns).zip(&self.stage.patches) {
            let emission = self.stage.emission(patch.facet, patch.side);
            totals[emitted.clone()].iter_mut().zip(emission).for_each(|(total, emission)| *total = *emission);
        }

        // Every hit of a photon sends on what it reflects.
        let n_photons = self.n_bundles();
        let etendue = self.stage.bundles.etendue();
        for number in 0..n_photons {
            let photon = Photon { number, n_photons };
            photon.fly(&self.stage, self.roulette, self.columns, stream, |vertex, bounce, arriving| {
                let (Some(bundle), Some(here)) = (self.stage.locate(vertex), self.columns.of(bounce)) else { return };
                let mut reflected = arriving.clone();
                vertex.reflection.absorb(vertex.given, &mut reflected);
                let totals = &mut tally[bundle * n_columns..][here];
                totals.iter_mut().zip(reflected.iter()).for_each(|(total, power)| *total += power / etendue[bundle]);
            });
        }
        tally
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

    fn sample(&self, _: usize, stream: &mut Stream, score: &mut Score) {
        add(&self.tally(stream), self.n_columns(), score);
    }

    fn samples(&self, start: usize, numbers: Range<u64>, streams: &Streams, score: &mut Score) {
        let numbers: Vec<u64> = numbers.collect();
        for wave in numbers.chunks(SAMPLES_A_WAVE) {
            let drawn = wave.par_iter().map(|number| self.tally(&mut streams.stream(start as u32, *number)));
            for tally in drawn.collect::<Vec<_>>() {
                add(&tally, self.n_columns(), score);
                score.end_sample();
            }
        }
    }
}

/// Adds a tally to the totals of every bundle.
fn add(tally: &[f64], n_columns: usize, score: &mut Score) {
    for (bundle, values) in tally.chunks_exact(n_columns).enumerate() {
        score.totals(bundle).iter_mut().zip(values).for_each(|(total, value)| *total += value);
    }
}

/// One of the photons of a sample.
pub(super) struct Photon {
    pub number: usize,
    pub n_photons: usize,
}

impl Photon {
    /// Sends the photon out and calls `hit(vertex, bounce, power)` wherever it arrives on what is not black, with the power that arrives
    /// in every band.
    pub fn fly(
        self,
        stage: &Stage<'_>,
        roulette: Roulette,
        columns: Columns,
        stream: &mut Stream,
        mut hit: impl FnMut(&Vertex<'_>, usize, &Bands),
    ) {
        // Choose the emitter by the photon's stratum, then leave any of its points in any direction.
        let stratum = (self.number as f64 + stream.uniform()) / self.n_photons as f64;
        let (emitter, position, direction) = stage.emit(stage.emitters.choose(stratum), stream);
        let scale = PI / (emitter.density * self.n_photons as f64);
        let mut power = Bands::all(scale, columns.n_bands);
        power.iter_mut().zip(emitter.emission).for_each(|(power, emission)| *power *= emission);
        let sent = power.max();

        let (mut facet, mut position, mut direction) = (emitter.facet, position, direction);
        for bounce in 1.. {
            if columns.ends_before(bounce) {
                return;
            }
            let Some(arrival) = stage.follow(facet, position, direction) else { return };
            let Some(vertex) = stage.vertex(&arrival) else { return };
            hit(&vertex, bounce, &power);

            // Turn it, and let it survive or not.
            let Some(turn) = vertex.reflection.turn(vertex.given, stream.uniform2(), &mut power) else { return };
            let survival = roulette.survival(bounce, power.max() / sent);
            if survival < 1.0 {
                if stream.uniform() >= survival {
                    return;
                }
                power.iter_mut().for_each(|power| *power /= survival);
            }
            (facet, position, direction) = (vertex.facet, vertex.position, vertex.frame.to_world(turn.direction));
        }
    }
}
