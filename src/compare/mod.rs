//! Answers held against answers: norms, z-scores, equivalence, rates.

mod equivalence;
mod norm;
mod pool;
mod rates;
mod zscore;

pub use equivalence::{EquivalenceVerdict, equivalent_blocks};
pub use norm::{relative_max, relative_rms};
pub use pool::{SCORES_A_COMPARISON, pooled};
pub use rates::{Extrapolation, Level, ObservedOrder, RatesError, observed_order, richardson};
pub use zscore::{ROUNDING_TOLERANCE, ZVerdict, compare_blocks, compare_blocks_anytime, p_value_map, p_values, z_map};
