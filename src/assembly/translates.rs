//! Patches that stand in rows, each a step further than the one before: pairs that differ by a translation exchange alike.
//!
//! ```text
//! T_{i+k, j+k} = T_{ij}   where k steps carry i and j into patches of their surfaces
//! ```
//!
//! as long as nothing stands between either pair. Nothing is taken on trust: a patch follows another where all of its corners do.

use super::orbits::Places;
use crate::geometry::{Affine3, Polygon, Vec3};

/// Rows of patches, a set of rows for every step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Translates {
    sets: Vec<Rows>,
}

/// Rows along one step.
#[derive(Clone, Debug, PartialEq)]
struct Rows {
    members: Vec<Vec<usize>>,
    /// Row of every patch, and its place in it.
    place_of: Vec<(usize, usize)>,
}

impl Translates {
    /// The rows of patches of the same kind along each of these steps. Cost O(n) a step.
    pub fn new(patches: &[(usize, &Polygon)], steps: &[Vec3]) -> Self {
        let places = Places::new(patches);
        let rows = |step: &Vec3| {
            let step = Affine3::from_translation(*step);
            let next = |(k, patch): (usize, &(usize, &Polygon))| places.image(*patch, &step).filter(|next| *next != k);
            let next: Vec<Option<usize>> = patches.iter().enumerate().map(next).collect();
            Rows::along(&next)
        };
        Self { sets: steps.iter().map(rows).filter(|rows| rows.members.len() < patches.len()).collect() }
    }

    /// True where no patch is the translate of another.
    pub fn is_empty(&self) -> bool {
        self.sets.is_empty()
    }

    /// The pair that this one is a translate of: both moved as far back along every step as there are patches.
    pub fn first_of(&self, [mut i, mut j]: [usize; 2]) -> [usize; 2] {
        for rows in &self.sets {
            let ((row_i, place_i), (row_j, place_j)) = (rows.place_of[i], rows.place_of[j]);
            let back = place_i.min(place_j);
            (i, j) = (rows.members[row_i][place_i - back], rows.members[row_j][place_j - back]);
        }
        [i.min(j), i.max(j)]
    }
}

impl Rows {
    /// Follows every patch that comes after no other to the end of its row.
    fn along(next: &[Option<usize>]) -> Self {
        let mut is_first = vec![true; next.len()];
        next.iter().flatten().for_each(|k| is_first[*k] = false);
        let mut members = Vec::new();
        let mut place_of = vec![(0, 0); next.len()];
        for first in (0..next.len()).filter(|k| is_first[*k]) {
            let row: Vec<usize> = std::iter::successors(Some(first), |k| next[*k]).collect();
            row.iter().enumerate().for_each(|(place, k)| place_of[*k] = (members.len(), place));
            members.push(row);
        }
        Self { members, place_of }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_move_back_together_as_far_as_both_can() {
        let square = |x: f64, y: f64, z: f64| {
            let corner = |u: f64, v: f64| Vec3::new(x + u, y + v, z);
            Polygon::new(vec![corner(0.0, 0.0), corner(0.25, 0.0), corner(0.25, 0.25), corner(0.0, 0.25)])
                .expect("a square is a polygon")
        };
        // Two floors of 4 × 4 cells, x running fastest, the second one another surface.
        let cells: Vec<(usize, Polygon)> = (0..32)
            .map(|k| (k / 16, square(0.25 * (k % 4) as f64, 0.25 * (k / 4 % 4) as f64, (k / 16) as f64)))
            .collect();
        let patches: Vec<(usize, &Polygon)> = cells.iter().map(|(kind, polygon)| (*kind, polygon)).collect();
        let translates = Translates::new(&patches, &[0.25 * Vec3::X, 0.25 * Vec3::Y, Vec3::Z]);
        let at = |x: usize, y: usize, z: usize| x + 4 * y + 16 * z;
        assert_eq!(translates.first_of([at(3, 1, 0), at(2, 3, 1)]), [at(1, 0, 0), at(0, 2, 1)]);
        assert_eq!(translates.first_of([at(0, 1, 0), at(2, 1, 0)]), [at(0, 0, 0), at(2, 0, 0)]);
        // No step leads from one surface to another, and one that leads nowhere makes no rows.
        assert_eq!(translates.sets.len(), 2);
        assert!(Translates::new(&patches, &[0.1 * Vec3::X]).is_empty());
    }
}
