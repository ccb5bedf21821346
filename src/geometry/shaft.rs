//! Can anything stand between two polygons? Decided once for the pair, before any ray.

use super::{Polygon, Tracer, Vec3, cover::covers, height};

/// What lies in the convex hull of two polygons.
#[derive(Clone, Debug, PartialEq)]
pub enum Shaft {
    /// Nothing: every point of one sees every point of the other.
    Clear,
    /// Polygons of one plane cut the hull in two: no point of one sees any point of the other.
    Blocked,
    /// These polygons may block some lines; handles for [`Tracer::blocked_by`] and [`Shaft::among`].
    Undecided(Vec<u32>),
}

impl Shaft {
    /// Classifies the pair of `a`, a piece of the plane of polygon `a_id` of the tracer, and `b`, a piece of that of `b_id`. What
    /// is called clear or blocked is so for every part of a and every part of b, to within the rounding of the coordinates: so a
    /// and b may be the hulls of many pieces. Lines are those from the front of one to the front of the other.
    ///
    /// Cost: a walk down the tree, and some hundred ns for every polygon near the hull. Allocates only where polygons are found.
    pub fn between(tracer: &Tracer, a: (&Polygon, usize), b: (&Polygon, usize)) -> Self {
        let hull = Hull::of(tracer, a, b);
        let mut inside = Vec::new();
        tracer.near([hull.low, hull.high], |handle| {
            if hull.may_hold(tracer, handle) {
                inside.push(handle);
            }
        });
        hull.classify(tracer, inside)
    }

    /// [`Shaft::between`], where only these polygons can stand in the way: those left undecided between a larger piece that holds a
    /// and a larger piece that holds b. Cost: some ten to some hundred ns for every handle.
    pub fn among(tracer: &Tracer, handles: &[u32], a: (&Polygon, usize), b: (&Polygon, usize)) -> Self {
        let hull = Hull::of(tracer, a, b);
        let inside = handles.iter().copied().filter(|handle| hull.may_hold(tracer, *handle)).collect();
        hull.classify(tracer, inside)
    }
}

/// The convex hull of two polygons, and the planes they lie in.
struct Hull<'a> {
    a: &'a Polygon,
    b: &'a Polygon,
    planes: [u32; 2],
    low: Vec3,
    high: Vec3,
    /// From the middle of a to that of b.
    axis: Vec3,
    /// No point of the hull is further from the axis, rounding included.
    radius: f64,
}

impl<'a> Hull<'a> {
    fn of(tracer: &Tracer, (a, a_id): (&'a Polygon, usize), (b, b_id): (&'a Polygon, usize)) -> Self {
        let corners = || a.vertices().iter().chain(b.vertices());
        let low = corners().fold(Vec3::INFINITY, |low, v| low.min(*v));
        let high = corners().fold(Vec3::NEG_INFINITY, |high, v| high.max(*v));
        let planes = [a_id, b_id].map(|id| tracer.plane_number(id));
        let widths = [a, b].map(|p| p.vertices().iter().map(|v| v.distance_squared(p.centroid())).fold(0.0, f64::max));
        let radius = widths[0].max(widths[1]).sqrt() + rounding(low, high);
        Self { a, b, planes, low, high, axis: b.centroid() - a.centroid(), radius }
    }

    fn corners(&self) -> impl Iterator<Item = &Vec3> {
        self.a.vertices().iter().chain(self.b.vertices())
    }

    /// False only if the polygon blocks no line; the cheapest reasons first.
    fn may_hold(&self, tracer: &Tracer, handle: u32) -> bool {
        if self.planes.contains(&tracer.plane_of(handle)) {
            return false;
        }
        // Beside the hull in x, y or z.
        let occluder = tracer.corners_of(handle);
        let low = occluder.iter().fold(Vec3::INFINITY, |low, v| low.min(*v));
        let high = occluder.iter().fold(Vec3::NEG_INFINITY, |high, v| high.max(*v));
        if low.cmpgt(self.high).any() || high.cmplt(self.low).any() {
            return false;
        }
        // Further from the line between the middles than both are wide.
        let (middle, reach) = (0.5 * (low + high), 0.5 * low.distance(high) + self.radius);
        let offset = middle - self.a.centroid();
        let beyond = offset - (offset.dot(self.axis) / self.axis.length_squared()).clamp(0.0, 1.0) * self.axis;
        if beyond.length_squared() > reach * reach {
            return false;
        }
        // Behind either polygon.
        let rounding = rounding(low.min(self.low), high.max(self.high));
        let behind = |plane: &Polygon| {
            occluder.iter().all(|v| height_above(plane.normal(), plane.centroid(), *v, rounding) <= 0.0)
        };
        if behind(self.a) || behind(self.b) {
            return false;
        }
        // With both on one side of it.
        let normal = tracer.normal_of(handle);
        let (mut above, mut below) = (false, false);
        self.corners().any(|v| {
            let height = height_above(normal, occluder[0], *v, rounding);
            above |= height > 0.0;
            below |= height < 0.0;
            above && below
        })
    }

    fn classify(&self, tracer: &Tracer, mut inside: Vec<u32>) -> Shaft {
        self.drop_beside(tracer, &mut inside);
        if inside.is_empty() {
            return Shaft::Clear;
        }

        // Do the polygons of one plane, taken together, cut the hull in two?
        let mut plane: Vec<&[Vec3]> = Vec::new();
        for (k, &first) in inside.iter().enumerate() {
            let number = tracer.plane_of(first);
            let same = |handle: &&u32| tracer.plane_of(**handle) == number;
            if inside[..k].iter().any(|handle| same(&handle)) {
                continue;
            }
            plane.clear();
            plane.extend(inside[k..].iter().filter(same).map(|handle| tracer.corners_of(*handle)));
            let normal = tracer.normal_of(first);
            if self.may_be_cut(normal, &plane) && covers(normal, &plane, self.a.vertices(), self.b.vertices()) {
                return Shaft::Blocked;
            }
        }
        Shaft::Undecided(inside)
    }

    /// Drops those beyond a plane that bounds the hull from the side.
    fn drop_beside(&self, tracer: &Tracer, inside: &mut Vec<u32>) {
        let rounding = rounding(self.low, self.high);
        let mut keep_inside = |(normal, point): (Vec3, Vec3)| {
            let outside = |v: &Vec3| normal.dot(*v - point) >= 0.0 || height(normal, point, *v) >= 0.0;
            inside.retain(|&handle| !tracer.corners_of(handle).iter().all(outside));
            inside.is_empty()
        };
        let is_above = |one: &Polygon, other: &Polygon| {
            let height = |v: &Vec3| height_above(other.normal(), other.centroid(), *v, rounding);
            one.vertices().iter().all(|v| height(v) >= 0.0)
        };
        if is_above(self.a, self.b) && is_above(self.b, self.a) {
            let _ = tangent_planes(self.a, self.b).chain(tangent_planes(self.b, self.a)).any(&mut keep_inside);
        } else {
            let _ = side_planes(self.a, self.b, rounding).into_iter().any(&mut keep_inside);
        }
    }

    /// False only if some line between corners of the two surely meets none of the facets of a plane: most planes do not cut the hull in
    /// two, and this is cheaper than to ask what they cover.
    fn may_be_cut(&self, normal: Vec3, facets: &[&[Vec3]]) -> bool {
        let point = facets[0][0];
        let size = self.low.distance(self.high);
        self.a.vertices().iter().all(|from| {
            let above = normal.dot(*from - point);
            self.b.vertices().iter().all(|to| {
                let change = above - normal.dot(*to - point);
                if change.abs() <= CLEARLY * size {
                    return true;
                }
                let crossing = *from + above / change * (*to - *from);
                facets.iter().any(|facet| may_hold_point(facet, normal, crossing, CLEARLY * size))
            })
        })
    }
}

/// Share of a hull's size that rounding is far below.
const CLEARLY: f64 = 1e-6;

/// False only if a point of the plane of a convex polygon is further than the margin outside of one of its edges. The normal may be that
/// of its front or of its back.
fn may_hold_point(polygon: &[Vec3], normal: Vec3, point: Vec3, margin: f64) -> bool {
    let (mut left, mut right) = (true, true);
    let mut from = polygon[polygon.len() - 1];
    for &to in polygon {
        let edge = to - from;
        let (side, margin) = (normal.dot(edge.cross(point - from)), margin * edge.length());
        left &= side >= -margin;
        right &= side <= margin;
        from = to;
    }
    left || right
}

/// What rounding can do to heights among points of a box, at most.
fn rounding(low: Vec3, high: Vec3) -> f64 {
    16.0 * f64::EPSILON * (2.0 * low.abs().max(high.abs()).max_element() + low.distance(high))
}

/// [`height`], quickly where it is beyond the rounding of any.
#[inline]
fn height_above(normal: Vec3, on_plane: Vec3, point: Vec3, rounding: f64) -> f64 {
    let above = normal.dot(point - on_plane);
    if above.abs() > rounding { above } else { height(normal, on_plane, point) }
}

/// The planes through an edge of a polygon and a corner of another in front of it with no corner of either above: outward normal and a point
/// of each.
fn tangent_planes<'a>(one: &'a Polygon, other: &'a Polygon) -> impl Iterator<Item = (Vec3, Vec3)> + 'a {
    let v = one.vertices();
    (0..v.len()).filter_map(move |k| {
        // Among the corners as seen along the edge, find the one furthest about it from the inside of the polygon. A corner so near the edge
        // that rounding turns it may win by that, and then the plane stands off; or lose, and then it is above by no more than rounding.
        let (start, edge) = (v[k], v[(k + 1) % v.len()] - v[k]);
        let inward = one.normal().cross(edge);
        let mut furthest = (0.0, 0.0);
        for corner in other.vertices() {
            let offset = *corner - start;
            let (along, up) = (inward.dot(offset), one.normal().dot(offset).max(0.0));
            let turn = furthest.0 * up - furthest.1 * along;
            let is_opposite = turn == 0.0 && along < 0.0 && furthest.0 > 0.0;
            if furthest == (0.0, 0.0) || turn > 0.0 || is_opposite {
                furthest = (along, up);
            }
        }
        let (along, up) = furthest;
        let normal = (along * one.normal() - up * inward).try_normalize()?;
        Some((normal, start))
    })
}

/// The planes that bound the hull of two polygons from the side, outward normal and a point of each: those through an edge of one
/// and a corner of the other with no corner of either above.
fn side_planes(a: &Polygon, b: &Polygon, rounding: f64) -> Vec<(Vec3, Vec3)> {
    let mut planes = Vec::with_capacity(a.vertices().len() + b.vertices().len());
    for (one, other) in [(a, b), (b, a)] {
        let v = one.vertices();
        for (k, start) in v.iter().enumerate() {
            let edge = v[(k + 1) % v.len()] - *start;
            let edge_squared = edge.length_squared();
            for apex in other.vertices() {
                let to_apex = *apex - *start;
                let normal = edge.cross(to_apex);
                let length = normal.length();
                if length <= 1e-9 * (edge_squared * to_apex.length_squared()).sqrt() {
                    continue;
                }
                let (mut above, mut below) = (false, false);
                let normal = normal / length;
                // The other's corners first: they tell most planes apart.
                for corner in other.vertices().iter().chain(v) {
                    let height = height_above(normal, *start, *corner, rounding);
                    above |= height > 0.0;
                    below |= height < 0.0;
                    if above && below {
                        break;
                    }
                }
                if !above {
                    planes.push((normal, *start));
                } else if !below {
                    planes.push((-normal, *start));
                }
            }
        }
    }
    planes
}
