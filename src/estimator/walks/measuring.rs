//! Measurements by gathering walks: the first bundle is drawn from the measurement.
//!
//! ```text
//! ⟨W, L⟩ = Σᵢ μᵢ Wᵢ Lᵢ = E[w_I X_I],      I ~ qᵢ ∝ μᵢ max over bands |Wᵢ|,      wᵢ = μᵢ Wᵢ / qᵢ
//! ```
//!
//! What is scored is one number a measurement and band (and bounce), in the étendue inner product: with W of 1/Σμ on a surface's bundles
//! and 0 elsewhere, its mean radiance. Requirements and moments as for [`MatrixWalk`]; W may have any sign.
//!
//! Cost: one random number a walk more than [`MatrixWalk`].

use super::super::{Estimator, EstimatorError, Score, Truth};
use super::gathering::Walk;
use super::{MatrixWalk, Scoring};
use crate::linalg::Block;
use crate::sampling::{AliasTable, Stream, Streams};
use std::ops::Range;

/// Walks whose mean is ⟨W, L⟩ of some measurements W. One start a measurement: [`Estimator::n_bundles`] counts measurements.
#[derive(Clone, Debug)]
pub struct MeasuringWalk {
    pub(super) walk: MatrixWalk,
    pub(super) starts: Vec<Starts>,
}

/// Where the walks of one measurement begin.
#[derive(Clone, Debug)]
pub(super) struct Starts {
    table: AliasTable,
    /// Σ μᵢ max |Wᵢ|.
    total: f64,
    /// W over its largest band, n × bands.
    shares: Block,
}

impl MatrixWalk {
    /// The same walks, begun where measurements look: every W is n × bands, in the units that make ⟨W, L⟩ what is wanted.
    ///
    /// # Errors
    /// A measurement that is zero, or not finite.
    ///
    /// # Panics
    /// If a measurement has another shape than the emission.
    pub fn measuring(&self, measurements: &[Block]) -> Result<MeasuringWalk, EstimatorError> {
        let starts = measurements.iter().enumerate().map(|(measurement, weights)| {
            let sampled = |source| EstimatorError::Measurement { measurement, source };
            Starts::new(weights, &self.chain.etendue).map_err(sampled)
        });
        Ok(MeasuringWalk { walk: self.clone(), starts: starts.collect::<Result<_, _>>()? })
    }
}

impl Starts {
    pub fn new(weights: &Block, etendue: &[f64]) -> Result<Self, crate::sampling::AliasError> {
        assert_eq!(weights.n_rows(), etendue.len(), "there must be one weight a bundle");
        let largest =
            |i: usize| weights.row(i).fold(0.0, |largest: f64, w| if w.is_nan() { w } else { largest.max(w.abs()) });
        let masses: Vec<f64> = etendue.iter().enumerate().map(|(i, mu)| mu * largest(i)).collect();
        let table = AliasTable::new(&masses)?;
        let share = |i: usize, band| if masses[i] > 0.0 { weights.get(i, band) / largest(i) } else { 0.0 };
        let shares = Block::from_fn(weights.n_rows(), weights.n_columns(), share);
        Ok(Self { table, total: masses.iter().sum(), shares })
    }

    /// A bundle.
    #[inline]
    pub fn draw(&self, stream: &mut Stream) -> usize {
        self.table.sample(stream.uniform())
    }

    /// w of a bundle, band by band.
    #[inline]
    pub fn weights(&self, bundle: usize) -> impl Iterator<Item = f64> + '_ {
        self.shares.row(bundle).map(|share| self.total * share)
    }

    /// w of one band, n.
    pub fn weights_of(&self, band: usize) -> Vec<f64> {
        self.shares.column(band).iter().map(|share| self.total * share).collect()
    }

    /// q, n.
    pub fn probabilities(&self) -> Vec<f64> {
        self.table.probabilities()
    }
}

impl MeasuringWalk {
    fn begin(&self, measurement: usize, mut stream: Stream) -> Walk {
        let starts = &self.starts[measurement];
        let bundle = starts.draw(&mut stream);
        let mut walk = self.walk.begin(bundle, stream);
        walk.weigh(starts.weights(bundle));
        walk
    }
}

impl Estimator for MeasuringWalk {
    fn name(&self) -> &'static str {
        match self.walk.scoring() {
            Scoring::Collision => "collision-measurement",
            Scoring::Absorption => "absorption-measurement",
            Scoring::Survival => "survival-measurement",
            Scoring::ExpectedValue => "expected-value-measurement",
        }
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        self.starts.len()
    }

    fn n_columns(&self) -> usize {
        self.walk.n_columns()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        *stream = self.walk.finish(self.begin(start, stream.clone()), start, score);
    }

    fn samples(&self, start: usize, numbers: Range<u64>, streams: &Streams, score: &mut Score) {
        let walks = numbers.map(|number| self.begin(start, streams.stream(start as u32, number)));
        self.walk.abreast(walks, start, score);
    }
}
