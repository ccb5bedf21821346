//! Boxes around boxes, eight to a node, f32, around blocks of eight polygons.
//!
//! An `obvhs` tree of two is collapsed so that the expected cost of a random line is least (Ylitie, Karras and Laine 2017, section 3.1).

use super::block::Block;
use super::eight::Eight;
use obvhs::bvh2::{Bvh2, node::Bvh2Node};
use pulp::f32x8;

/// Cost of testing a block of polygons over that of a node's eight boxes.
const BLOCK_COST: f32 = 0.8;

/// A child of a node: the number of a node, or of a block with this bit set.
pub(super) const BLOCK: u32 = 1 << 31;

/// Eight boxes and what is in them.
#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Low and high bounds along each axis.
    bounds: [[f32x8; 2]; 3],
    pub children: [u32; 8],
    pub n_children: u32,
}

/// A ray among boxes, eight times.
pub(super) struct BoxRay {
    inverse: [f32x8; 3],
    /// −origin · inverse.
    shift: [f32x8; 3],
    /// Which bound is met first along each axis.
    first: [usize; 3],
}

impl BoxRay {
    /// Directions are finite and not all zero; a component too small to divide by counts as 1e-20, which moves the ray by nothing.
    #[inline(always)]
    pub fn new(simd: impl Eight, origin: [f32; 3], direction: [f32; 3]) -> Self {
        let inverse = direction.map(|d| if d.abs() < 1e-20 { 1e20_f32.copysign(d) } else { 1.0 / d });
        Self {
            inverse: simd.splat3(inverse),
            shift: simd.splat3([0, 1, 2].map(|axis| -origin[axis] * inverse[axis])),
            first: inverse.map(|i| usize::from(i < 0.0)),
        }
    }
}

impl Node {
    /// Where the ray enters each box, and which of them it meets at 0 ≤ t ≤ t_max.
    #[inline(always)]
    pub fn meet(&self, simd: impl Eight, ray: &BoxRay, t_max: f32) -> (f32x8, u32) {
        let ((x0, x1), (y0, y1), (z0, z1)) =
            (self.slab(simd, ray, 0), self.slab(simd, ray, 1), self.slab(simd, ray, 2));
        let enter = simd.max_f32s(simd.max_f32s(x0, y0), simd.max_f32s(z0, simd.splat_f32s(0.0)));
        let leave = simd.min_f32s(simd.min_f32s(x1, y1), simd.min_f32s(z1, simd.splat_f32s(t_max)));
        (enter, !simd.signs(simd.sub_f32s(leave, enter)) & 0xff)
    }

    /// Where the ray passes the first and the second bound of an axis.
    #[inline(always)]
    fn slab(&self, simd: impl Eight, ray: &BoxRay, axis: usize) -> (f32x8, f32x8) {
        let first = ray.first[axis] & 1;
        let (near, far) = (self.bounds[axis][first], self.bounds[axis][first ^ 1]);
        let (inverse, shift) = (ray.inverse[axis], ray.shift[axis]);
        (simd.mul_add_e_f32s(near, inverse, shift), simd.mul_add_e_f32s(far, inverse, shift))
    }

    /// Which boxes meet the box between two corners.
    #[inline(always)]
    pub fn overlap(&self, simd: impl Eight, low: [f32; 3], high: [f32; 3]) -> u32 {
        let (low, high) = (simd.splat3(low), simd.splat3(high));
        let mut overlap = simd.sub_f32s(self.bounds[0][1], low[0]);
        for axis in 0..3 {
            overlap = simd.min_f32s(overlap, simd.sub_f32s(self.bounds[axis][1], low[axis]));
            overlap = simd.min_f32s(overlap, simd.sub_f32s(high[axis], self.bounds[axis][0]));
        }
        !simd.signs(overlap) & 0xff
    }
}

/// The collapsed tree.
#[derive(Clone)]
pub(super) struct Tree {
    /// Empty if there is one block or none; the first is the root.
    pub nodes: Vec<Node>,
    pub blocks: Vec<Block>,
    /// Children that a walk from the root may have to remember.
    pub n_waiting: usize,
}

impl Tree {
    /// Blocks without boxes.
    pub fn flat(n_primitives: usize, block: impl FnMut(&[u32]) -> Block) -> Self {
        let primitives: Vec<u32> = (0..n_primitives as u32).collect();
        Self { nodes: Vec::new(), blocks: primitives.chunks(8).map(block).collect(), n_waiting: 1 }
    }

    /// Collapses a tree of two; `block(primitives)` makes a block of at most eight primitives.
    pub fn collapse(binary: &Bvh2, mut block: impl FnMut(&[u32]) -> Block) -> Self {
        let mut tree = Self { nodes: Vec::new(), blocks: Vec::new(), n_waiting: 1 };
        if binary.nodes.is_empty() {
            return tree;
        }
        let plan = Plan::of(binary);
        let mut leaf = |tree: &mut Self, node: u32| {
            let primitives: Vec<u32> = plan.primitives(binary, node);
            tree.blocks.push(block(&primitives));
            (tree.blocks.len() - 1) as u32
        };
        if plan.is_block(0) {
            leaf(&mut tree, 0);
            return tree;
        }
        // Breadth first, so that the top of the tree stays together.
        let mut roots = vec![(0_u32, 1_usize)];
        let mut done = 0;
        while done < roots.len() {
            let (root, waiting) = roots[done];
            done += 1;
            let members = plan.children(binary, root);
            let mut node = Node::empty();
            let waiting = waiting + members.len();
            tree.n_waiting = tree.n_waiting.max(waiting);
            for &member in &members {
                let child = if plan.is_block(member) {
                    leaf(&mut tree, member) | BLOCK
                } else {
                    roots.push((member, waiting));
                    (roots.len() - 1) as u32
                };
                node.add(&binary.nodes[member as usize], child);
            }
            tree.nodes.push(node);
        }
        tree
    }
}

impl Node {
    fn empty() -> Self {
        let splat = |value: f32| -> f32x8 { pulp::cast([value; 8]) };
        let bounds = [[splat(f32::MAX), splat(f32::MIN)]; 3];
        Self { bounds, children: [0; 8], n_children: 0 }
    }

    fn add(&mut self, binary: &Bvh2Node, child: u32) {
        let lane = self.n_children as usize;
        let mut set = |axis: usize, bound: usize, value: f32| {
            let mut lanes: [f32; 8] = pulp::cast(self.bounds[axis][bound]);
            lanes[lane] = value;
            self.bounds[axis][bound] = pulp::cast(lanes);
        };
        for axis in 0..3 {
            set(axis, 0, binary.aabb().min[axis]);
            set(axis, 1, binary.aabb().max[axis]);
        }
        self.children[lane] = child;
        self.n_children += 1;
    }
}

/// For every node of the tree of two: its least cost as one to eight roots.
struct Plan {
    costs: Vec<[f32; 8]>,
    n_primitives: Vec<u32>,
}

impl Plan {
    fn of(binary: &Bvh2) -> Self {
        let n = binary.nodes.len();
        let mut plan = Self { costs: vec![[f32::INFINITY; 8]; n], n_primitives: vec![0; n] };
        // Children before parents.
        let mut order = vec![0_u32];
        let mut done = 0;
        while done < order.len() {
            let node = &binary.nodes[order[done] as usize];
            if !node.is_leaf() {
                order.extend([node.first_index, node.first_index + 1]);
            }
            done += 1;
        }
        for &k in order.iter().rev() {
            let node = &binary.nodes[k as usize];
            let area = node.aabb().half_area();
            if node.is_leaf() {
                plan.n_primitives[k as usize] = node.prim_count;
                plan.costs[k as usize] = [area * BLOCK_COST; 8];
                continue;
            }
            let [left, right] = [node.first_index as usize, node.first_index as usize + 1];
            let n_primitives = plan.n_primitives[left] + plan.n_primitives[right];
            let mut costs = [f32::INFINITY; 8];
            for roots in 2..=8 {
                let (_, cost) = plan.split(left, right, roots);
                costs[roots - 1] = cost.min(costs[roots - 2]);
            }
            let as_node = area + costs[7];
            // Small subtrees are always blocks: a node would test as many boxes.
            costs[0] = if n_primitives <= 8 { area * BLOCK_COST } else { as_node };
            for roots in 1..8 {
                costs[roots] = costs[roots].min(costs[0]);
            }
            plan.n_primitives[k as usize] = n_primitives;
            plan.costs[k as usize] = costs;
        }
        plan
    }

    /// How many of the roots go to the left at least cost, and that cost.
    fn split(&self, left: usize, right: usize, roots: usize) -> (usize, f32) {
        let cost = |k: usize| self.costs[left][k - 1] + self.costs[right][roots - k - 1];
        (1..roots)
            .map(|k| (k, cost(k)))
            .fold((1, f32::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
    }

    fn is_block(&self, node: u32) -> bool {
        self.n_primitives[node as usize] <= 8
    }

    /// The nodes of the tree of two that become the children of one node.
    fn children(&self, binary: &Bvh2, node: u32) -> Vec<u32> {
        let mut children = Vec::with_capacity(8);
        let mut open = vec![(node, 8_usize, true)];
        while let Some((k, roots, is_root)) = open.pop() {
            let node = &binary.nodes[k as usize];
            let costs = &self.costs[k as usize];
            // As many roots as are worth having.
            let roots = (1..=roots).find(|r| costs[r - 1] <= costs[roots - 1]).unwrap_or(1);
            if (roots == 1 && !is_root) || node.is_leaf() {
                children.push(k);
                continue;
            }
            let roots = if is_root { 8 } else { roots };
            let (left, right) = (node.first_index, node.first_index + 1);
            let (to_left, _) = self.split(left as usize, right as usize, roots);
            open.push((right, roots - to_left, false));
            open.push((left, to_left, false));
        }
        children
    }

    fn primitives(&self, binary: &Bvh2, node: u32) -> Vec<u32> {
        let mut primitives = Vec::with_capacity(8);
        let mut open = vec![node];
        while let Some(k) = open.pop() {
            let node = &binary.nodes[k as usize];
            if node.is_leaf() {
                let range = node.first_index as usize..(node.first_index + node.prim_count) as usize;
                primitives.extend_from_slice(&binary.primitive_indices[range]);
            } else {
                open.extend([node.first_index + 1, node.first_index]);
            }
        }
        primitives
    }
}
