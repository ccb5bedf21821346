//! Moments, hypothesis tests, confidence sequences and fits. Knows no light; the only door to `libm`.

mod binomial;
mod chi_squared;
mod confidence_sequence;
mod corrections;
mod covariance;
mod equivalence;
mod fit;
mod higher_moments;
mod moments;
mod normal;
mod p_values;
mod power;
pub mod special;
mod tails;
mod uniformity;
mod variance_test;
mod welch;

pub use binomial::{BinomialTest, binomial_interval, binomial_test};
pub use chi_squared::{ChiSquared, ChiSquaredError, MIN_EXPECTED, chi_squared_test};
pub use confidence_sequence::{ConfidenceError, EmpiricalBernstein, NormalMixture};
pub use corrections::{Correction, benjamini_hochberg, benjamini_yekutieli, holm, sidak, sidak_level};
pub use covariance::{ControlledMean, Covariance};
pub use equivalence::{
    Equivalence, equivalence_of_means, equivalence_power, equivalence_samples, equivalence_test, relative_equivalence,
};
pub use fit::{FitError, Line, fit_line, fit_power_law};
pub use higher_moments::HigherMoments;
pub use moments::{Moments, MomentsBlock};
pub use normal::{critical_z, two_sided_p, z_score};
pub use p_values::{PValueHistogram, p_value_histogram};
pub use power::{PowerError, detection_power, detection_samples};
pub use tails::{
    binomial_lower_tail, binomial_tail, chi_squared_critical, chi_squared_lower_tail, chi_squared_tail,
    fisher_critical, fisher_tail, normal_critical, normal_tail, student_critical, student_tail,
};
pub use uniformity::{KolmogorovSmirnov, UniformityError, kolmogorov_tail, uniformity_test};
pub use variance_test::{VarianceTest, VarianceTestError, variance_test, variance_test_of};
pub use welch::{TTest, welch_test};
use welch::{WelchError, welch_error};
