//! Equations made by hand, most of them without an answer: what solvers say of each.

use etendue::linalg::{Block, Dense, Diagonal, Equation, FactorError, LinearOperator, SelfAdjoint, Unknown};
use etendue::solver::{
    self, Cg, Cholesky, GaussSeidel, Jacobi, Lu, LuNalgebra, Neumann, RowGain, SolveError, Solver, Southwell, Stop,
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

/// The methods that K alone drives.
fn stationary() -> Vec<Box<dyn Solver>> {
    vec![
        Box::new(Neumann { tolerance: TOLERANCE }),
        Box::new(Jacobi { tolerance: TOLERANCE }),
        Box::new(GaussSeidel { tolerance: TOLERANCE }),
        Box::new(Southwell { tolerance: TOLERANCE }),
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

    // Elimination solves it all the same, and offers no bracket.
    for solver in [&Lu as &dyn Solver, &LuNalgebra] {
        let answer = solver.solve(plain(&transport, &emission), &mut ()).unwrap();
        assert!(answer.report.bracket.is_none() && answer.report.true_residual < TOLERANCE);
        // Cramer: det = 1 − 1.8.
        assert!((answer.radiance.get(0, 0) - (1.0 + 1.5 * 0.5) / (1.0 - 1.8)).abs() < TOLERANCE);
    }
}

#[test]
fn gain_above_one_is_not_positive_definite() {
    let by_hand = ByHand::new([1.0, 2.0], [[0.0, 3.0], [3.0, 0.0]], [0.9, 0.9], [1.0, 1.0]);
    match error_of(&Cg { tolerance: TOLERANCE }, by_hand.equation()) {
        SolveError::NotPositiveDefinite { method: "cg", band: 0, curvature, .. } => assert!(curvature < 0.0),
        other => panic!("{other}"),
    }
    let expected = FactorError::NotPositiveDefinite { pivot: 1, size: 2 };
    let found = error_of(&Cholesky, by_hand.equation());
    assert_eq!(found, SolveError::Factor { method: "cholesky", band: 0, source: expected });
}

#[test]
fn a_patch_that_keeps_all_its_light_is_named() {
    let transport = dense([[0.1, 0.2, 0.0], [0.0, 0.3, 0.1], [0.0, 0.2, 1.25]]);
    let emission = column(&[1.0, 1.0, 1.0]);
    for solver in &stationary()[1..] {
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
    for solver in [&Lu as &dyn Solver, &LuNalgebra] {
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
                    assert!(solver.is_direct(), "{}", solver.name());
                }
                SolveError::NotFinite { .. } | SolveError::Diverged { .. } | SolveError::NotSelfAdjoint { .. } => {
                    assert!(!solver.is_direct() || solver.name() == "cholesky", "{}", solver.name());
                }
                other => panic!("{}: {other}", solver.name()),
            }
        }
    }
}

#[test]
fn the_wrong_etendue_is_found_out() {
    for solver in [&Cg { tolerance: TOLERANCE } as &dyn Solver, &Cholesky] {
        assert!(solver.solve(two_patches().equation(), &mut ()).is_ok());
        // One patch said to be a tenth of a per mille larger than it is.
        let by_hand = ByHand { etendue: vec![1.0, 2.0 * 1.0001], ..two_patches() };
        match error_of(solver, by_hand.equation()) {
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
    for solver in solver::all(TOLERANCE) {
        match solver.solve(equation, &mut ()) {
            Ok(_) => assert!(!["cg", "cholesky"].contains(&solver.name())),
            Err(error) => {
                assert_eq!(error, SolveError::NoSelfAdjointForm { method: solver.name() });
                assert!(error.to_string().starts_with(solver.name()));
                assert!(["cg", "cholesky"].contains(&solver.name()));
            }
        }
    }
}
