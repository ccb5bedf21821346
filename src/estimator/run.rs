//! Draws samples and keeps their moments, on any number of threads with the same bits.
//!
//! Work is cut into tasks of one start and some consecutive samples, by constants that know nothing of the threads; their moments
//! are merged in the order of the samples. A sample's random numbers are keyed by (seed, name, start, sample), so none depends on
//! how many are drawn in all.

use super::{Estimate, Estimator, Score};
use crate::sampling::Streams;
use crate::stats::Moments;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Tasks drawn between two merges, or one a start where there are more starts: bounds the moments held at once.
const TASKS_A_WAVE: usize = 32;

/// Means of the first `n_samples` samples of every start.
///
/// Cost n_starts × n_samples samples. Memory 24 bytes a bundle and band, 32 times that for an estimator with a single start.
pub fn estimate(estimator: &dyn Estimator, n_samples: u64, seed: u64) -> Estimate {
    estimate_range(estimator, 0..n_samples, seed)
}

/// Means of the samples of these numbers, of every start: sample k is the same whatever the range, so disjoint ranges are
/// independent and [`Estimate::merge`] joins them.
pub fn estimate_range(estimator: &dyn Estimator, samples: Range<u64>, seed: u64) -> Estimate {
    estimate_watched(estimator, samples, seed, &|_| ())
}

/// [`estimate_range`], telling `progress` the finished share in [0, 1], from any thread.
pub fn estimate_watched(
    estimator: &dyn Estimator,
    samples: Range<u64>,
    seed: u64,
    progress: &(dyn Fn(f64) + Sync),
) -> Estimate {
    let (n_starts, n_columns) = (estimator.n_starts(), estimator.n_columns());
    let mut estimate = Estimate::empty(estimator, seed);
    if samples.is_empty() || n_starts == 0 {
        progress(1.0);
        return estimate;
    }
    let streams = Streams::new(seed, estimator.name());
    let mut moments = vec![Moments::default(); estimator.n_bundles() * n_columns];

    // Draw some chunks of samples from all starts at a time.
    let n_samples = samples.end - samples.start;
    let samples_a_task = estimator.samples_a_task().max(1);
    let n_chunks = n_samples.div_ceil(samples_a_task);
    let n_tasks = n_chunks.saturating_mul(n_starts as u64);
    let chunks_a_wave = TASKS_A_WAVE.div_ceil(n_starts) as u64;
    let done = AtomicU64::new(0);
    for first_chunk in (0..n_chunks).step_by(chunks_a_wave as usize) {
        let n_chunks_here = chunks_a_wave.min(n_chunks - first_chunk) as usize;
        let wave: Vec<(u64, Vec<Moments>)> = (0..n_chunks_here * n_starts)
            .into_par_iter()
            .map(|task| {
                let begin = samples.start + (first_chunk + (task / n_starts) as u64) * samples_a_task;
                let end = samples.end.min(begin.saturating_add(samples_a_task));
                let start = task % n_starts;
                let mut score = Score::new(estimator.reach(start), n_columns);
                estimator.samples(start, begin..end, &streams, &mut score);
                progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / n_tasks as f64);
                (score.n_steps(), score.into_moments())
            })
            .collect();

        // Merge them in order.
        for (task, (n_steps, drawn)) in wave.iter().enumerate() {
            estimate.n_steps += n_steps;
            let reach = estimator.reach(task % n_starts);
            let merged = &mut moments[reach.start * n_columns..reach.end * n_columns];
            merged.iter_mut().zip(drawn).for_each(|(merged, drawn)| merged.merge(drawn));
        }
    }

    estimate.n_samples = n_samples;
    estimate.samples = vec![samples];
    for (k, moments) in moments.iter().enumerate() {
        estimate.mean.set(k / n_columns, k % n_columns, moments.mean());
        estimate.variance_of_mean.set(k / n_columns, k % n_columns, moments.variance_of_mean());
    }
    if let Some(known) = estimator.known() {
        estimate.mean.add_scaled(1.0, known);
    }
    estimate
}
