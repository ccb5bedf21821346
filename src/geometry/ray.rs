//! Half-lines.

use super::Vec3;

/// The half-line origin + t direction, t > 0. The direction need not have unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    pub origin: Vec3,
    pub direction: Vec3,
}

impl Ray {
    /// The point at parameter t.
    pub fn at(&self, t: f64) -> Vec3 {
        self.origin + self.direction * t
    }
}
