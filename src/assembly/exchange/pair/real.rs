//! The numbers that the contour integral is computed in: f64, and double-double where f64 has no digits left.

use super::angle::angle;
use super::contour::ABREAST;
use super::double::Double;
use super::rules::gauss_nodes;
use crate::geometry::Vec3;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::LazyLock;

/// A real number of some precision.
pub trait Real:
    Copy
    + 'static
    + Debug
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Relative rounding of one operation.
    const EPSILON: f64;
    /// Nodes of the longest Gauss rule worth its while.
    const MOST_NODES: usize;

    /// Nodes and weights of Gauss' rule on [0, 1] with 1 ≤ n ≤ MOST_NODES nodes.
    fn gauss(n: usize) -> &'static [(Self, Self)];

    /// The nearest f64.
    fn value(self) -> f64;
    /// The root, zero of what is not positive.
    fn sqrt(self) -> Self;
    /// Natural logarithm of a positive number.
    fn ln(self) -> Self;
    /// ln(1 + self).
    fn ln_1p(self) -> Self;
    /// Angle in [0, π] of (x, self), self ≥ 0, from the x axis; zero at the origin.
    fn angle(self, x: Self) -> Self;
}

impl Real for f64 {
    const EPSILON: f64 = f64::EPSILON;
    const MOST_NODES: usize = 24;

    fn gauss(n: usize) -> &'static [(f64, f64)] {
        static RULES: LazyLock<Vec<Vec<(f64, f64)>>> =
            LazyLock::new(|| (0..=f64::MOST_NODES).map(|n| gauss_nodes(n, ABREAST)).collect());
        &RULES[n]
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        self.max(0.0).sqrt()
    }

    fn ln(self) -> f64 {
        f64::ln(self)
    }

    fn ln_1p(self) -> f64 {
        f64::ln_1p(self)
    }

    #[inline(always)]
    fn angle(self, x: f64) -> f64 {
        angle(self, x)
    }
}

/// A point or a vector in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<R> {
    pub x: R,
    pub y: R,
    pub z: R,
}

impl<R: Real> Vector<R> {
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub fn length(self) -> R {
        self.dot(self).sqrt()
    }

    #[inline(always)]
    pub fn scaled(self, factor: R) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<R: Real> Add for Vector<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<R: Real> Sub for Vector<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Vector<Double> {
    /// From one point to another, exactly.
    pub fn difference(from: Vec3, to: Vec3) -> Self {
        let [x, y, z] = [(to.x, from.x), (to.y, from.y), (to.z, from.z)].map(|(to, from)| Double::difference(to, from));
        Self { x, y, z }
    }

    /// From one point to others, exactly.
    pub fn from_point(origin: Vec3, points: &[Vec3]) -> Vec<Self> {
        points.iter().map(|p| Self::difference(origin, *p)).collect()
    }

    /// The nearest vector of f64.
    pub fn rounded(self) -> Vector<f64> {
        Vector { x: self.x.value(), y: self.y.value(), z: self.z.value() }
    }
}
