//! Convergence curves drawn before a method has run: from the leading eigenvalues of K.
//!
//! ```text
//! L − Lₖ = Kᵏ (I − K)⁻¹ K E ≈ Σᵢ ⟨xᵢ, K E⟩ λᵢᵏ / (1 − λᵢ) xᵢ
//! ```
//!
//! for the Neumann series; for methods on polynomials what the polynomial leaves of the interval that the eigenvalues span, and for the
//! accelerated ones what their projection leaves of K, both from the first iterate on. See [`prediction`].

use super::outcome::SolverRun;
use crate::assembly::System;
use crate::linalg::{Block, LinearOperator, max_abs};
use crate::solver::spectrum::{Eigen, Eigenpair, Spectrum, leading_eigenpairs, prediction};
use crate::solver::{SolveError, Solver, TwoGrid};

/// Pairs enough for the outliers that a few rooms give K, found as well as a line in a figure asks.
const PAIRS: Eigen = Eigen { n_pairs: 12, tolerance: 1e-8, dimension: 44, n_products: 400 };

/// Products to measure what two-grid takes off.
const FACTOR_PRODUCTS: usize = 24;

/// Methods with a theory here.
const METHODS: [&str; 7] = ["neumann", "jacobi", "richardson", "chebyshev", "cg", "minres", "perron"];

/// What the spectrum of one system says of the methods that will answer it.
pub(super) struct Foretold {
    bands: Vec<Band>,
    /// Of two-grid, the slowest band; 1 if it was not measured.
    two_grid: f64,
    /// max |L|.
    scale: f64,
}

/// One band.
struct Band {
    /// λᵢ, largest magnitude first.
    values: Vec<f64>,
    vectors: Vec<Vec<f64>>,
    /// ⟨xᵢ, K E⟩ / (1 − λᵢ).
    parts: Vec<f64>,
}

impl Foretold {
    /// Of the system whose answer is `truth`, of which only the size is used. Nothing is foretold where K has no self-adjoint form, nor
    /// computed for methods without a theory here. At most some 400 products.
    ///
    /// # Errors
    /// Products that are not finite.
    pub fn of(system: &System, truth: &Block, methods: &[Box<dyn Solver>]) -> Result<Self, SolveError> {
        let is_asked = |names: &[&str]| methods.iter().any(|method| names.contains(&method.name()));
        let equation = system.equation();
        let mut foretold = Self { bands: Vec::new(), two_grid: 1.0, scale: truth.max_abs() };
        if is_asked(&["two-grid"]) {
            let factors = TwoGrid { tolerance: 1.0, n_groups: None }.factor(equation, FACTOR_PRODUCTS)?;
            foretold.two_grid = factors.into_iter().fold(0.0, f64::max);
        }
        if is_asked(&METHODS) {
            let n_pairs = PAIRS.n_pairs.min(system.n_bundles());
            let dimension = PAIRS.dimension.min(system.n_bundles());
            let spectrum = leading_eigenpairs(equation, Eigen { n_pairs, dimension, ..PAIRS })?;
            let mut bounce = Block::zeros(system.n_bundles(), system.n_bands());
            system.transport().apply(system.emission(), &mut bounce);
            foretold.bands = Band::all(&spectrum, &bounce);
        }
        Ok(foretold)
    }

    /// Sets what was foretold beside every point of a history.
    pub fn write_into(&self, run: &mut SolverRun) {
        let n = run.history.len();
        let Some(first) = run.history.first().map(|point| point.error) else { return };
        let from_first = |curve: Vec<f64>| curve.into_iter().map(|left| first * left).collect();
        let curve: Vec<f64> = match run.solver.as_str() {
            "two-grid" if self.two_grid < 1.0 => from_first(prediction::geometric(self.two_grid, n)),
            _ if self.bands.is_empty() => return,
            "neumann" | "jacobi" => self.neumann(n),
            "richardson" => from_first(prediction::geometric(self.worst(Band::richardson), n)),
            "chebyshev" => from_first(self.slowest(n, |band| prediction::cg_bound(band.low(), band.high(), n))),
            "cg" | "minres" => from_first(self.slowest(n, |band| band.conjugate_gradients(n))),
            "perron" => from_first(prediction::geometric(self.worst(Band::second), n)),
            _ => return,
        };
        for (point, predicted) in run.history.iter_mut().zip(curve) {
            point.predicted = Some(predicted);
        }
    }

    /// ‖L − Lₖ‖∞ / ‖L‖∞ for k = 0 … n − 1, every band's share in one maximum.
    fn neumann(&self, n: usize) -> Vec<f64> {
        let mut parts: Vec<Vec<f64>> = self.bands.iter().map(|band| band.parts.clone()).collect();
        let mut curve = Vec::with_capacity(n);
        for _ in 0..n {
            let mut worst = 0.0_f64;
            for (band, parts) in self.bands.iter().zip(&mut parts) {
                let mut left = vec![0.0; band.vectors.first().map_or(0, Vec::len)];
                for ((part, x), value) in parts.iter_mut().zip(&band.vectors).zip(&band.values) {
                    left.iter_mut().zip(x).for_each(|(left, x)| *left += *part * x);
                    *part *= value;
                }
                worst = worst.max(max_abs(&left));
            }
            curve.push(worst / self.scale);
        }
        curve
    }

    fn worst(&self, of_band: impl Fn(&Band) -> f64) -> f64 {
        self.bands.iter().map(of_band).fold(0.0, f64::max)
    }

    fn slowest(&self, n: usize, of_band: impl Fn(&Band) -> Vec<f64>) -> Vec<f64> {
        let mut slowest = vec![0.0_f64; n];
        for band in &self.bands {
            slowest.iter_mut().zip(of_band(band)).for_each(|(slowest, left)| *slowest = slowest.max(left));
        }
        slowest
    }
}

impl Band {
    /// Every band of a spectrum with a self-adjoint form; none of another.
    fn all(spectrum: &Spectrum, bounce: &Block) -> Vec<Self> {
        let Some(weights) = &spectrum.weights else { return Vec::new() };
        let band = |(b, pairs): (usize, &Vec<Eigenpair>)| {
            let share = |x: &[f64]| {
                let terms = weights.column(b).iter().zip(x).zip(bounce.column(b));
                terms.map(|((w, x), e)| w * x * e).sum::<f64>()
            };
            Self {
                values: pairs.iter().map(|pair| pair.re).collect(),
                parts: pairs.iter().map(|pair| share(&pair.vector_re) / (1.0 - pair.re)).collect(),
                vectors: pairs.iter().map(|pair| pair.vector_re.clone()).collect(),
            }
        };
        spectrum.bands.iter().enumerate().map(band).collect()
    }

    fn low(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::min)
    }

    fn high(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }

    /// What the best damping takes off: (κ − 1)/(κ + 1).
    fn richardson(&self) -> f64 {
        let (low, high) = (self.low(), self.high());
        (high - low) / (2.0 - high - low)
    }

    /// |λ₂|: what is left of K without its Perron mode.
    fn second(&self) -> f64 {
        self.values.get(1).map_or(0.0, |value| value.abs())
    }

    fn conjugate_gradients(&self, n: usize) -> Vec<f64> {
        // Magnitudes beyond the last pair found are no larger than it.
        let rest = self.values.last().map_or(0.0, |value| value.abs());
        let mut outliers: Vec<f64> = self.values.iter().copied().filter(|value| *value > rest).collect();
        outliers.sort_by(|a, b| b.total_cmp(a));
        prediction::cg_bound_beyond(self.low().min(-rest), rest, &outliers, n)
    }
}
