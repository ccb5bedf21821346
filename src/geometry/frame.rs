//! Local coordinates on a surface.

use super::Vec3;

/// A right-handed orthonormal frame whose z axis is a surface normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub x: Vec3,
    pub y: Vec3,
    pub z: Vec3,
}

impl Frame {
    /// The frame about a unit normal, x and y chosen reproducibly (Duff et al. 2017, "Building an orthonormal basis, revisited").
    pub fn about(normal: Vec3) -> Self {
        let (x, y) = normal.any_orthonormal_pair();
        Self { x, y, z: normal }
    }

    /// Local to world.
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        v.x * self.x + v.y * self.y + v.z * self.z
    }

    /// World to local.
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }
}
