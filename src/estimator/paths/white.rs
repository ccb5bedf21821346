//! Closed parts of a scene that absorb nothing: there is no steady state in them, and a path never ends.
//!
//! Whether light can leave a part is asked with rays: some in all directions, which find what is large, and some to points of every
//! surface that absorbs, which find what is small. A hole to the outside through which fewer than one in some thousand rays go may be
//! overlooked; the scene is then refused, though its paths would end in the long run.
//!
//! Cost: nothing where every surface absorbs in every band; else O(white sides × absorbing sides) rays.

use super::stage::Stage;
use crate::geometry::Vec3;
use crate::sampling::{Stream, Streams, warp};
use crate::scene::Side;

/// Rays in all directions from every white side.
const N_RAYS: u64 = 256;

/// Segments from every white side to every side that absorbs.
const N_SEGMENTS: u64 = 16;

/// Directions in which a side that reflects everything does so, by the cosine to the normal.
const COSINES: [f64; 4] = [1.0, 0.7, 0.3, 0.05];

/// A bundle from which a path would never end, if there is one.
pub(super) fn closed_part(stage: &Stage<'_>) -> Option<usize> {
    (0..stage.scene.n_bands()).find_map(|band| closed_part_in(stage, band))
}

fn closed_part_in(stage: &Stage<'_>, band: usize) -> Option<usize> {
    // Number a facet's two sides, and find the white ones.
    let n_sides = 2 * stage.scene.facets().len();
    let side_of = |k: usize| if k.is_multiple_of(2) { Side::Front } else { Side::Back };
    let is_white: Vec<bool> = (0..n_sides).map(|k| is_white(stage, band, k / 2, side_of(k))).collect();
    let white: Vec<usize> = (0..n_sides).filter(|k| is_white[*k]).collect();
    let dark: Vec<usize> = (0..n_sides).filter(|k| !is_white[*k]).collect();

    // Ask of each where its light goes: out of the white, or to which of the others.
    let streams = Streams::new(0, "closed white parts");
    let mut ends = vec![false; n_sides];
    let mut seen: Vec<Vec<usize>> = vec![Vec::new(); n_sides];
    for &k in &white {
        let mut stream = streams.stream(k as u32, 0);
        for _ in 0..N_RAYS {
            match shoot(stage, k / 2, side_of(k), &mut stream) {
                Some(next) if is_white[next] => seen[next].push(k),
                _ => ends[k] = true,
            }
        }
        seen[k].dedup();
        ends[k] =
            ends[k] || dark.iter().any(|other| sees(stage, [k, *other].map(|k| (k / 2, side_of(k))), &mut stream));
    }

    // Let what sees a side that ends, end too.
    let mut found: Vec<usize> = white.iter().copied().filter(|k| ends[*k]).collect();
    while let Some(k) = found.pop() {
        for &from in &seen[k] {
            if !ends[from] {
                ends[from] = true;
                found.push(from);
            }
        }
    }
    let never = |k: &usize| !ends[*k];
    let bundle_on = |k: usize| stage.patches.iter().position(|p| p.facet == k / 2 && p.side == side_of(k));
    white.into_iter().filter(never).find_map(bundle_on)
}

/// True if the side absorbs nothing, whatever the direction.
fn is_white(stage: &Stage<'_>, band: usize, facet: usize, side: Side) -> bool {
    let Some(brdf) = stage.scene.surface_of(facet).brdf(side) else { return false };
    match brdf.lambertian() {
        Some(albedo) => albedo[band] >= 1.0,
        None => COSINES.iter().all(|cosine| brdf.albedo(band, warp::around_z(*cosine, 0.0).into()) >= 1.0),
    }
}

/// The number of the side that one ray from this one meets; `None` where it leaves the scene.
fn shoot(stage: &Stage<'_>, facet: usize, side: Side, stream: &mut Stream) -> Option<usize> {
    let position = stage.scene.polygon(facet).sample(stream.uniform2());
    let direction = stage.face(facet, side).frame.to_world(Vec3::from(warp::cosine_hemisphere(stream.uniform2())));
    let arrival = stage.follow(facet, position, direction)?;
    Some(2 * arrival.facet + usize::from(arrival.side == Side::Back))
}

/// True if one of some segments between the two sides is free.
fn sees(stage: &Stage<'_>, sides: [(usize, Side); 2], stream: &mut Stream) -> bool {
    let [(a, _), (b, _)] = sides;
    if stage.tracer.coplanar(a, b) {
        return false;
    }
    (0..N_SEGMENTS).any(|_| {
        let [from, to] = [a, b].map(|facet| stage.scene.polygon(facet).sample(stream.uniform2()));
        let faces = |(facet, side), offset: Vec3| stage.face(facet, side).frame.z.dot(offset) > 0.0;
        faces(sides[0], to - from) && faces(sides[1], from - to) && !stage.tracer.occluded(from, to, [a, b])
    })
}
