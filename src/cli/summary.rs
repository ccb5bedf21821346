//! A study as tables to read.

use crate::study::{AlbedoStudy, Duality, EstimatorRun, Refinement, SequentialRun, SolverRun, StudyOutcome};
use std::path::Path;

/// What a person wants to know first.
pub fn summary(outcome: &StudyOutcome, folder: &Path) -> String {
    let mut parts = vec![solvers(&outcome.solvers), duality(&outcome.duality)];
    parts.extend(outcome.albedos.as_ref().map(albedos));
    parts.push(estimators(&outcome.estimators));
    parts.extend(outcome.sequential.as_ref().map(sequential));
    parts.push(format!("matrix against path tracer: {}\n", finding(&outcome.refinement)));
    parts.push(format!("{}\n", folder.join("report.html").display()));
    parts.join("\n")
}

fn solvers(runs: &[SolverRun]) -> String {
    let width = name_width(runs);
    let mut text = format!(
        "{:width$} {:>9} {:>10} {:>10} {:>10} {:>10}\n",
        "solver", "products", "seconds", "residual", "error", "duality"
    );
    for run in runs {
        let dual = run.adjoint.as_ref().map_or("–".to_string(), |adjoint| format!("{:.1e}", adjoint.difference));
        text += &format!(
            "{:width$} {:>9} {:>10.3} {:>10.1e} {:>10.1e} {dual:>10}  {}\n",
            run.solver,
            products(run),
            run.seconds,
            run.true_residual,
            run.error,
            run.stop
        );
        run.refusal.iter().for_each(|refusal| text += &format!("{:width$}   {refusal}\n", ""));
    }
    text
}

/// Both sides of a reading, and how far they are apart.
pub fn duality(duality: &Duality) -> String {
    let Duality { sensor, unit, solver, reading, dual_reading, difference, .. } = duality;
    let numbers = |values: &[f64]| values.iter().map(|v| format!("{v:>14.6e}")).collect::<String>();
    format!(
        "duality by {solver}: {sensor}, {unit}\n  ⟨W, L⟩{}\n  ⟨E, J⟩{}  ({difference:.1e} apart)\n",
        numbers(reading),
        numbers(dual_reading)
    )
}

/// Products of every method at every albedo; of direct methods nothing is counted.
fn albedos(study: &AlbedoStudy) -> String {
    let Some(first) = study.levels.first() else { return String::new() };
    let width = name_width(&first.runs);
    let head: String = study.levels.iter().map(|level| format!("{:>18}", level.albedo)).collect();
    let mut text = format!("products and error against {} at albedo\n{:width$}{head}\n", study.reference_solver, "");
    for (k, run) in first.runs.iter().enumerate() {
        text += &format!("{:width$}", run.solver);
        for level in &study.levels {
            let run = &level.runs[k];
            text += &match run.stop.as_str() {
                "refused" => format!("{:>18}", "refused"),
                "direct" | "converged" => format!("{:>9} {:>8.1e}", products(run), run.error),
                "budget" => format!("{:>9} {:>8.1e}", format!(">{:.0}", study.budget), run.error),
                stop => format!("{stop:>9} {:>8.1e}", run.error),
            };
        }
        text += "\n";
    }
    let refusals = study.levels.iter().flat_map(|level| level.runs.iter().map(move |run| (level.albedo, run)));
    for (albedo, run) in refusals {
        run.refusal.iter().for_each(|refusal| text += &format!("at {albedo}: {refusal}\n"));
    }
    text
}

fn estimators(runs: &[EstimatorRun]) -> String {
    let name = |run: &EstimatorRun| format!("{} ({})", run.estimator, run.truth);
    let width = runs.iter().map(|run| name(run).chars().count()).fold(26, usize::max);
    let mut text = format!(
        "{:width$} {:>9} {:>10} {:>9} {:>9} {:>9} {:>8} {:>10} {:>9} {:>8}\n",
        "estimator", "samples", "seconds", "error", "foretold", "slope", "|z|", "p", "1/(v s)", "N(1 %)"
    );
    for run in runs {
        if let Some(refusal) = &run.refusal {
            text += &format!("{:width$} refused: {refusal}\n", name(run));
            continue;
        }
        let last = run.points.last();
        let foretold = last.and_then(|p| p.predicted).map_or("–".to_string(), |e| format!("{e:.2e}"));
        text += &format!(
            "{:width$} {:>9} {:>10.3} {:>9.2e} {foretold:>9} {:>9.2} {:>8.2} {:>10.1e} {:>9.1e} {:>8.1e}\n",
            name(run),
            last.map_or(0, |p| p.samples_per_bundle),
            run.seconds,
            last.map_or(f64::NAN, |p| p.error),
            run.slope,
            run.worst_z,
            run.p_value,
            run.efficiency,
            run.samples_for_percent
        );
    }
    for (run, variance) in runs.iter().filter_map(|run| Some((run, run.variance.as_ref()?))) {
        text += &format!(
            "{:width$} variance {:.4} ± {:.4} of the foretold (p = {:.1e})\n",
            run.estimator, variance.ratio, variance.standard_error, variance.p_value
        );
    }
    for (run, mesh) in runs.iter().filter_map(|run| Some((run, run.mesh.as_ref()?))) {
        let other = mesh.p_value.map_or(String::new(), |p| format!(", p = {p:.1e} against the path tracer"));
        text += &format!(
            "{:width$} {:.2} % off the matrix, {:.2} % of it noise{other}\n",
            run.estimator,
            100.0 * mesh.difference,
            100.0 * mesh.noise
        );
    }
    text
}

/// How steeply its error fell, and where it ended.
fn sequential(run: &SequentialRun) -> String {
    if let Some(refusal) = &run.refusal {
        return format!("{} refused: {refusal}\n", run.estimator);
    }
    let last = run.stages.last();
    format!(
        "{}: {} stages of {} walks a bundle, {:.3} s, each × {:.2e}, error {:.1e} ({})\n",
        run.estimator,
        run.stages.len(),
        run.n_walks,
        run.seconds,
        run.factor,
        last.map_or(f64::NAN, |stage| stage.error),
        run.stop
    )
}

fn finding(refinement: &Refinement) -> String {
    let order = match refinement.observed_order {
        order if order.is_nan() => "no order observed".to_string(),
        order => format!("order {order:.2}"),
    };
    match refinement.finest_error {
        error if error.is_nan() => "one mesh alone tells no discretisation error".to_string(),
        error => {
            let verdict = if refinement.agrees { "agree" } else { "DISAGREE" };
            let n_dark = refinement.surfaces.iter().filter(|mean| !mean.is_comparable).count();
            let left_out = match n_dark {
                0 => String::new(),
                n => format!(" ({n} of {} on too few paths to tell)", refinement.surfaces.len()),
            };
            format!(
                "{order}, finest mesh {:.2} % off the continuous truth, surface means {verdict}{left_out}",
                100.0 * error
            )
        }
    }
}

fn name_width(runs: &[SolverRun]) -> usize {
    runs.iter().map(|run| run.solver.chars().count()).fold(14, usize::max)
}

/// Of direct methods and of refusals there is nothing to count.
fn products(run: &SolverRun) -> String {
    if run.kind == "direct" || run.refusal.is_some() { "–".to_string() } else { format!("{:.1}", run.products) }
}
