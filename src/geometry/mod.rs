//! Polygons and rays. The only door to `glam` and `obvhs`.
//!
//! All coordinates are f64 metres. A polygon's front is the side from which its vertices run counter-clockwise.

mod polygon;
mod ray;

pub use glam::{DAffine3 as Affine3, DMat3 as Mat3, DVec3 as Vec3};
pub use polygon::{Polygon, PolygonError};
pub use ray::Ray;
