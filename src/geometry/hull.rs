//! The convex hull of points in space, and in a plane.

use super::{Vec2, Vec3};
use robust::{Coord3D, orient3d};
use std::collections::BTreeSet;

/// The faces of the convex hull, each three indices counter-clockwise seen from outside; empty where all points lie in one plane.
///
/// Points are added one by one; faces that a new point sees give way to the cone over their border (Kallay 1984). Every side test is
/// exact, so that points in one plane, as scenes are full of, are no trouble: a plane polygon comes back as several triangles.
/// Cost O(points · faces).
pub fn convex_hull(points: &[Vec3]) -> Vec<[usize; 3]> {
    let Some([a, b, c, d]) = tetrahedron(points) else { return Vec::new() };
    let mut faces = vec![[a, b, c], [a, d, b], [b, d, c], [c, d, a]];
    for p in 0..points.len() {
        if [a, b, c, d].contains(&p) {
            continue;
        }
        let (seen, kept): (Vec<[usize; 3]>, Vec<[usize; 3]>) = faces.iter().partition(|f| above(points, **f, p) > 0.0);
        if seen.is_empty() {
            continue;
        }
        let edges = |f: &[usize; 3]| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])];
        let borders: BTreeSet<(usize, usize)> = seen.iter().flat_map(edges).collect();
        faces = kept;
        faces.extend(borders.iter().filter(|(u, v)| !borders.contains(&(*v, *u))).map(|(u, v)| [*u, *v, p]));
    }
    faces
}

/// Corners of the convex hull of points of one plane with this unit normal, counter-clockwise about it. Cost O(n log n).
pub fn convex_hull_in_plane(points: impl Iterator<Item = Vec3> + Clone, normal: Vec3) -> Vec<Vec3> {
    let Some(origin) = points.clone().next() else { return Vec::new() };
    let right = normal.any_orthonormal_vector();
    let up = normal.cross(right);
    let flat = |p: Vec3| Vec2::new(right.dot(p - origin), up.dot(p - origin));
    chain(points.map(|p| (flat(p), p)))
}

/// The convex hull of points of the plane, counter-clockwise, each with what comes with it. Orientations are decided on a grid of 2⁵⁰ steps
/// across the points, exactly: rounding folds no side. Source: Andrew (1979), the monotone chain. Cost O(n log n).
pub(super) fn chain<T: Copy>(points: impl Iterator<Item = (Vec2, T)> + Clone) -> Vec<T> {
    let Some((origin, _)) = points.clone().next() else { return Vec::new() };
    let reach = points.clone().map(|(x, _)| (x - origin).abs().max_element()).fold(f64::MIN_POSITIVE, f64::max);
    let step = |x: f64| (x / reach * (1u64 << 49) as f64) as i64;
    let mut sorted: Vec<(i64, i64, T)> =
        points.map(|(x, of)| (step(x.x - origin.x), step(x.y - origin.y), of)).collect();
    sorted.sort_by_key(|(x, y, _)| (*x, *y));
    sorted.dedup_by_key(|(x, y, _)| (*x, *y));
    let turns_left = |a: &(i64, i64, T), b: &(i64, i64, T), c: &(i64, i64, T)| {
        i128::from(b.0 - a.0) * i128::from(c.1 - b.1) > i128::from(b.1 - a.1) * i128::from(c.0 - b.0)
    };
    let half = |points: &mut dyn Iterator<Item = &(i64, i64, T)>| {
        let mut half: Vec<(i64, i64, T)> = Vec::new();
        for point in points {
            while let [.., a, b] = &half[..]
                && !turns_left(a, b, point)
            {
                half.pop();
            }
            half.push(*point);
        }
        half.pop();
        half
    };
    let (lower, upper) = (half(&mut sorted.iter()), half(&mut sorted.iter().rev()));
    lower.into_iter().chain(upper).map(|(_, _, of)| of).collect()
}

/// Four points with room between them, the first three counter-clockwise seen from outside.
fn tetrahedron(points: &[Vec3]) -> Option<[usize; 4]> {
    let furthest = |measure: &dyn Fn(Vec3) -> f64| {
        (0..points.len()).max_by(|i, j| measure(points[*i]).total_cmp(&measure(points[*j])))
    };
    let a = furthest(&|p| p.distance(*points.first().unwrap_or(&p)))?;
    let b = furthest(&|p| p.distance(points[a]))?;
    let along = points[b] - points[a];
    let c = furthest(&|p| (p - points[a]).cross(along).length())?;
    let d = furthest(&|p| coplanarity(points[a], points[b], points[c], p).abs())?;
    let height = above(points, [a, b, c], d);
    match height {
        h if h > 0.0 => Some([a, c, b, d]),
        h if h < 0.0 => Some([a, b, c, d]),
        _ => None,
    }
}

/// Positive where point p is outside the face.
fn above(points: &[Vec3], [a, b, c]: [usize; 3], p: usize) -> f64 {
    -coplanarity(points[a], points[b], points[c], points[p])
}

/// Six times the signed volume of a tetrahedron, its sign exact: negative where d sees a, b, c counter-clockwise.
fn coplanarity(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    let coord = |v: Vec3| Coord3D { x: v.x, y: v.y, z: v.z };
    orient3d(coord(a), coord(b), coord(c), coord(d))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume_and_area(points: &[Vec3], faces: &[[usize; 3]]) -> (f64, f64) {
        let of = |f: &[usize; 3]| f.map(|k| points[k]);
        let volume = faces.iter().map(|f| {
            let [a, b, c] = of(f);
            a.dot(b.cross(c))
        });
        let area = faces.iter().map(|f| {
            let [a, b, c] = of(f);
            0.5 * (b - a).cross(c - a).length()
        });
        (volume.sum::<f64>() / 6.0, area.sum())
    }

    #[test]
    fn a_grid_of_points_has_the_hull_of_its_cube() {
        // 125 points, most of them in faces, on edges or inside.
        let points: Vec<Vec3> =
            (0..125).map(|k| Vec3::new((k % 5) as f64, (k / 5 % 5) as f64, (k / 25) as f64)).collect();
        let (volume, area) = volume_and_area(&points, &convex_hull(&points));
        assert_eq!((volume, area), (64.0, 96.0));
    }

    #[test]
    fn the_hull_of_a_turned_box_is_closed_to_rounding() {
        let turn = crate::geometry::Mat3::from_rotation_x(0.3) * crate::geometry::Mat3::from_rotation_z(1.1);
        let points: Vec<Vec3> =
            (0..27).map(|k| turn * Vec3::new((k % 3) as f64, (k / 3 % 3) as f64, (k / 9) as f64)).collect();
        let faces = convex_hull(&points);
        let (volume, area) = volume_and_area(&points, &faces);
        // Corners are rounded: some ulp of the coordinates.
        assert!((volume - 8.0).abs() < 1e-13 && (area - 24.0).abs() < 1e-13, "{volume} {area}");
        // No point sees a face from outside.
        assert!(faces.iter().all(|f| (0..points.len()).all(|p| above(&points, *f, p) <= 0.0)));
    }

    #[test]
    fn a_turned_grid_in_a_plane_has_four_corners() {
        let turn = crate::geometry::Mat3::from_rotation_y(0.7) * crate::geometry::Mat3::from_rotation_x(1.9);
        let points: Vec<Vec3> = (0..63).map(|k| turn * Vec3::new((k % 9) as f64, (k / 9) as f64, 0.25)).collect();
        // Rounding may keep a few points of the sides, never lose a corner or fold a side.
        let hull = convex_hull_in_plane(points.iter().copied(), turn * Vec3::Z);
        assert!([0, 8, 54, 62].iter().all(|k| hull.contains(&points[*k])));
        let polygon = crate::geometry::Polygon::new(hull).unwrap();
        assert!((polygon.area() - 48.0).abs() < 1e-12 && polygon.normal().dot(turn * Vec3::Z) > 0.0);
    }

    #[test]
    fn flat_scenes_have_no_hull() {
        let points: Vec<Vec3> = (0..9).map(|k| Vec3::new((k % 3) as f64, (k / 3) as f64, 0.5)).collect();
        assert!(convex_hull(&points).is_empty());
        assert!(convex_hull(&points[..2]).is_empty());
        assert!(convex_hull(&[]).is_empty());
    }
}
