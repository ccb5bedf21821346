//! ln and the angle of a vector on balls, from tables that build themselves.
//!
//! Both come down to one series, z (1 ± z²/3 + z⁴/5 ± …), at |z| ≤ 1/500:
//! ln x = k ln 2 + ln c + 2 artanh((m − c)/(m + c)) for x = 2ᵏ m and the multiple c of 1/256 next to m;
//! arctan t = arctan c + arctan((t − c)/(1 + t c)). The tables are summed from the same series, of more terms. Nothing of the platform's
//! mathematical library is believed. Cost: one quotient, some six products.

use super::ball::Ball;
use std::sync::LazyLock;

/// Entries of a table over a unit interval.
const N: usize = 256;

/// Terms of the series that the tables are made of: at |z|² ≤ 0.18, what is left is below 1e-38.
const N_TERMS: usize = 50;

struct Tables {
    /// 1/(2j + 1).
    coefficients: Vec<Ball>,
    /// ln(1 + i/N).
    ln: Vec<Ball>,
    /// arctan(i/N).
    arctan: Vec<Ball>,
    pi: Ball,
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let whole = |n: usize| Ball::exact(n as f64);
    let coefficients: Vec<Ball> = (0..N_TERMS).map(|j| Ball::ONE.over(whole(2 * j + 1))).collect();
    let series = |z: Ball, sign: f64| {
        let square = z * z;
        let rest = Ball::around(0.0, 2.0 * square.magnitude().powi(N_TERMS as i32));
        let square = if sign < 0.0 { -square } else { square };
        z * (coefficients.iter().rev().fold(Ball::ZERO, |sum, c| *c + square * sum) + rest)
    };
    // ln(1 + i/N) = 2 artanh(i/(2N + i)); arctan t = 2 arctan(t/(1 + √(1 + t²))).
    let ln = (0..=N).map(|i| series(whole(i).over(whole(2 * N + i)), 1.0).scaled(2.0)).collect();
    let halved = |t: Ball| t.over(Ball::ONE + (Ball::ONE + t * t).sqrt());
    let arctan: Vec<Ball> =
        (0..=N).map(|i| series(halved(Ball::exact(i as f64 / N as f64)), -1.0).scaled(2.0)).collect();
    let pi = arctan[N].scaled(4.0);
    Tables { coefficients, ln, arctan, pi }
});

impl Tables {
    /// z (1 + s z²/3 + z⁴/5 + s z⁶/7 + …): artanh for s = 1, arctan for s = −1. Terms from z⁶/7 on need f64 only.
    fn odd_series(&self, z: Ball, sign: f64) -> Ball {
        let square = z * z;
        let largest = square.magnitude();
        if largest.is_nan() || largest >= 0.25 {
            return Ball::ENTIRE;
        }
        let q = sign * square.high;
        let value = 1.0 / 7.0 + q * (1.0 / 9.0 + q * (1.0 / 11.0 + q * (1.0 / 13.0)));
        // Rounding, the ball of z² (the tail's derivative is below 1/2), and the terms left out, a geometric series.
        let radius = 4.0 * f64::EPSILON + 0.5 * (square.radius + square.low.abs()) + 0.1 * largest.powi(4);
        let q = if sign < 0.0 { -square } else { square };
        let [_, third, fifth, ..] = self.coefficients[..] else { return Ball::ENTIRE };
        z * (Ball::ONE + q * (third + q * (fifth + q * Ball::around(value, radius))))
    }
}

/// π.
pub fn pi() -> Ball {
    TABLES.pi
}

/// ln of a ball of positive numbers; the whole line if there are others.
pub fn ln(x: Ball) -> Ball {
    const FRACTION: u64 = (1 << 52) - 1;
    if x.lower() <= f64::MIN_POSITIVE || !x.is_finite() {
        return Ball::ENTIRE;
    }
    let bits = x.high.to_bits();
    let exponent = (bits >> 52) as i32 - 1023;
    let leading = f64::from_bits(bits & FRACTION | 1023 << 52);
    let i = ((leading - 1.0) * N as f64).round() as usize;

    // Take the power of two out in two steps, for either may be subnormal alone.
    let half = exponent / 2;
    let m = x.scaled(power_of_two(-half)).scaled(power_of_two(half - exponent));
    let c = Ball::exact(1.0 + i as f64 / N as f64);
    let tables = &*TABLES;
    let rest = tables.odd_series((m - c).over(m + c), 1.0).scaled(2.0);
    Ball::exact(f64::from(exponent)) * tables.ln[N] + tables.ln[i] + rest
}

fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// The angle in [0, π] of the vectors (x, y), y ≥ 0 wherever it matters: [0, π] if they may be zero.
pub fn angle(y: Ball, x: Ball) -> Ball {
    let tables = &*TABLES;
    let (steep, flat) = (y.high.abs() > x.high.abs(), x.high > 0.0);
    let anything = || Ball::around(1.6, 1.6);
    if steep {
        // π/2 − arctan(x/y).
        let rest = arctan(tables, x, y);
        if rest.is_finite() { tables.pi.scaled(0.5) - rest } else { anything() }
    } else {
        let rest = arctan(tables, y, x);
        match (rest.is_finite(), flat) {
            (false, _) => anything(),
            (true, true) => rest,
            (true, false) => tables.pi + rest,
        }
    }
}

/// arctan(a/b) for |a| ≤ |b|.
fn arctan(tables: &Tables, a: Ball, b: Ball) -> Ball {
    let ratio = a.high / b.high;
    let i = (ratio.abs() * N as f64).round();
    if i.is_nan() || i > N as f64 {
        return Ball::ENTIRE;
    }
    let c = Ball::exact((i / N as f64).copysign(ratio));
    let rest = tables.odd_series((a - c * b).over(b + c * a), -1.0);
    let base = tables.arctan[i as usize];
    if ratio < 0.0 { rest - base } else { rest + base }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Stream;
    use std::f64::consts::{FRAC_PI_4, LN_2, LN_10, PI};

    /// Uncertainty of a value given to 32 digits.
    const GIVEN: f64 = 1e-32;

    fn holds(ball: Ball, (high, low): (f64, f64)) -> bool {
        let value = Ball { high, low, radius: GIVEN * high.abs() };
        (ball - value).mignitude() == 0.0 && ball.radius < 1e-30 * (1.0 + high.abs())
    }

    /// f64 arguments; values from 90-digit arithmetic, as a sum of two f64.
    #[test]
    fn logarithms_hold_known_values() {
        for (x, value) in [
            (2.0, (LN_2, 2.3190468138462996e-17)),
            (3.0, (1.0986122886681098, -9.07129723500153e-17)),
            (10.0, (LN_10, -2.1707562233822494e-16)),
            (0.7, (-0.35667494393873245, 4.82556379937662e-18)),
            (1e-20, (-46.051701859880914, 7.339520394182075e-16)),
            (1e20, (46.051701859880914, -7.88798767963998e-16)),
            (1.0000001, (9.999999505838704e-08, 1.5249709528441489e-24)),
            (0.9999999, (-1.0000000494736474e-07, -5.529865283193222e-24)),
            (0.123, (-2.0955709236097197, 1.777473147890012e-16)),
        ] {
            assert!(holds(ln(Ball::exact(x)), value), "ln {x}: {:?}", ln(Ball::exact(x)));
        }
        assert!(ln(Ball::ONE).magnitude() < 1e-30);
        assert!(!ln(Ball::around(1.0, 1.0)).is_finite());
    }

    #[test]
    fn angles_hold_known_values() {
        for (y, x, value) in [
            (1.0, 1.0, (FRAC_PI_4, 3.061616997868383e-17)),
            (1.0, 3.0, (0.3217505543966422, 7.917392525722143e-18)),
            (1.0, -3.0, (2.819842099193151, 5.903613615775535e-17)),
            (0.7, 0.2, (1.2924966677897853, -9.972945404658236e-17)),
            (0.7, -0.2, (1.849095985800008, 1.4952903628636544e-19)),
            (1e-9, 1.0, (1e-9, -3.3333333333333338e-28)),
            (1e-9, -1.0, (3.141592652589793, 2.0520505085187742e-16)),
            (1.0, 1e-12, (1.5707963267938967, -7.191168262663192e-17)),
        ] {
            let found = angle(Ball::exact(y), Ball::exact(x));
            assert!(holds(found, value), "angle of ({x}, {y}): {found:?}");
        }
        // π, from the first 32 digits.
        assert!(holds(pi(), (PI, 1.2246467991473532e-16)));
        let unknown = angle(Ball::around(0.0, 1e-3), Ball::around(0.0, 1e-3));
        assert!(unknown.lower() <= 0.0 && unknown.upper() >= PI);
    }

    #[test]
    fn identities_hold_everywhere() {
        let mut stream = Stream::new(0x656c_656d, 0, 0);
        for _ in 0..20_000 {
            let mut positive = || Ball::exact((60.0 * stream.uniform() - 30.0).exp());
            let (x, y) = (positive(), positive());
            let logarithms = ln(x * y) - ln(x) - ln(y);
            assert!(logarithms.mignitude() == 0.0 && logarithms.radius < 1e-28, "{x:?} {y:?}: {logarithms:?}");
            // The angle of a product of complex numbers is the sum of theirs; both are below π/2.
            let angles = angle(x * y + x * y, x * x - y * y) - angle(y, x).scaled(2.0);
            assert!(angles.mignitude() == 0.0 && angles.radius < 1e-28, "{x:?} {y:?}: {angles:?}");
        }
    }

    #[test]
    fn wide_balls_hold_the_values_near_their_ends() {
        let mut stream = Stream::new(0x656c_656d, 1, 0);
        for _ in 0..20_000 {
            let x = 0.1 + 10.0 * stream.uniform();
            let radius = 0.2 * x * stream.uniform();
            let wide = ln(Ball::around(x, radius));
            for end in [x - 0.999 * radius, x + 0.999 * radius] {
                let value = ln(Ball::exact(end));
                assert!(wide.lower() <= value.upper() && value.lower() <= wide.upper(), "{x} ± {radius}");
            }
        }
    }
}
