//! Is a random answer the deterministic one, within its own error bars, everywhere at once?

use super::norm::check_shapes;
use crate::linalg::Block;
use crate::stats::{NormalMixture, critical_z, sidak, sidak_level, two_sided_p, z_score};
use serde::Serialize;

/// What rounding may leave between two exact computations of one column, relative to its largest entry: some thousand unknowns
/// times 2⁻⁵³, the accuracy that elimination keeps on a well-conditioned I − K.
pub const ROUNDING_TOLERANCE: f64 = 1e-12;

/// The outcome of many comparisons, corrected for their number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ZVerdict {
    /// Largest |z| anywhere; infinite where two exact numbers differ or one is not a number.
    pub worst_z: f64,
    /// Row and column of the largest |z|.
    pub worst_at: (usize, usize),
    /// Entries with an error bar, whose z-scores were looked at.
    pub n_comparisons: usize,
    /// Entries without: both sides exact, compared to rounding.
    pub n_exact: usize,
    /// Probability of a |z| this large somewhere, were the two equal (Šidák).
    pub p_value: f64,
    /// The |z| that would have been too large.
    pub critical_z: f64,
    /// p_value ≥ alpha.
    pub agrees: bool,
}

/// One comparison of a mean with what it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Comparison {
    z: f64,
    /// No error bar on either side.
    is_exact: bool,
}

/// Holds a mean with error bars against an exact reference, entry by entry, at family-wise significance `alpha`.
///
/// z = (mean − reference) / √(variance_of_mean + rounding²), with rounding = [`ROUNDING_TOLERANCE`] times the largest reference of
/// the column. Entries whose variance is exactly zero are compared exactly, to that rounding; anything that is not a number
/// disagrees, the variance of fewer than two samples included.
///
/// The scores are taken as normal and the variances as known, which is asymptotic in the number n of samples behind an entry. At a
/// critical z, false alarms are more frequent than alpha by about exp(z⁴/4n) for variances being estimated, and by 1 + (γ z³)²/18n
/// for scores of skewness γ: 1.4 times measured for fifteen entries, some of which score once in four samples, at n = 512 and
/// alpha = 1e-3. For alpha = 1e-6 and thousands of entries have some thousands of samples; more where scores are rare and large,
/// see [`SCORES_A_COMPARISON`](super::SCORES_A_COMPARISON).
///
/// # Panics
/// If the shapes differ.
pub fn compare_blocks(reference: &Block, mean: &Block, variance_of_mean: &Block, alpha: f64) -> ZVerdict {
    let worst = Worst::of(reference, mean, variance_of_mean);
    worst.verdict(alpha, two_sided_p(worst.z), critical_z(alpha, worst.n_comparisons))
}

/// [`compare_blocks`] for whoever looks while it runs: of all looks at an estimate that grows, one or more disagree with
/// probability alpha at most, the level of the sequence.
///
/// `n_samples` is how many each mean rests on at this look. The p-value is that of the worst entry by the sequence, corrected for
/// the entries and valid at all times together; until the sequence starts, nothing but exact entries can disagree.
///
/// # Panics
/// If the shapes differ.
pub fn compare_blocks_anytime(
    reference: &Block,
    mean: &Block,
    variance_of_mean: &Block,
    n_samples: u64,
    sequence: &NormalMixture,
) -> ZVerdict {
    let worst = Worst::of(reference, mean, variance_of_mean);
    let critical_z = sequence.at_level(sidak_level(sequence.alpha(), worst.n_comparisons)).critical_z(n_samples);
    worst.verdict(sequence.alpha(), sequence.p_value_of_z(worst.z, n_samples), critical_z)
}

/// The entry that is farthest off.
struct Worst {
    /// Unsigned.
    z: f64,
    at: (usize, usize),
    n_comparisons: usize,
    n_exact: usize,
}

impl Worst {
    fn of(reference: &Block, mean: &Block, variance_of_mean: &Block) -> Self {
        let mut worst = Self { z: 0.0, at: (0, 0), n_comparisons: 0, n_exact: 0 };
        comparisons(reference, mean, variance_of_mean, |row, column, Comparison { z, is_exact }| {
            worst.n_exact += usize::from(is_exact);
            worst.n_comparisons += usize::from(!is_exact);
            if z.abs() > worst.z {
                (worst.z, worst.at) = (z.abs(), (row, column));
            }
        });
        worst
    }

    /// Asks how likely the worst of so many is, given how likely it is alone; two exact numbers that differ leave no doubt.
    fn verdict(&self, alpha: f64, p_alone: f64, critical_z: f64) -> ZVerdict {
        let p_value = match (self.z, self.n_comparisons) {
            (f64::INFINITY, _) => 0.0,
            (_, 0) => 1.0,
            (_, n) => sidak(p_alone, n),
        };
        ZVerdict {
            worst_z: self.z,
            worst_at: self.at,
            n_comparisons: self.n_comparisons,
            n_exact: self.n_exact,
            p_value,
            critical_z,
            agrees: p_value >= alpha,
        }
    }
}

/// The z-score of every entry, as [`compare_blocks`] has it and with its sign: a map of where an estimate is too bright and where
/// too dark. 0 where both sides are exact and equal to rounding, ±∞ where they differ or one is not a number.
///
/// # Panics
/// If the shapes differ.
pub fn z_map(reference: &Block, mean: &Block, variance_of_mean: &Block) -> Block {
    let mut map = Block::zeros(reference.n_rows(), reference.n_columns());
    comparisons(reference, mean, variance_of_mean, |row, column, comparison| map.set(row, column, comparison.z));
    map
}

/// The two-sided p-value of every entry of a [`z_map`]; 1 where both sides are exact and equal.
///
/// # Panics
/// If the shapes differ.
pub fn p_value_map(reference: &Block, mean: &Block, variance_of_mean: &Block) -> Block {
    let mut map = z_map(reference, mean, variance_of_mean);
    map.values_mut().iter_mut().for_each(|z| *z = two_sided_p(*z));
    map
}

/// The p-values of the entries that have an error bar, column by column: for a histogram or a correction.
///
/// They are independent, and so uniform together, only where no sample scores two entries.
///
/// # Panics
/// If the shapes differ.
pub fn p_values(reference: &Block, mean: &Block, variance_of_mean: &Block) -> Vec<f64> {
    let mut found = Vec::with_capacity(reference.values().len());
    comparisons(reference, mean, variance_of_mean, |_, _, comparison| {
        if !comparison.is_exact {
            found.push(two_sided_p(comparison.z));
        }
    });
    found
}

/// Compares entry by entry, column by column.
fn comparisons(
    reference: &Block,
    mean: &Block,
    variance_of_mean: &Block,
    mut visit: impl FnMut(usize, usize, Comparison),
) {
    check_shapes(reference, mean);
    check_shapes(reference, variance_of_mean);
    for c in 0..reference.n_columns() {
        let rounding = ROUNDING_TOLERANCE * reference.column(c).iter().fold(0.0, |size: f64, v| size.max(v.abs()));
        let entries = reference.column(c).iter().zip(mean.column(c)).zip(variance_of_mean.column(c)).enumerate();
        for (row, ((reference, mean), variance)) in entries {
            // Score the entry by its error bar, or by whether two exact numbers are the same.
            let is_exact = *variance == 0.0;
            let apart = mean - reference;
            let z = if !is_exact {
                z_score(*mean, *reference, variance + rounding * rounding)
            } else if apart.abs() <= rounding {
                0.0
            } else {
                f64::INFINITY.copysign(apart)
            };
            let z = if z.is_nan() || !variance.is_finite() { f64::INFINITY } else { z };
            visit(row, c, Comparison { z, is_exact });
        }
    }
}
