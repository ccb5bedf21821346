//! Bidirectional path tracing: a path from the bundle, a path from the light, and every way to join them. Gathering.
//!
//! A path of light with k bounces has k + 1 vertices v₀ … v_k, v₀ on the bundle's patch and v_k on an emitter. Strategy (s, t) finds it
//! with t ≥ 1 vertices from the bundle (v₀ uniform on the patch, wanted in a direction of density cosθ/π, the rest by directions drawn
//! from the BRDFs) and s ≥ 0 from the light (v_k drawn on the emitters, the rest likewise), so
//!
//! ```text
//! k = s + t − 1,        bounce k is found by (0, k + 1), (1, k), … (k, 1).
//! ```
//!
//! s = 0 is meeting an emitter by chance, s = 1 is a point drawn on the emitters. With density p_s,t by area of the whole path, a strategy
//! alone, f E G V / p_s,t, has the expectation KᵏE; all together are weighed by a [`Heuristic`], w = p_s,t / Σ p or p² / Σ p², so that the
//! weights of one path sum to one. t = 0, a path from the light that meets the bundle by chance, would score all bundles at once and is
//! not among the strategies: it is [`LightTracer`](super::LightTracer).
//!
//! Variance: with weights, a path adds no more than it would by (0, k + 1) under the balance heuristic, a product of albedos, and all
//! moments exist. A single strategy with s ≥ 1 joins two points with cosθ cosθ′/r², whose square cannot be integrated where surfaces touch:
//! there its variance is infinite, and no error bar of it holds.
//!
//! Cost: two paths a sample and a shadow ray for every pair of their vertices. Source: Veach 1997, chapter 10; Lafortune & Willems 1993.

mod joint;
mod subpath;
mod weights;

use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::stage::Stage;
use super::{Heuristic, Roulette};
use crate::basis::Bundles;
use crate::sampling::Stream;
use crate::scene::Scene;
use subpath::{Node, Walker};

/// Pairs of paths whose mean is the continuous radiance of every bundle.
pub struct Bidirectional<'a> {
    stage: Stage<'a>,
    heuristic: Heuristic,
    roulette: Roulette,
    columns: Columns,
    part: Part,
}

/// Which strategies score.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    All,
    /// One alone: unweighted, or with the weight that it has among all.
    One {
        n_light: usize,
        n_eye: usize,
        is_weighted: bool,
    },
}

impl<'a> Bidirectional<'a> {
    /// All strategies, weighed by the balance heuristic. Cost O(facets log facets + bundles).
    ///
    /// # Errors
    /// As for [`PathTracer::new`](super::PathTracer::new).
    pub fn new(scene: &'a Scene, bundles: &'a Bundles) -> Result<Self, EstimatorError> {
        let columns = Columns { n_bands: scene.n_bands(), bounces: Bounces::All };
        let stage = Stage::new(scene, bundles)?;
        Ok(Self { stage, heuristic: Heuristic::default(), roulette: Roulette::default(), columns, part: Part::All })
    }

    /// The same pairs, weighed so.
    pub fn with_heuristic(self, heuristic: Heuristic) -> Self {
        Self { heuristic, ..self }
    }

    /// The same pairs, their paths ended so.
    ///
    /// # Errors
    /// A survival probability outside (0, 1].
    pub fn with_roulette(self, roulette: Roulette) -> Result<Self, EstimatorError> {
        roulette.checked().map(|roulette| Self { roulette, ..self })
    }

    /// The same pairs, scored for these bounces.
    pub fn with_bounces(self, bounces: Bounces) -> Self {
        Self { columns: Columns { bounces, ..self.columns }, ..self }
    }

    /// Strategy (s, t) alone, unweighted: its expectation is KᵏE of the continuous scene, k = s + t − 1, and zero in every other bounce.
    ///
    /// # Errors
    /// t = 0.
    pub fn strategy(self, s: usize, t: usize) -> Result<Self, EstimatorError> {
        self.one(s, t, false)
    }

    /// What strategy (s, t) contributes to the whole, with its weight: these sum to KᵏE over s + t = k + 1.
    ///
    /// # Errors
    /// t = 0.
    pub fn weighted_strategy(self, s: usize, t: usize) -> Result<Self, EstimatorError> {
        self.one(s, t, true)
    }

    fn one(self, n_light: usize, n_eye: usize, is_weighted: bool) -> Result<Self, EstimatorError> {
        if n_eye == 0 {
            return Err(EstimatorError::NoEyeVertex { n_light });
        }
        Ok(Self { part: Part::One { n_light, n_eye, is_weighted }, ..self })
    }

    /// The most vertices that a path from the light and one from the bundle may have.
    fn most_vertices(&self) -> (usize, usize) {
        let last = self.columns.bounces.last().unwrap_or(usize::MAX - 1);
        match self.part {
            Part::All => (last, last + 1),
            Part::One { n_light, n_eye, .. } => (n_light.min(last), n_eye.min(last + 1)),
        }
    }

    /// Adds what the path that joins the last of the light's vertices, if it has any, and of the eye's is worth. Returns how many rays it cast.
    fn join(&self, light: &[Node<'_>], eye: &[Node<'_>], totals: &mut [f64]) -> u64 {
        let is_weighted = match self.part {
            Part::All => true,
            Part::One { n_light, n_eye, is_weighted } => {
                if (light.len(), eye.len()) != (n_light, n_eye) {
                    return 0;
                }
                is_weighted
            }
        };
        let Some(joint) = joint::join(&self.stage, light, eye) else { return 0 };

        // Ask whether the way between them is free.
        let mut n_rays = 0;
        if let (Some(start), Some(end)) = (light.last(), eye.last()) {
            n_rays = 1;
            if self.stage.tracer.occluded(end.position, start.position, [end.facet, start.facet]) {
                return n_rays;
            }
        }
        let weight = if is_weighted { weights::weight(self.heuristic, light, eye, &joint) } else { 1.0 };
        totals.iter_mut().zip(joint.light.iter()).for_each(|(total, light)| *total += weight * light);
        n_rays
    }
}

impl Estimator for Bidirectional<'_> {
    fn name(&self) -> &'static str {
        match (self.part, self.heuristic) {
            (Part::One { is_weighted: false, .. }, _) => "bidirectional-strategy",
            (_, Heuristic::Balance) => "bidirectional",
            (_, Heuristic::Power) => "bidirectional-power",
        }
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

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        let (most_light, most_eye) = self.most_vertices();
        let stage = &self.stage;
        let walker = Walker { stage, roulette: self.roulette, n_bands: self.columns.n_bands };
        let (eye, n_eye_rays) = walker.of_bundle(stage.patches[start], most_eye, stream);
        let (light, n_light_rays) = walker.of_light(most_light, stream);
        let mut n_rays = n_eye_rays + n_light_rays;
        for t in 1..=eye.len() {
            for s in 0..=light.len() {
                let Some(here) = self.columns.of(s + t - 1) else { break };
                n_rays += self.join(&light[..s], &eye[..t], &mut score.totals(start)[here]);
            }
        }
        score.count_steps(n_rays);
    }
}
