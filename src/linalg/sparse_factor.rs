//! Sparse factorizations by faer, on one thread: its simplicial forms, whose bits depend on nothing but the matrix.

use super::factor::view;
use super::{Block, FactorError, Factorization, Sparse};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::prelude::default;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::lu::{LuSymbolicParams, factorize_symbolic_lu, simplicial};
use faer::sparse::linalg::{LuError, SupernodalThreshold};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Par, Side};

/// The rows of a square CSR matrix as faer sees columns: its transpose, without a copy of the values.
struct Transposed {
    starts: Vec<u32>,
}

impl Transposed {
    fn of(a: &Sparse) -> Self {
        Self { starts: a.as_sprs().indptr().raw_storage().iter().map(|start| *start as u32).collect() }
    }

    fn view<'a>(&'a self, a: &'a Sparse) -> SparseColMatRef<'a, u32, f64> {
        let n = self.starts.len() - 1;
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.starts, None, a.as_sprs().indices());
        SparseColMatRef::new(pattern, a.as_sprs().data())
    }
}

fn check_finite(a: &Sparse) -> Result<(), FactorError> {
    for row in 0..a.as_sprs().rows() {
        let (columns, values) = a.row_entries(row);
        if let Some(k) = values.iter().position(|v| !v.is_finite()) {
            return Err(FactorError::NotFinite { row, column: columns[k] as usize, value: values[k] });
        }
    }
    Ok(())
}

/// P Aᵀ Q = L U with partial pivoting, the columns ordered to keep the factors sparse (COLAMD).
pub struct SparseLuFactor {
    factors: simplicial::SimplicialLu<u32, f64>,
    rows: [Vec<u32>; 2],
    columns: [Vec<u32>; 2],
    n_entries: usize,
}

impl SparseLuFactor {
    /// Of a square matrix with fewer than 2³² stored entries.
    ///
    /// # Errors
    /// [`FactorError::Singular`] at a pivot that is zero or missing, [`FactorError::NotFinite`].
    pub fn new(a: &Sparse) -> Result<Self, FactorError> {
        check_finite(a)?;
        let n = a.as_sprs().rows();
        let singular = |pivot: usize, value: f64| FactorError::Singular { pivot, size: n, value };
        let transposed = Transposed::of(a);
        let view = transposed.view(a);

        // Order the columns; faer's numeric part then finds the fill as it goes.
        let params = LuSymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..LuSymbolicParams::default()
        };
        let symbolic = factorize_symbolic_lu(view.symbolic(), params).map_err(|_| singular(0, f64::NAN))?;
        let order = symbolic.col_perm();
        let mut rows = [vec![0; n], vec![0; n]];
        let [forward, backward] = &mut rows;
        let mut factors = simplicial::SimplicialLu::new();
        let scratch = simplicial::factorize_simplicial_numeric_lu_scratch::<u32, f64>(n, n);
        let stack = &mut MemBuffer::new(scratch);
        simplicial::factorize_simplicial_numeric_lu(forward, backward, &mut factors, view, order, MemStack::new(stack))
            .map_err(|error| match error {
                LuError::SymbolicSingular { index } => singular(index, 0.0),
                LuError::Generic(_) => singular(0, f64::NAN),
            })?;

        // A pivot is the last entry of its column of U.
        let upper = factors.u_factor_unsorted();
        for k in 0..n {
            let pivot = upper.val_of_col(k).last().copied().unwrap_or(0.0);
            if pivot == 0.0 || !pivot.is_finite() {
                return Err(singular(k, pivot));
            }
        }
        let n_entries = factors.l_factor_unsorted().compute_nnz() + upper.compute_nnz() - n;
        let (forward, backward) = order.arrays();
        let columns = [forward.to_vec(), backward.to_vec()];
        Ok(Self { factors, rows, columns, n_entries })
    }

    /// Entries of L and U, the diagonal counted once.
    pub fn n_entries(&self) -> usize {
        self.n_entries
    }

    fn permutations(&self) -> [PermRef<'_, u32>; 2] {
        [&self.rows, &self.columns].map(|[forward, backward]| PermRef::new_checked(forward, backward, forward.len()))
    }
}

impl Factorization for SparseLuFactor {
    fn solve(&self, x: &mut Block) {
        let [rows, columns] = self.permutations();
        let scratch =
            simplicial::solve_transpose_in_place_scratch::<u32, f64>(self.rows[0].len(), x.n_columns(), Par::Seq);
        let stack = &mut MemBuffer::new(scratch);
        // What is factored is the transpose.
        self.factors.solve_transpose_in_place_with_conj(
            rows,
            columns,
            Conj::No,
            view(x),
            Par::Seq,
            MemStack::new(stack),
        );
    }

    fn solve_transpose(&self, x: &mut Block) {
        let [rows, columns] = self.permutations();
        let scratch = simplicial::solve_in_place_scratch::<u32, f64>(self.rows[0].len(), x.n_columns(), Par::Seq);
        let stack = &mut MemBuffer::new(scratch);
        self.factors.solve_in_place_with_conj(rows, columns, Conj::No, view(x), Par::Seq, MemStack::new(stack));
    }
}

/// P A Pᵀ = L Lᵀ for symmetric positive definite A, ordered to keep L sparse (AMD).
pub struct SparseCholeskyFactor {
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
}

impl SparseCholeskyFactor {
    /// Of a symmetric matrix with fewer than 2³² stored entries; reads the lower triangle.
    ///
    /// # Errors
    /// [`FactorError::NotPositiveDefinite`] with the pivot in the order of elimination, [`FactorError::NotFinite`].
    pub fn new(a: &Sparse) -> Result<Self, FactorError> {
        check_finite(a)?;
        let n = a.as_sprs().rows();
        let transposed = Transposed::of(a);
        let view = transposed.view(a);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..CholeskySymbolicParams::default()
        };
        let refused = |pivot: usize| FactorError::NotPositiveDefinite { pivot, size: n };
        // The lower triangle by rows is the upper one by columns; faer counts pivots of this form from 1.
        let symbolic = factorize_symbolic_cholesky(view.symbolic(), Side::Upper, SymmetricOrdering::Amd, params)
            .map_err(|_| refused(0))?;
        let mut values = vec![0.0; symbolic.len_val()];
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, default());
        let stack = &mut MemBuffer::new(scratch);
        symbolic
            .factorize_numeric_llt(&mut values, view, Side::Upper, default(), Par::Seq, MemStack::new(stack), default())
            .map_err(|LltError::NonPositivePivot { index }| refused(index.saturating_sub(1)))?;
        Ok(Self { symbolic, values })
    }

    /// Entries of L.
    pub fn n_entries(&self) -> usize {
        self.values.len()
    }
}

impl Factorization for SparseCholeskyFactor {
    fn solve(&self, x: &mut Block) {
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(x.n_columns(), Par::Seq);
        let stack = &mut MemBuffer::new(scratch);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            view(x),
            Par::Seq,
            MemStack::new(stack),
        );
    }

    fn solve_transpose(&self, x: &mut Block) {
        self.solve(x);
    }
}
