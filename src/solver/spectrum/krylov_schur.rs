//! Krylov–Schur: a few extreme eigenpairs of an operator by its products alone, restarted without losing what is known.
//!
//! ```text
//! K V = V H + β v eᵀ,      H y = λ y:      ‖K V y − λ V y‖ = β |y_last|
//! ```
//!
//! with V orthonormal in ⟨a, b⟩ = Σ wᵢ aᵢ bᵢ. Every product adds a column to V, orthogonalised twice against all others; a full V is
//! shrunk to an orthonormal basis of its best eigenvectors, an invariant subspace of H, which keeps the relation. Where K is self-adjoint
//! H is symmetric, and this is Lanczos' method with full reorthogonalisation and thick restart. Of a multiple eigenvalue one vector is
//! found, the one that the start holds. Memory n × dimension a band. Source: Stewart (2001); Wu and Simon (2000).

use super::super::SolveError;
use crate::linalg::{Block, Dense, SmallPair, eigenpairs, symmetric_eigenpairs};

/// A vector that shrinks by orthogonalisation to so little of itself lay in the space already.
const INVARIANT: f64 = 1e-14;

/// One eigenvalue re + i im and its eigenvector, of norm 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenpair {
    pub re: f64,
    pub im: f64,
    /// ‖K x − λ x‖ of ‖x‖ = 1, in the norm of the inner product used.
    pub residual: f64,
    pub vector_re: Vec<f64>,
    pub vector_im: Vec<f64>,
}

/// What is looked for, and how hard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen {
    /// Eigenpairs of largest magnitude.
    pub n_pairs: usize,
    /// On the residual of each, relative to the largest magnitude.
    pub tolerance: f64,
    /// Columns of V before it is shrunk; more than n_pairs + 2, and twice n_pairs or more does well.
    pub dimension: usize,
    /// Products after which what is known is returned.
    pub n_products: usize,
}

/// The pairs of every band, and the products (all bands at once) that they took.
pub(super) struct Found {
    pub bands: Vec<Vec<Eigenpair>>,
    pub n_applies: usize,
}

/// Leading eigenpairs of every band of an n × n operator. `weights` is n × bands; unknowns of weight zero are left out, as zero.
pub(super) fn leading(
    method: &'static str,
    weights: &Block,
    is_self_adjoint: bool,
    settings: Eigen,
    mut apply: impl FnMut(&Block, &mut Block),
) -> Result<Found, SolveError> {
    let (n, n_bands) = (weights.n_rows(), weights.n_columns());
    let mut spaces: Vec<Space<'_>> =
        (0..n_bands).map(|band| Space::new(weights.column(band), is_self_adjoint, settings)).collect();
    let (mut x, mut image) = (Block::zeros(n, n_bands), Block::zeros(n, n_bands));
    let mut n_applies = 0;
    while n_applies < settings.n_products && spaces.iter().any(|space| !space.is_done) {
        for (band, space) in spaces.iter().enumerate() {
            match space.basis.last() {
                Some(v) if !space.is_done => x.column_mut(band).copy_from_slice(v),
                _ => x.column_mut(band).fill(0.0),
            }
        }
        apply(&x, &mut image);
        n_applies += 1;
        for (band, space) in spaces.iter_mut().enumerate().filter(|(_, space)| !space.is_done) {
            space.extend(image.column(band));
            let is_last = n_applies == settings.n_products;
            space.settle(is_last).map_err(|source| SolveError::Factor { method, band, source })?;
        }
    }
    Ok(Found { bands: spaces.into_iter().map(|space| space.found).collect(), n_applies })
}

/// The Krylov space of one band.
struct Space<'a> {
    weight: &'a [f64],
    is_self_adjoint: bool,
    settings: Eigen,
    /// Columns of V, and the next one.
    basis: Vec<Vec<f64>>,
    /// Columns of H, each with the weight of the next vector below.
    columns: Vec<Vec<f64>>,
    found: Vec<Eigenpair>,
    is_done: bool,
}

impl<'a> Space<'a> {
    fn new(weight: &'a [f64], is_self_adjoint: bool, settings: Eigen) -> Self {
        // Begin near uniform light, with a share in everything.
        let start = weight
            .iter()
            .enumerate()
            .map(|(i, w)| if *w > 0.0 { 1.0 + 0.5 * (1.618_033_988_749_895 * (i as f64 + 1.0)).sin() } else { 0.0 });
        let mut start: Vec<f64> = start.collect();
        let norm = inner(weight, &start, &start).sqrt();
        let is_done = norm == 0.0 || settings.n_pairs == 0;
        start.iter_mut().for_each(|v| *v /= norm);
        Self { weight, is_self_adjoint, settings, basis: vec![start], columns: Vec::new(), found: Vec::new(), is_done }
    }

    /// Takes in the image of the last vector: a column of H and the next vector, which is empty where the space is invariant.
    fn extend(&mut self, image: &[f64]) {
        let mut next: Vec<f64> = image.iter().zip(self.weight).map(|(v, w)| if *w > 0.0 { *v } else { 0.0 }).collect();
        let before = inner(self.weight, &next, &next).sqrt();
        let mut column = vec![0.0; self.basis.len() + 1];
        for _ in 0..2 {
            for (v, h) in self.basis.iter().zip(&mut column) {
                let part = inner(self.weight, v, &next);
                next.iter_mut().zip(v).for_each(|(n, v)| *n -= part * v);
                *h += part;
            }
        }
        let norm = inner(self.weight, &next, &next).sqrt();
        if norm > INVARIANT * before {
            next.iter_mut().for_each(|v| *v /= norm);
            column[self.basis.len()] = norm;
            self.basis.push(next);
        }
        self.columns.push(column);
    }

    /// Looks at the eigenpairs of H where V is full, invariant or has to do, and shrinks V where they are not good enough.
    fn settle(&mut self, is_last: bool) -> Result<(), crate::linalg::FactorError> {
        let m = self.columns.len();
        let is_invariant = self.basis.len() == m;
        if m < self.settings.dimension && !is_invariant && !is_last {
            return Ok(());
        }
        let h = Dense::from_fn(m, m, |r, c| self.columns[c].get(r).copied().unwrap_or(0.0));
        let pairs = if self.is_self_adjoint {
            symmetric_eigenpairs(&Dense::from_fn(m, m, |r, c| 0.5 * (h.get(r, c) + h.get(c, r))))
        } else {
            eigenpairs(&h)?
        };
        // The last row of the relation: β eᵀ, or what restarts have made of it.
        let tail: Vec<f64> = self.columns.iter().map(|column| column.get(m).copied().unwrap_or(0.0)).collect();
        let residual = |pair: &SmallPair| dot(&tail, &pair.vector_re).hypot(dot(&tail, &pair.vector_im));
        let largest = pairs.first().map_or(0.0, |pair| pair.re.hypot(pair.im));
        let wanted = &pairs[..self.settings.n_pairs.min(m)];
        let is_good = wanted.iter().all(|pair| residual(pair) <= self.settings.tolerance * largest);
        if is_good || is_invariant || is_last {
            self.found = wanted.iter().map(|pair| self.lift(pair, residual(pair))).collect();
            self.is_done = true;
            return Ok(());
        }

        // Keep the wanted and half of the rest, and no half of a complex pair.
        let mut n_kept = self.settings.n_pairs + (m - self.settings.n_pairs.min(m)) / 2;
        n_kept = n_kept.min(m - 1);
        if pairs[n_kept - 1].im > 0.0 && n_kept > 1 {
            n_kept -= 1;
        }
        let mut kept: Vec<Vec<f64>> = Vec::with_capacity(n_kept);
        for pair in &pairs[..n_kept] {
            let mut y = if pair.im < 0.0 { pair.vector_im.clone() } else { pair.vector_re.clone() };
            for _ in 0..2 {
                for q in &kept {
                    let part = dot(q, &y);
                    y.iter_mut().zip(q).for_each(|(y, q)| *y -= part * q);
                }
            }
            let norm = dot(&y, &y).sqrt();
            if norm > INVARIANT {
                y.iter_mut().for_each(|y| *y /= norm);
                kept.push(y);
            }
        }
        let mut basis: Vec<Vec<f64>> = kept.iter().map(|q| self.combine(q)).collect();
        basis.extend(self.basis.pop());
        let image = |q: &[f64]| (0..m).map(|r| (0..m).map(|c| h.get(r, c) * q[c]).sum()).collect::<Vec<f64>>();
        self.columns = kept
            .iter()
            .map(|q| {
                let image = image(q);
                kept.iter().map(|k| dot(k, &image)).chain([dot(&tail, q)]).collect()
            })
            .collect();
        self.basis = basis;
        Ok(())
    }

    /// V q.
    fn combine(&self, q: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.weight.len()];
        for (v, q) in self.basis.iter().zip(q) {
            sum.iter_mut().zip(v).for_each(|(sum, v)| *sum += q * v);
        }
        sum
    }

    fn lift(&self, pair: &SmallPair, residual: f64) -> Eigenpair {
        let (vector_re, vector_im) = (self.combine(&pair.vector_re), self.combine(&pair.vector_im));
        Eigenpair { re: pair.re, im: pair.im, residual, vector_re, vector_im }
    }
}

fn inner(weight: &[f64], a: &[f64], b: &[f64]) -> f64 {
    weight.iter().zip(a).zip(b).map(|((w, a), b)| w * a * b).sum()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
