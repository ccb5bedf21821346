//! Radiosity in spheres: one sphere in bands, one with an opening, and one within another.

use super::answer::{Answers, Demand};
use super::enclosure::{solve, spectrum};
use super::error::CaseError;
use super::limit::{EVEN, Limit, Refinement, refine};
use super::model::{Body, Model, Shape, WHOLE};
use super::reader::Case;
use super::revolution::{Facing, arc, joined, revolve, sectors};
use super::round::{ACCURACY, ENOUGH, LEVELS, SECTORS, agreeing, lengths, n_rings, nested_balls};
use super::symmetry::of_sectors;
use super::value::Value;
use crate::geometry::Polygon;
use std::f64::consts::{PI, TAU};

/// Bounces whose contributions are told.
const N_BOUNCES: usize = 11;

/// Sectors a level of a sphere in bands: narrow ones keep apart what is finer than they are.
const SECTORS_OF_BANDS: usize = 32;

/// Form factors are asked for to as many digits more as radiosities lose; no more than three.
const LEAST_ABSORBED: f64 = 1e-3;

/// Polar angle of the cap that stands for a pole. Its view differs from the pole's by no more than a band of this width at the horizon.
const POLE: f64 = 1e-10;

/// No arc in view has more rings at level 1: spheres that all but touch are not resolved.
const MOST_RINGS: f64 = 128.0;

fn refinement(n_levels: usize) -> Refinement<'static> {
    Refinement { levels: &LEVELS[..n_levels], powers: EVEN, enough: ENOUGH }
}

/// The limits under their names.
fn named(names: &[&str], limits: &[Limit]) -> Answers {
    let mut answers = Answers::new(Demand::Estimate);
    for (name, limit) in names.iter().zip(limits) {
        answers.number(*name, limit.value, limit.error);
    }
    answers
}

/// B and H of surfaces that are one unknown each: the Galerkin solution that is constant on each of them.
fn constant_on_surfaces(
    factors: &[Vec<f64>],
    albedo: &[f64],
    exitance: &[f64],
) -> Result<(Vec<f64>, Vec<f64>), CaseError> {
    let b = solve(albedo.len(), |i, j| albedo[i] * factors[i][j], exitance)?;
    let h = factors.iter().map(|row| row.iter().zip(&b).map(|(f, b)| f * b).sum()).collect();
    Ok((b, h))
}

/// `sphere_patches`: bands of one sphere of these shares of its area, from pole to pole, one unknown each.
pub fn sphere_patches(case: &Case) -> Result<Answers, CaseError> {
    let radius = case.geometry.length("radius")?;
    let parts = case.geometry.parts("patches")?;
    let (mut bands, mut albedo, mut exitance) = (Vec::new(), Vec::new(), Vec::new());
    let mut below = 0.0;
    for part in &parts {
        // A band between two heights has the share of the diameter that it spans.
        let share = part.length("area_fraction")?;
        let polar = |share: f64| (1.0 - 2.0 * share).clamp(-1.0, 1.0).acos();
        let end = if bands.len() + 1 == parts.len() { PI } else { polar(below + share) };
        bands.push([polar(below), end]);
        albedo.push(part.number("rho")?);
        exitance.push(part.number("E")?);
        below += share;
    }
    let limits = refine(refinement(7), |level| {
        let n_sectors = SECTORS_OF_BANDS * level;
        let band = |angles: &[f64; 2]| {
            let profile = arc(radius, *angles, n_rings(angles[1] - angles[0], level));
            revolve(&profile, &sectors(n_sectors), Facing::Right).map(Body::black)
        };
        let bodies = bands.iter().map(band).collect::<Result<Vec<_>, _>>()?;
        let model = Model::folded(
            Shape { bodies, symmetries: of_sectors(n_sectors), ..Shape::default() },
            WHOLE,
            |_, _| true,
            ACCURACY,
        )?;
        let (factors, areas) = (model.form_factors(), model.areas());
        let whole: f64 = areas.iter().sum();
        let mean = |values: &[f64]| values.iter().zip(areas).map(|(value, area)| value * area).sum::<f64>() / whole;
        let incident =
            |b: &[f64]| -> Vec<f64> { factors.iter().map(|row| row.iter().zip(b).map(|(f, b)| f * b).sum()).collect() };
        let (b, h) = constant_on_surfaces(&factors, &albedo, &exitance)?;
        let mut values = vec![mean(&h)];
        let mut term = exitance.clone();
        for _ in 0..=N_BOUNCES {
            let arrived = incident(&term);
            values.push(mean(&arrived));
            term = arrived.iter().zip(&albedo).map(|(h, albedo)| h * albedo).collect();
        }
        values.push(mean(&albedo));
        values.push(spectrum(&model, &albedo)[0]);
        values.push(values[0] / values[1]);
        let largest = b.iter().fold(0.0f64, |most, b| most.max(*b));
        values.extend(b);
        // As for radiosities, and the multiplier is one over the share of direct light.
        let absorbed = 1.0 - albedo.iter().fold(0.0f64, |most, albedo| most.max(*albedo));
        Ok((values.clone(), model.noise() * largest.max(values[0] / values[1]) / absorbed))
    })?;
    let mut answers = named(&["H", "H_direct"], &limits);
    let list = |limits: &[Limit]| {
        let worst = limits.iter().map(|limit| limit.error).fold(0.0, f64::max);
        (Value::numbers(limits.iter().map(|limit| limit.value)), worst)
    };
    let after = N_BOUNCES + 2;
    answers.values.insert("H_after_bounce_k_contribution_0_to_11".to_string(), list(&limits[1..after]));
    for (name, limit) in
        ["mean_rho", "spectral_radius", "sphere_multiplier_H_over_Hdirect"].iter().zip(&limits[after..])
    {
        answers.number(*name, limit.value, limit.error);
    }
    answers.values.insert("B".to_string(), list(&limits[after + 3..]));
    Ok(answers)
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
    let limits = refine(refinement(8), |level| {
        let n_sectors = SECTORS * level;
        let profile = arc(radius, [opening, PI], n_rings(PI - opening, level));
        let wall = revolve(&profile, &sectors(n_sectors), Facing::Right)?;
        let body = Body { albedo: 1.0 - emissivity, exitance: emissivity, ..Body::black(wall) };
        let shape = Shape { bodies: vec![body], symmetries: of_sectors(n_sectors), ..Shape::default() };
        let model = Model::folded(shape, WHOLE, |_, _| true, ACCURACY)?;
        let radiance = model.radiance()?;
        let (mean, incident, area) = (model.radiosity(&radiance)[0], model.irradiance(&radiance)[0], model.areas()[0]);
        let lost = (mean - incident) * area;
        let sphere = 4.0 * PI * radius * radius;
        let noise = model.radiosity_noise(&radiance) * (area / radius.powi(2)).max(1.0);
        Ok((vec![mean, area / sphere, lost / (radius * radius)], noise))
    })?;
    // The apparent emissivity of the opening is the radiosity of the wall behind it.
    Ok(named(&["eps_apparent", "wall_fraction", "flux_through_aperture_over_Eb_R2"], &limits))
}

/// `concentric_spheres` with albedos: each sphere is one unknown. See [`concentric_spheres`](super::round::concentric_spheres) for the levels.
pub fn grey(case: &Case) -> Result<Answers, CaseError> {
    let [inner, outer] = lengths(&case.geometry, ["r_inner", "r_outer"])?;
    let (albedo, exitance) = (case.geometry.numbers("rho")?, case.geometry.numbers("E")?);
    if albedo.len() != 2 || exitance.len() != 2 {
        return Err(CaseError::Geometry { field: "rho".to_string(), problem: "and 'E' must have two numbers each" });
    }
    let limits = refine(agreeing(), |level| {
        let bodies = nested_balls(inner, outer, SECTORS * level, 4 * level)?.map(Body::black).into();
        let shape = Shape { bodies, symmetries: of_sectors(SECTORS * level), ..Shape::default() };
        let absorbed = 1.0 - albedo[0].max(albedo[1]);
        let accuracy = ACCURACY * absorbed.clamp(LEAST_ABSORBED, 1.0);
        let model = Model::folded(shape, WHOLE, |_, _| true, accuracy)?;
        let (b, h) = constant_on_surfaces(&model.form_factors(), &albedo, &exitance)?;
        Ok((vec![b[0], b[1], b[0] - h[0]], model.noise() * b[0].max(b[1]) / absorbed))
    })?;
    Ok(named(&["B1", "B2", "q1"], &limits))
}

/// Pₗ(x) by its three-term recurrence.
fn legendre(l: usize, x: f64) -> f64 {
    let (mut before, mut value) = (1.0, x);
    if l == 0 {
        return before;
    }
    for k in 1..l {
        (before, value) = (value, ((2 * k + 1) as f64 * x * value - k as f64 * before) / (k + 1) as f64);
    }
    value
}

/// The mean of Pₗ between two cosines: ∫ Pₗ = (Pₗ₊₁ − Pₗ₋₁) / (2 l + 1), for l ≥ 1.
fn mean_legendre(l: usize, from: f64, to: f64) -> f64 {
    let primitive = |x: f64| (legendre(l + 1, x) - legendre(l - 1, x)) / (2 * l + 1) as f64;
    (primitive(to) - primitive(from)) / (to - from)
}

/// The degree l in "1+P_l(cos theta)".
fn degree(emission: &str) -> Result<usize, CaseError> {
    let digits = emission.strip_prefix("1+P_").and_then(|rest| rest.strip_suffix("(cos theta)"));
    let degree = digits.and_then(|digits| digits.parse().ok()).filter(|l| (1..=64).contains(l));
    degree.ok_or(CaseError::Needs("an emission of the form 1+P_l(cos theta)"))
}

/// A sphere about the origin in rings from pole to pole, the first of which is a flat cap so small that it stands for the pole, and the mean
/// of Pₗ over each of them. `arcs` are where rings end and what their width is at most up to there, at level 1.
fn capped(
    radius: f64,
    arcs: &[(f64, f64)],
    level: usize,
    facing: Facing,
    l: usize,
) -> Result<(Vec<Polygon>, Vec<f64>), CaseError> {
    let mut from = POLE;
    let rings = joined(arcs.iter().map(|(to, width)| {
        let n_rings = ((to - from) / width).ceil().max(1.0) as usize * level;
        arc(radius, [std::mem::replace(&mut from, *to), *to], n_rings)
    }));
    let profile = joined([vec![[0.0, rings[0][1]], rings[0]], rings.clone()]);
    let polygons = revolve(&profile, &sectors(SECTORS * level), facing)?;
    let means = rings.windows(2).map(|ends| mean_legendre(l, ends[0][1] / radius, ends[1][1] / radius));
    Ok((polygons, std::iter::once(1.0).chain(means).collect()))
}

/// `concentric_spheres` of which the outer one emits 1 + Pₗ(cos θ): four unknowns, coefficients of 1 and of Pₗ on both.
///
/// Spheres about one point look alike from everywhere on each of them. Operators that commute with all rotations take Pₗ to a multiple of
/// itself (Schur's lemma), and the multiple is what arrives at the pole, where Pₗ is 1, from rings that send Pₗ. Rings end where the pole's
/// view does, at the horizon of its own plane or of the inner sphere: all of them then see it in full or not at all, and errors run in
/// even powers.
pub fn zonal(case: &Case) -> Result<Answers, CaseError> {
    let [inner, outer] = lengths(&case.geometry, ["r_inner", "r_outer"])?;
    let albedo = [case.geometry.number("rho_inner")?, case.geometry.number("rho_outer")?];
    let l = degree(&case.geometry.text("E_outer")?)?;
    if case.geometry.number("E_inner")? != 0.0 {
        return Err(CaseError::Needs("an inner sphere that does not emit"));
    }
    // Rings in view resolve what is between the spheres, and Pₗ; those out of view stand only in the way.
    let horizon = (inner / outer).acos();
    let hidden = (PI, TAU / SECTORS as f64);
    let width = hidden.1.min((outer - inner) / outer).min(1.0 / l as f64).max(horizon / MOST_RINGS);
    let limits = refine(refinement(8), |level| {
        // A body for every ring: those of the inner sphere first.
        let (balls, zonal): (Vec<_>, Vec<_>) = [
            capped(inner, &[(horizon, width), hidden], level, Facing::Left, l)?,
            capped(outer, &[(horizon, width), (2.0 * horizon, width), hidden], level, Facing::Right, l)?,
        ]
        .into_iter()
        .unzip();
        let rings = balls.iter().flat_map(|ball| ball.chunks(SECTORS * level));
        let bodies = rings.map(|ring| Body::black(ring.to_vec())).collect();
        let shape = Shape { bodies, symmetries: of_sectors(SECTORS * level), ..Shape::default() };
        let caps = [0, zonal[0].len()];
        let least_absorbed = 1.0 - albedo[0].max(albedo[1]);
        let accuracy = ACCURACY * least_absorbed.clamp(LEAST_ABSORBED, 1.0);
        let model = Model::folded(shape, WHOLE, |from, _| caps.contains(&from), accuracy)?;

        // Sum over rings what arrives at the poles, plain and of Pₗ.
        let factors = model.form_factors();
        let arriving = |weight: &dyn Fn(f64) -> f64| -> Vec<Vec<f64>> {
            let from = |to: usize, sphere: usize| {
                let rings = factors[caps[to]][caps[sphere]..].iter().zip(&zonal[sphere]);
                rings.map(|(factor, mean)| factor * weight(*mean)).sum()
            };
            (0..2).map(|to| (0..2).map(|sphere| from(to, sphere)).collect()).collect()
        };
        let (plain, with_zonal) = (arriving(&|_| 1.0), arriving(&|mean| mean));
        let (mean, _) = constant_on_surfaces(&plain, &albedo, &[0.0, 1.0])?;
        let (amplitude, _) = constant_on_surfaces(&with_zonal, &albedo, &[0.0, 1.0])?;
        let at = |sphere: usize, cosine: f64| mean[sphere] + amplitude[sphere] * legendre(l, cosine);
        let values = vec![
            mean[1],
            mean[0],
            amplitude[1],
            amplitude[0],
            with_zonal[1][1],
            with_zonal[0][1],
            at(1, 1.0),
            at(1, -1.0),
            at(0, 1.0),
        ];

        // The band at the horizon sees one sphere for the other, which differ by this much.
        let largest = |b: &[f64]| b[0].abs().max(b[1].abs());
        let absorbed = |factors: &[Vec<f64>]| {
            let sent_on = |k: usize| albedo[k] * factors[k].iter().map(|factor| factor.abs()).sum::<f64>();
            (1.0 - sent_on(0).max(sent_on(1))).max(f64::EPSILON)
        };
        let noise = model.noise();
        let of_mean = (noise * largest(&mean) + POLE * (mean[1] - mean[0]).abs()) / absorbed(&plain);
        let of_amplitude = (noise + POLE) * largest(&amplitude).max(1.0) / absorbed(&with_zonal);
        Ok((values, of_mean + of_amplitude))
    })?;
    let names = [
        "B2_l0",
        "B1_l0",
        "B2_l",
        "B1_l",
        "eigenvalue_outer_outer_l",
        "coupling_m_l",
        "B2_at_theta0",
        "B2_at_theta180",
        "B1_at_theta0",
    ];
    Ok(named(&names, &limits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legendre_polynomials_have_their_values_and_means() {
        // P₃(x) = (5 x³ − 3 x)/2, and its mean over [0, 1] is −1/8. Some ulp.
        assert!((legendre(3, 0.3) - 0.5 * (5.0 * 0.027 - 0.9)).abs() < 1e-15);
        assert!((mean_legendre(3, 0.0, 1.0) + 0.125).abs() < 1e-15);
        assert!(degree("1+P_3(cos theta)").is_ok_and(|l| l == 3) && degree("1+P_0(cos theta)").is_err());
    }

    /// ∫ Pₗ over a sphere is zero, and so is the sum over its rings: a ring covers the share of the sphere that it spans in height.
    #[test]
    fn rings_from_pole_to_pole_cover_the_sphere() {
        let (level, l) = (2, 3);
        let arcs = [(1.0, 0.3), (PI, 0.7)];
        let (polygons, means) = capped(2.0, &arcs, level, Facing::Right, l).expect("a sphere");
        assert_eq!(polygons.len(), means.len() * SECTORS * level);
        let height = |polygon: &Polygon| {
            let (low, high) =
                polygon.vertices().iter().fold((2.0f64, -2.0f64), |(low, high), v| (low.min(v.z), high.max(v.z)));
            high - low
        };
        let rings = polygons.chunks(SECTORS * level).zip(&means);
        let (covered, sum) =
            rings.fold((0.0, 0.0), |(c, s), (ring, mean)| (c + height(&ring[0]), s + height(&ring[0]) * mean));
        // Some ulp of heights of 2 a ring.
        assert!((covered - 4.0).abs() < 1e-14 && sum.abs() < 1e-13, "{covered} {sum}");
    }
}
