//! Moments of importance-sampled walks.

use super::super::guided::{GuidedWalk, Tables};
use super::recursion::Central;
use super::{Law, OracleError, Order, Prediction};
use crate::linalg::{Block, Equation};

impl GuidedWalk {
    /// What the error bars will be. `solution` is the exact L for gathering and measuring, J for shooting; `solve` answers x = b + H x and is
    /// called once a moment. Rows of H may sum above 1: the solver must not rely on less.
    ///
    /// # Errors
    /// A moment that is infinite because the guide is poor, or not known to be finite, and those of `solve`.
    pub fn predict<E>(
        &self,
        order: Order,
        solution: &Block,
        solve: impl FnMut(Equation<'_>) -> Result<Block, E>,
    ) -> Result<Prediction, OracleError<E>> {
        let law = self.tables.law();
        let walks = Prediction::side_by_side(vec![Central::stationary(&law, solution.clone(), order, solve)?]);
        if self.starts.is_empty() {
            return Ok(walks);
        }
        let weights = |starts: usize, band: usize| {
            let weights = self.starts[starts][band].weights_of(0);
            let expected = self.tables.expected.column(band);
            weights.iter().zip(expected).map(|(w, c)| if *c > 0.0 { w / c } else { 0.0 }).collect()
        };
        Ok(walks.begun_at(self.starts.len(), |starts, band| {
            (self.starts[starts][band].probabilities(), weights(starts, band))
        }))
    }
}

impl Tables {
    /// In the terms of [`Law`]: nothing is scored on the way, and c where a walk ends.
    fn law(&self) -> Law<'_> {
        let (n, n_bands) = (self.guide.n_rows(), self.guide.n_columns());
        let block = |value: &dyn Fn(usize, usize) -> f64| Block::from_fn(n, n_bands, value);
        let over_expected = |i: usize, band: usize, value: f64| {
            let c = self.expected.get(i, band);
            if c > 0.0 { value / c } else { 0.0 }
        };
        let albedo = |i: usize, band: usize| self.albedo.get(i, band);
        let guide = |j: usize, band: usize| self.guide.get(j, band);
        let reflected = |j: usize, band: usize| if self.is_adjoint { albedo(j, band) } else { 1.0 };
        Law {
            propagation: &self.propagation,
            ending: block(&|i, band| over_expected(i, band, self.source.get(i, band))),
            at_last: self.expected.clone(),
            at_other: Block::zeros(n, n_bands),
            row: block(&|i, band| over_expected(i, band, if self.is_adjoint { 1.0 } else { albedo(i, band) })),
            gain: self.expected.clone(),
            guide: Some([
                block(&|j, band| reflected(j, band) * guide(j, band)),
                block(&|j, band| if guide(j, band) > 0.0 { 1.0 / guide(j, band) } else { 0.0 }),
            ]),
            may_leave: false,
            never_grows: false,
        }
    }
}
