//! Partly visible pairs, integrated: against reference form factors, and closure of whole scenes before any repair.

use super::form_factors::OCCLUDED;
use super::scenes::{polygon, scene_of};
use etendue::assembly::{Exchange, Occlusion, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::linalg::LinearOperator;
use std::f64::consts::PI;

/// Asked of Tᵢⱼ / min(μᵢ, μⱼ).
const TOLERANCE: f64 = 1e-7;

#[test]
fn integrated_pairs_match_the_reference_to_the_tolerance() {
    for pair in OCCLUDED {
        let polygons: Vec<_> = [pair.first, pair.second].iter().chain(pair.occluders).map(|v| polygon(v)).collect();
        let scene = scene_of(&polygons, true);
        let bundles = Bundles::new(&scene, Resolution { patch_size: 1e12, n_directions: 1 }).unwrap();
        let occlusion = Occlusion::Exact { tolerance: TOLERANCE };
        let settings = Exchange { occlusion, sink_rays: 1, repair: false, ..Exchange::default() };
        let system = assemble(&scene, &bundles, settings).unwrap();

        // Every polygon has a bundle on either side, front first: the fronts of the pair are 0 and 2.
        let mut row = vec![0.0; system.n_bundles()];
        system.exchange().row(0, 0, &mut row);
        let found = row[2] / (PI * polygons[0].area());
        // The tolerance is on the smaller of the two étendues.
        let smaller = polygons[0].area().min(polygons[1].area()) / polygons[0].area();
        let error = (found - pair.form_factor).abs();
        assert!(error <= TOLERANCE * smaller, "{}: {found} for {}, off by {error:e}", pair.id, pair.form_factor);
        assert_eq!(system.report().n_sampled, 0, "{}", pair.id);
    }
}

#[test]
fn closure_before_repair_falls_with_the_tolerance() {
    let scene = gallery::two_rooms();
    let bundles = Bundles::new(&scene, Resolution { patch_size: 1.0, n_directions: 1 }).unwrap();
    let closure = |tolerance: f64| {
        let occlusion = Occlusion::Exact { tolerance };
        let settings = Exchange { occlusion, sink_rays: 64, repair: false, ..Exchange::default() };
        assemble(&scene, &bundles, settings).unwrap().report().closure_before_repair
    };
    // A row has some hundred pairs: their errors add up to less than a hundred tolerances.
    for tolerance in [1e-4, 1e-6, 1e-8] {
        let found = closure(tolerance);
        assert!(found <= 100.0 * tolerance, "{tolerance:e}: {found:e}");
    }
    assert!(closure(1e-8) < 1e-8);
}
