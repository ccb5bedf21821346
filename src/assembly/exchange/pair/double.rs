//! Double-double arithmetic: a number as the unevaluated sum of two f64, some 31 decimal digits.
//!
//! Source: Dekker (1971), "A floating-point technique for extending the available precision"; error bounds: Joldes, Muller and
//! Popescu (2017), "Tight and rigorous error bounds for basic building blocks of double-word arithmetic". Cost: 10 to 30 flops
//! a product or a sum, some 100 ns an angle, twice that a logarithm. What it does not do: infinities, and numbers beyond
//! 1e±140, whose products leave the range of the low part.

use super::angle;
use super::contour::ABREAST;
use super::real::Real;
use super::rules::gauss_nodes;
use std::f64::consts::{LN_2, PI};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::LazyLock;

/// high + low, |low| ≤ ½ ulp(high).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Double {
    high: f64,
    low: f64,
}

/// a + b exactly (Knuth).
#[inline(always)]
fn two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let b_part = high - a;
    Double { high, low: (a - (high - b_part)) + (b - b_part) }
}

/// a + b exactly, for |a| ≥ |b| (Dekker).
#[inline(always)]
fn quick_two_sum(a: f64, b: f64) -> Double {
    let high = a + b;
    Double { high, low: b - (high - a) }
}

/// a b exactly.
#[inline(always)]
fn two_product(a: f64, b: f64) -> Double {
    let high = a * b;
    Double { high, low: a.mul_add(b, -high) }
}

impl Double {
    const fn new(high: f64, low: f64) -> Self {
        Self { high, low }
    }

    /// The difference of two f64, exactly.
    pub fn difference(a: f64, b: f64) -> Self {
        two_sum(a, -b)
    }

    fn scaled(self, power_of_two: f64) -> Self {
        Self { high: self.high * power_of_two, low: self.low * power_of_two }
    }

    /// eˣ − 1 for |x| ≤ ½ by its series.
    fn exp_m1(self) -> Self {
        EXPONENTIAL.iter().rev().fold(Self::default(), |sum, coefficient| (sum + *coefficient) * self)
    }
}

/// 1/k! from k = 1.
static EXPONENTIAL: LazyLock<[Double; 25]> = LazyLock::new(|| {
    let mut inverse = Double::from(1.0);
    std::array::from_fn(|k| {
        inverse = inverse / Double::from((k + 1) as f64);
        inverse
    })
});

const PI_DOUBLE: Double = Double::new(PI, 1.224_646_799_147_353_2e-16);
const LN_2_DOUBLE: Double = Double::new(LN_2, 2.319_046_813_846_299_6e-17);

/// Angles of the table that directions are turned by, in a right angle.
const N_TURNS: usize = 256;

/// k π / (2 N_TURNS) with its cosine and sine.
static TURNS: LazyLock<Vec<[Double; 3]>> = LazyLock::new(|| {
    // The first by its series, the others by turning on; the errors add up to some N_TURNS ulp of 1e-32, most of which cancel.
    let step = PI_DOUBLE * Double::from(0.5 / N_TURNS as f64);
    let (mut cosine, mut sine, mut term) = (Double::from(1.0), Double::default(), Double::from(1.0));
    for k in 1..14 {
        term = term * step / Double::from(f64::from(k));
        match k % 4 {
            1 => sine = sine + term,
            2 => cosine = cosine - term,
            3 => sine = sine - term,
            _ => cosine = cosine + term,
        }
    }
    let mut turns = vec![[Double::default(), Double::from(1.0), Double::default()]];
    for k in 0..N_TURNS {
        let [_, c, s] = turns[k];
        turns.push([step * Double::from((k + 1) as f64), c * cosine - s * sine, s * cosine + c * sine]);
    }
    turns
});

const FIFTH: Double = Double::new(0.2, -1.110_223_024_625_156_6e-17);
const THIRD: Double = Double::new(0.333_333_333_333_333_3, 1.850_371_707_708_594_3e-17);

impl From<f64> for Double {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (mut sum, tail) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        sum = quick_two_sum(sum.high, sum.low + tail.high);
        quick_two_sum(sum.high, sum.low + tail.low)
    }
}

impl Neg for Double {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Double {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        let low = self.high.mul_add(other.low, self.low * other.high);
        quick_two_sum(product.high, product.low + low)
    }
}

impl Div for Double {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // Long division: three digits of 53 bits.
        let first = self.high / other.high;
        let rest = self - other * Double::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Double::from(second);
        quick_two_sum(first, second) + Double::from(rest.high / other.high)
    }
}

impl Real for Double {
    const EPSILON: f64 = f64::EPSILON * f64::EPSILON;
    const MOST_NODES: usize = 48;

    fn gauss(n: usize) -> &'static [(Self, Self)] {
        static RULES: LazyLock<Vec<Vec<(Double, Double)>>> =
            LazyLock::new(|| (0..=Double::MOST_NODES).map(|n| gauss_nodes(n, ABREAST)).collect());
        &RULES[n]
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.high + self.low
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::default();
        }
        // One step of Newton's method from the f64 root.
        let root = self.high.sqrt();
        let rest = self - two_product(root, root);
        quick_two_sum(root, rest.high / (2.0 * root))
    }

    fn ln(self) -> Self {
        // Take out the power of two: what is left is within √2 of 1.
        let exponent = self.high.log2().round();
        let fraction = self.scaled((-exponent).exp2());
        LN_2_DOUBLE * Double::from(exponent) + (fraction - Double::from(1.0)).ln_1p()
    }

    fn ln_1p(self) -> Self {
        if self.high.abs() > 0.5 {
            return (self + Double::from(1.0)).ln();
        }
        // Newton from f64: y ← y + (1 + x) e⁻ʸ − 1, without the ones; the next term is −½ of the step squared.
        let start = Double::from(self.high.ln_1p());
        let below = (-start).exp_m1();
        let step = self + below + self * below;
        start + (step - Double::from(0.5 * step.high * step.high))
    }

    #[inline(always)]
    fn angle(self, x: Self) -> Self {
        // Fold at the y axis, turn by the nearest angle of the table, and sum the series of what is left.
        let (y, across) = (self, if x.high < 0.0 { -x } else { x });
        if across.high == 0.0 && y.high <= 0.0 {
            return Self::default();
        }
        let nearest = (angle::angle(y.high, across.high) * (2 * N_TURNS) as f64 / PI).round().max(0.0);
        let [turn, cosine, sine] = TURNS[nearest as usize];
        let t = (y * cosine - across * sine) / (across * cosine + y * sine);
        // t² < 1e-5: from the third term on, f64 has the digits that are left.
        let square = t * t;
        let z = square.high;
        let tail = z * (z * (1.0 / 9.0 + z * (z / 13.0 - 1.0 / 11.0)) - 1.0 / 7.0);
        let series = square * (square * (FIFTH + Double::from(tail)) - THIRD);
        let angle = turn + (t + t * series);
        if x.high < 0.0 { PI_DOUBLE - angle } else { angle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Stream;

    /// Some ulp of 2⁻¹⁰⁴ for a dozen operations.
    const ROUNDING: f64 = 16.0 * Double::EPSILON;

    fn assert_equal(found: Double, expected: Double, scale: f64) {
        let error = (found - expected).value().abs();
        assert!(error <= ROUNDING * scale, "{found:?} for {expected:?}: {error:e}");
    }

    #[test]
    fn arithmetic_undoes_itself() {
        let mut stream = Stream::new(0x646f_7562, 0, 0);
        let mut number = || Double::from(stream.uniform() + 0.1) / Double::from(stream.uniform() + 0.1);
        for _ in 0..10_000 {
            let (x, y) = (number(), number());
            assert_equal(x / y * y, x, x.value());
            assert_equal(x + y - y, x, x.value() + y.value());
            assert_equal(x.sqrt() * x.sqrt(), x, x.value());
            assert_equal((x * y).ln(), x.ln() + y.ln(), 1.0 + x.ln().value().abs() + y.ln().value().abs());
            assert_equal(x.ln_1p(), (Double::from(1.0) + x).ln(), 1.0);
            // Angles add where complex numbers multiply.
            let (u, v) = (y.angle(x), x.angle(y));
            assert_equal(u + v, PI_DOUBLE * Double::from(0.5), 1.0);
            assert_equal((x * y + y * x).angle(x * x - y * y), u + u, 1.0);
        }
    }

    #[test]
    fn constants_come_out() {
        // Machin: π/4 = 4 arctan 1/5 − arctan 1/239.
        let arc = |n: f64| Double::from(1.0).angle(Double::from(n));
        let quarter = Double::from(4.0) * arc(5.0) - arc(239.0);
        assert_equal(quarter * Double::from(4.0), PI_DOUBLE, 4.0);
        // ln 2 = 18 artanh 1/26 − 2 artanh 1/4801 + 8 artanh 1/8749.
        let area = |n: f64| Double::from(0.5) * (Double::from(n + 1.0) / Double::from(n - 1.0)).ln();
        let two = Double::from(18.0) * area(26.0) - Double::from(2.0) * area(4801.0) + Double::from(8.0) * area(8749.0);
        assert_equal(two, LN_2_DOUBLE, 1.0);
    }
}
