//! What is integrated: form factors of what terms hide, from points of the patch stood on.

use super::Term;
use super::flux::{self, Edge, Scratch};
use super::kinks::{self, Kink};
use super::nature;
use crate::geometry::Vec3;
use std::ops::Range;

/// What an integrand is like on a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Nature {
    /// Analytic: the error falls by this much with every point along either axis.
    Smooth { decays: [f64; 2] },
    /// Its second derivative jumps on these curves, analytic between them.
    Kinked(Range<usize>),
    /// Its second derivative may jump on curves that are not known.
    Rough,
}

/// A cell of more kinks is left to refinement.
const MOST_KINKS: usize = 3;

/// The terms of a sum over unions, each a function on the patch.
pub struct Integrand<'a> {
    /// Of the patch.
    pub normal: Vec3,
    pub terms: &'a [Term],
    pub targets: &'a [Vec3],
    pub active: &'a [Edge],
    pub scratch: &'a mut Scratch,
    /// Of all cells so far.
    pub kinks: &'a mut Vec<Kink>,
    pub n_points: usize,
}

impl Integrand<'_> {
    /// A term's value at a point inside one of its cells.
    pub fn at(&mut self, term: usize, x: Vec3) -> f64 {
        let Term { sign, target, edges, .. } = &self.terms[term];
        self.n_points += 1;
        let (target, edges) = (&self.targets[target.clone()], &self.active[edges.clone()]);
        sign * flux::hidden(x, self.normal, target, edges, self.scratch)
    }

    /// What a term is like on a cell with these corners.
    pub fn nature(&mut self, term: usize, corners: &[Vec3; 4]) -> Nature {
        let Term { target, edges, is_cut, .. } = &self.terms[term];
        if !is_cut {
            return Nature::Rough;
        }
        let (target, edges) = (&self.targets[target.clone()], &self.active[edges.clone()]);
        let first = self.kinks.len();
        kinks::find(corners, target, edges, self.kinks);
        if self.kinks.len() > first + MOST_KINKS {
            self.kinks.truncate(first);
            return Nature::Rough;
        }
        if self.kinks.len() > first {
            return Nature::Kinked(first..self.kinks.len());
        }
        Nature::Smooth { decays: nature::decays(corners, self.normal, target, edges) }
    }
}
