//! Methods with a coarse space: as fast for nearly white scenes as for grey ones.

use super::scenes::{self, Case};
use etendue::assembly::System;
use etendue::compare::relative_max;
use etendue::linalg::{Block, Equation, Hierarchy, LinearOperator, SelfAdjoint};
use etendue::solver::{
    Cg, DeflatedCg, DeflatedGmres, Gmres, Gth, Iteration, Multigrid, Perron, Solution, SolveError, Solver, Stop,
    TwoGrid,
};
use std::ops::ControlFlow;

/// Asked of the residual, and of the error against elimination without subtraction.
const TOLERANCE: f64 = 1e-12;

/// The case with every albedo that is not zero set to this, or none changed.
fn painted(case: &Case, albedo: Option<f64>) -> System {
    let own = case.system.transport().scattering().values();
    let chosen = |i: usize, band: usize| match albedo {
        Some(albedo) if own.get(i, band) > 0.0 => albedo,
        _ => own.get(i, band),
    };
    case.system.with_albedo(Block::from_fn(own.n_rows(), own.n_columns(), chosen))
}

fn solve(solver: &dyn Solver, equation: Equation<'_>) -> Solution {
    solver.solve(equation, &mut ()).unwrap_or_else(|error| panic!("{}: {error}", solver.name()))
}

/// The criterion: at most 12 products in single rooms and 20 where rooms are joined, to 1e-12, whatever is absorbed. Products count the
/// reading of K for the coarse equation, its elimination, and every pass over what is stored beside K.
#[test]
fn the_albedo_does_not_matter() {
    for (name, patch_size, most) in [
        ("furnace-cube", 0.125, 12.0),
        ("cornell-box", 0.2, 12.0),
        ("corner-box", 0.12, 12.0),
        ("two-rooms", 0.5, 20.0),
        ("maze", 0.5, 20.0),
    ] {
        let case = Case::new(name, patch_size);
        for albedo in [None, Some(0.9), Some(0.999), Some(1.0 - 1e-6), Some(1.0 - 1e-12)] {
            let system = painted(&case, albedo);
            let reference = solve(&Gth, system.equation());
            let answer = solve(&DeflatedCg { tolerance: TOLERANCE, n_groups: None }, system.equation());
            let report = &answer.report;
            let label = format!("{name} at {albedo:?}: {} products", report.products);
            assert_eq!(report.stop, Stop::Converged, "{label}");
            assert!(report.products <= most, "{label}");
            let error = relative_max(&answer.radiance, &reference.radiance);
            assert!(error <= 2.0 * TOLERANCE, "{label}, error {error:e}");
            // What can be verified from L alone: rounding L leaves so many ulp of it in its residual.
            let scale = (answer.radiance.max_abs() / case.system.emission().max_abs()).max(1.0);
            assert!(report.true_residual <= TOLERANCE * scale, "{label}, residual {:e}", report.true_residual);
        }
    }
}

/// Undeflated, the same albedos cost ever more products, and all the digits unless they are won back by corrections.
#[test]
fn plain_conjugate_gradients_lose_what_deflation_keeps() {
    let case = Case::new("two-rooms", 0.5);
    let system = painted(&case, Some(1.0 - 1e-12));
    let reference = solve(&Gth, system.equation());
    let unknown = Equation { absorption: None, ..system.equation() };
    let plain = solve(&Cg { tolerance: TOLERANCE }, unknown);
    assert!(relative_max(&plain.radiance, &reference.radiance) > 1e-6 && plain.report.products > 40.0);
    let refined = solve(&Cg { tolerance: TOLERANCE }, system.equation());
    // The tolerance over the lamp's share of the walls, some hundredth.
    assert!(relative_max(&refined.radiance, &reference.radiance) <= 100.0 * TOLERANCE);
    assert!(refined.report.n_refinements > 0 && refined.report.products > plain.report.products);
    let two_grid = solve(&TwoGrid { tolerance: TOLERANCE, n_groups: None }, system.equation());
    assert!(relative_max(&two_grid.radiance, &reference.radiance) <= TOLERANCE);
    assert_eq!(two_grid.report.n_refinements, 0);
    assert!(two_grid.report.products < plain.report.products);
}

/// Radiance of a finer mesh gathered onto the patches of this one, band 0.
fn gathered(case: &Case, finer: &Case, radiance: &Block) -> Vec<f64> {
    let n = case.system.n_bundles();
    let (mut sums, mut weights) = (vec![0.0; n], vec![0.0; n]);
    for i in 0..finer.system.n_bundles() {
        let patch = finer.bundles.patch(i).unwrap();
        let centroid = patch.polygon.centroid();
        let k = case.bundles.locate(patch.facet, patch.side, centroid, patch.polygon.normal()).unwrap();
        sums[k] += finer.system.etendue()[i] * radiance.get(i, 0);
        weights[k] += finer.system.etendue()[i];
    }
    sums.iter().zip(&weights).map(|(sum, weight)| sum / weight).collect()
}

/// Root mean square of a − b over étendue, relative to b's.
fn relative_distance(case: &Case, a: &[f64], b: &[f64]) -> f64 {
    let mean =
        |f: &dyn Fn(usize) -> f64| case.system.etendue().iter().enumerate().map(|(i, mu)| mu * f(i)).sum::<f64>();
    (mean(&|i| (a[i] - b[i]).powi(2)) / mean(&|i| b[i].powi(2))).sqrt()
}

#[test]
fn a_few_products_reach_the_error_of_the_mesh() {
    for (name, coarse, fine, most) in [
        ("corner-box", 0.2, 0.1, 3.0),
        ("cornell-box", 0.25, 0.125, 3.0),
        ("two-rooms", 0.5, 0.25, 3.0),
        ("maze", 0.5, 0.3, 3.0),
    ] {
        let (case, finer) = (Case::new(name, coarse), Case::new(name, fine));
        let solved = |case: &Case| solve(&Cg { tolerance: TOLERANCE }, case.system.equation()).radiance;
        let (truth, reference) = (solved(&case), solved(&finer));
        let mesh_error = relative_distance(&case, truth.column(0), &gathered(&case, &finer, &reference));
        // The last iterate that these products have paid for, reading K for the coarse equation among them.
        let mut afforded = None;
        let mut watch = |iteration: Iteration<'_>| {
            if iteration.products > most {
                return ControlFlow::Break(());
            }
            afforded = Some(iteration.iterate.clone());
            ControlFlow::Continue(())
        };
        let solver = TwoGrid { tolerance: TOLERANCE, n_groups: None };
        solver.solve(case.system.equation(), &mut watch).unwrap();
        let error = relative_distance(&case, afforded.unwrap().column(0), truth.column(0));
        assert!(error < mesh_error, "{name}: {error:e}, mesh {mesh_error:e}");
    }
}

/// What an iteration takes off the residual, over the second half of a solve.
fn rate(history: &[f64]) -> f64 {
    let (last, middle) = (history.len() - 1, history.len() / 2);
    (history[last] / history[middle]).powf(1.0 / (last - middle) as f64)
}

/// The second kind: halve the patches, and an iteration takes off the more; the albedo has no part in it.
#[test]
fn multigrid_converges_the_faster_the_finer_the_mesh() {
    for (name, sizes) in [("two-rooms", [1.0, 0.5]), ("cornell-box", [0.5, 0.25])] {
        for n_visits in [1, 2] {
            let solver = Multigrid { tolerance: TOLERANCE, n_visits };
            for albedo in [0.9, 1.0 - 1e-9] {
                let rates = sizes.map(|size| {
                    let case = Case::new(name, size);
                    let system = painted(&case, Some(albedo));
                    let answer = solve(&solver, system.equation());
                    let reference = solve(&Gth, system.equation());
                    let error = relative_max(&answer.radiance, &reference.radiance);
                    assert!(error <= 1e-10, "{name} {size}: {error:e}");
                    rate(&answer.report.history)
                });
                assert!(rates[1] < 0.75 * rates[0] && rates[0] < 0.5, "{name} {n_visits} {albedo}: {rates:?}");
            }
        }
    }
}

/// Nested iteration: the first answer of multigrid, one bounce from the coarse levels', is nearer than two-grid's, which has no finer level.
#[test]
fn multigrid_begins_where_two_grid_does_or_nearer() {
    let case = Case::new("corner-box", 0.12);
    let truth = solve(&Gth, case.system.equation()).radiance;
    let first = |solver: &dyn Solver| {
        let mut stop = |_: Iteration<'_>| ControlFlow::Break(());
        relative_max(&solver.solve(case.system.equation(), &mut stop).unwrap().radiance, &truth)
    };
    let two_grid = first(&TwoGrid { tolerance: TOLERANCE, n_groups: None });
    let multigrid = first(&Multigrid { tolerance: TOLERANCE, n_visits: 2 });
    assert!(multigrid < two_grid && multigrid < 0.05, "{multigrid:e} {two_grid:e}");
}

#[test]
fn importance_is_solved_alike() {
    let case = scenes::find("corner-box");
    let measurement = Block::from_fn(case.system.n_bundles(), case.system.n_bands(), |i, _| f64::from(i % 7 == 0));
    let adjoint = case.system.adjoint();
    let reference = solve(&Gth, adjoint.equation(&measurement));
    let solvers: [&dyn Solver; 4] = [
        &Multigrid { tolerance: TOLERANCE, n_visits: 1 },
        &DeflatedCg { tolerance: TOLERANCE, n_groups: None },
        &TwoGrid { tolerance: TOLERANCE, n_groups: None },
        &Perron { tolerance: TOLERANCE },
    ];
    for solver in solvers {
        let answer = solve(solver, adjoint.equation(&measurement));
        let error = relative_max(&answer.radiance, &reference.radiance);
        assert!(error < 10.0 * TOLERANCE, "{}: {error:e}", solver.name());
    }
}

#[test]
fn equations_without_a_form_are_solved_on_their_rows_or_refused() {
    let case = scenes::find("cornell-box");
    let plain = Equation::plain(case.system.transport(), case.system.emission());
    let reference = solve(&Gth, plain);
    for (solver, n_groups) in [(None, 1), (Some(1), 1), (Some(8), 8)] {
        let hierarchy: Option<&Hierarchy> = (n_groups > 1).then(|| case.system.hierarchy());
        let answer = solve(&TwoGrid { tolerance: TOLERANCE, n_groups: solver }, Equation { hierarchy, ..plain });
        assert!(relative_max(&answer.radiance, &reference.radiance) < 10.0 * TOLERANCE);
    }
    let refused = DeflatedCg { tolerance: TOLERANCE, n_groups: None }.solve(plain, &mut ());
    assert_eq!(refused.err(), Some(SolveError::NoSelfAdjointForm { method: "deflated-cg" }));

    // One patch said to be larger than it is.
    let form = case.system.equation().self_adjoint.unwrap();
    let mut etendue = form.etendue.to_vec();
    etendue[0] *= 1.001;
    let self_adjoint = Some(SelfAdjoint { etendue: &etendue, ..form });
    let refused = DeflatedCg { tolerance: TOLERANCE, n_groups: None }
        .solve(Equation { self_adjoint, ..case.system.equation() }, &mut ());
    assert!(matches!(refused, Err(SolveError::NotSelfAdjoint { method: "deflated-cg", .. })));
}

#[test]
fn hierarchies_follow_facets_and_sides() {
    let case = Case::new("two-rooms", 0.5);
    let (levels, n) = (case.system.hierarchy().levels(), case.system.n_bundles());
    assert!(levels[0].n_groups() < n && levels.last().unwrap().n_groups() == 1);
    for pair in levels.windows(2) {
        assert!(pair[0].onto(&pair[1]).is_some() && pair[1].n_groups() < pair[0].n_groups());
    }
    // No group but the last has patches of two planes or two sides.
    for level in &levels[..levels.len() - 2] {
        let mut kinds = vec![None; level.n_groups()];
        for i in 0..n {
            let patch = case.bundles.patch(i).unwrap();
            let kind = (patch.facet, patch.side);
            assert_eq!(*kinds[level.group_of(i)].get_or_insert(kind), kind);
        }
    }
    assert_eq!(case.system.transport().n_rows(), n);
}

#[test]
fn minimal_residuals_need_fewer_iterations_on_a_coarse_space() {
    // Without the form nothing is known of symmetry.
    let case = Case::new("two-rooms", 0.5);
    let equation = Equation { self_adjoint: None, ..case.system.equation() };
    let reference = solve(&Gth, equation);
    let plain = solve(&Gmres { tolerance: TOLERANCE, restart: 30, preconditioner: None }, equation);
    let deflated = solve(&DeflatedGmres { tolerance: TOLERANCE, n_groups: None }, equation);
    for answer in [&plain, &deflated] {
        assert!(relative_max(&answer.radiance, &reference.radiance) < 10.0 * TOLERANCE, "{}", answer.report.method);
    }
    assert_eq!(deflated.report.method, "deflated-gmres");
    assert!(deflated.report.n_iterations < plain.report.n_iterations);
}

#[test]
fn two_grid_converges_by_its_factor() {
    let case = Case::new("corner-box", 0.2);
    let solver = TwoGrid { tolerance: 1e-13, n_groups: None };
    for albedo in [Some(0.9), Some(1.0 - 1e-9)] {
        let system = painted(&case, albedo);
        let factors = solver.factor(system.equation(), 60).unwrap();
        let factor = factors.iter().copied().fold(0.0, f64::max);
        let history = solve(&solver, system.equation()).report.history;
        // The last six iterations, which the slowest modes have to themselves.
        let (first, last) = (history[history.len() - 7], history[history.len() - 1]);
        let met = (last / first).powf(1.0 / 6.0);
        assert!(factor < 0.6 && (met / factor - 1.0).abs() < 0.15, "{met} {factor}");
    }
}
