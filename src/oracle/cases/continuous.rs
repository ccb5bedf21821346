//! Continuous radiosity: solutions on finer and finer patches, extrapolated; values at points by one exact last bounce.

use super::answer::{Answers, Demand};
use super::cube;
use super::error::CaseError;
use super::limit::{EVEN, EVERY, Limit, Refinement, refine};
use super::model::{Body, Model, Probe, Shape, WHOLE};
use super::reader::Case;
use super::revolution::{Facing, joined, line, revolve, sectors};
use super::round::{ACCURACY, ENOUGH, lengths};
use super::symmetry::{mirror, of_a_box, of_sectors};
use super::value::Value;
use crate::geometry::{Polygon, Vec3};
use std::f64::consts::PI;

/// Grading of cells towards a corner of a cavity and towards edges of a cube. Next to a right angle B runs as B₀ + c dˢ with s < 1; with
/// the k-th of n cells ending at (k/n)^g means err by n^(−g (2 s + 1)) on account of it, which is beyond the fourth power.
const CORNER: f64 = 2.0;
const EDGE: f64 = 2.5;

/// Levels of round shapes.
const LEVELS: [usize; 9] = [1, 2, 3, 4, 5, 6, 8, 10, 12];

/// Sectors a level: rims must be round at the distance of what is next to them, and sectors that are alike cost little.
const SECTORS: usize = 32;

/// Pieces a level are no longer than an eighth of the way around.
const PIECES: f64 = 8.0;

/// Absolute error of rows of form factors behind a table: of pairs a thousandth, relative.
const IN_TABLE: f64 = 1e-5;

/// Rounding and quadrature of tables of discrete means.
const TABLE_ERROR: f64 = 1e-9;

/// Adds each limit under its name.
fn named(names: &[&str], limits: &[Limit]) -> Answers {
    let mut answers = Answers::new(Demand::Estimate);
    for (name, limit) in names.iter().zip(limits) {
        answers.number(*name, limit.value, limit.error);
    }
    answers
}

/// Cells of a parallelogram, n along each edge.
fn cells(corners: &[Vec3], n: usize) -> Result<Vec<Polygon>, CaseError> {
    let (u, v) = (corners[1] - corners[0], corners[3] - corners[0]);
    let point = |i: usize, j: usize| corners[0] + i as f64 / n as f64 * u + j as f64 / n as f64 * v;
    let cell = |i, j| Polygon::new(vec![point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
    (0..n * n)
        .map(|k| cell(k % n, k / n).map_err(|source| CaseError::Polygon { what: "cell".to_string(), source }))
        .collect()
}

/// Shares of a piece in n cells that crowd towards its beginning.
fn crowded(n: usize, grading: f64) -> impl Iterator<Item = f64> {
    (0..=n).map(move |k| (k as f64 / n as f64).powf(grading))
}

/// Pieces a level for a length in a tube of this radius.
fn n_pieces(length: f64, radius: f64, level: usize) -> usize {
    level * (length / (2.0 * PI * radius / PIECES) - 1e-9).ceil().max(1.0) as usize
}

/// Albedo and exitance of two surfaces.
fn two(case: &Case) -> Result<[(f64, f64); 2], CaseError> {
    match (&case.geometry.numbers("rho")?[..], &case.geometry.numbers("E")?[..]) {
        ([a1, a2], [e1, e2]) => Ok([(*a1, *e1), (*a2, *e2)]),
        _ => Err(CaseError::Geometry { field: "rho".to_string(), problem: "and 'E' must have two numbers each" }),
    }
}

/// `polygon_pair` with albedos: two facing parallelograms. Points are the first corner, the middle of the first edge, the centre, and
/// the middle between the first corner and the centre.
pub fn facing_squares(case: &Case) -> Result<Answers, CaseError> {
    let polygons = [case.geometry.polygon("polygon_1")?, case.geometry.polygon("polygon_2")?];
    let surfaces = two(case)?;
    if polygons.iter().any(|polygon| polygon.vertices().len() != 4) {
        return Err(CaseError::Geometry { field: "polygon_1".to_string(), problem: "must be a parallelogram" });
    }
    let mut probes = Vec::new();
    for (surface, polygon) in polygons.iter().enumerate() {
        let (v, centre) = (polygon.vertices(), polygon.centroid());
        for point in [v[0], 0.5 * (v[0] + v[1]), centre, 0.5 * (v[0] + centre)] {
            probes.push(Probe { surface, point, normal: polygon.normal() });
        }
    }
    let v = polygons[0].vertices();
    let symmetries = of_a_box(polygons[0].centroid(), (v[1] - v[0]).normalize(), (v[3] - v[0]).normalize());
    let model = |n: usize| {
        let body = |k: usize| {
            let (albedo, exitance) = surfaces[k];
            Ok::<_, CaseError>(Body { albedo, exitance, ..Body::black(cells(polygons[k].vertices(), n)?) })
        };
        let v = polygons[0].vertices();
        let steps = [v[1] - v[0], v[3] - v[0]].map(|edge| edge / n as f64).to_vec();
        let shape = Shape { bodies: vec![body(0)?, body(1)?], symmetries: symmetries.clone(), steps };
        Model::folded(shape, WHOLE, |from, to| from != to, ACCURACY)
    };
    let limits =
        refine(Refinement { levels: &[2, 4, 6, 8, 12, 16, 24, 32, 48, 64], powers: EVEN, enough: ENOUGH }, |n| {
            let model = model(n)?;
            let radiance = model.radiance()?;
            let mut values = model.gathered(&radiance, &probes);
            values.extend(model.radiosity(&radiance));
            Ok((values, model.radiosity_noise(&radiance)))
        })?;
    let names = ["corner", "edge_mid", "centre", "quarter"];
    let mut answers = Answers::new(Demand::Estimate);
    for (k, limit) in limits.iter().enumerate() {
        let name = match k {
            0..8 => format!("B{}_{}", k / 4 + 1, names[k % 4]),
            _ => format!("B{}_mean", k - 7),
        };
        answers.number(name, limit.value, limit.error);
    }
    let table = "P0_exact_means_n=1,2,4,8";
    if case.values.contains_key(table) {
        let means = |n: usize| model(n).and_then(|model| Ok(model.radiosity(&model.radiance()?)));
        let rows = [1, 2, 4, 8].map(means).into_iter().collect::<Result<Vec<_>, _>>()?;
        answers.add(table, Value::rows(rows), TABLE_ERROR);
    }
    Ok(answers)
}

/// `coaxial_disks` with albedos.
pub fn facing_disks(case: &Case) -> Result<Answers, CaseError> {
    let [r1, r2, h] = lengths(&case.geometry, ["r1", "r2", "h"])?;
    let surfaces = two(case)?;
    let mut probes = Vec::new();
    for (surface, (radius, z, normal)) in [(r1, 0.0, Vec3::Z), (r2, h, -Vec3::Z)].into_iter().enumerate() {
        for share in [0.0, 0.5, 1.0] {
            probes.push(Probe { surface, point: Vec3::new(share * radius, 0.0, z), normal });
        }
    }
    // Rings are no wider than half of the way to the other disk, and end where values are asked for.
    let limits = refine(Refinement { levels: &LEVELS, powers: EVEN, enough: ENOUGH }, |level| {
        let n_sectors = SECTORS * level;
        let disk = |k: usize, radius: f64, height: f64, facing| {
            let n_rings = level * (radius / h).ceil().clamp(1.0, 2.0) as usize;
            let middle = [0.5 * radius, height];
            let profile = joined([line([0.0, height], middle, n_rings), line(middle, [radius, height], n_rings)]);
            let polygons = revolve(&profile, &sectors(n_sectors), facing)?;
            Ok::<_, CaseError>(Body { albedo: surfaces[k].0, exitance: surfaces[k].1, ..Body::black(polygons) })
        };
        let bodies = vec![disk(0, r1, 0.0, Facing::Left)?, disk(1, r2, h, Facing::Right)?];
        let shape = Shape { bodies, symmetries: of_sectors(n_sectors), ..Shape::default() };
        let model = Model::folded(shape, WHOLE, |from, to| from != to, ACCURACY)?;
        let radiance = model.radiance()?;
        let mut values = model.gathered(&radiance, &probes);
        values.extend(model.radiosity(&radiance));
        Ok((values, model.radiosity_noise(&radiance)))
    })?;
    let names = ["B1_r=0", "B1_r=R1/2", "B1_r=R1", "B2_r=0", "B2_r=R2/2", "B2_r=R2", "B1_mean", "B2_mean"];
    Ok(named(&names, &limits))
}

/// `tube_open_ends`: a tube of one albedo that emits all over; B over the exitance of a black body.
pub fn tube(case: &Case) -> Result<Answers, CaseError> {
    let [diameter, length] = lengths(&case.geometry, ["diameter", "length"])?;
    let (albedo, exitance) = (case.geometry.number("rho")?, case.geometry.number("E")?);
    let (emissivity, radius) = (case.geometry.length("eps")?, 0.5 * diameter);
    // Values are asked for at multiples of a twentieth: there rings end, equally wide on both sides.
    let limits = refine(Refinement { levels: &LEVELS, powers: EVERY, enough: ENOUGH }, |level| {
        let n_sectors = SECTORS * level;
        let n_rings = 20 * n_pieces(0.05 * length, radius, level);
        let wall = revolve(&line([radius, 0.0], [radius, length], n_rings), &sectors(n_sectors), Facing::Left)?;
        // Probes lie on the polygons: in the middle of the first sector.
        let (sine, cosine) = (PI / n_sectors as f64).sin_cos();
        let foot = radius * cosine * Vec3::new(cosine, sine, 0.0);
        let probe =
            |share: f64| Probe { surface: 0, point: foot + share * length * Vec3::Z, normal: -foot.normalize() };
        let shape = Shape {
            bodies: vec![Body { albedo, exitance, ..Body::black(wall) }],
            symmetries: [of_sectors(n_sectors), vec![mirror(0.5 * length * Vec3::Z, Vec3::Z)]].concat(),
            steps: vec![length / n_rings as f64 * Vec3::Z],
        };
        let model = Model::folded(shape, WHOLE, |_, _| true, ACCURACY)?;
        let radiance = model.radiance()?;
        let mut values = model.gathered(&radiance, &[0.0, 0.1, 0.25, 0.5].map(probe));
        let (mean, incident) = (model.radiosity(&radiance)[0], model.irradiance(&radiance)[0]);
        // What leaves through the ends is what the wall loses: (B − H) per area of wall, here per area of both ends and of one.
        let area = model.areas()[0];
        let opening = 0.5 * n_sectors as f64 * radius * radius * (2.0 * PI / n_sectors as f64).sin();
        values.extend([mean, (mean - incident) * area, (mean - incident) * area / (2.0 * opening)]);
        let noise = model.radiosity_noise(&radiance) * area.max(area / (2.0 * opening)).max(1.0);
        Ok((values.into_iter().map(|value| value * emissivity / exitance).collect(), noise))
    })?;
    let names = [
        "B_x/L=0",
        "B_x/L=0.1",
        "B_x/L=0.25",
        "B_x/L=0.5",
        "B_mean",
        "total_loss_over_Eb",
        "effective_emissivity_of_both_ends",
    ];
    Ok(named(&names, &limits))
}

/// `cylindrical_cavity`: a tube that emits all over, closed at the bottom, open at the top.
pub fn cylindrical_cavity(case: &Case) -> Result<Answers, CaseError> {
    let [diameter, length] = lengths(&case.geometry, ["diameter", "length"])?;
    let (albedo, exitance) = (case.geometry.number("rho")?, case.geometry.number("E")?);
    let (emissivity, radius) = (case.geometry.length("eps")?, 0.5 * diameter);
    // Rings crowd where wall and base meet: the solution bends there.
    let limits = refine(Refinement { levels: &LEVELS, powers: EVEN, enough: ENOUGH }, |level| {
        let n_sectors = SECTORS * level;
        let on_base = crowded(2 * level, CORNER).map(|s| [radius * (1.0 - s), 0.0]).collect::<Vec<_>>();
        let on_wall = crowded(n_pieces(length, radius, level), CORNER).map(|s| [radius, length * s]);
        let base = revolve(&on_base, &sectors(n_sectors), Facing::Right)?;
        let wall = revolve(&on_wall.collect::<Vec<_>>(), &sectors(n_sectors), Facing::Left)?;
        let bodies = [base, wall].map(|polygons| Body { albedo, exitance, ..Body::black(polygons) }).to_vec();
        let shape = Shape { bodies, symmetries: of_sectors(n_sectors), ..Shape::default() };
        let model = Model::folded(shape, WHOLE, |_, _| true, ACCURACY)?;
        let radiance = model.radiance()?;
        let centre = Probe { surface: 0, point: Vec3::ZERO, normal: Vec3::Z };
        let mut values = model.gathered(&radiance, &[centre]);
        let (means, incident) = (model.radiosity(&radiance), model.irradiance(&radiance));
        let lost: f64 = (0..2).map(|k| (means[k] - incident[k]) * model.areas()[k]).sum();
        values.extend([lost / model.areas()[0], means[1], means[0]]);
        let noise = model.radiosity_noise(&radiance) * (1.0 + model.areas()[1] / model.areas()[0]);
        Ok((values.into_iter().map(|value| value * emissivity / exitance).collect(), noise))
    })?;
    Ok(named(&["B_base_centre", "effective_emissivity_aperture", "B_wall_mean", "B_base_mean"], &limits))
}

/// A unit cube's face means: floor, ceiling, and all sides alike; cells that crowd towards the edges where `grading` is above 1.
fn cube_radiosity(side: f64, albedo: f64, n: usize, grading: f64, accuracy: f64) -> Result<(Vec<f64>, f64), CaseError> {
    let at = |k: usize| {
        let s = k as f64 / n as f64;
        if s <= 0.5 { 0.5 * (2.0 * s).powf(grading) } else { 1.0 - 0.5 * (2.0 * (1.0 - s)).powf(grading) }
    };
    // Equal cells are cut by the basis.
    let (n_cut, patch_size) = if grading == 1.0 { (1, side / n as f64) } else { (n, WHOLE) };
    let span = |k: usize| if n_cut == 1 { [0.0, 1.0] } else { [at(k), at(k + 1)] };
    let face = |face: &cube::Face| {
        (0..n_cut * n_cut).map(|k| face.cell(span(k / n_cut), span(k % n_cut))).collect::<Result<Vec<_>, _>>()
    };
    let faces = cube::faces(side).iter().map(face).collect::<Result<Vec<_>, _>>()?;
    let body = |polygons: Vec<Polygon>, exitance| Body { albedo, exitance, ..Body::black(polygons) };
    let bodies = vec![body(faces[0].clone(), 1.0), body(faces[1].clone(), 0.0), body(faces[2..].concat(), 0.0)];
    let symmetries = of_a_box(Vec3::splat(0.5 * side), Vec3::X, Vec3::Y);
    let steps = Vec3::AXES.map(|axis| side / n as f64 * axis).to_vec();
    let shape = Shape { bodies, symmetries, steps };
    let model = Model::folded(shape, patch_size, |_, _| true, accuracy)?;
    let radiance = model.radiance()?;
    Ok((model.radiosity(&radiance), model.radiosity_noise(&radiance)))
}

/// `cube`: one face emits; means of the faces, on cells that crowd towards the edges, where the solution bends.
pub fn cube_means(case: &Case) -> Result<Answers, CaseError> {
    let side = case.geometry.length("side")?;
    let albedo = case.geometry.number("rho")?;
    let refinement = Refinement { levels: &[4, 6, 8, 12, 16, 20, 24, 28], powers: EVEN, enough: ENOUGH };
    let limits = refine(refinement, |n| cube_radiosity(side, albedo, n, EDGE, ACCURACY))?;
    let mut answers = named(&["mean_B_floor", "mean_B_ceiling", "mean_B_side"], &limits);
    let table = "P0_uniform_n_x_n_means_floor_ceiling_side";
    if let Some(rows) = case.values.get(table).and_then(Value::items) {
        let count = |row: &Value| row.items()?.first()?.number().filter(|n| (1.0..=64.0).contains(n));
        let mut error: f64 = 0.0;
        let mut means = Vec::new();
        for n in rows.iter().filter_map(count) {
            let (values, noise) = cube_radiosity(side, albedo, n as usize, 1.0, IN_TABLE)?;
            error = error.max(noise);
            means.push(std::iter::once(n).chain(values).collect());
        }
        answers.add(table, Value::rows(means), error);
    }
    Ok(answers)
}
