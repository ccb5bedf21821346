//! Form factors from a point to a polygon, a disk, a sphere.

use super::answer::{Answers, Demand};
use super::error::CaseError;
use super::limit::{EVEN, Refinement, refine};
use super::reader::Case;
use super::revolution::{Facing, arc, crossings, disk, revolve, sectors_between};
use crate::assembly::point_factor;
use crate::geometry::{Frame, Polygon, Vec3};
use std::f64::consts::PI;

/// Corners of the polygons that stand for a disk.
const CORNERS: [usize; 6] = [16, 32, 64, 128, 256, 512];

/// Sectors of the polyhedra that stand for a sphere.
const SECTORS: [usize; 6] = [16, 32, 48, 64, 96, 128];

/// Refinement ends at this error: three digits better than what is asked for, for it costs nothing here.
const ENOUGH: f64 = 1e-10;

/// Rounding of Lambert's sum relative to the largest term, 1: a few ulp an edge.
const ROUNDING: f64 = 4e-15;

/// `element_polygon`.
pub fn to_polygon(case: &Case) -> Result<Answers, CaseError> {
    let (point, normal) = (case.geometry.point("point")?, case.geometry.direction("normal_unnormalised")?);
    let polygon = case.geometry.polygon("polygon")?;
    let mut answers = Answers::new(Demand::Digits);
    answers.number("F", point_factor(point, normal, &polygon), ROUNDING);
    Ok(answers)
}

/// `element_disk`.
pub fn to_disk(case: &Case) -> Result<Answers, CaseError> {
    let geometry = &case.geometry;
    let (point, normal) = (geometry.point("point")?, geometry.direction("normal")?);
    let (centre, radius) = (geometry.point("disk_center")?, geometry.length("disk_radius")?);
    let facing = geometry.direction("disk_normal")?;
    // Put corners where the point's horizon cuts the rim.
    let frame = Frame::about(facing);
    let mut breaks = crossings(&frame, centre, radius, point, normal);
    if breaks.is_empty() {
        breaks = vec![0.0, PI];
    }
    limit(&CORNERS, |n| {
        Ok(point_factor(point, normal, &disk(&frame, centre, radius, &sectors_between(breaks.clone(), n / 2))?))
    })
}

/// `element_sphere`: the polar angle of the normal is from +z towards +x.
pub fn to_sphere(case: &Case) -> Result<Answers, CaseError> {
    let geometry = &case.geometry;
    let (point, centre) = (geometry.point("point")?, geometry.point("sphere_center")?);
    let radius = geometry.length("sphere_radius")?;
    let (sine, cosine) = geometry.number("normal_polar_deg")?.to_radians().sin_cos();
    let towards = point - centre;
    let distance = towards.length();
    if distance <= radius {
        return Err(CaseError::Geometry { field: "point".to_string(), problem: "must be outside of the sphere" });
    }

    // Turn the sphere's axis to the point: its outline is then a ring of corners, and more of them where the horizon cuts it.
    let frame = Frame::about(towards / distance);
    let normal = frame.to_local(Vec3::new(sine, 0.0, cosine));
    let point = distance * Vec3::Z;
    let outline = (radius / distance).acos();
    let world = Frame { x: Vec3::X, y: Vec3::Y, z: Vec3::Z };
    let rim = (radius * outline.cos() * Vec3::Z, radius * outline.sin());
    let mut breaks = crossings(&world, rim.0, rim.1, point, normal);
    if breaks.is_empty() {
        breaks = vec![0.0, PI];
    }
    limit(&SECTORS, |n| {
        let mut profile = arc(radius, [0.0, outline], n / 8);
        profile.extend(arc(radius, [outline, PI], n / 8).into_iter().skip(1));
        let ball = revolve(&profile, &sectors_between(breaks.clone(), n / 2), Facing::Left)?;
        Ok(sum(point, normal, &ball))
    })
}

fn sum(point: Vec3, normal: Vec3, polygons: &[Polygon]) -> f64 {
    polygons.iter().map(|polygon| point_factor(point, normal, polygon)).sum()
}

fn limit(levels: &[usize], mut compute: impl FnMut(usize) -> Result<f64, CaseError>) -> Result<Answers, CaseError> {
    let limits = refine(Refinement { levels, powers: EVEN, enough: ENOUGH }, |n| {
        compute(n).map(|factor| (vec![factor], ROUNDING))
    })?;
    let mut answers = Answers::new(Demand::Estimate);
    answers.number("F", limits[0].value, limits[0].error);
    Ok(answers)
}
