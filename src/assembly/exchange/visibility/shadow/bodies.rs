//! The facets of a scene joined into convex bodies.

use super::body::{Body, Plane, Rim};
use crate::geometry::{DisjointSets, Polygon, Tracer, Vec3, height};
use std::collections::HashMap;

/// Solids of more facets are left in pieces: proving one convex costs facets times corners.
const LARGEST: usize = 16_384;

/// All obstacles of a scene: every polygon of the tracer belongs to one body, and is one by itself.
pub struct Bodies {
    /// Flat ones, by the handles of their polygons; then those of several.
    bodies: Vec<Body>,
    /// Body of every handle of the tracer.
    body_of: Vec<u32>,
    /// The face of its body that every handle is part of.
    face_of: Vec<u32>,
}

impl Bodies {
    /// Joins facets that share an edge, corner for corner, and bend away from their fronts there, as far as what results is convex
    /// and at most open on one side. Cost O(n log n) for scenes of bodies of bounded size.
    pub fn new(tracer: &Tracer, polygons: &[&Polygon]) -> Self {
        let handles = 0..tracer.n_polygons() as u32;
        let mut bodies: Vec<Body> = handles
            .clone()
            .map(|handle| {
                let corners = || tracer.corners_of(handle).to_vec();
                let whole = || Body::new(Vec::new(), Vec::new(), corners(), None);
                Body::flat(corners(), tracer.normal_of(handle)).unwrap_or_else(whole)
            })
            .collect();
        let mut part_of: Vec<Option<(u32, u32)>> = vec![None; polygons.len()];
        for Joined { members, body } in Joints::of(polygons).bodies() {
            for (facet, face) in members {
                part_of[facet] = Some((bodies.len() as u32, face));
            }
            bodies.push(body);
        }
        let part_of = |handle: u32| part_of[tracer.polygon_of(handle)].unwrap_or((handle, 0));
        let (body_of, face_of) = handles.map(part_of).unzip();
        Self { bodies, body_of, face_of }
    }

    /// The body that the polygon with this handle belongs to.
    pub fn body_of(&self, handle: u32) -> u32 {
        self.body_of[handle as usize]
    }

    /// The body of this polygon alone.
    pub fn facet_of(&self, handle: u32) -> u32 {
        handle
    }

    /// The face of its body that this polygon is part of.
    pub fn face_of(&self, handle: u32) -> u32 {
        self.face_of[handle as usize]
    }

    pub fn get(&self, body: u32) -> &Body {
        &self.bodies[body as usize]
    }
}

/// An edge of a facet, and the facet on the other side of it.
struct Side {
    from: Vec3,
    to: Vec3,
    /// The neighbour, if there is one alone and the two bend away from their fronts or not at all.
    neighbour: Option<usize>,
}

/// A body of several facets.
struct Joined {
    /// Facets, each with its face.
    members: Vec<(usize, u32)>,
    body: Body,
}

/// How facets hang together.
struct Joints<'a> {
    polygons: &'a [&'a Polygon],
    sides: Vec<Vec<Side>>,
    /// Facets joined without bending share a number.
    flat: DisjointSets,
    /// Facets joined at all share a number.
    solid: DisjointSets,
    /// Heights that are rounding.
    grain: f64,
}

impl<'a> Joints<'a> {
    fn of(polygons: &'a [&'a Polygon]) -> Self {
        // Look up every edge run the other way.
        let grain = grain(polygons);
        let welded = weld(polygons, grain);
        let edges = |facet: usize| {
            let v: &[Vec3] = &welded[facet];
            (0..v.len()).map(move |k| (v[k], v[(k + 1) % v.len()]))
        };
        let mut run: HashMap<_, (usize, usize)> = HashMap::new();
        for facet in 0..polygons.len() {
            for (from, to) in edges(facet) {
                run.entry((bits(from), bits(to))).and_modify(|entry| entry.1 += 1).or_insert((facet, 1));
            }
        }
        let (mut flat, mut solid) = (DisjointSets::new(polygons.len()), DisjointSets::new(polygons.len()));
        let sides = polygons
            .iter()
            .enumerate()
            .map(|(facet, polygon)| {
                edges(facet)
                    .map(|(from, to)| {
                        let alone = run[&(bits(from), bits(to))].1 == 1;
                        let other = run.get(&(bits(to), bits(from))).filter(|(other, count)| {
                            alone && *count == 1 && *other != facet && bends_away(polygon, polygons[*other], grain)
                        });
                        if let Some((other, _)) = other {
                            solid.join(facet, *other);
                            if is_flat(polygon, polygons[*other], grain) {
                                flat.join(facet, *other);
                            }
                        }
                        Side { from, to, neighbour: other.map(|(other, _)| *other) }
                    })
                    .collect()
            })
            .collect();
        Self { polygons, sides, flat, solid, grain }
    }

    /// The bodies of more than one facet.
    fn bodies(mut self) -> Vec<Joined> {
        let n = self.polygons.len();
        let (solid, flat): (Vec<usize>, Vec<usize>) = (0..n).map(|i| (self.solid.least(i), self.flat.least(i))).unzip();
        let gather = |roots: &[usize], of: &[usize]| {
            let mut groups: HashMap<usize, Vec<usize>> = HashMap::new();
            of.iter().for_each(|&facet| groups.entry(roots[facet]).or_default().push(facet));
            let mut groups: Vec<Vec<usize>> = groups.into_values().filter(|group| group.len() > 1).collect();
            groups.sort();
            groups
        };
        let everything: Vec<usize> = (0..n).collect();
        let mut found = Vec::new();
        for members in gather(&solid, &everything) {
            if let Some(solid) = self.solid_of(&members, &flat) {
                found.push(solid);
                continue;
            }
            // Settle for its faces, where they are cut into patches.
            for face in gather(&flat, &members) {
                if let Some(body) = self.face_of(&face) {
                    found.push(Joined { members: face.into_iter().map(|facet| (facet, 0)).collect(), body });
                }
            }
        }
        found
    }

    /// The polyhedron of these facets, if it is convex and closed, or closed by one more face.
    fn solid_of(&self, members: &[usize], flat: &[usize]) -> Option<Joined> {
        if members.len() > LARGEST {
            return None;
        }
        // Number the faces, and find the edges between them and the ends left open.
        let mut numbers: HashMap<usize, u32> = HashMap::new();
        let mut faces = Vec::new();
        for &facet in members {
            numbers.entry(flat[facet]).or_insert_with(|| {
                let polygon = self.polygons[facet];
                faces.push(Plane { normal: polygon.normal(), point: polygon.centroid() });
                faces.len() as u32 - 1
            });
        }
        if faces.len() < 2 {
            return None;
        }
        let (mut rims, mut open): (Vec<Rim>, Vec<Rim>) = (Vec::new(), Vec::new());
        for &facet in members {
            let face = numbers[&flat[facet]];
            for side in &self.sides[facet] {
                match side.neighbour.map(|other| numbers[&flat[other]]) {
                    None => open.push(Rim { from: side.from, to: side.to, faces: [face, faces.len() as u32] }),
                    Some(other) if other > face => {
                        rims.push(Rim { from: side.from, to: side.to, faces: [face, other] });
                    }
                    Some(_) => {}
                }
            }
        }
        let mut corners: Vec<Vec3> =
            members.iter().flat_map(|&facet| self.sides[facet].iter().map(|side| side.from)).collect();
        corners.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap_or(std::cmp::Ordering::Equal));
        corners.dedup();

        // Close one opening by a face; it runs the other way around.
        let opening = (!open.is_empty()).then_some(faces.len());
        if opening.is_some() {
            let outline: Vec<Vec3> = walk(&open)?.into_iter().rev().collect();
            let origin = outline[0];
            let twice: Vec3 = outline.windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin)).sum();
            let plane = Plane { normal: twice.try_normalize()?, point: origin };
            if outline.iter().any(|v| plane.height(*v).abs() > self.grain) {
                return None;
            }
            faces.push(plane);
            rims.extend(open);
        }
        if faces.iter().any(|face| corners.iter().any(|v| face.height(*v) > self.grain)) {
            return None;
        }
        let members = members.iter().map(|&facet| (facet, numbers[&flat[facet]])).collect();
        Some(Joined { members, body: Body::new(faces, straight(rims), corners, opening) })
    }

    /// The polygon that these coplanar facets make, if it is convex.
    fn face_of(&self, members: &[usize]) -> Option<Body> {
        let inside = |facet: &usize| members.contains(facet);
        let open: Vec<Rim> = members
            .iter()
            .flat_map(|&facet| &self.sides[facet])
            .filter(|side| !side.neighbour.as_ref().is_some_and(inside))
            .map(|side| Rim { from: side.from, to: side.to, faces: [0, 1] })
            .collect();
        let normal = self.polygons[members[0]].normal();
        let body = Body::flat(walk(&open)?, normal)?;
        let leans_in = |rim: &Rim| {
            let inward = normal.cross(rim.to - rim.from).normalize_or_zero();
            body.corners.iter().all(|v| height(inward, rim.from, *v) >= -self.grain)
        };
        body.rims.iter().all(leans_in).then_some(body)
    }
}

/// What rounding may do to coordinates: 64 ulp of the largest.
fn grain(polygons: &[&Polygon]) -> f64 {
    let corners = polygons.iter().flat_map(|p| p.vertices());
    64.0 * f64::EPSILON * corners.map(|v| v.abs().max_element()).fold(f64::MIN_POSITIVE, f64::max)
}

/// Corners of every polygon, those moved together that differ by rounding alone.
fn weld(polygons: &[&Polygon], grain: f64) -> Vec<Vec<Vec3>> {
    // Look for a known corner in the grid cell of this one and in those that rounding could have moved it to.
    let cell = |v: Vec3| (v / (4.0 * grain)).round().to_array().map(|x| x as i64);
    let mut known: HashMap<[i64; 3], Vec3> = HashMap::new();
    let mut place = |v: Vec3| {
        let sign = |octant: u32, axis: u32| if octant >> axis & 1 == 0 { grain } else { -grain };
        let reached = (0..8).map(|o| cell(v + Vec3::new(sign(o, 0), sign(o, 1), sign(o, 2))));
        let found = reached
            .filter_map(|cell| known.get(&cell))
            .find(|other| (**other - v).abs().max_element() <= grain)
            .copied();
        found.unwrap_or_else(|| {
            known.insert(cell(v), v);
            v
        })
    };
    polygons.iter().map(|p| p.vertices().iter().map(|v| place(*v)).collect()).collect()
}

/// The bits of a point's coordinates, of one zero.
fn bits(v: Vec3) -> [u64; 3] {
    v.to_array().map(|x| (x + 0.0).to_bits())
}

/// The one loop that these edges make, if they do.
fn walk(edges: &[Rim]) -> Option<Vec<Vec3>> {
    let next: HashMap<_, Vec3> = edges.iter().map(|edge| (bits(edge.from), edge.to)).collect();
    if next.len() != edges.len() {
        return None;
    }
    let start = edges.first()?.from;
    let mut outline = vec![start];
    loop {
        let to = *next.get(&bits(*outline.last()?))?;
        if to == start {
            break;
        }
        if outline.len() == edges.len() {
            return None;
        }
        outline.push(to);
    }
    (outline.len() == edges.len()).then_some(outline)
}

/// Two faces of a convex body share one straight edge: joins its parts.
fn straight(rims: Vec<Rim>) -> Vec<Rim> {
    let mut whole: HashMap<[u32; 2], Rim> = HashMap::new();
    for rim in rims {
        let key = [rim.faces[0].min(rim.faces[1]), rim.faces[0].max(rim.faces[1])];
        whole
            .entry(key)
            .and_modify(|known| {
                let along = known.to - known.from;
                if (rim.to - known.to).dot(along) > 0.0 {
                    known.to = rim.to;
                }
                if (rim.from - known.from).dot(along) < 0.0 {
                    known.from = rim.from;
                }
            })
            .or_insert(rim);
    }
    let mut rims: Vec<Rim> = whole.into_values().collect();
    rims.sort_by_key(|rim| rim.faces);
    rims
}

/// True if each facet lies behind the other's plane or in it.
fn bends_away(a: &Polygon, b: &Polygon, grain: f64) -> bool {
    let behind = |p: &Polygon, q: &Polygon| p.vertices().iter().all(|v| height(q.normal(), q.centroid(), *v) <= grain);
    behind(a, b) && behind(b, a)
}

/// True if the two facets lie in one plane and face the same way.
fn is_flat(a: &Polygon, b: &Polygon, grain: f64) -> bool {
    let within =
        |p: &Polygon, q: &Polygon| p.vertices().iter().all(|v| height(q.normal(), q.centroid(), *v).abs() <= grain);
    a.normal().dot(b.normal()) > 0.0 && within(a, b) && within(b, a)
}
