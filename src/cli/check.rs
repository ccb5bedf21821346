//! `etendue check`: reference cases, answered and judged, as a table or as JSON.

use super::arguments::{Arguments, Check};
use super::exit::{Exit, Failure};
use super::output;
use super::progress::Bars;
use crate::gallery;
use crate::oracle::cases::{self, Case, Outcome, Value, Verdict};
use crate::study::Watch;
use serde::Serialize;
use std::collections::BTreeMap;

/// What `check --json` prints.
#[derive(Serialize)]
struct Record<'a> {
    schema: &'static str,
    n_passed: usize,
    n_failed: usize,
    n_skipped: usize,
    cases: Vec<CaseRecord<'a>>,
}

/// One case. `error`, `allowed` and `estimate` are absolute and those of the value that came off worst, named by `worst`.
#[derive(Serialize)]
struct CaseRecord<'a> {
    id: &'a str,
    group: &'a str,
    family: &'a str,
    verdict: &'static str,
    computed: &'a BTreeMap<String, Value>,
    reference: &'a BTreeMap<String, Value>,
    error: Option<f64>,
    allowed: Option<f64>,
    estimate: Option<f64>,
    worst: Option<&'a str>,
    reason: Option<&'a str>,
    needs: Option<&'a str>,
    seconds: f64,
}

pub fn run(arguments: &Arguments, check: &Check) -> Result<(), Failure> {
    let chosen = choose(check)?;
    let bars = Bars::new(arguments);
    let mut outcomes = Vec::with_capacity(chosen.len());
    for (k, case) in chosen.iter().enumerate() {
        outcomes.push(cases::run(case));
        bars.progress("check", (k + 1) as f64 / chosen.len() as f64);
    }
    drop(bars);

    let count = |wanted: fn(&Verdict) -> bool| outcomes.iter().filter(|outcome| wanted(&outcome.verdict)).count();
    let n_passed = count(|verdict| matches!(verdict, Verdict::Pass));
    let n_failed = count(|verdict| matches!(verdict, Verdict::Fail(_)));
    let n_skipped = count(|verdict| matches!(verdict, Verdict::Skipped(_)));
    if arguments.json {
        let cases = outcomes.iter().map(record).collect();
        let record = Record { schema: "etendue.check/1", n_passed, n_failed, n_skipped, cases };
        let text = serde_json::to_string(&record).map_err(|e| Failure::new(Exit::Internal, e.to_string()))?;
        output::print(&(text + "\n"))?;
    } else {
        let mut text = table(&outcomes);
        text += &format!("\n{n_passed} passed, {n_failed} failed, {n_skipped} skipped\n");
        output::print(&text)?;
    }
    match n_failed {
        0 => Ok(()),
        _ => Err(Failure::new(Exit::Check, format!("{n_failed} of {} cases failed", outcomes.len()))),
    }
}

/// The cases of the file, or of the gallery, that were asked for.
fn choose(check: &Check) -> Result<Vec<Case>, Failure> {
    let (name, text) = match &check.file {
        None => ("the gallery".to_string(), gallery::CASES.to_string()),
        Some(path) => {
            let name = path.display().to_string();
            let text = std::fs::read_to_string(path)
                .map_err(|error| Failure::new(Exit::Input, format!("cannot read '{name}': {error}")))?;
            (name, text)
        }
    };
    let all = cases::read(&text).map_err(|error| Failure::new(Exit::Input, format!("{name}: {error}")))?;
    for id in &check.id {
        if !all.iter().any(|case| case.id == *id) {
            return Err(Failure::new(Exit::Input, format!("{name}: there is no case '{id}'")));
        }
    }
    for group in &check.group {
        if !all.iter().any(|case| case.group == *group) {
            return Err(Failure::new(Exit::Input, format!("{name}: there is no case of group '{group}'")));
        }
    }
    let wanted = |case: &Case| {
        (check.id.is_empty() || check.id.contains(&case.id))
            && (check.group.is_empty() || check.group.contains(&case.group))
    };
    Ok(all.into_iter().filter(wanted).collect())
}

fn record(outcome: &Outcome) -> CaseRecord<'_> {
    let (verdict, reason, needs) = match &outcome.verdict {
        Verdict::Pass => ("pass", None, None),
        Verdict::Fail(reason) => ("fail", reason.as_deref(), None),
        Verdict::Skipped(needs) => ("skipped", None, Some(needs.as_str())),
    };
    CaseRecord {
        id: &outcome.id,
        group: &outcome.group,
        family: &outcome.family,
        verdict,
        computed: &outcome.computed,
        reference: &outcome.reference,
        error: outcome.error.filter(|error| error.is_finite()),
        allowed: outcome.allowed.filter(|allowed| allowed.is_finite()),
        estimate: outcome.estimate.filter(|estimate| estimate.is_finite()),
        worst: outcome.worst.as_deref(),
        reason,
        needs,
        seconds: outcome.seconds,
    }
}

/// A line a case: the value that came off worst, and the verdict.
fn table(outcomes: &[Outcome]) -> String {
    let width = outcomes.iter().map(|outcome| outcome.id.chars().count()).max().unwrap_or(0).max(4);
    let head = ["computed", "reference", "error", "allowed", "estimate", "seconds"];
    let [computed, reference, error, allowed, estimate, seconds] = head;
    let mut text = format!(
        "{:width$}  {computed:>19}  {reference:>19}  {error:>8}  {allowed:>8}  {estimate:>8}  {seconds:>7}  verdict\n",
        "case"
    );
    for outcome in outcomes {
        let number = |values: &BTreeMap<String, Value>| {
            let value = outcome.worst.as_ref().and_then(|worst| values.get(worst));
            match value {
                Some(Value::Number(number)) => format!("{number:.12e}"),
                Some(Value::List(items)) => format!("[{} numbers]", items.len()),
                _ => "-".to_string(),
            }
        };
        let small = |number: Option<f64>| number.map_or("-".to_string(), |number| format!("{number:.1e}"));
        let worst = outcome.worst.as_deref().map(|worst| format!(" ({worst})")).unwrap_or_default();
        let verdict = match &outcome.verdict {
            Verdict::Pass => format!("pass{worst}"),
            Verdict::Fail(None) => format!("FAIL{worst}"),
            Verdict::Fail(Some(reason)) => format!("FAIL: {reason}"),
            Verdict::Skipped(needs) => format!("skipped: needs {needs}"),
        };
        text += &format!(
            "{:width$}  {:>19}  {:>19}  {:>8}  {:>8}  {:>8}  {:7.3}  {verdict}\n",
            outcome.id,
            number(&outcome.computed),
            number(&outcome.reference),
            small(outcome.error),
            small(outcome.allowed),
            small(outcome.estimate),
            outcome.seconds
        );
    }
    text
}
