//! The boxes of polygons, f32, in coordinates centred on and scaled to the scene; and the tree of two over them.

use super::local::Local;
use crate::geometry::{Polygon, Vec3};
use glam::Vec3A;
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2, bvh2::builder::build_bvh2};
use std::time::Duration;

/// Length by which boxes of the normalised scene (radius 1) are grown: f32 rounding of origin, direction and box (fifteen times 6e-8),
/// and a margin of four.
const BOX_MARGIN: f32 = 4e-6;

/// Boxes of polygons, grown so that no f32 test misses what is in them.
pub(super) struct Boxes {
    pub boxes: Vec<Aabb>,
    /// Their coordinates: so f32 is as good for a pin as for a planet.
    pub local: Local,
    /// Half of the diagonal of the box around everything, m.
    pub radius: f64,
}

impl Boxes {
    pub fn around<'a>(polygons: impl Iterator<Item = &'a Polygon> + Clone) -> Self {
        let corners = polygons.clone().flat_map(|polygon| polygon.vertices());
        let (low, high) =
            corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
        let (centre, radius) = if low.is_finite() {
            (0.5 * (low + high), (0.5 * low.distance(high)).max(f64::MIN_POSITIVE))
        } else {
            (Vec3::ZERO, 1.0)
        };
        let local = Local::new(centre, radius);
        let around = |polygon: &Polygon| {
            let mut bounds = Aabb::empty();
            for v in polygon.vertices() {
                bounds.extend(Vec3A::from(local.point(*v).as_vec3()));
            }
            bounds.min -= Vec3A::splat(BOX_MARGIN);
            bounds.max += Vec3A::splat(BOX_MARGIN);
            bounds
        };
        Self { boxes: polygons.map(around).collect(), local, radius }
    }

    /// A tree of two, one box to a leaf.
    pub fn tree(&self) -> Bvh2 {
        let parameters = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        build_bvh2(&self.boxes, parameters, &mut Duration::default())
    }
}
