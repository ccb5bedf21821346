//! Where a sequence of finer and finer polygons is heading, and how far from there it still is.
//!
//! What is computed at step h runs as v(h) = v + Σ cₖ h^pₖ + noise, with powers known from the kind of approximation. Through the last values one
//! interpolant of the first powers is laid (Richardson's extrapolation), for every number of them. What an extrapolation changes when its
//! levels move one coarser is an error it has had; so is what one power less changes, and what doubt about the powers changes.

use super::error::CaseError;
use crate::linalg::{Block, Dense, LuFactor};

/// Polygons inscribed into smooth curves, sums of constants over equal cells, central differences.
pub const EVEN: &[f64] = &[2.0, 4.0, 6.0, 8.0, 10.0];

/// As [`EVEN`], where values at points see the cells around them, or neighbours meet at an angle that closes as they shrink.
pub const EVERY: &[f64] = &[2.0, 3.0, 4.0, 5.0, 6.0];

/// Where planes of shrinking facets begin to cut what they see: from there on it grows with the power 5/2, and steps h in that sum to h^{7/2}.
pub const HORIZON: &[f64] = &[2.0, 3.5, 4.0, 4.5, 5.5];

/// Shapes on which every level has the limit's value.
pub const CONSTANT: &[f64] = &[];

/// Ends that recede.
pub const LINEAR: &[f64] = &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// A limit and the error that is estimated for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    pub value: f64,
    pub error: f64,
}

/// The change that coarser levels make is at least the error that is left times (ratio of steps)^power − 1, some one half: twice that, and as
/// much again for sequences that are not quite even.
const SAFETY: f64 = 4.0;

/// One power more improves an extrapolation by no more than this: a change that is smaller still is luck.
const SUDDEN: f64 = 0.05;

/// One level more improves an estimate by no more than this: steps in the ratio 2/3 and five even powers.
const FASTEST: f64 = 50.0;

/// A level on which values are known worse than this helps no limit: it is what passes at most.
const WORST: f64 = super::answer::EXTRAPOLATED;

/// Fewer levels may agree by luck.
const FEWEST: usize = 5;

/// How values are refined: the numbers of levels in turn (the step is 1 / level), the powers of the step that the error has, and the
/// error at which it ends.
#[derive(Clone, Copy, Debug)]
pub struct Refinement<'a> {
    pub levels: &'a [usize],
    pub powers: &'a [f64],
    pub enough: f64,
}

/// Extrapolates values at these steps, falling, to step 0. `noise` is the absolute error of each value itself.
///
/// One value is its own limit, of unknown error. Cost O(levels⁴).
pub fn extrapolate(steps: &[f64], values: &[f64], powers: &[f64], noise: &[f64]) -> Limit {
    if powers.is_empty() {
        return agreed(values, noise);
    }
    let best_of = |n: usize| best_of(&steps[..n], &values[..n], powers, &noise[..n]);
    let mut limit = best_of(1.min(values.len()));
    for n in 2..=values.len() {
        let next = best_of(n);
        // What a level changes is an error that the one before has had, whatever it estimated; and it does not help more than it can.
        let error = match n > 3 {
            true => next.error.max((next.value - limit.value).abs()).max(limit.error / FASTEST),
            false => next.error,
        };
        limit = Limit { error, ..next };
    }
    limit
}

/// The value with the least noise of those that should agree, doubted by the next one.
fn agreed(values: &[f64], noise: &[f64]) -> Limit {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|i, j| noise[*i].total_cmp(&noise[*j]));
    match order[..] {
        [first, second, ..] => {
            Limit { value: values[first], error: noise[first] + SAFETY * (values[first] - values[second]).abs() }
        }
        _ => Limit { value: values.first().copied().unwrap_or(f64::NAN), error: f64::INFINITY },
    }
}

/// The extrapolation of the least estimated error among all numbers of powers.
fn best_of(steps: &[f64], values: &[f64], powers: &[f64], noise: &[f64]) -> Limit {
    let n = values.len();
    let last = values.last().copied().unwrap_or(f64::NAN);
    let mut best = Limit { value: last, error: f64::INFINITY };
    for n_powers in 1..n.min(powers.len() + 1) {
        let through = |end: usize, powers: &[f64]| {
            let first = end - powers.len() - 1;
            interpolated(&steps[first..end], &values[first..end], powers, &noise[first..end])
        };
        let (value, noise) = through(n, &powers[..n_powers]);
        let less = (value - through(n, &powers[..n_powers - 1]).0).abs();
        // A power that is doubted takes the place of the highest.
        let mut doubted = powers[..n_powers].to_vec();
        doubted[n_powers - 1] = if n_powers == 1 { powers[0] } else { powers[n_powers - 2] + 0.5 };
        let doubt = (value - through(n, &doubted).0).abs();
        let change = match n > n_powers + 1 {
            true => (value - through(n - 1, &powers[..n_powers]).0).abs().max(SUDDEN * less).max(doubt),
            // No level is left to doubt it with.
            false => less,
        };
        let error = SAFETY * change + noise;
        if error < best.error {
            best = Limit { value, error };
        }
    }
    best
}

/// The limit of the interpolant with the powers 0 and these, and the error that it has from the values'; NaN where the steps do not determine
/// it.
fn interpolated(steps: &[f64], values: &[f64], powers: &[f64], noise: &[f64]) -> (f64, f64) {
    let n = values.len();
    // The weights solve Σᵢ wᵢ hᵢ^p = [p = 0].
    let power = |k: usize| if k == 0 { 0.0 } else { powers[k - 1] };
    let matrix = Dense::from_fn(n, n, |k, i| (steps[i] / steps[0]).powf(power(k)));
    let mut weights = Block::from_fn(n, 1, |k, _| if k == 0 { 1.0 } else { 0.0 });
    let Ok(factor) = LuFactor::new(&matrix) else { return (f64::NAN, f64::NAN) };
    factor.solve(&mut weights);
    // Sum differences to the last value: weights of both signs then cost no digits of it.
    let last = values[n - 1];
    let sum: f64 = weights.column(0).iter().zip(values).map(|(w, v)| w * (v - last)).sum();
    (last + sum, weights.column(0).iter().zip(noise).map(|(w, noise)| w.abs() * noise).sum())
}

/// Computes lists of values at finer and finer levels, each list with the absolute error of its values, and extrapolates each of them, until
/// all of their errors are small enough or levels are at their end.
///
/// # Errors
/// What `compute` returns.
pub fn refine(
    refinement: Refinement,
    mut compute: impl FnMut(usize) -> Result<(Vec<f64>, f64), CaseError>,
) -> Result<Vec<Limit>, CaseError> {
    let Refinement { levels, powers, enough } = refinement;
    let fewest = if powers.is_empty() { 2 } else { FEWEST };
    let (mut steps, mut table): (Vec<f64>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let mut noise = Vec::new();
    let mut limits = Vec::new();
    for level in levels {
        let (values, error) = compute(*level)?;
        // What is laid through a level that is badly known is no better: leave it out, unless there is nothing else.
        let is_last = *level == levels[levels.len() - 1];
        if error > WORST && !(is_last && table.is_empty()) {
            continue;
        }
        noise.push(error);
        steps.push(1.0 / *level as f64);
        table.push(values);
        let limit = |k: usize| {
            let column: Vec<f64> = table.iter().map(|row| row[k]).collect();
            let rounding = 4.0 * f64::EPSILON * column.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let noise: Vec<f64> = noise.iter().map(|noise: &f64| noise.max(rounding)).collect();
            extrapolate(&steps, &column, powers, &noise)
        };
        limits = (0..table[0].len()).map(limit).collect();
        // A few levels say too little to end at.
        if table.len() >= fewest && limits.iter().all(|limit: &Limit| limit.error <= enough) {
            break;
        }
    }
    Ok(limits)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: [f64; 6] = [1.0, 0.5, 1.0 / 3.0, 0.25, 1.0 / 6.0, 0.125];

    #[test]
    fn sums_of_the_known_powers_are_extrapolated_exactly() {
        let smooth = STEPS.map(|h: f64| 3.0 + h.powi(2) - 2.0 * h.powi(4));
        let limit = extrapolate(&STEPS, &smooth, EVEN, &[1e-15; 6]);
        // Rounding of values near 3, amplified some ten times; the estimate improves by no more than a level can, from the first's 1.
        let levels_that_help = (STEPS.len() - 3) as i32;
        assert!((limit.value - 3.0).abs() < 1e-13, "{limit:?}");
        assert!(limit.error < SAFETY * FASTEST.powi(-levels_that_help), "{limit:?}");
    }

    /// Errors with powers that were not foreseen, and with other coefficients: the estimate contains every one of them. Where the error
    /// itself falls more slowly than was foreseen it contains half of it, which is why powers are listed by kind of approximation.
    #[test]
    fn estimates_contain_the_error_of_other_powers_too() {
        for powers in [EVEN, EVERY, HORIZON] {
            for (a, b, p, q) in
                [(1.0, 0.3, 2.0, 3.0), (1.0, -2.0, 2.0, 3.5), (0.5, 1.0, 1.5, 2.5), (1.0, 1.0, 1.8, 4.0)]
            {
                let rough = STEPS.map(|h: f64| 3.0 + a * h.powf(p) + b * h.powf(q));
                let limit = extrapolate(&STEPS, &rough, powers, &[0.0; 6]);
                let share = if p < powers[0] { 0.5 } else { 1.0 };
                assert!(share * (limit.value - 3.0).abs() <= limit.error, "{powers:?} {p} {q}: {limit:?}");
            }
        }
    }

    #[test]
    fn values_that_should_agree_are_as_good_as_the_best_of_them() {
        let limit = extrapolate(&STEPS[..3], &[2.5, 2.25, 2.5], CONSTANT, &[1e-9, 0.25, 1e-3]);
        assert_eq!(limit, Limit { value: 2.5, error: 1e-9 });
    }

    /// A level that is badly known spoils only what is laid through it.
    #[test]
    fn noise_counts_where_it_is() {
        let smooth = STEPS.map(|h: f64| 3.0 + h.powi(2));
        let clean = extrapolate(&STEPS, &smooth, EVEN, &[1e-12; 6]);
        let coarse = extrapolate(&STEPS, &smooth, EVEN, &[1e-2, 1e-12, 1e-12, 1e-12, 1e-12, 1e-12]);
        let fine = extrapolate(&STEPS, &smooth, EVEN, &[1e-12, 1e-12, 1e-12, 1e-12, 1e-12, 1e-2]);
        // The first of six is passed by the fifth on, each of which helps as much as a level may.
        let passed = SAFETY * 1e-2 / FASTEST.powi(4);
        assert!(clean.error < 1e-10 && coarse.error < passed && fine.error > 1e-2, "{clean:?} {coarse:?} {fine:?}");
    }

    #[test]
    fn one_value_has_no_known_error_and_refinement_ends_when_it_is_enough() {
        assert_eq!(extrapolate(&[1.0], &[2.0], EVEN, &[0.0]).error, f64::INFINITY);
        assert_eq!(extrapolate(&[1.0], &[2.0], CONSTANT, &[0.0]).error, f64::INFINITY);
        let mut n_levels = 0;
        let refinement = Refinement { levels: &[1, 2, 3, 4, 6, 8, 12], powers: EVEN, enough: 1e-3 };
        let limits = refine(refinement, |n| {
            n_levels += 1;
            Ok((vec![1.0 + 1.0 / (n * n) as f64], 0.0))
        });
        assert!(limits.is_ok_and(|limits| (limits[0].value - 1.0).abs() < 1e-12));
        assert_eq!(n_levels, FEWEST);
    }
}
