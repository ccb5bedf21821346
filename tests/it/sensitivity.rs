//! Derivatives from one adjoint solution against differences of solutions, and what-if answers against fresh ones.

use super::scenes;
use etendue::linalg::{Block, Dense, LinearOperator};
use etendue::scene::Side;
use etendue::solver::{Gth, Lu, RowChange, Solver};
use etendue::study::{Quantity, Sensor, sensitivity, weights};

/// Relative to the largest derivative: ten digits of differences whose five steps leave h¹⁰ and 1e-16 / h.
const AGREEMENT: f64 = 1e-10;

/// The largest step of an albedo; halved four times.
const STEP: f64 = 0.04;

/// d f / d x at x by central differences, extrapolated to step zero in even powers.
fn derivative(f: impl Fn(f64) -> f64, x: f64) -> f64 {
    let difference = |h: f64| (f(x + h) - f(x - h)) / (2.0 * h);
    let mut table: Vec<f64> = (0..5).map(|k| difference(STEP / f64::from(1 << k))).collect();
    for order in 1..table.len() {
        let factor = 4f64.powi(order as i32);
        for k in (order..table.len()).rev() {
            table[k] += (table[k] - table[k - 1]) / (factor - 1.0);
        }
    }
    table[table.len() - 1]
}

#[test]
fn derivatives_are_those_of_differences() {
    for (name, quantity) in [("cornell-box", Quantity::Irradiance), ("two-rooms", Quantity::Radiance)] {
        let case = scenes::find(name);
        let sensor = Sensor { quantity, surface: 0 };
        let found = sensitivity(&case.scene, &case.bundles, &case.system, sensor, &Lu).unwrap();
        let measurement = weights(&case.scene, &case.bundles, &case.system, sensor);
        let albedo = case.system.transport().scattering().values();
        let surface_of = |i: usize| {
            let patch = case.bundles.patch(case.bundles.element_of(i).0).unwrap();
            (case.scene.facets()[patch.facet].surface, patch.side)
        };
        let n = case.system.n_bundles();
        for band in 0..case.system.n_bands() {
            let reading = |system: &etendue::assembly::System| {
                let radiance = Lu.solve(system.equation(), &mut ()).unwrap().radiance;
                system.inner(&measurement, &radiance)[band]
            };
            let scale = found.surfaces.iter().map(|s| s.albedo[band]).fold(0.0, f64::max);
            for (s, surface) in found.surfaces.iter().enumerate() {
                // One surface's albedo, in this band.
                let at = |shift: f64| {
                    let is_moved = |i: usize, b: usize| b == band && surface_of(i).0 == s;
                    let moved = |i, b| albedo.get(i, b) + if is_moved(i, b) { shift } else { 0.0 };
                    reading(&case.system.with_albedo(Block::from_fn(n, case.system.n_bands(), moved)))
                };
                let expected = derivative(at, 0.0);
                let error = (surface.albedo[band] - expected).abs() / scale;
                assert!(error <= AGREEMENT, "{name}, {}: {} {expected}", surface.surface, surface.albedo[band]);
            }

            // L is linear in E: the reading is the sum of its parts.
            let total: f64 = (0..n)
                .filter(|i| surface_of(*i).1 == Side::Front)
                .map(|i| found.surfaces[surface_of(i).0].emission[band] / count(case, i) * emission(case, i, band))
                .sum();
            assert!((total / found.reading[band] - 1.0).abs() < AGREEMENT, "{name}: {total}");
            assert!((found.dual_reading[band] / found.reading[band] - 1.0).abs() < 1e-13, "{name}");
        }
    }
}

/// Front bundles of the surface that bundle i is on: emission is alike on all of them.
fn count(case: &scenes::Case, i: usize) -> f64 {
    let of = |k: usize| {
        let patch = case.bundles.patch(case.bundles.element_of(k).0).unwrap();
        (case.scene.facets()[patch.facet].surface, patch.side)
    };
    (0..case.system.n_bundles()).filter(|k| of(*k) == (of(i).0, Side::Front)).count() as f64
}

fn emission(case: &scenes::Case, i: usize, band: usize) -> f64 {
    case.system.emission().get(i, band)
}

#[test]
fn what_if_answers_are_those_of_a_fresh_solution() {
    let case = scenes::find("cornell-box");
    let (n, n_bands) = (case.system.n_bundles(), case.system.n_bands());
    let albedo = case.system.transport().scattering().values();
    let propagation = case.system.transport().propagation();
    let factored = [Lu.factor(case.system.equation()).unwrap(), Gth.factor(case.system.equation()).unwrap()];
    let mut row = vec![0.0; n];
    for (rows, change) in [(vec![3], -0.2), ((10..40).collect::<Vec<_>>(), 0.1), (vec![], 0.0)] {
        let moved = |i: usize, band: usize| albedo.get(i, band) + if rows.contains(&i) { change } else { 0.0 };
        let fresh = case.system.with_albedo(Block::from_fn(n, n_bands, moved));
        let expected = Lu.solve(fresh.equation(), &mut ()).unwrap().radiance;
        let mut added = Dense::zeros(rows.len(), n);
        for (k, i) in rows.iter().enumerate() {
            propagation.row(0, *i, &mut row);
            added.row_mut(k).iter_mut().zip(&row).for_each(|(v, g)| *v = change * g);
        }
        for band in 0..n_bands {
            let what = RowChange { band, rows: rows.clone(), change: added.clone() };
            for factored in &factored {
                let found = factored.what_if(&what, case.system.emission().column(band)).unwrap();
                let scale = expected.column(band).iter().copied().fold(0.0, f64::max);
                let worst = found.iter().zip(expected.column(band)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(worst <= 1e-13 * scale, "{} rows: {worst:e}", rows.len());
            }
        }
    }
}
