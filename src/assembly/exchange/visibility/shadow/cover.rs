//! Pieces covered with cells: triangles that end in singularities, quadrilaterals elsewhere.

use super::cubature::Cell;
use crate::geometry::Vec3;

/// Covers a convex polygon, singular at these corners, with cells of a term.
pub fn cover(polygon: &[Vec3], singular: &[usize], term: usize, into: &mut Vec<Cell>) {
    let mut add = |corners: [Vec3; 4]| into.push(Cell::new(corners, term));
    let n = polygon.len();
    match singular {
        // A fan of quadrilaterals, or one of triangles about the one singularity.
        [] => {
            for k in (1..n - 1).step_by(2) {
                add([polygon[0], polygon[k], polygon[k + 1], polygon[(k + 2) % n]]);
            }
        }
        [apex] => {
            for k in 1..n - 1 {
                let [from, to] = [k, k + 1].map(|k| polygon[(apex + k) % n]);
                add([polygon[*apex], from, to, polygon[*apex]]);
            }
        }
        // A quadrilateral a corner, from the middles of its sides to the centre; two triangles where it is singular.
        _ => {
            let centre = polygon.iter().copied().sum::<Vec3>() / n as f64;
            for k in 0..n {
                let corner = polygon[k];
                let [before, after] = [n - 1, 1].map(|step| 0.5 * (corner + polygon[(k + step) % n]));
                if singular.contains(&k) {
                    add([corner, after, centre, corner]);
                    add([corner, centre, before, corner]);
                } else {
                    add([corner, after, centre, before]);
                }
            }
        }
    }
}
