//! How the answer of the matrix approaches the scene's own as patches shrink.

use super::outcome::{MeshAgreement, Refinement, RefinementLevel, SurfaceMean};
use crate::basis::Bundles;
use crate::compare::observed_order;
use crate::linalg::Block;
use crate::scene::Scene;
use crate::stats::{critical_z, sidak, sidak_level, student_critical, student_tail, two_sided_p};

/// Orders a discretisation error is extrapolated with: constant patches give at most two, and two meshes that hardly differ prove
/// nothing.
const ORDERS: (f64, f64) = (0.5, 2.0);

/// Scores of one size that would give a mean its standard error: on fewer than so many no normal distribution is to be had. Where light
/// hardly gets, most surfaces see none.
const FEWEST_SCORES: f64 = 16.0;

/// One mesh's solution, by surface.
#[derive(Clone, Debug)]
pub struct LevelSolution {
    pub patch_size: f64,
    pub n_bundles: usize,
    /// Étendue-weighted mean of the reflected radiance, L − E: surfaces × bands.
    pub reflected: Block,
}

impl LevelSolution {
    pub fn new(scene: &Scene, bundles: &Bundles, radiance: &Block, emission: &Block) -> Self {
        let mut reflected = radiance.clone();
        reflected.add_scaled(-1.0, emission);
        let (reflected, _) = surface_means(scene, bundles, &reflected, None);
        Self { patch_size: bundles.resolution().patch_size, n_bundles: bundles.n_bundles(), reflected }
    }
}

/// Means of the reflected radiance of surfaces by a continuous method, surfaces × bands.
#[derive(Clone, Debug)]
pub struct SurfaceSample {
    pub mean: Block,
    /// Variance of `mean`.
    pub variance: Block,
    /// That every variance rests on; absent where they are many.
    pub n_degrees_of_freedom: Option<f64>,
}

/// Étendue-weighted mean over each surface, and the variance of that mean from variances of independent entries.
pub fn surface_means(scene: &Scene, bundles: &Bundles, values: &Block, variances: Option<&Block>) -> (Block, Block) {
    let (n_surfaces, n_bands) = (scene.surfaces().len(), values.n_columns());
    let mut weight = vec![0.0; n_surfaces];
    let (mut means, mut spread) = (Block::zeros(n_surfaces, n_bands), Block::zeros(n_surfaces, n_bands));
    for (i, mu) in bundles.etendue().iter().enumerate() {
        let Some(patch) = bundles.patch(bundles.element_of(i).0) else { continue };
        let surface = scene.facets()[patch.facet].surface;
        weight[surface] += mu;
        for band in 0..n_bands {
            means.column_mut(band)[surface] += mu * values.get(i, band);
            if let Some(variances) = variances {
                spread.column_mut(band)[surface] += mu * mu * variances.get(i, band);
            }
        }
    }
    for band in 0..n_bands {
        means.column_mut(band).iter_mut().zip(&weight).for_each(|(m, w)| *m /= w);
        spread.column_mut(band).iter_mut().zip(&weight).for_each(|(v, w)| *v /= w * w);
    }
    (means, spread)
}

/// Holds every level's reflected light (what is emitted is known and would only flatter the numbers), coarsest first and at least one, against the path tracer's means on the finest.
///
/// The finest level's discretisation error is extrapolated from its difference to the level before, |Δ| / (2ᵖ − 1), with p the
/// order that the matrix's own levels show where there are three; for no surface is it taken below the average.
pub fn compare(
    scene: &Scene,
    bundles: &Bundles,
    levels: &[LevelSolution],
    paths: &SurfaceSample,
    emission: &Block,
    significance: f64,
) -> Refinement {
    let areas: Vec<f64> = scene.surfaces().iter().map(|s| s.area()).collect();
    let SurfaceSample { mean: truth, variance, .. } = paths;
    let (emitted, _) = surface_means(scene, bundles, emission, None);
    let size = weigh(truth, &areas, |v| v * v);
    let noise = (weigh(variance, &areas, |v| v) / size).sqrt();
    let difference = |a: &Block, b: &Block| {
        let mut d = a.clone();
        d.add_scaled(-1.0, b);
        (weigh(&d, &areas, |v| v * v) / size).sqrt()
    };

    // Measure every level against the paths, and fit what is left once their noise is taken out.
    let measured: Vec<RefinementLevel> = levels
        .iter()
        .map(|level| RefinementLevel {
            patch_size: level.patch_size,
            n_bundles: level.n_bundles,
            error: difference(&level.reflected, truth),
            noise,
        })
        .collect();
    let clear: Vec<(f64, f64)> = measured
        .iter()
        .filter(|level| level.error > 2.0 * noise)
        .map(|level| (level.patch_size, (level.error * level.error - noise * noise).sqrt()))
        .collect();
    let fitted = observed_order(&clear);

    // Extrapolate the finest level from the matrix's own differences.
    let steps: Vec<f64> = levels.windows(2).map(|pair| difference(&pair[0].reflected, &pair[1].reflected)).collect();
    let own_order = match steps[..] {
        [.., coarse, fine] if fine > 0.0 => (coarse / fine).log2(),
        _ => 1.0,
    };
    let shrink = 2f64.powf(own_order.clamp(ORDERS.0, ORDERS.1)) - 1.0;
    let extrapolated = steps.last().map_or(f64::NAN, |step| step / shrink);

    // Compare surface by surface.
    let finest = &levels[levels.len() - 1];
    let before = &levels[levels.len().saturating_sub(2)];
    let critical = critical_z(significance, truth.values().len());
    let mut agrees = true;
    let mut surfaces = Vec::new();
    for (s, surface) in scene.surfaces().iter().enumerate() {
        for (band, name) in scene.bands().iter().enumerate() {
            let (matrix, path_tracer) = (finest.reflected.get(s, band), truth.get(s, band));
            let standard_error = variance.get(s, band).sqrt();
            let step = (matrix - before.reflected.get(s, band)).abs();
            let discretisation_error = (step / shrink).max(extrapolated * path_tracer.abs());
            // Two exact means may still differ by the rounding of their sums.
            let rounding = 1e-12 * path_tracer.abs();
            let is_dark = matrix == 0.0 && path_tracer == 0.0;
            let n_scores = (path_tracer / standard_error).powi(2);
            let is_comparable = is_dark || (path_tracer != 0.0 && n_scores >= FEWEST_SCORES);
            agrees &= !is_comparable
                || (matrix - path_tracer).abs() <= discretisation_error + critical * standard_error + rounding;
            surfaces.push(SurfaceMean {
                surface: surface.name.clone(),
                band: name.clone(),
                matrix: matrix + emitted.get(s, band),
                path_tracer: path_tracer + emitted.get(s, band),
                standard_error,
                discretisation_error,
                is_comparable,
            });
        }
    }
    agrees &= surfaces.iter().any(|mean| mean.is_comparable);
    // What was measured beyond noise is discretisation error too, whatever the levels extrapolate to.
    let beyond_noise = measured.last().map_or(0.0, |level| (level.error * level.error - noise * noise).max(0.0).sqrt());
    let finest_error = if extrapolated.is_nan() { f64::NAN } else { extrapolated.max(beyond_noise) };
    Refinement {
        levels: measured,
        observed_order: fitted.as_ref().map_or(f64::NAN, |fit| fit.order),
        order_standard_error: fitted.as_ref().map_or(f64::NAN, |fit| fit.standard_error),
        finest_error,
        agrees,
        surfaces,
    }
}

/// Holds one continuous method against the finest level, whose surfaces `refinement` has, and against the reference's means unless it is the
/// reference.
pub fn hold(
    scene: &Scene,
    refinement: &Refinement,
    finest: &LevelSolution,
    sample: &SurfaceSample,
    reference: Option<&SurfaceSample>,
    significance: f64,
) -> MeshAgreement {
    let areas: Vec<f64> = scene.surfaces().iter().map(|s| s.area()).collect();
    let size = weigh(&finest.reflected, &areas, |v| v * v);
    let mut apart = finest.reflected.clone();
    apart.add_scaled(-1.0, &sample.mean);
    let n = sample.mean.values().len();
    let alone = sidak_level(significance, n);
    let critical =
        sample.n_degrees_of_freedom.map_or_else(|| critical_z(significance, n), |d| student_critical(alone / 2.0, d));

    // Look at every surface that enough light has found.
    let (mut agrees, mut n_comparable, mut n_compared, mut worst) = (true, 0, 0, 0.0_f64);
    for (k, surface) in refinement.surfaces.iter().enumerate() {
        let n_bands = sample.mean.n_columns();
        let (s, band) = (k / n_bands, k % n_bands);
        let (mean, variance) = (sample.mean.get(s, band), sample.variance.get(s, band));
        if !surface.is_comparable || (mean != 0.0 && mean * mean < FEWEST_SCORES * variance) {
            continue;
        }
        n_comparable += 1;
        let rounding = 1e-12 * mean.abs();
        agrees &= apart.get(s, band).abs() <= surface.discretisation_error + critical * variance.sqrt() + rounding;
        if let Some(reference) = reference {
            let error = (variance + reference.variance.get(s, band)).sqrt().hypot(rounding);
            if error > 0.0 {
                n_compared += 1;
                worst = worst.max((mean - reference.mean.get(s, band)).abs() / error);
            }
        }
    }
    let p_of =
        |t: f64| sample.n_degrees_of_freedom.map_or_else(|| two_sided_p(t), |d| (2.0 * student_tail(t, d)).min(1.0));
    MeshAgreement {
        difference: (weigh(&apart, &areas, |v| v * v) / size).sqrt(),
        noise: (weigh(&sample.variance, &areas, |v| v) / size).sqrt(),
        agrees: agrees && n_comparable > 0 && refinement.levels.len() > 1,
        worst_t: reference.map(|_| worst),
        p_value: reference.map(|_| sidak(p_of(worst), n_compared.max(1))),
    }
}

/// Σ area · f(value) over surfaces and bands.
fn weigh(block: &Block, areas: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    block.columns().map(|column| column.iter().zip(areas).map(|(v, a)| a * f(*v)).sum::<f64>()).sum()
}
