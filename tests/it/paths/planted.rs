//! Mistakes planted on purpose, each caught within a budget that is stated before it is spent.
//!
//! A mistake that moves the mean by δ is seen at significance α with probability 1 − β by n samples of standard deviation σ if
//!
//! ```text
//! n ≥ ((z_{α/2} + z_β) σ / δ)²,
//! ```
//!
//! δ being derived for each mistake, and σ measured on a pilot run of other samples. The same n samples of the honest estimator must pass.

use super::*;
use etendue::estimator::{Estimate, Score, Truth, estimate, estimate_range};
use etendue::gallery;
use etendue::geometry::Tracer;
use etendue::sampling::Stream;
use etendue::stats::{critical_z, two_sided_p, z_score};
use std::f64::consts::PI;

/// Probability of missing a mistake.
const BETA: f64 = 1e-3;
/// Samples a start of most pilot runs.
const PILOT: u64 = 500;
/// Their numbers begin here, out of the way of all others.
const FIRST_PILOT: u64 = 1 << 40;

/// A mistake, and the étendue-weighted mean of some bundles that shows it.
struct Planted<'a> {
    what: &'static str,
    honest: &'a dyn Estimator,
    flawed: &'a dyn Estimator,
    /// One weight a bundle.
    weights: &'a [f64],
    exact: f64,
    /// The least that the mistake moves the mean.
    effect: f64,
    /// Samples a start of the pilot run.
    pilot: u64,
    /// Samples a start that are affordable here.
    affordable: u64,
}

impl Planted<'_> {
    /// Samples a start: what the largest σ/√n of the two estimators allows.
    fn budget(&self) -> u64 {
        let z = critical_z(ALPHA, 1) + critical_z(2.0 * BETA, 1);
        let needed = |estimator: &dyn Estimator| {
            let pilot = estimate_range(estimator, FIRST_PILOT..FIRST_PILOT + self.pilot, SEED);
            pilot.weighted_mean(self.weights, 0).unwrap().variance * self.pilot as f64 * (z / self.effect).powi(2)
        };
        (needed(self.honest).max(needed(self.flawed)).ceil() as u64).max(self.pilot)
    }

    fn p_value(&self, drawn: &Estimate) -> f64 {
        let mean = drawn.weighted_mean(self.weights, 0).unwrap();
        two_sided_p(z_score(mean.mean, self.exact, mean.variance))
    }

    fn assert_is_caught(&self) {
        let n = self.budget();
        assert!(n <= self.affordable, "{}: {n} samples a start are needed", self.what);
        let p = self.p_value(&estimate(self.honest, n, SEED));
        assert!(p > ALPHA, "{}: the honest estimator was rejected, p = {p:e}", self.what);
        let p = self.p_value(&estimate(self.flawed, n, SEED));
        assert!(p < ALPHA, "{} went unnoticed in {n} samples a start, p = {p:e}", self.what);
    }
}

// ---- mistakes in a BRDF

#[derive(Clone, Copy, Debug)]
enum Flaw {
    CosineTwice,
    PiMissing,
    /// Paths go on with this probability, and are not weighed up for it.
    RouletteUnweighted(f64),
}

/// A diffuse surface with a mistake.
#[derive(Clone, Debug)]
struct Flawed {
    honest: Lambert,
    flaw: Flaw,
}

impl Brdf for Flawed {
    fn n_bands(&self) -> usize {
        self.honest.n_bands()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        let honest = self.honest.eval(band, incident, outgoing);
        match self.flaw {
            Flaw::CosineTwice => honest * incident.z,
            Flaw::PiMissing => honest * PI,
            Flaw::RouletteUnweighted(_) => honest,
        }
    }

    fn sample(&self, outgoing: Vec3, [first, second]: [f64; 2]) -> Option<Vec3> {
        let survival = if let Flaw::RouletteUnweighted(survival) = self.flaw { survival } else { 1.0 };
        if first < survival { self.honest.sample(outgoing, [first / survival, second]) } else { None }
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        self.honest.pdf(outgoing, incident)
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        self.honest.albedo(band, outgoing)
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("{self:?}")
    }
}

/// A furnace of albedo a and emission 1 that takes itself to be of albedo a′ radiates 1/(1 − a′) instead of 1/(1 − a).
fn assert_flaw_is_caught(flaw: Flaw, albedo: f64, taken_for: f64, sampling: Sampling) {
    let honest = gallery::furnace_cube(&[albedo], &[1.0]).unwrap();
    let mut description = honest.description().clone();
    for surface in &mut description.surfaces {
        surface.front = Arc::new(Flawed { honest: Lambert::grey(albedo, 1), flaw });
    }
    let flawed = Scene::new(description).unwrap();
    let bundles = bundles(&honest, 100.0);
    let paths = |scene| PathTracer::new(scene, &bundles).unwrap().with_sampling(sampling);
    let exact = 1.0 / (1.0 - albedo);
    Planted {
        what: "a flawed BRDF",
        honest: &paths(&honest),
        flawed: &paths(&flawed),
        weights: bundles.etendue(),
        exact,
        effect: (1.0 / (1.0 - taken_for) - exact).abs(),
        pilot: PILOT,
        affordable: 2_000,
    }
    .assert_is_caught();
}

/// ∫ cos²θ dω / π = 2/3.
#[test]
fn cosine_twice() {
    assert_flaw_is_caught(Flaw::CosineTwice, 0.5, 0.5 * 2.0 / 3.0, Sampling::Both(Heuristic::Balance));
}

#[test]
fn pi_missing() {
    assert_flaw_is_caught(Flaw::PiMissing, 0.2, 0.2 * PI, Sampling::Both(Heuristic::Balance));
}

#[test]
fn roulette_unweighted() {
    assert_flaw_is_caught(Flaw::RouletteUnweighted(0.9), 0.5, 0.5 * 0.9, Sampling::Directions);
}

// ---- one strategy left out of the weights

/// Every weight as if a strategy were there, which is not.
struct LeftOut<'a> {
    whole: Bidirectional<'a>,
    part: Bidirectional<'a>,
}

impl Estimator for LeftOut<'_> {
    fn name(&self) -> &'static str {
        self.whole.name()
    }

    fn truth(&self) -> Truth {
        self.whole.truth()
    }

    fn n_bundles(&self) -> usize {
        self.whole.n_bundles()
    }

    fn n_columns(&self) -> usize {
        self.whole.n_columns()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        self.whole.sample(start, &mut stream.clone(), score);
        let whole = score.totals(start).to_vec();
        self.part.sample(start, stream, score);
        score.totals(start).iter_mut().zip(&whole).for_each(|(total, whole)| *total = 2.0 * whole - *total);
    }
}

/// The effect is what the strategy contributes, from a pilot run of it alone, less ten standard errors.
#[test]
fn a_strategy_left_out_of_the_weights() {
    let albedo: f64 = 0.5;
    let scene = gallery::furnace_cube(&[albedo], &[1.0]).unwrap();
    let bundles = bundles(&scene, 100.0);
    let whole = || Bidirectional::new(&scene, &bundles).unwrap().with_bounces(Bounces::UpTo(3));
    for (s, t) in [(0, 2), (1, 1), (1, 2), (2, 1), (0, 3)] {
        let part = || whole().weighted_strategy(s, t).unwrap();
        let pilot = estimate_range(&part(), FIRST_PILOT..FIRST_PILOT + 10 * PILOT, SEED);
        let pilot = pilot.weighted_mean(bundles.etendue(), 0).unwrap();
        Planted {
            what: "a strategy left out",
            honest: &whole(),
            flawed: &LeftOut { whole: whole(), part: part() },
            weights: bundles.etendue(),
            exact: (0..4).map(|k| albedo.powi(k)).sum(),
            effect: pilot.mean - 10.0 * pilot.variance.sqrt(),
            pilot: PILOT,
            affordable: 20_000,
        }
        .assert_is_caught();
    }
}

// ---- light sampled with the wrong density

/// Direct light from two lamps of equal size, chosen with probabilities that may not be those it divides by.
struct DirectLight<'a> {
    scene: &'a Scene,
    bundles: &'a Bundles,
    tracer: Tracer,
    /// With which it chooses the first lamp, and with which it says it does.
    chosen: f64,
    claimed: f64,
}

impl<'a> DirectLight<'a> {
    fn new(scene: &'a Scene, bundles: &'a Bundles, chosen: f64, claimed: f64) -> Self {
        let polygons: Vec<&Polygon> = (0..scene.facets().len()).map(|facet| scene.polygon(facet)).collect();
        Self { scene, bundles, tracer: Tracer::new(&polygons), chosen, claimed }
    }
}

impl Estimator for DirectLight<'_> {
    fn name(&self) -> &'static str {
        "direct-light"
    }

    fn truth(&self) -> Truth {
        Truth::Continuous
    }

    fn n_bundles(&self) -> usize {
        self.bundles.n_bundles()
    }

    fn n_columns(&self) -> usize {
        1
    }

    /// a E cosθ cosθ′ A / (π r² p).
    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        let patch = self.bundles.patch(start).unwrap();
        let (lamp, claimed) = if stream.uniform() < self.chosen { (1, self.claimed) } else { (2, 1.0 - self.claimed) };
        let lamp_polygon = self.scene.polygon(lamp);
        let (x, y) = (patch.polygon.sample(stream.uniform2()), lamp_polygon.sample(stream.uniform2()));
        if patch.facet != 0 || self.tracer.occluded(x, y, [0, lamp]) {
            return;
        }
        let offset = y - x;
        let cosines = offset.dot(patch.polygon.normal()) * -offset.dot(lamp_polygon.normal());
        let albedo = self.scene.surface_of(0).front.albedo(0, Vec3::Z);
        let emission = self.scene.surface_of(lamp).emission[0];
        let density = claimed / lamp_polygon.area();
        score.add(start, 0, albedo * emission * cosines / (PI * offset.length_squared().powi(2) * density));
    }
}

/// Two lamps of emission 3 and 1 over the two halves of a floor, chosen alike where the density says 3 to 1: the half of the floor under
/// the strong one gets (2 F₁ + 2 F₂) instead of (3 F₁ + F₂).
#[test]
fn light_sampled_with_the_wrong_density() {
    let up = [0.5, 9.0, 0.5];
    let half = |x, y, towards| quad([x, y, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0], towards);
    let scene = scene(vec![
        matte("floor", half(0.0, 0.0, up), &[0.8], &[0.0]),
        matte("strong", half(0.0, 0.5, [0.0; 3]), &[0.0], &[3.0]),
        matte("weak", half(0.5, 0.5, [0.0; 3]), &[0.0], &[1.0]),
    ]);
    let bundles = bundles(&scene, 100.0);

    // F from the half floor to each half above, by a rule that has long converged.
    let rule = crate::sphere::gauss(16);
    let factor = |shift: f64| {
        let mut sum = 0.0;
        for (ax, wa) in &rule {
            for (bx, wb) in &rule {
                for (ay, va) in &rule {
                    for (by, vb) in &rule {
                        let across = 0.5 * (bx - ax) + shift;
                        let distance_squared = across * across + (ay - by).powi(2) + 0.25;
                        sum += wa * wb * va * vb * 0.5 * 0.25 / (PI * distance_squared * distance_squared);
                    }
                }
            }
        }
        sum
    };
    let (near, far) = (factor(0.0), factor(0.5));
    let exact = 0.8 * (3.0 * near + far);
    let planted = Planted {
        what: "a wrong density",
        honest: &DirectLight::new(&scene, &bundles, 0.75, 0.75),
        flawed: &DirectLight::new(&scene, &bundles, 0.5, 0.75),
        weights: &[1.0, 0.0, 0.0],
        exact,
        effect: 0.8 * (near - far),
        pilot: PILOT,
        affordable: 5_000,
    };
    planted.assert_is_caught();

    // The path tracer's own emitters are drawn as they should be.
    let paths = PathTracer::new(&scene, &bundles).unwrap().with_sampling(Sampling::Emitters);
    Planted { honest: &paths, ..planted }.assert_is_caught();
}

// ---- one wall's albedo off by 0.1 %

/// A closed room in which every wall emits what it absorbs of L = 1, whatever its albedo: L = 1 everywhere. Of a wall whose albedo is 0.1 %
/// too small, L is too small by 0.001 a, and by what the others then lack.
#[test]
fn one_albedo_off_by_a_thousandth() {
    let albedos = [0.9, 0.3, 0.6, 0.45, 0.75, 0.5];
    let room = |error: f64| {
        let wall = |(k, wall): (usize, Polygon)| {
            let albedo = albedos[k] * if k == 0 { 1.0 - error } else { 1.0 };
            matte(&format!("wall-{k}"), wall, &[albedo], &[1.0 - albedos[k]])
        };
        scene(cube().into_iter().enumerate().map(wall).collect())
    };
    let (honest, flawed) = (room(0.0), room(1e-3));
    let bundles = bundles(&honest, 100.0);
    // Paths that meet emitters add up 1 less what they still carry: little noise, and only from the roulette. Samples of the other walls
    // show little; only the wall itself is paid for.
    let paths = |scene| {
        let paths = PathTracer::new(scene, &bundles).unwrap().with_sampling(Sampling::Directions);
        paths.with_roulette(Roulette::After(10)).unwrap()
    };
    let (honest, flawed) = (paths(&honest), paths(&flawed));
    Planted {
        what: "an albedo",
        honest: &OneStart { all: &honest },
        flawed: &OneStart { all: &flawed },
        weights: &[1.0],
        exact: 1.0,
        effect: 1e-3 * albedos[0],
        // Few paths survive the roulette and score at all.
        pilot: 20_000,
        affordable: 500_000,
    }
    .assert_is_caught();
}

/// The first start of an estimator alone.
struct OneStart<'a> {
    all: &'a dyn Estimator,
}

impl Estimator for OneStart<'_> {
    fn name(&self) -> &'static str {
        self.all.name()
    }

    fn truth(&self) -> Truth {
        self.all.truth()
    }

    fn n_bundles(&self) -> usize {
        1
    }

    fn n_columns(&self) -> usize {
        self.all.n_columns()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        self.all.sample(start, stream, score);
    }
}
