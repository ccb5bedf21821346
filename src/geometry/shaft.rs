//! Can anything stand between two polygons? Decided once for the pair, before any ray.

use super::{Polygon, Tracer, Vec3, height};

/// What lies in the convex hull of two polygons.
#[derive(Clone, Debug, PartialEq)]
pub enum Shaft {
    /// Nothing: every point of one sees every point of the other.
    Clear,
    /// One polygon cuts the hull in two: no point of one sees any point of the other.
    Blocked,
    /// These polygons may block some lines; handles for [`Tracer::blocked_by`].
    Undecided(Vec<u32>),
}

impl Shaft {
    /// Classifies the pair of `a`, a piece of polygon `a_id` of the tracer, and `b`, a piece of `b_id`. Never calls a shaft clear or
    /// blocked that is not, to within the rounding of the coordinates.
    ///
    /// With a on one side and b on the other of an occluder's plane, the hull of a and b meets the plane in the hull of the
    /// points where the lines between their corners do: if all of those lie in the (convex) occluder, everything is blocked.
    pub fn between(tracer: &Tracer, a: (&Polygon, usize), b: (&Polygon, usize)) -> Self {
        let corners = || a.0.vertices().iter().chain(b.0.vertices());
        let mut handles = Vec::new();
        tracer.near(corners().copied(), |handle, id, occluder| {
            if tracer.coplanar(id, a.1) || tracer.coplanar(id, b.1) {
                return;
            }
            // An occluder behind either polygon, or with both on one side of it, blocks nothing.
            let behind = |plane: &Polygon| occluder.iter().all(|v| height(plane.normal(), plane.centroid(), *v) <= 0.0);
            if behind(a.0) || behind(b.0) {
                return;
            }
            handles.push(handle);
        });
        handles.retain(|&handle| {
            let (normal, point) = tracer.plane_of(handle);
            let above = corners().all(|v| height(normal, point, *v) >= 0.0);
            let below = corners().all(|v| height(normal, point, *v) <= 0.0);
            !(above || below)
        });
        if !handles.is_empty() {
            let sides = side_planes(a.0, b.0);
            let outside = |occluder: &[Vec3], (normal, point): &(Vec3, Vec3)| {
                occluder.iter().all(|v| height(*normal, *point, *v) >= 0.0)
            };
            handles.retain(|&handle| !sides.iter().any(|plane| outside(tracer.corners_of(handle), plane)));
        }
        if handles.is_empty() {
            return Self::Clear;
        }

        let cuts = |handle: &u32| {
            let (normal, point) = tracer.plane_of(*handle);
            let side = |p: &Polygon, sign: f64| p.vertices().iter().all(|v| sign * height(normal, point, *v) > 0.0);
            let apart = (side(a.0, 1.0) && side(b.0, -1.0)) || (side(a.0, -1.0) && side(b.0, 1.0));
            let lines = || a.0.vertices().iter().flat_map(|v| b.0.vertices().iter().map(move |w| (*v, *w)));
            apart && lines().all(|(v, w)| tracer.blocked_by(&[*handle], v, w))
        };
        if handles.iter().any(cuts) { Self::Blocked } else { Self::Undecided(handles) }
    }
}

/// The planes that bound the hull of two polygons from the side, outward normal and a point of each: those through an edge of one
/// and a corner of the other with no corner of either above.
fn side_planes(a: &Polygon, b: &Polygon) -> Vec<(Vec3, Vec3)> {
    let mut planes = Vec::new();
    for (one, other) in [(a, b), (b, a)] {
        let v = one.vertices();
        for (k, start) in v.iter().enumerate() {
            let edge = v[(k + 1) % v.len()] - *start;
            for apex in other.vertices() {
                let normal = edge.cross(*apex - *start);
                let length = normal.length();
                if length <= 1e-9 * edge.length() * apex.distance(*start) {
                    continue;
                }
                let (mut above, mut below) = (false, false);
                for corner in v.iter().chain(other.vertices()) {
                    let height = height(normal / length, *start, *corner);
                    above |= height > 0.0;
                    below |= height < 0.0;
                }
                if !above {
                    planes.push((normal / length, *start));
                } else if !below {
                    planes.push((-normal / length, *start));
                }
            }
        }
    }
    planes
}
