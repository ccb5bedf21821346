//! Positive verdicts: not "no difference was found" but "the difference is below the margin".
//!
//! Two one-sided tests (Schuirmann 1987) refute that the difference is above the margin and that it is below its negative. What is
//! claimed then is wrong with probability alpha at most, and too few samples make it harder to claim, not easier.

use super::power::fewest_samples;
use super::{
    Moments, PowerError, WelchError, normal_critical, normal_tail, student_critical, student_tail, welch_error,
};
use serde::Serialize;

/// The outcome of the tests.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Equivalence {
    /// What should be nearly zero.
    pub difference: f64,
    pub standard_error: f64,
    /// Infinite where the standard error is known.
    pub n_degrees_of_freedom: f64,
    /// What the difference must stay below, unsigned.
    pub margin: f64,
    /// Probability of a difference at least this small, were the true one at the margin. Small means equal.
    pub p_value: f64,
}

impl Equivalence {
    /// p_value ≤ alpha: the two are equal within the margin. False where anything is not a number.
    pub fn holds(&self, alpha: f64) -> bool {
        self.p_value <= alpha
    }

    /// The smallest margin that would hold at this level: |difference| + t_α · standard error. Of a relative margin, to first order
    /// in the reference's own error.
    pub fn smallest_margin(&self, alpha: f64) -> f64 {
        self.difference.abs() + student_critical(alpha, self.n_degrees_of_freedom) * self.standard_error
    }
}

/// Tests whether a difference with this standard error is within ± margin.
///
/// Exact for a normal difference whose standard error is known (infinite degrees of freedom) or is an independent χ² with these
/// degrees of freedom; asymptotic otherwise, as the z and t tests are. The two tests need no correction for being two (Berger
/// 1982). A margin that is not above zero never holds. Nor does one that is not a number.
pub fn equivalence_test(difference: f64, standard_error: f64, n_degrees_of_freedom: f64, margin: f64) -> Equivalence {
    let t = slack(margin - difference.abs(), standard_error);
    let p_value = student_tail(t, n_degrees_of_freedom);
    Equivalence { difference, standard_error, n_degrees_of_freedom, margin, p_value }
}

/// Tests whether the means of two independent samples differ by less than the margin, with Welch's degrees of freedom.
pub fn equivalence_of_means(a: &Moments, b: &Moments, margin: f64) -> Equivalence {
    let WelchError { standard_error, n_degrees_of_freedom } = welch_error(a, b);
    equivalence_test(a.mean() - b.mean(), standard_error, n_degrees_of_freedom, margin)
}

/// Tests whether a value is within (1 ± margin) times a reference, both with their variances, independent of each other, and
/// normal.
///
/// By Fieller's argument (1954): value − (1 − margin) · reference is normal with variance v + (1 − margin)² v_ref and must be
/// above zero, (1 + margin) · reference − value likewise. Exact, and no quotient is ever taken as normal; for a negative reference
/// the signs turn over. `difference` is value/reference − 1 and `standard_error` that of the delta method, for show.
pub fn relative_equivalence(
    [value, variance]: [f64; 2],
    [reference, reference_variance]: [f64; 2],
    margin: f64,
) -> Equivalence {
    let sign = reference.signum();
    let one_sided = |factor: f64, direction: f64| {
        let distance = direction * sign * (factor * reference - value);
        slack(distance, (variance + factor * factor * reference_variance).sqrt())
    };
    let t = [one_sided(1.0 - margin, -1.0), one_sided(1.0 + margin, 1.0)];
    let p_value = if t.iter().any(|t| t.is_nan()) { f64::NAN } else { normal_tail(t[0].min(t[1])) };
    let ratio = value / reference;
    let standard_error = (variance + ratio * ratio * reference_variance).sqrt() / reference.abs();
    Equivalence { difference: ratio - 1.0, standard_error, n_degrees_of_freedom: f64::INFINITY, margin, p_value }
}

/// Probability that [`equivalence_test`] will hold at level alpha, before there is a sample: for a normal difference of known
/// standard error and this true value.
pub fn equivalence_power(true_difference: f64, standard_error: f64, margin: f64, alpha: f64) -> f64 {
    let room = margin - normal_critical(alpha) * standard_error;
    if room <= 0.0 {
        return 0.0;
    }
    let [above, below] = [room - true_difference, -room - true_difference].map(|edge| edge / standard_error);
    // From whichever side the two tails do not cancel.
    if below > 0.0 { normal_tail(below) - normal_tail(above) } else { normal_tail(-above) - normal_tail(-below) }
}

/// Samples that [`equivalence_test`] needs to hold with probability `power`, for numbers of this variance and true difference.
///
/// # Errors
/// A true difference that is not within the margin, probabilities outside (0, 1), a variance that is negative or not finite.
pub fn equivalence_samples(
    true_difference: f64,
    variance: f64,
    margin: f64,
    alpha: f64,
    power: f64,
) -> Result<u64, PowerError> {
    let is_within = true_difference.abs() < margin;
    if !is_within {
        return Err(PowerError::OutsideMargin { difference: true_difference, margin });
    }
    fewest_samples(variance, alpha, power, |error| equivalence_power(true_difference, error, margin, alpha))
}

/// How many standard errors there are to the edge; an exact number on the edge or beyond it is infinitely far beyond.
fn slack(distance: f64, standard_error: f64) -> f64 {
    if standard_error == 0.0 && distance <= 0.0 { f64::NEG_INFINITY } else { distance / standard_error }
}
