//! What was computed for a case, and the verdict on it.

use super::reader::Case;
use super::value::Value;
use std::collections::BTreeMap;

/// Most significant digits that are demanded of anything.
const MOST_DIGITS: u32 = 12;

/// The largest error estimate that passes where values are extrapolated.
pub const EXTRAPOLATED: f64 = 1e-6;

/// What a computed value must reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Demand {
    /// The digits that the case states as certain, at most twelve.
    Digits,
    /// The program's own estimate must be at most [`EXTRAPOLATED`] and contain the reference.
    Estimate,
}

/// Values computed for one case, each with the absolute error that the program estimates for it.
#[derive(Clone, Debug)]
pub struct Answers {
    pub demand: Demand,
    pub values: BTreeMap<String, (Value, f64)>,
}

/// A law measured: the worst defect found, and the largest that passes. Both relative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Identity {
    pub defect: f64,
    pub allowed: f64,
}

/// How a case ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    Pass,
    /// With a reason where it is not the numbers.
    Fail(Option<String>),
    /// What it needs.
    Skipped(String),
}

/// A case, answered and judged. `error`, `allowed` and `estimate` are absolute, and those of the number that came off worst.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub id: String,
    pub group: String,
    pub family: String,
    pub verdict: Verdict,
    pub computed: BTreeMap<String, Value>,
    pub reference: BTreeMap<String, Value>,
    /// |computed − reference|; `None` where nothing was compared.
    pub error: Option<f64>,
    pub allowed: Option<f64>,
    pub estimate: Option<f64>,
    /// Name of the value that came off worst.
    pub worst: Option<String>,
    pub seconds: f64,
}

impl Answers {
    pub fn new(demand: Demand) -> Self {
        Self { demand, values: BTreeMap::new() }
    }

    pub fn add(&mut self, name: impl Into<String>, value: Value, estimate: f64) {
        self.values.insert(name.into(), (value, estimate));
    }

    pub fn number(&mut self, name: impl Into<String>, value: f64, estimate: f64) {
        self.add(name, Value::Number(value), estimate);
    }
}

impl Outcome {
    /// An outcome without numbers.
    pub(super) fn blank(case: &Case, verdict: Verdict, seconds: f64) -> Self {
        Self {
            id: case.id.clone(),
            group: case.group.clone(),
            family: case.family.clone(),
            verdict,
            computed: BTreeMap::new(),
            reference: case.values.clone(),
            error: None,
            allowed: None,
            estimate: None,
            worst: None,
            seconds,
        }
    }
}

/// Holds the defect of a law against what is allowed; it stands for the case's 'tolerance', which is in words.
pub fn judge_identity(case: &Case, identity: Identity, seconds: f64) -> Outcome {
    let Identity { defect, allowed } = identity;
    let verdict = if defect <= allowed { Verdict::Pass } else { Verdict::Fail(None) };
    let name = "tolerance".to_string();
    Outcome {
        computed: BTreeMap::from([(name.clone(), Value::Number(defect))]),
        error: Some(defect),
        allowed: Some(allowed),
        worst: Some(name),
        ..Outcome::blank(case, verdict, seconds)
    }
}

/// Half a unit of the given significant digit of a number.
fn half_unit(value: f64, digits: u32) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    0.5 * 10f64.powf(value.abs().log10().floor() + 1.0 - f64::from(digits))
}

/// Holds computed values against the case's, number by number.
///
/// A reference that is zero has no significant digits: it is held to those of the largest number of its value, or of 1.
pub fn judge(case: &Case, answers: Answers, seconds: f64) -> Outcome {
    let mut outcome = Outcome::blank(case, Verdict::Pass, seconds);
    outcome.computed = answers.values.iter().map(|(name, (value, _))| (name.clone(), value.clone())).collect();
    let digits = case.digits_certain.clamp(1, MOST_DIGITS);
    let mut worst_ratio = -1.0;
    for (name, reference) in &case.values {
        let Some((computed, estimate)) = answers.values.get(name) else {
            outcome.verdict = Verdict::Fail(Some(format!("'{name}' was not computed")));
            continue;
        };
        let Some(pairs) = computed.paired(reference) else {
            outcome.verdict = Verdict::Fail(Some(format!("'{name}' has another shape than the reference")));
            continue;
        };
        let largest = pairs.iter().map(|(_, reference)| reference.abs()).fold(0.0, f64::max);
        for (computed, reference) in pairs {
            let size = match (reference != 0.0, largest > 0.0) {
                (true, _) => reference,
                (false, true) => largest,
                (false, false) => 1.0,
            };
            let stated = half_unit(size, digits).max(case.absolute_tolerance);
            let allowed = match answers.demand {
                Demand::Digits => stated,
                Demand::Estimate => estimate.min(EXTRAPOLATED) + half_unit(size, case.digits_certain.max(1)),
            };
            let error = (computed - reference).abs();
            let too_vague = answers.demand == Demand::Estimate && (estimate.is_nan() || *estimate > EXTRAPOLATED);
            let passes = error <= allowed && !too_vague;
            let ratio = if error.is_nan() { f64::INFINITY } else { error / allowed };
            let ratio = if too_vague { ratio.max(estimate / EXTRAPOLATED) } else { ratio };
            if ratio > worst_ratio || ratio.is_nan() {
                worst_ratio = ratio;
                (outcome.error, outcome.allowed) = (Some(error), Some(allowed));
                (outcome.estimate, outcome.worst) = (Some(*estimate), Some(name.clone()));
            }
            if !passes && outcome.verdict == Verdict::Pass {
                outcome.verdict = Verdict::Fail(too_vague.then(|| format!("the estimate for '{name}' is too large")));
            }
        }
    }
    outcome
}
