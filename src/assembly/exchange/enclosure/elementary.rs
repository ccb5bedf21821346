//! ln and the angle of a vector on balls, from tables that build themselves.
//!
//! Both come down to one series, z (1 ± z²/3 + z⁴/5 ± …), at |z| ≤ 1/500:
//! ln x = k ln 2 + ln c + 2 artanh((m − c)/(m + c)) for x = 2ᵏ m and a multiple c of 1/256 next to m;
//! arctan t = arctan c + arctan((t − c)/(1 + t c)). The table is summed by the same identities from one entry to the next.
//! Nothing of the platform's mathematical library is believed. Cost: one quotient, some six products.

use super::ball::Ball;
use std::sync::LazyLock;

/// Entries of a table over a unit interval.
const N: usize = 256;

struct Tables {
    third: Ball,
    fifth: Ball,
    /// ln(1 + i/N).
    ln: Vec<Ball>,
    /// arctan(i/N).
    arctan: Vec<Ball>,
    pi: Ball,
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let inverse = |n: f64| Ball::ONE.over(Ball::exact(n));
    let mut tables =
        Tables { third: inverse(3.0), fifth: inverse(5.0), ln: vec![Ball::ZERO], arctan: vec![Ball::ZERO], pi: Ball::ZERO };
    let (mut ln, mut arctan) = (Ball::ZERO, Ball::ZERO);
    for i in 0..N {
        // ln((N+i+1)/(N+i)) = 2 artanh(1/(2(N+i)+1)); tan(α − β) = 1/N / (1 + i(i+1)/N²).
        ln = ln + tables.odd_series(inverse((2 * (N + i) + 1) as f64), 1.0).scaled(2.0);
        let step = Ball::exact(N as f64).over(Ball::exact((N * N + i * (i + 1)) as f64));
        arctan = arctan + tables.odd_series(step, -1.0);
        tables.ln.push(ln);
        tables.arctan.push(arctan);
    }
    tables.pi = arctan.scaled(4.0);
    tables
});

impl Tables {
    /// z (1 + s z²/3 + z⁴/5 + s z⁶/7 + …): artanh for s = 1, arctan for s = −1. Terms from z⁶/7 on need f64 only.
    fn odd_series(&self, z: Ball, sign: f64) -> Ball {
        let square = z * z;
        let largest = square.magnitude();
        if !(largest < 0.25) {
            return Ball::ENTIRE;
        }
        let q = sign * square.high;
        let value = 1.0 / 7.0 + q * (1.0 / 9.0 + q * (1.0 / 11.0 + q * (1.0 / 13.0)));
        // Rounding, the ball of z² (the tail's derivative is below 1/2), and the terms left out, a geometric series.
        let radius = 4.0 * f64::EPSILON + 0.5 * (square.radius + square.low.abs()) + 0.1 * largest.powi(4);
        let q = if sign < 0.0 { -square } else { square };
        z * (Ball::ONE + q * (self.third + q * (self.fifth + q * Ball::around(value, radius))))
    }
}

/// π.
pub fn pi() -> Ball {
    TABLES.pi
}

/// ln of a ball of positive numbers; the whole line if there are others.
pub fn ln(x: Ball) -> Ball {
    const FRACTION: u64 = (1 << 52) - 1;
    if !(x.lower() > f64::MIN_POSITIVE) || !x.is_finite() {
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
    if !(i <= N as f64) {
        return Ball::ENTIRE;
    }
    let c = Ball::exact((i / N as f64).copysign(ratio));
    let rest = tables.odd_series((a - c * b).over(b + c * a), -1.0);
    let base = tables.arctan[i as usize];
    if ratio < 0.0 { rest - base } else { rest + base }
}
