//! Norms, verdicts and rates.

use etendue::compare::{
    Level, ROUNDING_TOLERANCE, RatesError, compare_blocks, compare_blocks_anytime, equivalent_blocks, observed_order,
    p_value_map, p_values, pooled, relative_max, relative_rms, richardson, z_map,
};
use etendue::linalg::Block;
use etendue::sampling::Streams;
use etendue::stats::{Moments, NormalMixture, binomial_tail, p_value_histogram, two_sided_p};

#[test]
fn norms_weigh_as_they_say() {
    let reference = Block::from_fn(2, 2, |r, c| [[3.0, 0.0], [4.0, 2.0]][c][r]);
    let value = Block::from_fn(2, 2, |r, c| reference.get(r, c) + [[1.0, 2.0], [0.0, -4.0]][c][r]);
    assert_eq!(relative_max(&value, &reference), 1.0);
    // Σ w d² = 2·1 + 1·4 + 2·0 + 1·16 = 22, Σ w r² = 2·9 + 0 + 2·16 + 4 = 54.
    assert_eq!(relative_rms(&value, &reference, &[2.0, 1.0]), 22f64.sqrt() / 54f64.sqrt());
    let zero = Block::zeros(2, 2);
    assert_eq!((relative_max(&zero, &zero), relative_rms(&zero, &zero, &[1.0, 1.0])), (0.0, 0.0));
    assert_eq!(relative_max(&value, &zero), f64::INFINITY);
    let broken = Block::from_fn(2, 2, |_, _| f64::NAN);
    assert!(relative_max(&broken, &reference).is_nan() && relative_rms(&broken, &reference, &[1.0, 1.0]).is_nan());
}

/// Means and variances of a fair experiment about `reference`, with row 0 known exactly.
fn experiment(reference: &Block, seed: u64, bias: f64) -> (Block, Block) {
    let (mut mean, mut variance) = (reference.clone(), Block::zeros(reference.n_rows(), reference.n_columns()));
    let streams = Streams::new(seed, "experiment");
    for c in 0..reference.n_columns() {
        for r in 1..reference.n_rows() {
            let mut stream = streams.stream(r as u32, c as u64);
            let exact = reference.get(r, c) + bias;
            let m: Moments = (0..100).map(|_| exact + 0.2 * (stream.uniform() - 0.5)).collect();
            mean.set(r, c, m.mean());
            variance.set(r, c, m.variance_of_mean());
        }
    }
    (mean, variance)
}

fn reference() -> Block {
    Block::from_fn(40, 3, |r, c| 1.0 + r as f64 + 0.1 * c as f64)
}

#[test]
fn fair_experiments_agree_about_as_often_as_promised() {
    // A significance of 0.05 is too often wrong by design: of 1000 fair experiments, 50 ± 7 fail; the scores of a mean of
    // 100 uniform numbers have slightly heavy (Student's) tails, so allow for twice as many, and at 1e-6 for none.
    let mut n_failures = 0;
    for seed in 0..1000 {
        let (mean, variance) = experiment(&reference(), seed, 0.0);
        let verdict = compare_blocks(&reference(), &mean, &variance, 0.05);
        assert_eq!((verdict.n_comparisons, verdict.n_exact), (39 * 3, 3));
        assert_eq!(verdict.agrees, verdict.worst_z <= verdict.critical_z);
        n_failures += usize::from(!verdict.agrees);
        assert!(compare_blocks(&reference(), &mean, &variance, 1e-6).agrees, "seed {seed}: {verdict:?}");
    }
    assert!((15..=150).contains(&n_failures), "{n_failures} of 1000");
}

#[test]
fn biased_experiments_do_not() {
    // A bias of ten standard errors, 10 × 0.2/√12/√100.
    let (mean, variance) = experiment(&reference(), 5, 0.0577);
    let verdict = compare_blocks(&reference(), &mean, &variance, 1e-6);
    assert!(!verdict.agrees && verdict.p_value < 1e-6 && verdict.worst_z > 8.0, "{verdict:?}");
}

#[test]
fn one_wrong_entry_is_found_and_named() {
    let (mut mean, variance) = experiment(&reference(), 6, 0.0);
    mean.set(17, 2, reference().get(17, 2) - 12.0 * variance.get(17, 2).sqrt());
    let verdict = compare_blocks(&reference(), &mean, &variance, 1e-6);
    assert!(!verdict.agrees && verdict.worst_at == (17, 2));
    assert!((verdict.worst_z - 12.0).abs() < 1e-6, "{verdict:?}");
}

#[test]
fn one_may_look_while_it_runs() {
    let (mut mean, variance) = experiment(&reference(), 6, 0.0);
    let sequence = NormalMixture::new(1e-6, 50, 100).unwrap();
    let look = |mean: &Block, n_samples| compare_blocks_anytime(&reference(), mean, &variance, n_samples, &sequence);
    let verdict = look(&mean, 100);
    assert!(verdict.agrees && verdict.p_value > 0.1);
    // A look costs: what is beyond the critical z of one look may not be beyond that of all.
    let once = compare_blocks(&reference(), &mean, &variance, 1e-6);
    assert!(verdict.critical_z > once.critical_z && verdict.critical_z < 1.5 * once.critical_z);
    for (share, agrees) in [(0.999, true), (1.001, false)] {
        let z = share * verdict.critical_z;
        mean.set(17, 2, reference().get(17, 2) - z * variance.get(17, 2).sqrt());
        let verdict = look(&mean, 100);
        assert_eq!((verdict.agrees, verdict.worst_at), (agrees, (17, 2)), "{verdict:?}");
    }
    // Nothing is said before the sequence starts, but of numbers that are none.
    assert!(look(&mean, 49).agrees && look(&mean, 49).critical_z == f64::INFINITY);
    mean.set(17, 2, f64::NAN);
    assert!(!look(&mean, 49).agrees);
}

#[test]
fn exact_entries_are_compared_to_rounding() {
    let exact = reference();
    let none = Block::zeros(40, 3);
    let largest = exact.get(39, 1);
    let off_by = |relative: f64| {
        let mut mean = exact.clone();
        mean.set(3, 1, exact.get(3, 1) + relative * largest);
        compare_blocks(&exact, &mean, &none, 1e-6)
    };
    let close = off_by(0.5 * ROUNDING_TOLERANCE);
    assert!(close.agrees && close.p_value == 1.0 && close.n_comparisons == 0 && close.n_exact == 120);
    let far = off_by(2.0 * ROUNDING_TOLERANCE);
    assert!(!far.agrees && far.worst_at == (3, 1) && far.worst_z == f64::INFINITY && far.p_value == 0.0);
}

#[test]
fn what_is_not_a_number_never_agrees() {
    let (mean, variance) = experiment(&reference(), 7, 0.0);
    for which in 0..3 {
        let mut blocks = [reference(), mean.clone(), variance.clone()];
        blocks[which].set(8, 0, f64::NAN);
        let verdict = compare_blocks(&blocks[0], &blocks[1], &blocks[2], 1e-6);
        assert!(!verdict.agrees && verdict.worst_at == (8, 0), "{verdict:?}");
    }
}

#[test]
fn rounding_in_a_variance_is_no_disagreement() {
    // A score that never varies but for its last bit has an error bar far below what its reference is known to.
    let mut mean = reference();
    let mut variance = Block::zeros(40, 3);
    mean.set(4, 0, reference().get(4, 0) * (1.0 + 4.0 * f64::EPSILON));
    variance.set(4, 0, 1e-36);
    assert!(compare_blocks(&reference(), &mean, &variance, 1e-6).agrees);
}

#[test]
fn maps_show_where_and_which_way() {
    let (mut mean, mut variance) = experiment(&reference(), 8, 0.0);
    mean.set(17, 2, reference().get(17, 2) - 6.0 * variance.get(17, 2).sqrt());
    variance.set(5, 1, f64::NAN);
    let z = z_map(&reference(), &mean, &variance);
    assert!((z.get(17, 2) + 6.0).abs() < 1e-6 && z.get(5, 1) == f64::INFINITY && z.get(0, 1) == 0.0);
    let p = p_value_map(&reference(), &mean, &variance);
    assert_eq!((p.get(17, 2), p.get(5, 1), p.get(0, 1)), (two_sided_p(z.get(17, 2)), 0.0, 1.0));
    // The verdict is that of the map's worst entry.
    variance.set(5, 1, 1.0);
    let verdict = compare_blocks(&reference(), &mean, &variance, 1e-6);
    assert_eq!((verdict.worst_z, verdict.worst_at), (z.get(17, 2).abs(), (17, 2)));
    // Row 0 is exact and tells nothing about error bars.
    let all = p_values(&reference(), &mean, &variance);
    assert_eq!((all.len(), verdict.n_comparisons), (117, 117));
    assert!(all.contains(&p.get(17, 2)));
}

#[test]
fn p_values_of_honest_error_bars_are_uniform_and_of_others_are_not() {
    let mut honest = Vec::new();
    let mut shrunk = Vec::new();
    for seed in 0..20 {
        let (mean, mut variance) = experiment(&reference(), 900 + seed, 0.0);
        honest.extend(p_values(&reference(), &mean, &variance));
        variance.values_mut().iter_mut().for_each(|v| *v *= 0.64);
        shrunk.extend(p_values(&reference(), &mean, &variance));
    }
    assert!(p_value_histogram(&honest, 20).unwrap().uniformity.p_value > 1e-6);
    // Error bars too small by a fifth.
    assert!(p_value_histogram(&shrunk, 20).unwrap().uniformity.p_value < 1e-6);
}

#[test]
fn equivalence_is_shown_everywhere_or_not_at_all() {
    let (mut mean, variance) = experiment(&reference(), 9, 0.0);
    // An error bar is 0.2/√12/10 = 0.0058, the largest of a column some 40: 0.1 % are seven of them.
    let verdict = equivalent_blocks(&reference(), &mean, &variance, 1e-3, 1e-4);
    assert!(verdict.holds && verdict.p_value < 1e-4 && verdict.n_comparisons == 120, "{verdict:?}");
    // The smallest margin is the one that just holds.
    let least = equivalent_blocks(&reference(), &mean, &variance, verdict.smallest_margin, 1e-4);
    assert!((least.p_value / 1e-4 - 1.0).abs() < 1e-9, "{least:?}");
    assert_eq!(verdict.to_string(), format!("equal within 0.1 % (p = {:.1e})", verdict.p_value));
    // A margin below the error bars shows nothing, nor do samples that are wrong in one place.
    let hasty = equivalent_blocks(&reference(), &mean, &variance, 1e-4, 1e-4);
    assert!(!hasty.holds && hasty.smallest_margin < 1e-3);
    let text = hasty.to_string();
    assert!(text.starts_with("not shown to be equal within 0.01 % (p = "), "{text}");
    // What it says could be shown is rounded up, and so can be.
    let (_, said) = text.rsplit_once("within ").unwrap();
    let said: f64 = said.trim_end_matches(" %").parse().unwrap();
    let next = equivalent_blocks(&reference(), &mean, &variance, said / 100.0, 1e-4);
    assert!(next.holds && said / 100.0 < 1.1 * hasty.smallest_margin, "{text}");
    mean.set(17, 2, reference().get(17, 2) + 0.05);
    let verdict = equivalent_blocks(&reference(), &mean, &variance, 1e-3, 1e-4);
    assert!(!verdict.holds && verdict.worst_at == (17, 2), "{verdict:?}");
    mean.set(17, 2, f64::NAN);
    let verdict = equivalent_blocks(&reference(), &mean, &variance, 1e-3, 1e-4);
    assert!(!verdict.holds && verdict.p_value == 1.0 && verdict.smallest_margin == f64::INFINITY);
    // Exact numbers are equal or are not; of nothing, nothing is shown.
    let none = Block::zeros(40, 3);
    assert_eq!(equivalent_blocks(&reference(), &reference(), &none, 1e-9, 1e-6).p_value, 0.0);
    assert!(equivalent_blocks(&none, &none, &none, 1e-9, 1e-6).holds);
    assert!(!equivalent_blocks(&none, &reference(), &none, 1e-9, 1e-6).holds);
    assert!(!equivalent_blocks(&Block::zeros(0, 0), &Block::zeros(0, 0), &Block::zeros(0, 0), 1e-3, 0.1).holds);
}

/// Light that arrives late is dim everywhere: the eighth bounce of a lamp of radiance 1 may have a reference of 1e-4 in every
/// bundle. The largest of them is no bound of a score, which is 1 when it comes, once in 10⁴ samples.
#[test]
fn late_bounces_are_pooled_until_they_score() {
    let (n_bundles, n_samples, chance) = (60, 100_000, 1e-4);
    let reference = Block::from_fn(n_bundles, 1, |_, _| chance);
    let weights = vec![0.5; n_bundles];
    let mut n_failures = 0;
    for experiment in 0..2000 {
        let mut stream = Streams::new(79, "late bounces").stream(experiment, 0);
        // Scores are so rare that their number is Poisson's: the gaps between them are exponential.
        let hits = Block::from_fn(n_bundles, 1, |_, _| {
            let mut left = chance * n_samples as f64 + (1.0 - stream.uniform()).ln();
            let mut n_hits = 0.0;
            while left > 0.0 {
                n_hits += 1.0;
                left += (1.0 - stream.uniform()).ln();
            }
            n_hits
        });
        let n = n_samples as f64;
        let mean = Block::from_fn(n_bundles, 1, |r, _| hits.get(r, 0) / n);
        let variance = Block::from_fn(n_bundles, 1, |r, _| hits.get(r, 0) / n * (1.0 - hits.get(r, 0) / n) / (n - 1.0));
        let [expected, mean, variance] = pooled(&reference, &mean, &variance, &weights, n_samples, &[1.0]);
        // Ten scores a bundle: 40 bundles make the first comparison, and the others join it.
        assert_eq!(expected.n_rows(), 1);
        n_failures += u64::from(!compare_blocks(&expected, &mean, &variance, 1e-3).agrees);
    }
    // At 600 scores a true alarm rate of 1.2e-3, by Poisson's terms.
    assert!(binomial_tail(n_failures, 2000, 1.2e-3) > 1e-6, "{n_failures} false alarms of 2000");
}

#[test]
fn unequal_weights_pool_by_their_skewness() {
    // One bundle of weight 10 drowns the others: its 100 scores alone make the sum as skewed as 103 scores would.
    let reference = Block::from_fn(50, 1, |_, _| 1.0);
    let weights: Vec<f64> = (0..50).map(|r| if r == 0 { 10.0 } else { 0.1 }).collect();
    assert_eq!(pooled(&reference, &reference, &reference, &weights, 100, &[1.0])[0].n_rows(), 0);
    assert_eq!(pooled(&reference, &reference, &reference, &[0.1; 50], 100, &[1.0])[0].n_rows(), 12);
    // Bundles without weight or without light take part in nothing.
    let dark = Block::from_fn(50, 1, |r, _| f64::from(u8::from(r % 2 == 0)));
    assert_eq!(pooled(&dark, &dark, &dark, &[0.1; 50], 100, &[1.0])[0].n_rows(), 6);
    assert_eq!(pooled(&dark, &dark, &dark, &[0.0; 50], 100, &[1.0])[0].n_rows(), 0);
    assert_eq!(pooled(&Block::zeros(50, 1), &dark, &dark, &[1.0; 50], 100, &[0.0])[0].n_rows(), 0);
}

#[test]
fn orders_are_observed() {
    let errors: Vec<(f64, f64)> = [0.4, 0.2, 0.1, 0.05].map(|h: f64| (h, 3.0 * h.powf(1.5))).to_vec();
    let order = observed_order(&errors).unwrap();
    assert!((order.order - 1.5).abs() < 1e-13 && order.standard_error < 1e-13 && order.n_levels == 4);
    assert_eq!(observed_order(&errors[..2]).unwrap().standard_error, f64::INFINITY);
    assert!(matches!(observed_order(&[(0.1, 1.0), (0.05, 0.0)]), Err(RatesError::Fit(_))));
}

#[test]
fn richardson_finds_limit_and_order() {
    // Doubling error in the differences: the order's last digits go as ulp(value) / (difference · ln ratio).
    for order in [0.5, 1.0, 1.7, 2.0, 4.0] {
        for steps in [[0.4, 0.2, 0.1], [1.0, 0.55, 0.37]] {
            let levels = steps.map(|step: f64| Level { step, value: 2.0 - 0.3 * step.powf(order) });
            let found = richardson(levels).unwrap();
            assert!((found.order - order).abs() < 1e-11, "{found:?}");
            assert!((found.limit - 2.0).abs() < 1e-12, "{found:?}");
            assert!((found.finest_error - 0.3 * steps[2].powf(order)).abs() < 1e-12);
        }
    }
}

#[test]
fn richardson_refuses_what_does_not_converge() {
    let levels = |steps: [f64; 3], values: [f64; 3]| {
        let mut k = 0;
        steps.map(|step| {
            k += 1;
            Level { step, value: values[k - 1] }
        })
    };
    let halves = [0.4, 0.2, 0.1];
    for values in [[1.0, 2.0, 1.5], [1.0, 2.0, 4.0], [1.0, 1.0, 1.0], [1.0, 2.0, 2.0], [1.0, 2.0, 3.0]] {
        assert!(matches!(richardson(levels(halves, values)), Err(RatesError::NotConverging { .. })), "{values:?}");
    }
    let values = [1.0, 2.0, 2.5];
    assert!(matches!(richardson(levels([0.4, 0.2, 0.2], values)), Err(RatesError::Steps { level: 2, .. })));
    assert!(matches!(richardson(levels([0.4, -0.2, -0.3], values)), Err(RatesError::Steps { level: 1, .. })));
    assert!(matches!(richardson(levels(halves, [1.0, f64::NAN, 2.5])), Err(RatesError::NotFinite { level: 1, .. })));
}
