//! Paths from one bundle that go step by step together.
//!
//! A path by itself is one long chain: each ray waits for the direction, which waits for the last hit. Many abreast keep the machine busy while
//! each of them waits, and what diffuse surfaces ask for is worked out for several at a time. What a path draws and adds up is the same whoever
//! is beside it.
//!
//! A path draws whole blocks of its stream: the point that it starts from, the direction in which its light is wanted, and for each bounce a
//! point on the emitters and a direction with the number that decides whether it survives.

use super::super::bounces::Columns;
use super::lanes::{self, Draw, Lanes, N, Points, Turns, Vectors, Weigh};
use super::path_tracer::{PathTracer, Sampling};
use super::reflection::Reflection;
use crate::geometry::{Ray, Vec3};
use crate::sampling::{Streams, warp};
use crate::scene::Side;

/// Some paths of one start under way. Lane k holds the k-th of those that have not ended.
pub(super) struct Wave<'t, 'a> {
    pub(super) tracer: &'t PathTracer<'a>,
    columns: Columns,
    /// Streams of the paths, and which of their blocks is next.
    streams: Streams,
    start: u32,
    pub block: u32,
    n_alive: usize,
    /// Which of the paths, and which sample.
    number: [u32; N],
    sample: [u64; N],
    /// Where it is: facet and side, position, the side's normal, and the direction of the ray that has come here.
    pub(super) place: [(u32, Side); N],
    pub(super) position: Vectors,
    normal: Vectors,
    pub(super) arriving: Vectors,
    /// Where it goes next.
    pub(super) direction: Vectors,
    /// The same as rays, and the points on emitters that they may see: laid out as they are traced, and written well before.
    rays: [Ray; N],
    targets: [Vec3; N],
    /// By solid angle.
    pub(super) density: Lanes,
    /// What it carries, band by band: on diffuse sides times the albedo, for that is what it carries on, whatever the direction.
    pub(super) carried: Vec<Lanes>,
    is_diffuse: [bool; N],
    pub(super) uniform: [Lanes; 3],
    /// Points on emitters, and what the geometry makes of their light.
    pub(super) emitter: [u32; N],
    pub(super) points: Points,
    gain: Lanes,
    /// What every path has found, path by path, one number a column.
    pub(super) totals: Vec<f64>,
    /// Closest hits and shadow rays so far.
    pub n_rays: u64,
}

impl<'t, 'a> Wave<'t, 'a> {
    /// Room for [`N`] paths abreast.
    pub fn new(tracer: &'t PathTracer<'a>, columns: Columns, streams: Streams, start: u32) -> Self {
        const ZERO: Lanes = [0.0; N];
        Self {
            tracer,
            columns,
            streams,
            start,
            block: 0,
            n_alive: 0,
            number: [0; N],
            sample: [0; N],
            place: [(0, Side::Front); N],
            position: [ZERO; 3],
            normal: [ZERO; 3],
            arriving: [ZERO; 3],
            rays: [Ray { origin: Vec3::ZERO, direction: Vec3::ZERO }; N],
            targets: [Vec3::ZERO; N],
            direction: [ZERO; 3],
            density: ZERO,
            carried: vec![ZERO; columns.n_bands],
            is_diffuse: [true; N],
            uniform: [ZERO; 3],
            emitter: [0; N],
            points: Points { position: [ZERO; 3], normal: [ZERO; 3], density: ZERO },
            gain: ZERO,
            totals: Vec::new(),
            n_rays: 0,
        }
    }

    /// Sends out a path for each of these samples, at most [`N`], from this block of their streams on, and follows them all to their ends.
    /// Returns what each has found, one number a column.
    pub fn run(
        &mut self,
        bundle: usize,
        samples: impl Iterator<Item = u64>,
        block: u32,
    ) -> impl Iterator<Item = &[f64]> {
        self.block = block;
        self.leave(bundle, samples);
        let sampling = self.tracer.sampling;
        for bounce in 1.. {
            let Some(here) = self.columns.of(bounce).filter(|_| self.n_alive > 0) else { break };
            if sampling != Sampling::Directions {
                self.draw_emitters();
                self.see_emitters(here.start);
            }
            if sampling == Sampling::Emitters && self.columns.ends_before(bounce + 1) {
                break;
            }
            self.turn();
            self.go(bounce, here.start);
        }
        self.totals.chunks_exact(self.columns.count())
    }

    /// Draws the next block of every path.
    fn draw(&mut self) {
        let samples = &self.sample[..lanes::whole(self.n_alive)];
        let (streams, start, block) = (&self.streams, self.start, self.block);
        Draw { streams, start, samples, block, uniform: &mut self.uniform }.run();
        self.block = self.block.wrapping_add(1);
    }

    /// Starts every path with what the bundle emits, anywhere in its étendue.
    fn leave(&mut self, bundle: usize, samples: impl Iterator<Item = u64>) {
        let (stage, columns) = (&self.tracer.stage, self.columns);
        let patch = stage.patches[bundle];
        self.n_alive = 0;
        for (sample, (slot, number)) in samples.zip(self.sample.iter_mut().zip(&mut self.number)) {
            (*slot, *number) = (sample, self.n_alive as u32);
            self.n_alive += 1;
        }
        self.totals.clear();
        self.totals.resize(self.n_alive * columns.count(), 0.0);
        if let Some(emitted) = columns.of(0) {
            let emission = stage.emission(patch.facet, patch.side);
            for totals in self.totals.chunks_exact_mut(columns.count()) {
                totals[emitted.clone()].iter_mut().zip(emission).for_each(|(total, emission)| *total = *emission);
            }
        }

        // A point of the patch; and a direction of density cosθ/π, backwards, where the direction matters.
        let n_alive = self.n_alive;
        self.carried.iter_mut().for_each(|carried| carried.fill(1.0));
        self.draw();
        let [u, v, _] = self.uniform;
        let face = stage.face(patch.facet, patch.side);
        let is_diffuse = matches!(face.reflection, Some(Reflection::Diffuse(_)));
        if is_diffuse {
            self.block = self.block.wrapping_add(1);
        } else {
            self.draw();
        }
        let parallelogram = patch.polygon.parallelogram();
        self.n_alive = 0;
        for k in 0..n_alive {
            let position = match parallelogram {
                Some([corner, along, up]) => corner + u[k] * along + v[k] * up,
                None => patch.polygon.sample([u[k], v[k]]),
            };
            let [s, t] = [self.uniform[0][k], self.uniform[1][k]];
            let given = if is_diffuse { Vec3::Z } else { warp::cosine_hemisphere([s, t]).into() };
            self.arrive(k, (patch.facet, patch.side), position, -face.frame.to_world(given), 1.0);
        }
    }

    /// Puts the path of lane k where its ray ends, in the first lane that is free; it ends on what is black. Lanes are freed in order, so the
    /// free one is not after k.
    #[inline]
    fn arrive(&mut self, k: usize, (facet, side): (usize, Side), position: Vec3, arriving: Vec3, gain: f64) {
        let face = self.tracer.stage.face(facet, side);
        let Some(reflection) = &face.reflection else { return };
        let to = self.n_alive;
        self.n_alive += 1;
        (self.number[to], self.sample[to]) = (self.number[k], self.sample[k]);
        self.place[to] = (facet as u32, side);
        lanes::set(&mut self.position, to, position);
        self.rays[to].origin = position;
        lanes::set(&mut self.normal, to, face.frame.z);
        lanes::set(&mut self.arriving, to, arriving);
        self.is_diffuse[to] = matches!(reflection, Reflection::Diffuse(_));
        match reflection {
            Reflection::Diffuse(albedo) => {
                let bands = self.carried.iter_mut().zip(*albedo);
                bands.for_each(|(carried, albedo)| carried[to] = carried[k] * gain * albedo);
            }
            Reflection::Other(_) => self.carried.iter_mut().for_each(|carried| carried[to] = carried[k] * gain),
        }
    }

    /// Draws a point on the emitters for every path, and what of its light a diffuse surface would reflect.
    fn draw_emitters(&mut self) {
        self.draw();
        let emitters = &self.tracer.stage.emitters;
        for k in 0..self.n_alive {
            let [choice, u, v] = [0, 1, 2].map(|d| self.uniform[d][k]);
            let (number, emitter) = emitters.choose(choice);
            self.emitter[k] = number as u32;
            self.targets[k] = emitter.point([u, v]);
            lanes::set(&mut self.points.position, k, self.targets[k]);
            lanes::set(&mut self.points.normal, k, emitter.normal);
            self.points.density[k] = emitter.density;
        }
        let (sampling, n) = (self.tracer.sampling, self.n_alive);
        let (position, normal) = (&self.position, &self.normal);
        Weigh { sampling, n, position, normal, points: &self.points, gain: &mut self.gain }.run();
    }

    /// Adds what the emitters send that nothing hides.
    fn see_emitters(&mut self, column: usize) {
        let stage = &self.tracer.stage;
        let n_columns = self.columns.count();
        for k in 0..self.n_alive {
            let emitter = stage.emitters.get(self.emitter[k] as usize);
            let facet = self.place[k].0 as usize;
            let is_facing = self.gain[k] > 0.0;
            if !is_facing || stage.tracer.coplanar(emitter.facet, facet) {
                continue;
            }
            let totals = self.number[k] as usize * n_columns + column;
            if !self.is_diffuse[k] {
                self.see_glossily(k, totals);
                continue;
            }
            let lit = self.carried.iter().zip(emitter.emission).any(|(carried, emission)| carried[k] * emission > 0.0);
            if !lit {
                continue;
            }
            self.n_rays += 1;
            if !stage.tracer.occluded(self.rays[k].origin, self.targets[k], [facet, emitter.facet]) {
                let found = self.totals[totals..].iter_mut().zip(self.carried.iter().zip(emitter.emission));
                found.for_each(|(total, (carried, emission))| *total += carried[k] * emission * self.gain[k]);
            }
        }
    }

    /// Draws where each path's light may come from. What does not reflect is left to carry nothing.
    fn turn(&mut self) {
        self.draw();
        let [u, v, _] = &self.uniform;
        let (direction, density) = (&mut self.direction, &mut self.density);
        Turns { n: self.n_alive, normal: &self.normal, uniform: [u, v], direction, density }.run();
        for k in 0..self.n_alive {
            if !self.is_diffuse[k] {
                self.turn_glossily(k);
            }
            self.rays[k].direction = lanes::get(&self.direction, k);
        }
    }

    /// Lets each path survive or not, follows its ray, adds what is emitted where that ends, and goes on from there.
    fn go(&mut self, bounce: usize, column: usize) {
        let (tracer, n_columns) = (self.tracer, self.columns.count());
        let stage = &tracer.stage;
        let n_alive = std::mem::take(&mut self.n_alive);
        for k in 0..n_alive {
            let most = self.carried.iter().fold(0.0, |most: f64, carried| most.max(carried[k]));
            let survival = tracer.roulette.survival(bounce, most);
            if self.uniform[2][k] >= survival {
                continue;
            }
            let gain = 1.0 / survival;
            self.n_rays += 1;
            let facet = self.place[k].0 as usize;
            let Some(hit) = stage.tracer.closest(&self.rays[k], Some(facet)) else { continue };
            let ray = self.rays[k];
            let density = stage.emitters.density(hit.polygon);
            if density > 0.0 && hit.front && tracer.sampling != Sampling::Emitters {
                let cosine = -ray.direction.dot(stage.face(hit.polygon, Side::Front).frame.z);
                let weight = gain * tracer.sampling.weight(self.density[k], density * hit.t * hit.t / cosine);
                let totals = &mut self.totals[self.number[k] as usize * n_columns + column..];
                let bands = self.carried.iter().zip(stage.emission(hit.polygon, Side::Front));
                let found = totals.iter_mut().zip(bands);
                found.for_each(|(total, (carried, emission))| *total += carried[k] * weight * emission);
            }
            let side = if hit.front { Side::Front } else { Side::Back };
            self.arrive(k, (hit.polygon, side), ray.at(hit.t), ray.direction, gain);
        }
    }
}
