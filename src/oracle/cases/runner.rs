//! From a case to its outcome.

use super::answer::{Answers, Outcome, Verdict, judge};
use super::error::CaseError;
use super::reader::Case;
use super::{closed, enclosure, points, polygons, round};
use std::collections::BTreeMap;
use std::time::Instant;

/// Answers one case from its geometry and judges the answer.
pub fn run(case: &Case) -> Outcome {
    let start = Instant::now();
    let result = answers(case);
    let seconds = start.elapsed().as_secs_f64();
    match result {
        Ok(answers) => judge(case, answers, seconds),
        Err(error) => {
            let verdict = match error {
                CaseError::Needs(what) => Verdict::Skipped(what.to_string()),
                other => Verdict::Fail(Some(other.to_string())),
            };
            Outcome {
                id: case.id.clone(),
                group: case.group.clone(),
                family: case.family.clone(),
                verdict,
                computed: BTreeMap::new(),
                reference: case.values.clone(),
                error: None,
                allowed: None,
                estimate: None,
                worst: None,
                seconds,
            }
        }
    }
}

/// What a case needs that is not here yet.
fn missing(case: &Case) -> Option<&'static str> {
    match (case.group.as_str(), case.geometry.kind.as_str()) {
        ("D", _) => Some("directions"),
        ("E", _) => Some("media"),
        ("F", _) => Some("photometry"),
        (_, kind)
            if kind.ends_with("_2d")
                || ["strips_2d_adjoint", "two_patches", "concentric_cylinders"].contains(&kind) =>
        {
            Some("flatland")
        }
        _ => None,
    }
}

fn answers(case: &Case) -> Result<Answers, CaseError> {
    if let Some(what) = missing(case) {
        return Err(CaseError::Needs(what));
    }
    let geometry = &case.geometry;
    match geometry.kind.as_str() {
        "polygon_pair" if !geometry.has("rho") => polygons::pair(case),
        "rectangle_family" => polygons::rectangle_family(case),
        "polygon_family" => polygons::strip_family(case),
        "cube_grid" => polygons::cube_grid(case),
        "element_polygon" => points::to_polygon(case),
        "element_disk" => points::to_disk(case),
        "element_sphere" => points::to_sphere(case),
        "enclosure_polygons" => enclosure::answers(case),
        "any_closed_scene" => closed::uniform(case),
        "coaxial_disks" if !geometry.has("rho") => round::coaxial_disks(case),
        "coaxial_annuli" => round::coaxial_annuli(case),
        "coaxial_disks_blocked" => round::coaxial_disks_blocked(case),
        "sphere_disk" => round::sphere_disk(case),
        "sphere_rectangle" => round::sphere_rectangle(case),
        "concentric_spheres" if !geometry.has("rho") && !geometry.has("E_outer") => round::concentric_spheres(case),
        "hemisphere_with_base" => round::hemisphere(case),
        "sphere_zones" => round::sphere_zones(case),
        "sphere_zones_blocked" => round::sphere_zones_blocked(case),
        "cone_interior" => round::cone(case),
        "cylinder_interior" => round::cylinder(case),
        "cylinder_rings" => round::cylinder_rings(case),
        _ => Err(CaseError::Needs("a kind of geometry that is not known here")),
    }
}
