//! Comparisons that rest on enough scores each to be normal.

use crate::linalg::Block;

/// Expected scores that one comparison rests on. A mean of λ rare scores has skewness λ^−½; at 400 its tail at six standard
/// errors is within a factor of a few of the normal one.
pub const SCORES_A_COMPARISON: f64 = 400.0;

/// Neighbouring entries joined until each comparison rests on [`SCORES_A_COMPARISON`] expected scores: one column of weighted means
/// for the reference, the estimate and its variance.
///
/// A random walk that finds a small lamp scores rarely and much: an entry of reference value m whose column is at most b expects at
/// least n m / b scores from n samples, for no score is much above b. Only the reference decides what is joined, never the sample,
/// so the comparisons stay honest. A column with too few scores in all has no comparison. Estimates of different rows must be independent. Shapes: all n × bands, one weight a row.
pub fn pooled(
    reference: &Block,
    mean: &Block,
    variance_of_mean: &Block,
    weights: &[f64],
    n_samples: u64,
) -> [Block; 3] {
    let mut rows: Vec<([f64; 3], f64)> = Vec::new();
    for band in 0..reference.n_columns() {
        let most = crate::linalg::max_abs(reference.column(band));
        let first = rows.len();
        let (mut sums, mut weight, mut scores) = ([0.0; 3], 0.0, 0.0);
        for (i, w) in weights.iter().enumerate() {
            sums[0] += w * reference.get(i, band);
            sums[1] += w * mean.get(i, band);
            sums[2] += w * w * variance_of_mean.get(i, band);
            weight += w;
            scores += n_samples as f64 * reference.get(i, band).abs() / most;
            if scores >= SCORES_A_COMPARISON {
                rows.push((sums, weight));
                (sums, weight, scores) = ([0.0; 3], 0.0, 0.0);
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
