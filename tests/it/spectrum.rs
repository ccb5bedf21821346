//! The spectrum of K: against what is known, against dense eigenvalues, and against what solvers then do.

use super::scenes;
use etendue::linalg::{Block, Dense, Equation, eigenpairs};
use etendue::solver::spectrum::{
    Eigen, TruncationBound, all_singular_values, condition, effective_rank, leading_eigenpairs,
    leading_singular_values, prediction, rank_bounds, spectral_radius,
};
use etendue::solver::{Cg, Gth, Iteration, Neumann, Solver};
use std::ops::ControlFlow;

/// Of pairs: residual, relative to the largest eigenvalue. Of self-adjoint operators eigenvalues then err by no more.
const SETTINGS: Eigen = Eigen { n_pairs: 5, tolerance: 1e-11, dimension: 24, n_products: 400 };

#[test]
fn the_furnace_has_its_albedos_for_radius() {
    // K is the albedo times a stochastic matrix; closure is kept to some 1e-14.
    let case = scenes::find("furnace-cube");
    let radius = spectral_radius(case.system.equation(), 1e-12, 50).unwrap();
    let spectrum = leading_eigenpairs(case.system.equation(), SETTINGS).unwrap();
    for (band, albedo) in [0.5, 0.75, 0.9].into_iter().enumerate() {
        let bounds = &radius.bands[band];
        assert!(bounds.low <= albedo * (1.0 + 1e-13) && albedo * (1.0 - 1e-13) <= bounds.high, "{bounds:?}");
        assert!(bounds.high - bounds.low < 1e-12);
        assert!((spectrum.bands[band][0].re - albedo).abs() < 1e-10);
    }
    // Uniform light is the Perron vector, so that one product is enough.
    assert_eq!(radius.n_applies, 1);
}

#[test]
fn two_patches_swing_between_two_eigenvalues() {
    let transport = Dense::from_fn(2, 2, |r, c| [[0.0, 0.4], [0.1, 0.0]][r][c]);
    let emission = Block::from_fn(2, 1, |_, _| 1.0);
    let equation = Equation::plain(&transport, &emission);
    let radius = spectral_radius(equation, 1e-10, 200).unwrap();
    let bounds = &radius.bands[0];
    assert!(bounds.low <= 0.2 && 0.2 <= bounds.high && bounds.high - bounds.low < 1e-9, "{bounds:?}");
    let pairs = &leading_eigenpairs(equation, Eigen { n_pairs: 2, ..SETTINGS }).unwrap().bands[0];
    let mut values = [pairs[0].re, pairs[1].re];
    values.sort_by(f64::total_cmp);
    assert!((values[0] + 0.2).abs() < 1e-14 && (values[1] - 0.2).abs() < 1e-14, "{values:?}");
    let negative = Dense::from_fn(2, 2, |r, c| [[0.0, -0.4], [0.1, 0.0]][r][c]);
    assert!(spectral_radius(Equation::plain(&negative, &emission), 1e-3, 9).is_none());
}

#[test]
fn leading_pairs_are_those_of_the_dense_matrix() {
    for name in ["cornell-box", "two-rooms"] {
        let case = scenes::find(name);
        let equation = case.system.equation();
        let plain = Equation { self_adjoint: None, ..equation };
        for equation in [equation, plain] {
            let spectrum = leading_eigenpairs(equation, SETTINGS).unwrap();
            for (band, pairs) in spectrum.bands.iter().enumerate() {
                let dense = eigenpairs(&Dense::from_operator(equation.transport, band)).unwrap();
                assert_eq!(pairs.len(), SETTINGS.n_pairs);
                for (pair, expected) in pairs.iter().zip(&dense) {
                    // K is similar to a symmetric matrix whose scaling has a condition of some 10.
                    let distance = (pair.re - expected.re).hypot(pair.im - expected.im);
                    assert!(distance < 1e-9, "{name} {band}: {} {} for {}", pair.re, pair.im, expected.re);
                }
            }
            let radius = spectral_radius(equation, 1e-6, 2000).unwrap();
            for (bounds, pairs) in radius.bands.iter().zip(&spectrum.bands) {
                assert!(bounds.low <= pairs[0].re * (1.0 + 1e-9) && pairs[0].re * (1.0 - 1e-9) <= bounds.high);
            }
        }
    }
}

#[test]
fn singular_values_are_those_of_the_dense_matrix() {
    let case = scenes::find("corner-box");
    let equation = case.system.equation();
    let leading = leading_singular_values(equation, SETTINGS).unwrap();
    let [of_transport, of_equation] = all_singular_values(equation, 0).unwrap();
    for (found, expected) in leading.bands[0].iter().zip(&of_transport) {
        // Squares err by the tolerance.
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    // All singular values exceed nothing, the first alone itself but for rounding.
    assert_eq!(effective_rank(&of_transport, 0.0), of_transport.iter().filter(|v| **v > 0.0).count());
    assert_eq!(effective_rank(&of_transport, 0.999_999), 1);
    let rank = effective_rank(&of_transport, 0.3);
    assert!(rank > 1 && rank < of_transport.len() / 2, "{rank} of {}", of_transport.len());
    // ‖(I − K)⁻¹‖ is at least 1/(1 − ρ), and no singular value is above 1 + the first of K.
    let radius = spectral_radius(equation, 1e-6, 500).unwrap().bands[0].low;
    assert!(condition(&of_equation) > (1.0 - of_transport[of_transport.len() - 1]) / (1.0 - radius) * 0.5);
    assert!(of_equation[0] <= 1.0 + of_transport[0] + 1e-12);
}

#[test]
fn the_rank_is_bounded_by_random_vectors() {
    for name in ["cornell-box", "two-rooms"] {
        let case = scenes::find(name);
        let equation = case.system.equation();
        let [values, _] = all_singular_values(equation, 1).unwrap();
        for tolerance in [0.5, 0.1, 0.02] {
            let rank = effective_rank(&values, tolerance);
            let bounds = rank_bounds(equation, 1, tolerance, 0x726b).unwrap();
            assert!(bounds.low <= rank && rank <= bounds.high, "{name} {tolerance}: {rank} {bounds:?}");
            // Singular values within a quarter of the tolerance may count or not: not many are.
            assert!(bounds.high - bounds.low <= 4 + rank / 2, "{name} {tolerance}: {rank} {bounds:?}");
            assert!(bounds.missing <= 0.3 * tolerance * values[0], "{name} {tolerance}: {bounds:?}");
        }
    }
}

#[test]
fn bounces_fall_as_foretold() {
    for name in ["corner-box", "two-rooms"] {
        let case = scenes::find(name);
        let equation = case.system.equation();
        let spectrum = leading_eigenpairs(equation, Eigen { n_pairs: 12, dimension: 40, ..SETTINGS }).unwrap();
        let answer = Neumann { tolerance: 1e-9 }.solve(equation, &mut ()).unwrap();
        let history = &answer.report.history;
        let curves: Vec<Vec<f64>> = (0..equation.n_bands())
            .map(|band| prediction::neumann(&spectrum, equation.emission, band, history.len()).unwrap())
            .collect();
        for k in history.len() / 2..history.len() {
            let foretold = curves.iter().map(|curve| curve[k]).fold(0.0, f64::max);
            // Late bounces hold only the leading eigenvectors.
            assert!((foretold / history[k] - 1.0).abs() < 1e-5, "{name} {k}: {foretold:e} {:e}", history[k]);
        }
    }
}

#[test]
fn truncation_bounds_hold_and_are_met() {
    const WANTED: f64 = 1e-6;
    let case = scenes::find("corner-box");
    let equation = case.system.equation();
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    let radius = spectral_radius(equation, 1e-4, 500).unwrap();
    let vectors = Block::from_fn(n, n_bands, |i, band| radius.bands[band].vector[i]);
    let by_vector = TruncationBound::by_vector(equation, &vectors);
    let truth = Gth.solve(equation, &mut ()).unwrap().radiance;
    // What is lacking after every bounce, by band.
    let mut lacking: Vec<Vec<f64>> = vec![Vec::new(); n_bands];
    let mut watch = |iteration: Iteration<'_>| {
        for (band, lacking) in lacking.iter_mut().enumerate() {
            let brightest = equation.emission.column(band).iter().copied().fold(0.0, f64::max);
            let pairs = truth.column(band).iter().zip(iteration.iterate.column(band));
            lacking.push(pairs.map(|(l, k)| (l - k).abs()).fold(0.0, f64::max) / brightest);
        }
        ControlFlow::Continue(())
    };
    Neumann { tolerance: 1e-9 }.solve(equation, &mut watch).unwrap();
    for band in 0..n_bands {
        let loose = TruncationBound::by_absorption(equation, band).unwrap();
        let tight = by_vector[band].unwrap();
        for bound in [loose, tight] {
            for (k, lacking) in lacking[band].iter().enumerate() {
                // The reference errs by some 1e-14 of L.
                assert!(*lacking <= bound.after(k) + 1e-13, "{k}: {lacking:e} {:e}", bound.after(k));
            }
            let needed = bound.bounces_needed(WANTED);
            assert!(bound.after(needed) <= WANTED && (needed == 0 || bound.after(needed - 1) > WANTED));
            assert!(lacking[band][needed.min(lacking[band].len() - 1)] <= WANTED);
        }
        // The Perron vector's bound is no more than a few bounces late, the albedos' far more.
        let met = lacking[band].iter().position(|lacking| *lacking <= WANTED).unwrap();
        let tight = tight.bounces_needed(WANTED);
        assert!(met <= tight && (tight as f64) < 1.25 * met as f64 + 4.0, "{met} {tight}");
        assert!(loose.bounces_needed(WANTED) > tight);
    }
}

#[test]
fn conjugate_gradients_keep_below_chebyshevs_bound() {
    let case = scenes::find("furnace-sphere");
    let mut emission = case.system.emission().clone();
    for band in 0..emission.n_columns() {
        emission.column_mut(band).iter_mut().enumerate().for_each(|(i, e)| *e *= 1.0 + (i as f64).sin());
    }
    let equation = Equation { emission: &emission, ..case.system.equation() };
    let answer = Cg { tolerance: 1e-12 }.solve(equation, &mut ()).unwrap();
    let spectrum = leading_eigenpairs(equation, SETTINGS).unwrap();
    let (low, high) = (spectrum.bands.iter().flatten())
        .fold((0.0, 0.0), |(low, high): (f64, f64), pair| (low.min(pair.re), high.max(pair.re)));
    let bound = prediction::cg_bound(low, high, answer.report.history.len());
    // The bound is on the energy norm; in the maximum norm it is late by the condition and the size of a patch.
    let slack = (1.0 - low) / (1.0 - high) * (equation.n_unknowns() as f64).sqrt();
    for (residual, bound) in answer.report.history.iter().zip(&bound) {
        assert!(*residual <= slack * bound, "{residual:e} {bound:e}");
    }
    let beyond = prediction::cg_bound_beyond(low, 0.1, &[high], 30);
    assert!(beyond.iter().zip(prediction::cg_bound(low, high, 30)).all(|(beyond, plain)| *beyond <= plain));
    assert_eq!(prediction::geometric(0.5, 4), [1.0, 0.5, 0.25, 0.125]);
}
