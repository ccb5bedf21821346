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

use super::translates::Translates;
use crate::basis::{Bundles, Patch};
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
    translates: Translates,
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
        let (facet_places, patch_places) = (Places::new(&facets), Places::new(&patches));
        let mut alike = DisjointSets::new(chosen.len());
        let mut symmetries = Vec::new();
        for candidate in candidates {
            let images = permutation(&facet_places, candidate).and_then(|_| permutation(&patch_places, candidate));
            let Some(images) = images else { continue };
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
        Self { members, orbit_of, symmetries, translates: Translates::default() }
    }

    /// The same, knowing that patches stand in rows along these steps: what passes between two that nothing stands between is then computed
    /// for one of all pairs that differ by steps. Cost O(n) a step.
    pub fn in_rows(self, scene: &Scene, bundles: &Bundles, steps: &[Vec3]) -> Self {
        let patches = (0..bundles.n_bundles()).map(|bundle| bundles.patch(bundles.element_of(bundle).0));
        let kind = |patch: &Patch| 2 * scene.facets()[patch.facet].surface + patch.side as usize;
        let patches: Option<Vec<(usize, &Polygon)>> =
            patches.map(|patch| patch.map(|patch| (kind(patch), &patch.polygon))).collect();
        Self { translates: patches.map_or(Translates::default(), |patches| Translates::new(&patches, steps)), ..self }
    }

    /// The rows that patches stand in.
    pub(super) fn translates(&self) -> &Translates {
        &self.translates
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
        let stays = |symmetry: &&Vec<Option<usize>>| symmetry[bundle] == Some(bundle);
        if !self.symmetries.iter().any(|symmetry| stays(&symmetry)) {
            return members.iter().map(|member| (*member, 1)).collect();
        }
        let mut alike = DisjointSets::new(members.len());
        for symmetry in self.symmetries.iter().filter(stays) {
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

/// Where polygons are: looked up by their centroids, rounded to cells far above the rounding.
pub(super) struct Places<'a> {
    polygons: &'a [(usize, &'a Polygon)],
    tolerance: f64,
    index: HashMap<(usize, [i64; 3]), Vec<usize>>,
}

impl<'a> Places<'a> {
    /// Polygons, each of a kind.
    pub fn new(polygons: &'a [(usize, &'a Polygon)]) -> Self {
        let corners = polygons.iter().flat_map(|(_, polygon)| polygon.vertices());
        let size = corners.map(|v| v.length()).fold(f64::MIN_POSITIVE, f64::max);
        let mut places = Self { polygons, tolerance: COINCIDENT * size, index: HashMap::with_capacity(polygons.len()) };
        for (k, (kind, polygon)) in polygons.iter().enumerate() {
            let key = places.key(*kind, polygon.centroid());
            places.index.entry(key).or_default().push(k);
        }
        places
    }

    fn key(&self, kind: usize, p: Vec3) -> (usize, [i64; 3]) {
        (kind, (p / (1e4 * self.tolerance)).floor().to_array().map(|x| x as i64))
    }

    /// The polygon of the same kind that an isometry carries this one into.
    ///
    /// A mirror turns the order of corners round, but fronts stay fronts: their normals are mirrored as vectors.
    pub fn image(&self, (kind, polygon): (usize, &Polygon), isometry: &Affine3) -> Option<usize> {
        let centre = isometry.transform_point3(polygon.centroid());
        let normal = isometry.transform_vector3(polygon.normal());
        let corners: Vec<Vec3> = polygon.vertices().iter().map(|v| isometry.transform_point3(*v)).collect();
        let is_image = |k: &usize| {
            let other = self.polygons[*k].1;
            other.vertices().len() == corners.len()
                && other.normal().dot(normal) > 0.0
                && corners.iter().all(|v| other.vertices().iter().any(|w| w.distance(*v) <= self.tolerance))
        };
        // Near a border between cells, look on both sides.
        let mut keys = Vec::with_capacity(1);
        for step in 0..8 {
            let shift = |axis: usize| if step >> axis & 1 == 0 { -self.tolerance } else { self.tolerance };
            let key = self.key(kind, centre + Vec3::new(shift(0), shift(1), shift(2)));
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        keys.iter().filter_map(|key| self.index.get(key)).flatten().copied().find(is_image)
    }
}

/// The image of every polygon among polygons of the same kind; `None` if one has no image.
fn permutation(places: &Places, isometry: &Affine3) -> Option<Vec<usize>> {
    places.polygons.iter().map(|polygon| places.image(*polygon, isometry)).collect()
}
