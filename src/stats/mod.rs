//! Moments, hypothesis tests and fits. Knows no light; the only door to `libm`.

mod chi_squared;
mod fit;
mod moments;
mod normal;
pub mod special;
mod tails;
mod welch;

pub use chi_squared::{ChiSquared, ChiSquaredError, MIN_EXPECTED, chi_squared_test};
pub use fit::{FitError, Line, fit_line, fit_power_law};
pub use moments::{Moments, MomentsBlock};
pub use normal::{critical_z, sidak, sidak_level, two_sided_p, z_score};
pub use tails::{
    binomial_lower_tail, binomial_tail, chi_squared_critical, chi_squared_lower_tail, chi_squared_tail,
    fisher_critical, fisher_tail, normal_critical, normal_tail, student_critical, student_tail,
};
pub use welch::{TTest, welch_test};
