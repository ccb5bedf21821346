//! Mistakes that must be caught.

use super::*;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    None,
    /// Survivors are not weighed by a / p.
    RouletteUnweighed,
    /// Every score is 1 % too high.
    ScoreOff,
}

/// The mean radiance of everything by a collision walk of its own, with or without a mistake in it.
struct Planted<'a> {
    system: &'a System,
    starts: AliasTable,
    steps: AliasRows,
    mistake: Mistake,
}

impl Planted<'_> {
    fn albedo(&self, bundle: usize, band: usize) -> f64 {
        self.system.transport().scattering().values().get(bundle, band)
    }
}

impl Estimator for Planted<'_> {
    fn name(&self) -> &'static str {
        "planted"
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        1
    }

    fn n_columns(&self) -> usize {
        self.system.n_bands()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        let mut bundle = self.starts.sample(stream.uniform());
        let n_bands = self.system.n_bands();
        let mut weights = vec![if self.mistake == Mistake::ScoreOff { 1.01 } else { 1.0 }; n_bands];
        loop {
            (0..n_bands)
                .for_each(|band| score.add(start, band, weights[band] * self.system.emission().get(bundle, band)));
            let survival = (0..n_bands).map(|band| self.albedo(bundle, band)).fold(0.0, f64::max);
            if stream.uniform() >= survival {
                return;
            }
            if self.mistake != Mistake::RouletteUnweighed {
                (0..n_bands).for_each(|band| weights[band] *= self.albedo(bundle, band) / survival);
            }
            let Some(next) = self.steps.sample(bundle, stream.uniform()) else { return };
            bundle = next;
        }
    }
}

/// Each mistake is caught within the number of samples that the prediction names beforehand: enough for the bias it makes to stand nine
/// standard errors out, where five are too many.
#[test]
fn planted_errors_are_caught_within_the_predicted_budget() {
    let system = system(&gallery::corner_box(), 1.0);
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let exact = exact(&system);
    let wanted = &measurements(&system)[..1];
    let walk = MatrixWalk::collision(&system).unwrap().measuring(wanted).unwrap();
    let prediction = walk.predict(Order::Variance, &exact, by_elimination).unwrap();
    let right = measured(&system, wanted, &exact);
    for mistake in [Mistake::RouletteUnweighed, Mistake::ScoreOff] {
        let planted = |mistake| Planted {
            system: &system,
            starts: AliasTable::new(system.etendue()).unwrap(),
            steps: AliasRows::new(n, n, |i, row| system.transport().propagation().row(0, i, row)).unwrap(),
            mistake,
        };
        // What the mistake amounts to.
        let wrong = planted(mistake);
        let albedo = |i: usize, band: usize| match mistake {
            Mistake::RouletteUnweighed => (0..n_bands).map(|band| wrong.albedo(i, band)).fold(0.0, f64::max),
            _ => wrong.albedo(i, band),
        };
        let mut biased = self::exact(&system.with_albedo(Block::from_fn(n, n_bands, albedo)));
        let factor = if mistake == Mistake::ScoreOff { 1.01 } else { 1.0 };
        biased.values_mut().iter_mut().for_each(|v| *v *= factor);
        let bias = measured(&system, wanted, &biased);

        // The budget that shows it in the band where it shows most.
        let samples = |band: usize| {
            let off = (bias.get(0, band) - right.get(0, band)).abs() / (critical_z(ALPHA, n_bands) + 4.0);
            prediction.variance.get(0, band) / (off * off)
        };
        let n_samples = (0..n_bands).map(samples).fold(f64::INFINITY, f64::min).ceil() as u64;
        let judge = |mistake| {
            let drawn = estimate(&planted(mistake), n_samples, SEED);
            compare_blocks(&right, &drawn.mean, &drawn.variance_of_mean, ALPHA)
        };
        let verdict = judge(mistake);
        assert!(!verdict.agrees, "{mistake:?} went unnoticed in {n_samples} samples: {verdict:?}");
        let verdict = judge(Mistake::None);
        assert!(verdict.agrees, "no mistake, {n_samples} samples: {verdict:?}");
    }
}

/// A third of all bundles reflects a thousandth more than it should: walks guided by the right solution vary so little that few of them tell.
#[test]
fn an_albedo_that_is_slightly_off_is_caught_by_guided_walks() {
    let system = system(&gallery::corner_box(), 1.0);
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let exact = exact(&system);
    let wanted = &measurements(&system)[..1];
    let right = measured(&system, wanted, &exact);
    let albedo = system.transport().scattering().values();
    let off = |i: usize, band: usize| if 3 * i < n { 1.001 * albedo.get(i, band) } else { albedo.get(i, band) };
    let mistaken = system.with_albedo(Block::from_fn(n, n_bands, off));
    let walk = GuidedWalk::gathering(&mistaken, &exact).unwrap().measuring(wanted).unwrap();
    let biased = self::exact(&mistaken);
    let prediction = walk.predict(Order::Variance, &biased, by_factors).unwrap();
    let bias = measured(&system, wanted, &biased);
    let error = (0..n_bands).map(|band| (bias.get(0, band) - right.get(0, band)).abs()).fold(0.0, f64::max);
    let n_samples = prediction.samples_for(error / (critical_z(ALPHA, n_bands) + 4.0)).max(1_000);
    assert!(n_samples < 20_000, "{n_samples} samples");
    let drawn = estimate(&walk, n_samples, SEED);
    let verdict = compare_blocks(&right, &drawn.mean, &drawn.variance_of_mean, ALPHA);
    assert!(!verdict.agrees, "{n_samples} samples: {verdict:?}");
    let verdict = compare_blocks(&bias, &drawn.mean, &drawn.variance_of_mean, ALPHA);
    assert!(verdict.agrees, "{n_samples} samples: {verdict:?}");
}
