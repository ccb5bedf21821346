//! Under refinement: the discrete truth is exact where it can be, and approaches the continuous one at its order.

use super::scenes::Case;
use etendue::assembly::{Exchange, Occlusion};
use etendue::compare::observed_order;
use etendue::gallery::{self, Continuous, Exact, MeanRadiance, PointRadiance};
use etendue::geometry::Vec3;
use etendue::linalg::Block;
use etendue::scene::Side;
use etendue::solver::{Lu, Solver};

/// The discrete means are given to twelve digits; exchange is asked for 1e-12.
const DISCRETE: f64 = 1e-11;

/// Exchange alone, its closure unrepaired: nothing sampled enters T of scenes without occluders.
fn unrepaired() -> Exchange {
    Exchange {
        tolerance: 1e-12,
        occlusion: Occlusion::Sampled { rays: 1, sink_rays: 1 },
        repair: false,
        ..Exchange::default()
    }
}

fn solved(case: &Case) -> Block {
    Lu.solve(case.system.equation(), &mut ()).unwrap().radiance
}

fn plates() -> Continuous {
    match gallery::parallel_plates_exact() {
        Exact::Continuous(exact) => exact,
        other => panic!("{other:?}"),
    }
}

/// Area mean of the radiance of a surface's front.
fn mean(case: &Case, radiance: &Block, surface: &str) -> f64 {
    let patches = (0..case.bundles.n_bundles()).map(|i| (i, case.bundles.patch(i).unwrap()));
    let (mut sum, mut area) = (0.0, 0.0);
    for (i, patch) in patches.filter(|(_, p)| case.scene.surface_of(p.facet).name == surface && p.side == Side::Front) {
        sum += patch.polygon.area() * radiance.get(i, 0);
        area += patch.polygon.area();
    }
    sum / area
}

fn worst_mean(case: &Case, radiance: &Block, means: &[MeanRadiance]) -> f64 {
    let error = |expected: &MeanRadiance| (mean(case, radiance, expected.surface) / expected.radiance[0] - 1.0).abs();
    means.iter().map(error).fold(0.0, f64::max)
}

#[test]
fn uniform_meshes_of_the_plates_have_their_discrete_means() {
    let exact = plates();
    assert_eq!(exact.uniform_patches.len(), 4);
    for uniform in &exact.uniform_patches {
        let case = Case::with("parallel-plates", 1.0 / uniform.n_per_side as f64, unrepaired());
        assert_eq!(case.system.n_bundles(), 2 * uniform.n_per_side * uniform.n_per_side);
        let error = worst_mean(&case, &solved(&case), &uniform.means);
        assert!(error < DISCRETE, "{} a side: {error:e}", uniform.n_per_side);
    }
}

/// Galerkin with constants: the kernel between the plates is smooth, so means (a functional tested with constants) err by O(h²), and
/// values at points by O(h), the variation within a patch.
#[test]
fn plates_converge_to_the_continuous_values_at_their_order() {
    let exact = plates();
    let (mut means, mut points) = (Vec::new(), Vec::new());
    for n in [4, 8, 16] {
        let h = 1.0 / f64::from(n);
        let case = Case::with("parallel-plates", h, unrepaired());
        let radiance = solved(&case);
        means.push((h, worst_mean(&case, &radiance, &exact.means)));

        let facet = |surface: &str| case.scene.surfaces().iter().position(|s| s.name == surface).unwrap();
        let error = |point: &PointRadiance| {
            let position = Vec3::from_array(point.position);
            let bundle = case.bundles.locate(facet(point.surface), Side::Front, position, position).unwrap();
            (radiance.get(bundle, 0) / point.radiance[0] - 1.0).abs()
        };
        points.push((h, exact.points.iter().map(error).fold(0.0, f64::max)));
    }
    let (of_means, of_points) = (observed_order(&means).unwrap(), observed_order(&points).unwrap());
    // Three levels short of the asymptote: a fifth of an order either way.
    assert!((of_means.order - 2.0).abs() < 0.2, "{of_means:?} {means:?}");
    assert!((of_points.order - 1.0).abs() < 0.2, "{of_points:?} {points:?}");
    assert!(means[2].1 < 1e-3, "{means:?}");
}

#[test]
fn furnaces_are_exact_at_every_level() {
    for (name, sizes) in [("furnace-cube", &[1.0, 0.5, 0.3, 0.2][..]), ("furnace-sphere", &[1.0])] {
        for patch_size in sizes {
            let case = Case::new(name, *patch_size);
            let Some(Exact::Uniform { radiance }) = (case.entry.exact)() else { panic!("{name}") };
            let answer = solved(&case);
            for (column, exact) in answer.columns().zip(&radiance) {
                let worst = column.iter().map(|l| (l / exact - 1.0).abs()).fold(0.0, f64::max);
                // Closure to 1e-14 and LU's own rounding, both over 1 − 0.9.
                assert!(worst < 1e-12, "{name} at {patch_size}: {worst:e}");
            }
        }
    }
}

/// Without any repair the rows close as well as the quadrature does: form factors of a closed convex scene sum to one.
#[test]
fn closed_convex_scenes_close_by_themselves() {
    for (name, patch_size) in [("furnace-cube", 0.25), ("furnace-sphere", 1.0)] {
        let case = Case::with(name, patch_size, unrepaired());
        let closure = case.system.laws().closure;
        // Each of some hundred entries may be off by its share of 1e-12.
        assert!(closure < 1e-11, "{name}: {closure:e}");
        assert_eq!(case.system.report().n_sampled, 0);
    }
}
