//! Bundles that symmetries of a scene carry into each other: of what is the same all around, one is enough.
//!
//! A symmetry is an isometry that maps every surface onto itself, facet by facet and patch by patch. Emission and albedo are those of
//! surfaces, so the solution of L = E + K L is the same on all bundles of an orbit, and the equation holds on orbits,
//!
//! ```text
//! T_IJ = Σ_{i∈I} Σ_{j∈J} T_ij = |I| Σ_{j∈J} T_ij   for any i in I,      μ_I = |I| μ_i.
//! ```
//!
//! Nothing is taken on trust: a candidate that fails for one facet is left out.

use crate::basis::Bundles;
use crate::geometry::{Affine3, DisjointSets, Polygon, Vec3};
use crate::scene::Scene;
use std::collections::HashMap;

/// Corners further than this from their images, relative to the scene's size, are other corners: a thousand ulp, what sines and
/// rotations leave.
const COINCIDENT: f64 = 2e-13;

/// Bundles in groups of what is alike, in the order of their first members. Surfaces may be left out of it, which then only stand in the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbits {
    members: Vec<Vec<usize>>,
    orbit_of: Vec<Option<usize>>,
    /// The image of every bundle that takes part, a list a symmetry.
    symmetries: Vec<Vec<Option<usize>>>,
}

impl Orbits {
    /// The orbits of all bundles on surfaces that take part, under those of the candidates that are symmetries of the scene and of these
    /// bundles. Cost O(n) a candidate.
    pub fn new(scene: &Scene, bundles: &Bundles, takes_part: impl Fn(usize) -> bool, candidates: &[Affine3]) -> Self {
        let facets: Vec<(usize, &Polygon)> =
            scene.facets().iter().enumerate().map(|(k, facet)| (facet.surface, scene.polygon(k))).collect();
        let mut chosen = Vec::new();
        let mut patches = Vec::new();
        for bundle in 0..bundles.n_bundles() {
            let Some(patch) = bundles.patch(bundles.element_of(bundle).0) else { continue };
            let surface = scene.facets()[patch.facet].surface;
            if takes_part(surface) {
                chosen.push(bundle);
                patches.push((2 * surface + patch.side as usize, &patch.polygon));
            }
        }
        let mut alike = DisjointSets::new(chosen.len());
        let mut symmetries = Vec::new();
        for candidate in candidates {
            let Some(images) = permutation(&facets, candidate).and_then(|_| permutation(&patches, candidate)) else {
                continue;
            };
            let mut symmetry = vec![None; bundles.n_bundles()];
            for (k, image) in images.into_iter().enumerate() {
                alike.join(k, image);
                symmetry[chosen[k]] = Some(chosen[image]);
            }
            symmetries.push(symmetry);
        }

        // Number the orbits in the order of their least members.
        let mut members: Vec<Vec<usize>> = Vec::new();
        let mut orbit_of = vec![None; bundles.n_bundles()];
        for (k, &bundle) in chosen.iter().enumerate() {
            let first = alike.least(k);
            let orbit = orbit_of[chosen[first]].unwrap_or(members.len());
            if orbit == members.len() {
                members.push(Vec::new());
            }
            orbit_of[bundle] = Some(orbit);
            members[orbit].push(bundle);
        }
        Self { members, orbit_of, symmetries }
    }

    /// Number of orbits.
    pub fn n_orbits(&self) -> usize {
        self.members.len()
    }

    /// The bundles of an orbit, ascending.
    pub fn members(&self, orbit: usize) -> &[usize] {
        &self.members[orbit]
    }

    /// What a bundle sees of an orbit, one of each kind: symmetries that leave the bundle where it is carry members into members that
    /// exchange as much with it. Each with their number.
    pub fn seen_from(&self, bundle: usize, orbit: usize) -> Vec<(usize, usize)> {
        let members = &self.members[orbit];
        let mut alike = DisjointSets::new(members.len());
        for symmetry in self.symmetries.iter().filter(|symmetry| symmetry[bundle] == Some(bundle)) {
            for (k, member) in members.iter().enumerate() {
                let Some(image) = symmetry[*member].and_then(|image| members.binary_search(&image).ok()) else {
                    continue;
                };
                alike.join(k, image);
            }
        }
        let mut count = vec![0; members.len()];
        (0..members.len()).for_each(|k| count[alike.least(k)] += 1);
        (0..members.len()).filter(|k| count[*k] > 0).map(|k| (members[k], count[k])).collect()
    }

    /// The orbit of a bundle; `None` where its surface was left out.
    pub fn orbit_of(&self, bundle: usize) -> Option<usize> {
        self.orbit_of[bundle]
    }
}

/// The image of every polygon among polygons of the same kind; `None` if one has no image.
fn permutation(polygons: &[(usize, &Polygon)], isometry: &Affine3) -> Option<Vec<usize>> {
    let size = polygons.iter().flat_map(|(_, p)| p.vertices()).map(|v| v.length()).fold(f64::MIN_POSITIVE, f64::max);
    // Look images up by their centroids, rounded to cells far above the rounding; near a border in the cells of both sides.
    let (tolerance, cell) = (COINCIDENT * size, 1e4 * COINCIDENT * size);
    let key = |kind: usize, p: Vec3| (kind, (p / cell).floor().to_array().map(|x| x as i64));
    let mut index: HashMap<(usize, [i64; 3]), Vec<usize>> = HashMap::with_capacity(polygons.len());
    for (k, (kind, polygon)) in polygons.iter().enumerate() {
        index.entry(key(*kind, polygon.centroid())).or_default().push(k);
    }
    let image = |(kind, polygon): &(usize, &Polygon)| {
        let centre = isometry.transform_point3(polygon.centroid());
        let normal = isometry.transform_vector3(polygon.normal());
        let corners: Vec<Vec3> = polygon.vertices().iter().map(|v| isometry.transform_point3(*v)).collect();
        let is_image = |k: &usize| {
            let other = polygons[*k].1;
            other.vertices().len() == corners.len()
                && other.normal().dot(normal) > 0.0
                && corners.iter().all(|v| other.vertices().iter().any(|w| w.distance(*v) <= tolerance))
        };
        let mut keys = Vec::with_capacity(1);
        for step in 0..8 {
            let offset = Vec3::new(
                if step & 1 == 0 { -tolerance } else { tolerance },
                if step & 2 == 0 { -tolerance } else { tolerance },
                if step & 4 == 0 { -tolerance } else { tolerance },
            );
            let key = key(*kind, centre + offset);
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        keys.iter().filter_map(|key| index.get(key)).flatten().copied().find(is_image)
    };
    // A mirror turns the order of corners round, but fronts stay fronts: their normals are mirrored as vectors.
    polygons.iter().map(image).collect()
}
