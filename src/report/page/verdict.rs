//! The result in one sentence.

use crate::report::number::{count, significant, with_error};
use crate::study::{EstimatorRun, StudyOutcome};

/// Walks on the matrix whose p-value (already corrected for the number of comparisons) is below this disagree with it.
pub const SIGNIFICANCE: f64 = 1e-6;

/// "2 436 ray bundles; all 8 solvers agree to 1.2×10⁻¹³; the walks on the matrix agree with it (p = 0.17); …"
pub fn sentence(outcome: &StudyOutcome) -> String {
    let parts = [solvers(outcome), walks(outcome), refinement(outcome)];
    let mut text = parts.into_iter().flatten().collect::<Vec<_>>().join("; ");
    if text.is_empty() {
        return "Nothing was measured.".into();
    }
    if let Some(first) = text.chars().next() {
        text.replace_range(..first.len_utf8(), &first.to_uppercase().to_string());
    }
    text + "."
}

/// Whether walks that estimate the discrete truth hit it.
pub fn agrees(run: &EstimatorRun) -> bool {
    run.n_comparisons == 0 || run.p_value >= SIGNIFICANCE
}

fn solvers(outcome: &StudyOutcome) -> Option<String> {
    // A run that ran out of budget is no claim of agreement.
    let n_all = outcome.solvers.len();
    let finished: Vec<_> =
        outcome.solvers.iter().filter(|run| ["direct", "converged"].contains(&run.stop.as_str())).collect();
    let worst = finished.iter().map(|run| run.error).filter(|e| !e.is_nan()).reduce(f64::max)?;
    let who = match finished.len() {
        1 if n_all == 1 => "the one solver".into(),
        n if n == n_all => format!("all {n} solvers"),
        n => format!("{n} of {n_all} solvers finished and"),
    };
    let verb = if n_all == 1 { "is accurate" } else { "agree" };
    Some(format!("on {} ray bundles, {who} {verb} to {}", count(outcome.n_bundles as u64), significant(worst, 2)))
}

fn walks(outcome: &StudyOutcome) -> Option<String> {
    let discrete = || outcome.estimators.iter().filter(|run| run.truth == "discrete" && run.refusal.is_none());
    let least = discrete().map(|run| run.p_value).filter(|p| !p.is_nan()).reduce(f64::min)?;
    let verb = if discrete().all(agrees) { "agree" } else { "disagree" };
    Some(format!("random walks on the matrix {verb} with them (least p = {})", significant(least, 2)))
}

fn refinement(outcome: &StudyOutcome) -> Option<String> {
    let study = &outcome.refinement;
    let finest = study.levels.last()?;
    if study.levels.len() < 2 {
        let apart = percent(finest.error);
        return Some(format!(
            "the path tracer, which knows no patches, differs by {apart}; one mesh alone tells no discretisation error"
        ));
    }
    let agreement = if study.agrees { "within" } else { "more than" };
    let order = if study.observed_order.is_finite() {
        format!(
            ", and the difference shrinks with the patches at order {}",
            with_error(study.observed_order, study.order_standard_error)
        )
    } else {
        String::new()
    };
    Some(format!(
        "the path tracer, which knows no patches, differs by {} at the finest, {agreement} the estimated discretisation and statistical \
         errors{order}",
        percent(finest.error)
    ))
}

/// A relative number as per cent.
pub fn percent(value: f64) -> String {
    format!("{}\u{a0}%", significant(100.0 * value, 2))
}
