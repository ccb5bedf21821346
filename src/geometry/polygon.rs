//! Planar convex polygons in f64.

use super::Vec3;
use thiserror::Error;

/// Vertices further than this, relative to the polygon's diameter, from its plane make it not planar.
/// Forty ulp: what a rotation and a translation of exact coordinates leave behind.
pub const PLANARITY_TOLERANCE: f64 = 1e-12;

/// A planar convex polygon, counter-clockwise seen from its front. Immutable; made only by [`Polygon::new`].
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    vertices: Vec<Vec3>,
    normal: Vec3,
    area: f64,
    centroid: Vec3,
}

/// Why a list of vertices is not a polygon.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PolygonError {
    #[error("a polygon needs at least 3 vertices, found {found}")]
    TooFewVertices { found: usize },
    #[error("vertex {vertex} is ({:e}, {:e}, {:e}): coordinates must be finite", .value[0], .value[1], .value[2])]
    NotFinite { vertex: usize, value: [f64; 3] },
    #[error("the polygon has zero area (area {area:e} at diameter {diameter:e})")]
    ZeroArea { area: f64, diameter: f64 },
    #[error("vertex {vertex} lies {distance:e} off the polygon's plane, allowed is {allowed:e}")]
    NotPlanar { vertex: usize, distance: f64, allowed: f64 },
    #[error("the polygon is not convex at vertex {vertex}")]
    NotConvex { vertex: usize },
}

impl Polygon {
    /// Checks the vertices and measures the polygon: n A = ½ Σ (vᵢ − v₀) × (vᵢ₊₁ − v₀) (Newell).
    ///
    /// # Errors
    /// Fewer than three vertices, a coordinate that is not finite, zero area, a vertex off the plane by more than
    /// [`PLANARITY_TOLERANCE`](super::PLANARITY_TOLERANCE) of the diameter, or a reflex corner.
    pub fn new(vertices: Vec<Vec3>) -> Result<Self, PolygonError> {
        if vertices.len() < 3 {
            return Err(PolygonError::TooFewVertices { found: vertices.len() });
        }
        if let Some((vertex, value)) = vertices.iter().enumerate().find(|(_, v)| !v.is_finite()) {
            return Err(PolygonError::NotFinite { vertex, value: value.to_array() });
        }

        // Sum the fan of triangles for area, normal and centroid, relative to the first vertex to keep digits far from the origin.
        let origin = vertices[0];
        let fan = || vertices[1..].windows(2).map(|pair| (pair[0] - origin, pair[1] - origin));
        let twice_area_vector: Vec3 = fan().map(|(a, b)| a.cross(b)).sum();
        let diameter = vertices.iter().map(|v| v.distance(origin)).fold(0.0, f64::max);
        let area = 0.5 * twice_area_vector.length();
        if area.is_nan() || area <= f64::EPSILON * diameter * diameter * 1e-3 {
            return Err(PolygonError::ZeroArea { area, diameter });
        }
        let normal = twice_area_vector / (2.0 * area);
        let moment: Vec3 = fan().map(|(a, b)| (a + b) * a.cross(b).dot(normal)).sum();
        let centroid = origin + moment / (6.0 * area);

        // Hold every vertex to the plane, and every corner to the left.
        let scale = diameter.max(vertices.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max) * 1e-3);
        for (vertex, v) in vertices.iter().enumerate() {
            let distance = (*v - centroid).dot(normal).abs();
            let allowed = PLANARITY_TOLERANCE * scale;
            if distance > allowed {
                return Err(PolygonError::NotPlanar { vertex, distance, allowed });
            }
        }
        let n = vertices.len();
        for vertex in 0..n {
            let before = vertices[vertex] - vertices[(vertex + n - 1) % n];
            let after = vertices[(vertex + 1) % n] - vertices[vertex];
            if before.cross(after).dot(normal) < -PLANARITY_TOLERANCE * before.length() * after.length() {
                return Err(PolygonError::NotConvex { vertex });
            }
        }
        Ok(Self { vertices, normal, area, centroid })
    }

    /// Corners, counter-clockwise seen from the front.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Unit normal of the front.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Area in m².
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Centre of mass.
    pub fn centroid(&self) -> Vec3 {
        self.centroid
    }

    /// A point uniform by area from two numbers uniform in [0, 1); its density is 1/area. Parallelograms keep the grid of the
    /// unit square; other polygons are fans of triangles chosen by area.
    pub fn sample(&self, mut u: [f64; 2]) -> Vec3 {
        if let Some([corner, along, up]) = self.parallelogram() {
            return corner + u[0] * along + u[1] * up;
        }
        let v = &self.vertices;
        // Choose a triangle of the fan, and use what is left of the number.
        let mut left = u[0] * self.area;
        let mut triangle = [v[0], v[1], v[2]];
        for pair in v[1..].windows(2) {
            triangle = [v[0], pair[0], pair[1]];
            let area = 0.5 * (pair[0] - v[0]).cross(pair[1] - v[0]).length();
            u[0] = (left / area).clamp(0.0, 1.0);
            if left < area {
                break;
            }
            left -= area;
        }
        let [a, b, c] = triangle;
        let s = u[0].sqrt();
        a + (1.0 - u[1]) * s * (b - a) + u[1] * s * (c - a)
    }

    /// A corner and the two sides that leave it, of a parallelogram; `None` of what is none to rounding.
    pub fn parallelogram(&self) -> Option<[Vec3; 3]> {
        let [a, b, c, d] = self.vertices[..] else { return None };
        let largest = |v: Vec3| v.abs().max_element();
        let allowed = 1e-14 * largest(c - a) + 8.0 * f64::EPSILON * (largest(a) + largest(c));
        (largest(a - b + c - d) <= allowed).then_some([a, b - a, d - a])
    }

    /// The same polygon seen from behind.
    pub fn flipped(&self) -> Self {
        let mut vertices = self.vertices.clone();
        vertices.reverse();
        Self { vertices, normal: -self.normal, area: self.area, centroid: self.centroid }
    }
}
