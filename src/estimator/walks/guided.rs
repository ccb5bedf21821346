//! Importance-sampled walks: an approximate solution decides where walks go and where they end.
//!
//! ```text
//! x = b + A x,      c = b + A x̃,      end on i with probability bᵢ/cᵢ,      or step to j with probability Aᵢⱼ x̃ⱼ / cᵢ
//! ```
//!
//! The weight grows by cᵢ / x̃ⱼ a step, and the bundle that ends a walk scores w c: the mean is x for every guide x̃ that is above zero where x
//! is. With x̃ = x, c is x too, weights and score telescope, and every walk scores xᵢ: the variance is zero to rounding. A guide that is
//! within a factor 1 ± δ of x leaves a relative standard deviation of order δ √(steps).
//!
//! *Gathering* has A = K, b = E, x = L: the guide is radiance, one start a bundle. *Measuring* begins it on i with probability ∝ μᵢ |Wᵢ| cᵢ.
//! *Shooting* has A = K*, b = W, x = J, the importance of one measurement, and begins where light is emitted, ∝ μᵢ Eᵢ cᵢ: ⟨E, J⟩ = ⟨W, L⟩.
//! All bands have their own tables and walks, so that all can have no variance at once.
//!
//! Moments need not exist where the guide is poor; [`GuidedWalk::predict`] tells. Cost: one random number and one alias slot a step and
//! band; tables of 16 bytes an entry of G above zero and band. Source: Kahn 1956; Spanier & Gelbard 1969, §3 (zero variance); Veach 1997,
//! §2.5.3; Christensen 2003 (discrete importance).

use super::super::{Estimator, EstimatorError, Score, Truth};
use super::measuring::Starts;
use crate::assembly::{AdjointTransport, Propagation, System};
use crate::linalg::{Block, LinearOperator};
use crate::sampling::{AliasRows, Stream};
use std::sync::Arc;

/// Walks whose steps follow an approximate solution. Scored: radiance of bundles, or measurements.
#[derive(Clone, Debug)]
pub struct GuidedWalk {
    kind: Kind,
    pub(super) tables: Arc<Tables>,
    /// By measurement and band; none where every bundle is a start.
    pub(super) starts: Vec<Vec<Starts>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Gathering,
    Measuring,
    Shooting,
}

/// Where walks go, in every band.
#[derive(Debug)]
pub(super) struct Tables {
    pub propagation: Propagation,
    pub etendue: Arc<[f64]>,
    /// a, n × bands.
    pub albedo: Block,
    /// b, n × bands.
    pub source: Block,
    /// x̃, n × bands.
    pub guide: Block,
    /// c, n × bands.
    pub expected: Block,
    pub is_adjoint: bool,
    /// One table a band; a row's missing probability ends the walk.
    steps: Vec<AliasRows>,
}

impl GuidedWalk {
    /// Gathering walks that go where `radiance`, an approximate L ≥ 0, says that light comes from.
    ///
    /// Cost O(n² bands).
    ///
    /// # Errors
    /// A guide below zero, not finite, or zero where light is; a closed part of the scene that the guide gives light and none is emitted in.
    pub fn gathering(system: &System, radiance: &Block) -> Result<Self, EstimatorError> {
        let tables = Tables::new(system, system.transport(), system.emission(), radiance, false)?;
        Ok(Self { kind: Kind::Gathering, tables: Arc::new(tables), starts: Vec::new() })
    }

    /// Particles that go where `importance`, an approximate J ≥ 0 of the measurement W ≥ 0, says that it looks. What is scored is ⟨W, L⟩.
    ///
    /// Cost O(n² bands).
    ///
    /// # Errors
    /// As for [`GuidedWalk::gathering`]; a measurement below zero, or exchange that is not symmetric; no emission that importance reaches.
    pub fn shooting(system: &System, measurement: &Block, importance: &Block) -> Result<Self, EstimatorError> {
        if system.equation().self_adjoint.is_none() {
            return Err(EstimatorError::NotReciprocal);
        }
        let adjoint = AdjointTransport::new(system.transport().clone());
        let tables = Arc::new(Tables::new(system, &adjoint, measurement, importance, true)?);
        let starts = tables.starts(system.emission()).map_err(EstimatorError::Emission)?;
        Ok(Self { kind: Kind::Shooting, tables, starts: vec![starts] })
    }

    /// The gathering walks, begun where measurements look, n × bands each, of any sign.
    ///
    /// # Errors
    /// A measurement that is zero wherever there is light, or not finite.
    ///
    /// # Panics
    /// If the walks measure already.
    pub fn measuring(&self, measurements: &[Block]) -> Result<Self, EstimatorError> {
        assert_eq!(self.kind, Kind::Gathering, "these walks measure already");
        let starts = measurements.iter().enumerate().map(|(measurement, weights)| {
            self.tables.starts(weights).map_err(|source| EstimatorError::Measurement { measurement, source })
        });
        Ok(Self { kind: Kind::Measuring, starts: starts.collect::<Result<_, _>>()?, ..self.clone() })
    }
}

impl Tables {
    fn new(
        system: &System,
        operator: &dyn LinearOperator,
        source: &Block,
        guide: &Block,
        is_adjoint: bool,
    ) -> Result<Self, EstimatorError> {
        let (n, n_bands) = (system.n_bundles(), system.n_bands());
        for block in [source, guide] {
            assert_eq!((block.n_rows(), block.n_columns()), (n, n_bands), "one guide and source a bundle and band");
            if let Some(k) = block.values().iter().position(|v| !(v.is_finite() && *v >= 0.0)) {
                return Err(EstimatorError::Guide { bundle: k % n, band: k / n, value: block.values()[k] });
            }
        }
        let mut expected = Block::zeros(n, n_bands);
        operator.apply(guide, &mut expected);
        expected.add_scaled(1.0, source);
        let steps = (0..n_bands).map(|band| {
            let (guide, expected) = (guide.column(band), expected.column(band));
            let row = |i: usize, row: &mut [f64]| {
                if expected[i] > 0.0 {
                    operator.row(band, i, row);
                    row.iter_mut().zip(guide).for_each(|(v, guide)| *v = *v * guide / expected[i]);
                }
            };
            AliasRows::new(n, n, row).map_err(EstimatorError::Propagation)
        });
        let steps = steps.collect::<Result<_, _>>()?;
        let tables = Self {
            propagation: system.transport().propagation().clone(),
            etendue: system.etendue().into(),
            albedo: system.transport().scattering().values().clone(),
            source: source.clone(),
            guide: guide.clone(),
            expected,
            is_adjoint,
            steps,
        };
        (0..n_bands).try_for_each(|band| tables.check(system, band))?;
        Ok(tables)
    }

    /// The guide must be above zero wherever one more bounce finds something, and walks must reach an end from there.
    fn check(&self, system: &System, band: usize) -> Result<(), EstimatorError> {
        let [source, guide, expected, albedo] =
            [&self.source, &self.guide, &self.expected, &self.albedo].map(|block| block.column(band));
        let n = guide.len();
        if let Some(bundle) = (0..n).find(|i| expected[*i] > 0.0 && guide[*i] == 0.0) {
            return Err(EstimatorError::GuideMisses { bundle, band });
        }

        // Search back from where walks end: i steps to j if G, the albedo between them and the guide of j are above zero.
        let mut ends: Vec<bool> = source.iter().map(|b| *b > 0.0).collect();
        let mut frontier: Vec<usize> = (0..n).filter(|i| ends[*i]).collect();
        while let Some(j) = frontier.pop() {
            system.exchange().for_each_in_row(j, |i, exchange| {
                let reflects = if self.is_adjoint { albedo[j] } else { albedo[i] };
                if exchange > 0.0 && reflects > 0.0 && guide[j] > 0.0 && !ends[i] {
                    ends[i] = true;
                    frontier.push(i);
                }
            });
        }
        match (0..n).find(|i| expected[*i] > 0.0 && !ends[*i]) {
            None => Ok(()),
            Some(bundle) => Err(EstimatorError::NeverEnds { bundle }),
        }
    }

    /// Starts ∝ μ |W| c, band by band.
    fn starts(&self, weights: &Block) -> Result<Vec<Starts>, crate::sampling::AliasError> {
        let n = weights.n_rows();
        let value = |i: usize, band: usize| weights.get(i, band) * self.expected.get(i, band);
        let of_band = |band| Starts::new(&Block::from_fn(n, 1, |i, _| value(i, band)), &self.etendue);
        (0..weights.n_columns()).map(of_band).collect()
    }

    /// One walk of one band; counts its steps and gives its score.
    #[inline]
    fn walk(&self, start: usize, band: usize, stream: &mut Stream, n_steps: &mut u64) -> f64 {
        let (guide, expected) = (self.guide.column(band), self.expected.column(band));
        let (mut bundle, mut weight) = (start, 1.0);
        while let Some(next) = self.steps[band].sample(bundle, stream.uniform()) {
            weight *= expected[bundle] / guide[next];
            bundle = next;
            *n_steps += 1;
        }
        weight * expected[bundle]
    }
}

impl Estimator for GuidedWalk {
    fn name(&self) -> &'static str {
        match self.kind {
            Kind::Gathering => "guided-walk",
            Kind::Measuring => "guided-measurement",
            Kind::Shooting => "guided-shooting",
        }
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        if self.kind == Kind::Gathering { self.tables.guide.n_rows() } else { self.starts.len() }
    }

    fn n_columns(&self) -> usize {
        self.tables.guide.n_columns()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        let mut n_steps = 0;
        for band in 0..self.n_columns() {
            let value = match self.starts.get(start) {
                // Of a start drawn by |W| c, c is taken out again.
                Some(starts) => {
                    let bundle = starts[band].draw(stream);
                    let weight: f64 = starts[band].weights(bundle).sum();
                    weight / self.tables.expected.get(bundle, band)
                        * self.tables.walk(bundle, band, stream, &mut n_steps)
                }
                None => self.tables.walk(start, band, stream, &mut n_steps),
            };
            score.add(start, band, value);
        }
        score.count_steps(n_steps);
    }
}
