//! Moments about the mean: from what is ahead of a walk to the walk itself, one step or all of them.

use super::existence;
use super::kernel::Kernel;
use super::{Law, OracleError, Order};
use crate::linalg::{Block, Equation, LinearOperator};
use rayon::prelude::*;

/// Mean and moments about it, n × bands each.
#[derive(Clone, Debug)]
pub struct Central {
    pub mean: Block,
    /// V, T and F, as many as wanted.
    pub moments: Vec<Block>,
}

/// What a walk scores on the bundle it stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visit {
    Scores,
    IsSilent,
}

impl Order {
    /// Moments about the mean.
    pub fn n_moments(self) -> usize {
        match self {
            Self::Variance => 1,
            Self::Fourth => 3,
        }
    }
}

impl Central {
    /// Of a score that is always zero.
    pub fn nothing(n: usize, n_bands: usize, order: Order) -> Self {
        let zeros = Block::zeros(n, n_bands);
        Self { mean: zeros.clone(), moments: vec![zeros; order.n_moments()] }
    }

    /// Of a walk that has `next` ahead of it, after its step. Two products a moment.
    pub fn before(law: &Law<'_>, visit: Visit, next: &Self) -> Self {
        // The mean first: what is scored here and K times what is ahead.
        let mut mean = Block::zeros(law.n_bundles(), law.n_bands());
        Kernel::new(law, 1).apply(&next.mean, &mut mean);
        if visit == Visit::Scores {
            mean.add_scaled(1.0, &law.expected_score());
        }
        let moments = (0..next.moments.len()).map(|k| {
            let mut moment = Block::zeros(law.n_bundles(), law.n_bands());
            Kernel::new(law, k + 2).apply(&next.moments[k], &mut moment);
            moment.add_scaled(1.0, &source(law, visit, &mean, &next.mean, &next.moments[..k]));
            moment
        });
        let moments = moments.collect();
        Self { mean, moments }
    }

    /// Of a walk that scores every visit, and has the like of itself ahead, whose mean is known.
    pub fn stationary<E>(
        law: &Law<'_>,
        mean: Block,
        order: Order,
        mut solve: impl FnMut(Equation<'_>) -> Result<Block, E>,
    ) -> Result<Self, OracleError<E>> {
        let mut moments = Vec::with_capacity(order.n_moments());
        for k in 0..order.n_moments() {
            let kernel = Kernel::new(law, k + 2);
            if !law.never_grows {
                existence::check(&kernel, k + 2)?;
            }
            let source = source(law, Visit::Scores, &mean, &mean, &moments);
            moments.push(solve(Equation::plain(&kernel, &source)).map_err(OracleError::Solve)?);
        }
        Ok(Self { mean, moments })
    }
}

/// What one step adds to the moment of order 2 + `lower.len()`, n × bands; `lower` are the lower moments of what is ahead.
fn source(law: &Law<'_>, visit: Visit, mean: &Block, next: &Block, lower: &[Block]) -> Block {
    let (n, n_bands) = (law.n_bundles(), law.n_bands());
    let scored = |block: &Block, i: usize, band: usize| if visit == Visit::Scores { block.get(i, band) } else { 0.0 };
    let power = lower.len() as i32 + 2;
    let rows: Vec<Vec<f64>> = (0..n)
        .into_par_iter()
        .map_init(
            || vec![0.0; n],
            |row, i| {
                law.propagation.row(0, i, row);
                let of_band = |band: usize| {
                    let (here, ending) = (mean.get(i, band), law.ending.get(i, band));
                    let (r, o) = (law.row.get(i, band), law.gain.get(i, band));
                    let stay = scored(&law.at_other, i, band) - here;
                    let (mut sum, mut gone) = (0.0, 0.0);
                    for (j, geometry) in row.iter().enumerate().filter(|(_, geometry)| **geometry > 0.0) {
                        let (d, e) = law.guide(j, band);
                        let (probability, weight) = (r * geometry * d, o * e);
                        if probability == 0.0 {
                            continue;
                        }
                        let off = stay + weight * next.get(j, band);
                        let square = weight * weight;
                        let lower = |k: usize| lower[k].get(j, band);
                        gone += probability;
                        sum += probability
                            * match power {
                                2 => off * off,
                                3 => off * (off * off + 3.0 * square * lower(0)),
                                _ => {
                                    off * (off * (off * off + 6.0 * square * lower(0))
                                        + 4.0 * square * weight * lower(1))
                                }
                            };
                    }
                    let left = if law.may_leave { (1.0 - ending - gone).max(0.0) } else { 0.0 };
                    sum + ending * (scored(&law.at_last, i, band) - here).powi(power) + left * stay.powi(power)
                };
                (0..n_bands).map(of_band).collect()
            },
        )
        .collect();
    Block::from_fn(n, n_bands, |i, band| rows[i][band])
}
