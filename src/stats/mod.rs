//! Moments, hypothesis tests and fits. Knows no light; the only door to `statrs`.

mod chi_squared;
mod fit;
mod moments;
mod normal;
pub mod special;
mod welch;

pub use chi_squared::{ChiSquared, ChiSquaredError, MIN_EXPECTED, chi_squared_test};
pub use fit::{FitError, Line, fit_line, fit_power_law};
pub use moments::{Moments, MomentsBlock};
pub use normal::{critical_z, sidak, sidak_level, two_sided_p, z_score};
pub use welch::{TTest, welch_test};
