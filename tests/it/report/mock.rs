//! A made-up study, plausible in every number, so that figures and page can be looked at without running one.

use etendue::image::Image;
use etendue::study::{
    AdjointRun, AlbedoLevel, AlbedoStudy, Approach, Duality, EstimatorRun, ExchangeSummary, Family, HistoryPoint,
    LawsMeasured, MeshAgreement, Pictures, Provenance, Refinement, RefinementLevel, RepairRun, SamplePoint,
    SequentialPoint, SequentialRun, SolverRun, StudyOutcome, SurfaceMean, Truncation, VarianceAgreement,
};
use std::collections::BTreeMap;

/// A reproducible number in [−1, 1) that looks random.
fn wobble(i: usize) -> f64 {
    2.0 * ((i as f64 * 12.9898 + 0.7).sin() * 43_758.545_3).fract().abs() - 1.0
}

/// An iterative run that shrinks its error by `factor` every `step` products until rounding stops it.
fn iterative(solver: &str, factor: f64, step: f64, seed: usize) -> SolverRun {
    let mut history = Vec::new();
    for i in 0..400 {
        let error = (0.8 * factor.powi(i) * (1.0 + 0.15 * wobble(seed + i as usize))).max(2e-16);
        let predicted = (seed < 200).then(|| 0.9 * factor.powi(i));
        let (products, residual) = (step * f64::from(i), (0.6 * error).max(1e-16));
        history.push(HistoryPoint { products, seconds: 0.004 * products, residual, error, predicted });
        if 0.6 * error < 1e-13 {
            break;
        }
    }
    let last = *history.last().unwrap();
    SolverRun {
        solver: solver.into(),
        kind: "iterative".into(),
        family: if factor < 0.2 { Family::Krylov } else { Family::Stationary },
        stop: "converged".into(),
        refusal: None,
        n_applies: last.products as usize,
        n_adjoint_applies: 0,
        products: last.products,
        seconds: 0.004 * last.products,
        true_residual: last.residual,
        error: last.error,
        error_bound: Some(6.0 * last.error),
        adjoint: Some(adjoint("converged", last.products, last.error)),
        history,
    }
}

fn adjoint(stop: &str, products: f64, difference: f64) -> AdjointRun {
    AdjointRun { stop: stop.into(), products, seconds: 0.004 * products, difference }
}

/// Products that grow as 1/(1 − albedo), or as its root, and one method that refuses the last.
fn albedos(solvers: &[SolverRun]) -> AlbedoStudy {
    const BUDGET: f64 = 1000.0;
    let level = |albedo: f64| {
        let runs = solvers.iter().enumerate().map(|(k, run)| {
            let growth = if run.family == Family::Krylov { (1.0 - albedo).powf(-0.5) } else { 1.0 / (1.0 - albedo) };
            let products = ((20 + k) as f64 * growth).min(BUDGET);
            let stop = match (run.kind.as_str(), products < BUDGET) {
                ("direct", _) => "direct",
                (_, true) => "converged",
                (_, false) => "budget",
            };
            SolverRun { stop: stop.into(), products, history: Vec::new(), adjoint: None, ..run.clone() }
        });
        let mut runs: Vec<SolverRun> = runs.collect();
        if albedo > 0.99 {
            runs[1].stop = "refused".into();
            runs[1].refusal = Some("Cholesky needs I − K to be positive definite".into());
            runs[1].products = f64::NAN;
        }
        AlbedoLevel { albedo, runs }
    };
    let levels = [0.5, 0.9, 0.99, 0.999].map(level).to_vec();
    AlbedoStudy { tolerance: 1e-12, budget: BUDGET, reference_solver: "gth".into(), levels }
}

fn direct(solver: &str, seconds: f64, error: f64) -> SolverRun {
    SolverRun {
        solver: solver.into(),
        kind: "direct".into(),
        family: Family::Direct,
        stop: "direct".into(),
        refusal: None,
        n_applies: 0,
        n_adjoint_applies: 0,
        products: 812.5,
        seconds,
        true_residual: 3.1e-16,
        error,
        error_bound: None,
        adjoint: Some(adjoint("direct", 812.5, 2.2e-16)),
        history: Vec::new(),
    }
}

fn estimator(name: &str, truth: &str, noise: f64, floor: f64, seed: usize) -> EstimatorRun {
    let is_walk = truth == "discrete";
    let points: Vec<SamplePoint> = (0..6)
        .map(|i| {
            let samples = 16_u64 << (2 * i);
            let predicted = noise / (samples as f64).sqrt();
            let standard_error = predicted * (1.0 + 0.03 * wobble(seed + i as usize));
            let error = (predicted * (1.0 + 0.05 * wobble(seed + 31 + i as usize))).hypot(floor);
            let (steps, seconds) = (2436 * 3 * samples, 1e-4 * samples as f64 * (1.0 + seed as f64 / 20.0));
            let predicted = is_walk.then_some(predicted);
            SamplePoint { samples_per_bundle: samples, error, standard_error, predicted, steps, seconds }
        })
        .collect();
    let agrees = floor == 0.0;
    let last = *points.last().unwrap();
    EstimatorRun {
        estimator: name.into(),
        approach: if is_walk { Approach::Gathering } else { Approach::Paths },
        truth: truth.into(),
        refusal: None,
        worst_z: if agrees { 4.21 } else { 61.0 },
        n_degrees_of_freedom: None,
        n_comparisons: 7308,
        p_value: if agrees { 0.17 } else { 0.0 },
        slope: if agrees { -0.501 } else { -0.31 },
        seconds_slope: if agrees { -0.497 } else { -0.33 },
        efficiency: 1.0 / (last.standard_error.powi(2) * last.seconds),
        samples_for_percent: (noise / 0.01).powi(2).ceil(),
        variance: is_walk.then_some(VarianceAgreement { ratio: 1.003, standard_error: 0.004, p_value: 0.45 }),
        prediction_refusal: None,
        mesh: (!is_walk).then_some(MeshAgreement {
            difference: 0.0019,
            noise: 0.0006,
            agrees: true,
            worst_t: None,
            p_value: None,
        }),
        points,
        seconds: last.seconds,
    }
}

/// A tenth of the error a stage, until rounding.
fn sequential() -> SequentialRun {
    let stages: Vec<SequentialPoint> = (1..18)
        .map(|k| {
            let error = 0.4_f64 * 0.1_f64.powi(k as i32).max(2e-14);
            SequentialPoint {
                products: k,
                steps: 1_900_000 * k as u64,
                seconds: 0.21 * k as f64,
                residual: 1.7 * error,
                error,
            }
        })
        .collect();
    SequentialRun {
        estimator: "sequential-walk".into(),
        refusal: None,
        n_walks: 256,
        stop: "converged".into(),
        factor: 0.1,
        seconds: 3.57,
        stages,
    }
}

/// A box of soft colours, `light` times as bright.
fn picture(light: f64) -> Image {
    let (width, height) = (256, 256);
    let mut image = Image::zeros(width, height, ["R", "G", "B"].map(String::from).to_vec());
    for y in 0..height {
        for x in 0..width {
            let (u, v) = (x as f64 / width as f64, y as f64 / height as f64);
            let lamp = if (u - 0.5).abs() < 0.12 && (v - 0.12).abs() < 0.03 { 18.0 } else { 0.0 };
            let red = light * (0.25 + 0.5 * (1.0 - u) * (1.0 - v));
            let green = light * (0.25 + 0.4 * u * (1.0 - v));
            image.pixel_mut(x, y).copy_from_slice(&[
                red + lamp,
                green + lamp,
                0.8 * light * (0.3 + 0.2 * v) + 0.6 * lamp,
            ]);
        }
    }
    image
}

/// The Cornell box as a study of it might come out.
pub fn cornell() -> StudyOutcome {
    let surfaces = ["floor", "ceiling", "back wall", "red wall", "green wall", "small box", "large box"];
    let means = surfaces.iter().enumerate().flat_map(|(s, surface)| {
        ["red", "green", "blue"].iter().enumerate().map(move |(b, band)| {
            let matrix = (0.35 + 0.08 * wobble(3 * s + b)) / (1.0 + 0.4 * b as f64);
            let path_tracer = matrix * (1.0 + 0.002 * wobble(17 + 3 * s + b));
            SurfaceMean {
                surface: (*surface).into(),
                band: (*band).into(),
                matrix,
                path_tracer,
                standard_error: 0.0004 * matrix,
                discretisation_error: 0.0021 * matrix,
                is_comparable: s > 0,
            }
        })
    });
    let solvers = vec![
        direct("LU (faer)", 0.61, 0.0),
        direct("Cholesky (faer)", 0.34, 8.9e-16),
        direct("LU (nalgebra)", 3.9, 1.1e-15),
        iterative("Neumann series", 0.52, 1.0, 1),
        iterative("Jacobi", 0.52, 1.0, 100),
        iterative("Gauss–Seidel", 0.31, 1.0, 200),
        iterative("Southwell", 0.45, 0.62, 300),
        iterative("Conjugate gradients", 0.11, 1.0, 400),
    ];
    StudyOutcome {
        scene: "cornell-box".into(),
        provenance: Provenance {
            version: "0.1.0".into(),
            command: ["etendue", "study", "cornell-box", "--patch-size", "0.1"].map(String::from).to_vec(),
            scene: "cornell-box".into(),
            scene_hash: "8f1d5c0a9f0e7f6a42c07d7e3b0f8a1be65b1a6bb1f0c0e7d6c1a3f4e5d60718".into(),
            patch_size: 0.1,
            n_directions: 1,
            seed: 20_111,
            settings: BTreeMap::from([
                ("solver tolerance".into(), "1e-13".into()),
                ("quadrature tolerance".into(), "1e-6".into()),
                ("visibility rays a pair".into(), "64".into()),
            ]),
        },
        n_bundles: 2436,
        bands: ["red", "green", "blue"].map(String::from).to_vec(),
        tessellations: Vec::new(),
        exchange: ExchangeSummary {
            n_by_clusters: 2_204_113,
            n_pairs: 1_583_220,
            n_unoccluded: 1_214_017,
            n_integrated: 0,
            n_sampled: 288_940,
            n_hidden: 80_263,
            quadrature_error: 3.4e-7,
            visibility_error: 1.9e-3,
            closure_before_repair: 4.2e-3,
            repair_sweeps: 9,
            repair_change: 8.1e-4,
            escaped: 0.1312,
        },
        laws: LawsMeasured { reciprocity: 0.0, closure: 4.4e-16, positivity: 0.0, conservation: 2.2e-16 },
        repairs: [
            ("symmetric scaling", 9, 0.0, 0.0),
            ("alternating", 41, 2.2e-16, 1.3e-6),
            ("row scaling", 1, 7.4e-3, 5.1e-5),
        ]
        .map(|(method, sweeps, reciprocity, from_reference)| RepairRun {
            method: method.into(),
            sweeps,
            laws: LawsMeasured { reciprocity, closure: 4.4e-16, positivity: 0.0, conservation: 2.2e-16 },
            change: 8.1e-4,
            from_reference,
        })
        .to_vec(),
        reference_solver: "LU (faer)".into(),
        albedos: Some(albedos(&solvers)),
        solvers,
        duality: Duality {
            sensor: "mean irradiance of 'floor'".into(),
            unit: "W m⁻²",
            solver: "LU (faer)".into(),
            reading: vec![1.25, 1.5, 0.75],
            dual_reading: vec![1.25, 1.5, 0.75],
            difference: 2.2e-16,
            stop: "direct".into(),
            products: 812.5,
            seconds: 0.4,
        },
        truncation: (0..44)
            .map(|k| {
                let error = (0.71 * 0.52_f64.powi(k)).max(2e-16);
                Truncation { bounces: k as usize, error, bound: (3.9 * 0.56_f64.powi(k)).max(1e-17) }
            })
            .collect(),
        estimators: vec![
            estimator("Path tracer", "continuous", 1.3, 0.02, 7),
            estimator("Absorption walk", "discrete", 2.6, 0.0, 23),
            estimator("Collision walk", "discrete", 1.7, 0.0, 41),
        ],
        sequential: Some(sequential()),
        refinement: Refinement {
            levels: [(0.4, 168, 0.0141), (0.2, 640, 0.0068), (0.1, 2436, 0.0036), (0.05, 9600, 0.00165)]
                .map(|(patch_size, n_bundles, error)| RefinementLevel { patch_size, n_bundles, error, noise: 0.0006 })
                .to_vec(),
            observed_order: 1.02,
            order_standard_error: 0.07,
            finest_error: 0.0016,
            agrees: true,
            surfaces: means.collect(),
        },
        stages: [
            ("basis", 0.004),
            ("exchange", 9.41),
            ("assembly", 0.22),
            ("solvers", 5.3),
            ("estimators", 11.8),
            ("pictures", 2.1),
        ]
        .map(|(stage, seconds)| (stage.to_string(), seconds))
        .to_vec(),
        pictures: Some(Pictures {
            solved: picture(1.0),
            bounces: (0..6).map(|k| picture(1.0 - 0.6_f64.powi(k))).collect(),
        }),
    }
}
