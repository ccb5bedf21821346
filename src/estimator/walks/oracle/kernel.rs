//! Hₘ = diag(r oᵐ) G diag(d eᵐ): how moments of order m pass from bundle to bundle.

use super::Law;
use crate::linalg::{Block, LinearOperator, Scratch};

/// Hₘ of every band, n × n.
pub struct Kernel<'a> {
    propagation: &'a dyn LinearOperator,
    /// r oᵐ, n × bands.
    left: Block,
    /// d eᵐ, n × bands; 1 if there is none.
    right: Option<Block>,
    scratch: Scratch,
}

impl<'a> Kernel<'a> {
    pub fn new(law: &'a Law<'_>, order: usize) -> Self {
        let (n, n_bands, power) = (law.n_bundles(), law.n_bands(), order as i32);
        let left = Block::from_fn(n, n_bands, |i, band| law.row.get(i, band) * law.gain.get(i, band).powi(power));
        let right = law
            .guide
            .as_ref()
            .map(|[d, e]| Block::from_fn(n, n_bands, |j, band| d.get(j, band) * e.get(j, band).powi(power)));
        Self { propagation: law.propagation, left, right, scratch: Scratch::default() }
    }

    /// M⁻¹ Hₘᵀ M = G diag(r oᵐ), where M G is symmetric and nothing guides the walk.
    pub fn adjoint(law: &'a Law<'_>, order: usize) -> Self {
        let ones = Block::from_fn(law.n_bundles(), law.n_bands(), |_, _| 1.0);
        Self {
            right: Some(Self::new(law, order).left),
            left: ones,
            propagation: law.propagation,
            scratch: Scratch::default(),
        }
    }

    /// r oᵐ of one band, n × 1.
    pub fn left_of(&self, band: usize) -> Block {
        Block::from_fn(self.left.n_rows(), 1, |i, _| self.left.get(i, band))
    }

    /// out ← second · op(first · x), where there is a first and a second.
    fn between(&self, first: Option<&Block>, x: &Block, second: Option<&Block>, out: &mut Block, transposed: bool) {
        let weigh = |block: &mut Block, weights: Option<&Block>| {
            let weights = weights.into_iter().flat_map(|weights| weights.values());
            block.values_mut().iter_mut().zip(weights).for_each(|(v, w)| *v *= w);
        };
        self.scratch.with(x.n_rows(), x.n_columns(), |weighted| {
            weighted.copy_from(x);
            weigh(weighted, first);
            match transposed {
                true => self.propagation.apply_transpose(weighted, out),
                false => self.propagation.apply(weighted, out),
            }
        });
        weigh(out, second);
    }

    fn right(&self, bundle: usize, band: usize) -> f64 {
        self.right.as_ref().map_or(1.0, |right| right.get(bundle, band))
    }
}

impl LinearOperator for Kernel<'_> {
    fn n_rows(&self) -> usize {
        self.left.n_rows()
    }

    fn n_columns(&self) -> usize {
        self.left.n_rows()
    }

    fn n_bands(&self) -> usize {
        self.left.n_columns()
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        self.between(self.right.as_ref(), x, Some(&self.left), y, false);
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        self.between(Some(&self.left), x, self.right.as_ref(), y, true);
    }

    fn row(&self, band: usize, row: usize, out: &mut [f64]) {
        self.propagation.row(0, row, out);
        let left = self.left.get(row, band);
        out.iter_mut().enumerate().for_each(|(j, v)| *v *= left * self.right(j, band));
    }

    fn column(&self, band: usize, column: usize, out: &mut [f64]) {
        self.propagation.column(0, column, out);
        let right = self.right(column, band);
        out.iter_mut().zip(self.left.column(band)).for_each(|(v, left)| *v *= left * right);
    }

    fn is_nonnegative(&self) -> bool {
        let scales = self.left.values().iter().chain(self.right.iter().flat_map(|right| right.values()));
        scales.into_iter().all(|v| *v >= 0.0) && self.propagation.is_nonnegative()
    }

    fn n_entries(&self) -> u64 {
        self.propagation.n_entries()
    }
}
