//! Random answers: what they came to, whether they are right, and what their error bars were worth.

use super::markup::{Column, Table, section};
use super::verdict::{SIGNIFICANCE, agrees, percent};
use super::{FigureOnPage, figure};
use crate::report::number::{count, seconds, significant};
use crate::study::{EstimatorRun, SequentialRun, StudyOutcome, UNBOUNDED, VarianceAgreement};

/// Largest count that is written out.
const MOST_WRITTEN: f64 = 1e15;

/// Both figures, the table of costs and that of verdicts.
pub fn estimators(outcome: &StudyOutcome, on_page: &FigureOnPage, stages: Option<&FigureOnPage>) -> String {
    let lead = "Walks on the matrix estimate the discrete truth and must hit it within their own error bars, which a linear system foretells before a \
                walk is drawn. Light paths never see the matrix: they estimate the continuous truth, and their distance from the matrix levels \
                off at the discretisation error, the same for all of them.";
    let shown = figure(
        on_page,
        "Error of every estimator against samples per bundle and against seconds, logarithmic, beside its standard error, foretold or measured, and a line of slope minus one half",
        "Étendue-weighted root mean square difference from the discrete solution (markers), and the standard error (lines): solid where the variance's own \
         linear system foretold it, dashed where the samples say it of themselves. Grey: the methods of the other panels.",
    );
    let refusals = outcome.estimators.iter().filter_map(|run| Some((&run.estimator, run.refusal.as_ref()?)));
    let refusals: String = refusals.map(|(name, refusal)| format!(" {name} was refused: {refusal}.")).collect();
    let unforeseen =
        outcome.estimators.iter().filter_map(|run| Some((&run.estimator, run.prediction_refusal.as_ref()?)));
    let unforeseen: String = unforeseen.map(|(name, why)| format!(" {name} is not foretold: {why}.")).collect();
    let costs = costs(&outcome.estimators).html(&format!(
        "Errors relative, at the largest sample count. Efficiency is 1 / (relative variance × seconds); the samples a bundle for 1 % are foretold \
         where there is a theory, else carried on from what was measured.{unforeseen}{refusals}"
    ));
    let verdicts = verdicts(outcome).html(&format!(
        "z against the matrix of bundles pooled with their neighbours until each comparison rests on 400 expected scores; t(ν) where the error bars rest \
         on ν + 1 batches or replicates. p is the probability of one this large, corrected for their number (Šidák), and below {} the verdict is \
         disagreement. Variance: measured over foretold.",
        significant(SIGNIFICANCE, 1)
    ));
    let mesh = mesh(outcome);
    let staged = outcome.sequential.as_ref().map(|run| sequential(run, stages)).unwrap_or_default();
    section("estimators", "Random answers", lead, &(shown + &costs + &verdicts + &mesh + &staged))
}

/// What each came to, and what it took.
fn costs(runs: &[EstimatorRun]) -> Table {
    use Column::{Numbers, Words};
    let mut table = Table::new(&[
        ("estimator", Words),
        ("truth", Words),
        ("samples a bundle", Numbers),
        ("steps", Numbers),
        ("time", Numbers),
        ("error", Numbers),
        ("standard error", Numbers),
        ("foretold", Numbers),
        ("slope by samples", Numbers),
        ("by time", Numbers),
        ("efficiency, s⁻¹", Numbers),
        ("samples for 1 %", Numbers),
    ]);
    for run in runs {
        let last = run.points.last();
        let number = |value: Option<f64>| value.map_or("—".into(), |v| significant(v, 2));
        let samples = match run.samples_for_percent {
            n if n.is_finite() && (0.0..MOST_WRITTEN).contains(&n) => count(n as u64),
            n => significant(n, 2),
        };
        table.row(&[
            &run.estimator,
            &run.truth,
            &last.map_or("—".into(), |p| count(p.samples_per_bundle)),
            &last.map_or("—".into(), |p| count(p.steps)),
            &if run.refusal.is_some() { "refused".into() } else { seconds(run.seconds) },
            &number(last.map(|p| p.error)),
            &number(last.map(|p| p.standard_error)),
            &number(last.and_then(|p| p.predicted)),
            &significant(run.slope, 3),
            &significant(run.seconds_slope, 3),
            &significant(run.efficiency, 2),
            &samples,
        ]);
    }
    table
}

/// Whether each is right, and its variance what it was foretold to be.
fn verdicts(outcome: &StudyOutcome) -> Table {
    use Column::{Numbers, Words};
    let mut table = Table::new(&[
        ("estimator", Words),
        ("largest |z|", Numbers),
        ("of", Numbers),
        ("p", Numbers),
        ("against the matrix", Words),
        ("variance", Numbers),
        ("p", Numbers),
        ("error bars", Words),
    ]);
    for run in &outcome.estimators {
        let z = match run.n_degrees_of_freedom {
            Some(degrees) => format!("{}, t({degrees:.0})", significant(run.worst_z, 3)),
            None => significant(run.worst_z, 3),
        };
        let variance = run.variance.as_ref();
        let ratio =
            |v: &VarianceAgreement| format!("{} ± {}", significant(v.ratio, 4), significant(v.standard_error, 2));
        let kept = |p: f64| if p >= SIGNIFICANCE { "as foretold" } else { "not as foretold" };
        table.row(&[
            &run.estimator,
            &z,
            &count(run.n_comparisons as u64),
            &significant(run.p_value, 2),
            verdict(run),
            &variance.map_or("—".into(), ratio),
            &variance.map_or("—".into(), |v| significant(v.p_value, 2)),
            variance.map_or("—", |v| kept(v.p_value)),
        ]);
    }
    table
}

fn verdict(run: &EstimatorRun) -> &'static str {
    match (run.truth.as_str(), agrees(run)) {
        _ if run.refusal.is_some() => "refused",
        _ if run.n_comparisons == 0 => "too few samples to tell",
        ("discrete", true) => "agrees",
        ("discrete", false) => "disagrees",
        (_, true) => "mesh not yet visible",
        (_, false) => "mesh visible",
    }
}

/// What the continuous methods see of the mesh: it must be the same for all, and what the refinement says.
fn mesh(outcome: &StudyOutcome) -> String {
    use Column::{Numbers, Words};
    let mut table = Table::new(&[
        ("light paths", Words),
        ("off the matrix", Numbers),
        ("of it noise", Numbers),
        ("discretisation error", Numbers),
        ("every surface within both", Words),
        ("|t| against path tracer", Numbers),
        ("p", Numbers),
    ]);
    let runs: Vec<_> = outcome.estimators.iter().filter_map(|run| Some((run, run.mesh.as_ref()?))).collect();
    if runs.is_empty() {
        return String::new();
    }
    let estimate = outcome.refinement.finest_error;
    let is_known = outcome.refinement.levels.len() > 1;
    for (run, mesh) in &runs {
        let number = |value: Option<f64>| value.map_or("—".into(), |v| significant(v, 2));
        table.row(&[
            &run.estimator,
            &percent(mesh.difference),
            &percent(mesh.noise),
            &if is_known { percent(estimate) } else { "—".into() },
            match (is_known, mesh.agrees) {
                (false, _) => "one mesh tells none",
                (true, true) => "yes",
                (true, false) => "no",
            },
            &number(mesh.worst_t),
            &number(mesh.p_value),
        ]);
    }
    let same = runs.iter().filter_map(|(_, mesh)| mesh.p_value).all(|p| p >= SIGNIFICANCE);
    let finding = match (runs.len() > 1, same) {
        (false, _) => "",
        (true, true) => "The methods agree with one another: ",
        (true, false) => "The methods disagree with one another, which no mesh explains: ",
    };
    let unbounded = if runs.iter().any(|(run, _)| run.estimator == UNBOUNDED) {
        " Points drawn on emitters alone have infinite variance where a lamp touches what it lights: no error bar of theirs holds."
    } else {
        ""
    };
    table.html(&format!(
        "Mean reflected radiance of surfaces. {finding}how far they are off the matrix, noise taken out, is the discretisation error, which the refinement \
         below estimates by other means.{unbounded}"
    ))
}

/// The one whose answer is corrected stage by stage.
fn sequential(run: &SequentialRun, on_page: Option<&FigureOnPage>) -> String {
    let text = match (&run.refusal, run.stages.last()) {
        (Some(refusal), _) => format!("Sequential Monte Carlo was refused: {refusal}."),
        (None, None) => "Sequential Monte Carlo ran no stage.".into(),
        (None, Some(last)) => format!(
            "Sequential Monte Carlo ({}): {} walks a bundle on what is left, again and again. Every stage multiplies the error by {}; \
             {} stages in {} leave {} ({}).",
            run.estimator,
            count(run.n_walks),
            significant(run.factor, 2),
            count(run.stages.len() as u64),
            seconds(run.seconds),
            significant(last.error, 2),
            run.stop
        ),
    };
    match on_page {
        Some(on_page) => figure(on_page, "Error of sequential Monte Carlo after every stage, logarithmic", &text),
        None => format!("<p>{}</p>\n", super::markup::escape(&text)),
    }
}
