//! Walks that follow an approximate solution.

use super::*;

#[test]
fn walks_guided_by_the_solution_have_no_variance() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let exact = exact(&system);
        let wanted = measurements(&system)[..1].to_vec();
        let gathering = GuidedWalk::gathering(&system, &exact).unwrap();
        let measuring = gathering.measuring(&wanted).unwrap();
        let shooting = GuidedWalk::shooting(&system, &wanted[0], &importance(&system, &wanted[0])).unwrap();
        let measured = measured(&system, &wanted, &exact);
        let walks: [(&dyn Estimator, &Block); 3] =
            [(&gathering, &exact), (&measuring, &measured), (&shooting, &measured)];
        for (walk, exact) in walks {
            let drawn = estimate(walk, 2_000, SEED);
            assert!(relative_max(&drawn.mean, exact) < SOLVE_TOLERANCE, "{} in {}", walk.name(), scene.name());
            let worst = drawn.variance_of_mean.values().iter().zip(exact.values());
            let worst = worst.map(|(v, l)| (v * 2_000.0).sqrt() / l).fold(0.0, f64::max);
            assert!(worst < NO_DEVIATION, "{} in {}: the deviation is {worst:e}", walk.name(), scene.name());
        }
        let predicted = gathering.predict(Order::Fourth, &exact, by_factors).unwrap();
        let worst =
            predicted.variance.values().iter().zip(exact.values()).map(|(v, l)| v.sqrt() / l).fold(0.0, f64::max);
        assert!(worst < NO_DEVIATION, "{}: predicted {worst:e}", scene.name());
    }
}

#[test]
fn walks_guided_roughly_are_right_and_predicted() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let exact = exact(&system);
        let wanted = measurements(&system);
        let gathering = GuidedWalk::gathering(&system, &rough(&exact)).unwrap();
        let prediction = gathering.predict(Order::Fourth, &exact, by_factors).unwrap();
        assert_predicted(scene.name(), &exact, &prediction, &estimate(&gathering, n_large(), SEED), 12);

        let (measuring, all) = (gathering.measuring(&wanted).unwrap(), measured(&system, &wanted, &exact));
        let prediction = measuring.predict(Order::Fourth, &exact, by_factors).unwrap();
        assert_predicted(scene.name(), &all, &prediction, &estimate(&measuring, n_large(), SEED), 12);

        let (exact, first) = (importance(&system, &wanted[0]), measured(&system, &wanted[..1], &exact));
        let shooting = GuidedWalk::shooting(&system, &wanted[0], &rough(&exact)).unwrap();
        let predicted = shooting.predict(Order::Fourth, &exact, by_factors).unwrap();
        assert_predicted(scene.name(), &first, &predicted, &estimate(&shooting, n_large(), SEED), 12);

        // A rough guide beats none by far.
        let blind = MatrixWalk::collision(&system).unwrap().measuring(&wanted[..1]).unwrap();
        let blind = blind.predict(Order::Variance, &self::exact(&system), by_elimination).unwrap();
        for (guided, blind) in predicted.variance.values().iter().zip(blind.variance.values()) {
            assert!(*blind < 1e-20 || 3.0 * guided < *blind, "{}: {guided} is not well below {blind}", scene.name());
        }
    }
}

/// Importance from a mesh of a quarter of the bundles leaves a tenth of the variance, or less.
#[test]
fn walks_guided_by_a_coarse_solution_vary_little() {
    let scene = gallery::furnace_cube(&[0.5, 0.5], &[1.0, 2.0]).unwrap();
    let bundles =
        [0.5, 0.25].map(|patch_size| Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).unwrap());
    let systems = [0, 1].map(|k| {
        let facet = |i: usize| bundles[k].patch(bundles[k].element_of(i).0).unwrap().facet;
        let system = assemble(&scene, &bundles[k], Exchange::default()).unwrap();
        let albedo = |i: usize, band: usize| 0.9 - 0.15 * ((facet(i) + band) % 6) as f64;
        system.with_albedo(Block::from_fn(system.n_bundles(), system.n_bands(), albedo))
    });
    // What the floor sends out, on both meshes.
    let floor = [0, 1].map(|k| {
        let is_floor = |i: usize| bundles[k].patch(bundles[k].element_of(i).0).unwrap().facet == 0;
        Block::from_fn(bundles[k].n_bundles(), 2, |i, _| if is_floor(i) { 1.0 } else { 0.0 })
    });
    let coarse = importance(&systems[0], &floor[0]);
    let parent = |i: usize| {
        let patch = bundles[1].patch(bundles[1].element_of(i).0).unwrap();
        bundles[0].locate(patch.facet, patch.side, patch.polygon.centroid(), patch.polygon.normal()).unwrap()
    };
    let guide = Block::from_fn(bundles[1].n_bundles(), 2, |i, band| coarse.get(parent(i), band));
    let walk = GuidedWalk::shooting(&systems[1], &floor[1], &guide).unwrap();
    let prediction = walk.predict(Order::Fourth, &importance(&systems[1], &floor[1]), by_factors).unwrap();
    let (radiance, wanted) = (exact(&systems[1]), [floor[1].clone()]);
    let right = measured(&systems[1], &wanted, &radiance);
    assert_predicted(scene.name(), &right, &prediction, &estimate(&walk, n_large(), SEED), 12);
    let blind = MatrixWalk::collision(&systems[1]).unwrap().measuring(&wanted).unwrap();
    let blind = blind.predict(Order::Variance, &radiance, by_elimination).unwrap();
    for (guided, blind) in prediction.variance.values().iter().zip(blind.variance.values()) {
        assert!(10.0 * guided < *blind, "{guided} is not well below {blind}");
    }
}

/// A guide that knows nothing sends weights up without end.
#[test]
fn moments_that_do_not_exist_are_refused() {
    let system = system(&gallery::corner_box(), 1.0);
    let exact = exact(&system);
    let mut stream = Stream::new(SEED, 8, 8);
    let wild = Block::from_fn(exact.n_rows(), exact.n_columns(), |_, _| 10f64.powf(6.0 * stream.uniform()));
    let walk = GuidedWalk::gathering(&system, &wild).unwrap();
    let refused = walk.predict(Order::Variance, &exact, by_factors);
    assert!(matches!(refused, Err(OracleError::Infinite { order: 2, radius }) if radius >= 1.0), "{refused:?}");

    let mut zero = exact.clone();
    zero.set(3, 0, 0.0);
    assert_eq!(GuidedWalk::gathering(&system, &zero).unwrap_err(), EstimatorError::GuideMisses { bundle: 3, band: 0 });
    zero.set(3, 0, -1.0);
    let refused = GuidedWalk::gathering(&system, &zero).unwrap_err();
    assert_eq!(refused, EstimatorError::Guide { bundle: 3, band: 0, value: -1.0 });
}
