//! Every solver × every scene of the gallery.

use super::scenes::{self, coarse};
use etendue::compare::relative_max;
use etendue::gallery::Exact;
use etendue::linalg::{Block, Equation, LinearOperator, SelfAdjoint};
use etendue::solver::{self, Cg, Iteration, Lu, Neumann, Observer, Solution, Solver, Stop};
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
            assert_eq!(report.n_adjoint_applies, 0);
        }
        assert_eq!(solvers.iter().filter(|s| s.is_direct()).count(), 3);
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

#[test]
fn work_is_counted_as_it_was_done() {
    let case = scenes::find("cornell-box");
    let plain = case.system.equation();
    let form = plain.self_adjoint.unwrap();
    let (n, n_bands) = (case.system.n_bundles(), case.system.n_bands());
    for solver in solver::all(1e-6) {
        let (transport, propagation) = (Counting::new(plain.transport), Counting::new(form.propagation));
        let self_adjoint = Some(SelfAdjoint { propagation: &propagation, ..form });
        let answer = solve(&*solver, Equation { transport: &transport, self_adjoint, ..plain });
        let report = &answer.report;
        let iterations = report.n_iterations;
        let [applies, transposes, rows, columns] = transport.counts();
        let [g_applies, g_transposes, g_rows, g_columns] = propagation.counts();
        assert_eq!(applies + g_applies, report.n_applies + VERIFICATION, "{}", solver.name());
        assert_eq!((transposes + g_transposes, g_columns), (0, 0), "{}", solver.name());

        // Diagonals are read row by row, once.
        let whole = n * n_bands;
        let expected = match solver.name() {
            "lu" | "lu-nalgebra" => (0, 0.0, whole, 0),
            "cholesky" => (3, 3.0, 0, 0),
            "neumann" => (iterations + 1, (iterations + 1) as f64, 0, 0),
            "jacobi" => (iterations + 1, (iterations + 1) as f64, whole, 0),
            "gauss-seidel" => (0, (iterations + 1) as f64, whole * (iterations + 2), 0),
            "southwell" => (0, iterations as f64, whole, columns),
            "cg" => (iterations + 3, (iterations + 3) as f64, 0, 0),
            other => panic!("what does '{other}' cost?"),
        };
        assert_eq!((report.n_applies, report.products, rows, columns), expected, "{}", solver.name());
        assert_eq!(g_rows, if solver.name() == "cholesky" { whole } else { 0 });
        if solver.name() == "southwell" {
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
        seen: Vec<(usize, f64, f64)>,
        iterate: Block,
    }
    impl Observer for Stopper {
        fn observe(&mut self, iteration: Iteration<'_>) -> ControlFlow<()> {
            self.seen.push((iteration.index, iteration.products, iteration.residual));
            self.iterate = iteration.iterate.clone();
            if iteration.index == LAST { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }
    let case = scenes::find("two-rooms");
    for solver in solver::all(TOLERANCE).iter().filter(|s| !s.is_direct()) {
        let mut stopper = Stopper { seen: Vec::new(), iterate: Block::default() };
        let answer = solver.solve(case.system.equation(), &mut stopper).unwrap();
        let name = solver.name();
        assert_eq!((answer.report.stop, answer.report.n_iterations), (Stop::Observer, LAST), "{name}");
        assert_eq!(stopper.iterate, answer.radiance, "{name}");
        assert!(stopper.seen.iter().map(|seen| seen.0).eq(0..=LAST), "{name}");
        assert!(stopper.seen.iter().map(|seen| seen.2).eq(answer.report.history.iter().copied()), "{name}");
        assert!(stopper.seen.windows(2).all(|pair| pair[1].1 > pair[0].1), "{name}");
        assert!(answer.report.bracket.is_some() && answer.report.true_residual > TOLERANCE, "{name}");
    }
}
