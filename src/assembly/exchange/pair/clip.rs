//! The part of a polygon in front of a plane.

use super::double::Double;
use super::real::{Real, Vector};
use crate::geometry::{Polygon, Vec3, height};

/// How a polygon lies to a plane.
#[derive(Clone, Debug, PartialEq)]
pub enum Half {
    /// No point in front (on the plane counts as behind).
    Behind,
    /// No point behind (on the plane counts as in front).
    InFront,
    /// This part is in front.
    Part(Vec<Vec3>),
}

/// Cuts `polygon` by the plane of `plane` (Sutherland and Hodgman 1974). Corners within the rounding of their coordinates lie
/// on the plane.
pub fn in_front_of(polygon: &[Vec3], plane: &Polygon) -> Half {
    above(polygon, plane.vertices()[0], plane.normal())
}

/// The same for the plane through a point with this unit normal.
pub fn above(polygon: &[Vec3], origin: Vec3, normal: Vec3) -> Half {
    let heights: Vec<f64> = polygon.iter().map(|v| height(normal, origin, *v)).collect();
    if heights.iter().all(|h| *h <= 0.0) {
        return Half::Behind;
    }
    if heights.iter().all(|h| *h >= 0.0) {
        return Half::InFront;
    }
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for k in 0..polygon.len() {
        let next = (k + 1) % polygon.len();
        if heights[k] >= 0.0 {
            part.push(polygon[k]);
        }
        if heights[k] * heights[next] < 0.0 {
            let s = heights[k] / (heights[k] - heights[next]);
            part.push(polygon[k] + s * (polygon[next] - polygon[k]));
        }
    }
    Half::Part(part)
}

/// The part of a polygon above a plane, in double-double: its corners and their heights, zero where they lie on the plane. What
/// is cut off is cut off to thirty digits, so that little left over is right to as many as the polygon.
pub fn cut(corners: &[Vector<Double>], heights: &[Double]) -> Vec<Vector<Double>> {
    let mut part = Vec::with_capacity(corners.len() + 1);
    for k in 0..corners.len() {
        let next = (k + 1) % corners.len();
        let [here, there] = [heights[k], heights[next]];
        if here.value() >= 0.0 {
            part.push(corners[k]);
        }
        if here.value() * there.value() < 0.0 {
            part.push(corners[k] + (corners[next] - corners[k]).scaled(here / (here - there)));
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Stream;

    #[test]
    fn the_parts_on_either_side_make_the_whole() {
        let mut stream = Stream::new(0x636c_6970, 0, 0);
        let mut point = || Vec3::from_array(std::array::from_fn(|_| 2.0 * stream.uniform() - 1.0));
        let area = |part: Half, whole: &Polygon| match part {
            Half::Behind => 0.0,
            Half::InFront => whole.area(),
            // A sliver that is no polygon has no area to speak of.
            Half::Part(part) => Polygon::new(part).map_or(0.0, |part| part.area()),
        };
        let mut n_cut = 0;
        for _ in 0..2_000 {
            let polygons = [(); 2].map(|()| Polygon::new(vec![point(), point(), point()]));
            let [Ok(whole), Ok(plane)] = polygons else { continue };
            let front = in_front_of(whole.vertices(), &plane);
            n_cut += usize::from(matches!(front, Half::Part(_)));
            let sum = area(front, &whole) + area(in_front_of(whole.vertices(), &plane.flipped()), &whole);
            // New corners are rounded: some ulp of the coordinates times the perimeter.
            assert!((sum - whole.area()).abs() < 1e-13, "{sum} for {}", whole.area());
        }
        assert!(n_cut > 500, "{n_cut}");
    }

    #[test]
    fn what_lies_in_the_plane_is_on_neither_side_of_it() {
        let square =
            |z: f64| [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z)).to_vec();
        let plane = Polygon::new(square(0.3)).unwrap();
        assert_eq!(in_front_of(&square(0.3), &plane), Half::Behind);
        assert_eq!(in_front_of(&square(0.3 + 1e-17), &plane), Half::Behind);
        assert_eq!(in_front_of(&square(0.3 + 1e-12), &plane), Half::InFront);
        assert_eq!(in_front_of(&square(0.3 - 1e-12), &plane), Half::Behind);
        // Touching by an edge is in front, not cut.
        let leaning = [Vec3::new(0.0, 0.0, 0.3), Vec3::new(1.0, 0.0, 0.3), Vec3::new(0.5, 0.5, 0.9)];
        assert_eq!(in_front_of(&leaning, &plane), Half::InFront);
    }
}
