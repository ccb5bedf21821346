//! A study as tables to read.

use crate::study::{AlbedoStudy, Duality, EstimatorRun, Refinement, SolverRun, StudyOutcome};
use std::path::Path;

/// What a person wants to know first.
pub fn summary(outcome: &StudyOutcome, folder: &Path) -> String {
    let mut parts = vec![solvers(&outcome.solvers), duality(&outcome.duality)];
    parts.extend(outcome.albedos.as_ref().map(albedos));
    parts.push(estimators(&outcome.estimators));
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
    let mut text = format!("{:26} {:>9} {:>10} {:>10} {:>10}\n", "estimator", "slope", "seconds", "worst |z|", "p");
    for run in runs {
        let name = format!("{} ({})", run.estimator, run.truth);
        text += &format!(
            "{name:26} {:>9.2} {:>10.3} {:>10.2} {:>10.1e}\n",
            run.slope, run.seconds, run.worst_z, run.p_value
        );
    }
    text
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
