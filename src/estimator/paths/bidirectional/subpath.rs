//! The two halves of a path, vertex by vertex, with the density of each vertex from either side.

use super::super::super::bands::Bands;
use super::super::Roulette;
use super::super::reflection::{Reflection, Turn};
use super::super::stage::{Stage, Vertex};
use crate::basis::Patch;
use crate::geometry::{Frame, Vec3};
use crate::sampling::{Stream, warp};
use crate::scene::Side;
use std::f64::consts::PI;

/// A vertex of a path from the bundle or from the light. "Before" is towards the end that the path started from, "behind" the other way.
#[derive(Clone)]
pub(super) struct Node<'a> {
    pub facet: usize,
    pub side: Side,
    pub position: Vec3,
    pub frame: &'a Frame,
    pub turning: Turning<'a>,
    /// What the path carries up to here: the product of f cosθ / density of all vertices before, and at a light E over its density.
    pub throughput: Bands,
    /// By area, m⁻², given the vertices before. That of a bundle's first vertex is the same for all strategies, and left at 1.
    pub forward: f64,
    /// By area, m⁻², had the path come from the other end through the vertices behind. Known once there are two; until then 0.
    pub reverse: f64,
    /// cosθ/r²: from a density of directions here to one of points at the vertex before; 0 at the first.
    pub back: f64,
}

/// How light turns at a vertex.
#[derive(Clone, Copy)]
pub(super) enum Turning<'a> {
    /// It starts here, with density cosθ/π.
    Emission,
    /// It has come from, or goes on to, the vertex before: local, unit length.
    Reflection { reflection: &'a Reflection<'a>, given: Vec3 },
}

impl<'a> Node<'a> {
    fn reflecting(vertex: &Vertex<'a>, throughput: Bands, forward: f64, back: f64) -> Self {
        let Vertex { facet, side, position, frame, reflection, given } = *vertex;
        let turning = Turning::Reflection { reflection, given };
        Self { facet, side, position, frame, turning, throughput, forward, reverse: 0.0, back }
    }

    /// True where no other strategy can place a neighbour of this vertex.
    pub fn is_delta(&self) -> bool {
        match self.turning {
            Turning::Emission => false,
            Turning::Reflection { reflection, .. } => reflection.is_delta(),
        }
    }

    /// Density by solid angle of going on in this direction, local.
    pub fn density(&self, direction: Vec3) -> f64 {
        match self.turning {
            Turning::Emission => warp::cosine_hemisphere_pdf(direction.to_array()),
            Turning::Reflection { reflection, given } => reflection.density(given, direction),
        }
    }

    /// Density by area of the vertex before, had light come from this direction, local, the other way.
    pub fn density_back(&self, direction: Vec3) -> f64 {
        match self.turning {
            Turning::Emission => 0.0,
            Turning::Reflection { reflection, given } => reflection.density(direction, given) * self.back,
        }
    }

    /// values ← values · f · scale towards this direction, local; light that starts here is already in the throughput.
    pub fn scale(&self, direction: Vec3, scale: f64, values: &mut [f64]) {
        match self.turning {
            Turning::Emission => {
                let scale = if direction.z > 0.0 { scale } else { 0.0 };
                values.iter_mut().for_each(|value| *value *= scale);
            }
            Turning::Reflection { reflection, given } => reflection.scale(given, direction, scale, values),
        }
    }
}

/// Makes paths.
#[derive(Clone, Copy)]
pub(super) struct Walker<'s, 'a> {
    pub stage: &'s Stage<'a>,
    pub roulette: Roulette,
    pub n_bands: usize,
}

impl<'s> Walker<'s, '_> {
    /// A path that starts in the étendue of a bundle, of at most so many vertices, and how many rays it took.
    pub fn of_bundle(self, patch: &Patch, most: usize, stream: &mut Stream) -> (Vec<Node<'s>>, u64) {
        let Some(vertex) = self.stage.leave(patch, stream).filter(|_| most > 0) else { return (Vec::new(), 0) };
        let mut path = vec![Node::reflecting(&vertex, Bands::all(1.0, self.n_bands), 1.0, 0.0)];
        let n_rays = self.extend(most, stream, &mut path);
        (path, n_rays)
    }

    /// A path that starts on an emitter, of at most so many vertices, and how many rays it took.
    pub fn of_light(self, most: usize, stream: &mut Stream) -> (Vec<Node<'s>>, u64) {
        if most == 0 {
            return (Vec::new(), 0);
        }
        let (emitter, position) = self.stage.emitters.point(stream);
        let mut throughput = Bands::all(1.0 / emitter.density, self.n_bands);
        throughput.iter_mut().zip(emitter.emission).for_each(|(carried, emission)| *carried *= emission);
        let mut path = vec![Node {
            facet: emitter.facet,
            side: Side::Front,
            position,
            frame: &self.stage.face(emitter.facet, Side::Front).frame,
            turning: Turning::Emission,
            throughput,
            forward: emitter.density,
            reverse: 0.0,
            back: 0.0,
        }];
        let n_rays = self.extend(most, stream, &mut path);
        (path, n_rays)
    }

    /// Lets a path go on until it escapes, is absorbed, or has so many vertices. Returns how many rays it took.
    fn extend(self, most: usize, stream: &mut Stream, path: &mut Vec<Node<'s>>) -> u64 {
        let mut n_rays = 0;
        let mut sent = path.last().map_or(0.0, |first| first.throughput.max());
        while let Some(here) = path.last().filter(|_| path.len() < most) {
            // Draw a direction; what is reflected survives or not.
            let mut throughput = here.throughput.clone();
            let [u, v, fate] = stream.uniform3();
            let turn = match here.turning {
                Turning::Emission => {
                    let direction = warp::cosine_hemisphere([u, v]);
                    throughput.iter_mut().for_each(|carried| *carried *= PI);
                    sent *= PI;
                    Turn { direction: direction.into(), density: warp::cosine_hemisphere_pdf(direction) }
                }
                Turning::Reflection { reflection, given } => {
                    let turn = reflection.turn(given, [u, v], &mut throughput);
                    let survival = self.roulette.survival(path.len(), throughput.max() / sent);
                    let Some(turn) = turn.filter(|_| fate < survival) else { break };
                    throughput.iter_mut().for_each(|carried| *carried /= survival);
                    turn
                }
            };

            // Go there, and tell the vertex before how likely it was the other way.
            let reverse = here.density_back(turn.direction);
            let direction = here.frame.to_world(turn.direction);
            n_rays += 1;
            let Some(arrival) = self.stage.follow(here.facet, here.position, direction) else { break };
            let distance_squared = arrival.distance * arrival.distance;
            let forward = turn.density * arrival.given.z / distance_squared;
            let back = turn.direction.z / distance_squared;
            let Some(vertex) = self.stage.vertex(&arrival) else { break };
            if let [.., before, _] = &mut path[..] {
                before.reverse = reverse;
            }
            path.push(Node::reflecting(&vertex, throughput, forward, back));
        }
        n_rays
    }
}
