//! The spectrum of K: how fast light dies away, and what that says of every method before it is run.

mod krylov_schur;
mod leading;
pub mod prediction;
mod radius;
mod rank;
mod truncation;

pub use krylov_schur::{Eigen, Eigenpair};
pub use leading::{
    SingularValues, Spectrum, all_singular_values, condition, effective_rank, leading_eigenpairs,
    leading_singular_values,
};
pub use radius::{RadiusBounds, SpectralRadius, largest_gain, spectral_radius};
pub use rank::{RankBounds, rank_bounds};
pub use truncation::TruncationBound;
