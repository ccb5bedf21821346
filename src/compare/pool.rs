//! Comparisons that rest on enough scores each to be normal.

use crate::linalg::Block;

/// Expected scores that one comparison rests on.
///
/// A mean of λ scores of one size, over its own error bar, has heavier tails than a normal number. By sums of Poisson's terms, |z|
/// exceeds 3.3, 4, 5 and 6 more often than promised by the factors 1.3, 1.6, 3.8 and 15 at λ = 400; by 1.1, 1.3, 1.9 and 4.9 at λ
/// = 1000; by 1.0, 1.0, 1.1 and 1.3 at λ = 10⁴.
pub const SCORES_A_COMPARISON: f64 = 400.0;

/// Neighbouring entries joined until each comparison rests on [`SCORES_A_COMPARISON`] expected scores: one column of weighted means
/// for the reference, the estimate and its variance.
///
/// A random walk that finds a small lamp scores rarely and much: an entry of reference value m, whose samples score at most b
/// each, expects at least n m / b samples of n to score. `largest_scores` holds b for each column: what the estimator multiplies
/// its hits with, the largest emission for a plain walk, *for whatever bounce the column holds*. The column's own largest value is
/// none: light that arrives late is dim everywhere because it arrives rarely, and each arrival is as bright as ever.
///
/// Scores of unequal weight count as the equal ones whose sum is as skewed: λ = (Σ w² s)³ / (Σ w³ s)² for s expected scores of
/// weight w.
///
/// Only the reference and the bound decide what is joined, never the sample, so the comparisons stay honest. A column with too few
/// scores in all has no comparison. Estimates of different rows must be independent. Shapes: all n × columns, one weight a row,
/// one bound a column.
///
/// # Panics
/// If there is not one bound a column.
pub fn pooled(
    reference: &Block,
    mean: &Block,
    variance_of_mean: &Block,
    weights: &[f64],
    n_samples: u64,
    largest_scores: &[f64],
) -> [Block; 3] {
    assert_eq!(largest_scores.len(), reference.n_columns(), "there must be one bound a column");
    let mut rows: Vec<([f64; 3], f64)> = Vec::new();
    for (column, largest_score) in largest_scores.iter().enumerate() {
        let first = rows.len();
        let (mut sums, mut weight, mut squares, mut cubes) = ([0.0; 3], 0.0, 0.0, 0.0);
        for (i, w) in weights.iter().enumerate() {
            let value = reference.get(i, column);
            sums[0] += w * value;
            sums[1] += w * mean.get(i, column);
            sums[2] += w * w * variance_of_mean.get(i, column);
            weight += w;
            if value != 0.0 {
                let scores = n_samples as f64 * value.abs() / largest_score;
                squares += w * w * scores;
                cubes += w * w * w * scores;
            }
            if squares.powi(3) >= SCORES_A_COMPARISON * cubes * cubes && cubes > 0.0 {
                rows.push((sums, weight));
                (sums, weight, squares, cubes) = ([0.0; 3], 0.0, 0.0, 0.0);
            }
        }
        // What is left over joins the last comparison.
        if let [.., (last, last_weight)] = &mut rows[first..] {
            last.iter_mut().zip(sums).for_each(|(total, rest)| *total += rest);
            *last_weight += weight;
        }
    }
    let scale = |k: usize, weight: f64| if k == 2 { weight * weight } else { weight };
    std::array::from_fn(|k| Block::from_fn(rows.len(), 1, |r, _| rows[r].0[k] / scale(k, rows[r].1)))
}
