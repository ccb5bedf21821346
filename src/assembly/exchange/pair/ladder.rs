//! Patches made ready for quadrature.

use super::double::Double;
use super::grid::Grids;
use super::real::Vector;
use super::shape::Shape;
use crate::geometry::Polygon;
use pulp::Arch;

/// The Gauss rules that [`unoccluded`](super::unoccluded) chooses from, and the vector instructions that this machine has for
/// them.
pub struct Ladder {
    pub(super) grids: Grids,
    pub(super) arch: Arch,
}

/// A polygon made ready for [`unoccluded`](super::unoccluded): in coordinates of its own. 400 bytes a quadrilateral.
pub struct Nodes {
    pub(super) shape: Shape,
}

impl Default for Ladder {
    fn default() -> Self {
        Self::new()
    }
}

impl Ladder {
    /// Computes the rules.
    pub fn new() -> Self {
        Self { grids: Grids::new(), arch: Arch::new() }
    }

    /// Makes a patch ready.
    pub fn nodes(&self, polygon: &Polygon) -> Nodes {
        let vertices = polygon.vertices();
        Nodes { shape: Shape::new(&Vector::from_point(vertices[0], vertices)) }
    }

    /// A polygon given by its corners.
    pub(super) fn bare(&self, corners: &[Vector<Double>]) -> Nodes {
        let own: Vec<_> = corners.iter().map(|v| *v - corners[0]).collect();
        Nodes { shape: Shape::new(&own) }
    }
}
