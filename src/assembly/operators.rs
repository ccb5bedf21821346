//! Propagation G and transport K = S G as operators: unformed, one stored matrix behind both.

use crate::linalg::{Block, Diagonal, LinearOperator, Matrix};
use std::sync::Arc;

/// G = M⁻¹ T: outgoing radiance to incident radiance. Grey. Only T is stored; Gᵀ = T M⁻¹ because T is symmetric.
#[derive(Clone, Debug)]
pub struct Propagation {
    exchange: Arc<Matrix>,
    etendue: Arc<[f64]>,
}

impl Propagation {
    pub fn new(exchange: Arc<Matrix>, etendue: Arc<[f64]>) -> Self {
        Self { exchange, etendue }
    }

    /// Calls `visit(j, Gᵢⱼ)` for the stored entries of row i.
    pub fn for_each_in_row(&self, i: usize, mut visit: impl FnMut(usize, f64)) {
        let mu = self.etendue[i];
        self.exchange.for_each_in_row(i, |j, t| visit(j, t / mu));
    }

    fn divide(&self, block: &mut Block) {
        for c in 0..block.n_columns() {
            block.column_mut(c).iter_mut().zip(self.etendue.iter()).for_each(|(v, mu)| *v /= mu);
        }
    }
}

impl LinearOperator for Propagation {
    fn n_rows(&self) -> usize {
        self.etendue.len()
    }

    fn n_columns(&self) -> usize {
        self.etendue.len()
    }

    fn n_bands(&self) -> usize {
        1
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        self.exchange.apply(x, y);
        self.divide(y);
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        let mut scaled = x.clone();
        self.divide(&mut scaled);
        self.exchange.apply(&scaled, y);
    }

    fn row(&self, band: usize, row: usize, out: &mut [f64]) {
        self.exchange.row(band, row, out);
        let mu = self.etendue[row];
        out.iter_mut().for_each(|v| *v /= mu);
    }

    fn column(&self, band: usize, column: usize, out: &mut [f64]) {
        // Column j of T is its row j.
        self.exchange.row(band, column, out);
        out.iter_mut().zip(self.etendue.iter()).for_each(|(v, mu)| *v /= mu);
    }

    fn n_entries(&self) -> u64 {
        self.exchange.n_entries()
    }
}

/// K = S G: one bounce. S has one bin an element here, so it is a diagonal for every band.
#[derive(Clone, Debug)]
pub struct Transport {
    scattering: Diagonal,
    propagation: Propagation,
}

impl Transport {
    pub fn new(scattering: Diagonal, propagation: Propagation) -> Self {
        Self { scattering, propagation }
    }

    /// S.
    pub fn scattering(&self) -> &Diagonal {
        &self.scattering
    }

    /// G.
    pub fn propagation(&self) -> &Propagation {
        &self.propagation
    }

    fn scatter(&self, block: &mut Block) {
        block.values_mut().iter_mut().zip(self.scattering.values().values()).for_each(|(v, s)| *v *= s);
    }
}

impl LinearOperator for Transport {
    fn n_rows(&self) -> usize {
        self.propagation.n_rows()
    }

    fn n_columns(&self) -> usize {
        self.propagation.n_columns()
    }

    fn n_bands(&self) -> usize {
        self.scattering.n_bands()
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        self.propagation.apply(x, y);
        self.scatter(y);
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        let mut scattered = x.clone();
        self.scatter(&mut scattered);
        self.propagation.apply_transpose(&scattered, y);
    }

    fn row(&self, band: usize, row: usize, out: &mut [f64]) {
        self.propagation.row(0, row, out);
        let s = self.scattering.values().get(row, band);
        out.iter_mut().for_each(|v| *v *= s);
    }

    fn column(&self, band: usize, column: usize, out: &mut [f64]) {
        self.propagation.column(0, column, out);
        out.iter_mut().zip(self.scattering.values().column(band)).for_each(|(v, s)| *v *= s);
    }

    fn n_entries(&self) -> u64 {
        self.propagation.n_entries()
    }
}
