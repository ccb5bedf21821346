//! The main study: one scene, every solver and estimator, against each other.

use super::albedo::{albedo_study, check_albedos};
use super::duality::LinearSensor;
use super::estimation::{Estimated, estimate_growing};
use super::estimators::{REFERENCE, Roster, SEQUENTIAL, UNBOUNDED, choose_estimators};
use super::methods::{Solved, solve_all};
use super::outcome::*;
use super::refinement::{self, LevelSolution};
use super::repairs;
use super::sequential::run_sequential;
use super::truncation::truncate;
use super::watch::Watch;
use super::{Provenance, StudyError};
use crate::assembly::{Exchange, Gather, Measurement, System, assemble_watched};
use crate::basis::{Bundles, Resolution};
use crate::linalg::{Block, LinearOperator};
use crate::oracle;
use crate::scene::Scene;
use crate::solver::{self, Solver};
use std::time::Instant;

/// What is varied and what is held. No defaults here: these numbers are the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct StudySettings {
    /// Of the finest mesh; the refinement levels double it.
    pub resolution: Resolution,
    /// Names of the methods that solve it, a direct one first: the reference.
    pub solvers: Vec<String>,
    /// Names of the random methods, see [`choose_estimators`](super::choose_estimators); the path tracer runs in any case, as the continuous
    /// truth.
    pub estimators: Vec<String>,
    /// Meshes compared, the finest included; three show an order.
    pub n_levels: usize,
    /// On ‖E + K L − L‖∞ / ‖E‖∞ of every iterative solver.
    pub tolerance: f64,
    /// Albedos in [0, 1) at which all that reflects is looked at as well; may be empty.
    pub albedos: Vec<f64>,
    /// Products after which a method is stopped there.
    pub albedo_budget: f64,
    pub exchange: Exchange,
    /// Samples a bundle of the walks on the matrix: 1, 4, 16, … up to this.
    pub walk_samples: u64,
    /// Samples a bundle of the path tracer: likewise.
    pub path_samples: u64,
    /// Family-wise significance of every comparison.
    pub significance: f64,
    pub seed: u64,
    /// How the picture is gathered; scenes without a camera have none.
    pub gather: Gather,
    /// Bounces shown one by one.
    pub n_bounces: usize,
}

/// Runs the study. `watch` hears which stage is at work and how far it is.
///
/// # Errors
/// A scene that cannot be cut or assembled, or a first solve that fails: without a reference there is no study. What another method
/// refuses is recorded.
pub fn run(
    scene: &Scene,
    settings: &StudySettings,
    provenance: Provenance,
    watch: &dyn Watch,
) -> Result<StudyOutcome, StudyError> {
    check_albedos(&settings.albedos)?;
    let names = choose_estimators(&settings.estimators)?;
    let mut stages = Stages { watch, seconds: Vec::new() };

    // Assemble the finest mesh, and hold it to the four laws.
    let bundles = Bundles::new(scene, settings.resolution)?;
    let system = stages.time("assemble", |progress| assemble_watched(scene, &bundles, settings.exchange, progress))?;
    let laws = system.laws();

    // Solve it by every method.
    let methods: Vec<_> = settings.solvers.iter().filter_map(|name| solver::named(name, settings.tolerance)).collect();
    let sensor = stages.time("measure", |_| LinearSensor::of(scene, &bundles, &system));
    let solved = stages.time("solve", |progress| solve_all(&methods, &system, &sensor, progress))?;
    let Solved { reference_solver, truth, duality, runs: solvers } = solved;
    let albedos = if settings.albedos.is_empty() {
        None
    } else {
        let (albedos, tolerance, budget) = (&settings.albedos, settings.tolerance, settings.albedo_budget);
        let study = stages
            .time("albedos", |progress| albedo_study(&system, &methods, albedos, tolerance, budget, &progress))?;
        Some(study)
    };
    let repairs = stages.time("repairs", |progress| repairs::compare(&system, settings.tolerance, &truth, progress));
    let truncation = stages.time("truncate", |_| truncate(&system, &truth, 60));

    // Estimate it by every estimator, walks against the matrix and paths against the scene.
    let roster = stages.time("build tables", |_| Roster::new(scene, &bundles, &system, &truth));
    let (mut estimators, mut sampled, mut reference) = (Vec::new(), Vec::new(), None);
    for name in names.iter().filter(|name| *name != SEQUENTIAL) {
        match stages.time(name, |progress| estimate_growing(&roster, name, settings, progress)) {
            Ok(Estimated { run, surfaces }) => {
                estimators.push(run);
                sampled.push(surfaces.clone());
                reference = surfaces.filter(|_| name == REFERENCE).or(reference);
            }
            // Without a continuous truth there is no study; what another method refuses is recorded.
            Err(StudyError::Estimator(refusal)) if name != REFERENCE => {
                estimators.push(EstimatorRun::refused(name, &refusal));
                sampled.push(None);
            }
            Err(error) => return Err(error),
        }
    }
    let reference = reference.ok_or(StudyError::NoEstimator)?;
    let is_sequential = names.iter().any(|name| name == SEQUENTIAL);
    let sequential =
        is_sequential.then(|| stages.time(SEQUENTIAL, |progress| run_sequential(&roster, settings, progress)));
    drop(roster);

    // Refine: the same scene on coarser meshes.
    let (refinement, finest) =
        stages.time("refine", |progress| -> Result<(Refinement, LevelSolution), StudyError> {
            let mut levels = Vec::new();
            for k in (1..settings.n_levels).rev() {
                // Where facets are smaller than patches, a coarser mesh is the same mesh and shows nothing.
                let patch_size = settings.resolution.patch_size * (1u64 << k) as f64;
                let resolution = Resolution { patch_size, ..settings.resolution };
                let finer = levels.last().map_or(0, |level: &LevelSolution| level.n_bundles);
                if !patch_size.is_finite() || Bundles::count(scene, resolution)? <= finer {
                    continue;
                }
                let coarse = Bundles::new(scene, resolution)?;
                if coarse.n_bundles() >= bundles.n_bundles() {
                    continue;
                }
                // Each level costs some sixteen times the one before.
                let share = |done: f64| progress(done * 16f64.powi(1 - k as i32));
                let coarse_system = assemble_watched(scene, &coarse, settings.exchange, &share)?;
                let solution = solver::Cg { tolerance: settings.tolerance }.solve(coarse_system.equation(), &mut ())?;
                levels.push(LevelSolution::new(scene, &coarse, &solution.radiance, coarse_system.emission()));
            }
            let finest = LevelSolution::new(scene, &bundles, &truth, system.emission());
            levels.push(finest.clone());
            let (emission, significance) = (system.emission(), settings.significance);
            Ok((refinement::compare(scene, &bundles, &levels, &reference, emission, significance), finest))
        })?;
    for (run, sample) in estimators.iter_mut().zip(&sampled) {
        let Some(sample) = sample else { continue };
        let other = (![REFERENCE, UNBOUNDED].contains(&run.estimator.as_str())).then_some(&reference);
        run.mesh = Some(refinement::hold(scene, &refinement, &finest, sample, other, settings.significance));
    }

    let pictures = Measurement::new(scene, &bundles, settings.gather).map(|measurement| {
        stages.time("gather", |progress| picture(&measurement, &system, &truth, settings.n_bounces, progress))
    });

    Ok(StudyOutcome {
        scene: scene.name().to_string(),
        provenance,
        n_bundles: bundles.n_bundles(),
        bands: scene.bands().to_vec(),
        tessellations: tessellations(scene),
        exchange: summarise(&system, &repairs),
        laws: laws.into(),
        repairs,
        reference_solver,
        solvers,
        duality,
        albedos,
        truncation,
        estimators,
        sequential,
        refinement,
        stages: stages.seconds,
        pictures,
    })
}

/// Times stages and tells who watches.
struct Stages<'a> {
    watch: &'a dyn Watch,
    seconds: Vec<(String, f64)>,
}

impl Stages<'_> {
    fn time<T>(&mut self, stage: &str, work: impl FnOnce(&(dyn Fn(f64) + Sync)) -> T) -> T {
        let start = Instant::now();
        let watch = self.watch;
        watch.progress(stage, 0.0);
        let result = work(&|done| watch.progress(stage, done));
        watch.progress(stage, 1.0);
        self.seconds.push((stage.to_string(), start.elapsed().as_secs_f64()));
        result
    }
}

/// One sentence for every curved shape that was replaced by polygons.
pub fn tessellations(scene: &Scene) -> Vec<String> {
    let sentence = |surface: &crate::scene::Surface| {
        surface.tessellation.as_ref().map(|t| {
            let (name, shape, n, deviation) = (&surface.name, t.shape, t.n_polygons, t.deviation);
            format!("{shape} '{name}' stands as {n} polygons, at most {deviation:.2e} m off")
        })
    };
    scene.surfaces().iter().filter_map(sentence).collect()
}

/// The solved picture, and the same after 0, 1, 2, … bounces: E + W L.
fn picture(
    measurement: &Measurement,
    system: &System,
    truth: &Block,
    n_bounces: usize,
    progress: &(dyn Fn(f64) + Sync),
) -> Pictures {
    // W adds a bounce, so the picture after k bounces shows the field after k − 1; that after none is the emission seen.
    let mut fields = vec![system.emission().clone()];
    let mut term = system.emission().clone();
    let mut next = Block::zeros(term.n_rows(), term.n_columns());
    for _ in 1..n_bounces {
        system.transport().apply(&term, &mut next);
        std::mem::swap(&mut term, &mut next);
        let mut sum = fields[fields.len() - 1].clone();
        sum.add_scaled(1.0, &term);
        fields.push(sum);
    }
    let mut all: Vec<&Block> = fields.iter().collect();
    all.push(truth);
    let mut images = oracle::pictures(measurement, &all, progress);
    let solved = images.pop().expect("one picture a field");
    Pictures { solved, bounces: images }
}

/// What the report says of T, the change that its repair made in L included.
fn summarise(system: &System, repairs: &[RepairRun]) -> ExchangeSummary {
    let report = system.report();
    let all: f64 = system.etendue().iter().sum();
    ExchangeSummary {
        n_pairs: report.n_pairs,
        n_unoccluded: report.n_clear,
        n_by_clusters: report.n_by_clusters,
        n_integrated: report.n_integrated,
        n_sampled: report.n_sampled,
        n_hidden: report.n_hidden,
        quadrature_error: report.quadrature_error,
        visibility_error: report.visibility_error,
        closure_before_repair: report.closure_before_repair,
        repair_sweeps: report.repair.map_or(0, |repair| repair.sweeps),
        repair_change: report.repair.and(repairs.first()).map_or(0.0, |used| used.change),
        escaped: system.sinks().column(0).iter().sum::<f64>() / all,
    }
}
