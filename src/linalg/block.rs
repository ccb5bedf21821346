//! A block of column vectors: one column a colour band (or a right-hand side).

/// n_rows × n_columns, column-major: every column is one contiguous vector.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Block {
    n_rows: usize,
    n_columns: usize,
    values: Vec<f64>,
}

impl Block {
    /// All zeros.
    pub fn zeros(n_rows: usize, n_columns: usize) -> Self {
        Self { n_rows, n_columns, values: vec![0.0; n_rows * n_columns] }
    }

    /// value(row, column) for every entry.
    pub fn from_fn(n_rows: usize, n_columns: usize, mut value: impl FnMut(usize, usize) -> f64) -> Self {
        let mut block = Self::zeros(n_rows, n_columns);
        for c in 0..n_columns {
            for (r, slot) in block.column_mut(c).iter_mut().enumerate() {
                *slot = value(r, c);
            }
        }
        block
    }

    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    pub fn n_columns(&self) -> usize {
        self.n_columns
    }

    pub fn column(&self, c: usize) -> &[f64] {
        &self.values[c * self.n_rows..(c + 1) * self.n_rows]
    }

    pub fn column_mut(&mut self, c: usize) -> &mut [f64] {
        &mut self.values[c * self.n_rows..(c + 1) * self.n_rows]
    }

    pub fn columns(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.n_columns).map(|c| self.column(c))
    }

    /// C columns in a row.
    pub(super) fn columns_from<const C: usize>(&self, first: usize) -> [&[f64]; C] {
        std::array::from_fn(|c| self.column(first + c))
    }

    /// The same to write to.
    pub(super) fn columns_from_mut<const C: usize>(&mut self, first: usize) -> [&mut [f64]; C] {
        let n = self.n_rows;
        let mut rest = &mut self.values[first * n..];
        std::array::from_fn(|_| rest.split_off_mut(..n).unwrap_or_default())
    }

    pub fn get(&self, row: usize, column: usize) -> f64 {
        self.values[column * self.n_rows + row]
    }

    pub fn set(&mut self, row: usize, column: usize, value: f64) {
        self.values[column * self.n_rows + row] = value;
    }

    /// All entries, column after column.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// self ← self + factor · other.
    pub fn add_scaled(&mut self, factor: f64, other: &Block) {
        debug_assert_eq!((self.n_rows, self.n_columns), (other.n_rows, other.n_columns));
        for (a, b) in self.values.iter_mut().zip(&other.values) {
            *a += factor * b;
        }
    }

    /// self ← other, without allocating.
    pub fn copy_from(&mut self, other: &Block) {
        self.values.copy_from_slice(&other.values);
    }

    /// max |entry|; NaN if any entry is NaN.
    pub fn max_abs(&self) -> f64 {
        max_abs(&self.values)
    }

    /// The entries of one row, one a column.
    pub fn row(&self, row: usize) -> impl Iterator<Item = f64> + '_ {
        (0..self.n_columns).map(move |c| self.get(row, c))
    }
}

/// max |xᵢ|; NaN if any xᵢ is NaN.
pub fn max_abs(values: &[f64]) -> f64 {
    worst(values.iter().map(|v| v.abs()))
}

/// The largest of these and 0; NaN if any is NaN, which `f64::max` would lose.
pub fn worst(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |worst: f64, v| if v.is_nan() || worst.is_nan() { f64::NAN } else { worst.max(v) })
}
