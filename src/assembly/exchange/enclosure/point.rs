//! Points and vectors whose coordinates are balls.

use super::ball::Ball;
use crate::geometry::Vec3;
use std::ops::{Add, Neg, Sub};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub x: Ball,
    pub y: Ball,
    pub z: Ball,
}

impl Point {
    /// (v − origin) · power, exactly; `power` is one of two.
    pub fn new(v: Vec3, origin: Vec3, power: f64) -> Self {
        let along = |v, origin| Ball::difference(v, origin).scaled(power);
        Self { x: along(v.x, origin.x), y: along(v.y, origin.y), z: along(v.z, origin.z) }
    }

    pub fn dot(self, other: Self) -> Ball {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// t times the vector.
    pub fn times(self, t: Ball) -> Self {
        Self { x: self.x * t, y: self.y * t, z: self.z * t }
    }

    /// The vector rounded to f64: each coordinate to its own last digit.
    pub fn rounded(self) -> Vec3 {
        Vec3::new(self.x.high, self.y.high, self.z.high)
    }

    /// No point of the box is further from its middle.
    pub fn doubt(self) -> f64 {
        self.x.radius + self.y.radius + self.z.radius
    }

    /// No vector in the box is longer.
    pub fn longest(self) -> f64 {
        let [x, y, z] = [self.x, self.y, self.z].map(Ball::magnitude);
        (x * x + y * y + z * z).sqrt() * (1.0 + 8.0 * f64::EPSILON) + f64::MIN_POSITIVE
    }

    /// No vector in the box is shorter.
    pub fn shortest(self) -> f64 {
        let [x, y, z] = [self.x, self.y, self.z].map(Ball::mignitude);
        (x * x + y * y + z * z).sqrt() * (1.0 - 8.0 * f64::EPSILON)
    }

    /// True if both are the same point and known exactly.
    pub fn is_exactly(self, other: Self) -> bool {
        let same = |a: Ball, b: Ball| a == b && a.radius == 0.0;
        same(self.x, other.x) && same(self.y, other.y) && same(self.z, other.z)
    }
}

impl Add for Point {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Point {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Neg for Point {
    type Output = Self;

    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}
