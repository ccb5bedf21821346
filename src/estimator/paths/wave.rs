//! Paths from one bundle that go step by step together.
//!
//! A path by itself is one long chain: each ray waits for the direction, which waits for the last hit. Many abreast keep the machine busy while
//! each of them waits. What a path draws and adds up is the same whoever is beside it.

use super::super::bounces::Columns;
use super::path_tracer::{PathTracer, Sampling};
use super::stage::{Arrival, Vertex};
use crate::geometry::Vec3;
use crate::sampling::Stream;
use crate::scene::Side;

/// Some paths of one start under way.
pub(super) struct Wave<'t, 'a> {
    tracer: &'t PathTracer<'a>,
    columns: Columns,
    /// Those that have not ended.
    paths: Vec<Path<'t>>,
    /// What path k still carries, k · n_bands ...
    throughput: Vec<f64>,
    /// What path k has found, k · n_columns ...
    totals: Vec<f64>,
    /// Emitters that may be seen, and what they would add, n_bands each.
    sights: Vec<Sight>,
    light: Vec<f64>,
    /// Closest hits and shadow rays so far.
    pub n_rays: u64,
}

/// A path that has not ended.
struct Path<'t> {
    number: usize,
    stream: Stream,
    vertex: Vertex<'t>,
    /// Where it goes next, and with which density by solid angle.
    direction: Vec3,
    density: f64,
}

/// A point on an emitter that a path may see.
struct Sight {
    number: usize,
    from: Vec3,
    to: Vec3,
    ends: [usize; 2],
}

impl<'t, 'a> Wave<'t, 'a> {
    pub fn new(tracer: &'t PathTracer<'a>, columns: Columns) -> Self {
        let (paths, sights) = (Vec::new(), Vec::new());
        Self {
            tracer,
            columns,
            paths,
            throughput: Vec::new(),
            totals: Vec::new(),
            sights,
            light: Vec::new(),
            n_rays: 0,
        }
    }

    /// Sends out a path with each of these streams, and follows them all to their ends. Returns what each has found, one number a column.
    pub fn run(&mut self, start: usize, streams: impl Iterator<Item = Stream>) -> impl Iterator<Item = &[f64]> {
        let n_columns = self.columns.count();
        self.leave(start, streams);
        for bounce in 1.. {
            let Some(here) = self.columns.of(bounce).filter(|_| !self.paths.is_empty()) else { break };
            if self.tracer.sampling != Sampling::Directions {
                self.draw_emitters();
                self.see_emitters(here.start);
            }
            if self.tracer.sampling == Sampling::Emitters && self.columns.ends_before(bounce + 1) {
                break;
            }
            self.turn(bounce);
            self.go(here.start);
        }
        self.totals.chunks_exact(n_columns)
    }

    /// Starts every path with what the bundle emits, anywhere in its étendue.
    fn leave(&mut self, start: usize, streams: impl Iterator<Item = Stream>) {
        let stage = &self.tracer.stage;
        let patch = stage.patches[start];
        let (n_columns, n_bands) = (self.columns.count(), self.columns.n_bands);
        self.paths.clear();
        self.totals.clear();
        for (number, mut stream) in streams.enumerate() {
            self.totals.resize((number + 1) * n_columns, 0.0);
            let Some(vertex) = stage.leave(patch, &mut stream) else { continue };
            self.paths.push(Path { number, stream, vertex, direction: Vec3::ZERO, density: 0.0 });
        }
        let n_paths = self.totals.len() / n_columns;
        self.throughput.clear();
        self.throughput.resize(n_paths * n_bands, 1.0);
        if let Some(emitted) = self.columns.of(0) {
            let emission = stage.emission(patch.facet, patch.side);
            for totals in self.totals.chunks_exact_mut(n_columns) {
                totals[emitted.clone()].iter_mut().zip(emission).for_each(|(total, emission)| *total = *emission);
            }
        }
    }

    /// Draws a point on the emitters for every path, and keeps those that face its vertex.
    fn draw_emitters(&mut self) {
        let (stage, n_bands) = (&self.tracer.stage, self.columns.n_bands);
        self.sights.clear();
        self.light.clear();
        for path in &mut self.paths {
            let vertex = &path.vertex;
            let (emitter, point) = stage.emitters.point(&mut path.stream);
            let offset = point - vertex.position;
            let distance_squared = offset.length_squared();
            let direction = offset / distance_squared.sqrt();
            let incident = vertex.frame.to_local(direction);
            let emitter_cosine = -direction.dot(emitter.normal);
            let is_facing = incident.z > 0.0 && emitter_cosine > 0.0;
            if !is_facing || stage.tracer.coplanar(emitter.facet, vertex.facet) {
                continue;
            }

            // f E cosθ′ / p, times the weight against finding it by a ray.
            let by_point = emitter.density * distance_squared / emitter_cosine;
            let weight = match self.tracer.sampling {
                Sampling::Both(heuristic) => {
                    heuristic.weight(by_point, vertex.reflection.density(vertex.given, incident))
                }
                Sampling::Directions | Sampling::Emitters => 1.0,
            };
            let first = self.light.len();
            let carried = &self.throughput[path.number * n_bands..][..n_bands];
            self.light.extend(carried.iter().zip(emitter.emission).map(|(carried, emission)| carried * emission));
            let light = &mut self.light[first..];
            vertex.reflection.scale(vertex.given, incident, incident.z / by_point * weight, light);
            if light.iter().any(|light| *light > 0.0) {
                let ends = [vertex.facet, emitter.facet];
                self.sights.push(Sight { number: path.number, from: vertex.position, to: point, ends });
            } else {
                self.light.truncate(first);
            }
        }
    }

    /// Adds what the emitters send that nothing hides.
    fn see_emitters(&mut self, column: usize) {
        let (tracer, n_bands, n_columns) = (&self.tracer.stage.tracer, self.columns.n_bands, self.columns.count());
        self.n_rays += self.sights.len() as u64;
        for (sight, light) in self.sights.iter().zip(self.light.chunks_exact(n_bands)) {
            if !tracer.occluded(sight.from, sight.to, sight.ends) {
                let totals = &mut self.totals[sight.number * n_columns + column..];
                totals.iter_mut().zip(light).for_each(|(total, light)| *total += light);
            }
        }
    }

    /// Draws where each path's light may come from, and lets the path survive or not.
    fn turn(&mut self, bounce: usize) {
        let (roulette, n_bands) = (self.tracer.roulette, self.columns.n_bands);
        let throughput = &mut self.throughput;
        self.paths.retain_mut(|path| {
            let vertex = &path.vertex;
            let carried = &mut throughput[path.number * n_bands..][..n_bands];
            let [u, v, fate] = path.stream.uniform3();
            let Some(turn) = vertex.reflection.turn(vertex.given, [u, v], carried) else { return false };
            let survival = roulette.survival(bounce, carried.iter().copied().fold(0.0, f64::max));
            if fate >= survival {
                return false;
            }
            let gain = 1.0 / survival;
            carried.iter_mut().for_each(|carried| *carried *= gain);
            path.direction = vertex.frame.to_world(turn.direction);
            path.density = turn.density;
            true
        });
    }

    /// Follows every path's ray, adds what is emitted where it ends, and goes on from there.
    fn go(&mut self, column: usize) {
        let (tracer, n_bands, n_columns) = (self.tracer, self.columns.n_bands, self.columns.count());
        let (stage, totals, throughput) = (&tracer.stage, &mut self.totals, &self.throughput);
        self.n_rays += self.paths.len() as u64;
        self.paths.retain_mut(|path| {
            let Some(arrival) = stage.follow(path.vertex.facet, path.vertex.position, path.direction) else {
                return false;
            };
            let density = stage.emitters.density(arrival.facet);
            if density > 0.0 && arrival.side == Side::Front && tracer.sampling != Sampling::Emitters {
                let weight = weight_of_ray(tracer.sampling, path.density, density, &arrival);
                let totals = &mut totals[path.number * n_columns + column..];
                let carried = &throughput[path.number * n_bands..][..n_bands];
                let emission = stage.emission(arrival.facet, arrival.side);
                for ((total, carried), emission) in totals.iter_mut().zip(carried).zip(emission) {
                    *total += carried * weight * emission;
                }
            }
            let Some(next) = stage.vertex(&arrival) else { return false };
            path.vertex = next;
            true
        });
    }
}

/// The weight of an emitter that a ray of this density has met, against drawing that point.
#[inline]
fn weight_of_ray(sampling: Sampling, by_ray: f64, density: f64, arrival: &Arrival) -> f64 {
    match sampling {
        Sampling::Both(heuristic) => {
            let by_point = density * arrival.distance * arrival.distance / arrival.given.z;
            heuristic.weight(by_ray, by_point)
        }
        Sampling::Directions | Sampling::Emitters => 1.0,
    }
}
