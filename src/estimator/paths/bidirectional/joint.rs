//! Where a path from the light and one from the bundle are joined.

use super::super::super::bands::Bands;
use super::super::stage::Stage;
use super::subpath::{Node, Turning};
use crate::scene::Side;

/// A joined path: what it is worth without a weight, and the densities by area that only the joint knows.
pub(super) struct Joint {
    pub light: Bands,
    /// Of the eye's last vertex and the one before it, coming from the light.
    pub eye_reverse: [f64; 2],
    /// Of the light's last vertex and the one before it, coming from the bundle.
    pub light_reverse: [f64; 2],
}

/// Joins the last vertices of the two paths, taken to see each other; `None` where no light goes that way. Without a path from the light,
/// the path from the bundle is taken to have met an emitter.
pub(super) fn join(stage: &Stage<'_>, light: &[Node<'_>], eye: &[Node<'_>]) -> Option<Joint> {
    let end = eye.last()?;
    match light.last() {
        None => meet(stage, end),
        Some(start) => connect(stage, start, end),
    }
}

/// The last vertex of the path from the bundle lies on an emitter.
fn meet(stage: &Stage<'_>, end: &Node<'_>) -> Option<Joint> {
    let density = stage.emitters.density(end.facet);
    let Turning::Reflection { given, .. } = end.turning else { return None };
    if density == 0.0 || end.side == Side::Back || given.z <= 0.0 {
        return None;
    }
    let mut light = end.throughput.clone();
    light.iter_mut().zip(stage.emission(end.facet, end.side)).for_each(|(light, emission)| *light *= emission);
    let before = given.z * std::f64::consts::FRAC_1_PI * end.back;
    Some(Joint { light, eye_reverse: [density, before], light_reverse: [0.0; 2] })
}

/// The two last vertices are joined: f cosθ cosθ′/r² f′ times what both paths carry.
fn connect(stage: &Stage<'_>, start: &Node<'_>, end: &Node<'_>) -> Option<Joint> {
    if start.is_delta() || end.is_delta() || stage.tracer.coplanar(start.facet, end.facet) {
        return None;
    }
    let offset = start.position - end.position;
    let distance_squared = offset.length_squared();
    let direction = offset / distance_squared.sqrt();
    let (to_light, to_eye) = (end.frame.to_local(direction), start.frame.to_local(-direction));
    if !(to_light.z > 0.0 && to_eye.z > 0.0) {
        return None;
    }

    let mut light = end.throughput.clone();
    light.iter_mut().zip(start.throughput.iter()).for_each(|(light, carried)| *light *= carried);
    end.scale(to_light, to_light.z / distance_squared, &mut light);
    start.scale(to_eye, to_eye.z, &mut light);
    if light.max() <= 0.0 {
        return None;
    }
    let eye_reverse = [start.density(to_eye) * to_light.z / distance_squared, end.density_back(to_light)];
    let light_reverse = [end.density(to_light) * to_eye.z / distance_squared, start.density_back(to_eye)];
    Some(Joint { light, eye_reverse, light_reverse })
}
