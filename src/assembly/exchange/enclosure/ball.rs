//! Balls on the real line: a double-double midpoint (some 32 digits) and a radius rounded outward.
//!
//! Every operation returns a ball that holds the exact result for all numbers in its operands. With u = 2⁻⁵³, the sum and the product
//! of two double-doubles are off by at most 3u² + 13u³ and less than 6u² (Joldes, Muller and Popescu 2017, "Tight and rigorous error
//! bounds for basic building blocks of double-word arithmetic", algorithms 6 and 10; Muller and Rideau 2022 prove both formally); 8u²
//! is charged for either. Quotients and square roots are guessed and then bounded by what multiplying back leaves, so that no
//! further theorem is needed. Products are split by Dekker's method and need no fused instruction.
//!
//! Operands that are plain f64 and give a plain f64 stay exact: radius 0.

use std::ops::{Add, Mul, Neg, Sub};

/// Charged on each sum and product, relative: 8u².
const ROUNDING: f64 = 8.0 * (f64::EPSILON / 2.0) * (f64::EPSILON / 2.0);

/// Covers the rounding of up to ten operations on non-negative numbers.
const OUTWARD: f64 = 1.0 + 16.0 * f64::EPSILON;

/// Products below this may lose digits of their error term to underflow.
const UNDERFLOW: f64 = 1e-250;

/// All x with |x − (high + low)| ≤ radius; high is high + low rounded. A radius that is infinite or no number means the whole line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    pub high: f64,
    pub low: f64,
    pub radius: f64,
}

impl Ball {
    pub const ZERO: Self = Self::exact(0.0);
    pub const ONE: Self = Self::exact(1.0);
    pub const ENTIRE: Self = Self { high: 0.0, low: 0.0, radius: f64::INFINITY };

    /// This number and no other.
    pub const fn exact(value: f64) -> Self {
        Self { high: value, low: 0.0, radius: 0.0 }
    }

    /// All numbers within `radius` of `value`.
    pub const fn around(value: f64, radius: f64) -> Self {
        Self { high: value, low: 0.0, radius }
    }

    /// a − b of two plain numbers, exactly.
    pub fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        Self { high, low, radius: 0.0 }
    }

    /// The same midpoint without its uncertainty: another number, but one that is known exactly.
    pub fn midpoint(self) -> Self {
        Self { radius: 0.0, ..self }
    }

    /// The same midpoint with this much more uncertainty.
    pub fn widened(self, by: f64) -> Self {
        Self { radius: (self.radius + by) * OUTWARD, ..self }
    }

    /// No number in the ball is greater.
    pub fn upper(self) -> f64 {
        if self.is_plain() {
            return self.high;
        }
        ((self.low + self.radius).next_up() + self.high).next_up()
    }

    /// No number in the ball is less.
    pub fn lower(self) -> f64 {
        if self.is_plain() {
            return self.high;
        }
        ((self.low - self.radius).next_down() + self.high).next_down()
    }

    /// No number in the ball is greater in magnitude.
    pub fn magnitude(self) -> f64 {
        (self.high.abs() + self.low.abs() + self.radius) * OUTWARD
    }

    /// No number in the ball is less in magnitude; 0 if the ball holds zero.
    pub fn mignitude(self) -> f64 {
        if self.high > 0.0 { self.lower().max(0.0) } else { (-self.upper()).max(0.0) }
    }

    /// True if the ball is one f64.
    fn is_plain(self) -> bool {
        self.low == 0.0 && self.radius == 0.0
    }

    /// True if the ball is the number 0.
    pub fn is_zero(self) -> bool {
        self.high == 0.0 && self.is_plain()
    }

    pub fn is_finite(self) -> bool {
        self.high.is_finite() && self.radius.is_finite()
    }

    /// Times a power of two.
    pub fn scaled(self, power: f64) -> Self {
        let (high, low, radius) = (self.high * power, self.low * power, self.radius * power);
        let is_exact = [(self.high, high), (self.low, low), (self.radius, radius)]
            .iter()
            .all(|(before, after)| *before == 0.0 || after.abs() > UNDERFLOW);
        Self { high, low, radius: if is_exact { radius } else { radius + f64::MIN_POSITIVE } }
    }

    /// √ of the non-negative numbers in the ball.
    pub fn sqrt(self) -> Self {
        if self.is_zero() {
            return self;
        }
        let is_clear_of_zero = self.lower() > UNDERFLOW;
        if !is_clear_of_zero {
            // 0 … √upper.
            let half = 0.5 * self.upper().max(0.0).sqrt().next_up();
            return Self::around(half, half * OUTWARD + f64::MIN_POSITIVE);
        }
        // |√x − s| = |x − s²| / (√x + s).
        let root = self.high.sqrt();
        let rest = (self.midpoint() - Self::exact(root) * Self::exact(root)).high;
        let (high, low) = fast_two_sum(root, rest / (2.0 * root));
        let guess = Self { high, low, radius: 0.0 };
        let left = self - guess * guess;
        if left.is_zero() { guess } else { guess.widened(left.magnitude() / high * OUTWARD) }
    }

    /// All quotients; the whole line if the divisor's ball holds zero.
    pub fn over(self, divisor: Self) -> Self {
        let least = divisor.mignitude();
        let has_inverse = least > 0.0;
        if !has_inverse {
            return Self::ENTIRE;
        }
        // |x/y − q| = |x − q y| / |y|.
        let first = self.high / divisor.high;
        let rest = (self.midpoint() - Self::exact(first) * divisor.midpoint()).high;
        let (high, low) = fast_two_sum(first, rest / divisor.high);
        let guess = Self { high, low, radius: 0.0 };
        let left = self - guess * divisor;
        if left.is_zero() { guess } else { guess.widened(left.magnitude() / least * OUTWARD) }
    }
}

impl Neg for Ball {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low, radius: self.radius }
    }
}

impl Add for Ball {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let (sum, error) = two_sum(self.high, other.high);
        let radius = self.radius + other.radius;
        if self.low == 0.0 && other.low == 0.0 {
            return Self { high: sum, low: error, radius: radius * OUTWARD };
        }
        let (lows, lost) = two_sum(self.low, other.low);
        let (middle, carried) = fast_two_sum(sum, error + lows);
        let (high, low) = fast_two_sum(middle, lost + carried);
        Self { high, low, radius: (radius + ROUNDING * high.abs()) * OUTWARD + f64::MIN_POSITIVE }
    }
}

impl Sub for Ball {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Ball {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let (product, error) = two_product(self.high, other.high);
        let size = (self.high.abs() + self.radius) * other.radius + self.radius * other.high.abs();
        let is_plain = self.low == 0.0 && other.low == 0.0;
        if is_plain && (product.abs() > UNDERFLOW || self.high == 0.0 || other.high == 0.0) {
            return Self { high: product, low: error, radius: size * OUTWARD };
        }
        if self.is_zero() && other.is_finite() || other.is_zero() && self.is_finite() {
            return Self::ZERO;
        }
        let crossed = self.high * other.low + self.low * other.high;
        let (high, low) = fast_two_sum(product, error + crossed);
        Self { high, low, radius: (size + ROUNDING * high.abs()) * OUTWARD + f64::MIN_POSITIVE }
    }
}

/// a + b as its rounded value and what rounding lost (Knuth).
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let from_b = sum - a;
    let from_a = sum - from_b;
    (sum, (a - from_a) + (b - from_b))
}

/// The same for |a| ≥ |b| (Dekker).
#[inline]
fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// a b as its rounded value and what rounding lost (Dekker, Veltkamp).
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    (product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2)
}

/// Two halves of 26 bits.
#[inline]
fn split(a: f64) -> (f64, f64) {
    let shifted = 134_217_729.0 * a;
    let high = shifted - (shifted - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Stream;

    /// A whole number below 2¹⁰⁰ in magnitude, and the ball of it.
    fn whole(stream: &mut Stream) -> (i128, Ball) {
        let bits = 1 + stream.bits() % 100;
        let value = ((i128::from(stream.bits()) << 64 | i128::from(stream.bits())) >> (127 - bits)) * 2 + 1;
        let high = value as f64;
        (value, Ball { high, low: (value - high as i128) as f64, radius: 0.0 })
    }

    #[test]
    fn sums_hold_the_exact_sum_of_whole_numbers() {
        let mut stream = Stream::new(0x6261_6c6c, 0, 0);
        for _ in 0..100_000 {
            let ((a, x), (b, y)) = (whole(&mut stream), whole(&mut stream));
            let sum = x + y;
            // What is left of the exact sum after the midpoint is a whole number again.
            let left = (a + b - sum.high as i128) as f64 - sum.low;
            assert!(left.abs() <= sum.radius, "{a} + {b}: {sum:?}");
            assert!(sum.radius <= 2e-31 * sum.high.abs() + 1e-300, "{a} + {b}: {sum:?}");
        }
    }

    #[test]
    fn products_hold_the_exact_product_of_whole_numbers() {
        let mut stream = Stream::new(0x6261_6c6c, 1, 0);
        for _ in 0..100_000 {
            // Sixty bits each: more than an f64 holds, and the product still fits.
            let [a, b] = [(); 2].map(|()| i128::from(stream.bits() as i64) >> 3);
            let ball = |a: i128| Ball { high: a as f64, low: (a - a as f64 as i128) as f64, radius: 0.0 };
            let product = ball(a) * ball(b);
            let left = (a * b - product.high as i128) as f64 - product.low;
            assert!(left.abs() <= product.radius, "{a} × {b}: {product:?}");
            assert!(product.radius <= 2e-31 * product.high.abs(), "{a} × {b}: {product:?}");
        }
    }

    #[test]
    fn quotients_and_roots_hold_what_they_undo() {
        let mut stream = Stream::new(0x6261_6c6c, 2, 0);
        for _ in 0..20_000 {
            let ((_, x), (_, y)) = (whole(&mut stream), whole(&mut stream));
            let holds = |ball: Ball, of: Ball| (ball - of).mignitude() == 0.0;
            let quotient = (x * y).over(y);
            assert!(holds(quotient, x) && quotient.radius < 1e-30 * x.magnitude(), "{x:?} {y:?}: {quotient:?}");
            let root = (x * x).sqrt();
            let size = if x.high < 0.0 { -x } else { x };
            assert!(holds(root, size) && root.radius < 1e-30 * x.magnitude(), "{x:?}: {root:?}");
        }
        // √2, √0.1 and √1e-30 (the f64) to 32 digits.
        for (x, high, low) in [
            (2.0, std::f64::consts::SQRT_2, -9.667293313452913e-17),
            (0.1, 0.31622776601683794, 8.004969469767158e-19),
            (1e-30, 1e-15, -3.6037189572868085e-32),
        ] {
            let left = Ball::exact(x).sqrt() - Ball { high, low, radius: 0.0 };
            assert!(left.magnitude() < 1e-30 * high, "√{x}: {left:?}");
        }
    }

    #[test]
    fn radii_travel_through_every_operation() {
        let mut stream = Stream::new(0x6261_6c6c, 3, 0);
        for _ in 0..20_000 {
            let mut number = || 4.0 * stream.uniform() - 2.0;
            let (a, b) = (number(), number());
            // Balls somewhere about the numbers, wide enough to hold them.
            let mut ball = |value: f64| {
                let centre = value + 0.1 * number();
                Ball::around(centre, (centre - value).abs().next_up())
            };
            let (x, y) = (ball(a), ball(b));
            let holds = |ball: Ball, of: Ball| ball.lower() <= of.upper() && of.lower() <= ball.upper();
            let (p, q) = (Ball::exact(a), Ball::exact(b));
            assert!(holds(x + y, p + q) && holds(x - y, p - q) && holds(x * y, p * q) && holds(x.over(y), p.over(q)));
            if a > 0.0 {
                assert!(holds(x.sqrt(), p.sqrt()));
            }
            assert!(x.lower() <= a && a <= x.upper() && x.mignitude() <= a.abs() && a.abs() <= x.magnitude());
        }
    }

    #[test]
    fn plain_numbers_stay_exact_and_zero_divides_nothing() {
        let product = Ball::exact(3.0) * Ball::exact(0.25) - Ball::exact(0.75);
        assert!(product.is_zero());
        assert!((Ball::difference(0.7, 0.1) * Ball::ZERO).is_zero());
        assert!(!Ball::ONE.over(Ball::around(1e-3, 1e-3)).is_finite());
        assert!(Ball::around(0.0, 1.0).sqrt().lower() <= 0.0 && Ball::around(0.0, 1.0).sqrt().upper() >= 1.0);
        // 1 + 1e-200 is neither of its neighbours.
        let close = Ball::ONE + Ball::exact(1e-200);
        assert!(close.lower() <= 1.0 && close.upper() >= 1.0f64.next_up());
    }
}
