//! Small conservative systems, eliminated without subtracting and solved as a constant and what differs from it.
//!
//! ```text
//! C = diag(loss) + diag(F 1) − F,      (C x)ᵢ = lossᵢ xᵢ + Σⱼ Fᵢⱼ (xᵢ − xⱼ)
//! ```
//!
//! with flows F ≥ 0 (the diagonal does not matter) and losses ≥ 0. Elimination keeps both ≥ 0 and never subtracts, so every number of the
//! factors is right to some ulp, however small the losses (Grassmann, Taksar and Heyman 1985). The answer of a system that loses little
//! is nearly a large constant; kept apart, it does not eat the digits of the rest:
//!
//! ```text
//! x = β 1 + d,      dₖ = (qₖ − β lossₖ + Σ_{j>k} Fₖⱼ dⱼ) / (lossₖ + Σ_{j>k} Fₖⱼ),      d = 0 at the last
//! ```

use super::{Dense, FactorError, LinearOperator};

/// C as eliminated. Cost ⅓ n³ multiplications.
#[derive(Clone, Debug)]
pub struct LossFactor {
    /// Above the diagonal what flows on, below it what was multiplied with.
    flows: Dense,
    loss: Vec<f64>,
    /// lossₖ + Σ_{j>k} Fₖⱼ; zero for an unknown that has nothing to do with any other.
    total: Vec<f64>,
    /// The unknown that is eliminated last, changed with number n − 1.
    last: usize,
}

impl LossFactor {
    /// From F, whose diagonal is not read, and the losses.
    ///
    /// # Errors
    /// [`FactorError::Singular`] where unknowns exchange among themselves and lose nothing, [`FactorError::NotFinite`].
    pub fn new(mut flows: Dense, mut loss: Vec<f64>) -> Result<Self, FactorError> {
        let n = loss.len();
        if let Some(k) = flows.values().iter().position(|v| !v.is_finite()) {
            return Err(FactorError::NotFinite { row: k / n, column: k % n, value: flows.values()[k] });
        }
        if let Some(k) = loss.iter().position(|v| !v.is_finite()) {
            return Err(FactorError::NotFinite { row: k, column: k, value: loss[k] });
        }

        // Leave for last what gives out most.
        let given = |i: usize| (0..n).filter(|j| *j != i).map(|j| flows.get(i, j)).sum::<f64>() + loss[i];
        let last = (0..n).max_by(|a, b| given(*a).total_cmp(&given(*b))).unwrap_or(0);
        if n > 0 {
            exchange(&mut flows, last, n - 1);
            loss.swap(last, n - 1);
        }

        // Give what flows through each unknown to those that it flows between.
        let mut total = vec![0.0; n];
        for k in 0..n {
            let (above, below) = flows.values_mut().split_at_mut((k + 1) * n);
            let pivot = &above[k * n..];
            total[k] = loss[k] + pivot[k + 1..].iter().sum::<f64>();
            let is_alone = total[k] == 0.0 && below.chunks(n).all(|row| row[k] == 0.0);
            if (total[k] <= 0.0 && !is_alone) || total[k].is_nan() {
                return Err(FactorError::Singular { pivot: k, size: n, value: total[k] });
            }
            if is_alone && k + 1 == n {
                return Err(FactorError::Singular { pivot: k, size: n, value: 0.0 });
            }
            for (row, loss_i) in below.chunks_mut(n).zip(k + 1..) {
                if row[k] != 0.0 {
                    let share = row[k] / total[k];
                    row[k] = share;
                    row[k + 1..].iter_mut().zip(&pivot[k + 1..]).for_each(|(f, p)| *f += share * p);
                    loss[loss_i] += share * loss[k];
                }
            }
        }
        Ok(Self { flows, loss, total, last })
    }

    pub fn n_unknowns(&self) -> usize {
        self.loss.len()
    }

    /// q ← d of C (β 1 + d) = q, and β. Cost n².
    pub fn solve(&self, q: &mut [f64]) -> f64 {
        let n = q.len();
        if n == 0 {
            return 0.0;
        }
        q.swap(self.last, n - 1);
        for i in 1..n {
            q[i] += self.flows.row_slice(i)[..i].iter().zip(q.iter()).map(|(share, q)| share * q).sum::<f64>();
        }
        let constant = q[n - 1] / self.total[n - 1];
        q[n - 1] = 0.0;
        for k in (0..n - 1).rev() {
            let row = &self.flows.row_slice(k)[k + 1..];
            let gathered: f64 = row.iter().zip(&q[k + 1..]).map(|(f, d)| f * d).sum();
            let right = q[k] - constant * self.loss[k] + gathered;
            // Give an unknown that is alone no part in anything.
            q[k] = if self.total[k] == 0.0 { 0.0 } else { right / self.total[k] };
        }
        q.swap(self.last, n - 1);
        constant
    }
}

/// Changes the places of two unknowns.
fn exchange(matrix: &mut Dense, a: usize, b: usize) {
    let n = matrix.n_columns();
    for row in matrix.values_mut().chunks_mut(n) {
        row.swap(a, b);
    }
    for column in 0..n {
        matrix.values_mut().swap(a * n + column, b * n + column);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three unknowns that lose 1e-15 of what they exchange: the answer to q = (1, 0, 0) is known in closed form, for C⁻¹ = by hand.
    #[test]
    fn what_is_nearly_conserved_keeps_its_digits() {
        // Chain 0 — 1 — 2 with flows 1, loss e at 2 only: x₂ = 1/e, x₁ = x₂ + 1, x₀ = x₁ + 1.
        let loss = 1e-15;
        let flows = Dense::from_fn(3, 3, |r, c| if r.abs_diff(c) == 1 { 1.0 } else { 0.0 });
        let factor = LossFactor::new(flows, vec![0.0, 0.0, loss]).unwrap_or_else(|error| panic!("{error}"));
        let mut q = [1.0, 0.0, 0.0];
        let constant = factor.solve(&mut q);
        // A few ulp each, of the constant and of the rest.
        assert!(((constant + q[2]) * loss - 1.0).abs() < 1e-15, "{constant:e}");
        assert!((q[0] - q[2] - 2.0).abs() < 1e-15 && (q[1] - q[2] - 1.0).abs() < 1e-15, "{q:?}");
    }

    #[test]
    fn what_loses_nothing_is_singular_and_what_is_alone_is_left_out() {
        let flows = Dense::from_fn(3, 3, |r, c| if r != c && r + c == 1 { 1.0 } else { 0.0 });
        assert!(matches!(LossFactor::new(flows.clone(), vec![0.0; 3]), Err(FactorError::Singular { .. })));
        let factor = LossFactor::new(flows, vec![0.0, 0.5, 0.0]).unwrap_or_else(|error| panic!("{error}"));
        let mut q = [1.0, 0.0, 0.0];
        let constant = factor.solve(&mut q);
        assert_eq!([q[0] + constant, q[1] + constant], [3.0, 2.0]);
    }
}
