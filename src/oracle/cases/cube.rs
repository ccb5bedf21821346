//! The inside of a cube, face by face, and cells of its faces.

use super::error::CaseError;
use crate::geometry::{Polygon, Vec3};

/// One face of the cube [0, side]³: a corner, and the two axes of its cells in the order x, y, z.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    corner: Vec3,
    first: Vec3,
    second: Vec3,
    /// True if first × second points out of the cube.
    turned: bool,
}

/// The faces at z = 0, z = side, y = 0, y = side, x = 0, x = side, all facing inward.
pub fn faces(side: f64) -> [Face; 6] {
    let (x, y, z) = (side * Vec3::X, side * Vec3::Y, side * Vec3::Z);
    let face = |corner, first, second, turned| Face { corner, first, second, turned };
    [
        face(Vec3::ZERO, x, y, false),
        face(z, x, y, true),
        face(Vec3::ZERO, x, z, true),
        face(y, x, z, false),
        face(Vec3::ZERO, y, z, false),
        face(x, y, z, true),
    ]
}

impl Face {
    /// The cell between these shares of the two axes.
    ///
    /// # Errors
    /// A cell that is no polygon.
    pub fn cell(&self, [left, right]: [f64; 2], [low, high]: [f64; 2]) -> Result<Polygon, CaseError> {
        let point = |s: f64, t: f64| self.corner + s * self.first + t * self.second;
        let mut corners = vec![point(left, low), point(right, low), point(right, high), point(left, high)];
        if self.turned {
            corners.reverse();
        }
        Polygon::new(corners).map_err(|source| CaseError::Polygon { what: "cell of a cube".to_string(), source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_look_inward() {
        for face in faces(2.0) {
            let polygon = face.cell([0.0, 1.0], [0.0, 1.0]).expect("a face is a polygon");
            assert_eq!(polygon.normal().dot(Vec3::ONE - polygon.centroid()), 1.0);
        }
    }
}
