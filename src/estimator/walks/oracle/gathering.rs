//! Moments of gathering walks, bundle by bundle, bounce by bounce and measurement by measurement.

use super::super::{MatrixWalk, MeasuringWalk, Scoring};
use super::recursion::{Central, Visit};
use super::{Law, OracleError, Order, Prediction};
use crate::estimator::Bounces;
use crate::linalg::{Block, Equation};

impl MatrixWalk {
    /// What the walks' error bars will be. `radiance` is the solution L for their E; `solve` answers x = b + H x, n unknowns, and is called once
    /// a moment — not at all, and the radiance is not looked at, where bounces end.
    ///
    /// # Errors
    /// Those of `solve`: every moment of these walks exists.
    pub fn predict<E>(
        &self,
        order: Order,
        radiance: &Block,
        solve: impl FnMut(Equation<'_>) -> Result<Block, E>,
    ) -> Result<Prediction, OracleError<E>> {
        let law = self.law();
        let (n, n_bands) = (law.n_bundles(), law.n_bands());
        let is_expected = self.scoring() == Scoring::ExpectedValue;
        // Expected-value walks sample what is left of E.
        let offset = is_expected.then(|| self.emission().clone());
        let nothing = Central::nothing(n, n_bands, order);
        let columns = match self.bounces() {
            Bounces::All => {
                let mut sampled = radiance.clone();
                if let Some(offset) = &offset {
                    sampled.add_scaled(-1.0, offset);
                }
                vec![Central::stationary(&law, sampled, order, solve)?.plus(offset)]
            }
            Bounces::UpTo(last) => {
                let n_visits = last + 1 - usize::from(is_expected);
                let sum = (0..n_visits).fold(nothing, |next, _| Central::before(&law, Visit::Scores, &next));
                vec![sum.plus(offset)]
            }
            Bounces::Each(last) => {
                let mut each: Vec<Central> = Vec::with_capacity(last + 1);
                each.extend(offset.map(|offset| nothing.clone().plus(Some(offset))));
                let mut walk = Central::before(&law, Visit::Scores, &nothing);
                while each.len() <= last {
                    let next = Central::before(&law, Visit::IsSilent, &walk);
                    each.push(std::mem::replace(&mut walk, next));
                }
                each
            }
        };
        Ok(Prediction::side_by_side(columns))
    }

    fn law(&self) -> Law<'_> {
        Law::of_chain(&self.chain, self.scores())
    }
}

impl MeasuringWalk {
    /// What the error bars of the measurements will be; otherwise as [`MatrixWalk::predict`]. One solve serves all measurements.
    ///
    /// # Errors
    /// Those of `solve`.
    pub fn predict<E>(
        &self,
        order: Order,
        radiance: &Block,
        solve: impl FnMut(Equation<'_>) -> Result<Block, E>,
    ) -> Result<Prediction, OracleError<E>> {
        let of_walks = self.walk.predict(order, radiance, solve)?;
        let n_bands = self.walk.chain.n_bands;
        Ok(of_walks.begun_at(self.starts.len(), |m, c| {
            (self.starts[m].probabilities(), self.starts[m].weights_of(c % n_bands))
        }))
    }
}

impl Central {
    /// Of the same score and something that is not random.
    fn plus(mut self, known: Option<Block>) -> Self {
        if let Some(known) = known {
            self.mean.add_scaled(1.0, &known);
        }
        self
    }
}

impl Prediction {
    /// One block of columns after another.
    pub(super) fn side_by_side(parts: Vec<Central>) -> Self {
        let n_moments = parts.first().map_or(0, |part| part.moments.len());
        let join = |of: &dyn Fn(&Central) -> &Block| {
            let (n, n_bands) = (of(&parts[0]).n_rows(), of(&parts[0]).n_columns());
            Block::from_fn(n, n_bands * parts.len(), |i, c| of(&parts[c / n_bands]).get(i, c % n_bands))
        };
        let moment = |k: usize| (k < n_moments).then(|| join(&|part: &Central| &part.moments[k]));
        Self {
            mean: join(&|part: &Central| &part.mean),
            variance: join(&|part: &Central| &part.moments[0]),
            third: moment(1),
            fourth: moment(2),
        }
    }

    /// Of walks that begin on a random bundle with a weight: `starts(row, column)` gives the probabilities and weights of one row.
    pub(super) fn begun_at(&self, n_rows: usize, starts: impl Fn(usize, usize) -> (Vec<f64>, Vec<f64>)) -> Self {
        let n_columns = self.mean.n_columns();
        let row = |m: usize| (0..n_columns).map(|c| self.mixed(&starts(m, c), c)).collect();
        let rows: Vec<Vec<[f64; 4]>> = (0..n_rows).map(row).collect();
        let moment = |k: usize| Block::from_fn(n_rows, n_columns, |m, c| rows[m][c][k]);
        Self {
            mean: moment(0),
            variance: moment(1),
            third: self.third.as_ref().map(|_| moment(2)),
            fourth: self.fourth.as_ref().map(|_| moment(3)),
        }
    }

    /// Mean and moments about it of w X with the bundle drawn by q.
    fn mixed(&self, (q, w): &(Vec<f64>, Vec<f64>), c: usize) -> [f64; 4] {
        let drawn = || q.iter().zip(w).enumerate().filter(|(_, (q, _))| **q > 0.0);
        let mean = drawn().map(|(i, (q, w))| q * w * self.mean.get(i, c)).sum();
        let of = |block: Option<&Block>, i: usize| block.map_or(0.0, |block| block.get(i, c));
        let mut sums = [mean, 0.0, 0.0, 0.0];
        for (i, (q, w)) in drawn() {
            let (off, square) = (w * self.mean.get(i, c) - mean, w * w);
            let variance = square * self.variance.get(i, c);
            let third = square * w * of(self.third.as_ref(), i);
            let fourth = square * square * of(self.fourth.as_ref(), i);
            sums[1] += q * (off * off + variance);
            sums[2] += q * (off * (off * off + 3.0 * variance) + third);
            sums[3] += q * (off * (off * (off * off + 6.0 * variance) + 4.0 * third) + fourth);
        }
        sums
    }
}
