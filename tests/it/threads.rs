//! The same bits on any number of threads.

use super::scenes::Case;
use etendue::assembly::System;
use etendue::linalg::LinearOperator;
use etendue::solver::{self, Solution};

fn on_threads<R: Send>(n_threads: usize, work: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap().install(work)
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

fn bits_of_system(system: &System) -> Vec<u64> {
    let mut row = vec![0.0; system.n_bundles()];
    let mut all = bits(system.sinks().values());
    for i in 0..system.n_bundles() {
        system.exchange().row(0, i, &mut row);
        all.extend(bits(&row));
    }
    all
}

fn bits_of_answer(answer: &Solution) -> Vec<u64> {
    let report = &answer.report;
    let bracket = report.bracket.as_ref().unwrap();
    [
        answer.radiance.values(),
        &report.history,
        bracket.low.values(),
        bracket.high.values(),
        &[report.true_residual, report.products],
    ]
    .iter()
    .flat_map(|values| bits(values))
    .collect()
}

#[test]
fn assembly_and_every_solver_give_the_same_bits_on_any_number_of_threads() {
    let run = |n_threads: usize| {
        on_threads(n_threads, || {
            let system = Case::new("cornell-box", 0.4).system;
            let answers: Vec<(&str, Vec<u64>)> = solver::all(1e-12)
                .iter()
                .map(|solver| (solver.name(), bits_of_answer(&solver.solve(system.equation(), &mut ()).unwrap())))
                .collect();
            (bits_of_system(&system), *system.report(), answers)
        })
    };
    let (system, report, answers) = run(1);
    for n_threads in [2, 3, 8] {
        let (other_system, other_report, other_answers) = run(n_threads);
        assert!(system == other_system, "T or its sinks differ on {n_threads} threads");
        assert_eq!(report, other_report, "{n_threads} threads");
        for ((name, answer), (_, other)) in answers.iter().zip(&other_answers) {
            assert!(answer == other, "{name} differs on {n_threads} threads");
        }
    }
}
