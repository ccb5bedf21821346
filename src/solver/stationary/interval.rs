//! Where the eigenvalues of I − A lie, from a few Lanczos steps.
//!
//! ```text
//! [1 − θ₊, 1 − θ₋ + β],      θ± the outermost Ritz values of A = S^½ G S^½ and β the norm of the next Lanczos vector
//! ```
//!
//! No eigenvalue is thought above the upper end (Zhou and Li 2011); some may lie between 0 and the lower one, which slows what rests on it
//! but does not make it diverge. One product a step, for all bands at once.

use crate::linalg::{Block, Dense, Equation, symmetric_eigenvalues};
use crate::solver::SolveError;
use crate::solver::monitor::Monitor;
use crate::solver::self_adjoint::{CHECK, checked_form};

/// Lanczos steps.
const STEPS: usize = 12;

/// Holds the eigenvalues of I − A of one band, and 1.
#[derive(Clone, Copy)]
pub(super) struct Interval {
    pub low: f64,
    pub high: f64,
}

/// Coefficients of one band's Lanczos vectors.
#[derive(Default)]
struct Tridiagonal {
    diagonal: Vec<f64>,
    beside: Vec<f64>,
}

/// The interval of every band. Checks that G is self-adjoint: two products more.
pub(super) fn measure(
    method: &'static str,
    equation: Equation<'_>,
    monitor: &mut Monitor<'_>,
) -> Result<Vec<Interval>, SolveError> {
    let form = checked_form(method, equation)?;
    monitor.count_applies(CHECK);
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());

    // Begin with a vector that leans towards uniform light and has a share in everything.
    let mut v = Block::from_fn(n, n_bands, |i, _| 1.0 + 0.5 * (1.618_033_988_749_895 * (i as f64 + 1.0)).sin());
    let zeros = || Block::zeros(n, n_bands);
    let (mut before, mut image, mut direction, mut scratch) = (zeros(), zeros(), zeros(), zeros());
    let mut coefficients: Vec<Tridiagonal> = (0..n_bands).map(|_| Tridiagonal::default()).collect();
    for band in 0..n_bands {
        let norm = form.inner(v.column(band), v.column(band)).sqrt();
        v.column_mut(band).iter_mut().for_each(|v| *v /= norm);
    }
    for _ in 0..STEPS.min(n) {
        form.apply(&v, &mut scratch, &mut direction, &mut image);
        monitor.count_applies(1);
        for (band, t) in coefficients.iter_mut().enumerate() {
            let (v, before, next) = (v.column_mut(band), before.column_mut(band), image.column(band));
            let alpha = form.inner(v, next);
            let beta = t.beside.last().copied().unwrap_or(0.0);
            before.iter_mut().zip(&*v).zip(next).for_each(|((b, v), a)| *b = a - alpha * v - beta * *b);
            before.swap_with_slice(v);
            let norm = form.inner(v, v).sqrt();
            t.diagonal.push(alpha);
            t.beside.push(norm);
            // A space that is exhausted adds nothing.
            let inverse = if norm > f64::EPSILON { 1.0 / norm } else { 0.0 };
            v.iter_mut().for_each(|v| *v *= inverse);
        }
    }
    coefficients.iter().enumerate().map(|(band, t)| t.interval(method, band)).collect()
}

impl Tridiagonal {
    fn interval(&self, method: &'static str, band: usize) -> Result<Interval, SolveError> {
        // Steps after the space was exhausted are no steps.
        let exhausted = self.beside.iter().position(|beta| *beta <= f64::EPSILON);
        let k = exhausted.map_or(self.diagonal.len(), |last| last + 1);
        let entry = |r: usize, c: usize| match r.abs_diff(c) {
            0 => self.diagonal[r],
            1 => self.beside[r.min(c)],
            _ => 0.0,
        };
        let matrix = Dense::from_fn(k, k, entry);
        if matrix.values().iter().any(|v| !v.is_finite()) {
            return Err(SolveError::NotFinite { method, iteration: 0 });
        }
        let ritz = symmetric_eigenvalues(&matrix);
        let (largest, smallest) = (ritz.first().copied().unwrap_or(0.0), ritz.last().copied().unwrap_or(0.0));
        let curvature = 1.0 - largest;
        if curvature <= 0.0 {
            return Err(SolveError::NotPositiveDefinite { method, band, iteration: 0, curvature });
        }
        let beyond = self.beside.get(k.wrapping_sub(1)).copied().unwrap_or(0.0);
        Ok(Interval { low: curvature.min(1.0), high: (1.0 - smallest + beyond).max(1.0) })
    }
}
