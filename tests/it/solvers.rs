//! Every solver × every scene of the gallery.

use super::scenes::{self, coarse};
use etendue::assembly::{RepairMethod, System};
use etendue::compare::relative_max;
use etendue::gallery::Exact;
use etendue::linalg::{Block, Dense, Equation, LinearOperator, Range, SelfAdjoint};
use etendue::solver::{self, Budget, Cg, Gth, Iteration, Lu, Neumann, Observer, Solution, SolveError, Solver, Stop};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Residual asked of the iterative methods.
const TOLERANCE: f64 = 1e-13;
/// With ‖(I − K)⁻¹‖ ≤ 1/(1 − 0.9) a residual of 1e-13 is an error of 1e-12; the rest is for scenes whose solution is dimmer than E.
const AGREEMENT: f64 = 1e-10;
/// 1e-13 ‖E‖ of residual is 1e-13 ‖L‖ of error in a furnace; LU loses cond ≤ 20 × some ulp.
const FURNACE: f64 = 1e-12;

fn solve(solver: &dyn Solver, equation: Equation<'_>) -> Solution {
    solver.solve(equation, &mut ()).unwrap_or_else(|error| panic!("{}: {error}", solver.name()))
}

#[test]
fn all_solvers_agree_on_all_scenes() {
    for case in coarse() {
        let reference = solve(&Lu, case.system.equation());
        let solvers = solver::all(TOLERANCE);
        for solver in &solvers {
            let answer = solve(&**solver, case.system.equation());
            let report = &answer.report;
            let error = relative_max(&answer.radiance, &reference.radiance);
            assert!(error <= AGREEMENT, "{} on {}: {error:e}", report.method, case.entry.name);
            assert_eq!(report.method, solver.name());
            assert_eq!(report.stop, if solver.is_direct() { Stop::Direct } else { Stop::Converged });
            // The residual is recomputed: a method cannot talk itself below the tolerance by more than rounding.
            let bound = if solver.is_direct() { AGREEMENT } else { TOLERANCE + 1e-13 };
            assert!(report.true_residual <= bound, "{} on {}: {report:?}", report.method, case.entry.name);
            assert_eq!(report.n_adjoint_applies, if solver.name() == "bicg" { report.n_iterations } else { 0 });
            assert_eq!(report.n_fill.is_some(), ["sparse-lu", "sparse-cholesky", "low-rank"].contains(&report.method));
        }
        assert_eq!(solvers.iter().filter(|s| s.is_direct()).count(), 6);
    }
}

#[test]
fn furnaces_are_solved_to_twelve_digits_by_every_solver() {
    for name in ["furnace-cube", "furnace-sphere"] {
        let case = scenes::find(name);
        let Some(Exact::Uniform { radiance }) = (case.entry.exact)() else { panic!("{name}") };
        for solver in solver::all(TOLERANCE) {
            let answer = solve(&*solver, case.system.equation());
            for (column, exact) in answer.radiance.columns().zip(&radiance) {
                let worst = column.iter().map(|l| (l / exact - 1.0).abs()).fold(0.0, f64::max);
                assert!(worst <= FURNACE, "{} on {name}: {worst:e}", solver.name());
            }
        }
    }
}

#[test]
fn absorbed_power_is_emitted_power() {
    for case in coarse() {
        let Some(Exact::AbsorbedPower { power }) = (case.entry.exact)() else { continue };
        let radiance = solve(&Lu, case.system.equation()).radiance;
        let irradiance = case.system.irradiance(&radiance);
        let albedo = case.system.transport().scattering().values();
        for (band, emitted) in power.iter().enumerate() {
            let area = |i: usize| case.bundles.patch(i).unwrap().polygon.area();
            let absorbed: f64 = (0..case.system.n_bundles())
                .map(|i| (1.0 - albedo.get(i, band)) * irradiance.get(i, band) * area(i))
                .sum();
            assert!((absorbed / emitted - 1.0).abs() <= AGREEMENT, "{}: {absorbed} {emitted}", case.entry.name);
        }
    }
}

/// Brackets at a tolerance so loose that they are wide: they must hold the discrete truth all the same.
#[test]
fn brackets_hold_the_direct_answer() {
    const LOOSE: f64 = 1e-3;
    for case in coarse() {
        let reference = solve(&Lu, case.system.equation());
        let own = reference.report.bracket.as_ref().unwrap();
        let gain = case.system.transport().scattering().values().max_abs();
        for solver in solver::all(LOOSE) {
            let answer = solve(&*solver, case.system.equation());
            let bracket = answer.report.bracket.as_ref().unwrap();
            for band in 0..case.system.n_bands() {
                // The truth lies in both intervals, so they meet, and the direct answer is within a hair of it.
                let emission = case.system.emission().column(band).iter().copied().fold(0.0, f64::max);
                for i in 0..case.system.n_bundles() {
                    let (low, high) = (bracket.low.get(i, band), bracket.high.get(i, band));
                    let truth = reference.radiance.get(i, band);
                    let hair = own.high.get(i, band) - own.low.get(i, band);
                    assert!(low - hair <= truth && truth <= high + hair, "{}: {low} {truth} {high}", solver.name());
                    // No wider than the tolerance allows: the gain of K is at most the largest albedo.
                    let allowed = (LOOSE * emission + 1e-9 * emission) / (1.0 - gain);
                    assert!((truth - low).max(high - truth) <= 2.0 * allowed, "{}", solver.name());
                    // Iterates that only ever add light lie below the truth, but for rounding.
                    if ["neumann", "jacobi", "gauss-seidel", "southwell"].contains(&solver.name()) {
                        let below = answer.radiance.get(i, band) - low;
                        assert!(below <= 1e-9 * emission / (1.0 - gain), "{}", solver.name());
                    }
                }
            }
        }
        assert!(own.relative_width() < AGREEMENT, "{}", case.entry.name);
    }
}

#[test]
fn brackets_hold_the_exact_answer_of_the_furnace() {
    let case = scenes::find("furnace-cube");
    let Some(Exact::Uniform { radiance }) = (case.entry.exact)() else { panic!() };
    for tolerance in [1e-2, 1e-6] {
        for solver in solver::all(tolerance) {
            let answer = solve(&*solver, case.system.equation());
            let bracket = answer.report.bracket.unwrap();
            for (band, exact) in radiance.iter().enumerate() {
                // Closure is kept to 1e-14, and the furnace's answer moves by 1/(1 − a) times as much.
                let closure = 1e-13 * exact;
                for (low, high) in bracket.low.column(band).iter().zip(bracket.high.column(band)) {
                    let (low, high) = (low - closure, high + closure);
                    assert!((low..=high).contains(exact), "{}: {low} {exact} {high}", solver.name());
                }
            }
        }
    }
}

/// Counts what is asked of an operator.
struct Counting<'a> {
    inner: &'a dyn LinearOperator,
    applies: AtomicUsize,
    transposes: AtomicUsize,
    rows: AtomicUsize,
    columns: AtomicUsize,
}

impl<'a> Counting<'a> {
    fn new(inner: &'a dyn LinearOperator) -> Self {
        let zero = AtomicUsize::default;
        Self { inner, applies: zero(), transposes: zero(), rows: zero(), columns: zero() }
    }

    fn counts(&self) -> [usize; 4] {
        [&self.applies, &self.transposes, &self.rows, &self.columns].map(|count| count.load(Ordering::Relaxed))
    }
}

impl LinearOperator for Counting<'_> {
    fn n_rows(&self) -> usize {
        self.inner.n_rows()
    }

    fn n_columns(&self) -> usize {
        self.inner.n_columns()
    }

    fn n_bands(&self) -> usize {
        self.inner.n_bands()
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        self.applies.fetch_add(1, Ordering::Relaxed);
        self.inner.apply(x, y);
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        self.transposes.fetch_add(1, Ordering::Relaxed);
        self.inner.apply_transpose(x, y);
    }

    fn row(&self, band: usize, row: usize, out: &mut [f64]) {
        self.rows.fetch_add(1, Ordering::Relaxed);
        self.inner.row(band, row, out);
    }

    fn column(&self, band: usize, column: usize, out: &mut [f64]) {
        self.columns.fetch_add(1, Ordering::Relaxed);
        self.inner.column(band, column, out);
    }

    fn is_nonnegative(&self) -> bool {
        self.inner.is_nonnegative()
    }

    fn n_entries(&self) -> u64 {
        self.inner.n_entries()
    }
}

/// Products that every answer is verified with: its true residual.
const VERIFICATION: usize = 1;

/// What methods on a coarse space spend, in products.
struct CoarseWork {
    /// K once, and an elimination of ⅓ m³.
    setup: f64,
    /// K P once, and the coarse factors.
    pass: f64,
    /// Three times the strong entries.
    near: f64,
}

impl CoarseWork {
    fn of(system: &System, most: f64) -> Self {
        let (n, n_bands) = (system.n_bundles(), system.n_bands());
        let m = system.hierarchy().finest_within(most as usize).unwrap().n_groups() as f64;
        let size = (n * n) as f64;
        let mut row = vec![0.0; n];
        let albedo = system.transport().scattering().values();
        let mut strong = 0;
        for band in 0..n_bands {
            let root = |i: usize| (system.etendue()[i] / albedo.get(i, band)).sqrt();
            let is_strong = |i: usize, j: usize, k: f64| {
                albedo.get(i, band) > 0.0 && albedo.get(j, band) > 0.0 && root(i) * k > 4.0 / n as f64 * root(j)
            };
            let mut n_strong = 0;
            for i in 0..n {
                system.transport().row(band, i, &mut row);
                n_strong += row.iter().enumerate().filter(|(j, k)| is_strong(i, *j, **k)).count();
            }
            strong = strong.max(n_strong);
        }
        let near = 3.0 * strong as f64 / size;
        Self { setup: 1.0 + m.powi(3) / (3.0 * size), pass: m / n as f64 + m * m / size, near }
    }
}

/// What the low-rank stand-in spends to find its range, in K written out, and every time it is applied, in products.
fn low_rank_work(transport: &dyn LinearOperator) -> [f64; 2] {
    let n_bands = transport.n_bands() as f64;
    let size = (transport.n_rows() as f64).powi(2);
    let of_band = |band: usize| {
        let range = Range::find(&Dense::from_operator(transport, band), 0.5, 0);
        let rank = range.rank() as f64;
        [range.n_products as f64, (2.0 * size.sqrt() * rank + rank * rank) / size]
    };
    let sums = (0..transport.n_bands()).map(of_band).fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
    sums.map(|sum| sum / n_bands)
}

/// What multigrid spends to set up, on its first correction, and on every other, in products.
fn multigrid_work(system: &System, n_visits: f64) -> [f64; 3] {
    let n = system.n_bundles() as f64;
    let groups = system.hierarchy().levels().iter().map(|level| level.n_groups() as f64);
    let last = groups.clone().position(|m| m <= n.powf(2.0 / 3.0).floor()).unwrap();
    let groups: Vec<f64> = groups.take(last + 1).collect();
    let (m, above) = (groups[last], &groups[..last]);
    let formed = above.iter().map(|m| m * m).sum::<f64>() + m.powi(3) / 3.0;
    // A level reads its matrix after its bounce, and after every answer of the next level but the last.
    let cycle = above.iter().rev().fold(m * m, |below, m| n_visits * (m * m + below));
    let mut nested = m * m;
    for k in (0..last).rev() {
        let size = above[k] * above[k];
        nested += size + above[k..].iter().rev().fold(m * m, |below, m| n_visits * (m * m + below));
    }
    let spread = groups[0] / n;
    [1.0 + formed / (n * n), spread + nested / (n * n), spread + cycle / (n * n)]
}

#[test]
fn work_is_counted_as_it_was_done() {
    let case = scenes::find("cornell-box");
    let plain = case.system.equation();
    let form = plain.self_adjoint.unwrap();
    let (n, n_bands) = (case.system.n_bundles(), case.system.n_bands());
    for solver in solver::all(1e-6) {
        let (transport, propagation) = (Counting::new(plain.transport), Counting::new(form.propagation));
        let coarse =
            CoarseWork::of(&case.system, if solver.name() == "perron" { 1.0 } else { (n as f64).powf(2.0 / 3.0) });
        let self_adjoint = Some(SelfAdjoint { propagation: &propagation, ..form });
        let answer = solve(&*solver, Equation { transport: &transport, self_adjoint, ..plain });
        let report = &answer.report;
        let iterations = report.n_iterations;
        let [applies, transposes, rows, columns] = transport.counts();
        let [g_applies, g_transposes, g_rows, g_columns] = propagation.counts();
        assert_eq!(applies + g_applies, report.n_applies + VERIFICATION, "{}", solver.name());
        assert_eq!((transposes + g_transposes, g_columns), (report.n_adjoint_applies, 0), "{}", solver.name());

        // Diagonals are read row by row, once.
        let whole = n * n_bands;
        let expected = match solver.name() {
            "lu" | "lu-nalgebra" | "gth" | "sparse-lu" => (0, 0.0, whole, 0),
            "cholesky" | "sparse-cholesky" => (3, 3.0, 0, 0),
            "lu-f32" => (iterations + 1, (iterations + 1) as f64, whole, 0),
            "low-rank" => {
                let [prepared, pass] = low_rank_work(plain.transport);
                (iterations + 1, prepared + 1.0 + iterations as f64 * (1.0 + pass), whole, 0)
            }
            "neumann" => (iterations + 1, (iterations + 1) as f64, 0, 0),
            "jacobi" => (iterations + 1, (iterations + 1) as f64, whole, 0),
            // Two to check G, twelve of Lanczos.
            "richardson" => (iterations + 15, (iterations + 15) as f64, 0, 0),
            "chebyshev" => (iterations + 15, (iterations + 15) as f64, 0, 0),
            "gauss-seidel" | "sor" => (0, (iterations + 1) as f64, whole * (iterations + 2), 0),
            "symmetric-gauss-seidel" => (0, (2 * iterations + 2) as f64, whole * (2 * iterations + 3), 0),
            "southwell" | "overshooting" => (0, iterations as f64, whole, columns),
            "progressive" => (iterations + 1, (2 * iterations + 1) as f64, whole, columns),
            "cg" | "minres" => (iterations + 3, (iterations + 3) as f64, 0, 0),
            "bicg" => (iterations + 1, (2 * iterations + 1) as f64, 0, 0),
            "bicgstab" => (2 * iterations + 1, (2 * iterations + 1) as f64, 0, 0),
            "gmres" | "anderson" => (iterations + 1, (iterations + 1) as f64, 0, 0),
            // Two steps of the preconditioner and one product of its own.
            "fgmres" => (3 * iterations + 1, (3 * iterations + 1) as f64, 0, 0),
            "deflated-cg" => {
                let an_iteration = 1.0 + coarse.pass + coarse.near;
                (iterations, coarse.setup + coarse.pass + iterations as f64 * an_iteration, whole, 0)
            }
            "deflated-gmres" => {
                (iterations + 1, coarse.setup + 1.0 + iterations as f64 * (1.0 + coarse.pass), whole, 0)
            }
            "two-grid" | "perron" => {
                let near = if solver.name() == "perron" { 0.0 } else { coarse.near };
                (iterations, coarse.setup + coarse.pass + iterations as f64 * (1.0 + coarse.pass + near), whole, 0)
            }
            "multigrid" => {
                let [setup, first, pass] = multigrid_work(&case.system, 2.0);
                (iterations, setup + first + iterations as f64 * (1.0 + pass + coarse.near), whole, 0)
            }
            other => panic!("what does '{other}' cost?"),
        };
        assert_eq!((report.n_applies, rows, columns), (expected.0, expected.2, expected.3), "{}", solver.name());
        // Shares of a product are summed in another order.
        assert!((report.products - expected.1).abs() < 1e-9, "{}: {} {}", solver.name(), report.products, expected.1);
        assert_eq!(report.n_refinements, 0, "{}", solver.name());
        assert_eq!(g_rows, if solver.name().ends_with("cholesky") { whole } else { 0 });
        if ["southwell", "overshooting", "progressive"].contains(&solver.name()) {
            // n shots a band and iteration, each one column, except from a band with nothing left to shoot.
            assert!(columns <= whole * iterations && columns > n * iterations);
        }
        assert_eq!(report.history.len(), if solver.is_direct() { 0 } else { iterations + 1 });
    }
}

#[test]
fn bounces_in_the_furnace_are_powers_of_the_albedo() {
    let case = scenes::find("furnace-cube");
    let (albedo, emission) = ([0.5, 0.75, 0.9], [1.0, 0.5, 0.25]);
    let mut worst: f64 = 0.0;
    let mut watch = |it: Iteration<'_>| {
        for band in 0..3 {
            let sum = emission[band] * (1.0 - f64::powi(albedo[band], it.index as i32 + 1)) / (1.0 - albedo[band]);
            worst = it.iterate.column(band).iter().map(|l| (l / sum - 1.0).abs()).fold(worst, f64::max);
        }
        ControlFlow::Continue(())
    };
    let answer = Neumann { tolerance: 1e-6 }.solve(case.system.equation(), &mut watch).unwrap();
    // The first k with 0.9^{k+1} ≤ 1e-6 is 131, by a margin of 9 %.
    assert_eq!((answer.report.n_iterations, answer.report.n_applies), (131, 132));
    assert!(worst < FURNACE, "{worst:e}");
    for (k, residual) in answer.report.history.iter().enumerate() {
        assert!((residual / f64::powi(0.9, k as i32 + 1) - 1.0).abs() < FURNACE, "bounce {k}: {residual:e}");
    }

    // A uniform field is an eigenvector: conjugate gradients need one step, two products to check G and one to begin.
    let cg = solve(&Cg { tolerance: 1e-10 }, case.system.equation());
    assert_eq!((cg.report.n_iterations, cg.report.n_applies), (1, 4));
}

#[test]
fn observers_see_every_iterate_and_can_stop() {
    const LAST: usize = 3;
    struct Stopper {
        last: usize,
        seen: Vec<(usize, f64, f64)>,
        iterate: Block,
    }
    impl Observer for Stopper {
        fn observe(&mut self, iteration: Iteration<'_>) -> ControlFlow<()> {
            self.seen.push((iteration.index, iteration.products, iteration.residual));
            self.iterate = iteration.iterate.clone();
            if iteration.index == self.last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }
    let case = scenes::find("two-rooms");
    // A low-rank stand-in of full rank is K itself: there is nothing to stop.
    for solver in solver::all(TOLERANCE).iter().filter(|s| !s.is_direct() && s.name() != "low-rank") {
        let name = solver.name();
        // Seven digits twice are all there are.
        let last = if name == "lu-f32" { 1 } else { LAST };
        let mut stopper = Stopper { last, seen: Vec::new(), iterate: Block::default() };
        let answer = solver.solve(case.system.equation(), &mut stopper).unwrap();
        assert_eq!((answer.report.stop, answer.report.n_iterations), (Stop::Observer, last), "{name}");
        assert_eq!(stopper.iterate, answer.radiance, "{name}");
        assert!(stopper.seen.iter().map(|seen| seen.0).eq(0..=last), "{name}");
        assert!(stopper.seen.iter().map(|seen| seen.2).eq(answer.report.history.iter().copied()), "{name}");
        assert!(stopper.seen.windows(2).all(|pair| pair[1].1 > pair[0].1), "{name}");
        assert!(answer.report.bracket.is_some() && answer.report.true_residual > TOLERANCE, "{name}");
    }
}

#[test]
fn methods_are_found_by_their_names() {
    let all = solver::all(TOLERANCE);
    for (k, method) in all.iter().enumerate() {
        assert_eq!(solver::named(method.name(), TOLERANCE).unwrap().name(), method.name());
        assert!(all[..k].iter().all(|other| other.name() != method.name()), "{} twice", method.name());
    }
    assert!(solver::named("crystal ball", TOLERANCE).is_none());
}

#[test]
fn budgets_end_in_a_status_after_so_many_products() {
    const PRODUCTS: f64 = 40.0;
    let case = scenes::find("furnace-cube");
    for solver in solver::all(0.0).iter().filter(|s| !s.is_direct()) {
        let mut seen = 0;
        let mut count = |_: Iteration<'_>| {
            seen += 1;
            ControlFlow::Continue(())
        };
        let answer =
            solver.solve(case.system.equation(), &mut Budget { products: PRODUCTS, observer: &mut count }).unwrap();
        let report = &answer.report;
        // Nothing left to shoot or to minimise is convergence even to 0; otherwise the budget ends it, one iteration past it at most.
        if report.stop == Stop::Converged {
            assert_eq!(report.history.last(), Some(&0.0), "{}", report.method);
        } else {
            assert_eq!(report.stop, Stop::Budget, "{}", report.method);
            // Finding a range is preparation, and no iteration.
            assert!(report.products < PRODUCTS + 3.0 || report.method == "low-rank", "{report:?}");
        }
        assert_eq!(seen, report.history.len());
    }
}

/// Albedos of every surface that is not black.
const ALBEDOS: [f64; 6] = [0.3, 0.9, 0.99, 0.999, 1.0 - 1e-6, 1.0 - 1e-9];

/// Every method × every scene × every albedo, against elimination without subtraction: what a method says it has solved is right to ten
/// digits, however little is absorbed, and what it has not solved lies in its bracket.
#[test]
fn all_solvers_agree_at_every_albedo_or_say_that_they_ran_out() {
    for case in coarse() {
        for albedo in ALBEDOS {
            let old = case.system.transport().scattering().values();
            let chosen = |i: usize, band: usize| if old.get(i, band) > 0.0 { albedo } else { 0.0 };
            let system = case.system.with_albedo(Block::from_fn(old.n_rows(), old.n_columns(), chosen));
            let truth = solve(&Gth, system.equation()).radiance;
            // Slow methods need 1 / (1 − albedo) products; what they have by then lies in its bracket.
            let products = if albedo > 0.9 { 150.0 } else { 500.0 };
            for solver in solver::all(TOLERANCE) {
                let place = format!("{} on {} at 1 - {:.0e}", solver.name(), case.entry.name, 1.0 - albedo);
                let mut budget = Budget { products, observer: &mut () };
                let answer = match solver.solve(system.equation(), &mut budget) {
                    Ok(answer) => answer,
                    // Seven digits do not hold an absorption of 1e-9.
                    Err(SolveError::Factor { .. } | SolveError::Diverged { .. })
                        if solver.name() == "lu-f32" && albedo > 0.999_999 =>
                    {
                        continue;
                    }
                    Err(error) => panic!("{place}: {error}"),
                };
                let report = &answer.report;
                match report.stop {
                    Stop::Direct | Stop::Converged => {
                        let error = relative_max(&answer.radiance, &truth);
                        assert!(
                            error <= AGREEMENT,
                            "{place}: {error:e} {:e} {}",
                            report.true_residual,
                            report.n_refinements
                        );
                        // Where every row absorbs alike the bracket says so, too, and it knows no other method.
                        let width = report.bracket.as_ref().unwrap().relative_width();
                        let is_alike = case.entry.name.starts_with("furnace");
                        assert!(width <= AGREEMENT || !is_alike, "{place}: {width:e}");
                    }
                    Stop::Budget => assert!(albedo > 0.9, "{place}: {:?}", report.products),
                    other => panic!("{place}: {other}"),
                }
                assert!(
                    report.stop != Stop::Budget || !NEVER_SLOW.contains(&solver.name()),
                    "{place} needs more than {products} products"
                );
                let bracket = answer.report.bracket.unwrap();
                let bounds = bracket.low.values().iter().zip(bracket.high.values());
                for ((low, high), truth) in bounds.zip(truth.values()) {
                    // Elimination without subtraction is off by some n ulp itself.
                    let hair = FURNACE * truth;
                    assert!((low - hair..=high + hair).contains(truth), "{place}: {low} {truth} {high}");
                }
            }
        }
    }
}

/// Methods that the albedo hardly slows.
const NEVER_SLOW: [&str; 4] = ["cg", "minres", "deflated-cg", "deflated-gmres"];

#[test]
fn what_is_not_self_adjoint_is_solved_or_refused() {
    let case = scenes::find("cornell-box");
    let (system, _) = case.system.repaired_by(RepairMethod::Rows);
    let truth = solve(&Gth, system.equation()).radiance;
    let needy = ["cholesky", "sparse-cholesky", "richardson", "chebyshev", "cg", "minres", "deflated-cg"];
    for solver in solver::all(TOLERANCE) {
        match solver.solve(system.equation(), &mut ()) {
            Ok(answer) => {
                assert!(relative_max(&answer.radiance, &truth) <= AGREEMENT, "{}", solver.name());
                assert!(!needy.contains(&solver.name()));
            }
            Err(error) => {
                assert_eq!(error, SolveError::NoSelfAdjointForm { method: solver.name() });
                assert!(needy.contains(&solver.name()));
            }
        }
    }
}

/// ⟨W, L⟩ = ⟨E, J⟩ by every method, J solved by the same one.
#[test]
fn importance_measures_what_radiance_does() {
    for name in ["cornell-box", "two-rooms"] {
        let system = &scenes::find(name).system;
        let (n, n_bands) = (system.n_bundles(), system.n_bands());
        let measurement = Block::from_fn(n, n_bands, |i, band| if i % 5 == band { 1.0 + i as f64 } else { 0.0 });
        let adjoint = system.adjoint();
        let inner = |a: &Block, b: &Block, band: usize| -> f64 {
            let pairs = a.column(band).iter().zip(b.column(band));
            system.etendue().iter().zip(pairs).map(|(mu, (a, b))| mu * a * b).sum()
        };
        for solver in solver::all(TOLERANCE) {
            let radiance = solve(&*solver, system.equation()).radiance;
            let importance = solve(&*solver, adjoint.equation(&measurement)).radiance;
            for band in 0..n_bands {
                let [seen, sent] = [inner(&measurement, &radiance, band), inner(system.emission(), &importance, band)];
                // A residual of 1e-13 of the brightest, over 1 − 0.9, in scenes that are up to some hundred times dimmer.
                assert!((seen - sent).abs() <= AGREEMENT * seen.abs(), "{} in {name}: {seen} {sent}", solver.name());
            }
        }
    }
}

#[test]
fn what_is_factored_once_answers_many_lights_and_sensors() {
    let system = &scenes::find("two-rooms").system;
    let equation = system.equation();
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let lights = Block::from_fn(n, 2 * n_bands, |i, c| if i % 7 == c { 1.0 } else { 0.0 });
    let factored =
        [Lu.factor(equation).unwrap(), Gth.factor(equation).unwrap(), solver::SparseLu.factor(equation).unwrap()];
    let half = |from: &Block, k: usize| Block::from_fn(n, n_bands, |i, band| from.get(i, k * n_bands + band));
    let adjoint = system.adjoint();
    for factored in &factored {
        let (radiance, importance) = (factored.solve(&lights), factored.solve_adjoint(&lights));
        for k in 0..2 {
            let light = half(&lights, k);
            let alone = solve(&Gth, Equation { emission: &light, ..equation }).radiance;
            assert!(relative_max(&half(&radiance, k), &alone) <= FURNACE);
            let alone = solve(&Gth, adjoint.equation(&light)).radiance;
            assert!(relative_max(&half(&importance, k), &alone) <= FURNACE);
        }
    }
    assert_eq!(factored.map(|f| f.n_fill().is_some()), [false, false, true]);
}
