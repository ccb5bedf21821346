//! Where light can leave a scene: what of its convex hull no surface covers.
//!
//! Between two points of the scene a ray stays inside the hull, so what leaves a patch for good passes an opening, and what passes an
//! opening never comes back: étendue that escapes is exchange with the openings, and is computed like any other.

use super::cut::{SEAM, uncovered};
use crate::geometry::{Polygon, Vec3, convex_hull, convex_hull_in_plane, group_by_plane, height};

/// The uncovered parts of the hull's faces, fronts inward. Cost O(corners · hull faces).
pub fn openings(facets: &[&Polygon]) -> Vec<Polygon> {
    let mut points: Vec<Vec3> = facets.iter().flat_map(|facet| facet.vertices()).copied().collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    points.dedup();
    let faces = convex_hull(&points);

    // Join the triangles of one plane; what is too thin to be a polygon is a seam.
    let triangles: Vec<Polygon> =
        faces.iter().filter_map(|face| Polygon::new(face.map(|k| points[k]).to_vec()).ok()).collect();
    let all: Vec<&Polygon> = triangles.iter().collect();
    let planes = group_by_plane(&all);
    let hull: f64 = triangles.iter().map(Polygon::area).sum();
    let mut found = Vec::new();
    for (k, first) in triangles.iter().enumerate().filter(|(k, _)| planes[*k] as usize == *k) {
        let joined = (k..all.len()).filter(|t| planes[*t] as usize == k).flat_map(|t| all[t].vertices()).copied();
        let Ok(face) = Polygon::new(convex_hull_in_plane(joined, first.normal())) else { continue };
        let face = face.flipped();
        let covers = facets.iter().copied().filter(|facet| covers(facet, &face));
        found.extend(uncovered(&face, covers, SEAM * hull));
    }
    found
}

/// True if the facet lies in the plane of a face of the hull. The corners of either are in the plane of the other's within rounding;
/// of a large and a small one, that of the large is the better known.
fn covers(facet: &Polygon, face: &Polygon) -> bool {
    let (large, small) = if facet.area() > face.area() { (facet, face) } else { (face, facet) };
    small.vertices().iter().all(|v| height(large.normal(), large.centroid(), *v) == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery;
    use crate::geometry::Mat3;

    /// Area of the openings of a scene of the gallery, turned, its last `n_removed` facets taken away.
    fn of(name: &str, turn: Mat3, n_removed: usize) -> f64 {
        let scene = (gallery::find(name).expect("a scene of the gallery").build)();
        let turned = |f| Polygon::new(scene.polygon(f).vertices().iter().map(|v| turn * *v).collect());
        let facets: Vec<Polygon> =
            (0..scene.facets().len() - n_removed).map(|f| turned(f).expect("still a polygon")).collect();
        openings(&facets.iter().collect::<Vec<_>>()).iter().map(Polygon::area).sum()
    }

    #[test]
    fn closed_rooms_have_none_and_others_what_is_missing() {
        for turn in [Mat3::IDENTITY, Mat3::from_rotation_x(0.3) * Mat3::from_rotation_z(1.1)] {
            for name in ["furnace-cube", "furnace-sphere", "two-rooms"] {
                assert_eq!(of(name, turn, 0), 0.0, "{name}");
            }
            // A cube of 1 without one face, and the four sides between two unit squares ½ apart. Corners are rounded to some ulp.
            assert!((of("furnace-cube", turn, 1) - 1.0).abs() < 1e-12);
            assert!((of("parallel-plates", turn, 0) - 2.0).abs() < 1e-12);
        }
    }
}
