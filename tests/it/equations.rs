//! Equations made by hand, most of them without an answer: what solvers say of each.

use etendue::linalg::{Block, Dense, Diagonal, Equation, FactorError, LinearOperator, SelfAdjoint, Unknown};
use etendue::sampling::Stream;
use etendue::solver::{
    self, Anderson, BiCg, BiCgStab, Cg, Chebyshev, Cholesky, DeflatedCg, GaussSeidel, Gmres, Gth, Jacobi, Lu,
    LuNalgebra, Minres, Neumann, Overshooting, OwnGain, Progressive, Richardson, RowGain, SingleLu, Solution,
    SolveError, Solver, Sor, Southwell, SparseCholesky, SparseLu, Stop, SymmetricGaussSeidel,
};

const TOLERANCE: f64 = 1e-12;

fn dense<const N: usize>(rows: [[f64; N]; N]) -> Dense {
    Dense::from_fn(N, N, |r, c| rows[r][c])
}

fn column(values: &[f64]) -> Block {
    Block::from_fn(values.len(), 1, |r, _| values[r])
}

/// Of a plain equation without a self-adjoint form.
fn plain<'a>(transport: &'a dyn LinearOperator, emission: &'a Block) -> Equation<'a> {
    Equation::plain(transport, emission)
}

fn error_of(solver: &dyn Solver, equation: Equation<'_>) -> SolveError {
    match solver.solve(equation, &mut ()) {
        Err(error) => error,
        Ok(answer) => panic!("{}: {:?}", solver.name(), answer.report),
    }
}

const ON_COARSE_SPACES: [&str; 5] = ["deflated-cg", "deflated-gmres", "two-grid", "multigrid", "perron"];

/// The methods that K alone drives.
fn stationary() -> Vec<Box<dyn Solver>> {
    vec![
        Box::new(Neumann { tolerance: TOLERANCE }),
        Box::new(Jacobi { tolerance: TOLERANCE }),
        Box::new(GaussSeidel { tolerance: TOLERANCE }),
        Box::new(Southwell { tolerance: TOLERANCE }),
    ]
}

/// The methods that rest on the self-adjoint form.
fn needing_self_adjointness() -> Vec<Box<dyn Solver>> {
    vec![
        Box::new(Cholesky),
        Box::new(SparseCholesky),
        Box::new(Richardson { tolerance: TOLERANCE, damping: None }),
        Box::new(Chebyshev { tolerance: TOLERANCE }),
        Box::new(Cg { tolerance: TOLERANCE }),
        Box::new(Minres { tolerance: TOLERANCE }),
        Box::new(DeflatedCg { tolerance: TOLERANCE, n_groups: None }),
    ]
}

/// A self-adjoint equation by hand: G = M⁻¹ T with T symmetric, S = diag(albedo).
struct ByHand {
    etendue: Vec<f64>,
    propagation: Dense,
    root: Diagonal,
    transport: Dense,
    emission: Block,
}

impl ByHand {
    fn new<const N: usize>(etendue: [f64; N], exchange: [[f64; N]; N], albedo: [f64; N], emission: [f64; N]) -> Self {
        let propagation = Dense::from_fn(N, N, |r, c| exchange[r][c] / etendue[r]);
        let transport = Dense::from_fn(N, N, |r, c| albedo[r] * exchange[r][c] / etendue[r]);
        let root = Diagonal::new(column(&albedo.map(f64::sqrt)));
        Self { etendue: etendue.to_vec(), propagation, root, transport, emission: column(&emission) }
    }

    fn equation(&self) -> Equation<'_> {
        let (propagation, scattering_root) = (&self.propagation, &self.root);
        let unknown = Unknown::Radiance;
        let self_adjoint = Some(SelfAdjoint { etendue: &self.etendue, propagation, scattering_root, unknown });
        Equation { self_adjoint, ..Equation::plain(&self.transport, &self.emission) }
    }
}

/// Two patches of étendue 1 and 2 that exchange ½, albedos 0.8 and 0.4: K = ((0, 0.4), (0.1, 0)).
fn two_patches() -> ByHand {
    ByHand::new([1.0, 2.0], [[0.0, 0.5], [0.5, 0.0]], [0.8, 0.4], [1.0, 0.0])
}

#[test]
fn two_patches_have_the_answer_of_cramers_rule() {
    // L = (1, 0.1) / (1 − 0.04).
    let expected = [1.0 / 0.96, 0.1 / 0.96];
    for solver in solver::all(TOLERANCE) {
        let by_hand = two_patches();
        let answer = solver.solve(by_hand.equation(), &mut ()).unwrap();
        for (found, expected) in answer.radiance.column(0).iter().zip(expected) {
            // The tolerance over 1 − ‖K‖∞ = 0.6, and rounding.
            assert!((found - expected).abs() <= 2.0 * TOLERANCE, "{}: {found} {expected}", solver.name());
        }
    }
}

#[test]
fn a_band_without_light_stays_dark() {
    let transport = dense([[0.0, 0.4], [0.1, 0.0]]);
    let emission = Block::from_fn(2, 2, |r, band| if r == 0 && band == 1 { 1.0 } else { 0.0 });
    for solver in stationary() {
        let answer = solver.solve(plain(&transport, &emission), &mut ()).unwrap();
        assert_eq!(answer.radiance.column(0), [0.0, 0.0], "{}", solver.name());
        assert!(answer.radiance.get(1, 1) > 0.0 && answer.report.stop == Stop::Converged);
    }
    for solver in solver::all(TOLERANCE) {
        let by_hand = ByHand { emission: column(&[0.0, 0.0]), ..two_patches() };
        let answer = solver.solve(by_hand.equation(), &mut ()).unwrap();
        assert_eq!(answer.radiance.values(), [0.0, 0.0], "{}", solver.name());
        assert_eq!(answer.report.true_residual, 0.0);
    }
}

#[test]
fn gain_above_one_is_divergence_with_its_numbers() {
    // ρ(K) = √(1.5 × 1.2) > 1.
    let transport = dense([[0.0, 1.5], [1.2, 0.0]]);
    let emission = column(&[1.0, 0.5]);
    for solver in stationary() {
        match error_of(&*solver, plain(&transport, &emission)) {
            SolveError::Diverged { method, iteration, residual, best, gain } => {
                assert_eq!(method, solver.name());
                assert!(iteration > 10 && residual > 1e7 * best && best > 0.0, "{iteration} {residual} {best}");
                assert_eq!(gain, Some(RowGain { band: 0, unknown: 0, gain: 1.5 }));
            }
            other => panic!("{}: {other}", solver.name()),
        }
    }

    // The others solve it all the same, and offer no bracket.
    let tolerance = TOLERANCE;
    let others: [&dyn Solver; 8] = [
        &Lu,
        &LuNalgebra,
        &SparseLu,
        &SingleLu { tolerance },
        &BiCg { tolerance },
        &BiCgStab { tolerance, preconditioner: None },
        &Gmres { tolerance, restart: 2, preconditioner: Some(&OwnGain) },
        &Anderson { tolerance, depth: 2 },
    ];
    for solver in others {
        let answer = solver.solve(plain(&transport, &emission), &mut ()).unwrap();
        assert!(answer.report.bracket.is_none() && answer.report.true_residual < TOLERANCE);
        // Cramer: det = 1 − 1.8; ‖(I − K)⁻¹‖∞ = 2.5 / 0.8.
        let error = (answer.radiance.get(0, 0) - (1.0 + 1.5 * 0.5) / (1.0 - 1.8)).abs();
        assert!(error < 4.0 * TOLERANCE, "{}: {error:e}", solver.name());
    }
    // But for the one that rests on what is lost.
    let source = FactorError::Gain { row: 0, loss: -0.5 };
    assert_eq!(error_of(&Gth, plain(&transport, &emission)), SolveError::Factor { method: "gth", band: 0, source });
}

#[test]
fn gain_above_one_is_not_positive_definite() {
    let by_hand = ByHand::new([1.0, 2.0], [[0.0, 3.0], [3.0, 0.0]], [0.9, 0.9], [1.0, 1.0]);
    match error_of(&Cg { tolerance: TOLERANCE }, by_hand.equation()) {
        SolveError::NotPositiveDefinite { method: "cg", band: 0, curvature, .. } => assert!(curvature < 0.0),
        other => panic!("{other}"),
    }
    for solver in [&Cholesky as &dyn Solver, &SparseCholesky] {
        let source = FactorError::NotPositiveDefinite { pivot: 1, size: 2 };
        assert_eq!(error_of(solver, by_hand.equation()), SolveError::Factor { method: solver.name(), band: 0, source });
    }
    for solver in
        [&Chebyshev { tolerance: TOLERANCE } as &dyn Solver, &Richardson { tolerance: TOLERANCE, damping: None }]
    {
        match error_of(solver, by_hand.equation()) {
            SolveError::NotPositiveDefinite { method, curvature, .. } => {
                assert!(method == solver.name() && curvature < 0.0);
            }
            other => panic!("{other}"),
        }
    }
    // Minimal residuals need no more than an inverse.
    let [answer, reference] = [&Minres { tolerance: TOLERANCE } as &dyn Solver, &Lu]
        .map(|solver| solver.solve(by_hand.equation(), &mut ()).unwrap().radiance);
    assert!(etendue::compare::relative_max(&answer, &reference) < 10.0 * TOLERANCE);
}

#[test]
fn a_patch_that_keeps_all_its_light_is_named() {
    let transport = dense([[0.1, 0.2, 0.0], [0.0, 0.3, 0.1], [0.0, 0.2, 1.25]]);
    let emission = column(&[1.0, 1.0, 1.0]);
    let tolerance = TOLERANCE;
    let mut dividing = stationary().split_off(1);
    dividing.extend([
        Box::new(SymmetricGaussSeidel { tolerance }) as Box<dyn Solver>,
        Box::new(Sor { tolerance, relaxation: Some(1.2) }),
        Box::new(Progressive { tolerance }),
        Box::new(Overshooting { tolerance }),
        Box::new(Gmres { tolerance, restart: 3, preconditioner: Some(&OwnGain) }),
    ]);
    for solver in &dividing {
        let expected = SolveError::SelfGain { method: solver.name(), band: 0, unknown: 2, gain: 1.25 };
        assert_eq!(error_of(&**solver, plain(&transport, &emission)), expected);
    }
}

#[test]
fn solvers_take_unknowns_that_see_themselves() {
    // A diagonal in K: Jacobi, Gauss–Seidel and Southwell divide by 1 − Kᵢᵢ.
    let by_hand = ByHand::new([1.0, 2.0], [[0.25, 0.5], [0.5, 1.5]], [0.8, 0.4], [1.0, 0.5]);
    let reference = Lu.solve(by_hand.equation(), &mut ()).unwrap();
    // K = ((0.2, 0.4), (0.1, 0.3)), det(I − K) = 0.8 × 0.7 − 0.04.
    assert!((reference.radiance.get(0, 0) - (0.7 + 0.4 * 0.5) / 0.52).abs() < TOLERANCE);
    for solver in solver::all(TOLERANCE) {
        let answer = solver.solve(by_hand.equation(), &mut ()).unwrap();
        let error = etendue::compare::relative_max(&answer.radiance, &reference.radiance);
        assert!(error < 10.0 * TOLERANCE, "{}: {error:e}", solver.name());
    }
}

#[test]
fn a_white_closed_equation_is_singular() {
    let by_hand = ByHand::new([1.0, 1.0], [[0.0, 1.0], [1.0, 0.0]], [1.0, 1.0], [1.0, 1.0]);
    for solver in [&Lu as &dyn Solver, &LuNalgebra, &Gth, &SparseLu, &SingleLu { tolerance: TOLERANCE }] {
        let source = FactorError::Singular { pivot: 1, size: 2, value: 0.0 };
        let expected = SolveError::Factor { method: solver.name(), band: 0, source };
        assert_eq!(error_of(solver, by_hand.equation()), expected);
    }
    assert!(matches!(error_of(&Cholesky, by_hand.equation()), SolveError::Factor { method: "cholesky", .. }));
    match error_of(&Cg { tolerance: TOLERANCE }, by_hand.equation()) {
        SolveError::NotPositiveDefinite { iteration: 0, curvature, .. } => assert_eq!(curvature, 0.0),
        other => panic!("{other}"),
    }
}

#[test]
fn a_series_that_never_falls_stagnates() {
    // K = 1 on one unknown: every bounce is as bright as the last.
    let transport = Diagonal::new(column(&[1.0]));
    let emission = column(&[1.0]);
    let answer = Neumann { tolerance: TOLERANCE }.solve(plain(&transport, &emission), &mut ()).unwrap();
    assert_eq!((answer.report.stop, answer.report.n_applies), (Stop::Stagnated, 1001));
    assert_eq!((answer.report.true_residual, answer.report.bracket), (1.0, None));
}

#[test]
fn a_series_that_falls_slowly_runs_out_of_budget() {
    let transport = Diagonal::new(column(&[1.0 - 1e-8]));
    let emission = column(&[1.0]);
    let answer = Neumann { tolerance: TOLERANCE }.solve(plain(&transport, &emission), &mut ()).unwrap();
    assert_eq!((answer.report.stop, answer.report.n_applies), (Stop::Budget, 1_000_000));
}

#[test]
fn what_is_not_a_number_is_refused() {
    for bad in [f64::NAN, f64::INFINITY] {
        let by_hand = ByHand { emission: column(&[1.0, bad]), ..two_patches() };
        for solver in solver::all(TOLERANCE) {
            match error_of(&*solver, by_hand.equation()) {
                SolveError::NotFinite { method, .. } => assert_eq!(method, solver.name()),
                other => panic!("{}: {other}", solver.name()),
            }
        }

        // In K, direct methods can say where.
        let mut by_hand = two_patches();
        by_hand.transport.row_mut(1)[0] = bad;
        by_hand.propagation.row_mut(1)[0] = bad;
        for solver in solver::all(TOLERANCE) {
            match error_of(&*solver, by_hand.equation()) {
                SolveError::Factor { source: FactorError::NotFinite { row: 1, column: 0, .. }, .. } => {
                    assert!(solver.is_direct() || ["lu-f32", "low-rank"].contains(&solver.name()), "{}", solver.name());
                }
                // On a coarse space the groups' flow is what is not finite.
                SolveError::Factor { source: FactorError::NotFinite { row: 0, column: 0, .. }, .. } => {
                    assert!(ON_COARSE_SPACES.contains(&solver.name()), "{}", solver.name());
                }
                SolveError::NotFinite { .. } | SolveError::Diverged { .. } | SolveError::NotSelfAdjoint { .. } => {
                    assert!(!solver.is_direct() || solver.name().ends_with("cholesky"), "{}", solver.name());
                }
                other => panic!("{}: {other}", solver.name()),
            }
        }
    }
}

#[test]
fn the_wrong_etendue_is_found_out() {
    for solver in needing_self_adjointness() {
        assert!(solver.solve(two_patches().equation(), &mut ()).is_ok());
        // One patch said to be a tenth of a per mille larger than it is.
        let by_hand = ByHand { etendue: vec![1.0, 2.0 * 1.0001], ..two_patches() };
        match error_of(&*solver, by_hand.equation()) {
            SolveError::NotSelfAdjoint { method, violation, allowed } => {
                assert_eq!(method, solver.name());
                assert!((1e-7..1e-3).contains(&violation) && allowed < violation, "{violation:e} {allowed:e}");
            }
            other => panic!("{}: {other}", solver.name()),
        }
    }
}

#[test]
fn methods_that_need_the_self_adjoint_form_say_so() {
    let by_hand = two_patches();
    let equation = Equation { self_adjoint: None, ..by_hand.equation() };
    let needing: Vec<_> = needing_self_adjointness().iter().map(|solver| solver.name()).collect();
    for solver in solver::all(TOLERANCE) {
        match solver.solve(equation, &mut ()) {
            Ok(_) => assert!(!needing.contains(&solver.name())),
            Err(error) => {
                assert_eq!(error, SolveError::NoSelfAdjointForm { method: solver.name() });
                assert!(error.to_string().starts_with(solver.name()));
                assert!(needing.contains(&solver.name()));
            }
        }
    }
}

#[test]
fn what_would_divide_by_nothing_breaks_down_by_name() {
    // I − K turns by a right angle: ⟨r, (I − K) r⟩ = 0 for every r.
    let transport = dense([[1.0, -1.0], [1.0, 1.0]]);
    let emission = column(&[1.0, 0.0]);
    let tolerance = TOLERANCE;
    for solver in [&BiCg { tolerance } as &dyn Solver, &BiCgStab { tolerance, preconditioner: None }] {
        match error_of(solver, plain(&transport, &emission)) {
            SolveError::Breakdown { method, band: 0, iteration: 0, value, residual, .. } => {
                assert_eq!((method, value, residual), (solver.name(), 0.0, 1.0));
            }
            other => panic!("{other}"),
        }
    }
    let answer = Gmres { tolerance, restart: 2, preconditioner: None };
    let answer = answer.solve(plain(&transport, &emission), &mut ()).unwrap();
    // (I − K)⁻¹ = ((0, −1), (1, 0)) on (1, 0).
    assert!((answer.radiance.get(0, 0)).abs() < TOLERANCE && (answer.radiance.get(1, 0) - 1.0).abs() < TOLERANCE);
    let source = FactorError::Negative { row: 0, column: 1, value: -1.0 };
    assert_eq!(error_of(&Gth, plain(&transport, &emission)), SolveError::Factor { method: "gth", band: 0, source });
}

/// A number and what rounding took from it: some 32 digits (Dekker 1971).
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    fn sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let part = sum - a;
        Self(sum, (a - (sum - part)) + (b - part))
    }

    fn plus(self, other: Self) -> Self {
        let Self(high, low) = Self::sum(self.0, other.0);
        Self::sum(high, low + self.1 + other.1)
    }

    fn times(self, other: Self) -> Self {
        let high = self.0 * other.0;
        let low = self.0.mul_add(other.0, -high) + (self.0 * other.1 + self.1 * other.0);
        Self::sum(high, low)
    }

    fn minus(self, other: Self) -> Self {
        self.plus(Self(-other.0, -other.1))
    }

    fn over(self, other: Self) -> Self {
        let first = self.0 / other.0;
        let left = self.minus(other.times(Self(first, 0.0)));
        let second = left.0 / other.0;
        let left = left.minus(other.times(Self(second, 0.0)));
        Self::sum(first, second).plus(Self(left.0 / other.0, 0.0))
    }
}

/// L by plain elimination in some 32 digits, the diagonal of I − K from what is absorbed and what goes elsewhere.
fn eliminate_in_double(transport: &Dense, absorption: &[f64], emission: &[f64]) -> Vec<f64> {
    let n = absorption.len();
    let single = |v: f64| Double(v, 0.0);
    let mut a: Vec<Vec<Double>> = (0..n)
        .map(|r| {
            let mut row: Vec<Double> = (0..n).map(|c| single(-transport.get(r, c))).collect();
            row[r] =
                (0..n).filter(|c| *c != r).fold(single(absorption[r]), |sum, c| sum.plus(single(transport.get(r, c))));
            row.push(single(emission[r]));
            row
        })
        .collect();
    for p in 0..n {
        for r in p + 1..n {
            let (above, below) = a.split_at_mut(r);
            let (pivot, row) = (&above[p], &mut below[0]);
            let factor = row[p].over(pivot[p]);
            row.iter_mut().zip(pivot).skip(p).for_each(|(v, pivot)| *v = v.minus(factor.times(*pivot)));
        }
    }
    let mut x = vec![single(0.0); n];
    for r in (0..n).rev() {
        let known = (r + 1..n).fold(a[r][n], |sum, c| sum.minus(a[r][c].times(x[c])));
        x[r] = known.over(a[r][r]);
    }
    x.iter().map(|x| x.0).collect()
}

/// A closed room of n patches that exchange étendue at random, each of the same albedo: its equation's parts.
fn white_room(n: usize, absorption: f64) -> (ByHand, Block) {
    let mut stream = Stream::new(0x67_7468, 0, 0);
    let mut exchange = Dense::zeros(n, n);
    for r in 0..n {
        for c in 0..r {
            let t = stream.uniform().powi(4);
            exchange.row_mut(r)[c] = t;
            exchange.row_mut(c)[r] = t;
        }
    }
    let etendue: Vec<f64> = (0..n).map(|r| exchange.row_slice(r).iter().sum()).collect();
    let propagation = Dense::from_fn(n, n, |r, c| exchange.get(r, c) / etendue[r]);
    let transport = Dense::from_fn(n, n, |r, c| (1.0 - absorption) * propagation.get(r, c));
    let root = Diagonal::new(Block::from_fn(n, 1, |_, _| (1.0 - absorption).sqrt()));
    let emission = Block::from_fn(n, 1, |i, _| if i < 3 { 1.0 } else { 0.0 });
    (ByHand { etendue, propagation, root, transport, emission }, Block::from_fn(n, 1, |_, _| absorption))
}

#[test]
fn elimination_without_subtraction_keeps_twelve_digits_where_others_keep_none() {
    // More than one panel of the factorization.
    const N: usize = 75;
    for exponent in [3, 6, 9, 12, 15, 18] {
        let (by_hand, absorption) = white_room(N, 10f64.powi(-exponent));
        let equation = Equation { absorption: Some(&absorption), ..by_hand.equation() };
        let exact = eliminate_in_double(&by_hand.transport, absorption.column(0), by_hand.emission.column(0));
        let error = |found: &Block| {
            found.column(0).iter().zip(&exact).map(|(l, exact)| (l / exact - 1.0).abs()).fold(0.0, f64::max)
        };
        let gth = Gth.solve(equation, &mut ()).unwrap();
        assert!(error(&gth.radiance) <= 1e-12, "1e-{exponent}: {:e}", error(&gth.radiance));

        // Where they do not know what is absorbed, ulps of 1 stand against it.
        let kept = 1e-18 / absorption.get(0, 0);
        for solver in [&Lu as &dyn Solver, &Cg { tolerance: 1e-13 }, &Cholesky] {
            match solver.solve(by_hand.equation(), &mut ()) {
                Ok(answer) => {
                    let error = error(&answer.radiance);
                    assert!(error > kept, "{} at 1e-{exponent}: {error:e}", solver.name());
                    assert!(exponent < 15 || error > 1e-3, "{} at 1e-{exponent}: {error:e}", solver.name());
                }
                Err(error) => assert!(exponent >= 15, "{error}"),
            }
            // Where they do, corrections win the digits back as long as there is one left to begin with.
            match solver.solve(equation, &mut ()) {
                Ok(Solution { radiance, report }) => {
                    let is_solved = matches!(report.stop, Stop::Direct | Stop::Converged);
                    assert!(is_solved || exponent >= 15, "{} at 1e-{exponent}: {report:?}", solver.name());
                    assert!(
                        !is_solved || error(&radiance) <= 1e-11,
                        "{} 1e-{exponent}: {:e}",
                        solver.name(),
                        error(&radiance)
                    );
                    assert!(report.n_refinements > 0 || exponent < 6, "{} at 1e-{exponent}", solver.name());
                }
                Err(error) => assert!(exponent >= 15, "{error}"),
            }
        }
    }
}

#[test]
fn elimination_without_subtraction_takes_light_of_either_sign() {
    let (by_hand, absorption) = white_room(40, 0.25);
    let emission = Block::from_fn(40, 1, |i, _| (i as f64).sin());
    let equation = Equation { absorption: Some(&absorption), emission: &emission, ..by_hand.equation() };
    let [found, reference] = [&Gth as &dyn Solver, &Lu].map(|solver| solver.solve(equation, &mut ()).unwrap().radiance);
    assert!(etendue::compare::relative_max(&found, &reference) < TOLERANCE);
}

#[test]
fn krylov_methods_agree_with_those_of_an_independent_library() {
    use faer::dyn_stack::{MemBuffer, MemStack};
    use faer::matrix_free::IdentityPrecond;
    use faer::matrix_free::bicgstab::{BicgParams, bicgstab, bicgstab_scratch};
    use faer::{Mat, Par};
    let (by_hand, _) = white_room(60, 0.1);
    let n = by_hand.etendue.len();
    let matrix = Mat::from_fn(n, n, |r, c| f64::from(u8::from(r == c)) - by_hand.transport.get(r, c));
    let right = Mat::from_fn(n, 1, |r, _| by_hand.emission.get(r, 0));
    let mut out = Mat::<f64>::zeros(n, 1);
    let scratch =
        bicgstab_scratch(IdentityPrecond { dim: n }, IdentityPrecond { dim: n }, matrix.as_ref(), 1, Par::Seq);
    let params = BicgParams { rel_tolerance: 1e-13, max_iters: 100, ..BicgParams::default() };
    let precond = IdentityPrecond { dim: n };
    let found = bicgstab(
        out.as_mut(),
        precond,
        precond,
        matrix.as_ref(),
        right.as_ref(),
        params,
        |_| {},
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
    );
    assert!(found.is_ok());
    let tolerance = TOLERANCE;
    let ours: [&dyn Solver; 3] = [
        &BiCgStab { tolerance, preconditioner: None },
        &BiCg { tolerance },
        &Gmres { tolerance, restart: 60, preconditioner: None },
    ];
    for solver in ours {
        let answer = solver.solve(by_hand.equation(), &mut ()).unwrap().radiance;
        for i in 0..n {
            // Residuals of 1e-12 over an absorption of a tenth.
            assert!((answer.get(i, 0) - out[(i, 0)]).abs() < 1e-10, "{}", solver.name());
        }
    }
}
