//! Tabulated surfaces.

use super::{direction, outgoing_directions};
use crate::sphere::{Cells, test_sampler};
use etendue::geometry::Vec3;
use etendue::sampling::{Streams, warp};
use etendue::scattering::{BlinnPhong, Brdf, HalfDifferenceTable, Lambert, PatchRings, TableError, Tabulated};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

/// Sums of a hundred products.
const ROUNDING: f64 = 1e-13;

/// A lawful table: a symmetric matrix of random numbers, scaled so that the whitest patch is white.
fn random_table(patches: PatchRings, seed: u64) -> Tabulated {
    let n = patches.n_patches();
    let mut stream = Streams::new(seed, "table").stream(0, 0);
    let mut values = vec![0.0; n * n];
    for i in 0..n {
        for o in 0..=i {
            let f = stream.uniform2()[0].powi(6);
            (values[i * n + o], values[o * n + i]) = (f, f);
        }
    }
    let albedo = Tabulated::as_measured("random", patches.clone(), vec![values.clone()]).unwrap().violations().albedo;
    let scaled = values.iter().map(|f| f / albedo).collect();
    let darker = values.iter().map(|f| 0.5 * f / albedo).collect();
    Tabulated::new("random", patches, vec![scaled, darker]).unwrap()
}

fn all_patches() -> [PatchRings; 3] {
    [PatchRings::klems_full(), PatchRings::klems_half(), PatchRings::klems_quarter()]
}

#[test]
fn patches_tile_the_hemisphere() {
    for (patches, n) in all_patches().into_iter().zip([145, 73, 41]) {
        assert_eq!(patches.n_patches(), n);
        let total: f64 = (0..n).map(|k| patches.projected_solid_angle(k)).sum();
        assert!((total - PI).abs() < ROUNDING);

        // Directions fall into patches by their projected solid angle, and a turn by 180° maps patches onto patches.
        let mut counts = vec![0.0; n];
        let mut stream = Streams::new(5, "patches").stream(0, 0);
        let mut image = vec![None; n];
        for _ in 0..200_000 {
            let direction = Vec3::from(warp::cosine_hemisphere(stream.uniform2()));
            let patch = patches.find(direction);
            let opposite = patches.find(Vec3::new(-direction.x, -direction.y, direction.z));
            counts[patch] += 1.0;
            assert_eq!(*image[patch].get_or_insert(opposite), opposite);
        }
        for (k, count) in counts.iter().enumerate() {
            let expected = 200_000.0 * patches.projected_solid_angle(k) / PI;
            // Seven standard deviations of a Poisson number.
            assert!((count - expected).abs() < 7.0 * expected.sqrt(), "patch {k}: {count} against {expected}");
        }
    }
}

#[test]
fn constant_tables_are_lamberts() {
    let patches = PatchRings::klems_half();
    let n = patches.n_patches();
    let table = Tabulated::new("grey", patches, vec![vec![0.6 * FRAC_1_PI; n * n]]).unwrap();
    let lambert = Lambert::grey(0.6, 1);
    for degrees in [0.0, 30.0, 70.0, 89.0] {
        let [a, b] = [direction(degrees, 0.7), direction(50.0, 0.2)];
        assert!((table.albedo(0, a) - 0.6).abs() < ROUNDING);
        assert!((table.eval(0, a, b) - lambert.eval(0, a, b)).abs() < 1e-16);
        assert!((table.pdf(a, b) - lambert.pdf(a, b)).abs() < ROUNDING);
    }
    let below = Vec3::new(0.6, 0.0, -0.8);
    assert_eq!((table.eval(0, below, Vec3::Z), table.albedo(0, below), table.pdf(Vec3::Z, below)), (0.0, 0.0, 0.0));
    assert!(table.sample(below, [0.5; 2]).is_none());
}

#[test]
fn tables_keep_every_law() {
    for (k, patches) in all_patches().into_iter().enumerate() {
        let table = random_table(patches, 17 + k as u64);
        assert!(table.violations().is_lawful());
        let mut stream = Streams::new(29, "pairs").stream(0, 0);
        for _ in 0..2000 {
            let [a, b] = [0, 1].map(|_| Vec3::from(warp::uniform_sphere(stream.uniform2())));
            assert_eq!(table.eval(0, a, b).to_bits(), table.eval(0, b, a).to_bits());
        }

        // Bands differ by a factor, so that every sample of f cosθ/pdf is the albedo.
        for outgoing in outgoing_directions(&table) {
            let albedo = table.albedo(0, outgoing);
            assert!((0.0..=1.0 + ROUNDING).contains(&albedo));
            for _ in 0..100 {
                let incident = table.sample(outgoing, stream.uniform2()).unwrap();
                let weight = table.eval(0, incident, outgoing) * incident.z / table.pdf(outgoing, incident);
                assert!((weight - albedo).abs() < 1e-12, "{weight} against {albedo}");
            }
        }
    }
}

/// Rings at equal steps of cosθ, so that cells and patches line up, and the density is smooth in each cell.
#[test]
fn tables_are_sampled_by_their_density() {
    let edge = |k: i32| (1.0 - 0.2 * f64::from(k)).acos().to_degrees();
    let mut rings: Vec<(f64, usize)> = (1..=5).map(|k| (edge(k), 12)).collect();
    rings[4].0 = 90.0;
    let table = random_table(PatchRings::new(&rings).unwrap(), 3);
    // Sectors are centred on azimuth 0: cells of half a sector line up with both.
    let cells = Cells { low: 0.0, n_rings: 10, n_sectors: 24 };
    for outgoing in outgoing_directions(&table) {
        let pdf = |incident| table.pdf(outgoing, incident);
        let test = test_sampler(cells, "table", 100_000, |u| table.sample(outgoing, u), pdf);
        assert!(test.p_value > 1e-7, "{test:?}");
    }
}

#[test]
fn unlawful_tables_are_refused_with_numbers() {
    let patches = PatchRings::klems_quarter();
    let n = patches.n_patches();
    let mut values = vec![0.3; n * n];
    values[3] = 0.1;
    let Err(TableError::Unlawful(violations)) = Tabulated::new("bent", patches.clone(), vec![values.clone()]) else {
        panic!("a table that is not reciprocal was taken");
    };
    assert!((violations.reciprocity - 2.0 / 3.0).abs() < 1e-15 && violations.albedo < 1.0);
    let mended = Tabulated::as_measured("bent", patches.clone(), vec![values]).unwrap().symmetrised();
    assert!(mended.violations().is_lawful());

    let bright = Tabulated::new("bright", patches.clone(), vec![vec![0.4; n * n]]);
    let Err(TableError::Unlawful(violations)) = bright else { panic!("a table brighter than white was taken") };
    assert!((violations.albedo - 0.4 * PI).abs() < ROUNDING && violations.reciprocity == 0.0);

    assert_eq!(Tabulated::new("none", patches.clone(), vec![]), Err(TableError::NoBand));
    let short = Tabulated::new("short", patches.clone(), vec![vec![0.0; 7]]);
    assert_eq!(short, Err(TableError::Length { band: 0, found: 7, expected: n * n }));
    let mut values = vec![0.1; n * n];
    values[n + 2] = -1.0;
    let negative = Tabulated::new("negative", patches, vec![values]);
    assert_eq!(negative, Err(TableError::Value { band: 0, incident: 2, outgoing: 1, value: -1.0 }));
    assert!(PatchRings::new(&[(30.0, 4), (20.0, 4), (90.0, 4)]).is_err() && PatchRings::new(&[(30.0, 4)]).is_err());
    assert!(PatchRings::new(&[]).is_err() && PatchRings::new(&[(90.0, 0)]).is_err());
}

#[test]
fn half_difference_tables_are_reciprocal_and_tell_their_albedo() {
    // Blinn and Phong's lobe in cells of half angles alone, and stripes in the azimuth of the difference.
    let n_cells = [60, 20, 24];
    let lobe = BlinnPhong::new(vec![0.8], 4.0).unwrap();
    let values = |striped: bool| {
        let cells = (0..n_cells.iter().product()).map(|k: usize| {
            let half = ((k / (20 * 24)) as f64 + 0.5) / 60.0;
            let normal = Vec3::from(warp::around_z((half * half * FRAC_PI_2).cos(), 0.0));
            let stripe = if striped && k.is_multiple_of(2) { 0.5 } else { 1.0 };
            stripe * lobe.eval(0, normal, normal)
        });
        cells.collect::<Vec<f64>>()
    };
    let table = HalfDifferenceTable::new("lobe", n_cells, vec![values(false), values(true)]).unwrap();
    let mut stream = Streams::new(41, "pairs").stream(0, 0);
    for _ in 0..5000 {
        let [a, b] = [0, 1].map(|_| Vec3::from(warp::uniform_sphere(stream.uniform2())));
        for band in 0..2 {
            assert_eq!(table.eval(band, a, b).to_bits(), table.eval(band, b, a).to_bits());
        }
        assert!(a.z > 0.0 && b.z > 0.0 || table.eval(0, a, b) == 0.0);
        // Turning the pair about the normal, or its mirror image, changes nothing but at the edges of cells.
        let image = |v: Vec3| Vec3::new(v.x, -v.y, v.z);
        let [left, right] = [table.eval(0, a, b), table.eval(0, image(a), image(b))];
        assert!((left - right).abs() < 0.05);
    }
    for degrees in [0.0, 40.0, 75.0] {
        let outgoing = direction(degrees, 0.4);
        let (albedo, exact) = (table.albedo_with_error(0, outgoing), lobe.albedo(0, outgoing));
        // Cells of 1.5° to 3° bend a lobe of 40° by their square.
        assert!((albedo.value - exact).abs() < 2e-3 && albedo.error < 2e-3, "{degrees}°: {albedo:?} against {exact}");
        // At the normal all pairs lie in one plane, on the edge between two stripes.
        let striped = table.albedo(1, outgoing);
        assert!(degrees == 0.0 || (striped - 0.75 * exact).abs() < 1e-2, "{degrees}°: {striped}");
    }
    let largest = lobe.albedo(0, warp::around_z(31.5 / 32.0, 0.0).into());
    assert!((table.largest_albedo() - largest).abs() < 2e-3);
    assert!(HalfDifferenceTable::new("short", [2, 2, 2], vec![vec![0.0; 7]]).is_err());
    assert!(HalfDifferenceTable::new("dark", [1, 1, 1], vec![vec![-1.0]]).is_err());
    assert!(HalfDifferenceTable::new("none", [1, 1, 1], vec![]).is_err());
}
