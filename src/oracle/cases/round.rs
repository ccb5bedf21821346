//! Form factors of round shapes: disks, annuli, spheres, cylinders, cones; surface by surface, extrapolated over finer and finer
//! polygons.

use super::answer::{Answers, Demand};
use super::blocker::Blocker;
use super::error::CaseError;
use super::limit::{CONSTANT, EVEN, HORIZON, Refinement, refine};
use super::model::{Body, Model, Shape, WHOLE};
use super::reader::{Case, Geometry};
use super::revolution::{Facing, arc, disk, joined, revolve, sectors};
use super::symmetry::{of_a_box, of_sectors};
use crate::geometry::{Frame, Polygon, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Levels: shapes have eight sectors, and rings as wide as these, for each.
pub const LEVELS: [usize; 18] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512];

/// Sectors a level.
pub const SECTORS: usize = 8;

/// Error at which refinement ends: well below what passes.
pub const ENOUGH: f64 = 3e-7;

/// The same past something round, where every level is dear.
const DEAR: f64 = 9e-7;

/// Absolute error of a row of form factors.
pub const ACCURACY: f64 = 1e-9;

/// What a case asks for: its name, and the surfaces from and to which the form factor is.
type Wanted = [(&'static str, usize, usize)];

/// The answers for named form factors of surfaces that are built for every level.
fn factors(
    refinement: Refinement,
    wanted: &Wanted,
    build: impl Fn(usize) -> Result<Shape, CaseError>,
) -> Result<Answers, CaseError> {
    let limits = refine(refinement, |level| {
        let is_wanted = |from, to| wanted.iter().any(|(_, i, j)| (*i, *j) == (from, to));
        let model = Model::folded(build(level)?, WHOLE, is_wanted, ACCURACY)?;
        let factors = model.form_factors();
        Ok((wanted.iter().map(|(_, from, to)| factors[*from][*to]).collect(), model.noise()))
    })?;
    let mut answers = Answers::new(Demand::Estimate);
    for ((name, ..), limit) in wanted.iter().zip(limits) {
        answers.number(*name, limit.value, limit.error);
    }
    Ok(answers)
}

/// Refinement up to so many levels, with errors in even powers.
fn even(n_levels: usize) -> Refinement<'static> {
    Refinement { levels: &LEVELS[..n_levels], powers: EVEN, enough: ENOUGH }
}

/// The same without levels at which sectors of this radius are wider than sixteen times what is between two surfaces: on them errors do not
/// run in powers yet.
fn resolving(radius: f64, gap: f64) -> Refinement<'static> {
    let coarse = |level: &usize| TAU * radius > 16.0 * gap * (SECTORS * level) as f64;
    let first = LEVELS.iter().take_while(|level| coarse(level)).count().min(LEVELS.len() - 8);
    Refinement { levels: &LEVELS[first..(first + 8).max(14)], ..even(0) }
}

/// Past something round: tangent planes of a sphere begin to cut what they see, edges of a disk do not. The coarsest level shows its
/// corners more than its roundness.
fn blocked(by_sphere: bool) -> Refinement<'static> {
    Refinement { levels: &LEVELS[1..8], powers: if by_sphere { HORIZON } else { EVEN }, enough: DEAR }
}

/// Surfaces with the symmetry of the level's sectors.
fn turned(level: usize, surfaces: Vec<Vec<Polygon>>) -> Shape {
    Shape {
        bodies: surfaces.into_iter().map(Body::black).collect(),
        symmetries: of_sectors(SECTORS * level),
        ..Shape::default()
    }
}

/// A disk about the z axis at this height, facing up or down, in a triangle a sector.
fn level_disk(radius: f64, height: f64, up: bool, level: usize) -> Result<Vec<Polygon>, CaseError> {
    let facing = if up { Facing::Left } else { Facing::Right };
    revolve(&[[0.0, height], [radius, height]], &sectors(SECTORS * level), facing)
}

/// Rings for an arc of a sphere or a circle: as wide as sectors at its equator, or narrower.
pub fn n_rings(angle: f64, level: usize) -> usize {
    let coarsest = (angle / (TAU / SECTORS as f64) - 1e-9).ceil().max(1.0) as usize;
    coarsest * level
}

/// The profile of a sphere about the origin between two polar angles, with rings that end at those breaks which lie between.
fn broken_arc(radius: f64, [from, to]: [f64; 2], breaks: &[f64], level: usize) -> Vec<[f64; 2]> {
    let mut ends: Vec<f64> = breaks.iter().copied().filter(|angle| *angle > from && *angle < to).collect();
    ends.extend([from, to]);
    ends.sort_by(f64::total_cmp);
    joined(ends.windows(2).map(|pair| arc(radius, [pair[0], pair[1]], n_rings(pair[1] - pair[0], level))))
}

/// A sphere about a point of the z axis that stands in the way.
fn blocking_ball(blocker: &Blocker, height: f64, level: usize) -> Result<Body, CaseError> {
    let profile = blocker.profile(|angle| n_rings(angle, level));
    let lifted: Vec<[f64; 2]> = profile.into_iter().map(|[r, z]| [r, z + height]).collect();
    Ok(Body::occluder(revolve(&lifted, &sectors(SECTORS * level), Facing::Left)?))
}

/// A closed sphere about the origin.
pub fn ball(radius: f64, level: usize, facing: Facing) -> Result<Vec<Polygon>, CaseError> {
    revolve(&broken_arc(radius, [0.0, PI], &[], level), &sectors(SECTORS * level), facing)
}

/// A zone of it between two polar angles in degrees, seen from inside.
fn zone(radius: f64, degrees: [f64; 2], level: usize) -> Result<Vec<Polygon>, CaseError> {
    let profile = broken_arc(radius, degrees.map(f64::to_radians), &[], level);
    revolve(&profile, &sectors(SECTORS * level), Facing::Right)
}

/// Polar angles, from the +z axis, at which tangent planes of a sphere about the origin touch the rim of a disk about the axis: between
/// them a plane cuts the disk.
fn horizons(radius: f64, disk_radius: f64, height: f64) -> Vec<f64> {
    let (distance, bearing) = (disk_radius.hypot(height), disk_radius.atan2(height));
    if distance <= radius {
        return Vec::new();
    }
    // The point sees the sphere's cap about its own bearing; the rim's other end has the bearing mirrored.
    let reach = (radius / distance).acos();
    vec![reach - bearing, reach + bearing, bearing - reach]
}

/// `coaxial_disks`.
pub fn coaxial_disks(case: &Case) -> Result<Answers, CaseError> {
    let [r1, r2, h] = lengths(&case.geometry, ["r1", "r2", "h"])?;
    factors(resolving(r1.max(r2), h), &[("F_12", 0, 1), ("F_21", 1, 0)], |level| {
        Ok(turned(level, vec![level_disk(r1, 0.0, true, level)?, level_disk(r2, h, false, level)?]))
    })
}

/// `coaxial_annuli`.
pub fn coaxial_annuli(case: &Case) -> Result<Answers, CaseError> {
    let [a1, b1, h] = lengths(&case.geometry, ["inner_1", "outer_1", "h"])?;
    let [a2, b2] = lengths(&case.geometry, ["inner_2", "outer_2"])?;
    factors(resolving(b1.max(b2), h), &[("F_12", 0, 1), ("F_21", 1, 0)], |level| {
        let azimuths = sectors(SECTORS * level);
        let up = revolve(&[[a1, 0.0], [b1, 0.0]], &azimuths, Facing::Left)?;
        Ok(turned(level, vec![up, revolve(&[[a2, h], [b2, h]], &azimuths, Facing::Right)?]))
    })
}

/// `coaxial_disks_blocked`: a disk or a sphere between them.
pub fn coaxial_disks_blocked(case: &Case) -> Result<Answers, CaseError> {
    let [r1, r2, h] = lengths(&case.geometry, ["r1", "r2", "h"])?;
    let [radius, height] = lengths(&case.geometry, ["blocker_radius", "blocker_z"])?;
    let is_sphere = match case.geometry.text("blocker")?.as_str() {
        "disk" => false,
        "sphere" => true,
        _ => return Err(CaseError::Needs("a blocker that is a disk or a sphere")),
    };
    let ball = Blocker::new(radius, [[[0.0, -height], [r1, -height]], [[0.0, h - height], [r2, h - height]]]);
    let blocker = |level: usize| {
        if is_sphere {
            return blocking_ball(&ball, height, level);
        }
        let frame = Frame { x: Vec3::X, y: Vec3::Y, z: Vec3::Z };
        Ok(Body::occluder(vec![disk(&frame, height * Vec3::Z, radius, &sectors(SECTORS * level))?]))
    };
    let open = |level| Ok(turned(level, vec![level_disk(r1, 0.0, true, level)?, level_disk(r2, h, false, level)?]));
    let mut answers = factors(blocked(is_sphere), &[("F_12", 0, 1)], |level| {
        let mut shape = open(level)?;
        shape.bodies.push(blocker(level)?);
        Ok(shape)
    })?;
    answers.values.extend(factors(resolving(r1.max(r2), h), &[("F_12_unoccluded", 0, 1)], open)?.values);
    Ok(answers)
}

/// `sphere_disk`: a sphere over the middle of a disk.
pub fn sphere_disk(case: &Case) -> Result<Answers, CaseError> {
    let [radius, disk_radius, h] = lengths(&case.geometry, ["sphere_radius", "disk_radius", "h_center_to_disk"])?;
    // Stand the disk on top, so that polar angles count from its middle.
    let breaks = horizons(radius, disk_radius, h);
    let refinement = Refinement { levels: &LEVELS[..12], powers: HORIZON, enough: ENOUGH };
    factors(refinement, &[("F_sphere_disk", 0, 1), ("F_disk_sphere", 1, 0)], |level| {
        let profile = broken_arc(radius, [0.0, PI], &breaks, level);
        let ball = revolve(&profile, &sectors(SECTORS * level), Facing::Left)?;
        Ok(turned(level, vec![ball, level_disk(disk_radius, h, false, level)?]))
    })
}

/// `sphere_rectangle`: a sphere over the middle of an a × b rectangle.
pub fn sphere_rectangle(case: &Case) -> Result<Answers, CaseError> {
    let [radius, a, b, h] = lengths(&case.geometry, ["sphere_radius", "a", "b", "h_center_to_plane"])?;
    let corner = |x: f64, y: f64| Vec3::new(0.5 * x * a, 0.5 * y * b, h);
    let corners = vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
    let rectangle =
        Polygon::new(corners).map_err(|source| CaseError::Polygon { what: "rectangle".to_string(), source })?;
    let refinement = Refinement { levels: &LEVELS[2..12], powers: HORIZON, enough: ENOUGH };
    factors(refinement, &[("F", 0, 1)], |level| {
        let bodies = vec![Body::black(ball(radius, level, Facing::Left)?), Body::black(vec![rectangle.clone()])];
        Ok(Shape { bodies, symmetries: of_a_box(Vec3::ZERO, Vec3::X, Vec3::Y), ..Shape::default() })
    })
}

/// Two concentric spheres in the same sectors and rings.
pub fn nested_balls(inner: f64, outer: f64, n_sectors: usize, n_rings: usize) -> Result<[Vec<Polygon>; 2], CaseError> {
    let ball = |radius, facing| revolve(&arc(radius, [0.0, PI], n_rings), &sectors(n_sectors), facing);
    Ok([ball(inner, Facing::Left)?, ball(outer, Facing::Right)?])
}

/// Where all levels agree: two would be enough, and more are there for what is badly known on one of them.
pub fn agreeing() -> Refinement<'static> {
    Refinement { levels: &LEVELS[..4], powers: CONSTANT, enough: ENOUGH }
}

/// `concentric_spheres`. With the same facets, what spheres exchange has the ratio of their areas at any level.
pub fn concentric_spheres(case: &Case) -> Result<Answers, CaseError> {
    let [inner, outer] = lengths(&case.geometry, ["r_inner", "r_outer"])?;
    factors(agreeing(), &[("F_12", 0, 1), ("F_21", 1, 0), ("F_22", 1, 1)], |level| {
        let bodies = nested_balls(inner, outer, SECTORS * level, 4 * level)?.map(Body::black).into();
        Ok(Shape { bodies, symmetries: of_sectors(SECTORS * level), ..Shape::default() })
    })
}

/// `hemisphere_with_base`.
pub fn hemisphere(case: &Case) -> Result<Answers, CaseError> {
    let radius = case.geometry.length("radius")?;
    let wanted = [("F_base_hemi", 0, 1), ("F_hemi_base", 1, 0), ("F_hemi_hemi", 1, 1)];
    factors(even(9), &wanted, |level| {
        let profile = broken_arc(radius, [0.0, FRAC_PI_2], &[], level);
        let dome = revolve(&profile, &sectors(SECTORS * level), Facing::Right)?;
        Ok(turned(level, vec![level_disk(radius, 0.0, true, level)?, dome]))
    })
}

/// `sphere_zones`: from zone to zone of one sphere, seen from inside.
pub fn sphere_zones(case: &Case) -> Result<Answers, CaseError> {
    let radius = case.geometry.length("radius")?;
    let zones = [case.geometry.interval("zone_1_deg")?, case.geometry.interval("zone_2_deg")?];
    factors(even(9), &[("F_12", 0, 1)], |level| {
        Ok(turned(level, vec![zone(radius, zones[0], level)?, zone(radius, zones[1], level)?]))
    })
}

/// `sphere_zones_blocked`: the same with a smaller sphere in the middle.
pub fn sphere_zones_blocked(case: &Case) -> Result<Answers, CaseError> {
    let [radius, inner] = lengths(&case.geometry, ["R", "r_inner"])?;
    let zones = [case.geometry.interval("zone_1_deg")?, case.geometry.interval("zone_2_deg")?];
    let open = |level| Ok(turned(level, vec![zone(radius, zones[0], level)?, zone(radius, zones[1], level)?]));
    let ball = Blocker::new(
        inner,
        zones.map(|ends| {
            ends.map(|degrees| {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                // Poles lie on the axis exactly.
                [if degrees % 180.0 == 0.0 { 0.0 } else { radius * sine }, radius * cosine]
            })
        }),
    );
    let mut answers = factors(blocked(true), &[("F_12", 0, 1)], |level| {
        let mut shape = open(level)?;
        shape.bodies.push(blocking_ball(&ball, 0.0, level)?);
        Ok(shape)
    })?;
    answers.values.extend(factors(even(9), &[("F_12_unoccluded", 0, 1)], open)?.values);
    Ok(answers)
}

/// `cone_interior`: a cone on its base, seen from inside.
pub fn cone(case: &Case) -> Result<Answers, CaseError> {
    let [radius, height] = lengths(&case.geometry, ["base_radius", "height"])?;
    factors(resolving(radius, height), &[("F_lateral_base", 1, 0), ("F_lateral_lateral", 1, 1)], |level| {
        let lateral = revolve(&[[radius, 0.0], [0.0, height]], &sectors(SECTORS * level), Facing::Left)?;
        Ok(turned(level, vec![level_disk(radius, 0.0, true, level)?, lateral]))
    })
}

/// `cylinder_interior`: bases b, lateral surface l.
pub fn cylinder(case: &Case) -> Result<Answers, CaseError> {
    let [radius, height] = lengths(&case.geometry, ["radius", "height"])?;
    let wanted = [("F_bb", 0, 1), ("F_bl", 0, 2), ("F_lb", 2, 0), ("F_ll", 2, 2)];
    factors(resolving(radius, height), &wanted, |level| {
        let lateral = revolve(&[[radius, 0.0], [radius, height]], &sectors(SECTORS * level), Facing::Left)?;
        let bases = [level_disk(radius, 0.0, true, level)?, level_disk(radius, height, false, level)?];
        Ok(turned(level, bases.into_iter().chain([lateral]).collect()))
    })
}

/// `cylinder_rings`: from ring to ring of one cylinder, seen from inside.
pub fn cylinder_rings(case: &Case) -> Result<Answers, CaseError> {
    let radius = case.geometry.length("radius")?;
    let spans = [case.geometry.interval("ring_1_z")?, case.geometry.interval("ring_2_z")?];
    let narrowest = spans.iter().map(|[low, high]| high - low).fold(radius, f64::min);
    factors(resolving(radius, narrowest), &[("F_12", 0, 1)], |level| {
        let azimuths = sectors(SECTORS * level);
        let ring = |[low, high]: [f64; 2]| revolve(&[[radius, low], [radius, high]], &azimuths, Facing::Left);
        Ok(turned(level, vec![ring(spans[0])?, ring(spans[1])?]))
    })
}

pub(super) fn lengths<const N: usize>(geometry: &Geometry, fields: [&str; N]) -> Result<[f64; N], CaseError> {
    let mut values = [0.0; N];
    for (value, field) in values.iter_mut().zip(fields) {
        *value = geometry.length(field)?;
    }
    Ok(values)
}
