//! A facet in its own plane, and how much of a disk lies on it.

use crate::geometry::{Frame, Polygon, Vec2, Vec3};

/// A polygon in the coordinates of its plane, its centroid the origin. Both sides share them.
pub(super) struct Flat {
    origin: Vec3,
    frame: Frame,
    corners: Vec<Vec2>,
    pub area: f64,
    /// The rectangle around it.
    pub low: Vec2,
    pub high: Vec2,
}

impl Flat {
    pub fn new(polygon: &Polygon) -> Self {
        let (origin, frame) = (polygon.centroid(), Frame::about(polygon.normal()));
        let mut flat =
            Self { origin, frame, corners: Vec::new(), area: polygon.area(), low: Vec2::ZERO, high: Vec2::ZERO };
        flat.corners = polygon.vertices().iter().map(|v| flat.coordinates(*v)).collect();
        flat.low = flat.corners.iter().fold(Vec2::INFINITY, |low, v| low.min(*v));
        flat.high = flat.corners.iter().fold(Vec2::NEG_INFINITY, |high, v| high.max(*v));
        flat
    }

    /// Where a point of the facet lies in its plane.
    pub fn coordinates(&self, point: Vec3) -> Vec2 {
        let offset = point - self.origin;
        Vec2::new(offset.dot(self.frame.x), offset.dot(self.frame.y))
    }

    /// Area that the disk shares with the polygon: edge by edge, what the disk shares with the triangle of its centre and the edge. O(corners).
    pub fn area_within(&self, centre: Vec2, radius: f64) -> f64 {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(a, b)| triangle_within(*a - centre, *b - centre, radius)).sum()
    }
}

/// Signed area that the disk around the origin shares with the triangle (0, a, b).
fn triangle_within(a: Vec2, b: Vec2, radius: f64) -> f64 {
    // Solve |a + t (b − a)| = radius for where the edge enters and leaves the disk.
    let edge = b - a;
    let (length_squared, half_slope) = (edge.length_squared(), a.dot(edge));
    let discriminant = half_slope * half_slope - length_squared * (a.length_squared() - radius * radius);
    if discriminant <= 0.0 || length_squared == 0.0 {
        return sector(a, b, radius);
    }
    let root = discriminant.sqrt();
    let (enters, leaves) = ((-half_slope - root) / length_squared, (-half_slope + root) / length_squared);
    if leaves <= 0.0 || enters >= 1.0 {
        return sector(a, b, radius);
    }

    // A sector before, a triangle between, a sector after.
    let (first, last) = (a + enters.max(0.0) * edge, a + leaves.min(1.0) * edge);
    sector(a, first, radius) + 0.5 * first.perp_dot(last) + sector(last, b, radius)
}

/// Signed area of the disk's sector from a to b.
fn sector(a: Vec2, b: Vec2, radius: f64) -> f64 {
    0.5 * radius * radius * a.perp_dot(b).atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn disks_on_polygons_have_their_area() {
        let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let flat = Flat::new(&Polygon::new(corners.to_vec()).expect("a rectangle"));
        let at = |x, y| flat.coordinates(Vec3::new(x, y, 0.0));
        let cap = |h: f64, r: f64| r * r * (h / r).acos() - h * (r * r - h * h).sqrt();
        for (centre, radius, exact) in [
            (at(1.0, 0.5), 0.4, PI * 0.16),
            (at(0.0, 0.0), 0.5, 0.25 * PI * 0.25),
            (at(1.0, 0.0), 0.5, 0.5 * PI * 0.25),
            (at(0.7, 0.5), 10.0, 2.0),
            (at(1.0, 0.8), 0.4, PI * 0.16 - cap(0.2, 0.4)),
            (at(1.0, 0.5), 0.6, PI * 0.36 - 2.0 * cap(0.5, 0.6)),
            (at(5.0, 0.5), 1.0, 0.0),
        ] {
            let area = flat.area_within(centre, radius);
            assert!((area - exact).abs() < 1e-14, "{area} against {exact}");
        }
    }
}
