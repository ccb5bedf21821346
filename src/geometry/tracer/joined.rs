//! Polygons of one plane that make a convex polygon together, joined: what a face of a solid hides, its facets hide together.

use crate::geometry::{DisjointSets, Polygon, Vec3, convex_hull_in_plane};
use std::borrow::Cow;
use std::collections::HashMap;

/// Sine of a turn that is none: some ulp of coordinates a thousand lengths away.
const STRAIGHT: f64 = 1e-12;

/// By how much of its area a convex polygon may differ from its hull, by rounding.
const CONVEX: f64 = 1e-9;

/// The chosen polygons, those that are joined under the number of the first of their parts. `planes` are their numbers of planes (see
/// [`group_by_plane`](crate::geometry::group_by_plane)).
///
/// Parts that face alike and share edges, corner for corner, are joined where the edges left over make one convex loop. Its winding number,
/// 1 inside and 0 outside, is the sum of those of its parts: they cover the whole, and nothing but it, once. Cost O(n) on average.
pub(super) fn joined<'a>(polygons: &[&'a Polygon], planes: &[u32], chosen: &[usize]) -> Vec<(usize, Cow<'a, Polygon>)> {
    // Find who runs along every edge.
    let seams = Seams::of(polygons, planes, chosen);
    let mut sets = DisjointSets::new(polygons.len());
    for &k in chosen {
        edges(polygons[k]).for_each(|edge| seams.across(k, edge).iter().for_each(|other| sets.join(k, *other)));
    }
    let mut parts: HashMap<usize, Vec<usize>> = HashMap::new();
    chosen.iter().for_each(|&k| parts.entry(sets.least(k)).or_default().push(k));

    // Put every whole in the place of its first part.
    let whole = |parts: &Vec<usize>| if parts.len() > 1 { seams.whole(parts) } else { None };
    let wholes: HashMap<usize, Polygon> =
        parts.iter().filter_map(|(least, parts)| Some((*least, whole(parts)?))).collect();
    let mut found = Vec::with_capacity(parts.len());
    for &k in chosen {
        let least = sets.least(k);
        match wholes.get(&least) {
            None => found.push((k, Cow::Borrowed(polygons[k]))),
            Some(whole) if parts[&least][0] == k => found.push((k, Cow::Owned(whole.clone()))),
            Some(_) => {}
        }
    }
    found
}

/// A plane and the way polygons face there, and the ends of an edge.
type Run = ((u32, bool), [u64; 3], [u64; 3]);

/// Who runs along every edge.
struct Seams<'a, 'p> {
    polygons: &'a [&'p Polygon],
    planes: &'a [u32],
    runs: HashMap<Run, Vec<usize>>,
}

impl<'a, 'p> Seams<'a, 'p> {
    fn of(polygons: &'a [&'p Polygon], planes: &'a [u32], chosen: &[usize]) -> Self {
        let mut seams = Self { polygons, planes, runs: HashMap::with_capacity(4 * chosen.len()) };
        for &k in chosen {
            for edge in edges(polygons[k]) {
                seams.runs.entry(seams.run(k, edge)).or_default().push(k);
            }
        }
        seams
    }

    fn run(&self, k: usize, (from, to): (Vec3, Vec3)) -> Run {
        let plane = self.planes[k];
        let is_back = self.polygons[k].normal().dot(self.polygons[plane as usize].normal()) < 0.0;
        ((plane, is_back), bits(from), bits(to))
    }

    /// Those beside polygon k across one of its edges.
    fn across(&self, k: usize, (from, to): (Vec3, Vec3)) -> &[usize] {
        self.runs.get(&self.run(k, (to, from))).map_or(&[], Vec::as_slice)
    }

    /// The convex polygon that these make, if they do.
    fn whole(&self, parts: &[usize]) -> Option<Polygon> {
        // Leave out the edges inside.
        let mut next: HashMap<[u64; 3], Vec3> = HashMap::new();
        let mut first = None;
        let mut n_open = 0;
        for &k in parts {
            for edge @ (from, to) in edges(self.polygons[k]) {
                if self.across(k, (to, from)).len() > 1 {
                    return None;
                }
                if self.across(k, edge).is_empty() {
                    next.insert(bits(from), to);
                    first.get_or_insert(from);
                    n_open += 1;
                }
            }
        }

        // Walk around the others.
        let first = first?;
        let mut outline = vec![first];
        loop {
            let to = *next.get(&bits(*outline.last()?))?;
            if bits(to) == bits(first) {
                break;
            }
            if outline.len() == n_open {
                return None;
            }
            outline.push(to);
        }
        if outline.len() != n_open {
            return None;
        }
        straighten(&mut outline);
        let hull =
            Polygon::new(convex_hull_in_plane(outline.iter().copied(), self.polygons[parts[0]].normal())).ok()?;
        let whole = Polygon::new(outline).ok()?;
        ((whole.area() / hull.area() - 1.0).abs() <= CONVEX).then_some(whole)
    }
}

fn edges(polygon: &Polygon) -> impl Iterator<Item = (Vec3, Vec3)> {
    let v = polygon.vertices();
    (0..v.len()).map(|k| (v[k], v[(k + 1) % v.len()]))
}

/// The bits of a point's coordinates, of one zero.
fn bits(v: Vec3) -> [u64; 3] {
    v.to_array().map(|x| (x + 0.0).to_bits())
}

/// Drops corners on the line between their neighbours.
fn straighten(outline: &mut Vec<Vec3>) {
    let mut k = 0;
    while outline.len() > 3 && k < outline.len() {
        let n = outline.len();
        let (before, here, after) = (outline[(k + n - 1) % n], outline[k], outline[(k + 1) % n]);
        let sine = (here - before).cross(after - here).length();
        if sine <= STRAIGHT * here.distance(before) * after.distance(here) {
            outline.remove(k);
            k = k.saturating_sub(1);
        } else {
            k += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Mat3, group_by_plane};

    /// Unit squares with these lowest corners, in a turned plane.
    fn squares(corners: &[(i32, i32)]) -> Vec<Polygon> {
        let turn = Mat3::from_rotation_x(0.3) * Mat3::from_rotation_y(1.1);
        let at = |x: i32, y: i32| turn * Vec3::new(f64::from(x), f64::from(y), 2.0);
        let square = |&(x, y): &(i32, i32)| Polygon::new(vec![at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]);
        corners.iter().map(|corner| square(corner).expect("a square")).collect()
    }

    /// Number, corners and area of what comes of them.
    fn found(polygons: &[Polygon]) -> Vec<(usize, usize, f64)> {
        let all: Vec<&Polygon> = polygons.iter().collect();
        let chosen: Vec<usize> = (0..all.len()).collect();
        let joined = joined(&all, &group_by_plane(&all), &chosen);
        joined.iter().map(|(id, p)| (*id, p.vertices().len(), (p.area() * 1e9).round() / 1e9)).collect()
    }

    #[test]
    fn what_makes_a_convex_polygon_is_joined_and_nothing_else() {
        let grid: Vec<(i32, i32)> = (0..6).map(|k| (k % 3, k / 3)).collect();
        assert_eq!(found(&squares(&grid)), [(0, 4, 6.0)]);
        // Two apart, one of them of two squares.
        assert_eq!(found(&squares(&[(5, 0), (0, 0), (1, 0)])), [(0, 4, 1.0), (1, 4, 2.0)]);
        // An L, a frame around a hole, and squares that touch in a corner.
        let frame: Vec<(i32, i32)> = (0..9).filter(|k| *k != 4).map(|k| (k % 3, k / 3)).collect();
        for apart in [vec![(0, 0), (1, 0), (0, 1)], frame, vec![(0, 0), (1, 1)]] {
            let expected: Vec<_> = (0..apart.len()).map(|k| (k, 4, 1.0)).collect();
            assert_eq!(found(&squares(&apart)), expected);
        }
        // One square twice: who runs along its edges is not clear.
        assert_eq!(found(&squares(&[(0, 0), (1, 0), (1, 0)])).len(), 3);
        // Back to back, they are two sides.
        let mut two = squares(&[(0, 0), (1, 0)]);
        two[1] = two[1].flipped();
        assert_eq!(found(&two), [(0, 4, 1.0), (1, 4, 1.0)]);
    }
}
