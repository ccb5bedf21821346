//! Is a random answer the deterministic one within a margin, everywhere? A positive verdict: it needs samples enough to be had.

use super::norm::check_shapes;
use crate::linalg::{Block, max_abs};
use crate::stats::{Equivalence, equivalence_test};
use serde::Serialize;
use std::fmt;

/// The outcome of many equivalence tests.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EquivalenceVerdict {
    /// What every entry must stay within, relative to the largest reference of its column.
    pub margin: f64,
    /// The largest p-value of any entry: probability of entries all this close, were one of them off by the margin. 1 where one is
    /// not a number.
    pub p_value: f64,
    /// Row and column of it.
    pub worst_at: (usize, usize),
    /// The smallest margin that would have held at `alpha`, likewise relative; infinite where an entry is not a number.
    pub smallest_margin: f64,
    pub n_comparisons: usize,
    /// p_value ≤ alpha: equal within the margin.
    pub holds: bool,
}

impl fmt::Display for EquivalenceVerdict {
    /// "equal within 0.1 % (p = 3.2e-7)", or what was not shown and what could be.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { margin, p_value, smallest_margin, holds, .. } = self;
        let [margin, smallest] = [margin, smallest_margin].map(|m| Percent(*m));
        if *holds {
            write!(f, "equal within {margin} (p = {p_value:.1e})")
        } else {
            write!(f, "not shown to be equal within {margin} (p = {p_value:.1e}), but within {smallest}")
        }
    }
}

/// A share in per cent, to two digits, rounded up: what is said to hold, holds.
struct Percent(f64);

impl fmt::Display for Percent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = 100.0 * self.0;
        if !(percent.is_finite() && percent > 0.0) {
            return write!(f, "{percent} %");
        }
        let digit = 10f64.powf(percent.log10().floor() - 1.0);
        // A margin given in decimals is itself, not the next step up.
        let steps = (percent / digit * (1.0 - 1e-9)).ceil();
        let n_decimals = (-digit.log10()).round().max(0.0) as usize;
        let text = format!("{:.n_decimals$}", steps * digit);
        let text = if n_decimals > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        write!(f, "{text} %")
    }
}

/// Tests whether a mean is within ± margin · max |reference of the column| of an exact reference, in every entry at once.
///
/// All entries must pass the two one-sided tests of [`stats::equivalence_test`](crate::stats::equivalence_test), each at the full
/// `alpha`: the claim is wrong with probability alpha at most, whatever their dependence, and takes no correction for their number
/// (Berger 1982). The scores are taken as normal and the variances as known, as [`compare_blocks`](super::compare_blocks) takes
/// them. Nothing to compare is nothing shown.
///
/// # Panics
/// If the shapes differ.
pub fn equivalent_blocks(
    reference: &Block,
    mean: &Block,
    variance_of_mean: &Block,
    margin: f64,
    alpha: f64,
) -> EquivalenceVerdict {
    check_shapes(reference, mean);
    check_shapes(reference, variance_of_mean);
    let n_comparisons = reference.values().len();
    let (mut p_value, mut worst_at, mut smallest_margin) = (0.0, (0, 0), 0.0);
    for column in 0..reference.n_columns() {
        let scale = max_abs(reference.column(column));
        for row in 0..reference.n_rows() {
            let difference = mean.get(row, column) - reference.get(row, column);
            let standard_error = variance_of_mean.get(row, column).sqrt();
            let test = equivalence_test(difference, standard_error, f64::INFINITY, margin * scale);
            let (p, least) = worst_case(&test, alpha, scale);
            if p > p_value {
                (p_value, worst_at) = (p, (row, column));
            }
            smallest_margin = f64::max(smallest_margin, least);
        }
    }
    let p_value = if n_comparisons == 0 { 1.0 } else { p_value };
    EquivalenceVerdict { margin, p_value, worst_at, smallest_margin, n_comparisons, holds: p_value <= alpha }
}

/// p-value and smallest relative margin, with what is not a number as never equal and 0 against 0 as equal.
fn worst_case(test: &Equivalence, alpha: f64, scale: f64) -> (f64, f64) {
    let least = test.smallest_margin(alpha);
    let relative = if least == 0.0 { 0.0 } else { least / scale };
    let p_value = if least == 0.0 && test.margin >= 0.0 { 0.0 } else { test.p_value };
    (if p_value.is_nan() { 1.0 } else { p_value }, if relative.is_nan() { f64::INFINITY } else { relative })
}
