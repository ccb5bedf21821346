//! The form factor of a polygon seen from a point, by Lambert's formula.
//!
//! ```text
//! F = (1/2π) Σ θₖ n·(vₖ × vₖ₊₁) / |vₖ × vₖ₊₁|
//! ```
//!
//! over the polygon's edges, vₖ its corners as seen from the point, θₖ the angle between neighbours, n the receiver's normal.
//! Source: Lambert (1760), Photometria; Baum, Rushmeier and Winget (1989), eq. 4.

use crate::geometry::Vec3;
use std::f64::consts::TAU;

/// F of a polygon wholly above the receiver's horizon, corners relative to the point; positive where the polygon's front faces it.
pub fn form_factor(corners: &[Vec3], normal: Vec3) -> f64 {
    let Some(mut from) = corners.last().copied() else { return 0.0 };
    let mut sum = 0.0;
    for &to in corners {
        let across = to.cross(from);
        let length = across.length();
        // An edge seen end on subtends nothing.
        if length > 0.0 {
            sum += length.atan2(from.dot(to)) * normal.dot(across) / length;
        }
        from = to;
    }
    sum / TAU
}
