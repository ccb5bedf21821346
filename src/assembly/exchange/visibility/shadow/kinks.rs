//! Where what is hidden bends on curves: three edges of different outlines that pass each other in one direction.
//!
//! The planes through x and the edges then share a line, det(n₁, n₂, n₃) = 0, which is a conic in the plane of x (the lines that meet three
//! lines sweep a quadric).

use super::events::sides_of;
use super::flux::Edge;
use crate::geometry::Vec3;

/// So many points speak for a cell: its corners, the middles of its sides and of a diagonal.
const N_EYES: usize = 9;

/// The ends and the middle, by number, of the sides of the two triangles that a diagonal makes of a cell.
const SIDES: [[usize; 3]; 5] = [[0, 4, 1], [1, 5, 2], [2, 6, 3], [3, 7, 0], [0, 8, 2]];

/// True if a quadratic function of these values is positive all over the cell: Bézier's coefficients on both triangles are, of which it is a
/// mean.
fn is_positive(values: [f64; N_EYES]) -> bool {
    values[..4].iter().all(|v| *v > 0.0)
        && SIDES.iter().all(|&[from, middle, to]| 4.0 * values[middle] > values[from] + values[to])
}

/// The planes through the points of a cell and one edge, normals to the hidden side.
struct Sheaf {
    edge: Edge,
    normals: [Vec3; N_EYES],
}

/// Three edges that may pass each other in view.
#[derive(Clone, Copy, Debug)]
pub struct Kink([Edge; 3]);

impl Kink {
    /// Vanishes where the three planes share a line; quadratic on every line of points x.
    pub fn twist(&self, x: Vec3) -> f64 {
        let [one, two, three] = self.0.map(|edge| edge.plane_from(x));
        one.cross(two).dot(three)
    }

    /// Where the twist changes sign between two points, as shares of the way.
    pub fn crossings(&self, from: Vec3, to: Vec3) -> impl Iterator<Item = f64> {
        // The parabola through three values: a s² + b s + c.
        let [c, middle, end] = [from, 0.5 * (from + to), to].map(|x| self.twist(x));
        let (a, b) = (2.0 * (c + end) - 4.0 * middle, 4.0 * middle - 3.0 * c - end);
        let square = b * b - 4.0 * a * c;
        let q = -0.5 * (b + square.max(0.0).sqrt().copysign(b));
        let roots = if square > 0.0 { [q / a, c / q] } else { [f64::NAN; 2] };
        roots.into_iter().filter(|s| *s > 0.0 && *s < 1.0)
    }
}

/// Adds those three edges of different outlines (sides of the target are one) that may pass each other in view, seen from somewhere in a cell
/// with these corners.
///
/// Where two of them meet out of sight, outside of one and the same other edge all over the cell, nothing bends.
pub fn find(&[a, b, c, d]: &[Vec3; 4], target: &[Vec3], edges: &[Edge], into: &mut Vec<Kink>) {
    if edges.iter().all(|edge| edge.owner == edges[0].owner) {
        return;
    }
    let middle = |p: Vec3, q: Vec3| 0.5 * (p + q);
    let eyes = [a, b, c, d, middle(a, b), middle(b, c), middle(c, d), middle(d, a), middle(a, c)];
    let through = |edge: Edge| Sheaf { edge, normals: eyes.map(|x| edge.plane_from(x)) };
    let sheaves: Vec<Sheaf> = edges.iter().copied().chain(sides_of(target)).map(through).collect();
    let away = (target[1] - target[0]).cross(target[2] - target[0]);

    // Two edges meet in a direction; that towards the target may be hidden by some other edge everywhere. Where it turns over, edges that are
    // nearly parallel pass each other all along.
    let is_out_of_sight = |i: usize, j: usize| {
        let ways: [Vec3; N_EYES] = std::array::from_fn(|k| sheaves[i].normals[k].cross(sheaves[j].normals[k]));
        let sign = -ways[0].dot(away).signum();
        let is_steady = is_positive(ways.map(|way| -sign * way.dot(away)));
        let outside = |other: &Sheaf| is_positive(std::array::from_fn(|k| -sign * other.normals[k].dot(ways[k])));
        is_steady && sheaves.iter().enumerate().any(|(l, other)| l != i && l != j && outside(other))
    };

    // At least two of three are edges of obstacles.
    for i in 0..edges.len() {
        for j in (i + 1..edges.len()).filter(|j| edges[*j].owner != edges[i].owner) {
            let ways: [Vec3; N_EYES] = std::array::from_fn(|k| sheaves[i].normals[k].cross(sheaves[j].normals[k]));
            let mut meets_in_sight = None;
            for (l, third) in sheaves.iter().enumerate().skip(j + 1) {
                let is_apart = third.edge.owner != edges[i].owner && third.edge.owner != edges[j].owner;
                let twist: [f64; N_EYES] = std::array::from_fn(|k| third.normals[k].dot(ways[k]));
                if !is_apart || is_positive(twist.map(|t| t * twist[0].signum())) {
                    continue;
                }
                // In one plane, two edges pass each other or have a corner in common: cells end at such lines.
                let (one, two, three) = (&edges[i], &edges[j], &third.edge);
                if one.is_coplanar(two) || one.is_coplanar(three) || two.is_coplanar(three) {
                    continue;
                }
                if !*meets_in_sight.get_or_insert_with(|| !is_out_of_sight(i, j)) {
                    break;
                }
                if !is_out_of_sight(i, l) && !is_out_of_sight(j, l) {
                    into.push(Kink([edges[i], edges[j], third.edge]));
                }
            }
        }
    }
}
