//! What diffuse surfaces ask for, for many paths at a time: plain arithmetic over lanes, that the machine does several of at once.
//!
//! Each lane's result is a function of that lane alone, and rounded as it is by itself: the number of lanes changes no bit.

use super::Heuristic;
use super::path_tracer::Sampling;
use crate::geometry::Vec3;
use crate::sampling::{Streams, warp};
use pulp::{Arch, NullaryFnOnce};
use std::f64::consts::PI;

/// Paths abreast: enough to hide what each waits for, few enough to stay in the nearest cache.
pub(super) const N: usize = 64;

/// One number a path.
pub(super) type Lanes = [f64; N];

/// One vector a path, component by component.
pub(super) type Vectors = [Lanes; 3];

#[inline]
pub(super) fn get(vectors: &Vectors, k: usize) -> Vec3 {
    Vec3::new(vectors[0][k], vectors[1][k], vectors[2][k])
}

#[inline]
pub(super) fn set(vectors: &mut Vectors, k: usize, value: Vec3) {
    (vectors[0][k], vectors[1][k], vectors[2][k]) = (value.x, value.y, value.z);
}

/// Lanes worked out for n that are wanted: whole vectors, what is in the rest being nobody's.
#[inline(always)]
pub(super) fn whole(n: usize) -> usize {
    n.next_multiple_of(8).min(N)
}

/// Something computed for all lanes: run by the widest instructions of this machine, which round as any others.
trait Kernel {
    fn run(self);
}

/// A kernel as `pulp` takes it.
struct On<K>(K);

impl<K: Kernel> NullaryFnOnce for On<K> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.0.run();
    }
}

/// Three numbers a path, from one block of its stream.
pub(super) struct Draw<'l> {
    pub streams: &'l Streams,
    pub start: u32,
    pub samples: &'l [u64],
    pub block: u32,
    pub uniform: &'l mut [Lanes; 3],
}

impl Draw<'_> {
    pub fn run(self) {
        Arch::new().dispatch(On(self));
    }
}

impl Kernel for Draw<'_> {
    #[inline(always)]
    fn run(self) {
        let [a, b, c] = self.uniform;
        self.streams.uniform3_many(self.start, self.samples, self.block, [a, b, c]);
    }
}

/// A direction of density cosθ/π about each normal, and its density.
pub(super) struct Turns<'l> {
    pub n: usize,
    pub normal: &'l Vectors,
    pub uniform: [&'l Lanes; 2],
    pub direction: &'l mut Vectors,
    pub density: &'l mut Lanes,
}

impl Turns<'_> {
    pub fn run(self) {
        Arch::new().dispatch(On(self));
    }
}

impl Kernel for Turns<'_> {
    #[inline(always)]
    fn run(self) {
        let ([u, v], [nx, ny, nz], [dx, dy, dz]) = (self.uniform, self.normal, self.direction);
        for k in 0..whole(self.n) {
            let [x, y, z] = warp::cosine_hemisphere([u[k], v[k]]);
            self.density[k] = warp::cosine_hemisphere_pdf([x, y, z]);

            // The frame about the normal (Duff et al. 2017), as Frame::about has it.
            let (nx, ny, nz) = (nx[k], ny[k], nz[k]);
            let sign = 1.0_f64.copysign(nz);
            let a = -1.0 / (sign + nz);
            let b = nx * ny * a;
            dx[k] = x * (1.0 + sign * nx * nx * a) + y * b + z * nx;
            dy[k] = x * (sign * b) + y * (sign + ny * ny * a) + z * ny;
            dz[k] = x * (-sign * nx) - y * ny + z * nz;
        }
    }
}

/// Points drawn on emitters.
pub(super) struct Points {
    pub position: Vectors,
    pub normal: Vectors,
    /// By area, m⁻².
    pub density: Lanes,
}

/// What diffuse surfaces make of points on emitters, but for albedo and emission: cosθ cosθ′ / (π r² p) times the weight, zero where the two do
/// not face each other.
///
/// With n · o and n′ · o for the vector o between the points, cosθ cosθ′ / (π r² p) is x / y, x = (n · o)(−n′ · o) and y = π p r⁴; and that is also
/// the ratio of the densities of the two ways to find the point: the direction's cosθ/π to the point's p r²/cosθ′.
pub(super) struct Weigh<'l> {
    pub sampling: Sampling,
    pub n: usize,
    pub position: &'l Vectors,
    pub normal: &'l Vectors,
    pub points: &'l Points,
    pub gain: &'l mut Lanes,
}

impl Weigh<'_> {
    pub fn run(self) {
        Arch::new().dispatch(On(self));
    }

    #[inline(always)]
    fn each(self, gain: impl Fn(f64, f64) -> f64) {
        let (from, to, points) = (self.position, &self.points.position, self.points);
        for k in 0..whole(self.n) {
            let (ox, oy, oz) = (to[0][k] - from[0][k], to[1][k] - from[1][k], to[2][k] - from[2][k]);
            let cosine = self.normal[0][k] * ox + self.normal[1][k] * oy + self.normal[2][k] * oz;
            let away = points.normal[0][k] * ox + points.normal[1][k] * oy + points.normal[2][k] * oz;
            let distance_squared = ox * ox + oy * oy + oz * oz;
            let x = if cosine > 0.0 { cosine } else { 0.0 } * if away < 0.0 { -away } else { 0.0 };
            self.gain[k] = gain(x, PI * points.density[k] * distance_squared * distance_squared);
        }
    }
}

impl Kernel for Weigh<'_> {
    #[inline(always)]
    fn run(self) {
        match self.sampling {
            Sampling::Both(Heuristic::Balance) => self.each(|x, y| x / (x + y)),
            Sampling::Both(Heuristic::Power) => self.each(|x, y| x * y / (x * x + y * y)),
            Sampling::Emitters | Sampling::Directions => self.each(|x, y| x / y),
        }
    }
}
