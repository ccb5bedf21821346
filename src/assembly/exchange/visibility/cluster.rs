//! Which patches can exchange anything, settled for whole clusters of them before any pair is looked at.
//!
//! The patches of one side of a facet are halved again and again into clusters, each inside a convex polygon of the facet's plane.
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

/// The clusters of a scene's patches, and how each sees the others.
pub struct Clusters {
    /// The first ends; the others are sinks.
    n_sources: usize,
    nodes: Vec<Node>,
    /// Patches, cluster by cluster.
    members: Vec<u32>,
    /// The leaf of every patch.
    leaf_of: Vec<u32>,
    /// Of every cluster, its partners among the clusters of later facets.
    links: Vec<Vec<Link>>,
    pub census: Census,
}

struct Node {
    polygon: Polygon,
    facet: usize,
    members: Range<usize>,
    parent: Option<u32>,
    halves: Option<[u32; 2]>,
}

/// Two clusters that may exchange something.
struct Link {
    partner: u32,
    view: View,
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

impl Clusters {
    /// Builds the clusters and links them, but not those that hold none of the first `n_sources` ends: sinks exchange nothing with
    /// each other. Ends come facet by facet, side by side, as [`Bundles`](crate::basis::Bundles) number them. Cost O(n log n) for
    /// the clusters; the links grow with the length of the borders between light and shadow, not with n².
    pub fn new(ends: &[End], n_sources: usize, facets: &[&Polygon], occluders: &Tracer) -> Self {
        let mut clusters = Self {
            n_sources,
            nodes: Vec::new(),
            members: (0..ends.len() as u32).collect(),
            leaf_of: vec![0; ends.len()],
            links: Vec::new(),
            census: Census::default(),
        };

        // Halve every side of every facet.
        let mut roots = Vec::new();
        let mut start = 0;
        let is_same_side = |a: &End, b: &End| a.facet == b.facet && a.polygon.normal().dot(b.polygon.normal()) > 0.0;
        for group in ends.chunk_by(is_same_side) {
            let facet = facets[group[0].facet];
            let is_front = group[0].polygon.normal().dot(facet.normal()) > 0.0;
            let polygon = if is_front { facet.clone() } else { facet.flipped() };
            let root = clusters.grow(ends, polygon, group[0].facet, start..start + group.len(), None);
            roots.push((root, start < n_sources));
            start += group.len();
        }

        // Link the halves of every two.
        let later = |k: usize| roots[k + 1..].iter().map(|(root, _)| *root);
        let sources = roots.iter().enumerate().filter(|(_, (_, is_source))| *is_source);
        let pairs: Vec<(u32, u32)> = sources.flat_map(|(k, (root, _))| later(k).map(move |b| (*root, b))).collect();
        let linked: Vec<(Vec<(u32, Link)>, Census)> = pairs
            .into_par_iter()
            .with_max_len(1)
            .map(|(a, b)| {
                let mut found = (Vec::new(), Census::default());
                clusters.link(occluders, (a, b), None, &mut found);
                found
            })
            .collect();
        clusters.links.resize_with(clusters.nodes.len(), Vec::new);
        for (links, census) in linked {
            clusters.census.n_averted += census.n_averted;
            clusters.census.n_hidden += census.n_hidden;
            clusters.census.n_clear += census.n_clear;
            clusters.census.n_shafts += census.n_shafts;
            links.into_iter().for_each(|(node, link)| clusters.links[node as usize].push(link));
        }
        clusters
    }

    /// Calls `visit(j, view)` for every patch j of a later facet that patch i may exchange something with.
    pub fn for_each_partner(&self, i: usize, mut visit: impl FnMut(usize, &View)) {
        let mut node = Some(self.leaf_of[i]);
        while let Some(k) = node {
            for link in &self.links[k as usize] {
                let partner = &self.nodes[link.partner as usize];
                self.members[partner.members.clone()].iter().for_each(|&j| visit(j as usize, &link.view));
            }
            node = self.nodes[k as usize].parent;
        }
    }

    /// Makes the cluster of these members, and its halves; returns its number.
    fn grow(
        &mut self,
        ends: &[End],
        polygon: Polygon,
        facet: usize,
        members: Range<usize>,
        parent: Option<u32>,
    ) -> u32 {
        let number = self.nodes.len() as u32;
        let halves = if members.len() > LEAF { self.halve(ends, &polygon, members.clone()) } else { None };
        self.nodes.push(Node { polygon, facet, members: members.clone(), parent, halves: None });
        match halves {
            Some([(a, of_a), (b, of_b)]) => {
                let a = self.grow(ends, a, facet, of_a, Some(number));
                let b = self.grow(ends, b, facet, of_b, Some(number));
                self.nodes[number as usize].halves = Some([a, b]);
            }
            None => self.members[members].iter().for_each(|&end| self.leaf_of[end as usize] = number),
        }
        number
    }

    /// Parts the members in the middle of the polygon's longer extent; `None` where a half has no polygon.
    fn halve(
        &mut self,
        ends: &[End],
        polygon: &Polygon,
        members: Range<usize>,
    ) -> Option<[(Polygon, Range<usize>); 2]> {
        let axis = longer_axis(polygon);
        let height = |end: u32| axis.dot(ends[end as usize].polygon.centroid() - polygon.centroid());
        self.members[members.clone()].sort_by(|a, b| height(*a).total_cmp(&height(*b)).then(a.cmp(b)));
        let hull = |range: Range<usize>| {
            let corners = self.members[range.clone()].iter().flat_map(|&m| ends[m as usize].polygon.vertices());
            Some((Polygon::new(convex_hull_in_plane(corners.copied(), polygon.normal())).ok()?, range))
        };
        let middle = members.start + members.len() / 2;
        Some([hull(members.start..middle)?, hull(middle..members.end)?])
    }

    /// Links the clusters a and b, or their halves. `candidates` are the occluders not yet ruled out; `None` stands for all.
    fn link(
        &self,
        occluders: &Tracer,
        (a, b): (u32, u32),
        candidates: Option<&[u32]>,
        found: &mut (Vec<(u32, Link)>, Census),
    ) {
        let (one, other) = (&self.nodes[a as usize], &self.nodes[b as usize]);
        let n_pairs = one.members.len() * other.members.len();
        let (links, census) = found;
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
                links.push((a, Link { partner: b, view: View::Clear { is_facing } }));
            }
            Shaft::Undecided(handles) => match larger_halves(one, other) {
                Some((true, halves)) => {
                    halves.into_iter().for_each(|half| self.link(occluders, (half, b), Some(&handles), found));
                }
                Some((false, halves)) => {
                    halves.into_iter().for_each(|half| self.link(occluders, (a, half), Some(&handles), found));
                }
                None => links.push((a, Link { partner: b, view: View::Open(handles.into()) })),
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
        for (name, patch_size) in
            [("corner-box", 0.25), ("two-rooms", 0.7), ("cornell-box", 0.4), ("spherical-crater", 10.0)]
        {
            let scene = (gallery::find(name).expect("a scene of the gallery").build)();
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
                n_settled += usize::from(said[j] != Said::Open);
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
        assert_eq!(census.n_averted + census.n_hidden + census.n_clear, n_settled - same_side_pairs(ends), "{name}");
    }

    /// Pairs within one side of a facet are nobody's.
    fn same_side_pairs(ends: &[End]) -> usize {
        let is_same_side = |a: &End, b: &End| a.facet == b.facet && a.polygon.normal().dot(b.polygon.normal()) > 0.0;
        ends.chunk_by(is_same_side).map(|group| group.len() * (group.len() - 1) / 2).sum()
    }
}
