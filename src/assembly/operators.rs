//! Propagation G and transport K = S G as operators: unformed, one stored matrix behind both.

use crate::linalg::{Block, Diagonal, LinearOperator, Matrix, Scratch};
use std::sync::Arc;

/// G = M⁻¹ T: outgoing radiance to incident radiance. Grey. Only T is stored; Gᵀ = T M⁻¹ because T is symmetric.
#[derive(Clone, Debug)]
pub struct Propagation {
    exchange: Arc<Matrix>,
    etendue: Arc<[f64]>,
    scratch: Scratch,
}

impl Propagation {
    pub fn new(exchange: Arc<Matrix>, etendue: Arc<[f64]>) -> Self {
        Self { exchange, etendue, scratch: Scratch::default() }
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
        self.scratch.with(x.n_rows(), x.n_columns(), |scaled| {
            scaled.copy_from(x);
            self.divide(scaled);
            self.exchange.apply(scaled, y);
        });
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

    fn is_nonnegative(&self) -> bool {
        self.exchange.is_nonnegative()
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
    scratch: Scratch,
}

impl Transport {
    pub fn new(scattering: Diagonal, propagation: Propagation) -> Self {
        Self { scattering, propagation, scratch: Scratch::default() }
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
        self.scratch.with(x.n_rows(), x.n_columns(), |scattered| {
            scattered.copy_from(x);
            self.scatter(scattered);
            self.propagation.apply_transpose(scattered, y);
        });
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

    fn is_nonnegative(&self) -> bool {
        self.scattering.is_nonnegative() && self.propagation.is_nonnegative()
    }

    fn n_entries(&self) -> u64 {
        self.propagation.n_entries()
    }
}

/// K* = G S, the adjoint of K in the étendue inner product: one bounce of importance.
#[derive(Clone, Debug)]
pub struct AdjointTransport {
    transport: Transport,
    scratch: Scratch,
}

impl AdjointTransport {
    pub fn new(transport: Transport) -> Self {
        Self { transport, scratch: Scratch::default() }
    }
}

impl LinearOperator for AdjointTransport {
    fn n_rows(&self) -> usize {
        self.transport.n_rows()
    }

    fn n_columns(&self) -> usize {
        self.transport.n_columns()
    }

    fn n_bands(&self) -> usize {
        self.transport.n_bands()
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        self.scratch.with(x.n_rows(), x.n_columns(), |scattered| {
            scattered.copy_from(x);
            self.transport.scatter(scattered);
            self.transport.propagation.apply(scattered, y);
        });
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        self.transport.propagation.apply_transpose(x, y);
        self.transport.scatter(y);
    }

    fn row(&self, band: usize, row: usize, out: &mut [f64]) {
        self.transport.propagation.row(0, row, out);
        out.iter_mut().zip(self.transport.scattering.values().column(band)).for_each(|(v, s)| *v *= s);
    }

    fn column(&self, band: usize, column: usize, out: &mut [f64]) {
        self.transport.propagation.column(0, column, out);
        let s = self.transport.scattering.values().get(column, band);
        out.iter_mut().for_each(|v| *v *= s);
    }

    fn diagonal(&self, band: usize, out: &mut [f64]) {
        self.transport.diagonal(band, out);
    }

    fn is_nonnegative(&self) -> bool {
        self.transport.is_nonnegative()
    }

    fn n_entries(&self) -> u64 {
        self.transport.n_entries()
    }
}
