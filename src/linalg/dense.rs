//! Dense matrices, row by row, and their product with a block.

use super::{Block, LinearOperator};
use rayon::prelude::*;

/// Rows that one task takes: enough work to be worth a task, and the same on any number of threads.
const ROWS_A_TASK: usize = 16;

/// n_rows × n_columns in f64, row-major. As an operator it is grey.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    n_rows: usize,
    n_columns: usize,
    values: Vec<f64>,
}

impl Dense {
    pub fn zeros(n_rows: usize, n_columns: usize) -> Self {
        Self { n_rows, n_columns, values: vec![0.0; n_rows * n_columns] }
    }

    /// value(row, column) for every entry.
    pub fn from_fn(n_rows: usize, n_columns: usize, mut value: impl FnMut(usize, usize) -> f64) -> Self {
        let mut dense = Self::zeros(n_rows, n_columns);
        for r in 0..n_rows {
            for (c, slot) in dense.row_mut(r).iter_mut().enumerate() {
                *slot = value(r, c);
            }
        }
        dense
    }

    /// One band of any operator, written out: row by row, in parallel.
    pub fn from_operator(operator: &dyn LinearOperator, band: usize) -> Self {
        let mut dense = Self::zeros(operator.n_rows(), operator.n_columns());
        if dense.n_columns > 0 {
            let rows = dense.values.par_chunks_mut(dense.n_columns).enumerate();
            rows.for_each(|(r, out)| operator.row(band, r, out));
        }
        dense
    }

    pub fn row_slice(&self, r: usize) -> &[f64] {
        &self.values[r * self.n_columns..(r + 1) * self.n_columns]
    }

    pub fn row_mut(&mut self, r: usize) -> &mut [f64] {
        &mut self.values[r * self.n_columns..(r + 1) * self.n_columns]
    }

    pub fn get(&self, r: usize, c: usize) -> f64 {
        self.values[r * self.n_columns + c]
    }

    /// All entries, row after row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }
}

impl LinearOperator for Dense {
    fn n_rows(&self) -> usize {
        self.n_rows
    }

    fn n_columns(&self) -> usize {
        self.n_columns
    }

    fn n_bands(&self) -> usize {
        1
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        assert_eq!((x.n_rows(), y.n_rows(), x.n_columns()), (self.n_columns, self.n_rows, y.n_columns()));
        // Read every row once for up to four columns.
        for first in (0..x.n_columns()).step_by(4) {
            match x.n_columns() - first {
                1 => self.apply_columns::<1>(x, y, first),
                2 => self.apply_columns::<2>(x, y, first),
                3 => self.apply_columns::<3>(x, y, first),
                _ => self.apply_columns::<4>(x, y, first),
            }
        }
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        assert_eq!((x.n_rows(), y.n_rows(), x.n_columns()), (self.n_rows, self.n_columns, y.n_columns()));
        // Every task owns some columns of the matrix, and walks down them in the order of the rows.
        for c in 0..x.n_columns() {
            let x = x.column(c);
            y.column_mut(c).par_chunks_mut(512).enumerate().for_each(|(task, out)| {
                let first = task * 512;
                out.fill(0.0);
                for (r, x) in x.iter().enumerate() {
                    let row = &self.row_slice(r)[first..first + out.len()];
                    out.iter_mut().zip(row).for_each(|(out, a)| *out += a * x);
                }
            });
        }
    }

    fn row(&self, _band: usize, row: usize, out: &mut [f64]) {
        out.copy_from_slice(self.row_slice(row));
    }

    fn column(&self, _band: usize, column: usize, out: &mut [f64]) {
        out.iter_mut().enumerate().for_each(|(r, out)| *out = self.get(r, column));
    }

    fn n_entries(&self) -> u64 {
        self.values.len() as u64
    }
}

impl Dense {
    fn apply_columns<const C: usize>(&self, x: &Block, y: &mut Block, first: usize) {
        let x: [&[f64]; C] = std::array::from_fn(|c| x.column(first + c));
        let n_rows = self.n_rows;
        let n_tasks = n_rows.div_ceil(ROWS_A_TASK);
        let results: Vec<[[f64; C]; ROWS_A_TASK]> = (0..n_tasks)
            .into_par_iter()
            .map(|task| {
                let mut out = [[0.0; C]; ROWS_A_TASK];
                for (k, out) in out.iter_mut().enumerate().take(n_rows - task * ROWS_A_TASK) {
                    *out = dot_block(self.row_slice(task * ROWS_A_TASK + k), x);
                }
                out
            })
            .collect();
        for c in 0..C {
            let rows = results.as_flattened().iter();
            y.column_mut(first + c).iter_mut().zip(rows).for_each(|(y, row)| *y = row[c]);
        }
    }
}

/// The dot products of one row with C columns, summed in eight lanes in a fixed order.
fn dot_block<const C: usize>(row: &[f64], x: [&[f64]; C]) -> [f64; C] {
    const LANES: usize = 8;
    let n = row.len();
    let x = x.map(|x| &x[..n]);
    let mut lanes = [[0.0f64; LANES]; C];
    let whole = n - n % LANES;
    for start in (0..whole).step_by(LANES) {
        let a: &[f64; LANES] = row[start..start + LANES].try_into().expect("a whole chunk");
        for c in 0..C {
            let b: &[f64; LANES] = x[c][start..start + LANES].try_into().expect("a whole chunk");
            for l in 0..LANES {
                lanes[c][l] += a[l] * b[l];
            }
        }
    }
    std::array::from_fn(|c| {
        let l = &lanes[c];
        let tail: f64 = (whole..n).map(|k| row[k] * x[c][k]).sum();
        ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7])) + tail
    })
}
