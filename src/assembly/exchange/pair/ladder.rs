//! Patches made ready for product Gauss rules of every length.

use super::double::Double;
use super::product::Points;
use super::real::Vector;
use super::rules::{Rule, gauss_legendre};
use super::shape::Shape;
use crate::geometry::Polygon;
use pulp::Arch;
use std::borrow::Cow;

/// Gauss points an axis.
pub const LADDER: [usize; 11] = [2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16];

/// Rungs whose points are kept with every patch; the others are laid anew for every pair.
const N_KEPT: usize = 7;

/// The Gauss rules that [`unoccluded`](super::unoccluded) chooses from, and the vector instructions that this machine has for
/// them.
pub struct Ladder {
    /// Each rung's, and the one longer by a point.
    rules: [[Rule; 2]; LADDER.len()],
    pub(super) arch: Arch,
}

/// A polygon made ready for [`unoccluded`](super::unoccluded): its points for the lower rungs. 7 kB a quadrilateral.
pub struct Nodes {
    pub(super) shape: Shape,
    rungs: Vec<Points>,
}

impl Default for Ladder {
    fn default() -> Self {
        Self::new()
    }
}

impl Ladder {
    /// Computes the rules.
    pub fn new() -> Self {
        Self { rules: LADDER.map(|n| [n, n + 1].map(gauss_legendre)), arch: Arch::new() }
    }

    /// Lays the points of the rungs that are kept onto a patch.
    pub fn nodes(&self, polygon: &Polygon) -> Nodes {
        let vertices = polygon.vertices();
        let mut nodes = Nodes { shape: Shape::new(&Vector::from_point(vertices[0], vertices)), rungs: Vec::new() };
        nodes.rungs = (0..N_KEPT).map(|rung| self.points(&nodes.shape, rung)).collect();
        nodes
    }

    /// A polygon given by its corners, with no points kept.
    pub(super) fn bare(&self, corners: &[Vector<Double>]) -> Nodes {
        let own: Vec<_> = corners.iter().map(|v| *v - corners[0]).collect();
        Nodes { shape: Shape::new(&own), rungs: Vec::new() }
    }

    /// The points of a rung.
    pub(super) fn rung<'a>(&self, nodes: &'a Nodes, rung: usize) -> Cow<'a, Points> {
        nodes.rungs.get(rung).map_or_else(|| Cow::Owned(self.points(&nodes.shape, rung)), Cow::Borrowed)
    }

    fn points(&self, shape: &Shape, rung: usize) -> Points {
        let [rule, longer] = &self.rules[rung];
        shape.points(rule, longer)
    }
}
