//! Light on its way from an emitter.

use super::super::bands::Bands;
use super::super::bounces::Columns;
use super::Roulette;
use super::stage::{Stage, Vertex};
use crate::geometry::Vec3;
use crate::sampling::{Stream, warp};
use crate::scene::Side;
use std::f64::consts::PI;

/// Sends a photon out and calls `hit(vertex, bounce, power)` wherever it arrives on what is not black, with the power that arrives in
/// every band, W. Returns how many rays it took.
#[inline]
pub(super) fn fly(
    stage: &Stage<'_>,
    roulette: Roulette,
    columns: Columns,
    stream: &mut Stream,
    mut hit: impl FnMut(&Vertex<'_>, usize, &Bands),
) -> u64 {
    // Leave any point of the emitters in any direction.
    let (emitter, mut position) = stage.emitters.point(stream);
    let mut facet = emitter.facet;
    let local = Vec3::from(warp::cosine_hemisphere(stream.uniform2()));
    let mut direction = stage.face(facet, Side::Front).frame.to_world(local);
    let mut power = Bands::all(PI / emitter.density, columns.n_bands);
    power.iter_mut().zip(emitter.emission).for_each(|(power, emission)| *power *= emission);
    let sent = power.max();

    let mut n_rays = 0;
    for bounce in 1.. {
        if columns.ends_before(bounce) {
            break;
        }
        n_rays += 1;
        let Some(arrival) = stage.follow(facet, position, direction) else { break };
        let Some(vertex) = stage.vertex(&arrival) else { break };
        hit(&vertex, bounce, &power);

        // Turn it, and let it survive or not.
        let [u, v, fate] = stream.uniform3();
        let Some(turn) = vertex.reflection.turn(vertex.given, [u, v], &mut power) else { break };
        let survival = roulette.survival(bounce, power.max() / sent);
        if fate >= survival {
            break;
        }
        power.iter_mut().for_each(|power| *power /= survival);
        (facet, position, direction) = (vertex.facet, vertex.position, vertex.frame.to_world(turn.direction));
    }
    n_rays
}
