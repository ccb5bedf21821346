//! Exchange of polygons that are close or touch: by contours in f64, and in double-double where too much cancels there.

use super::contour::{self, Integral};
use super::double::Double;
use super::real::{Real, Vector};
use pulp::Arch;

/// Error of the contour's value in ulp of its terms' size: more than twice the largest found on 3·10⁴ random pairs.
const ROUNDING: f64 = 2.0;

/// Shares of the tolerance that the contour's truncation may take, tried in turn.
const SHARES: [f64; 3] = [0.1, 1e-4, 1e-8];

/// What a result rounded to f64 can be asked for.
const FINEST: f64 = 2.0 * f64::EPSILON;

/// T of two polygons wholly in front of each other's planes, in common coordinates, and its error estimate.
pub struct Close {
    arch: Arch,
    corners: [Vec<Vector<Double>>; 2],
    /// The length that `corners` are measured in: a power of two, so that nothing is rounded, and logarithms are small.
    unit: f64,
}

impl Close {
    pub fn new(arch: Arch, corners: [Vec<Vector<Double>>; 2]) -> Self {
        // Go around the smaller one: the terms of its edges are small as well.
        let reach = |p: &Vec<Vector<Double>>| p.iter().map(|v| (*v - p[0]).rounded().length()).fold(0.0, f64::max);
        let [a, b] = corners;
        let corners = if reach(&b) < reach(&a) { [b, a] } else { [a, b] };
        let size = corners.iter().flatten().map(|v| v.rounded().length()).fold(0.0, f64::max);
        let unit = power_of_two(size);
        let scale = Double::from(1.0 / unit);
        Self { arch, corners: corners.map(|p| p.into_iter().map(|v| v.scaled(scale)).collect()), unit }
    }

    /// In f64; `None` where that does not reach the relative tolerance. T is of the order of `guess`.
    pub fn in_single(&self, guess: f64, tolerance: f64) -> Option<(f64, f64)> {
        let [a, b] = self.corners.each_ref().map(|p| p.iter().map(|v| v.rounded()).collect::<Vec<_>>());
        let mut guess = guess / (self.unit * self.unit);
        for _ in 0..2 {
            let found = contour::exchange(self.arch, &a, &b, SHARES[0] * tolerance * guess);
            let (value, error) = weighed(&found);
            if error <= tolerance * value {
                return Some(self.measured(value, error));
            }
            // Only a truncation allowed by too high a guess is worth another try.
            if found.truncation < 0.5 * error || error > 0.5 * value {
                return None;
            }
            guess = value;
        }
        None
    }

    /// In double-double: right to the last bits of f64 for T down to some 1e-16 of the contours' size.
    pub fn in_double(&self, guess: f64, tolerance: f64) -> Option<(f64, f64)> {
        let tolerance = tolerance.max(FINEST);
        let mut best = (0.0, f64::INFINITY);
        for share in SHARES {
            let found = contour::exchange(
                self.arch,
                &self.corners[0],
                &self.corners[1],
                share * tolerance * guess / (self.unit * self.unit),
            );
            best = weighed(&found);
            if best.1 <= tolerance * best.0 {
                break;
            }
        }
        (best.0 > 0.0).then(|| self.measured(best.0, best.1))
    }

    fn measured(&self, value: f64, error: f64) -> (f64, f64) {
        let square = self.unit * self.unit;
        (value * square, error * square)
    }
}

/// The largest power of two that is no larger: the number without its fraction.
fn power_of_two(size: f64) -> f64 {
    f64::from_bits(size.to_bits() & f64::INFINITY.to_bits())
}

/// The value and its error estimate.
fn weighed<R: Real>(found: &Integral<R>) -> (f64, f64) {
    let value = found.value.value();
    (value, found.truncation + ROUNDING * R::EPSILON * found.size + 0.5 * f64::EPSILON * value.abs())
}
