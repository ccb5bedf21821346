//! Outlines that more than one scene is made of: lists of corners, counter-clockwise seen from the front.

use crate::geometry::Vec3;

/// The corners of one polygon.
pub(super) type Outline = Vec<Vec3>;

/// centre ± half_u ± half_v; the front faces along half_u × half_v.
pub(super) fn parallelogram(centre: Vec3, half_u: Vec3, half_v: Vec3) -> Outline {
    vec![centre - half_u - half_v, centre + half_u - half_v, centre + half_u + half_v, centre - half_u + half_v]
}

/// The six faces of centre ± a ± b ± c, for a right-handed frame (a × b · c > 0), fronts outward: +a, −a, +b, −b,
/// +c, −c.
pub(super) fn parallelepiped(centre: Vec3, a: Vec3, b: Vec3, c: Vec3) -> [Outline; 6] {
    [
        parallelogram(centre + a, b, c),
        parallelogram(centre - a, c, b),
        parallelogram(centre + b, c, a),
        parallelogram(centre - b, a, c),
        parallelogram(centre + c, a, b),
        parallelogram(centre - c, b, a),
    ]
}

/// The six faces of the axis-aligned room between two corners, fronts inward: at high x, low x, high y, low y, high
/// z, low z.
pub(super) fn room(low: Vec3, high: Vec3) -> [Outline; 6] {
    let centre = 0.5 * (low + high);
    let half = 0.5 * (high - low);
    let (a, b, c) = (Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z);
    parallelepiped(centre, a, b, c).map(reversed)
}

/// The same polygon seen from behind.
pub(super) fn reversed(mut outline: Outline) -> Outline {
    outline.reverse();
    outline
}
