//! Discrete sampling by inverting cumulative probabilities: neighbours in the uniform number are neighbours in the outcome.

use rayon::prelude::*;

/// A distribution for each row of a substochastic matrix, column j with probability p_ij and none with what is missing to 1, where the order
/// of the columns matters: a low-discrepancy point keeps its evenness, which alias tables tear up.
///
/// Zeros take no memory; the bits do not depend on the number of threads.
#[derive(Clone, Debug, PartialEq)]
pub struct CumulativeRows {
    /// Row i owns entries `starts[i]..starts[i + 1]`.
    starts: Vec<usize>,
    columns: Vec<u32>,
    /// Σ p of the row's entries up to and including each.
    cumulative: Vec<f64>,
}

impl CumulativeRows {
    /// `row(i, out)` writes row i, entries not negative, into `out`, which comes filled with zeros. Rows that sum above 1 by rounding lose it at
    /// their end. Cost O(n_rows · n_columns), 12 bytes an entry above zero.
    ///
    /// # Panics
    /// If there are 2³² columns or more.
    pub fn new(n_rows: usize, n_columns: usize, row: impl Fn(usize, &mut [f64]) + Sync) -> Self {
        assert!(u32::try_from(n_columns).is_ok(), "columns are numbered by 32 bits");
        let entries = |i: usize, values: &mut Vec<f64>| -> Vec<(u32, f64)> {
            values.fill(0.0);
            row(i, values);
            let mut sum = 0.0;
            let positive = values.iter().enumerate().filter(|(_, p)| **p > 0.0);
            positive
                .map(|(j, p)| {
                    sum += p;
                    (j as u32, sum)
                })
                .collect()
        };
        let rows: Vec<Vec<(u32, f64)>> =
            (0..n_rows).into_par_iter().map_init(|| vec![0.0; n_columns], |values, i| entries(i, values)).collect();
        let mut starts = vec![0];
        rows.iter().for_each(|row| starts.push(starts[starts.len() - 1] + row.len()));
        let columns = rows.iter().flatten().map(|(j, _)| *j).collect();
        let cumulative = rows.iter().flatten().map(|(_, sum)| *sum).collect();
        Self { starts, columns, cumulative }
    }

    /// A column from one number uniform in [0, 1); `None` above the row's sum. Cost O(log n).
    pub fn sample(&self, row: usize, uniform: f64) -> Option<usize> {
        let here = self.starts[row]..self.starts[row + 1];
        let k = self.cumulative[here.clone()].partition_point(|sum| *sum <= uniform);
        self.columns[here].get(k).map(|j| *j as usize)
    }
}
