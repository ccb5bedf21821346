//! Moments of shooting walks, bundle by bundle: the adjoint systems.
//!
//! A bundle t hears of a particle only when it arrives there, with power w in place of 1: its score is w Y with Y what unit power that has
//! just arrived at t scores in t from then on. With Hₘ the step from arrival to arrival, σₘ the m-th powers of what is born as
//! it first arrives, and A and B what t scores where the particle ends and where it goes on,
//!
//! ```text
//! E[Xᵐ]ₜ = sₘ ρₘ,      s = σₘ + Hₘᵀ s,      σₘ = Gᵀ (q wᵐ)      solved as s = M x, x = G M⁻¹ q wᵐ + (M⁻¹ Hₘᵀ M) x
//! ρₘ = (1 − p) Aᵐ + p Bᵐ + Σ over 0 < k < m of (m over k) Bᵐ⁻ᵏ ((I − Hₖ)⁻¹ₜₜ − 1) ρₖ,      ρ = E[Yᵐ] less what starts anew
//! ```
//!
//! The diagonal of (I − Hₖ)⁻¹ is how often the k-th power comes back. It takes n right-hand sides a band, for k = 1 (variances) or
//! k = 1, 2, 3 (fourth moments), and is not wanted where only last events score. Cost: a solve a moment, and a solve of n right-hand sides a
//! band and diagonal, with n² numbers held. Source: Sbert 1997; Bekaert 1999, §4.3.

use super::super::shooting::ShootingWalk;
use super::kernel::Kernel;
use super::{Law, OracleError, Order, Prediction};
use crate::estimator::Bounces;
use crate::linalg::{Block, Equation, LinearOperator};

/// One band of a family of matrices, as a grey one.
struct OneBand<'a> {
    kernel: &'a Kernel<'a>,
    law: &'a Law<'a>,
    left: Block,
    band: usize,
}

impl ShootingWalk {
    /// What the error bars of every bundle will be. `solve` answers x = b + H x, n unknowns: with one right-hand side a band, and where a
    /// diagonal is wanted with n of a grey H. It is not called where every bounce is scored alone.
    ///
    /// # Errors
    /// Those of `solve`; bounces up to a last one, added up, are not predicted.
    pub fn predict<E>(
        &self,
        order: Order,
        mut solve: impl FnMut(Equation<'_>) -> Result<Block, E>,
    ) -> Result<Prediction, OracleError<E>> {
        let law = self.law();
        let (n, n_bands, n_powers) = (law.n_bundles(), law.n_bands(), order.n_moments() + 1);
        match self.bounces() {
            Bounces::All => {
                let mut local = Vec::new();
                let mut raw = Vec::with_capacity(n_powers);
                for power in 1..=n_powers as i32 {
                    let adjoint = Kernel::adjoint(&law, power as usize);
                    let born = self.first_arrivals(&law, power);
                    let arrived = solve(Equation::plain(&adjoint, &born)).map_err(OracleError::Solve)?;
                    let at_visit = local_moment(&law, power as usize, &local);
                    raw.push(self.weighed(&arrived, &at_visit));
                    // What comes back counts towards all higher moments, unless only last events score.
                    if (power as usize) < n_powers {
                        let returns = returns(&law, &Kernel::new(&law, power as usize), &mut solve)?;
                        local.push(times(&returns, &at_visit));
                    }
                }
                Ok(Prediction::from_raw(&raw, &self.chain.emission))
            }
            Bounces::Each(last) => {
                let mut columns = vec![vec![Block::zeros(n, n_bands); n_powers]];
                let mut arrived: Vec<Block> =
                    (1..=n_powers as i32).map(|power| self.first_arrivals(&law, power)).collect();
                let adjoints: Vec<Kernel<'_>> = (1..=n_powers).map(|power| Kernel::adjoint(&law, power)).collect();
                let none = vec![Block::zeros(n, n_bands); n_powers];
                for _ in 0..last {
                    let scored = |k: usize| self.weighed(&arrived[k], &local_moment(&law, k + 1, &none[..k]));
                    columns.push((0..n_powers).map(scored).collect());
                    for (arrived, adjoint) in arrived.iter_mut().zip(&adjoints) {
                        let mut next = Block::zeros(n, n_bands);
                        adjoint.apply(arrived, &mut next);
                        *arrived = next;
                    }
                }
                let join = |k: usize| {
                    Block::from_fn(n, n_bands * columns.len(), |i, c| columns[c / n_bands][k].get(i, c % n_bands))
                };
                let raw: Vec<Block> = (0..n_powers).map(join).collect();
                Ok(Prediction::from_raw(&raw, &self.known))
            }
            Bounces::UpTo(last) => Err(OracleError::PartialSum { last }),
        }
    }

    /// G M⁻¹ q wᵐ, n × bands.
    fn first_arrivals(&self, law: &Law<'_>, power: i32) -> Block {
        let (probabilities, etendue) = (self.births.probabilities(), &self.chain.etendue);
        let weights: Vec<Vec<f64>> = (0..law.n_bands()).map(|band| self.births.weights_of(band)).collect();
        let of = |i: usize, band: usize| probabilities[i] / etendue[i] * weights[band][i].powi(power);
        let born = Block::from_fn(law.n_bundles(), law.n_bands(), of);
        let mut arrived = Block::zeros(law.n_bundles(), law.n_bands());
        law.propagation.apply(&born, &mut arrived);
        arrived
    }

    /// M x ρ, entry by entry.
    fn weighed(&self, x: &Block, local: &Block) -> Block {
        Block::from_fn(x.n_rows(), x.n_columns(), |i, c| self.chain.etendue[i] * x.get(i, c) * local.get(i, c))
    }
}

/// ρₘ, from what lower powers bring back; n × bands.
fn local_moment(law: &Law<'_>, power: usize, returned: &[Block]) -> Block {
    Block::from_fn(law.n_bundles(), law.n_bands(), |i, band| {
        let (ending, last, other) = (law.ending.get(i, band), law.at_last.get(i, band), law.at_other.get(i, band));
        let once = ending * last.powi(power as i32) + (1.0 - ending) * other.powi(power as i32);
        let mut sum = once;
        let mut choose = 1.0;
        for (k, returned) in (1..power).zip(returned) {
            choose *= (power - k + 1) as f64 / k as f64;
            sum += choose * other.powi((power - k) as i32) * returned.get(i, band);
        }
        sum
    })
}

/// (I − H)⁻¹ₜₜ − 1, n × bands; zeros where no visit but the last scores.
fn returns<E>(
    law: &Law<'_>,
    kernel: &Kernel<'_>,
    solve: &mut impl FnMut(Equation<'_>) -> Result<Block, E>,
) -> Result<Block, OracleError<E>> {
    let (n, n_bands) = (law.n_bundles(), law.n_bands());
    let mut returns = Block::zeros(n, n_bands);
    for band in 0..n_bands {
        if law.at_other.column(band).iter().all(|b| *b == 0.0) {
            continue;
        }
        // Columns of H, so that nothing is subtracted: (I − H)⁻¹ H = (I − H)⁻¹ − I.
        let mut columns = Block::zeros(n, n);
        (0..n).for_each(|j| kernel.column(band, j, columns.column_mut(j)));
        let grey = OneBand { kernel, law, left: kernel.left_of(band), band };
        let solved = solve(Equation::plain(&grey, &columns)).map_err(OracleError::Solve)?;
        (0..n).for_each(|t| returns.set(t, band, solved.get(t, t)));
    }
    Ok(returns)
}

/// Entry by entry.
fn times(a: &Block, b: &Block) -> Block {
    let mut product = a.clone();
    product.values_mut().iter_mut().zip(b.values()).for_each(|(a, b)| *a *= b);
    product
}

impl Prediction {
    /// From raw moments of what is sampled, and what is known besides.
    fn from_raw(raw: &[Block], known: &Block) -> Self {
        let each = |value: &dyn Fn(&[f64]) -> f64| {
            Block::from_fn(known.n_rows(), known.n_columns(), |i, c| {
                let moments: Vec<f64> = raw.iter().map(|moment| moment.get(i, c)).collect();
                value(&moments)
            })
        };
        let mut mean = raw[0].clone();
        mean.add_scaled(1.0, known);
        let has_higher = raw.len() >= 4;
        Self {
            mean,
            variance: each(&|m| (m[1] - m[0] * m[0]).max(0.0)),
            third: has_higher.then(|| each(&|m| m[2] - 3.0 * m[0] * m[1] + 2.0 * m[0].powi(3))),
            fourth: has_higher.then(|| {
                each(&|m| (m[3] - 4.0 * m[0] * m[2] + 6.0 * m[0] * m[0] * m[1] - 3.0 * m[0].powi(4)).max(0.0))
            }),
        }
    }
}

impl LinearOperator for OneBand<'_> {
    fn n_rows(&self) -> usize {
        self.kernel.n_rows()
    }

    fn n_columns(&self) -> usize {
        self.kernel.n_columns()
    }

    fn n_bands(&self) -> usize {
        1
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        self.law.propagation.apply(x, y);
        (0..y.n_columns()).for_each(|c| scale(y.column_mut(c), self.left.values()));
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        let mut scaled = x.clone();
        (0..x.n_columns()).for_each(|c| scale(scaled.column_mut(c), self.left.values()));
        self.law.propagation.apply_transpose(&scaled, y);
    }

    fn row(&self, _: usize, row: usize, out: &mut [f64]) {
        self.kernel.row(self.band, row, out);
    }

    fn column(&self, _: usize, column: usize, out: &mut [f64]) {
        self.kernel.column(self.band, column, out);
    }

    fn is_nonnegative(&self) -> bool {
        self.kernel.is_nonnegative()
    }

    fn n_entries(&self) -> u64 {
        self.kernel.n_entries()
    }
}

fn scale(values: &mut [f64], factors: &[f64]) {
    values.iter_mut().zip(factors).for_each(|(v, f)| *v *= f);
}
