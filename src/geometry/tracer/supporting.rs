//! Which planes have all of a scene on one side.

use super::boxes::Boxes;
use crate::geometry::Polygon;
use crate::geometry::plane::{Plane, largest_of_planes};
use obvhs::bvh2::Bvh2;

/// For every number of a plane (see [`group_by_plane`](crate::geometry::plane::group_by_plane)): true if no vertex of the scene lies
/// strictly on one of its sides. Cost O(n log n) for a scene whose planes pass close to few of its boxes.
pub(super) fn supporting(polygons: &[&Polygon], planes: &[u32]) -> Vec<bool> {
    let mut supporting = vec![false; polygons.len()];
    if !polygons.is_empty() {
        let boxes = Boxes::around(polygons.iter().copied());
        let tree = boxes.tree();
        for plane in largest_of_planes(polygons, planes) {
            supporting[planes[plane.of] as usize] = is_supporting(&plane, polygons, &boxes, &tree);
        }
    }
    supporting
}

fn is_supporting(plane: &Plane, polygons: &[&Polygon], boxes: &Boxes, tree: &Bvh2) -> bool {
    let point = boxes.local.point(plane.point);
    let (mut above, mut below) = (false, false);
    let mut open = vec![0_u32];
    while let Some(node) = open.pop() {
        // Leave out boxes that cannot hold what is still looked for.
        let node = &tree.nodes[node as usize];
        let (low, high) = (node.aabb().min.as_dvec3(), node.aabb().max.as_dvec3());
        let height = plane.normal.dot(0.5 * (low + high) - point);
        let reach = plane.normal.abs().dot(0.5 * (high - low));
        if (above || height + reach <= 0.0) && (below || height - reach >= 0.0) {
            continue;
        }
        if !node.is_leaf() {
            open.extend([node.first_index, node.first_index + 1]);
            continue;
        }
        for k in node.first_index..node.first_index + node.prim_count {
            for v in polygons[tree.primitive_indices[k as usize] as usize].vertices() {
                let height = plane.height(*v);
                above |= height > 0.0;
                below |= height < 0.0;
            }
        }
        if above && below {
            return false;
        }
    }
    true
}
