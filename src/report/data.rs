//! The numbers behind the figures and tables, as CSV.

use super::csv::{Csv, Field};
use crate::study::{
    AlbedoStudy, BandSpectrum, EstimatorRun, MeshAgreement, Refinement, SequentialRun, SolverRun, Truncation,
    VarianceAgreement,
};

/// One row an iteration; what was not predicted is empty.
pub fn convergence(solvers: &[SolverRun]) -> Vec<u8> {
    let mut csv = Csv::new(&["solver", "iteration", "products", "seconds", "residual", "error", "predicted_error"]);
    for run in solvers {
        for (i, p) in run.history.iter().enumerate() {
            let [products, seconds, residual, error] = [p.products, p.seconds, p.residual, p.error].map(Field::Number);
            let predicted = p.predicted.map_or(Field::Text(""), Field::Number);
            csv.row(&[Field::Text(&run.solver), Field::Count(i as u64), products, seconds, residual, error, predicted]);
        }
    }
    csv.into_bytes()
}

/// One row a solver; an absent bound, and what a method that refused has none of, is empty.
pub fn solvers(solvers: &[SolverRun]) -> Vec<u8> {
    let mut csv = Csv::new(&[
        "solver",
        "kind",
        "stop",
        "n_applies",
        "n_adjoint_applies",
        "products",
        "seconds",
        "true_residual",
        "error",
        "error_bound",
        "adjoint_products",
        "adjoint_seconds",
        "duality_difference",
    ]);
    for run in solvers {
        csv.row(&[
            Field::Text(&run.solver),
            Field::Text(&run.kind),
            Field::Text(&run.stop),
            Field::Count(run.n_applies as u64),
            Field::Count(run.n_adjoint_applies as u64),
            Field::Number(run.products),
            Field::Number(run.seconds),
            Field::Number(run.true_residual),
            Field::Number(run.error),
            optional(run.error_bound),
            optional(run.adjoint.as_ref().map(|adjoint| adjoint.products)),
            optional(run.adjoint.as_ref().map(|adjoint| adjoint.seconds)),
            optional(run.adjoint.as_ref().map(|adjoint| adjoint.difference)),
        ]);
    }
    csv.into_bytes()
}

/// One row a method and albedo.
pub fn albedos(study: &AlbedoStudy) -> Vec<u8> {
    let mut csv = Csv::new(&["albedo", "solver", "kind", "stop", "products", "seconds", "true_residual", "error"]);
    for level in &study.levels {
        for run in &level.runs {
            let [products, seconds, residual, error] =
                [run.products, run.seconds, run.true_residual, run.error].map(Field::Number);
            csv.row(&[
                Field::Number(level.albedo),
                Field::Text(&run.solver),
                Field::Text(&run.kind),
                Field::Text(&run.stop),
                products,
                seconds,
                residual,
                error,
            ]);
        }
    }
    csv.into_bytes()
}

/// band, real, imaginary, radius: one row an eigenvalue.
pub fn spectrum(bands: &[BandSpectrum]) -> Vec<u8> {
    let mut csv = Csv::new(&["band", "real", "imaginary", "radius"]);
    for band in bands {
        for [re, im] in &band.eigenvalues {
            csv.row(&[Field::Text(&band.band), Field::Number(*re), Field::Number(*im), Field::Number(band.radius[1])]);
        }
    }
    csv.into_bytes()
}

/// bounces, error, bound.
pub fn truncation(series: &[Truncation]) -> Vec<u8> {
    let mut csv = Csv::new(&["bounces", "error", "bound"]);
    for t in series {
        csv.row(&[Field::Count(t.bounces as u64), Field::Number(t.error), Field::Number(t.bound)]);
    }
    csv.into_bytes()
}

/// One row an estimator and sample count; what was not predicted is empty.
pub fn monte_carlo(estimators: &[EstimatorRun]) -> Vec<u8> {
    let mut csv = Csv::new(&[
        "estimator",
        "truth",
        "samples_per_bundle",
        "error",
        "standard_error",
        "predicted_standard_error",
        "steps",
        "seconds",
    ]);
    for run in estimators {
        for p in &run.points {
            let [error, standard_error, seconds] = [p.error, p.standard_error, p.seconds].map(Field::Number);
            csv.row(&[
                Field::Text(&run.estimator),
                Field::Text(&run.truth),
                Field::Count(p.samples_per_bundle),
                error,
                standard_error,
                optional(p.predicted),
                Field::Count(p.steps),
                seconds,
            ]);
        }
    }
    csv.into_bytes()
}

/// One row an estimator; what does not apply to it is empty.
pub fn estimators(estimators: &[EstimatorRun]) -> Vec<u8> {
    let mut csv = Csv::new(&[
        "estimator",
        "truth",
        "slope",
        "seconds_slope",
        "efficiency",
        "samples_for_percent",
        "variance_ratio",
        "variance_ratio_standard_error",
        "variance_p_value",
        "worst_z",
        "degrees_of_freedom",
        "n_comparisons",
        "p_value",
        "difference_from_matrix",
        "difference_noise",
        "p_value_against_path_tracer",
        "seconds",
    ]);
    for run in estimators {
        let variance = |of: &dyn Fn(&VarianceAgreement) -> f64| optional(run.variance.as_ref().map(of));
        let mesh = |of: &dyn Fn(&MeshAgreement) -> Option<f64>| optional(run.mesh.as_ref().and_then(of));
        csv.row(&[
            Field::Text(&run.estimator),
            Field::Text(&run.truth),
            Field::Number(run.slope),
            Field::Number(run.seconds_slope),
            Field::Number(run.efficiency),
            Field::Number(run.samples_for_percent),
            variance(&|v| v.ratio),
            variance(&|v| v.standard_error),
            variance(&|v| v.p_value),
            Field::Number(run.worst_z),
            optional(run.n_degrees_of_freedom),
            Field::Count(run.n_comparisons as u64),
            Field::Number(run.p_value),
            mesh(&|m| Some(m.difference)),
            mesh(&|m| Some(m.noise)),
            mesh(&|m| m.p_value),
            Field::Number(run.seconds),
        ]);
    }
    csv.into_bytes()
}

/// products, steps, seconds, residual, error: one row a stage.
pub fn sequential(run: &SequentialRun) -> Vec<u8> {
    let mut csv = Csv::new(&["products", "steps", "seconds", "residual", "error"]);
    for stage in &run.stages {
        let [seconds, residual, error] = [stage.seconds, stage.residual, stage.error].map(Field::Number);
        csv.row(&[Field::Count(stage.products as u64), Field::Count(stage.steps), seconds, residual, error]);
    }
    csv.into_bytes()
}

/// What is absent is empty.
fn optional(value: Option<f64>) -> Field<'static> {
    value.map_or(Field::Text(""), Field::Number)
}

/// patch_size, n_bundles, error, noise: one row a level.
pub fn refinement(study: &Refinement) -> Vec<u8> {
    let mut csv = Csv::new(&["patch_size", "n_bundles", "error", "noise"]);
    for l in &study.levels {
        let [patch_size, error, noise] = [l.patch_size, l.error, l.noise].map(Field::Number);
        csv.row(&[patch_size, Field::Count(l.n_bundles as u64), error, noise]);
    }
    csv.into_bytes()
}

/// surface, band, matrix, path_tracer, standard_error, discretisation_error.
pub fn surfaces(study: &Refinement) -> Vec<u8> {
    let mut csv = Csv::new(&["surface", "band", "matrix", "path_tracer", "standard_error", "discretisation_error"]);
    for s in &study.surfaces {
        let [matrix, paths, noise, mesh] =
            [s.matrix, s.path_tracer, s.standard_error, s.discretisation_error].map(Field::Number);
        csv.row(&[Field::Text(&s.surface), Field::Text(&s.band), matrix, paths, noise, mesh]);
    }
    csv.into_bytes()
}
