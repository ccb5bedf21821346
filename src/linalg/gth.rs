//! Elimination without subtraction: the factorization of an M-matrix from its off-diagonal entries and its row sums.
//!
//! ```text
//! I − K = (I − F) (D − U),      dₚ = aₚ + Σ_{j>p} Kₚⱼ,      Kᵢⱼ ← Kᵢⱼ + Kᵢₚ Kₚⱼ / dₚ,      aᵢ ← aᵢ + Kᵢₚ aₚ / dₚ
//! ```
//!
//! with K ≥ 0 and a = (I − K) 1 ≥ 0 given. Every number is a sum, a product or a quotient of numbers that are not negative, so every entry
//! of the factors is right to some n ulp *of itself*, however little is absorbed. Source: Grassmann, Taksar and Heyman (1985); its
//! errors, O'Cinneide (1993); for M-matrices with given row sums, Alfa, Xue and Ye (2002).

use super::factor::check_finite;
use super::{Block, Dense, FactorError, Factorization, LinearOperator};
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Pivots that are eliminated before the rest of the matrix hears of them.
const PANEL: usize = 32;

/// Parts that a product is split into, on any number of threads.
const DEGREE: usize = 4;

/// Sums of a dot product that run side by side.
const LANES: usize = 8;

/// I − K = (I − F) (D − U): F strictly below the diagonal, D on it, U strictly above.
pub struct GthFactor(Dense);

impl GthFactor {
    /// From K ≥ 0, n × n, whose diagonal is not read, and its losses a = 1 − Σⱼ Kᵢⱼ ≥ 0, n. Cost ⅔ n³; factors in place.
    ///
    /// # Errors
    /// [`FactorError::NotFinite`]; [`FactorError::Negative`] for an entry below zero, [`FactorError::Gain`] for a loss below zero;
    /// [`FactorError::Singular`] where unknowns lose nothing and feed none that do.
    pub fn new(mut transport: Dense, absorption: &[f64]) -> Result<Self, FactorError> {
        check_finite(&transport)?;
        let n = transport.n_rows();
        if let Some(k) = transport.values().iter().position(|v| *v < 0.0) {
            return Err(FactorError::Negative { row: k / n, column: k % n, value: transport.values()[k] });
        }
        if let Some(row) = absorption.iter().position(|a| a.is_nan() || *a < 0.0) {
            return Err(FactorError::Gain { row, loss: absorption[row] });
        }

        let mut losses = absorption.to_vec();
        for start in (0..n).step_by(PANEL) {
            let end = (start + PANEL).min(n);
            let (above, below) = transport.values_mut().split_at_mut(end * n);
            let (panel_losses, losses) = losses[start..].split_at_mut(end - start);
            let panel = &mut above[start * n..];
            eliminate_panel(panel, panel_losses, start, n)?;

            // Scatter the panel's columns of every row below: its factors, and what it now loses through the panel.
            below.par_chunks_mut(n).zip(losses.par_iter_mut()).for_each(|(row, loss)| {
                for p in 0..end - start {
                    let pivot = &panel[p * n..][..n];
                    let factor = row[start + p] / pivot[start + p];
                    row[start + p] = factor;
                    add_scaled(&mut row[start + p + 1..end], factor, &pivot[start + p + 1..end]);
                    *loss += factor * panel_losses[p];
                }
            });

            // And all the columns right of it in one product.
            if end < n {
                let pivots = MatRef::from_row_major_slice(panel, end - start, n).split_at_col(end).1;
                let (left, right) = MatMut::from_row_major_slice_mut(below, n - end, n).split_at_col_mut(end);
                let factors = left.as_ref().split_at_col(start).1;
                matmul(right, Accum::Add, factors, pivots, 1.0, Par::rayon(DEGREE));
            }
        }
        Ok(Self(transport))
    }

    /// x ← (I − K)⁻¹ x for every column: componentwise to some n ulp where no entry of the column is below zero; of a column with both signs
    /// the parts are solved and subtracted. Cost 2 n² a column.
    pub fn solve(&self, x: &mut Block) {
        by_parts(x, |column| self.substitute(column));
    }

    /// x ← (I − K)⁻ᵀ x for every column, likewise.
    pub fn solve_transpose(&self, x: &mut Block) {
        by_parts(x, |column| self.substitute_transposed(column));
    }

    fn substitute(&self, x: &mut [f64]) {
        for i in 1..x.len() {
            let (known, rest) = x.split_at_mut(i);
            rest[0] += dot(&self.0.row_slice(i)[..i], known);
        }
        for i in (0..x.len()).rev() {
            let row = self.0.row_slice(i);
            let (rest, known) = x.split_at_mut(i + 1);
            rest[i] = (rest[i] + dot(&row[i + 1..], known)) / row[i];
        }
    }

    fn substitute_transposed(&self, x: &mut [f64]) {
        for i in 0..x.len() {
            let row = self.0.row_slice(i);
            let (known, rest) = x.split_at_mut(i + 1);
            known[i] /= row[i];
            add_scaled(rest, known[i], &row[i + 1..]);
        }
        for i in (1..x.len()).rev() {
            let (rest, known) = x.split_at_mut(i);
            add_scaled(rest, known[0], &self.0.row_slice(i)[..i]);
        }
    }
}

impl Factorization for GthFactor {
    fn solve(&self, x: &mut Block) {
        self.solve(x);
    }

    fn solve_transpose(&self, x: &mut Block) {
        self.solve_transpose(x);
    }
}

/// Eliminates the rows of a panel, from column `start` on, among themselves: every row hears of those before it and then becomes a pivot.
fn eliminate_panel(panel: &mut [f64], losses: &mut [f64], start: usize, n: usize) -> Result<(), FactorError> {
    for p in 0..losses.len() {
        let (done, rest) = panel.split_at_mut(p * n);
        let row = &mut rest[..n];
        for (q, pivot) in done.chunks_exact(n).enumerate() {
            let factor = row[start + q] / pivot[start + q];
            row[start + q] = factor;
            add_scaled(&mut row[start + q + 1..], factor, &pivot[start + q + 1..]);
            losses[p] += factor * losses[q];
        }
        // The diagonal is what is lost and what goes to those still to come.
        let diagonal = start + p;
        row[diagonal] = losses[p] + row[diagonal + 1..].iter().sum::<f64>();
        if row[diagonal] == 0.0 || !row[diagonal].is_finite() {
            return Err(FactorError::Singular { pivot: diagonal, size: n, value: row[diagonal] });
        }
    }
    Ok(())
}

/// Solves every column, those with both signs in two parts.
fn by_parts(x: &mut Block, solve: impl Fn(&mut [f64])) {
    for c in 0..x.n_columns() {
        let column = x.column_mut(c);
        if column.iter().all(|v| *v >= 0.0) {
            solve(column);
            continue;
        }
        // What is not a number stays so.
        let mut negative: Vec<f64> = column.iter().map(|v| if *v < 0.0 { -v } else { 0.0 }).collect();
        column.iter_mut().filter(|v| **v < 0.0).for_each(|v| *v = 0.0);
        solve(column);
        solve(&mut negative);
        column.iter_mut().zip(&negative).for_each(|(v, negative)| *v -= negative);
    }
}

fn add_scaled(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_tail), (b, b_tail)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    sums.iter().sum::<f64>() + a_tail.iter().zip(b_tail).map(|(a, b)| a * b).sum::<f64>()
}
