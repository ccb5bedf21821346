//! Form factors of round shapes: disks, annuli, spheres, cylinders, cones; surface by surface, extrapolated over finer and finer
//! polygons.

use super::answer::{Answers, Demand};
use super::error::CaseError;
use super::limit::refine;
use super::model::{Body, Model, Walls};
use super::reader::{Case, Geometry};
use super::revolution::{Facing, arc, disk, revolve, sectors};
use crate::geometry::{Frame, Polygon, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Sectors where pairs are few: flat shapes facing each other.
const FLAT: [usize; 6] = [16, 24, 32, 48, 64, 96];

/// Sectors where shapes are cut into rings, too.
const RINGED: [usize; 5] = [12, 16, 20, 24, 32];

/// Sectors of a ball seen from outside: planes of its facets cut what it sees.
const BALL: [usize; 5] = [16, 24, 32, 48, 64];

/// Sectors where a pair takes adaptive quadrature around its occluders.
const BLOCKED: [usize; 3] = [8, 12, 16];

/// Sectors of balls within balls: both have the same facets, so that what they exchange has the ratio of their areas on any.
const NESTED: [usize; 2] = [4, 6];

/// Absolute error asked for of form factors past something round.
const ROUND: f64 = 1e-8;

/// What a case asks for: its name, and the surfaces from and to which the form factor is.
type Wanted = [(&'static str, usize, usize)];

/// The answers for named form factors of surfaces that are built for every number of sectors.
fn factors(
    levels: &[usize],
    wanted: &Wanted,
    build: impl Fn(usize) -> Result<Vec<Vec<Polygon>>, CaseError>,
) -> Result<Answers, CaseError> {
    let limits = refine(levels, 2.0, |n| {
        let bodies = build(n)?.into_iter().map(Body::black).collect();
        let model = Model::new(bodies, Walls::Open, ROUND)?;
        let factors = model.form_factors();
        Ok((wanted.iter().map(|(_, from, to)| factors[*from][*to]).collect(), model.noise()))
    })?;
    let mut answers = Answers::new(Demand::Estimate);
    for ((name, ..), limit) in wanted.iter().zip(limits) {
        answers.number(*name, limit.value, limit.error);
    }
    Ok(answers)
}

/// A disk about the z axis at this height, facing up or down.
fn level_disk(radius: f64, height: f64, up: bool, n: usize) -> Result<Vec<Polygon>, CaseError> {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    // Both have their first corner on the x axis.
    let frame = if up { Frame { x, y, z } } else { Frame { x, y: -y, z: -z } };
    disk(&frame, height * Vec3::Z, radius, &sectors(n))
}

/// A closed sphere about the origin.
fn ball(radius: f64, n: usize, facing: Facing) -> Result<Vec<Polygon>, CaseError> {
    revolve(&arc(radius, [0.0, PI], n / 2), &sectors(n), facing)
}

/// A zone of it between two polar angles in degrees, seen from inside.
fn zone(radius: f64, degrees: [f64; 2], n: usize) -> Result<Vec<Polygon>, CaseError> {
    let angles = degrees.map(f64::to_radians);
    let pieces = (((angles[1] - angles[0]) / PI * n as f64 / 2.0).round() as usize).max(n / 8).max(1);
    revolve(&arc(radius, angles, pieces), &sectors(n), Facing::Right)
}

/// `coaxial_disks`.
pub fn coaxial_disks(case: &Case) -> Result<Answers, CaseError> {
    let [r1, r2, h] = lengths(&case.geometry, ["r1", "r2", "h"])?;
    factors(&FLAT, &[("F_12", 0, 1), ("F_21", 1, 0)], |n| {
        Ok(vec![level_disk(r1, 0.0, true, n)?, level_disk(r2, h, false, n)?])
    })
}

/// `coaxial_annuli`.
pub fn coaxial_annuli(case: &Case) -> Result<Answers, CaseError> {
    let [a1, b1, h] = lengths(&case.geometry, ["inner_1", "outer_1", "h"])?;
    let [a2, b2] = lengths(&case.geometry, ["inner_2", "outer_2"])?;
    factors(&FLAT, &[("F_12", 0, 1), ("F_21", 1, 0)], |n| {
        let azimuths = sectors(n);
        let up = revolve(&[[a1, 0.0], [b1, 0.0]], &azimuths, Facing::Left)?;
        Ok(vec![up, revolve(&[[a2, h], [b2, h]], &azimuths, Facing::Right)?])
    })
}

/// `coaxial_disks_blocked`: a disk or a sphere between them.
pub fn coaxial_disks_blocked(case: &Case) -> Result<Answers, CaseError> {
    let [r1, r2, h] = lengths(&case.geometry, ["r1", "r2", "h"])?;
    let [radius, height] = lengths(&case.geometry, ["blocker_radius", "blocker_z"])?;
    let disks = |n| Ok(vec![level_disk(r1, 0.0, true, n)?, level_disk(r2, h, false, n)?]);
    let is_sphere = match case.geometry.text("blocker")?.as_str() {
        "disk" => false,
        "sphere" => true,
        _ => return Err(CaseError::Needs("a blocker that is a disk or a sphere")),
    };
    let mut answers = factors(&BLOCKED, &[("F_12", 0, 1)], |n| {
        let mut surfaces = disks(n)?;
        if is_sphere {
            let profile = arc(radius, [0.0, PI], n / 2).into_iter().map(|[r, z]| [r, z + height]).collect::<Vec<_>>();
            surfaces.push(revolve(&profile, &sectors(n), Facing::Left)?);
        } else {
            surfaces.push(level_disk(radius, height, true, n)?);
        }
        Ok(surfaces)
    })?;
    answers.values.extend(factors(&FLAT, &[("F_12_unoccluded", 0, 1)], disks)?.values);
    Ok(answers)
}

/// `sphere_disk`: a sphere over the middle of a disk.
pub fn sphere_disk(case: &Case) -> Result<Answers, CaseError> {
    let [radius, disk_radius, h] = lengths(&case.geometry, ["sphere_radius", "disk_radius", "h_center_to_disk"])?;
    factors(&BALL, &[("F_sphere_disk", 0, 1), ("F_disk_sphere", 1, 0)], |n| {
        Ok(vec![ball(radius, n, Facing::Left)?, level_disk(disk_radius, -h, true, n)?])
    })
}

/// `sphere_rectangle`: a sphere over the middle of an a × b rectangle.
pub fn sphere_rectangle(case: &Case) -> Result<Answers, CaseError> {
    let [radius, a, b, h] = lengths(&case.geometry, ["sphere_radius", "a", "b", "h_center_to_plane"])?;
    let corner = |x: f64, y: f64| Vec3::new(0.5 * x * a, 0.5 * y * b, -h);
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let rectangle =
        Polygon::new(corners).map_err(|source| CaseError::Polygon { what: "rectangle".to_string(), source })?;
    factors(&BALL, &[("F", 0, 1)], |n| Ok(vec![ball(radius, n, Facing::Left)?, vec![rectangle.clone()]]))
}

/// `concentric_spheres`.
pub fn concentric_spheres(case: &Case) -> Result<Answers, CaseError> {
    let [inner, outer] = lengths(&case.geometry, ["r_inner", "r_outer"])?;
    factors(&NESTED, &[("F_12", 0, 1), ("F_21", 1, 0), ("F_22", 1, 1)], |n| {
        Ok(vec![ball(inner, n, Facing::Left)?, ball(outer, n, Facing::Right)?])
    })
}

/// `hemisphere_with_base`.
pub fn hemisphere(case: &Case) -> Result<Answers, CaseError> {
    let radius = case.geometry.length("radius")?;
    let wanted = [("F_base_hemi", 0, 1), ("F_hemi_base", 1, 0), ("F_hemi_hemi", 1, 1)];
    factors(&RINGED, &wanted, |n| {
        let dome = revolve(&arc(radius, [0.0, FRAC_PI_2], n / 4), &sectors(n), Facing::Right)?;
        Ok(vec![level_disk(radius, 0.0, true, n)?, dome])
    })
}

/// `sphere_zones`: from zone to zone of one sphere, seen from inside.
pub fn sphere_zones(case: &Case) -> Result<Answers, CaseError> {
    let radius = case.geometry.length("radius")?;
    let zones = [case.geometry.interval("zone_1_deg")?, case.geometry.interval("zone_2_deg")?];
    factors(&RINGED, &[("F_12", 0, 1)], |n| Ok(vec![zone(radius, zones[0], n)?, zone(radius, zones[1], n)?]))
}

/// `sphere_zones_blocked`: the same with a smaller sphere in the middle.
pub fn sphere_zones_blocked(case: &Case) -> Result<Answers, CaseError> {
    let [radius, inner] = lengths(&case.geometry, ["R", "r_inner"])?;
    let zones = [case.geometry.interval("zone_1_deg")?, case.geometry.interval("zone_2_deg")?];
    let open = |n| Ok(vec![zone(radius, zones[0], n)?, zone(radius, zones[1], n)?]);
    let mut answers = factors(&BLOCKED, &[("F_12", 0, 1)], |n| {
        let mut surfaces = open(n)?;
        surfaces.push(ball(inner, n, Facing::Left)?);
        Ok(surfaces)
    })?;
    answers.values.extend(factors(&RINGED, &[("F_12_unoccluded", 0, 1)], open)?.values);
    Ok(answers)
}

/// `cone_interior`: a cone on its base, seen from inside.
pub fn cone(case: &Case) -> Result<Answers, CaseError> {
    let [radius, height] = lengths(&case.geometry, ["base_radius", "height"])?;
    factors(&RINGED, &[("F_lateral_base", 1, 0), ("F_lateral_lateral", 1, 1)], |n| {
        let lateral = revolve(&[[radius, 0.0], [0.0, height]], &sectors(n), Facing::Left)?;
        Ok(vec![level_disk(radius, 0.0, true, n)?, lateral])
    })
}

/// `cylinder_interior`: bases b, lateral surface l.
pub fn cylinder(case: &Case) -> Result<Answers, CaseError> {
    let [radius, height] = lengths(&case.geometry, ["radius", "height"])?;
    let wanted = [("F_bb", 0, 1), ("F_bl", 0, 2), ("F_lb", 2, 0), ("F_ll", 2, 2)];
    factors(&FLAT[..5], &wanted, |n| {
        let lateral = revolve(&[[radius, 0.0], [radius, height]], &sectors(n), Facing::Left)?;
        Ok(vec![level_disk(radius, 0.0, true, n)?, level_disk(radius, height, false, n)?, lateral])
    })
}

/// `cylinder_rings`: from ring to ring of one cylinder, seen from inside.
pub fn cylinder_rings(case: &Case) -> Result<Answers, CaseError> {
    let radius = case.geometry.length("radius")?;
    let spans = [case.geometry.interval("ring_1_z")?, case.geometry.interval("ring_2_z")?];
    factors(&FLAT[..5], &[("F_12", 0, 1)], |n| {
        let ring = |[low, high]: [f64; 2]| revolve(&[[radius, low], [radius, high]], &sectors(n), Facing::Left);
        Ok(vec![ring(spans[0])?, ring(spans[1])?])
    })
}

pub(super) fn lengths<const N: usize>(geometry: &Geometry, fields: [&str; N]) -> Result<[f64; N], CaseError> {
    let mut values = [0.0; N];
    for (value, field) in values.iter_mut().zip(fields) {
        *value = geometry.length(field)?;
    }
    Ok(values)
}
