//! The four laws × every scene of the gallery, measured on the matrices from outside.

use super::scenes::{Case, coarse};
use etendue::assembly::{Exchange, Occlusion};
use etendue::linalg::{Block, LinearOperator};
use etendue::scene::Side;
use std::f64::consts::PI;

/// The laws' own bound: rows of a few hundred terms summed in f64 err by some 1e-14.
const LAW: f64 = 1e-12;
/// A product of three rounded factors taken in two orders: two roundings each way.
const TWO_ORDERS: f64 = 4.0 * f64::EPSILON;

/// The matrix of one band as its products with the unit vectors: what a solver sees, whatever is stored.
fn by_products(operator: &dyn LinearOperator, band: usize, n_bands: usize) -> Vec<Vec<f64>> {
    let n = operator.n_columns();
    let (mut x, mut y) = (Block::zeros(n, n_bands), Block::zeros(operator.n_rows(), n_bands));
    let mut rows = vec![vec![0.0; n]; operator.n_rows()];
    for j in 0..n {
        x.set(j, band, 1.0);
        operator.apply(&x, &mut y);
        x.set(j, band, 0.0);
        rows.iter_mut().enumerate().for_each(|(i, row)| row[j] = y.get(i, band));
    }
    rows
}

/// Étendue by area: π times half the length of Σ v × v', summed over the corners themselves.
fn etendue_by_hand(case: &Case, element: usize) -> f64 {
    let v = case.bundles.patch(element).unwrap().polygon.vertices();
    let doubled: etendue::geometry::Vec3 = (1..v.len() - 1).map(|k| (v[k] - v[0]).cross(v[k + 1] - v[0])).sum();
    0.5 * PI * doubled.length()
}

#[test]
fn exchange_is_symmetric_bit_for_bit_and_not_negative() {
    for case in coarse() {
        let exchange = by_products(case.system.exchange(), 0, 1);
        let mut stored = vec![0.0; exchange.len()];
        for (i, row) in exchange.iter().enumerate() {
            case.system.exchange().row(0, i, &mut stored);
            for (j, t) in row.iter().enumerate() {
                let name = case.entry.name;
                assert_eq!(t.to_bits(), exchange[j][i].to_bits(), "{name}: T[{i}, {j}] = {t:e}");
                assert_eq!(t.to_bits(), stored[j].to_bits(), "{name}: T[{i}, {j}] = {t:e}");
                assert!(*t >= 0.0, "{name}: T[{i}, {j}] = {t:e}");
            }
            // A flat patch sends nothing to itself.
            assert_eq!(row[i], 0.0);
        }
        assert_eq!(case.system.laws().reciprocity, 0.0);
        assert_eq!(case.system.laws().positivity, 0.0);
    }
}

#[test]
fn rows_of_exchange_and_sinks_sum_to_the_etendue_of_the_patch() {
    for case in coarse() {
        let mut row = vec![0.0; case.system.n_bundles()];
        let mut worst: f64 = 0.0;
        for i in 0..case.system.n_bundles() {
            let (element, bin) = case.bundles.element_of(i);
            assert_eq!((element, bin), (i, 0));
            let mu = etendue_by_hand(case, element);
            case.system.exchange().row(0, i, &mut row);
            let total: f64 = row.iter().sum::<f64>() + case.system.sinks().row(i).sum::<f64>();
            worst = worst.max((total / mu - 1.0).abs());
            assert!(case.system.sinks().row(i).all(|sink| sink >= 0.0), "{}", case.entry.name);
        }
        assert!(worst <= LAW, "{}: {worst:e}", case.entry.name);
        assert!(case.system.laws().closure <= LAW, "{}", case.entry.name);
    }
}

#[test]
fn closed_scenes_lose_no_ray_and_open_ones_do() {
    for case in coarse() {
        let sinks = case.system.sinks();
        let total = |sink: usize| sinks.column(sink).iter().sum::<f64>();
        if case.entry.closed {
            assert_eq!((total(0), total(1)), (0.0, 0.0), "{}", case.entry.name);
        } else {
            assert!(total(0) > 0.0, "{}", case.entry.name);
        }
    }
}

#[test]
fn scattering_conserves_energy_band_by_band() {
    for case in coarse() {
        let (n, n_bands) = (case.system.n_bundles(), case.system.n_bands());
        let scattering = case.system.transport().scattering();
        let ones = Block::from_fn(n, n_bands, |_, _| 1.0);
        let mut scattered = Block::zeros(n, n_bands);
        scattering.apply(&ones, &mut scattered);
        for i in 0..n {
            let patch = case.bundles.patch(i).unwrap();
            let surface = case.scene.surface_of(patch.facet);
            let albedo = surface.brdf(patch.side).unwrap().lambertian().unwrap();
            for (band, a) in albedo.iter().enumerate() {
                // One bin: the row of R, and its column, is μ a alone.
                assert_eq!(scattered.get(i, band), *a);
                let redistribution = case.system.etendue()[i] * scattered.get(i, band);
                assert!((0.0..=case.system.etendue()[i] * (1.0 + LAW)).contains(&redistribution));
                let emitted = if patch.side == Side::Front { surface.emission[band] } else { 0.0 };
                assert_eq!(case.system.emission().get(i, band), emitted);
            }
        }
        assert!(case.system.laws().conservation <= LAW);
    }
}

#[test]
fn transport_is_one_matrix_whichever_way_it_is_read() {
    for name in ["parallel-plates", "cornell-box"] {
        let case = super::scenes::find(name);
        let (n, n_bands) = (case.system.n_bundles(), case.system.n_bands());
        let transport = case.system.transport();
        let exchange = by_products(case.system.exchange(), 0, 1);
        for band in 0..n_bands {
            let products = by_products(transport, band, n_bands);
            let (mut row, mut column, mut diagonal) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
            transport.diagonal(band, &mut diagonal);
            let (mut unit, mut transposed) = (Block::zeros(n, n_bands), Block::zeros(n, n_bands));
            for i in 0..n {
                transport.row(band, i, &mut row);
                transport.column(band, i, &mut column);
                unit.set(i, band, 1.0);
                transport.apply_transpose(&unit, &mut transposed);
                unit.set(i, band, 0.0);
                let albedo = transport.scattering().values().get(i, band);
                for j in 0..n {
                    let expected = albedo * exchange[i][j] / case.system.etendue()[i];
                    for read in [row[j], products[i][j], transposed.get(j, band)] {
                        assert!((read - expected).abs() <= TWO_ORDERS * expected, "{name}: K[{i}, {j}]");
                    }
                    assert!((column[j] - products[j][i]).abs() <= TWO_ORDERS * column[j], "{name}: K[{j}, {i}]");
                }
                assert_eq!(diagonal[i], 0.0);
            }
        }
    }
}

#[test]
fn undoing_the_repair_gives_the_unrepaired_system() {
    let repaired = super::scenes::find("cornell-box");
    let settings =
        Exchange { occlusion: Occlusion::Sampled { rays: 24, sink_rays: 256 }, repair: false, ..Exchange::default() };
    let raw = Case::with("cornell-box", repaired.bundles.resolution().patch_size, settings);
    let undone = repaired.system.without_repair();

    let n = raw.system.n_bundles();
    let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
    for i in 0..n {
        raw.system.exchange().row(0, i, &mut a);
        undone.exchange().row(0, i, &mut b);
        // d · (1/d) on either side: four roundings.
        let alike = |(a, b): (&f64, &f64)| (a - b).abs() <= 2.0 * TWO_ORDERS * a.abs();
        assert!(a.iter().zip(&b).all(alike));
        let (a, b): (Vec<f64>, Vec<f64>) = (raw.system.sinks().row(i).collect(), undone.sinks().row(i).collect());
        assert!(a.iter().zip(&b).all(alike));
    }
    assert!(raw.system.report().repair.is_none() && undone.report().repair.is_none());

    // What the repair was for: closure fails by the sampling before it, and by rounding after it.
    let report = repaired.system.report();
    let repair = report.repair.unwrap();
    let open = undone.laws().closure;
    assert!(open > 1e-4 && (open - raw.system.laws().closure).abs() < LAW, "{open:e}");
    assert!((report.closure_before_repair - raw.system.laws().closure).abs() < LAW);
    assert!(repair.after <= LAW && repair.strongest > 1e-4 && repair.sweeps > 0);
    assert_eq!(undone.laws().reciprocity, 0.0);
}
