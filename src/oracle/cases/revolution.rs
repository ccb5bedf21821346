//! Surfaces of revolution as polygons: disks, cylinders, cones, spheres, cut by rings and by sectors.
//!
//! Corners lie on the surface. With n sectors and rings in proportion, areas and form factors run in even powers of 1/n, which is what
//! their extrapolation relies on.

use super::error::CaseError;
use crate::geometry::{Frame, Polygon, Vec3};
use std::f64::consts::{PI, TAU};

/// Which way the front looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// To the left of the profile's direction, seen with the axis up and the radius to the right.
    Left,
    Right,
}

fn polygon(corners: Vec<Vec3>) -> Result<Polygon, CaseError> {
    Polygon::new(corners).map_err(|source| CaseError::Polygon { what: "surface of revolution".to_string(), source })
}

/// Azimuths of the corners of n equal sectors, from 0 to just below 2π.
pub fn sectors(n: usize) -> Vec<f64> {
    (0..n).map(|k| TAU * k as f64 / n as f64).collect()
}

/// The same with corners at these azimuths, and n equal sectors between every two neighbours: where a plane cuts all polygons alike, what is
/// left of them still runs in even powers of 1/n.
pub fn sectors_between(mut breaks: Vec<f64>, n: usize) -> Vec<f64> {
    breaks.iter_mut().for_each(|azimuth| *azimuth = azimuth.rem_euclid(TAU));
    breaks.sort_by(f64::total_cmp);
    let ends = breaks.iter().copied().skip(1).chain(breaks.first().map(|first| first + TAU));
    let spans = breaks.iter().copied().zip(ends);
    spans.flat_map(|(from, to)| (0..n).map(move |k| from + (to - from) * k as f64 / n as f64)).collect()
}

/// Azimuths at which the circle of this radius at this height about the frame's z crosses a plane through `point`; none where it
/// does not.
pub fn crossings(frame: &Frame, centre: Vec3, radius: f64, point: Vec3, normal: Vec3) -> Vec<f64> {
    let (along_x, along_y) = (radius * normal.dot(frame.x), radius * normal.dot(frame.y));
    let (reach, needed) = (along_x.hypot(along_y), normal.dot(point - centre));
    if reach <= needed.abs() {
        return Vec::new();
    }
    let (middle, half) = (along_y.atan2(along_x), (needed / reach).acos());
    vec![middle - half, middle + half]
}

/// The convex polygon with corners at these azimuths that stands for a disk: its front looks along the frame's z.
///
/// # Errors
/// What cannot be a polygon.
pub fn disk(frame: &Frame, centre: Vec3, radius: f64, azimuths: &[f64]) -> Result<Polygon, CaseError> {
    let corner = |azimuth: &f64| {
        let (sine, cosine) = azimuth.sin_cos();
        centre + radius * (cosine * frame.x + sine * frame.y)
    };
    polygon(azimuths.iter().map(corner).collect())
}

/// Revolves a profile of (radius, height) points about the z axis: every piece of it becomes one quadrilateral a sector, a triangle
/// where it meets the axis.
///
/// # Errors
/// What cannot be a polygon.
pub fn revolve(profile: &[[f64; 2]], azimuths: &[f64], facing: Facing) -> Result<Vec<Polygon>, CaseError> {
    let n = azimuths.len();
    let mut polygons = Vec::with_capacity((profile.len().max(1) - 1) * n);
    let directions: Vec<(f64, f64)> = azimuths.iter().map(|azimuth| azimuth.sin_cos()).collect();
    for pair in profile.windows(2) {
        for k in 0..n {
            let point = |[r, z]: [f64; 2], k: usize| {
                let (sine, cosine) = directions[k % n];
                Vec3::new(r * cosine, r * sine, z)
            };
            let mut corners = vec![point(pair[0], k), point(pair[0], k + 1), point(pair[1], k + 1), point(pair[1], k)];
            if pair[0][0] == 0.0 {
                corners.remove(0);
            } else if pair[1][0] == 0.0 {
                corners.remove(3);
            }
            // Counter-clockwise as they stand, seen from the right of the profile.
            if facing == Facing::Left {
                corners.reverse();
            }
            polygons.push(polygon(corners)?);
        }
    }
    Ok(polygons)
}

/// A profile of several parts, each of which begins where the one before ended.
pub fn joined(parts: impl IntoIterator<Item = Vec<[f64; 2]>>) -> Vec<[f64; 2]> {
    let mut profile: Vec<[f64; 2]> = Vec::new();
    for part in parts {
        profile.extend(part.into_iter().skip(usize::from(!profile.is_empty())));
    }
    profile
}

/// A straight profile cut into equal pieces.
pub fn line(from: [f64; 2], to: [f64; 2], n_pieces: usize) -> Vec<[f64; 2]> {
    let at = |k: usize| {
        let s = k as f64 / n_pieces as f64;
        [from[0] * (1.0 - s) + to[0] * s, from[1] * (1.0 - s) + to[1] * s]
    };
    (0..=n_pieces).map(at).collect()
}

/// The profile of a sphere about the origin between two polar angles (radians, from +z), cut into equal angles.
pub fn arc(radius: f64, [from, to]: [f64; 2], n_pieces: usize) -> Vec<[f64; 2]> {
    let at = |k: usize| {
        let angle = from + (to - from) * k as f64 / n_pieces as f64;
        // Poles lie on the axis exactly.
        let sine = if angle <= 0.0 || angle >= PI { 0.0 } else { angle.sin() };
        [radius * sine, radius * angle.cos()]
    };
    (0..=n_pieces).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_approach_those_of_the_round_shapes_and_fronts_look_the_way_that_was_asked_for() {
        let area = |polygons: &[Polygon]| polygons.iter().map(Polygon::area).sum::<f64>();
        let n = 64;
        // Inscribed polygons fall short by (2π²/3)/n² relative for a disk, and no more than twice that for the others.
        let short = 4.0 * PI * PI / 3.0 / (n * n) as f64;
        let round = disk(&Frame::about(Vec3::Z), Vec3::ZERO, 1.0, &sectors(n)).expect("a polygon");
        assert!(round.area() < PI && round.area() > PI * (1.0 - short));
        assert!(round.normal().dot(Vec3::Z) > 0.999);
        let ball = revolve(&arc(1.0, [0.0, PI], n / 2), &sectors(n), Facing::Left).expect("polygons");
        assert!(area(&ball) < 4.0 * PI && area(&ball) > 4.0 * PI * (1.0 - short));
        let outward = |p: &Polygon| p.normal().dot(p.centroid()) > 0.0;
        assert!(ball.iter().all(outward) || !ball.iter().any(outward));
        let tube = revolve(&line([1.0, 0.0], [1.0, 2.0], 2), &sectors(n), Facing::Left).expect("polygons");
        assert!(tube.iter().all(|p| !outward(p)), "going up, left is towards the axis");
    }
}
