//! Conjugate gradients with a coarse space deflated, preconditioned by what is strong and near.
//!
//! ```text
//! z = r + N r + N² r + N³ r,      p ← z + β p − P C⁻¹ (Pᵀ W − (K P)ᵀ W) z
//! ```
//!
//! N holds the strong entries of K, those between patches that share an edge; every residual stays orthogonal to the coarse space.
//!
//! in the inner product ⟨a, b⟩ = Σ wᵢ aᵢ bᵢ in which K is self-adjoint: w = μ/s for radiance, μ s for importance, s the diagonal of S.
//! Unknowns without scattering have no part in it: they emit, or gather, and send nothing back.
//!
//! Needs the self-adjoint form with S diagonal, and ρ(K) < 1; checks both. Every entry of K is read once to set up, which gives K P,
//! the first bounce and two probes of the symmetry; then one product an iteration, a pass over the n × m matrix K P and three over N, all counted. What is left to
//! converge is the spectrum of K beside the coarse space, which knows nothing of the albedo: for absorption 1e-12 as fast as for ½.
//! Source: Nicolaides (1987); Saad, Yeung, Erhel and Guyomarc'h (2000), algorithm 3.6.

use super::super::monitor::Monitor;
use super::super::report::{band_residual, relative_residual};
use super::super::self_adjoint::{PROBES, check_probes, probe};
use super::super::{Attempt, Observer, SolveError, Solver};
use super::coarse::{self, Coarse, Wanted};
use super::shifted::Shifted;
use super::two_grid::level;
use crate::linalg::{Block, Equation, max_abs};

/// A residual whose share in the coarse space is below this is orthogonal to it.
const ORTHOGONAL: f64 = 1e-6;

/// Coarse corrections to begin with at most: where the coarse answer is the answer, rounding is all that the first leaves.
const STARTS: usize = 3;

/// Iterates until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeflatedCg {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// Most groups that the coarse space may have; by default n^⅔, whose elimination costs a third of a product.
    pub n_groups: Option<usize>,
}

impl Solver for DeflatedCg {
    fn name(&self) -> &'static str {
        "deflated-cg"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let method = self.name();
        let mut monitor = Monitor::new(method, equation, self.tolerance, observer);
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let form = equation.self_adjoint.ok_or(SolveError::NoSelfAdjointForm { method })?;
        let weights = coarse::weights(form, n_bands).ok_or(SolveError::NoSelfAdjointForm { method })?;

        // Read K once: the coarse equation, the first bounce, two probes of the symmetry.
        let aggregation = level(equation, self.n_groups);
        let probes = PROBES.map(|frequency| {
            let wave = |i: usize, band: usize| if weights.get(i, band) > 0.0 { probe(frequency, i) } else { 0.0 };
            Block::from_fn(n, n_bands, wave)
        });
        let mut images: [Block; 3] = std::array::from_fn(|_| Block::zeros(n, n_bands));
        let sources = [equation.emission, &probes[0], &probes[1]];
        let mut coarse =
            Coarse::new(method, equation, aggregation, Wanted::Factor, weights.clone(), &sources, &mut images)?;
        monitor.work.products += coarse.setup_work();
        let [mut r, kx, ky] = images;
        check_symmetry(method, &coarse, &probes, [&kx, &ky])?;

        // Start from the coarse answer.
        let mut field = Shifted::at(equation.emission);
        let mut gathered = vec![0.0; coarse.n_groups()];
        let mut spread = gathered.clone();
        for _ in 0..STARTS {
            let mut is_orthogonal = true;
            for band in 0..n_bands {
                coarse.gather(band, r.column(band), &mut gathered);
                let constant = coarse.solve(band, &mut gathered);
                field.constants[band] += constant;
                coarse.prolong(band, &gathered, field.rest.column_mut(band));
                coarse.correct(band, constant, &gathered, r.column_mut(band));
                settle(coarse.weight(band), field.rest.column_mut(band), r.column_mut(band));
                coarse.gather(band, r.column(band), &mut gathered);
                let whole: f64 = coarse.weight(band).iter().zip(r.column(band)).map(|(w, r)| w * r.abs()).sum();
                is_orthogonal &= max_abs(&gathered) <= ORTHOGONAL * whole;
            }
            monitor.work.products += coarse.pass_work();
            if is_orthogonal {
                break;
            }
        }

        let (mut p, mut image) = (Block::zeros(n, n_bands), Block::zeros(n, n_bands));
        let (mut z, mut scratch) = (Block::zeros(n, n_bands), vec![0.0; n]);
        for band in 0..n_bands {
            coarse.near(band).apply(r.column(band), &mut scratch, z.column_mut(band));
        }
        let mut radiance = equation.emission.clone();
        // ⟨r, z⟩ now and at the last step.
        let mut norms: Vec<[f64; 2]> =
            (0..n_bands).map(|band| [inner(&coarse, band, r.column(band), z.column(band)), 0.0]).collect();
        let stop = loop {
            field.write(&coarse, None, &mut radiance);
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &r), &radiance)? {
                break stop;
            }

            // Turn the direction conjugate to the last, and to the coarse space.
            for (band, [norm, last]) in norms.iter().copied().enumerate() {
                let turn = if last > 0.0 { norm / last } else { 0.0 };
                coarse.gather(band, z.column(band), &mut gathered);
                coarse.gather_spread(band, z.column(band), &mut spread);
                gathered.iter_mut().zip(&spread).for_each(|(q, b)| *q = b - *q);
                let constant = coarse.solve(band, &mut gathered);
                p.column_mut(band).iter_mut().zip(z.column(band)).for_each(|(p, r)| *p = r + turn * *p);
                coarse.prolong(band, &gathered, p.column_mut(band));
                coarse.prolong_constant(band, constant, p.column_mut(band));
            }
            monitor.work.products += coarse.pass_work() + coarse.near_work();

            // image = (I − K) p.
            equation.transport.apply(&p, &mut image);
            monitor.count_applies(1);
            image.values_mut().iter_mut().zip(p.values()).for_each(|(a, p)| *a = p - *a);

            for (band, [norm, last]) in norms.iter_mut().enumerate() {
                // A band that is done rests: its numbers would only sink into the denormals.
                if *norm < f64::MIN_POSITIVE || band_residual(equation.emission, &r, band) <= self.tolerance {
                    continue;
                }
                let curvature = inner(&coarse, band, p.column(band), image.column(band));
                let iteration = monitor.work.n_iterations;
                if !curvature.is_finite() {
                    return Err(SolveError::NotFinite { method, iteration });
                }
                if curvature <= 0.0 {
                    return Err(SolveError::NotPositiveDefinite { method, band, iteration, curvature });
                }
                let step = *norm / curvature;
                add_scaled(field.rest.column_mut(band), step, p.column(band));
                add_scaled(r.column_mut(band), -step, image.column(band));
                settle(coarse.weight(band), field.rest.column_mut(band), r.column_mut(band));
                *last = *norm;
                coarse.near(band).apply(r.column(band), &mut scratch, z.column_mut(band));
                *norm = inner(&coarse, band, r.column(band), z.column(band));
            }
        };
        Ok(Attempt::ended(field.doubled(&coarse, None), stop, monitor))
    }
}

/// ⟨a, b⟩ = Σ wᵢ aᵢ bᵢ.
fn inner(coarse: &Coarse, band: usize, a: &[f64], b: &[f64]) -> f64 {
    coarse.weight(band).iter().zip(a).zip(b).map(|((w, a), b)| w * a * b).sum()
}

/// Gives unknowns that send nothing back what they lack at once: nobody else hears of it.
fn settle(weight: &[f64], radiance: &mut [f64], residual: &mut [f64]) {
    for ((w, l), r) in weight.iter().zip(radiance).zip(residual) {
        if *w == 0.0 {
            *l += std::mem::take(r);
        }
    }
}

fn add_scaled(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
}

/// ⟨x, K y⟩ = ⟨K x, y⟩ of every band, where x and y are zero on what is left out.
fn check_symmetry(
    method: &'static str,
    coarse: &Coarse,
    [x, y]: &[Block; 2],
    [kx, ky]: [&Block; 2],
) -> Result<(), SolveError> {
    (0..x.n_columns()).try_for_each(|band| {
        let product = |a: &[f64], b: &[f64]| inner(coarse, band, a, b);
        let [x, y, kx, ky] = [x, y, kx, ky].map(|block| block.column(band));
        check_probes(method, product, [x, kx], [y, ky])
    })
}
