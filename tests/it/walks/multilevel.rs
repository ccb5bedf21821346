//! Walks on several refinements.

use super::*;

#[test]
fn levels_add_up_to_the_finest() {
    let furnace = gallery::furnace_cube(&[0.3, 0.6, 0.9], &[1.0, 0.5, 0.2]).unwrap();
    for scene in [furnace, gallery::parallel_plates()] {
        let sizes = [0.5, 0.25, 0.125];
        let bundles = sizes.map(|patch_size| Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).unwrap());
        let systems = [0, 1, 2].map(|k| {
            // Walls that reflect unlike one another: in a furnace, walks of all levels score alike.
            let facet = |i: usize| bundles[k].patch(bundles[k].element_of(i).0).unwrap().facet;
            let system = assemble(&scene, &bundles[k], Exchange::default()).unwrap();
            let albedo = |i: usize, band: usize| (0.2 + 0.13 * facet(i) as f64) * (1.0 - 0.2 * band as f64);
            system.with_albedo(Block::from_fn(system.n_bundles(), system.n_bands(), albedo))
        });
        let pairs: Vec<_> = bundles.iter().zip(&systems).collect();
        let levels = Multilevel::new(&pairs).unwrap();
        let (name, exact) = (scene.name(), exact(&systems[2]));
        assert_eq!((levels.n_levels(), levels.n_bundles()), (3, exact.n_rows()));

        // Without bias, with error bars that hold, whatever the numbers of samples.
        let drawn = levels.estimate_with(&[20_000, 4_000, 4_000], SEED);
        let verdict = compare_blocks(&exact, &drawn.mean, &drawn.variance_of_mean, ALPHA);
        assert!(verdict.agrees, "{name}: {verdict:?}");
        let mut more = exact.clone();
        more.add_scaled(0.1, &exact);
        assert!(!compare_blocks(&more, &drawn.mean, &drawn.variance_of_mean, ALPHA).agrees);

        // Differences vary the less the finer the levels, ...
        let variances: Vec<f64> = drawn.levels.iter().map(|level| level.variance).collect();
        assert!(variances[2] < 0.8 * variances[1] && variances[1] < 0.5 * variances[0], "{name}: {variances:?}");

        // ... so that the error asked for is met, and even on meshes so coarse at no higher cost than by walks from every fine bundle.
        let error = 0.01 * exact.max_abs();
        let drawn = levels.estimate(error, 200, SEED);
        let total: f64 = systems[2].etendue().iter().sum();
        let mean_variance = |block: &Block| {
            let of =
                |column: &[f64]| column.iter().zip(systems[2].etendue()).map(|(v, mu)| v * mu / total).sum::<f64>();
            block.columns().map(of).fold(0.0, f64::max)
        };
        let reached = mean_variance(&drawn.variance_of_mean).sqrt();
        assert!((reached / error - 1.0).abs() < 0.2, "{name}: {reached} of {error}");
        let alone = MatrixWalk::collision(&systems[2]).unwrap();
        let predicted = alone.predict(Order::Variance, &exact, by_elimination).unwrap();
        let n_walks = mean_variance(&predicted.variance) / (error * error);
        let steps_a_walk = estimate(&alone, 100, SEED).n_steps as f64 / 100.0;
        let n_steps: u64 = drawn.levels.iter().map(|level| level.n_steps).sum();
        let by_itself = n_walks * steps_a_walk;
        assert!((n_steps as f64) < 1.2 * by_itself, "{name}: {n_steps} against {by_itself}: {:?}", drawn.levels);
    }
}

#[test]
fn levels_that_are_no_refinements_are_refused() {
    let scene = gallery::corner_box();
    let bundles =
        [0.5, 0.3].map(|patch_size| Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).unwrap());
    let systems = [0, 1].map(|k| assemble(&scene, &bundles[k], Exchange::default()).unwrap());
    let refused = Multilevel::new(&[(&bundles[0], &systems[0]), (&bundles[1], &systems[1])]).unwrap_err();
    assert!(
        matches!(refused, EstimatorError::Nesting { level: 1, source: NestingError::Straddles { .. } }),
        "{refused:?}"
    );
    assert_eq!(Multilevel::new(&[]).unwrap_err(), EstimatorError::NoLevels);
}
