//! How far apart two fields are, as one number.

use crate::linalg::Block;

/// max |value − reference| / max |reference| over all entries; NaN if anything is NaN.
///
/// A reference of zeros makes it 0 for equal fields and infinite for others.
///
/// # Panics
/// If the shapes differ.
pub fn relative_max(value: &Block, reference: &Block) -> f64 {
    let mut difference = value.clone();
    check_shapes(value, reference);
    difference.add_scaled(-1.0, reference);
    relative(difference.max_abs(), reference.max_abs())
}

/// √(Σ w (value − reference)² / Σ w reference²) over all entries, with one weight a row: their étendue, where rows are bundles.
///
/// A reference of zeros makes it 0 for equal fields and infinite for others.
///
/// # Panics
/// If the shapes differ, or there is not one weight a row.
pub fn relative_rms(value: &Block, reference: &Block, weights: &[f64]) -> f64 {
    check_shapes(value, reference);
    assert_eq!(weights.len(), reference.n_rows(), "there must be one weight a row");
    let (mut difference, mut size) = (0.0, 0.0);
    for (a, b) in value.columns().zip(reference.columns()) {
        for ((a, b), w) in a.iter().zip(b).zip(weights) {
            difference += w * (a - b) * (a - b);
            size += w * b * b;
        }
    }
    relative(difference.sqrt(), size.sqrt())
}

fn relative(difference: f64, size: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / size }
}

pub(super) fn check_shapes(a: &Block, b: &Block) {
    assert_eq!((a.n_rows(), a.n_columns()), (b.n_rows(), b.n_columns()), "fields to compare must have the same shape");
}
