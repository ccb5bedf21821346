//! A study becomes a complete, self-contained, faithful report, and a folder that is whole or not there.

mod folder;
mod mock;

use etendue::image::{Image, decode_exr};
use etendue::report::{Artifact, SCHEMA, render, spectrum_files};
use etendue::study::{
    BandSpectrum, Family, HistoryPoint, Pictures, SolverRun, SpectrumOutcome, StudyOutcome, Truncation,
};
use std::collections::BTreeSet;

const FIGURES: [&str; 6] = ["convergence", "albedos", "truncation", "monte-carlo", "sequential", "refinement"];

fn file<'a>(files: &'a [Artifact], name: &str) -> &'a [u8] {
    &files.iter().find(|file| file.name == name).unwrap_or_else(|| panic!("{name} is missing")).bytes
}

fn text<'a>(files: &'a [Artifact], name: &str) -> &'a str {
    std::str::from_utf8(file(files, name)).unwrap()
}

/// The rows of a CSV without quoted fields, header first.
fn rows(csv: &str) -> Vec<Vec<&str>> {
    csv.lines().map(|line| line.split(',').collect()).collect()
}

/// Everything a report must be, whatever the outcome.
fn assert_sound(outcome: &StudyOutcome) -> Vec<Artifact> {
    let files = render(outcome).unwrap();

    // Every figure is there three times, and every name once.
    let is_there = |figure: &str| match figure {
        "albedos" => outcome.albedos.is_some(),
        "sequential" => outcome.sequential.is_some(),
        _ => true,
    };
    for figure in FIGURES.iter().filter(|figure| is_there(figure)) {
        let svg = text(&files, &format!("{figure}.svg"));
        let tree = roxmltree::Document::parse(svg).unwrap_or_else(|error| panic!("{figure}.svg: {error}"));
        assert!(tree.root_element().attribute("viewBox").is_some() && !svg.contains("NaN"), "{figure}.svg");
        assert!(file(&files, &format!("{figure}.png")).starts_with(b"\x89PNG"));
        assert!(text(&files, &format!("{figure}.csv")).lines().next().is_some());
    }
    let names: BTreeSet<&str> = files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names.len(), files.len());

    // The page fetches nothing and links only to files beside it.
    let html = text(&files, "report.html");
    for forbidden in ["http:", "https:", "//cdn", "<script", "<link", "@import", "url("] {
        assert!(!html.contains(forbidden), "the page holds {forbidden}");
    }
    for source in html.split("src=\"").skip(1) {
        assert!(source.starts_with("data:image/png;base64,"));
    }
    for link in html.split("href=\"").skip(1) {
        let target = link.split('"').next().unwrap();
        assert!(names.contains(target), "the page links to {target}, which is not in the report");
    }

    // The page nests properly: as XML once the tags that HTML leaves open are closed.
    let mut xml = html.replace("<!doctype html>", "");
    for open in ["<meta ", "<img "] {
        let mut closed = String::new();
        for (i, piece) in xml.split(open).enumerate() {
            closed += &if i == 0 { piece.to_owned() } else { format!("{open}{}", piece.replacen('>', "/>", 1)) };
        }
        xml = closed;
    }
    roxmltree::Document::parse(&xml).unwrap_or_else(|error| panic!("report.html: {error}"));

    // report.json says what it is and lists every file.
    let json: serde_json::Value = serde_json::from_slice(file(&files, "report.json")).unwrap();
    assert_eq!(json["schema"], SCHEMA);
    assert_eq!(json["scene"], outcome.scene.as_str());
    let listed: BTreeSet<&str> = json["files"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert!(names.iter().all(|name| *name == "report.json" || listed.contains(name)));
    files
}

#[test]
fn a_report_is_complete_and_self_contained() {
    let outcome = mock::cornell();
    let files = assert_sound(&outcome);
    let pictures = outcome.pictures.unwrap();
    assert_eq!(decode_exr(file(&files, "solved.exr")).unwrap().channels, ["R", "G", "B"]);
    for k in 0..pictures.bounces.len() {
        decode_exr(file(&files, &format!("bounce-{k}.exr"))).unwrap();
    }
    for picture in ["solved.png", "bounces.png"] {
        assert!(file(&files, picture).starts_with(b"\x89PNG"));
    }
}

#[test]
fn equal_outcomes_give_equal_bytes() {
    assert!(render(&mock::cornell()).unwrap() == render(&mock::cornell()).unwrap());
}

#[test]
fn the_page_says_the_result_first() {
    let mut outcome = mock::cornell();
    let files = render(&outcome).unwrap();
    let html = text(&files, "report.html");
    assert!(html.contains(
        "On 2\u{202f}436 ray bundles, all 8 solvers agree to 1.4×10⁻¹³; random walks on the matrix agree with them"
    ));
    assert!(html.contains("within the estimated discretisation and statistical errors"));

    // What disagrees is said as plainly.
    outcome.estimators[1].p_value = 1e-9;
    outcome.solvers[3].stop = "budget".into();
    outcome.refinement.agrees = false;
    outcome.laws.closure = 1e-3;
    let files = render(&outcome).unwrap();
    let html = text(&files, "report.html");
    for claim in ["7 of 8 solvers finished and agree", "disagree with them", "more than the estimated", "law broken"] {
        assert!(html.contains(claim), "{claim}");
    }
}

/// Every number of every CSV read back must be the same f64, bit for bit.
#[test]
fn csv_brings_every_number_back() {
    let mut outcome = mock::cornell();
    outcome.solvers[3].history[1].error = f64::MIN_POSITIVE / 3.0;
    outcome.solvers[3].history[2].error = f64::INFINITY;
    let files = render(&outcome).unwrap();
    let same = |field: &str, value: f64| field.parse::<f64>().unwrap().to_bits() == value.to_bits();

    let table = rows(text(&files, "convergence.csv"));
    assert_eq!(table[0], ["solver", "iteration", "products", "seconds", "residual", "error", "predicted_error"]);
    let points = outcome.solvers.iter().flat_map(|run| run.history.iter().map(move |p| (&run.solver, p)));
    assert_eq!(table.len() - 1, points.clone().count());
    for (row, (solver, p)) in table[1..].iter().zip(points) {
        assert!(
            row[0] == solver && same(row[2], p.products) && same(row[3], p.seconds) && same(row[4], p.residual),
            "{row:?}"
        );
        assert!(same(row[5], p.error) && row[6].is_empty() == p.predicted.is_none(), "{row:?}");
        assert!(p.predicted.is_none_or(|predicted| same(row[6], predicted)), "{row:?}");
    }
    for (row, t) in rows(text(&files, "truncation.csv"))[1..].iter().zip(&outcome.truncation) {
        assert!(row[0] == t.bounces.to_string() && same(row[1], t.error) && same(row[2], t.bound), "{row:?}");
    }
    let points = outcome.estimators.iter().flat_map(|run| run.points.iter().map(move |p| (&run.estimator, p)));
    let table = rows(text(&files, "monte-carlo.csv"));
    assert_eq!(table[0][3..], ["error", "standard_error", "predicted_standard_error", "steps", "seconds"]);
    assert_eq!(table.len() - 1, points.clone().count());
    for (row, (estimator, p)) in table[1..].iter().zip(points) {
        assert!(row[0] == estimator && row[2] == p.samples_per_bundle.to_string(), "{row:?}");
        assert!(same(row[3], p.error) && same(row[4], p.standard_error) && same(row[7], p.seconds), "{row:?}");
        assert!(row[5].is_empty() == p.predicted.is_none() && row[6] == p.steps.to_string(), "{row:?}");
        assert!(p.predicted.is_none_or(|predicted| same(row[5], predicted)), "{row:?}");
    }
    for (row, run) in rows(text(&files, "estimators.csv"))[1..].iter().zip(&outcome.estimators) {
        assert!(row[0] == run.estimator && same(row[2], run.slope) && same(row[5], run.samples_for_percent), "{row:?}");
        assert!(row[6].is_empty() == run.variance.is_none() && row[13].is_empty() == run.mesh.is_none(), "{row:?}");
        assert!(row[10].is_empty() && same(row[12], run.p_value) && same(row[16], run.seconds), "{row:?}");
    }
    let stages = &outcome.sequential.as_ref().unwrap().stages;
    for (row, stage) in rows(text(&files, "sequential.csv"))[1..].iter().zip(stages) {
        assert!(row[0] == stage.products.to_string() && same(row[3], stage.residual) && same(row[4], stage.error));
    }
    for (row, l) in rows(text(&files, "refinement.csv"))[1..].iter().zip(&outcome.refinement.levels) {
        assert!(same(row[0], l.patch_size) && same(row[2], l.error) && same(row[3], l.noise), "{row:?}");
    }
    for (row, s) in rows(text(&files, "surfaces.csv"))[1..].iter().zip(&outcome.refinement.surfaces) {
        assert!(
            row[0] == s.surface && row[1] == s.band && same(row[2], s.matrix) && same(row[5], s.discretisation_error)
        );
    }
    for (row, run) in rows(text(&files, "solvers.csv"))[1..].iter().zip(&outcome.solvers) {
        assert!(row[0] == run.solver && same(row[6], run.seconds) && same(row[8], run.error), "{row:?}");
        assert_eq!(row[9].is_empty(), run.error_bound.is_none());
        assert!(same(row[12], run.adjoint.as_ref().unwrap().difference), "{row:?}");
    }
    let levels = &outcome.albedos.as_ref().unwrap().levels;
    let runs = levels.iter().flat_map(|level| level.runs.iter().map(move |run| (level.albedo, run)));
    let table = rows(text(&files, "albedos.csv"));
    assert_eq!(table.len() - 1, runs.clone().count());
    for (row, (albedo, run)) in table[1..].iter().zip(runs) {
        assert!(same(row[0], albedo) && row[1] == run.solver && row[3] == run.stop, "{row:?}");
        assert!(row[4] == "NaN" && run.products.is_nan() || same(row[4], run.products), "{row:?}");
    }
}

/// The words of a figure, in the order they were written.
fn words(svg: &str) -> Vec<String> {
    let tree = roxmltree::Document::parse(svg).unwrap();
    let texts = tree.descendants().filter(|node| node.has_tag_name("text"));
    texts.map(|node| node.text().unwrap_or_default().trim().to_owned()).collect()
}

#[test]
fn no_method_is_dropped_from_the_figure_of_albedos() {
    let mut outcome = mock::cornell();
    // One that is refused somewhere says so; one that is refused everywhere has no point, but its name.
    outcome.albedos.as_mut().unwrap().levels[0].runs[6].refusal = Some("no".into());
    for level in &mut outcome.albedos.as_mut().unwrap().levels {
        (level.runs[5].stop, level.runs[5].refusal) = ("refused".into(), Some("no".into()));
        level.runs[5].products = f64::NAN;
    }
    let files = assert_sound(&outcome);
    let words = words(text(&files, "albedos.svg"));
    for run in outcome.solvers.iter().filter(|run| run.kind == "iterative") {
        assert!(words.iter().any(|word| word.starts_with(&run.solver)), "{} is not in {words:?}", run.solver);
    }
    for expected in [
        "Gauss–Seidel (refused)",
        "Southwell (not at 0.5)",
        "budget, 1\u{202f}000 products",
        "not there within it",
        "a = 0.999",
    ] {
        assert!(words.iter().any(|word| word == expected), "'{expected}' is not in {words:?}");
    }
    let html = text(&files, "report.html");
    for expected in ["As walls turn white", "&gt; 1\u{202f}000 · ", "Refused at 0.999: Cholesky needs"] {
        assert!(html.contains(expected), "'{expected}' is not on the page");
    }

    // What was not asked for is not on the page.
    outcome.albedos = None;
    let files = assert_sound(&outcome);
    assert!(files.iter().all(|file| !file.name.starts_with("albedos")));
    assert!(!text(&files, "report.html").contains("As walls turn white"));
}

#[test]
fn many_methods_are_parted_by_what_they_rest_on() {
    let mut outcome = mock::cornell();
    let titles = |outcome: &StudyOutcome| {
        let files = assert_sound(outcome);
        words(text(&files, "convergence.svg")).into_iter().filter(|word| word.contains("error against")).count()
    };
    assert_eq!(titles(&outcome), 0, "few methods share one panel without a family");
    let more: Vec<SolverRun> = (0..10)
        .map(|k| {
            let family = [Family::Stationary, Family::Krylov, Family::Accelerated][k % 3];
            SolverRun { solver: format!("method-{k}"), family, ..outcome.solvers[4].clone() }
        })
        .collect();
    outcome.solvers.extend(more);
    // Three families, against products and against time.
    assert_eq!(titles(&outcome), 6);
}

#[test]
fn what_the_spectrum_foretold_is_drawn_and_named_once() {
    let mut outcome = mock::cornell();
    let n_notes = |outcome: &StudyOutcome| {
        let files = assert_sound(outcome);
        words(text(&files, "convergence.svg")).into_iter().filter(|word| word.contains("foretold")).count()
    };
    assert_eq!(n_notes(&outcome), 1);
    outcome.solvers.iter_mut().flat_map(|run| &mut run.history).for_each(|point| point.predicted = None);
    assert_eq!(n_notes(&outcome), 0);
}

/// A spectrum of these eigenvalues in two bands.
fn spectrum_of(eigenvalues: &[[f64; 2]], radius: f64) -> SpectrumOutcome {
    let band = |name: &str| BandSpectrum {
        band: name.into(),
        radius: [0.9 * radius, radius],
        eigenvalues: eigenvalues.to_vec(),
        singular_values: eigenvalues.iter().map(|[re, im]| 1.1 * re.hypot(*im)).collect(),
        condition: None,
        effective_rank: None,
        bounces: Vec::new(),
    };
    SpectrumOutcome { n_bundles: 9, bands: vec![band("red"), band("blue")], products: 7 }
}

#[test]
fn a_spectrum_is_drawn_whatever_its_numbers() {
    let svg = |outcome: &SpectrumOutcome| {
        let files = spectrum_files(outcome).unwrap();
        let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["spectrum.svg", "spectrum.png", "spectrum.csv"]);
        let svg = text(&files, "spectrum.svg").to_owned();
        assert!(!svg.contains("NaN"));
        svg
    };
    // Real ones are told to be, with a row of bars a band.
    let real = words(&svg(&spectrum_of(&[[0.8, 0.0], [-0.3, 0.0]], 0.8)));
    let complex = words(&svg(&spectrum_of(&[[0.8, 0.0], [0.1, 0.3], [0.1, -0.3]], 0.8)));
    assert!(
        real.iter().any(|word| word.contains("all are real")) && !complex.iter().any(|word| word.contains("real,"))
    );
    for radius in [0.0, f64::INFINITY, f64::NAN, 1e300] {
        svg(&spectrum_of(&[[f64::NAN, 0.0], [0.1, f64::INFINITY], [1e300, 0.0]], radius));
    }
    svg(&spectrum_of(&[], 0.0));
    svg(&SpectrumOutcome { n_bundles: 0, bands: Vec::new(), products: 0 });
}

#[test]
fn text_is_escaped_everywhere() {
    let mut outcome = mock::cornell();
    let hostile = "<script>alert('x')</script> & \"y\",\n\u{1F4A1}";
    outcome.scene = hostile.into();
    outcome.provenance.command.push(hostile.into());
    outcome.provenance.settings.insert(hostile.into(), hostile.into());
    outcome.tessellations.push(hostile.into());
    outcome.duality.sensor = hostile.into();
    outcome.albedos.as_mut().unwrap().reference_solver = hostile.into();
    outcome.albedos.as_mut().unwrap().levels[0].runs[4].solver = hostile.into();
    outcome.reference_solver = hostile.into();
    outcome.solvers[3].solver = hostile.into();
    outcome.estimators[0].estimator = hostile.into();
    outcome.refinement.surfaces[0].surface = hostile.into();
    outcome.stages[0].0 = hostile.into();
    let files = assert_sound(&outcome);
    let quoted = format!("\"{}\"", hostile.replace('"', "\"\""));
    assert!(
        text(&files, "convergence.csv").contains(&quoted),
        "a field with a comma, a quote and a line break is quoted"
    );
}

#[test]
fn nothing_measured_still_makes_a_page() {
    let mut outcome = mock::cornell();
    outcome.solvers.clear();
    outcome.albedos.as_mut().unwrap().levels.clear();
    outcome.truncation.clear();
    outcome.estimators.clear();
    outcome.sequential.as_mut().unwrap().stages.clear();
    outcome.refinement.levels.clear();
    outcome.refinement.surfaces.clear();
    outcome.stages.clear();
    outcome.bands.clear();
    outcome.exchange.n_pairs = 0;
    outcome.pictures = None;
    assert_sound(&outcome);
}

/// Zero, subnormal, negative, NaN, infinite and huge values, each in every place of every figure, and the worst alone.
#[test]
fn no_number_breaks_a_figure() {
    let odd = [0.0, -0.0, 1e-18, 5e-324, -1.0, 1e300, f64::MAX, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let with = |pick: &dyn Fn(usize) -> f64| {
        let mut outcome = mock::cornell();
        outcome.pictures = None;
        for run in &mut outcome.solvers {
            for (i, p) in run.history.iter_mut().enumerate() {
                let predicted = (i % 2 == 0).then(|| pick(i + 4));
                let (products, seconds, residual, error) = (pick(i), pick(i + 3), pick(i + 1), pick(i + 2));
                *p = HistoryPoint { products, seconds, residual, error, predicted };
            }
            (run.error, run.seconds, run.products, run.error_bound) = (pick(0), pick(1), pick(2), Some(pick(3)));
        }
        outcome.truncation =
            (0..20).map(|i| Truncation { bounces: i * i * i, error: pick(i), bound: pick(i + 1) }).collect();
        for run in &mut outcome.estimators {
            for (i, p) in run.points.iter_mut().enumerate() {
                (p.samples_per_bundle, p.error, p.standard_error) = ([0, 1, u64::MAX][i % 3], pick(i), pick(i + 1));
                (p.predicted, p.seconds) = ((i % 2 == 0).then(|| pick(i + 2)), pick(i + 3));
            }
            (run.worst_z, run.p_value, run.slope, run.seconds) = (pick(0), pick(1), pick(2), pick(3));
            (run.seconds_slope, run.efficiency, run.samples_for_percent) = (pick(1), pick(2), pick(4));
            run.variance.iter_mut().for_each(|v| (v.ratio, v.standard_error, v.p_value) = (pick(0), pick(1), pick(2)));
            run.mesh.iter_mut().for_each(|m| (m.difference, m.noise, m.worst_t) = (pick(3), pick(4), Some(pick(5))));
        }
        let staged = outcome.sequential.as_mut().unwrap();
        for (i, stage) in staged.stages.iter_mut().enumerate() {
            (stage.products, stage.steps) = ([0, 1, usize::MAX][i % 3], [u64::MAX, 0, 1][i % 3]);
            (stage.seconds, stage.residual, stage.error) = (pick(i), pick(i + 1), pick(i + 2));
        }
        (staged.factor, staged.seconds) = (pick(0), pick(1));
        for (i, level) in outcome.refinement.levels.iter_mut().enumerate() {
            (level.patch_size, level.error, level.noise) = (pick(i), pick(i + 1), pick(i + 2));
        }
        (outcome.refinement.observed_order, outcome.refinement.order_standard_error) = (pick(0), pick(1));
        (outcome.refinement.finest_error, outcome.laws.closure, outcome.exchange.escaped) = (pick(2), pick(3), pick(4));
        for (i, s) in outcome.refinement.surfaces.iter_mut().enumerate() {
            (s.matrix, s.path_tracer, s.standard_error, s.discretisation_error) =
                (pick(i), pick(i + 1), pick(i + 2), pick(i + 3));
        }
        let albedos = outcome.albedos.as_mut().unwrap();
        (albedos.tolerance, albedos.budget) = (pick(0), pick(1));
        for (i, level) in albedos.levels.iter_mut().enumerate() {
            level.albedo = pick(i);
            for (k, run) in level.runs.iter_mut().enumerate() {
                (run.products, run.seconds, run.error) = (pick(i + k), pick(i + k + 1), pick(i + k + 2));
            }
        }
        for (i, (_, seconds)) in outcome.stages.iter_mut().enumerate() {
            *seconds = pick(i);
        }
        outcome
    };
    for value in [0.0, 5e-324, f64::MAX, f64::NAN] {
        assert_sound(&with(&|_| value));
    }
    for offset in 0..odd.len() {
        assert_sound(&with(&|i| odd[(i + offset) % odd.len()]));
    }
}

#[test]
fn a_true_error_of_zero_is_drawn_at_the_foot_with_a_note() {
    let mut outcome = mock::cornell();
    outcome.solvers[7].history.last_mut().unwrap().error = 0.0;
    let files = assert_sound(&outcome);
    assert!(text(&files, "convergence.svg").contains("below 10⁻¹⁷"));
    assert!(!text(&files, "truncation.svg").contains("below 10⁻¹⁷"));
}

#[test]
fn pictures_of_any_number_of_bands_are_shown() {
    for n_bands in [1, 2, 3, 5] {
        let mut outcome = mock::cornell();
        let mut image = Image::zeros(20, 10, (0..n_bands).map(|b| format!("{b}")).collect());
        image.values.fill(0.3);
        outcome.pictures = Some(Pictures { solved: image.clone(), bounces: vec![image.clone(); 5] });
        let files = assert_sound(&outcome);
        assert_eq!(decode_exr(file(&files, "bounce-4.exr")).unwrap().channels, image.channels);
    }
}

#[test]
fn a_picture_without_pixels_is_an_error() {
    let mut outcome = mock::cornell();
    outcome.pictures = Some(Pictures { solved: Image::zeros(0, 0, vec![]), bounces: vec![] });
    assert!(render(&outcome).is_err());
}
