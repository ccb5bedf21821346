//! The directions that a matrix sends most into, found by random vectors.

use super::{Block, Dense, LinearOperator};
use crate::sampling::Streams;

/// Vectors that are added at a time.
const BATCH: usize = 16;

/// An orthonormal basis Q of what one band of A reaches, with ‖A − Q Qᵀ A‖ about the tolerance asked for.
pub struct Range {
    /// Q, n × rank.
    pub basis: Block,
    /// Qᵀ A, rank × n.
    pub coefficients: Dense,
    /// max ‖(A − Q Qᵀ A) ω‖ over the random vectors ω of variance 1 that were tried last: about the Frobenius norm of what is missing.
    pub missing: f64,
    /// Products of A or Aᵀ with one vector.
    pub n_products: usize,
}

impl Range {
    /// Adds batches of random vectors until what they still find is below the tolerance, or until every dimension is taken. One column of A
    /// times a vector for every vector, and one of Aᵀ for every basis vector; cost 2 n² (2 rank + batch) and n rank² for keeping orthogonal.
    /// Source: Halko, Martinsson and Tropp (2011), algorithm 4.2 and lemma 4.1.
    pub fn find(matrix: &Dense, tolerance: f64, seed: u64) -> Self {
        let n = matrix.n_columns();
        let streams = Streams::new(seed, "randomised range");
        let mut vectors: Vec<Vec<f64>> = Vec::new();
        let (mut missing, mut n_products) = (f64::INFINITY, 0);
        while vectors.len() < n && missing > tolerance {
            let first = vectors.len();
            let batch = BATCH.min(n - first);
            let random = Block::from_fn(n, batch, |i, c| {
                let mut stream = streams.stream((first + c) as u32, i as u64);
                // Centred uniforms of variance 1.
                (2.0 * stream.uniform() - 1.0) * 3f64.sqrt()
            });
            let mut images = Block::zeros(n, batch);
            matrix.apply(&random, &mut images);
            n_products += batch;
            missing = 0.0;
            for image in images.columns() {
                let mut image = image.to_vec();
                let whole = norm(&image);
                // Twice is enough (Giraud et al. 2005).
                (0..2).for_each(|_| orthogonalise(&mut image, &vectors));
                let left = norm(&image);
                missing = f64::max(missing, left);
                if left > n as f64 * f64::EPSILON * whole {
                    image.iter_mut().for_each(|v| *v /= left);
                    vectors.push(image);
                }
            }
            // Nothing new in a whole batch: the range is exhausted.
            if vectors.len() == first {
                break;
            }
        }
        n_products += vectors.len();
        let basis = Block::from_fn(n, vectors.len(), |i, c| vectors[c][i]);
        let mut coefficients = Block::zeros(n, vectors.len());
        matrix.apply_transpose(&basis, &mut coefficients);
        let coefficients = Dense::from_fn(vectors.len(), n, |r, c| coefficients.get(c, r));
        Self { basis, coefficients, missing, n_products }
    }

    /// Number of basis vectors.
    pub fn rank(&self) -> usize {
        self.basis.n_columns()
    }
}

fn orthogonalise(x: &mut [f64], basis: &[Vec<f64>]) {
    for q in basis {
        let share: f64 = q.iter().zip(&*x).map(|(q, x)| q * x).sum();
        x.iter_mut().zip(q).for_each(|(x, q)| *x -= share * q);
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}
