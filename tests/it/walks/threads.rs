//! Bits that must not depend on threads, or on how walks are batched.

use super::*;

#[test]
fn threads_change_no_bit_of_any_walk() {
    let system = system(&gallery::corner_box(), 0.5);
    let exact = exact(&system);
    let walk = MatrixWalk::collision(&system).unwrap();
    let wanted = measurements(&system);
    let all: [(Box<dyn Estimator>, u64); 6] = [
        (Box::new(walk.measuring(&wanted).unwrap()), 5_000),
        (Box::new(walk.shooting(Scoring::Survival).unwrap()), 10_000),
        (Box::new(walk.stochastic_jacobi(10_000).unwrap()), 50),
        (Box::new(GuidedWalk::gathering(&system, &rough(&exact)).unwrap()), 1_500),
        (Box::new(walk.quasi(1_000)), 5),
        (Box::new(walk.measuring(&wanted).unwrap().quasi(20_000)), 20),
    ];
    let on = |n_threads: usize, estimator: &dyn Estimator, n_samples: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| estimate(estimator, n_samples, SEED))
    };
    for (estimator, n_samples) in &all {
        let alone = on(1, estimator.as_ref(), *n_samples);
        assert!(alone.n_steps > 0, "{} counts no steps", estimator.name());
        assert_eq!(alone, on(3, estimator.as_ref(), *n_samples), "{}", estimator.name());
    }
}

/// Particles move many abreast; one after another they draw the same samples.
#[test]
fn particles_abreast_are_the_same_particles() {
    let system = system(&gallery::corner_box(), 0.5);
    for bounces in [Bounces::All, Bounces::Each(3), Bounces::UpTo(1), Bounces::UpTo(0)] {
        let shooting =
            MatrixWalk::collision(&system).unwrap().shooting(Scoring::Absorption).unwrap().with_bounces(bounces);
        let drawn = estimate(&shooting, 3_000, SEED);
        let mut sum = Block::zeros(drawn.mean.n_rows(), drawn.mean.n_columns());
        let one_by_one = OneByOne(&shooting);
        sum.copy_from(&estimate(&one_by_one, 3_000, SEED).mean);
        sum.add_scaled(1.0, shooting.known().unwrap());
        assert!(relative_max(&sum, &drawn.mean) < SOLVE_TOLERANCE, "{bounces:?}");
    }
}

/// Another estimator's samples, drawn singly, without what is known.
struct OneByOne<'a>(&'a dyn Estimator);

impl Estimator for OneByOne<'_> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn truth(&self) -> Truth {
        self.0.truth()
    }

    fn n_bundles(&self) -> usize {
        self.0.n_bundles()
    }

    fn n_columns(&self) -> usize {
        self.0.n_columns()
    }

    fn n_starts(&self) -> usize {
        self.0.n_starts()
    }

    fn reach(&self, start: usize) -> std::ops::Range<usize> {
        self.0.reach(start)
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        self.0.sample(start, stream, score);
    }
}
