//! Which patches can exchange anything, settled for whole clusters of them before any pair is looked at.
//!
//! The patches of one side of a facet are halved again and again into clusters, each inside a convex polygon of the facet's plane.
//! What holds for the polygons of two clusters holds for all of their pairs: that one lies behind the other, that nothing can stand
//! between them, that one occluder cuts them off. Where none of this is known the larger cluster is halved, and only the occluders
//! not yet ruled out are looked at again.
//!
//! Source: Hanrahan, Salzman and Aupperle (1991), "A rapid hierarchical radiosity algorithm" (links between clusters); Haines and
//! Wallace (1991), "Shaft culling" (inherited candidates).

use super::clip::{Half, in_front_of};
use crate::basis::Patch;
use crate::geometry::{Polygon, Shaft, Tracer, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Clusters of so many patches are not halved: their pairs are looked at one by one.
const LEAF: usize = 4;

/// The clusters of a scene's patches, and how each sees the others.
pub struct Clusters {
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

/// How many pairs clusters settled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Census {
    /// Pairs of which one lies behind the other, or in its plane.
    pub n_averted: usize,
    pub n_hidden: usize,
    pub n_clear: usize,
}

impl Clusters {
    /// Builds the clusters and links them. Patches come facet by facet, side by side, as [`Bundles`](crate::basis::Bundles) number
    /// them. Cost O(n log n) for the clusters; the links grow with the length of the borders between light and shadow, not with n².
    pub fn new(patches: &[&Patch], facets: &[&Polygon], occluders: &Tracer) -> Self {
        let mut clusters = Self {
            nodes: Vec::new(),
            members: (0..patches.len() as u32).collect(),
            leaf_of: vec![0; patches.len()],
            links: Vec::new(),
            census: Census::default(),
        };

        // Halve every side of every facet.
        let mut roots = Vec::new();
        let mut start = 0;
        for group in patches.chunk_by(|a, b| a.facet == b.facet && a.side == b.side) {
            let facet = facets[group[0].facet];
            let polygon = if group[0].polygon.normal().dot(facet.normal()) > 0.0 { facet.clone() } else { facet.flipped() };
            roots.push(clusters.grow(patches, polygon, group[0].facet, start..start + group.len(), None));
            start += group.len();
        }

        // Link the halves of every two.
        let pairs: Vec<(u32, u32)> =
            roots.iter().enumerate().flat_map(|(k, &a)| roots[k + 1..].iter().map(move |&b| (a, b))).collect();
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
        patches: &[&Patch],
        polygon: Polygon,
        facet: usize,
        members: Range<usize>,
        parent: Option<u32>,
    ) -> u32 {
        let number = self.nodes.len() as u32;
        let halves = if members.len() > LEAF { self.halve(patches, &polygon, members.clone()) } else { None };
        self.nodes.push(Node { polygon, facet, members: members.clone(), parent, halves: None });
        match halves {
            Some([(a, of_a), (b, of_b)]) => {
                let a = self.grow(patches, a, facet, of_a, Some(number));
                let b = self.grow(patches, b, facet, of_b, Some(number));
                self.nodes[number as usize].halves = Some([a, b]);
            }
            None => self.members[members].iter().for_each(|&patch| self.leaf_of[patch as usize] = number),
        }
        number
    }

    /// Parts the members in the middle of the polygon's longer extent; `None` where a half has no polygon.
    fn halve(
        &mut self,
        patches: &[&Patch],
        polygon: &Polygon,
        members: Range<usize>,
    ) -> Option<[(Polygon, Range<usize>); 2]> {
        let axis = longer_axis(polygon);
        let height = |patch: u32| axis.dot(patches[patch as usize].polygon.centroid() - polygon.centroid());
        self.members[members.clone()].sort_by(|a, b| height(*a).total_cmp(&height(*b)).then(a.cmp(b)));
        let hull = |range: Range<usize>| {
            let corners = self.members[range.clone()].iter().flat_map(|&m| patches[m as usize].polygon.vertices());
            Some((Polygon::new(convex_hull(corners.copied(), polygon)).ok()?, range))
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
        match Shaft::among(occluders, candidates, (&one.polygon, one.facet), (&other.polygon, other.facet)) {
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

/// Corners of the convex hull of points in the plane of `plane`, counter-clockwise (Andrew 1979, the monotone chain), on a grid of
/// 2⁵⁰ steps across the points, so that every orientation is exact.
fn convex_hull(points: impl Iterator<Item = Vec3> + Clone, plane: &Polygon) -> Vec<Vec3> {
    let origin = plane.centroid();
    let (right, up) = plane.normal().any_orthonormal_pair();
    let reach = points.clone().map(|p| (p - origin).abs().max_element()).fold(f64::MIN_POSITIVE, f64::max);
    let step = |x: f64| (x / reach * (1u64 << 49) as f64) as i64;
    let mut sorted: Vec<(i64, i64, Vec3)> =
        points.map(|p| (step(right.dot(p - origin)), step(up.dot(p - origin)), p)).collect();
    sorted.sort_by_key(|(x, y, _)| (*x, *y));
    sorted.dedup_by_key(|(x, y, _)| (*x, *y));
    let turns_left = |a: &(i64, i64, Vec3), b: &(i64, i64, Vec3), c: &(i64, i64, Vec3)| {
        i128::from(b.0 - a.0) * i128::from(c.1 - b.1) > i128::from(b.1 - a.1) * i128::from(c.0 - b.0)
    };
    let chain = |points: &mut dyn Iterator<Item = &(i64, i64, Vec3)>| {
        let mut chain: Vec<(i64, i64, Vec3)> = Vec::new();
        for point in points {
            while chain.len() >= 2 && !turns_left(&chain[chain.len() - 2], &chain[chain.len() - 1], point) {
                chain.pop();
            }
            chain.push(*point);
        }
        chain.pop();
        chain
    };
    let (lower, upper) = (chain(&mut sorted.iter()), chain(&mut sorted.iter().rev()));
    lower.into_iter().chain(upper).map(|(_, _, p)| p).collect()
}
