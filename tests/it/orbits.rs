//! Orbits: what symmetries carry into each other has one unknown, and the same answer as without them.

use etendue::assembly::{Exchange, Occlusion, Orbits, assemble, assemble_orbits};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::geometry::{Affine3, Mat3, Vec3};
use etendue::linalg::LinearOperator;
use etendue::scene::Scene;
use etendue::solver::{Lu, Solver};

/// The reflection that exchanges low and high x of a cube with this centre.
fn mirror(centre: Vec3, normal: Vec3) -> Affine3 {
    let image = |v: Vec3| v - 2.0 * normal.dot(v) * normal;
    let matrix = Mat3::from_cols(image(Vec3::X), image(Vec3::Y), image(Vec3::Z));
    Affine3::from_mat3_translation(matrix, 2.0 * normal.dot(centre) * normal)
}

fn middle(scene: &Scene) -> Vec3 {
    let corners = || (0..scene.facets().len()).flat_map(|facet| scene.polygon(facet).vertices());
    let low = corners().fold(Vec3::INFINITY, |low, v| low.min(*v));
    let high = corners().fold(Vec3::NEG_INFINITY, |high, v| high.max(*v));
    0.5 * (low + high)
}

fn settings() -> Exchange {
    Exchange {
        tolerance: 1e-13,
        occlusion: Occlusion::Exact { tolerance: 1e-11 },
        repair: false,
        ..Exchange::default()
    }
}

#[test]
fn plates_on_orbits_have_the_radiance_and_the_exchange_that_they_have_in_full() {
    let scene = gallery::parallel_plates();
    let bundles = Bundles::new(&scene, Resolution { patch_size: 0.25, n_directions: 1 }).unwrap();
    let full = assemble(&scene, &bundles, settings()).unwrap();
    let radiance = Lu.solve(full.equation(), &mut ()).unwrap().radiance;

    let diagonal = (Vec3::X - Vec3::Y).normalize();
    let candidates = [Vec3::X, Vec3::Y, diagonal].map(|normal| mirror(middle(&scene), normal));
    for (n_candidates, n_orbits) in [(0, 32), (1, 16), (2, 8), (3, 6)] {
        let orbits = Orbits::new(&scene, &bundles, |_| true, &candidates[..n_candidates]);
        assert_eq!(orbits.n_orbits(), n_orbits);
        let (folded, error) = assemble_orbits(&scene, &bundles, &orbits, &|_, _| true, settings()).unwrap();
        let alike = Lu.solve(folded.equation(), &mut ()).unwrap().radiance;
        for bundle in 0..bundles.n_bundles() {
            let orbit = orbits.orbit_of(bundle).unwrap();
            // Exchange to 1e-13, over 1 − albedo.
            assert!((alike.get(orbit, 0) / radiance.get(bundle, 0) - 1.0).abs() < 1e-11);
        }
        // T_IJ is the sum of all pairs.
        let mut row = vec![0.0; n_orbits];
        for (i, error) in error.iter().enumerate() {
            folded.exchange().row(0, i, &mut row);
            for (j, value) in row.iter().enumerate() {
                let mut sum = 0.0;
                for k in orbits.members(i) {
                    full.exchange().for_each_in_row(*k, |l, t| {
                        sum += if orbits.orbit_of(l) == Some(j) { t } else { 0.0 };
                    });
                }
                assert!((value - sum).abs() <= 1e-12 * folded.etendue()[i], "{i} {j}: {value} {sum}");
            }
            assert!(*error < 1e-11 * folded.etendue()[i]);
        }
    }
}

#[test]
fn what_is_no_symmetry_is_left_out_and_so_are_surfaces_that_only_stand_in_the_way() {
    let scene = gallery::parallel_plates();
    let bundles = Bundles::new(&scene, Resolution { patch_size: 0.5, n_directions: 1 }).unwrap();
    // A mirror off the middle, a turn by an odd angle, and a reflection that exchanges the two plates.
    let off = mirror(middle(&scene) + 1e-6 * Vec3::X, Vec3::X);
    let turned = Affine3::from_mat3(Mat3::from_rotation_z(0.1));
    let exchanged = mirror(middle(&scene), Vec3::Z);
    assert_eq!(Orbits::new(&scene, &bundles, |_| true, &[off, turned, exchanged]).n_orbits(), bundles.n_bundles());

    let half = Orbits::new(&scene, &bundles, |surface| surface == 0, &[]);
    assert_eq!(half.n_orbits(), bundles.n_bundles() / 2);
    assert!((0..bundles.n_bundles()).filter(|bundle| half.orbit_of(*bundle).is_none()).count() == half.n_orbits());
}

/// Pairs that differ by steps are computed once: no entry changes by more than the quadrature's tolerance.
#[test]
fn patches_in_rows_exchange_what_they_do_one_by_one() {
    for (scene, axes) in [
        (gallery::parallel_plates(), vec![Vec3::X, Vec3::Y]),
        (gallery::furnace_cube(&[0.5], &[1.0]).unwrap(), vec![Vec3::X, Vec3::Y, Vec3::Z]),
        // Here something stands between some of those that differ by steps.
        (gallery::corner_box(), vec![Vec3::X, Vec3::Y, Vec3::Z]),
    ] {
        let bundles = Bundles::new(&scene, Resolution { patch_size: 0.25, n_directions: 1 }).unwrap();
        let orbits = Orbits::new(&scene, &bundles, |_| true, &[]);
        // Steps that lead nowhere do no harm.
        let steps: Vec<Vec3> = axes.iter().flat_map(|axis| [0.25 * *axis, 0.1 * *axis, Vec3::ZERO]).collect();
        let in_rows = orbits.clone().in_rows(&scene, &bundles, &steps);
        let [one_by_one, in_rows] = [orbits, in_rows]
            .map(|orbits| assemble_orbits(&scene, &bundles, &orbits, &|_, _| true, settings()).unwrap().0);
        let n = bundles.n_bundles();
        let (mut row, mut other) = (vec![0.0; n], vec![0.0; n]);
        for i in 0..n {
            one_by_one.exchange().row(0, i, &mut row);
            in_rows.exchange().row(0, i, &mut other);
            for (a, b) in row.iter().zip(&other) {
                // Twice the tolerance of the quadrature, and that of occlusion.
                assert!((a - b).abs() <= 2e-13 * a + 2e-11 * one_by_one.etendue()[i], "{} {i}: {a} {b}", scene.name());
            }
        }
    }
}
