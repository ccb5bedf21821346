//! Which patches can exchange anything, settled for whole clusters of them before any pair is looked at.
//!
//! The patches that lie in one plane and face one way are halved again and again into clusters, each inside a convex polygon of that plane.
//! What holds for the polygons of two clusters holds for all of their pairs: that one lies behind the other, that nothing can stand
//! between them, that one occluder cuts them off. Where none of this is known the larger cluster is halved, and only the occluders
//! not yet ruled out are looked at again.
//!
//! Source: Hanrahan, Salzman and Aupperle (1991), "A rapid hierarchical radiosity algorithm" (links between clusters); Haines and
//! Wallace (1991), "Shaft culling" (inherited candidates).

use super::End;
use crate::assembly::exchange::pair::{Half, in_front_of};
use crate::geometry::{Polygon, Shaft, Tracer, Vec3, convex_hull_in_plane};
use rayon::prelude::*;
use std::ops::Range;

/// Clusters of so many patches are not halved: their pairs are looked at one by one.
const LEAF: usize = 4;

/// Centroids closer than this along the extent of a cluster, relative to it, are in one row.
const ROW: f64 = 1e-6;

/// The clusters of a scene's patches, and how each sees the others.
pub struct Clusters {
    /// The first ends; the others are sinks.
    n_sources: usize,
    nodes: Vec<Node>,
    /// Patches, cluster by cluster.
    members: Vec<u32>,
    /// The leaf of every patch.
    leaf_of: Vec<u32>,
    /// Of every cluster, its partners.
    links: Vec<Vec<Link>>,
    /// What stands between linked clusters.
    views: Vec<View>,
    pub census: Census,
}

struct Node {
    polygon: Polygon,
    facet: usize,
    members: Range<usize>,
    parent: Option<u32>,
    halves: Option<[u32; 2]>,
}

/// A cluster that another one may exchange something with.
#[derive(Clone, Copy)]
struct Link {
    partner: u32,
    /// Number of the view.
    view: u32,
}

/// What the halves of two roots found out.
#[derive(Default)]
struct Found {
    links: Vec<(u32, u32, View)>,
    census: Census,
}

/// What stands between two clusters.
#[derive(Clone, Debug, PartialEq)]
pub enum View {
    /// Nothing; and each lies wholly in front of the other where `is_facing`.
    Clear { is_facing: bool },
    /// Perhaps these occluders.
    Open(Box<[u32]>),
}

impl View {
    /// What may stand between; `None` where nothing does.
    pub fn candidates(&self) -> Option<&[u32]> {
        match self {
            Self::Clear { .. } => None,
            Self::Open(candidates) => Some(candidates),
        }
    }
}

/// How many pairs of sources clusters settled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Census {
    /// Pairs of which one lies behind the other, or in its plane.
    pub n_averted: usize,
    pub n_hidden: usize,
    pub n_clear: usize,
    /// How many pairs of clusters were looked at for it.
    pub n_shafts: usize,
}

impl Census {
    fn add(&mut self, other: Self) {
        self.n_averted += other.n_averted;
        self.n_hidden += other.n_hidden;
        self.n_clear += other.n_clear;
        self.n_shafts += other.n_shafts;
    }
}

impl Clusters {
    /// Builds the clusters and links them, but not those that hold none of the first `n_sources` ends: sinks exchange nothing with
    /// each other. Cost O(n log n) for the clusters; the links grow with the length of the borders between light and shadow, not with n².
    pub fn new(ends: &[End], n_sources: usize, facets: &[&Polygon], occluders: &Tracer) -> Self {
        let mut clusters = Self {
            n_sources,
            nodes: Vec::new(),
            members: (0..ends.len() as u32).collect(),
            leaf_of: vec![0; ends.len()],
            links: Vec::new(),
            views: Vec::new(),
            census: Census::default(),
        };
        let roots = clusters.plant(ends, facets, occluders);

        // Link the halves of every two.
        let later = |k: usize| roots[k + 1..].iter().copied();
        let is_source = |root: u32| clusters.nodes[root as usize].members.start < n_sources;
        let sources = roots.iter().enumerate().filter(|(_, root)| is_source(**root));
        let pairs: Vec<(u32, u32)> = sources.flat_map(|(k, root)| later(k).map(move |b| (*root, b))).collect();
        let linked: Vec<Found> = pairs
            .into_par_iter()
            .with_max_len(1)
            .map(|(a, b)| {
                let mut found = Found::default();
                clusters.link(occluders, (a, b), None, &mut found);
                found
            })
            .collect();

        // Let both ends of every link know of it.
        clusters.links.resize_with(clusters.nodes.len(), Vec::new);
        for Found { links, census } in linked {
            clusters.census.add(census);
            for (a, b, view) in links {
                let view = clusters.number(view);
                for (one, partner) in [(a, b), (b, a)] {
                    clusters.links[one as usize].push(Link { partner, view });
                }
            }
        }
        clusters
    }

    /// Calls `visit(j, view)` for every later end j that patch i may exchange something with.
    pub fn for_each_partner(&self, i: usize, mut visit: impl FnMut(usize, &View)) {
        let mut node = Some(self.leaf_of[i]);
        while let Some(k) = node {
            for link in &self.links[k as usize] {
                let partner = &self.nodes[link.partner as usize];
                let later = self.members[partner.members.clone()].iter().filter(|j| **j as usize > i);
                later.for_each(|&j| visit(j as usize, &self.views[link.view as usize]));
            }
            node = self.nodes[k as usize].parent;
        }
    }

    /// Grows the clusters of all ends, sources and sinks apart, a root for every way that a plane faces; returns the roots, those of sources
    /// first.
    fn plant(&mut self, ends: &[End], facets: &[&Polygon], occluders: &Tracer) -> Vec<u32> {
        let kind = |(k, end): (usize, &End)| {
            let plane = occluders.plane_number(end.facet);
            (k >= self.n_sources, plane, end.polygon.normal().dot(facets[plane as usize].normal()) < 0.0)
        };
        let kinds: Vec<(bool, u32, bool)> = ends.iter().enumerate().map(kind).collect();
        self.members.sort_by_key(|k| kinds[*k as usize]);
        let mut roots = Vec::new();
        let mut start = 0;
        while start < ends.len() {
            let kind = kinds[self.members[start] as usize];
            let alike = |k: &&u32| kinds[**k as usize] == kind;
            let mut members = start..start + self.members[start..].iter().take_while(alike).count();
            // Two facets of a plane may be too far off it, by rounding, to be of one polygon.
            let hull = self.hull(ends, members.clone()).or_else(|| {
                let facet = ends[self.members[start] as usize].facet;
                let same = |k: &&u32| ends[**k as usize].facet == facet;
                members.end = start + self.members[members.clone()].iter().take_while(same).count();
                self.hull(ends, members.clone())
            });
            let polygon = hull.unwrap_or_else(|| {
                members.end = start + 1;
                ends[self.members[start] as usize].polygon.clone()
            });
            self.note_averted(ends, members.clone());
            start = members.end;
            roots.push(self.grow(ends, polygon, members, None));
        }
        roots
    }

    /// Pairs in one plane exchange nothing; those of one facet are not pairs.
    fn note_averted(&mut self, ends: &[End], members: Range<usize>) {
        if members.start >= self.n_sources {
            return;
        }
        let pairs = |n: usize| n * n.saturating_sub(1) / 2;
        let facets = self.members[members.clone()].chunk_by(|a, b| ends[*a as usize].facet == ends[*b as usize].facet);
        let within: usize = facets.map(|group| pairs(group.len())).sum();
        self.census.n_averted += pairs(members.len()) - within;
    }

    /// The number of a view: those of clear pairs are shared.
    fn number(&mut self, view: View) -> u32 {
        const SHARED: [View; 2] = [View::Clear { is_facing: false }, View::Clear { is_facing: true }];
        if self.views.is_empty() {
            self.views.extend(SHARED);
        }
        if let View::Clear { is_facing } = view {
            return u32::from(is_facing);
        }
        self.views.push(view);
        self.views.len() as u32 - 1
    }

    /// Makes the cluster of these members, and its halves; returns its number.
    fn grow(&mut self, ends: &[End], polygon: Polygon, members: Range<usize>, parent: Option<u32>) -> u32 {
        let number = self.nodes.len() as u32;
        let halves = if members.len() > LEAF { self.halve(ends, &polygon, members.clone()) } else { None };
        let facet = ends[self.members[members.start] as usize].facet;
        self.nodes.push(Node { polygon, facet, members: members.clone(), parent, halves: None });
        match halves {
            Some([(a, of_a), (b, of_b)]) => {
                let a = self.grow(ends, a, of_a, Some(number));
                let b = self.grow(ends, b, of_b, Some(number));
                self.nodes[number as usize].halves = Some([a, b]);
            }
            None => self.members[members].iter().for_each(|&end| self.leaf_of[end as usize] = number),
        }
        number
    }

    /// Parts the members near the middle of the polygon's longer extent, between rows of them where they stand in rows; `None` where a half
    /// has no polygon.
    fn halve(
        &mut self,
        ends: &[End],
        polygon: &Polygon,
        members: Range<usize>,
    ) -> Option<[(Polygon, Range<usize>); 2]> {
        let axis = longer_axis(polygon);
        let height = |end: u32| axis.dot(ends[end as usize].polygon.centroid() - polygon.centroid());
        let list = &mut self.members[members.clone()];
        list.sort_by(|a, b| height(*a).total_cmp(&height(*b)).then(a.cmp(b)));
        let (first, last) = (height(list[0]), height(list[list.len() - 1]));
        let is_row_end = |k: &usize| height(list[*k]) - height(list[k - 1]) > ROW * (last - first);
        let middle = list.len() / 2;
        let near = (list.len().div_ceil(4)..=list.len() - list.len().div_ceil(4)).filter(is_row_end);
        let middle = members.start + near.min_by_key(|k| k.abs_diff(middle)).unwrap_or(middle);
        let part = |range: Range<usize>| Some((self.hull(ends, range.clone())?, range));
        Some([part(members.start..middle)?, part(middle..members.end)?])
    }

    /// The convex hull of members of one plane.
    fn hull(&self, ends: &[End], members: Range<usize>) -> Option<Polygon> {
        let members = &self.members[members];
        let normal = ends[members[0] as usize].polygon.normal();
        let corners = members.iter().flat_map(|&m| ends[m as usize].polygon.vertices());
        Polygon::new(convex_hull_in_plane(corners.copied(), normal)).ok()
    }

    /// Links the clusters a and b, or their halves. `candidates` are the occluders not yet ruled out; `None` stands for all.
    fn link(&self, occluders: &Tracer, (a, b): (u32, u32), candidates: Option<&[u32]>, found: &mut Found) {
        let (one, other) = (&self.nodes[a as usize], &self.nodes[b as usize]);
        let n_pairs = one.members.len() * other.members.len();
        let Found { links, census } = found;
        let n_pairs = if one.members.end.max(other.members.end) > self.n_sources { 0 } else { n_pairs };
        if occluders.coplanar(one.facet, other.facet) {
            census.n_averted += n_pairs;
            return;
        }
        let sides =
            (in_front_of(one.polygon.vertices(), &other.polygon), in_front_of(other.polygon.vertices(), &one.polygon));
        if matches!(sides, (Half::Behind, _) | (_, Half::Behind)) {
            census.n_averted += n_pairs;
            return;
        }
        let is_facing = matches!(sides, (Half::InFront, Half::InFront));
        census.n_shafts += 1;
        let ends = [(&one.polygon, one.facet), (&other.polygon, other.facet)];
        let shaft = match candidates {
            None => Shaft::between(occluders, ends[0], ends[1]),
            Some(candidates) => Shaft::among(occluders, candidates, ends[0], ends[1]),
        };
        match shaft {
            Shaft::Blocked => census.n_hidden += n_pairs,
            Shaft::Clear => {
                census.n_clear += n_pairs;
                links.push((a, b, View::Clear { is_facing }));
            }
            Shaft::Undecided(handles) => match larger_halves(one, other) {
                Some((true, halves)) => {
                    halves.into_iter().for_each(|half| self.link(occluders, (half, b), Some(&handles), found));
                }
                Some((false, halves)) => {
                    halves.into_iter().for_each(|half| self.link(occluders, (a, half), Some(&handles), found));
                }
                None => links.push((a, b, View::Open(handles.into()))),
            },
        }
    }
}

/// The halves of the larger of the two that has any, and whether that is the first.
fn larger_halves(one: &Node, other: &Node) -> Option<(bool, [u32; 2])> {
    match (one.halves, other.halves) {
        (Some(halves), Some(_)) if one.polygon.area() >= other.polygon.area() => Some((true, halves)),
        (_, Some(halves)) => Some((false, halves)),
        (Some(halves), None) => Some((true, halves)),
        (None, None) => None,
    }
}

/// Of the direction of the longest edge and the one across it, that in which the polygon extends further.
fn longer_axis(polygon: &Polygon) -> Vec3 {
    let v = polygon.vertices();
    let edges = (0..v.len()).map(|k| v[(k + 1) % v.len()] - v[k]);
    let along = edges.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(Vec3::X).normalize();
    let across = polygon.normal().cross(along);
    let extent = |axis: Vec3| {
        let heights = v.iter().map(|p| axis.dot(*p - v[0]));
        let (low, high) = heights.fold((0.0f64, 0.0f64), |(low, high), h| (low.min(h), high.max(h)));
        high - low
    };
    // A tie goes to the edge, not to rounding.
    if extent(across) > (1.0 + 1e-9) * extent(along) { across } else { along }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{Bundles, Resolution};
    use crate::gallery;
    use crate::geometry::Mat3;
    use crate::sampling::Kronecker;

    /// What clusters say of a pair: nothing of it was linked, it is clear, or it is open.
    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Said {
        Nothing,
        Clear,
        Open,
    }

    /// Rays hunt for a clear pair with a hidden part, and for an unlinked one that sees something.
    #[test]
    fn no_ray_contradicts_a_cluster() {
        let of_gallery = |name: &str| (gallery::find(name).expect("a scene of the gallery").build)();
        for (name, patch_size, scene) in [
            ("corner-box", 0.25, of_gallery("corner-box")),
            ("two-rooms", 0.7, of_gallery("two-rooms")),
            ("cornell-box", 0.4, of_gallery("cornell-box")),
            ("spherical-crater", 10.0, of_gallery("spherical-crater")),
            ("a facet a patch", 10.0, gallery::floating_block(6).expect("a scene")),
        ] {
            let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
            for turn in [Mat3::IDENTITY, Mat3::from_rotation_x(0.3) * Mat3::from_rotation_z(1.1)] {
                let turned =
                    |p: &Polygon| Polygon::new(p.vertices().iter().map(|v| turn * *v).collect()).expect("turned");
                let facets: Vec<Polygon> = (0..scene.facets().len()).map(|f| turned(scene.polygon(f))).collect();
                let facets: Vec<&Polygon> = facets.iter().collect();
                let patches: Vec<_> = (0..bundles.elements().len()).filter_map(|e| bundles.patch(e)).collect();
                let polygons: Vec<Polygon> = patches.iter().map(|p| turned(&p.polygon)).collect();
                let ends: Vec<End> = polygons.iter().zip(&patches).map(|(p, patch)| End::new(p, patch.facet)).collect();
                let occluders = Tracer::occluders(&facets);
                let clusters = Clusters::new(&ends, ends.len(), &facets, &occluders);
                check(name, &clusters, &ends, &occluders);
            }
        }
    }

    fn check(name: &str, clusters: &Clusters, ends: &[End], occluders: &Tracer) {
        let n = ends.len();
        let is_same_side = |i: usize, j: usize| {
            ends[i].facet == ends[j].facet && ends[i].polygon.normal().dot(ends[j].polygon.normal()) > 0.0
        };
        let points = Kronecker::<4>::new(0x636c_7573);
        let mut n_settled = 0;
        for i in 0..n {
            let mut said = vec![Said::Nothing; n];
            clusters.for_each_partner(i, |j, view| {
                assert_eq!(said[j], Said::Nothing, "{name}: {i} and {j} are linked twice");
                said[j] = if matches!(view, View::Open(_)) { Said::Open } else { Said::Clear };
                if *view == (View::Clear { is_facing: true }) {
                    let [a, b] = [ends[i].polygon, ends[j].polygon];
                    let sides = (in_front_of(a.vertices(), b), in_front_of(b.vertices(), a));
                    assert_eq!(sides, (Half::InFront, Half::InFront), "{name}: {i} and {j}");
                }
            });
            for j in i + 1..n {
                // Pairs of one facet are nobody's.
                n_settled += usize::from(said[j] != Said::Open && !is_same_side(i, j));
                for k in 0..6 {
                    let [u0, u1, u2, u3] = points.point(6 * (n * i + j) + k);
                    let (x, y) = (ends[i].polygon.sample([u0, u1]), ends[j].polygon.sample([u2, u3]));
                    let d = (y - x).normalize_or_zero();
                    // Grazing rays are left to rounding.
                    let is_facing = d.dot(ends[i].polygon.normal()) > 1e-9 && d.dot(ends[j].polygon.normal()) < -1e-9;
                    let sees = is_facing && !occluders.occluded(x, y, [ends[i].facet, ends[j].facet]);
                    match said[j] {
                        Said::Nothing => assert!(!sees, "{name}: {i} sees {j} unlinked"),
                        Said::Clear => assert!(sees || !is_facing, "{name}: {i} and {j} are not clear"),
                        Said::Open => {}
                    }
                }
            }
        }
        let census = clusters.census;
        assert_eq!(census.n_averted + census.n_hidden + census.n_clear, n_settled, "{name}");
    }
}
