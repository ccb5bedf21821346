//! `integrator` and `sampler`: checked by name, then left aside, for they steer a renderer and are no part of the
//! scene.

use super::document::{Document, Element};
use super::object::{Kind, Object, Plugin};
use crate::scene::format::FormatError;

static INTEGRATORS: [Plugin; 2] = [
    Plugin {
        name: "path",
        parameters: &[
            ("max_depth", Kind::Integer),
            ("rr_depth", Kind::Integer),
            ("hide_emitters", Kind::Boolean),
            ("samples_per_pass", Kind::Integer),
            ("block_size", Kind::Integer),
            ("timeout", Kind::Float),
        ],
        parts: &[],
    },
    Plugin {
        name: "direct",
        parameters: &[
            ("shading_samples", Kind::Integer),
            ("emitter_samples", Kind::Integer),
            ("bsdf_samples", Kind::Integer),
            ("hide_emitters", Kind::Boolean),
            ("samples_per_pass", Kind::Integer),
            ("block_size", Kind::Integer),
            ("timeout", Kind::Float),
        ],
        parts: &[],
    },
];

const COUNT: (&str, Kind) = ("sample_count", Kind::Integer);
const SEED: (&str, Kind) = ("seed", Kind::Integer);
const JITTER: (&str, Kind) = ("jitter", Kind::Boolean);

static SAMPLERS: [Plugin; 5] = [
    Plugin { name: "independent", parameters: &[COUNT, SEED], parts: &[] },
    Plugin { name: "stratified", parameters: &[COUNT, SEED, JITTER], parts: &[] },
    Plugin { name: "multijitter", parameters: &[COUNT, SEED, JITTER], parts: &[] },
    Plugin { name: "orthogonal", parameters: &[COUNT, SEED, JITTER, ("strength", Kind::Integer)], parts: &[] },
    Plugin { name: "ldsampler", parameters: &[COUNT, SEED], parts: &[] },
];

pub(super) fn check_integrator(document: &Document, element: &Element) -> Result<(), FormatError> {
    Object::open(document, element, &INTEGRATORS).map(drop)
}

pub(super) fn check_sampler(document: &Document, element: &Element) -> Result<(), FormatError> {
    Object::open(document, element, &SAMPLERS).map(drop)
}
