//! Dense matrices, row by row, and their product with a block.

use super::share::share;
use super::{Block, LinearOperator};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::sync::LazyLock;

/// Rows that are worth a task.
const ROWS_A_TASK: usize = 32;

/// Columns of a strip that one task of a transposed product owns: a few kB of each row.
const STRIP: usize = 256;

/// Lanes that a dot product is summed in, on any machine.
const LANES: usize = 8;

/// The vector instructions that this machine has for them.
static ARCH: LazyLock<Arch> = LazyLock::new(Arch::new);

/// What entries may be stored as. Sums are in f64 either way.
pub trait Entry: Copy + Into<f64> + Send + Sync + 'static {}

impl Entry for f64 {}

impl Entry for f32 {}

/// n_rows × n_columns, row-major, in f64 or, in half the room, f32. As an operator it is grey.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense<T = f64> {
    n_rows: usize,
    n_columns: usize,
    values: Vec<T>,
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

    /// From its entries, row after row.
    pub(super) fn from_values(n_rows: usize, n_columns: usize, values: Vec<f64>) -> Self {
        assert_eq!(values.len(), n_rows * n_columns);
        Self { n_rows, n_columns, values }
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

    /// The same in half the room, every entry rounded.
    pub fn rounded(&self) -> Dense<f32> {
        let values = self.values.iter().map(|v| *v as f32).collect();
        Dense { n_rows: self.n_rows, n_columns: self.n_columns, values }
    }
}

impl<T: Entry> Dense<T> {
    pub fn row_slice(&self, r: usize) -> &[T] {
        &self.values[r * self.n_columns..(r + 1) * self.n_columns]
    }

    pub fn row_mut(&mut self, r: usize) -> &mut [T] {
        &mut self.values[r * self.n_columns..(r + 1) * self.n_columns]
    }

    pub fn get(&self, r: usize, c: usize) -> f64 {
        self.values[r * self.n_columns + c].into()
    }

    /// All entries, row after row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// y ← A x for C columns, ROWS rows side by side.
    fn apply_columns<const C: usize, const ROWS: usize>(&self, x: [&[f64]; C], y: [&mut [f64]; C]) {
        share(y, 0, ROWS_A_TASK, &|first, y| {
            ARCH.dispatch(Rows::<T, C, ROWS> { matrix: self, first, x, y });
        });
    }

    /// y ← Aᵀ x for C columns.
    fn transpose_columns<const C: usize>(&self, x: [&[f64]; C], y: [&mut [f64]; C]) {
        share(y, 0, STRIP, &|first, y| {
            ARCH.dispatch(Strip { matrix: self, first, x, y });
        });
    }
}

impl<T: Entry> LinearOperator for Dense<T> {
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
        // Read every row once for up to four columns, as many rows side by side as there are registers for.
        for first in (0..x.n_columns()).step_by(4) {
            match x.n_columns() - first {
                1 => self.apply_columns::<1, 4>(x.columns_from(first), y.columns_from_mut(first)),
                2 => self.apply_columns::<2, 2>(x.columns_from(first), y.columns_from_mut(first)),
                3 => self.apply_columns::<3, 1>(x.columns_from(first), y.columns_from_mut(first)),
                _ => self.apply_columns::<4, 1>(x.columns_from(first), y.columns_from_mut(first)),
            }
        }
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        assert_eq!((x.n_rows(), y.n_rows(), x.n_columns()), (self.n_rows, self.n_columns, y.n_columns()));
        for first in (0..x.n_columns()).step_by(4) {
            match x.n_columns() - first {
                1 => self.transpose_columns::<1>(x.columns_from(first), y.columns_from_mut(first)),
                2 => self.transpose_columns::<2>(x.columns_from(first), y.columns_from_mut(first)),
                3 => self.transpose_columns::<3>(x.columns_from(first), y.columns_from_mut(first)),
                _ => self.transpose_columns::<4>(x.columns_from(first), y.columns_from_mut(first)),
            }
        }
    }

    fn row(&self, _band: usize, row: usize, out: &mut [f64]) {
        out.iter_mut().zip(self.row_slice(row)).for_each(|(out, v)| *out = (*v).into());
    }

    fn column(&self, _band: usize, column: usize, out: &mut [f64]) {
        out.iter_mut().enumerate().for_each(|(r, out)| *out = self.get(r, column));
    }

    fn diagonal(&self, _band: usize, out: &mut [f64]) {
        out.iter_mut().enumerate().for_each(|(i, out)| *out = self.get(i, i));
    }

    fn is_nonnegative(&self) -> bool {
        self.values.iter().all(|v| (*v).into() >= 0.0)
    }

    fn n_entries(&self) -> u64 {
        self.values.len() as u64
    }
}

/// Some rows times C columns, ROWS of them side by side.
struct Rows<'a, T, const C: usize, const ROWS: usize> {
    matrix: &'a Dense<T>,
    first: usize,
    x: [&'a [f64]; C],
    /// As many rows as are wanted.
    y: [&'a mut [f64]; C],
}

impl<T: Entry, const C: usize, const ROWS: usize> WithSimd for Rows<'_, T, C, ROWS> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { matrix, first, x, mut y } = self;
        let n = y[0].len();
        let whole = n - n % ROWS;
        for r in (0..whole).step_by(ROWS) {
            let dots: [_; ROWS] = dots(simd, std::array::from_fn(|k| matrix.row_slice(first + r + k)), x);
            for (k, dots) in dots.iter().enumerate() {
                y.iter_mut().zip(dots).for_each(|(y, dot)| y[r + k] = *dot);
            }
        }
        for r in whole..n {
            let [dots] = dots(simd, [matrix.row_slice(first + r)], x);
            y.iter_mut().zip(dots).for_each(|(y, dot)| y[r] = dot);
        }
    }
}

/// The dot products of R rows with C columns, each summed in its lanes in an order that is always the same.
#[inline(always)]
fn dots<S: Simd, T: Entry, const C: usize, const R: usize>(simd: S, rows: [&[T]; R], x: [&[f64]; C]) -> [[f64; C]; R] {
    // A group of lanes is so many registers.
    let n_registers = LANES / S::F64_LANES;
    let n = x[0].len() / LANES;
    let ((rows, row_tails), (x, x_tails)) = (groups(rows, n), groups(x, n));
    let mut sums = [[[simd.splat_f64s(0.0); LANES]; C]; R];
    for k in 0..n {
        for r in 0..R {
            let entries: [f64; LANES] = rows[r][k].map(Into::into);
            let a = S::as_simd_f64s(&entries).0;
            for c in 0..C {
                let b = S::as_simd_f64s(&x[c][k]).0;
                for v in 0..n_registers {
                    sums[r][c][v] = simd.mul_add_f64s(a[v], b[v], sums[r][c][v]);
                }
            }
        }
    }
    std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            let mut l = [0.0; LANES];
            for (v, lanes) in S::as_mut_simd_f64s(&mut l).0.iter_mut().enumerate() {
                *lanes = sums[r][c][v];
            }
            let tail = row_tails[r].iter().zip(x_tails[c]).fold(0.0, |sum, (a, x)| (*a).into().mul_add(*x, sum));
            ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7])) + tail
        })
    })
}

/// Slices cut into so many groups of lanes, and what is left of each.
#[inline(always)]
fn groups<T, const N: usize>(slices: [&[T]; N], n: usize) -> ([&[[T; LANES]]; N], [&[T]; N]) {
    let cut = slices.map(|slice| slice.as_chunks::<LANES>());
    (cut.map(|(whole, _)| &whole[..n]), cut.map(|(_, tail)| tail))
}

/// Some columns of the matrix, all the way down, times C columns.
struct Strip<'a, T, const C: usize> {
    matrix: &'a Dense<T>,
    first: usize,
    x: [&'a [f64]; C],
    /// As many rows as columns are wanted.
    y: [&'a mut [f64]; C],
}

impl<T: Entry, const C: usize> WithSimd for Strip<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { matrix, first, x, mut y } = self;
        let columns = first..first + y[0].len();
        y.iter_mut().for_each(|y| y.fill(0.0));
        for r in 0..matrix.n_rows {
            let row = &matrix.row_slice(r)[columns.clone()];
            for (y, x) in y.iter_mut().zip(x) {
                let x = x[r];
                y.iter_mut().zip(row).for_each(|(y, a)| *y = (*a).into().mul_add(x, *y));
            }
        }
    }
}
