//! Polygons and rays. The only door to `glam`, `obvhs` and `robust`.
//!
//! All coordinates are f64 metres. A polygon's front is the side from which its vertices run counter-clockwise.

mod cover;
mod disjoint;
mod frame;
mod hull;
mod plane;
mod polygon;
mod ray;
mod shaft;
mod tracer;

pub(crate) use disjoint::DisjointSets;
pub use frame::Frame;
pub use glam::{DAffine3 as Affine3, DMat3 as Mat3, DMat4 as Mat4, DVec2 as Vec2, DVec3 as Vec3};
pub use hull::{convex_hull, convex_hull_in_plane};
pub use plane::{group_by_plane, height};
pub use polygon::{PLANARITY_TOLERANCE, Polygon, PolygonError};
pub use ray::Ray;
pub use shaft::Shaft;
pub use tracer::{Hit, Tracer};
