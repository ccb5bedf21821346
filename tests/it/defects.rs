//! What was once wrong, each with the test that would have found it.

use super::scenes::{polygon, scene_of};
use etendue::assembly::{AssemblyError, Exchange, Gather, Measurement, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::compare::pooled;
use etendue::gallery;
use etendue::linalg::{Block, worst};
use etendue::scattering::Lambert;
use etendue::scene::{PixelFilter, Scene, SceneError};
use etendue::solver::{Cg, Lu, Solver, Stop};
use std::sync::Arc;

#[test]
fn a_lamp_in_the_plane_of_the_ceiling_is_refused_by_name() {
    // Both squares at z = 1 face down onto the floor, the smaller within the larger.
    let square = |z: f64, half: f64, up: bool| {
        let mut corners = [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
        if !up {
            corners.reverse();
        }
        polygon(&corners)
    };
    let polygons = [square(1.0, 0.25, false), square(1.0, 1.0, false), square(0.5, 0.9, true)];
    let scene = scene_of(&polygons, false);
    let bundles = Bundles::new(&scene, Resolution { patch_size: 0.5, n_directions: 1 }).unwrap();
    // From near the floor's middle the lamp and the ceiling behind it are seen both.
    let large = [square(1.0, 40.0, false), square(1.0, 50.0, false), square(0.0, 0.5, true)];
    let crowded = scene_of(&large, false);
    let crowded_bundles = Bundles::new(&crowded, Resolution { patch_size: 10.0, n_directions: 1 }).unwrap();
    match assemble(&crowded, &crowded_bundles, Exchange::default()) {
        Err(AssemblyError::Overlap { fullness, .. }) => assert!((1.5..2.1).contains(&fullness), "{fullness}"),
        other => panic!("{:?}", other.map(|system| system.report().closure_before_repair)),
    }
    // Where little overlaps the closure before repair tells.
    if let Ok(system) = assemble(&scene, &bundles, Exchange::default()) {
        assert!(system.report().closure_before_repair > 0.01);
    }
}

#[test]
fn filters_with_negative_lobes_weigh_one() {
    // A furnace looks the same through every filter.
    let scene = gallery::furnace_cube(&[0.5], &[1.0]).unwrap();
    let mut description = scene.description().clone();
    let mut camera = description.camera.clone().unwrap();
    (camera.film.width, camera.film.height) = (4, 4);
    for filter in [
        PixelFilter::Box { radius: 0.5 },
        PixelFilter::Gaussian { standard_deviation: 0.5 },
        PixelFilter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
        PixelFilter::Lanczos { lobes: 3.0 },
    ] {
        camera.film.filter = filter;
        description.camera = Some(camera.clone());
        let scene = Scene::new(description.clone()).unwrap();
        let bundles = Bundles::new(&scene, Resolution { patch_size: 0.5, n_directions: 1 }).unwrap();
        for seed in 0..4 {
            let measurement = Measurement::new(&scene, &bundles, Gather { samples: 1024, rays: 1, seed }).unwrap();
            let light = Block::from_fn(bundles.n_bundles(), 1, |_, _| 2.0);
            let pixels = measurement.apply(&[&light], &|_| ());
            // 1024 signs scatter by less than 4 √((weight² − 1)/1024) about their mean; lanczos weighs 1.6² at most.
            for k in 0..16 {
                let seen = pixels[0].get(k, 0) + pixels[1].get(k, 0);
                assert!((seen / 2.0 - 1.0).abs() < 0.1, "{filter:?}: {seen}");
            }
        }
    }
    for bad in [PixelFilter::Gaussian { standard_deviation: 0.0 }, PixelFilter::Mitchell { b: 0.0, c: 50.0 }] {
        camera.film.filter = bad;
        description.camera = Some(camera.clone());
        assert!(matches!(Scene::new(description.clone()), Err(SceneError::Camera { .. })), "{bad:?}");
    }
}

#[test]
fn pooling_leaves_no_bundle_out_and_invents_no_comparison() {
    let ones = Block::from_fn(10, 1, |_, _| 1.0);
    // 10 bundles × 100 scores: two comparisons of four, the last two bundles joined to the second.
    let value = Block::from_fn(10, 1, |r, _| if r == 9 { 7.0 } else { 1.0 });
    let [reference, mean, variance] = pooled(&ones, &value, &ones, &[1.0; 10], 100, &[1.0]);
    assert_eq!((reference.n_rows(), reference.values()), (2, &[1.0, 1.0][..]));
    assert_eq!(mean.values(), [1.0, 2.0]);
    assert_eq!(variance.values(), [4.0 / 16.0, 6.0 / 36.0]);
    // Too few scores in all.
    assert_eq!(pooled(&ones, &value, &ones, &[1.0; 10], 4, &[1.0])[0].n_rows(), 0);
}

#[test]
fn a_dark_band_rests_while_a_bright_one_works() {
    // Albedos so different that the first band's residual would sink into the denormals.
    let scene = gallery::two_rooms();
    let mut description = scene.description().clone();
    for surface in &mut description.surfaces {
        surface.front = Arc::new(Lambert::new(vec![0.02, 0.02, 0.9999]));
        surface.back = surface.back.as_ref().map(|_| Arc::new(Lambert::new(vec![0.02, 0.02, 0.9999])) as _);
    }
    let scene = Scene::new(description).unwrap();
    let bundles = Bundles::new(&scene, Resolution { patch_size: 1.0, n_directions: 1 }).unwrap();
    let system = assemble(&scene, &bundles, Exchange::default()).unwrap();
    let answer = Cg { tolerance: 1e-10 }.solve(system.equation(), &mut ()).unwrap();
    assert_eq!(answer.report.stop, Stop::Converged);
    // A tolerance that nothing reaches ends all the same.
    let endless = Cg { tolerance: 1e-300 }.solve(system.equation(), &mut ()).unwrap();
    assert!(matches!(endless.report.stop, Stop::Stagnated | Stop::Converged), "{}", endless.report.stop);
    let direct = Lu.solve(system.equation(), &mut ()).unwrap();
    for band in 0..3 {
        let scale = direct.radiance.column(band).iter().fold(0.0, |m: f64, v| m.max(*v));
        let pairs = answer.radiance.column(band).iter().zip(direct.radiance.column(band));
        // The tolerance over the least absorption, 1e-4, on the scale of the emission.
        assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-6 * scale), "band {band}");
    }
}

#[test]
fn the_largest_of_numbers_keeps_what_is_none() {
    assert_eq!(worst([1.0, 3.0, 2.0].into_iter()), 3.0);
    for k in 0..3 {
        let mut values = [1.0, 3.0, 2.0];
        values[k] = f64::NAN;
        assert!(worst(values.into_iter()).is_nan());
    }
}
