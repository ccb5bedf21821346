//! Light paths against exact answers, against each other, and against themselves with a mistake in them.
//!
//! Every comparison is of surface means, one a band and bounce. Their standard errors come from [`N_BATCHES`] means over disjoint ranges
//! of samples, so that whatever one sample scores in many bundles is counted with its correlations; p-values are Student's t. All
//! comparisons of one test together err with probability [`ALPHA`].

mod density;
mod edges;
mod exact;
mod planted;
mod strategies;

use etendue::basis::{Bundles, Resolution};
use etendue::estimator::{
    Bidirectional, Bounces, Estimator, Heuristic, LightTracer, PathTracer, Roulette, Sampling, estimate_range,
};
use etendue::geometry::{Polygon, Vec3};
use etendue::linalg::Block;
use etendue::scattering::{Brdf, Lambert};
use etendue::scene::{Scene, SceneDescription, Side, Surface};
use etendue::stats::{Moments, sidak_level, welch_test};
use std::sync::Arc;

/// Probability that one of these tests rejects estimators that are right.
const ALPHA: f64 = 1e-6;
const SEED: u64 = 0x9a75_0b5e_55ed_ca5e;
const N_BATCHES: u64 = 64;
/// What rounding may leave between two numbers without noise, relative.
const ROUNDING: f64 = 1e-12;

// ---- scenes

/// A parallelogram from a corner and two edges, its front towards `towards`.
fn quad(corner: [f64; 3], u: [f64; 3], v: [f64; 3], towards: [f64; 3]) -> Polygon {
    let [corner, u, v, towards] = [corner, u, v, towards].map(Vec3::from);
    let polygon = Polygon::new(vec![corner, corner + u, corner + u + v, corner + v]).unwrap();
    if polygon.normal().dot(towards - polygon.centroid()) > 0.0 { polygon } else { polygon.flipped() }
}

fn surface(name: &str, polygon: Polygon, front: impl Brdf + 'static, emission: &[f64]) -> Surface {
    let (name, polygons, emission) = (name.into(), vec![polygon], emission.to_vec());
    Surface { name, polygons, front: Arc::new(front), back: None, emission, tessellation: None }
}

fn matte(name: &str, polygon: Polygon, albedo: &[f64], emission: &[f64]) -> Surface {
    surface(name, polygon, Lambert::new(albedo.to_vec()), emission)
}

fn scene(surfaces: Vec<Surface>) -> Scene {
    let bands = (0..surfaces[0].emission.len()).map(|band| format!("band-{band}")).collect();
    Scene::new(SceneDescription { name: "test".into(), bands, surfaces, camera: None }).unwrap()
}

/// Floor, ceiling, left, right, back, front of the unit cube, facing inward.
fn cube() -> [Polygon; 6] {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let wall = |corner, u, v| quad(corner, u, v, [0.5; 3]);
    [wall([0.0; 3], x, z), wall(y, x, z), wall([0.0; 3], y, z), wall(x, y, z), wall([0.0; 3], x, y), wall(z, x, y)]
}

fn bundles(scene: &Scene, patch_size: f64) -> Bundles {
    Bundles::new(scene, Resolution { patch_size, n_directions: 1 }).unwrap()
}

// ---- estimators

/// An estimator, and what it is called here: its settings are not part of its name.
struct Contestant<'a> {
    label: &'static str,
    estimator: Box<dyn Estimator + 'a>,
    /// False where emitters are found only by drawing points on them: no error bar holds where they touch what they light.
    has_variance_near_emitters: bool,
    /// False where emitters are found only by chance.
    finds_small_emitters: bool,
}

fn contestants<'a>(scene: &'a Scene, bundles: &'a Bundles, bounces: Bounces) -> Vec<Contestant<'a>> {
    let paths = || PathTracer::new(scene, bundles).unwrap().with_bounces(bounces);
    let light = || LightTracer::new(scene, bundles).unwrap().with_bounces(bounces);
    let both_ways = || Bidirectional::new(scene, bundles).unwrap().with_bounces(bounces);
    let contestant = |label, estimator: Box<dyn Estimator + 'a>| Contestant {
        label,
        estimator,
        has_variance_near_emitters: true,
        finds_small_emitters: true,
    };
    let drawn = paths().with_sampling(Sampling::Emitters);
    let met = paths().with_sampling(Sampling::Directions);
    vec![
        contestant("paths", Box::new(paths())),
        contestant("paths, power heuristic", Box::new(paths().with_sampling(Sampling::Both(Heuristic::Power)))),
        Contestant { has_variance_near_emitters: false, ..contestant("paths, emitters drawn", Box::new(drawn)) },
        Contestant { finds_small_emitters: false, ..contestant("paths, emitters met", Box::new(met)) },
        contestant("paths, late roulette", Box::new(paths().with_roulette(Roulette::After(2)).unwrap())),
        contestant("paths, constant roulette", Box::new(paths().with_roulette(Roulette::Constant(0.93)).unwrap())),
        contestant("light", Box::new(light())),
        contestant("light, late roulette", Box::new(light().with_roulette(Roulette::After(2)).unwrap())),
        contestant("bidirectional", Box::new(both_ways())),
        contestant("bidirectional, power heuristic", Box::new(both_ways().with_heuristic(Heuristic::Power))),
        contestant("bidirectional, late roulette", Box::new(both_ways().with_roulette(Roulette::After(2)).unwrap())),
    ]
}

// ---- comparisons

/// Linear functionals of n × columns numbers: surface means of each column, fronts and backs apart.
struct SurfaceMeans {
    /// A name, and the bundles with their shares.
    means: Vec<(String, Vec<(usize, f64)>)>,
}

impl SurfaceMeans {
    fn new(scene: &Scene, bundles: &Bundles) -> Self {
        let mut means: Vec<(String, Vec<(usize, f64)>)> = Vec::new();
        for bundle in 0..bundles.n_bundles() {
            let patch = bundles.patch(bundle).unwrap();
            let back = if patch.side == Side::Back { ", back" } else { "" };
            let name = format!("{}{back}", scene.surface_of(patch.facet).name);
            let entry = (bundle, bundles.etendue()[bundle]);
            match means.iter_mut().find(|(known, _)| *known == name) {
                Some((_, entries)) => entries.push(entry),
                None => means.push((name, vec![entry])),
            }
        }
        for (_, entries) in &mut means {
            let total: f64 = entries.iter().map(|(_, mu)| mu).sum();
            entries.iter_mut().for_each(|(_, mu)| *mu /= total);
        }
        Self { means }
    }

    /// One number a mean and column, mean by mean.
    fn of(&self, radiance: &Block) -> Vec<f64> {
        let mean = |entries: &[(usize, f64)], column| entries.iter().map(|(k, w)| w * radiance.get(*k, column)).sum();
        self.means.iter().flat_map(|(_, e)| (0..radiance.n_columns()).map(move |column| mean(e, column))).collect()
    }
}

/// The moments over batches of functionals of the mean.
fn batches(estimator: &dyn Estimator, samples_a_batch: u64, of: impl Fn(&Block) -> Vec<f64>) -> Vec<Moments> {
    let batch = |k: u64| of(&estimate_range(estimator, k * samples_a_batch..(k + 1) * samples_a_batch, SEED).mean);
    let mut moments = vec![Moments::default(); batch(0).len()];
    for k in 0..N_BATCHES {
        moments.iter_mut().zip(batch(k)).for_each(|(moments, value)| moments.push(value));
    }
    moments
}

/// A number without noise.
fn certain(value: f64) -> Moments {
    [value, value].into_iter().collect()
}

/// Probability of such a difference, were the means equal.
fn p_value(a: &Moments, b: &Moments) -> f64 {
    let size = a.mean().abs().max(b.mean().abs());
    let has_noise = a.variance() + b.variance() > (ROUNDING * size).powi(2);
    match has_noise {
        true => welch_test(a, b).p_value,
        false if (a.mean() - b.mean()).abs() <= ROUNDING * size => 1.0,
        false => 0.0,
    }
}

/// Comparisons that must all hold.
#[derive(Default)]
struct Verdict {
    comparisons: Vec<(String, f64)>,
}

impl Verdict {
    fn compare(&mut self, what: String, a: &Moments, b: &Moments) {
        let what = format!("{what}: {} ± {:.2e} against {}", a.mean(), a.standard_error(), b.mean());
        self.comparisons.push((what, p_value(a, b)));
    }

    /// Every p-value above the level that makes all of them together [`ALPHA`].
    fn assert_agreement(&self) {
        let level = sidak_level(ALPHA, self.comparisons.len());
        assert!(!self.comparisons.is_empty(), "nothing was compared");
        for (what, p) in &self.comparisons {
            assert!(*p > level, "{what}: p = {p:e} of {} comparisons", self.comparisons.len());
        }
    }
}
