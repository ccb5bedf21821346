//! Photon density: the radiance of a bundle from the photons near its points. Shooting, biased by the kernel, consistent.
//!
//! ```text
//! L(x) ≈ E(x) + Σ over the photons p near x of  Φ_p a(ω_p) / (N π A),      A the part of the disk around x that lies on x's facet
//! ```
//!
//! A sample sends out N photons, stores each wherever it arrives on what is not black, at every bounce, and estimates the radiance of each
//! bundle at a point drawn on its patch. "Near" is a [`Kernel`]: a disk of one radius, or the disk that holds the k nearest photons. Dividing
//! by the part of the disk on the facet leaves no darkening at edges; light does not leak from one facet or side to another.
//!
//! Bias: the expectation is not the radiance but its mean over the disks, off by h²/8 ∇²L for a radius h away from edges, and in the first
//! order of h within h of an edge, so [`Truth`] is [`Truth::Smoothed`]. For a radius it is linear in the photons and does not depend on N;
//! for the nearest it shrinks with N, as (k/N) where L is smooth. [`PhotonDensity::bias`] estimates it from the same photons, against the
//! histogram, which is the unbiased mean over the patch ([`LightTracer`](super::LightTracer) with N photons a sample). The kernel pays
//! where patches are smaller than it: its variance falls off as 1/h², the histogram's grows with the patches' number.
//!
//! Variance exists for a radius, as for light tracing. For the k nearest photons it exists for k ≥ 3, as that of (k − 1)/A_k does.
//!
//! Cost: N photons, and O(k) a bundle with a grid of cells. Source: Jensen 1996; Silverman 1986, §5.2 ((k − 1)/(N A_k), which is unbiased
//! where the density is uniform).

mod disk;
mod map;

use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::stage::Stage;
use super::{Roulette, photon};
use crate::basis::Bundles;
use crate::linalg::Block;
use crate::sampling::{Stream, Streams};
use crate::scene::Scene;
use disk::Flat;
use map::{Hit, PhotonMap};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::Range;

/// Samples drawn between two scorings: bounds the tallies held at once.
const SAMPLES_A_WAVE: usize = 16;

/// Which photons a point is lit by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// Those within this distance, metres.
    Radius(f64),
    /// Those nearer than the k-th nearest, k ≥ 3.
    Nearest(usize),
}

/// Photon maps whose mean is the radiance of every bundle, smoothed by a kernel.
pub struct PhotonDensity<'a> {
    stage: Stage<'a>,
    flats: Vec<Flat>,
    n_photons: usize,
    kernel: Kernel,
    roulette: Roulette,
    columns: Columns,
    /// What is emitted, unless it is the bias that is scored.
    known: Option<Block>,
}

impl<'a> PhotonDensity<'a> {
    /// Maps of so many photons, seen through this kernel. Cost O(facets log facets + bundles).
    ///
    /// # Errors
    /// As for [`PathTracer::new`](super::PathTracer::new); no photons, a radius that is not above zero, fewer than three nearest.
    pub fn new(
        scene: &'a Scene,
        bundles: &'a Bundles,
        n_photons: usize,
        kernel: Kernel,
    ) -> Result<Self, EstimatorError> {
        let is_valid = match kernel {
            Kernel::Radius(radius) => radius.is_finite() && radius > 0.0,
            Kernel::Nearest(k) => k >= 3,
        };
        if n_photons == 0 || !is_valid {
            return Err(EstimatorError::Kernel { n_photons, kernel });
        }
        let columns = Columns { n_bands: scene.n_bands(), bounces: Bounces::All };
        let stage = Stage::new(scene, bundles)?;
        let flats = (0..scene.facets().len()).map(|facet| Flat::new(scene.polygon(facet))).collect();
        let known = Some(stage.emitted(columns));
        Ok(Self { stage, flats, n_photons, kernel, roulette: Roulette::default(), columns, known })
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
        let known = self.known.map(|_| self.stage.emitted(columns));
        Self { columns, known, ..self }
    }

    /// The same photons, scored by the density estimate less the histogram: the expectation is the kernel's bias in every bundle.
    pub fn bias(self) -> Self {
        Self { known: None, ..self }
    }

    /// Which photons a point is lit by.
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Photons a sample.
    pub fn n_photons(&self) -> usize {
        self.n_photons
    }

    /// One sample, bundle by bundle, one number a column, and how many rays it took.
    fn tally(&self, stream: &mut Stream) -> (Vec<f64>, u64) {
        let (stage, n_columns) = (&self.stage, self.n_columns());
        let etendue = stage.bundles.etendue();
        let mut tally = vec![0.0; self.n_bundles() * n_columns];

        // Store what every photon has reflected, at each hit.
        let mut map = PhotonMap::new(self.columns.n_bands);
        let mut n_rays = 0;
        for _ in 0..self.n_photons {
            n_rays += photon::fly(stage, self.roulette, self.columns, stream, |vertex, bounce, arriving| {
                let Some(here) = self.columns.of(bounce) else { return };
                let mut reflected = arriving.clone();
                vertex.reflection.absorb(vertex.given, &mut reflected);
                reflected.iter_mut().for_each(|power| *power /= self.n_photons as f64);
                let at = self.flats[vertex.facet].coordinates(vertex.position);
                map.store(Hit { facet: vertex.facet, side: vertex.side, at, column: here.start }, &reflected);
                if self.known.is_none() {
                    let Some(bundle) = stage.locate(vertex) else { return };
                    let totals = &mut tally[bundle * n_columns..][here];
                    totals
                        .iter_mut()
                        .zip(reflected.iter())
                        .for_each(|(total, power)| *total -= power / etendue[bundle]);
                }
            });
        }

        // Look from one point of every bundle at those around it.
        let map = map.sorted(&self.flats);
        for (totals, patch) in tally.chunks_exact_mut(n_columns).zip(&stage.patches) {
            let flat = &self.flats[patch.facet];
            let at = flat.coordinates(patch.polygon.sample(stream.uniform2()));
            let around = map.around((patch.facet, patch.side), flat, at, self.kernel);
            let scale = 1.0 / (PI * around.area);
            for (column, power) in around.photons {
                let totals = &mut totals[column..];
                totals.iter_mut().zip(power).for_each(|(total, power)| *total += power * scale);
            }
        }
        (tally, n_rays)
    }

    /// Adds a tally to the totals of every bundle.
    fn add(&self, (tally, n_rays): &(Vec<f64>, u64), score: &mut Score) {
        for (bundle, values) in tally.chunks_exact(self.n_columns()).enumerate() {
            score.totals(bundle).iter_mut().zip(values).for_each(|(total, value)| *total += value);
        }
        score.count_steps(*n_rays);
    }
}

impl Estimator for PhotonDensity<'_> {
    fn name(&self) -> &'static str {
        if self.known.is_some() { "photon-density" } else { "photon-density-bias" }
    }

    fn truth(&self) -> Truth {
        Truth::Smoothed
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
        self.known.as_ref()
    }

    fn sample(&self, _: usize, stream: &mut Stream, score: &mut Score) {
        self.add(&self.tally(stream), score);
    }

    /// Draws whole maps in parallel.
    fn samples(&self, start: usize, numbers: Range<u64>, streams: &Streams, score: &mut Score) {
        let numbers: Vec<u64> = numbers.collect();
        for wave in numbers.chunks(SAMPLES_A_WAVE) {
            let draw = |number: &u64| self.tally(&mut streams.stream(start as u32, *number));
            for tally in wave.par_iter().map(draw).collect::<Vec<_>>() {
                self.add(&tally, score);
                score.end_sample();
            }
        }
    }
}
