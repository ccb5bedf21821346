//! What several outlines hide together, term by term.

use super::body::Lie;
use super::cells::{Line, Pieces, grain};
use super::cover::cover;
use super::events;
use super::flux::Edge;
use super::nature::singular_corners;
use super::{Desk, Term};
use crate::geometry::Vec3;
use std::ops::Range;

/// More lines than this are left to refinement: they would cut a part into thousands of pieces.
const MOST_LINES: usize = 192;

impl Desk {
    /// Adds sign · F(target ∩ hidden sides of the active edges ∩ (what the first n outlines hide)): the union of sets is the sum of each
    /// less its intersection with those before it.
    pub(super) fn add_union(
        &mut self,
        part: &[Vec3],
        target: Range<usize>,
        active: Range<usize>,
        sign: f64,
        n: usize,
        is_whole: bool,
    ) {
        for k in 0..n {
            let (n_targets, n_active) = (self.targets.len(), self.active.len());
            let mut front = Pieces::default();
            let part = match self.outlines[k].cut {
                None => part,
                Some(plane) => {
                    Line { normal: plane.normal, point: plane.point }.keep(part, 1.0, grain(part), &mut front);
                    let Some(front) = front.iter().next() else { continue };
                    front
                }
            };
            let is_whole = is_whole && self.outlines[k].cut.is_none();
            let Some(target) = self.restrict(part, target.clone(), active.clone(), k) else {
                self.targets.truncate(n_targets);
                self.active.truncate(n_active);
                continue;
            };
            let active = n_active..self.active.len();
            if is_whole && self.chain.is_empty() && active.is_empty() && target == (0..self.n_target) {
                self.is_total = true;
                return;
            }
            self.terms.push(Term { sign, target: target.clone(), edges: active.clone(), is_cut: true });
            self.cut_into_cells(part);
            self.chain.push(k);
            self.add_union(part, target, active, -sign, k, false);
            self.chain.pop();
            if self.is_total {
                return;
            }
        }
    }

    /// The target cut by the front faces of an outline, and its edges that take part added to those that do already; `None` where
    /// nothing is hidden.
    fn restrict(
        &mut self,
        part: &[Vec3],
        target: Range<usize>,
        active: Range<usize>,
        k: usize,
    ) -> Option<Range<usize>> {
        let outline = self.outlines[k].clone();
        // Bodies side by side hide nothing together.
        for &other in &self.chain {
            if self.outlines[other].body == outline.body {
                return None;
            }
            let other = self.outlines[other].edges.clone();
            let apart = |one: Range<usize>, two: Range<usize>| {
                let outside =
                    |edge: &Edge| self.edges[two.clone()].iter().all(|corner| edge.never_hides(part, &[corner.from]));
                !two.is_empty() && self.edges[one].iter().any(outside)
            };
            if apart(outline.edges.clone(), other.clone()) || apart(other, outline.edges.clone()) {
                return None;
            }
        }

        // What lies before a front face is not hidden.
        let mut target = target;
        for front in self.fronts[outline.fronts.clone()].iter() {
            match front.lie(&self.targets[target.clone()]) {
                Lie::Below => {}
                Lie::Above => return None,
                Lie::Across => {
                    let line = Line { normal: -front.normal, point: front.point };
                    self.spare.clear();
                    let whole = &self.targets[target.clone()];
                    line.keep(whole, 1.0, grain(whole), &mut self.spare);
                    let start = self.targets.len();
                    self.targets.extend_from_slice(self.spare.iter().next()?);
                    target = start..self.targets.len();
                }
            }
        }

        // Keep the edges that pass through what is left.
        let corners = &self.targets[target.clone()];
        for k in active.clone().chain(outline.edges.start + active.end..outline.edges.end + active.end) {
            let edge = if k < active.end { self.active[k] } else { self.edges[k - active.end] };
            match edge.lie(part, corners) {
                Lie::Below => return None,
                Lie::Above => {}
                Lie::Across => self.active.push(edge),
            }
        }
        Some(target)
    }

    /// Cuts the part along the lines on which the last term bends, and covers what is left with cells.
    fn cut_into_cells(&mut self, part: &[Vec3]) {
        let Self { terms, targets, active, lines, pieces, spare, cells, points, singular, .. } = self;
        let number = terms.len() - 1;
        let (target, edges) = (&targets[terms[number].target.clone()], &active[terms[number].edges.clone()]);
        events::find(part, target, edges, points, lines);
        pieces.clear();
        pieces.add(part);
        let (size, normal) = (events::size_of(part), events::normal_of(part));
        for (line, slope) in lines.iter().take(MOST_LINES) {
            spare.clear();
            for piece in pieces.iter() {
                line.split(piece, *slope, size, spare);
            }
            std::mem::swap(pieces, spare);
        }
        let is_cut = lines.len() <= MOST_LINES;
        for piece in pieces.iter() {
            singular.clear();
            singular.extend(singular_corners(piece, normal, target, edges));
            cover(piece, singular, number, cells);
        }
        terms[number].is_cut = is_cut;
    }
}
