//! Walks down the tree: to the closest polygon, to any that blocks, to all whose boxes meet a box.

use super::block::{Block, LaneRay};
use super::eight::{Eight, Kernel};
use super::local::{LocalRay, round_up};
use super::tree::{BLOCK, BoxRay, Tree};
use super::{Hit, Tracer};
use crate::geometry::Ray;

/// Room for waiting children on the stack; deeper trees take a heap.
const WAITING: usize = 96;

/// A question to the tree.
trait Visitor {
    type Answer;
    /// A child that waits, and what is known of it.
    type Waiting: Copy + Default;

    /// Tests all blocks.
    fn test_all(&self, simd: impl Eight, tree: &Tree) -> Self::Answer;

    /// Walks down the tree, with room for the children that wait.
    fn walk(&self, simd: impl Eight, tree: &Tree, waiting: &mut [Self::Waiting]) -> Self::Answer;
}

#[inline(always)]
fn visit<V: Visitor>(simd: impl Eight, tree: &Tree, visitor: &V) -> V::Answer {
    if tree.nodes.is_empty() {
        visitor.test_all(simd, tree)
    } else if tree.n_waiting <= WAITING {
        visitor.walk(simd, tree, &mut [V::Waiting::default(); WAITING])
    } else {
        visitor.walk(simd, tree, &mut vec![V::Waiting::default(); tree.n_waiting])
    }
}

/// The closest polygon met that is not in `plane`.
pub(super) struct Closest<'a> {
    pub tracer: &'a Tracer,
    pub ray: &'a Ray,
    pub local: LocalRay,
    pub plane: u32,
}

impl Kernel for Closest<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run(self, simd: impl Eight) -> Option<Hit> {
        visit(simd, &self.tracer.tree, &self)
    }
}

impl Visitor for Closest<'_> {
    type Answer = Option<Hit>;
    type Waiting = u64;

    #[inline(always)]
    fn test_all(&self, simd: impl Eight, tree: &Tree) -> Option<Hit> {
        let mut so_far = SoFar { lanes: LaneRay::new(simd, &self.local), t_max: 0.0, best: None };
        for block in &tree.blocks {
            self.meet(simd, block, &mut so_far);
        }
        so_far.best
    }

    /// Waiting children are numbers that sort by where the ray enters them: bits of t, then the child.
    #[inline(always)]
    fn walk(&self, simd: impl Eight, tree: &Tree, waiting: &mut [u64]) -> Option<Hit> {
        let mut so_far =
            SoFar { lanes: LaneRay::new(simd, &self.local), t_max: round_up(self.local.t_max), best: None };
        let boxes = BoxRay::new(simd, self.local.origin, self.local.direction);
        let mut n_waiting = 1;
        waiting[0] = 0;
        while n_waiting > 0 {
            n_waiting -= 1;
            let next = waiting[n_waiting];
            if f32::from_bits((next >> 32) as u32) > so_far.t_max {
                continue;
            }
            let child = next as u32;
            if child & BLOCK != 0 {
                self.meet(simd, &tree.blocks[(child & !BLOCK) as usize], &mut so_far);
                continue;
            }
            // Wait for the nearest last.
            let node = &tree.nodes[child as usize];
            let (enter, mut met) = node.meet(simd, &boxes, so_far.t_max);
            let enter: [u32; 8] = pulp::cast(enter);
            let first = n_waiting;
            while met != 0 {
                let lane = met.trailing_zeros() as usize & 7;
                met &= met - 1;
                let entry = u64::from(enter[lane]) << 32 | u64::from(node.children[lane]);
                let mut place = n_waiting;
                while place > first && waiting[place - 1] < entry {
                    waiting[place] = waiting[place - 1];
                    place -= 1;
                }
                waiting[place] = entry;
                n_waiting += 1;
            }
        }
        so_far.best
    }
}

impl Closest<'_> {
    /// Looks for a polygon of the block that comes before the best so far.
    #[inline(always)]
    fn meet(&self, simd: impl Eight, block: &Block, so_far: &mut SoFar) {
        let candidates = block.candidates(simd, &so_far.lanes, [self.plane]);
        let mut left = candidates.possible;
        while left != 0 {
            let lane = left.trailing_zeros() as usize & 7;
            left &= left - 1;
            let shape = &self.tracer.shapes[block.first as usize + lane];
            let nearest = so_far.best.map_or(f64::MAX, |hit| hit.t);
            let hit = if candidates.inside >> lane & 1 == 1 {
                shape.meet_plane(self.ray, nearest)
            } else {
                self.tracer.meet(self.ray, shape, nearest)
            };
            let Some(hit) = hit else { continue };
            // Of two polygons met at one point take the lower number, whatever the order of the boxes.
            if hit.t < nearest || so_far.best.is_none_or(|best| hit.polygon < best.polygon) {
                so_far.best = Some(hit);
                so_far.t_max = self.local.parameter(hit.t);
                so_far.lanes.shorten(simd, so_far.t_max);
            }
        }
    }
}

/// A walk to the closest polygon under way.
struct SoFar {
    lanes: LaneRay,
    t_max: f32,
    best: Option<Hit>,
}

/// Whether any polygon not in `planes` is met at 0 < t < 1.
pub(super) struct Any<'a> {
    pub tracer: &'a Tracer,
    pub ray: &'a Ray,
    pub local: LocalRay,
    pub planes: [u32; 2],
}

impl Kernel for Any<'_> {
    type Output = bool;

    #[inline(always)]
    fn run(self, simd: impl Eight) -> bool {
        visit(simd, &self.tracer.tree, &self)
    }
}

impl Visitor for Any<'_> {
    type Answer = bool;
    type Waiting = u32;

    #[inline(always)]
    fn test_all(&self, simd: impl Eight, tree: &Tree) -> bool {
        let lanes = LaneRay::new(simd, &self.local);
        for block in &tree.blocks {
            if self.is_blocked_in(simd, block, &lanes) {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn walk(&self, simd: impl Eight, tree: &Tree, waiting: &mut [u32]) -> bool {
        let lanes = LaneRay::new(simd, &self.local);
        let boxes = BoxRay::new(simd, self.local.origin, self.local.direction);
        let t_max = round_up(self.local.t_max);
        let mut n_waiting = 1;
        waiting[0] = 0;
        while n_waiting > 0 {
            n_waiting -= 1;
            let node = &tree.nodes[waiting[n_waiting] as usize];
            let (_, mut met) = node.meet(simd, &boxes, t_max);
            while met != 0 {
                let child = node.children[met.trailing_zeros() as usize & 7];
                met &= met - 1;
                if child & BLOCK == 0 {
                    waiting[n_waiting] = child;
                    n_waiting += 1;
                } else if self.is_blocked_in(simd, &tree.blocks[(child & !BLOCK) as usize], &lanes) {
                    return true;
                }
            }
        }
        false
    }
}

impl Any<'_> {
    #[inline(always)]
    fn is_blocked_in(&self, simd: impl Eight, block: &Block, lanes: &LaneRay) -> bool {
        let candidates = block.candidates(simd, lanes, self.planes);
        if candidates.inside != 0 {
            return true;
        }
        let mut doubtful = candidates.possible;
        while doubtful != 0 {
            let lane = doubtful.trailing_zeros() as usize & 7;
            doubtful &= doubtful - 1;
            let shape = &self.tracer.shapes[block.first as usize + lane];
            if self.tracer.meet(self.ray, shape, 1.0).is_some_and(|hit| hit.t < 1.0) {
                return true;
            }
        }
        false
    }
}

/// Every polygon in a block whose box meets the box from `low` to `high`.
pub(super) struct Near<'a, F> {
    pub tree: &'a Tree,
    pub low: [f32; 3],
    pub high: [f32; 3],
    pub visit: F,
}

impl<F: FnMut(u32)> Kernel for Near<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run(mut self, simd: impl Eight) {
        let tree = self.tree;
        let all = |block: &Block| block.first..block.first + block.n_polygons;
        if tree.nodes.is_empty() {
            tree.blocks.iter().flat_map(all).for_each(self.visit);
            return;
        }
        let mut waiting = vec![0_u32];
        while let Some(node) = waiting.pop() {
            let node = &tree.nodes[node as usize];
            let mut met = node.overlap(simd, self.low, self.high);
            while met != 0 {
                let child = node.children[met.trailing_zeros() as usize & 7];
                met &= met - 1;
                if child & BLOCK == 0 {
                    waiting.push(child);
                } else {
                    all(&tree.blocks[(child & !BLOCK) as usize]).for_each(&mut self.visit);
                }
            }
        }
    }
}
