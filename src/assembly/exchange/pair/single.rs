//! The exchange of one pair of polygons with nothing between them, outside any scene.

use super::{Ladder, unoccluded};
use crate::geometry::Polygon;
use std::sync::LazyLock;

static LADDER: LazyLock<Ladder> = LazyLock::new(Ladder::new);

/// T = ∫∫ cosθ cosθ′ / r² dA dA′ of the parts of two polygons in front of each other's plane and an estimate of its error, both
/// m² sr; `None` where they do not face each other. What [`assemble`](crate::assembly::assemble) deposits where nothing stands
/// between; [`enclose`](crate::assembly::enclose) proves it.
///
/// `tolerance` is relative. Cost: some µs to some 100 µs; a scene's pairs share what this lays out anew for each.
pub fn exchange_of_pair(a: &Polygon, b: &Polygon, tolerance: f64) -> Option<(f64, f64)> {
    let nodes = [a, b].map(|polygon| LADDER.nodes(polygon));
    unoccluded(&LADDER, (a, &nodes[0]), (b, &nodes[1]), tolerance)
}
