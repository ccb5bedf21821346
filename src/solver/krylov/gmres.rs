//! Generalised minimal residuals, restarted.
//!
//! ```text
//! Lₖ = L₀ + Zₖ yₖ,      Zₖ = P⁻¹ Vₖ,      (I − K) Zₖ = Vₖ₊₁ Hₖ,      yₖ = argmin ‖r₀ − (I − K) Zₖ y‖
//! ```
//!
//! Needs I − K to have an inverse, and nothing of symmetry. The residual never rises in the étendue norm (the plain one where there is no
//! étendue). One product an iteration and those of the preconditioner, and one a restart; room for m + 1 blocks, twice as many with a
//! preconditioner. Every iterate is formed, which costs as much again as the orthogonalisation: k n a band in iteration k. The flexible
//! form is the same loop with a preconditioner that may change between iterations. Source: Saad and Schultz (1986); Saad (1993); the
//! recurrence of the residual, Saad (2003), eq. 6.48.

use super::inner::{Inner, add_scaled, one_minus_transport, set_scaled};
use super::preconditioner::Preconditioner;
use crate::linalg::{Block, Equation, Residual};
use crate::solver::monitor::Monitor;
use crate::solver::report::{band_residual, relative_residual};
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// GMRES(m), preconditioned from the right.
#[derive(Clone, Copy)]
pub struct Gmres<'p> {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// m, the iterations between restarts.
    pub restart: usize,
    pub preconditioner: Option<&'p dyn Preconditioner>,
}

/// Flexible GMRES(m): the preconditioner may depend on what it is applied to.
#[derive(Clone, Copy)]
pub struct FlexibleGmres<'p> {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// m, the iterations between restarts.
    pub restart: usize,
    pub preconditioner: &'p dyn Preconditioner,
}

impl Solver for Gmres<'_> {
    fn name(&self) -> &'static str {
        if self.preconditioner.is_some() { "preconditioned-gmres" } else { "gmres" }
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        minimise(self.name(), equation, self.tolerance, self.restart, self.preconditioner, monitor)
    }
}

impl Solver for FlexibleGmres<'_> {
    fn name(&self) -> &'static str {
        "fgmres"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        minimise(self.name(), equation, self.tolerance, self.restart, Some(self.preconditioner), monitor)
    }
}

/// The loop behind every method of this family, in the name of one of them.
pub(in crate::solver) fn minimise<'a>(
    method: &'static str,
    equation: Equation<'a>,
    tolerance: f64,
    restart: usize,
    preconditioner: Option<&dyn Preconditioner>,
    mut monitor: Monitor<'_>,
) -> Result<Attempt<'a>, SolveError> {
    let prepare = |p: &dyn Preconditioner| p.prepare(method, equation, &mut monitor.work);
    let mut prepared = preconditioner.map(prepare).transpose()?;
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    let m = restart.max(1);
    let inner = Inner::of(equation);
    let zeros = || Block::zeros(n, n_bands);
    let mut basis: Vec<Block> = (0..=m).map(|_| zeros()).collect();
    let mut steps: Vec<Block> = if prepared.is_some() { (0..m).map(|_| zeros()).collect() } else { Vec::new() };
    let mut squares: Vec<LeastSquares> = (0..n_bands).map(|_| LeastSquares::new(m)).collect();
    let (mut start, mut radiance, mut r) = (equation.emission.clone(), equation.emission.clone(), zeros());
    let mut residual = Residual::new(equation);
    let mut is_done = vec![false; n_bands];

    let stop = 'restarts: loop {
        // Begin a cycle with the residual of what there is.
        start.copy_from(&radiance);
        residual.evaluate(&start, None, &mut r);
        monitor.count_applies(1);
        for (band, squares) in squares.iter_mut().enumerate() {
            let norm = inner.norm(r.column(band));
            squares.begin(norm);
            set_scaled(basis[0].column_mut(band), if norm > 0.0 { 1.0 / norm } else { 0.0 }, r.column(band));
        }
        for k in 0..m {
            // The residual of the start is the last of the cycle before.
            if (k > 0 || monitor.history.is_empty())
                && let Some(stop) = monitor.check(relative_residual(equation.emission, &r), &radiance)?
            {
                break 'restarts stop;
            }
            for (band, is_done) in is_done.iter_mut().enumerate() {
                *is_done = band_residual(equation.emission, &r, band) <= tolerance;
            }

            // The next vector: (I − K) P⁻¹ vₖ.
            let (known, rest) = basis.split_at_mut(k + 1);
            let next = &mut rest[0];
            match &mut prepared {
                Some(prepared) => {
                    prepared.apply(&known[k], &mut steps[k], &mut monitor.work);
                    one_minus_transport(equation, &steps[k], next);
                }
                None => one_minus_transport(equation, &known[k], next),
            }
            monitor.count_applies(1);

            for (band, squares) in squares.iter_mut().enumerate() {
                if is_done[band] {
                    next.column_mut(band).fill(0.0);
                    continue;
                }
                // Make it orthogonal to those before.
                let iteration = monitor.work.n_iterations;
                for (j, v) in known.iter().enumerate() {
                    let h = inner.dot(v.column(band), next.column(band));
                    add_scaled(next.column_mut(band), -h, v.column(band));
                    squares.column_mut(k)[j] = h;
                }
                let norm = inner.norm(next.column(band));
                if !norm.is_finite() {
                    return Err(SolveError::NotFinite { method, iteration });
                }
                next.column_mut(band).iter_mut().for_each(|v| *v *= if norm > 0.0 { 1.0 / norm } else { 0.0 });
                let (c, s, left) = squares.rotate(k, norm).ok_or_else(|| {
                    let residual = band_residual(equation.emission, &r, band);
                    SolveError::Breakdown { method, band, iteration, quantity: "hₖₖ", value: 0.0, residual }
                })?;

                // Form the residual and the iterate.
                let column = next.column(band);
                r.column_mut(band).iter_mut().zip(column).for_each(|(r, v)| *r = s * s * *r + c * left * v);
                let weights = squares.solve(k + 1);
                let l = radiance.column_mut(band);
                l.copy_from_slice(start.column(band));
                let directions = if steps.is_empty() { &*known } else { &steps };
                directions.iter().zip(weights).for_each(|(z, y)| add_scaled(l, *y, z.column(band)));
            }
        }
        if let Some(stop) = monitor.check(relative_residual(equation.emission, &r), &radiance)? {
            break stop;
        }
    };
    Ok(Attempt::ended(radiance, stop, monitor))
}

/// argmin ‖norm e₁ − H y‖ of one band, H turned triangular column by column.
struct LeastSquares {
    m: usize,
    /// Columns of the triangle, m + 1 entries each.
    h: Vec<f64>,
    rotations: Vec<(f64, f64)>,
    right: Vec<f64>,
    y: Vec<f64>,
}

impl LeastSquares {
    fn new(m: usize) -> Self {
        Self { m, h: vec![0.0; m * (m + 1)], rotations: vec![(1.0, 0.0); m], right: vec![0.0; m + 1], y: vec![0.0; m] }
    }

    fn begin(&mut self, norm: f64) {
        self.right.fill(0.0);
        self.right[0] = norm;
    }

    fn column_mut(&mut self, k: usize) -> &mut [f64] {
        let height = self.m + 1;
        &mut self.h[k * height..(k + 1) * height]
    }

    /// Turns column k, whose last entry is `below`, by the rotations so far and one more: its cosine, its sine and the norm that is left,
    /// with a sign. `None` where the column vanishes.
    fn rotate(&mut self, k: usize, below: f64) -> Option<(f64, f64, f64)> {
        let column = &mut self.h[k * (self.m + 1)..][..k + 2];
        column[k + 1] = below;
        for (j, (c, s)) in self.rotations[..k].iter().enumerate() {
            (column[j], column[j + 1]) = (c * column[j] + s * column[j + 1], c * column[j + 1] - s * column[j]);
        }
        let size = column[k].hypot(below);
        if size == 0.0 {
            return None;
        }
        let (c, s) = (column[k] / size, below / size);
        column[k] = size;
        self.rotations[k] = (c, s);
        self.right[k + 1] = -s * self.right[k];
        self.right[k] *= c;
        Some((c, s, self.right[k + 1]))
    }

    /// y of the first k columns.
    fn solve(&mut self, k: usize) -> &[f64] {
        for i in (0..k).rev() {
            let known: f64 = (i + 1..k).map(|j| self.h[j * (self.m + 1) + i] * self.y[j]).sum();
            self.y[i] = (self.right[i] - known) / self.h[i * (self.m + 1) + i];
        }
        &self.y[..k]
    }
}
