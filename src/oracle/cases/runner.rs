//! From a case to its outcome.

use super::answer::{Answers, Outcome, Verdict, judge, judge_identity};
use super::error::CaseError;
use super::reader::Case;
use super::{closed, continuous, enclosure, identities, points, polygons, round, shells};
use std::time::Instant;

/// Answers one case from its geometry and judges the answer.
pub fn run(case: &Case) -> Outcome {
    let start = Instant::now();
    let seconds = || start.elapsed().as_secs_f64();
    let outcome = match case.geometry.kind.as_str() {
        "any_scene" => identities::check(case).map(|identity| judge_identity(case, identity, seconds())),
        _ => answers(case).map(|answers| judge(case, answers, seconds())),
    };
    outcome.unwrap_or_else(|error| {
        let verdict = match error {
            CaseError::Needs(what) => Verdict::Skipped(what.to_string()),
            other => Verdict::Fail(Some(other.to_string())),
        };
        Outcome::blank(case, verdict, seconds())
    })
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
        "concentric_spheres" if geometry.has("E_outer") => shells::zonal(case),
        "concentric_spheres" if geometry.has("rho") => shells::grey(case),
        "concentric_spheres" => round::concentric_spheres(case),
        "hemisphere_with_base" => round::hemisphere(case),
        "sphere_zones" => round::sphere_zones(case),
        "sphere_zones_blocked" => round::sphere_zones_blocked(case),
        "cone_interior" => round::cone(case),
        "cylinder_interior" => round::cylinder(case),
        "cylinder_rings" => round::cylinder_rings(case),
        "polygon_pair" => continuous::facing_squares(case),
        "coaxial_disks" => continuous::facing_disks(case),
        "tube_open_ends" => continuous::tube(case),
        "cylindrical_cavity" => continuous::cylindrical_cavity(case),
        "spherical_cavity" => shells::spherical_cavity(case),
        "sphere_patches" => shells::sphere_patches(case),
        "cube" => continuous::cube_means(case),
        _ => Err(CaseError::Needs("a kind of geometry that is not known here")),
    }
}
