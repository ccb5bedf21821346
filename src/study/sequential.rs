//! Sequential Monte Carlo, stage by stage.

use super::StudySettings;
use super::estimators::{Roster, SEQUENTIAL};
use super::outcome::{SequentialPoint, SequentialRun};
use crate::compare::relative_rms;
use crate::estimator::{EstimatorError, Sequential, SequentialStop};
use crate::stats::fit_line;
use std::time::Instant;

/// Stages that share the samples of a plain walk.
const STAGES: u64 = 16;

/// Fewest walks a stage: with fewer the error may grow.
const FEWEST_WALKS: u64 = 64;

const MOST_STAGES: usize = 100;

/// Errors above this multiple of the least are not yet rounding.
const ABOVE_ROUNDING: f64 = 10.0;

/// Corrects until the residual is the solvers' tolerance, or what is left of it is rounding.
pub(super) fn run_sequential(
    roster: &Roster<'_>,
    settings: &StudySettings,
    progress: &(dyn Fn(f64) + Sync),
) -> SequentialRun {
    let n_walks = (settings.walk_samples / STAGES).max(FEWEST_WALKS);
    let walk = match roster.walk() {
        Ok(walk) => walk,
        Err(refusal) => return SequentialRun::refused(n_walks, &refusal),
    };
    let plan = Sequential { tolerance: settings.tolerance, n_walks, max_stages: MOST_STAGES };
    let (weights, digits) = (roster.system.etendue(), -settings.tolerance.log10());
    let mut stages = Vec::new();
    // The observer's own time is not the method's.
    let (start, mut watching) = (Instant::now(), 0.0);
    let answer = walk.sequential_watched(plan, settings.seed, &mut |stage, radiance| {
        let paused = Instant::now();
        stages.push(SequentialPoint {
            products: stage.n_products,
            steps: stage.n_steps,
            seconds: start.elapsed().as_secs_f64() - watching,
            residual: stage.residual,
            error: relative_rms(radiance, roster.truth, weights),
        });
        progress((-stage.residual.log10() / digits).clamp(0.0, 1.0));
        watching += paused.elapsed().as_secs_f64();
    });
    let stop = match answer.stop {
        SequentialStop::Converged => "converged",
        SequentialStop::Budget => "budget",
        SequentialStop::Stalled => "stalled",
    };
    SequentialRun {
        estimator: SEQUENTIAL.to_string(),
        refusal: None,
        n_walks,
        stop: stop.to_string(),
        factor: factor(&stages),
        seconds: stages.last().map_or(0.0, |stage| stage.seconds),
        stages,
    }
}

/// What one stage multiplies the error by, over the stages before rounding.
fn factor(stages: &[SequentialPoint]) -> f64 {
    let least = stages.iter().map(|stage| stage.error).fold(f64::INFINITY, f64::min);
    let clear = stages.iter().filter(|stage| stage.error > ABOVE_ROUNDING * least && stage.error.is_finite());
    let (x, y): (Vec<f64>, Vec<f64>) = clear.map(|stage| (stage.products as f64, stage.error.ln())).unzip();
    fit_line(&x, &y).map_or(f64::NAN, |line| line.slope.exp())
}

impl SequentialRun {
    fn refused(n_walks: u64, refusal: &EstimatorError) -> Self {
        Self {
            estimator: SEQUENTIAL.to_string(),
            refusal: Some(refusal.to_string()),
            n_walks,
            stop: "refused".to_string(),
            stages: Vec::new(),
            factor: f64::NAN,
            seconds: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_is_that_of_the_stages_before_rounding() {
        let stage = |k: usize| SequentialPoint {
            products: k,
            steps: 0,
            seconds: 0.0,
            residual: 0.0,
            error: 0.1_f64.powi(k as i32).max(1e-13),
        };
        let stages: Vec<SequentialPoint> = (1..30).map(stage).collect();
        assert!((factor(&stages) - 0.1).abs() < 1e-12, "{}", factor(&stages));
        assert!(factor(&stages[..1]).is_nan());
    }
}
