//! Continuous radiosity: solutions on finer and finer patches, extrapolated; values at points by one exact last bounce.

use super::answer::{Answers, Demand};
use super::cube;
use super::error::CaseError;
use super::limit::{Limit, refine};
use super::model::{Body, EXACT, Model, Probe, Walls};
use super::reader::Case;
use super::revolution::{Facing, arc, line, revolve, sectors};
use super::round::lengths;
use super::value::Value;
use crate::geometry::{Polygon, Vec3};
use std::f64::consts::PI;

/// Cells along an edge of a square.
const CELLS: [usize; 6] = [2, 4, 6, 8, 12, 16];

/// Sectors of round shapes whose rings grow with them.
const SECTORS: [usize; 5] = [8, 12, 16, 20, 24];

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
    let model = |n: usize| {
        let body = |k: usize| {
            let (albedo, exitance) = surfaces[k];
            Ok::<_, CaseError>(Body { polygons: cells(polygons[k].vertices(), n)?, albedo, exitance })
        };
        Model::new(vec![body(0)?, body(1)?], Walls::Open, EXACT)
    };
    let limits = refine(&CELLS, 2.0, |n| {
        let model = model(n)?;
        let radiance = model.radiance()?;
        let mut values = model.gathered(&radiance, &probes);
        values.extend(model.radiosity(&radiance));
        Ok((values, model.noise()))
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
        answers.add(table, Value::rows(rows), 1e-12);
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
    let limits = refine(&[8, 12, 16, 24, 32, 40], 2.0, |n| {
        let (rings, azimuths) = (n / 4, sectors(n));
        let disk = |k: usize, radius: f64, height: f64, facing| {
            let polygons = revolve(&line([0.0, height], [radius, height], rings), &azimuths, facing)?;
            Ok::<_, CaseError>(Body { polygons, albedo: surfaces[k].0, exitance: surfaces[k].1 })
        };
        let bodies = vec![disk(0, r1, 0.0, Facing::Left)?, disk(1, r2, h, Facing::Right)?];
        let model = Model::new(bodies, Walls::Open, EXACT)?;
        let radiance = model.radiance()?;
        let mut values = model.gathered(&radiance, &probes);
        values.extend(model.radiosity(&radiance));
        Ok((values, model.noise()))
    })?;
    let names = ["B1_r=0", "B1_r=R1/2", "B1_r=R1", "B2_r=0", "B2_r=R2/2", "B2_r=R2", "B1_mean", "B2_mean"];
    Ok(named(&names, &limits))
}

/// `tube_open_ends`: a tube of one albedo that emits all over; B over the exitance of a black body.
pub fn tube(case: &Case) -> Result<Answers, CaseError> {
    let [diameter, length] = lengths(&case.geometry, ["diameter", "length"])?;
    let (albedo, exitance) = (case.geometry.number("rho")?, case.geometry.number("E")?);
    let (emissivity, radius) = (case.geometry.length("eps")?, 0.5 * diameter);
    let rings = |n: usize| ((length / diameter * n as f64 / 2.0).round() as usize).max(n / 4);
    let limits = refine(&SECTORS, 2.0, |n| {
        let azimuths = sectors(n);
        let wall = revolve(&line([radius, 0.0], [radius, length], rings(n)), &azimuths, Facing::Left)?;
        // Probes lie on the polygons: in the middle of the first sector.
        let (sine, cosine) = (PI / n as f64).sin_cos();
        let foot = radius * cosine * Vec3::new(cosine, sine, 0.0);
        let probe =
            |share: f64| Probe { surface: 0, point: foot + share * length * Vec3::Z, normal: -foot.normalize() };
        let model = Model::new(vec![Body { polygons: wall, albedo, exitance }], Walls::Open, EXACT)?;
        let radiance = model.radiance()?;
        let mut values = model.gathered(&radiance, &[0.0, 0.1, 0.25, 0.5].map(probe));
        let (mean, incident) = (model.radiosity(&radiance)[0], model.irradiance(&radiance)[0]);
        // What leaves through the ends is what the wall loses: (B − H) per area of wall, here per area of both ends and of one.
        let area = model.areas()[0];
        let opening = 0.25 * n as f64 * radius * radius * (2.0 * PI / n as f64).sin() * 2.0;
        values.extend([mean, (mean - incident) * area, (mean - incident) * area / (2.0 * opening)]);
        Ok((values.into_iter().map(|value| value * emissivity / exitance).collect(), model.noise()))
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

/// `spherical_cavity`: a sphere with a round opening, emitting all over.
pub fn spherical_cavity(case: &Case) -> Result<Answers, CaseError> {
    let radius = case.geometry.length("radius")?;
    let opening = case.geometry.number("opening_half_angle_deg")?.to_radians();
    let emissivity = case.geometry.length("eps")?;
    if !(opening > 0.0 && opening < PI) {
        return Err(CaseError::Geometry {
            field: "opening_half_angle_deg".to_string(),
            problem: "must be between 0 and 180",
        });
    }
    let limits = refine(&SECTORS, 2.0, |n| {
        let wall = revolve(&arc(radius, [opening, PI], n / 2), &sectors(n), Facing::Right)?;
        let body = Body { polygons: wall, albedo: 1.0 - emissivity, exitance: emissivity };
        let model = Model::new(vec![body], Walls::Open, EXACT)?;
        let radiance = model.radiance()?;
        let (mean, incident, area) = (model.radiosity(&radiance)[0], model.irradiance(&radiance)[0], model.areas()[0]);
        let lost = (mean - incident) * area;
        let sphere = 4.0 * PI * radius * radius;
        Ok((vec![mean, area / sphere, lost / (radius * radius)], model.noise()))
    })?;
    // The apparent emissivity of the opening is the radiosity of the wall behind it.
    Ok(named(&["eps_apparent", "wall_fraction", "flux_through_aperture_over_Eb_R2"], &limits))
}

/// `sphere_patches`: bands of one sphere of these shares of its area, from pole to pole.
pub fn sphere_patches(case: &Case) -> Result<Answers, CaseError> {
    let radius = case.geometry.length("radius")?;
    let parts = case.geometry.parts("patches")?;
    let mut bands = Vec::new();
    let mut below = 0.0;
    for part in &parts {
        let (share, albedo, exitance) = (part.length("area_fraction")?, part.number("rho")?, part.number("E")?);
        // A band between two heights has the share of the diameter that it spans.
        let polar = |share: f64| (1.0 - 2.0 * share).clamp(-1.0, 1.0).acos();
        let end = if bands.len() + 1 == parts.len() { PI } else { polar(below + share) };
        bands.push(([polar(below), end], albedo, exitance));
        below += share;
    }
    let n_bounces = 11;
    let limits = refine(&SECTORS, 2.0, |n| {
        let azimuths = sectors(n);
        let body = |(angles, albedo, exitance): &([f64; 2], f64, f64)| {
            let pieces = (((angles[1] - angles[0]) / PI * 8.0).ceil() as usize).max(2) * n / 16;
            let polygons = revolve(&arc(radius, *angles, pieces.max(1)), &azimuths, Facing::Right)?;
            Ok::<_, CaseError>(Body { polygons, albedo: *albedo, exitance: *exitance })
        };
        let bodies = bands.iter().map(body).collect::<Result<_, _>>()?;
        let model = Model::new(bodies, Walls::Closed, EXACT)?;
        let radiance = model.radiance()?;
        let areas = model.areas();
        let whole: f64 = areas.iter().sum();
        let mean = |values: Vec<f64>| values.iter().zip(areas).map(|(value, area)| value * area).sum::<f64>() / whole;
        let mut values = vec![mean(model.irradiance(&radiance))];
        let mut term = model.system.emission().clone();
        for _ in 0..=n_bounces {
            values.push(mean(model.irradiance(&term)));
            term = model.bounce(&term);
        }
        values.push(mean(bands.iter().map(|band| band.1).collect()));
        values.push(model.spectral_radius());
        values.push(values[0] / values[1]);
        values.extend(model.radiosity(&radiance));
        Ok((values, model.noise()))
    })?;
    let mut answers = named(&["H", "H_direct"], &limits);
    let list = |limits: &[Limit]| {
        let worst = limits.iter().map(|limit| limit.error).fold(0.0, f64::max);
        (Value::numbers(limits.iter().map(|limit| limit.value)), worst)
    };
    let after = n_bounces + 2;
    answers.values.insert("H_after_bounce_k_contribution_0_to_11".to_string(), list(&limits[1..after]));
    for (name, limit) in
        ["mean_rho", "spectral_radius", "sphere_multiplier_H_over_Hdirect"].iter().zip(&limits[after..])
    {
        answers.number(*name, limit.value, limit.error);
    }
    answers.values.insert("B".to_string(), list(&limits[after + 3..]));
    Ok(answers)
}

/// `cylindrical_cavity`: a tube that emits all over, closed at the bottom, open at the top.
pub fn cylindrical_cavity(case: &Case) -> Result<Answers, CaseError> {
    let [diameter, length] = lengths(&case.geometry, ["diameter", "length"])?;
    let (albedo, exitance) = (case.geometry.number("rho")?, case.geometry.number("E")?);
    let (emissivity, radius) = (case.geometry.length("eps")?, 0.5 * diameter);
    let limits = refine(&SECTORS, 2.0, |n| {
        let azimuths = sectors(n);
        let n_rings = ((length / diameter * n as f64 / 2.0).round() as usize).max(n / 2);
        // Rings crowd where wall and base meet: the solution bends there.
        let crowd = |points: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
            points
                .into_iter()
                .map(|[r, z]| [radius * (1.0 - (1.0 - r / radius).powi(2)), length * (z / length).powi(2)])
                .collect()
        };
        let base = revolve(&crowd(line([0.0, 0.0], [radius, 0.0], n / 4)), &azimuths, Facing::Left)?;
        let wall = revolve(&crowd(line([radius, 0.0], [radius, length], n_rings)), &azimuths, Facing::Left)?;
        let body = |polygons| Body { polygons, albedo, exitance };
        let model = Model::new(vec![body(base), body(wall)], Walls::Open, EXACT)?;
        let radiance = model.radiance()?;
        let centre = Probe { surface: 0, point: Vec3::ZERO, normal: Vec3::Z };
        let mut values = model.gathered(&radiance, &[centre]);
        let (means, incident) = (model.radiosity(&radiance), model.irradiance(&radiance));
        let lost: f64 = (0..2).map(|k| (means[k] - incident[k]) * model.areas()[k]).sum();
        values.extend([lost / model.areas()[0], means[1], means[0]]);
        Ok((values.into_iter().map(|value| value * emissivity / exitance).collect(), model.noise()))
    })?;
    Ok(named(&["B_base_centre", "effective_emissivity_aperture", "B_wall_mean", "B_base_mean"], &limits))
}

/// `cube`: one face emits; means of the faces, on cells that crowd towards the edges, where the solution bends.
pub fn cube_means(case: &Case) -> Result<Answers, CaseError> {
    let side = case.geometry.length("side")?;
    let albedo = case.geometry.number("rho")?;
    let means = |n: usize, grading: f64| {
        let at = |k: usize| {
            let s = k as f64 / n as f64;
            if s <= 0.5 { 0.5 * (2.0 * s).powf(grading) } else { 1.0 - 0.5 * (2.0 * (1.0 - s)).powf(grading) }
        };
        let span = |k: usize| [at(k), at(k + 1)];
        let mut bodies = Vec::new();
        for (f, face) in cube::faces(side).iter().enumerate() {
            let polygons = (0..n * n).map(|k| face.cell(span(k / n), span(k % n))).collect::<Result<_, _>>()?;
            bodies.push(Body { polygons, albedo, exitance: if f == 0 { 1.0 } else { 0.0 } });
        }
        let model = Model::new(bodies, Walls::Closed, EXACT)?;
        Ok::<_, CaseError>((model.radiosity(&model.radiance()?)[..3].to_vec(), model.noise()))
    };
    let limits = refine(&[4, 6, 8, 10], 2.0, |n| means(n, 2.5))?;
    let mut answers = named(&["mean_B_floor", "mean_B_ceiling", "mean_B_side"], &limits);
    let table = "P0_uniform_n_x_n_means_floor_ceiling_side";
    if let Some(rows) = case.values.get(table).and_then(Value::items) {
        // Only meshes that can be solved as they are, without use of the symmetry of this one scene.
        let counts: Vec<usize> = rows
            .iter()
            .filter_map(|row| row.items()?.first()?.number())
            .map(|n| n as usize)
            .filter(|n| *n <= 8)
            .collect();
        let rows = counts.into_iter().map(|n| Ok(std::iter::once(n as f64).chain(means(n, 1.0)?.0).collect()));
        answers.add(table, Value::rows(rows.collect::<Result<Vec<_>, CaseError>>()?), 1e-10);
    }
    Ok(answers)
}
