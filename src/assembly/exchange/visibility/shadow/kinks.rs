//! Where what is hidden bends on curves: three edges of different outlines that pass each other in one direction.
//!
//! The planes through x and the edges then share a line, det(n₁, n₂, n₃) = 0, which is a conic in the plane of x (the lines that meet three
//! lines sweep a quadric).

use super::events::sides_of;
use super::flux::Edge;
use crate::geometry::Vec3;

/// So many points speak for a cell: its corners, the middles of its sides, its centre.
const N_EYES: usize = 9;

/// The planes through the points of a cell and one edge, normals to the hidden side.
struct Sheaf {
    owner: usize,
    normals: [Vec3; N_EYES],
}

/// True if, seen from somewhere in a cell with these corners, three edges of different outlines (sides of the target are one) may pass each
/// other in view.
///
/// Where two of them meet out of sight, outside of one and the same other edge all over the cell, nothing bends.
pub fn is_kinked([a, b, c, d]: [Vec3; 4], target: &[Vec3], edges: &[Edge]) -> bool {
    let owner = edges[0].owner;
    if edges.iter().all(|edge| edge.owner == owner) {
        return false;
    }
    let middle = |p: Vec3, q: Vec3| 0.5 * (p + q);
    let eyes = [a, middle(a, b), b, middle(b, c), c, middle(c, d), d, middle(d, a), 0.25 * (a + b + c + d)];
    let through = |edge: Edge| Sheaf { owner: edge.owner, normals: eyes.map(|x| edge.plane_from(x)) };
    let sheaves: Vec<Sheaf> = edges.iter().copied().chain(sides_of(target)).map(through).collect();
    let away = (target[1] - target[0]).cross(target[2] - target[0]);

    // The direction in which two edges meet, towards the target, and whether some other edge hides it everywhere.
    let meeting = |i: usize, j: usize, k: usize| {
        let along = sheaves[i].normals[k].cross(sheaves[j].normals[k]);
        if along.dot(away) > 0.0 { -along } else { along }
    };
    let is_out_of_sight = |i: usize, j: usize| {
        let ways: [Vec3; N_EYES] = std::array::from_fn(|k| meeting(i, j, k));
        let outside = |other: &Sheaf| other.normals.iter().zip(&ways).all(|(normal, way)| normal.dot(*way) < 0.0);
        sheaves.iter().enumerate().any(|(l, other)| l != i && l != j && outside(other))
    };

    // At least two of three are edges of obstacles.
    for i in 0..edges.len() {
        for j in (i + 1..edges.len()).filter(|j| sheaves[*j].owner != sheaves[i].owner) {
            let ways: [Vec3; N_EYES] = std::array::from_fn(|k| sheaves[i].normals[k].cross(sheaves[j].normals[k]));
            let mut meets_in_sight = None;
            for l in j + 1..sheaves.len() {
                let third = &sheaves[l];
                let is_apart = third.owner != sheaves[i].owner && third.owner != sheaves[j].owner;
                let twist: [f64; N_EYES] = std::array::from_fn(|k| third.normals[k].dot(ways[k]));
                if !is_apart || twist.iter().all(|t| t * twist[0] > 0.0) {
                    continue;
                }
                if !*meets_in_sight.get_or_insert_with(|| !is_out_of_sight(i, j)) {
                    break;
                }
                if !is_out_of_sight(i, l) && !is_out_of_sight(j, l) {
                    return true;
                }
            }
        }
    }
    false
}
