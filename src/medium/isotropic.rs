//! Particles that forget where light came from.

use super::Phase;
use crate::geometry::Vec3;
use crate::sampling::warp;

/// p = 1/4π.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Isotropic;

impl Phase for Isotropic {
    fn eval(&self, _incident: Vec3, _outgoing: Vec3) -> f64 {
        warp::uniform_sphere_pdf()
    }

    fn sample(&self, _outgoing: Vec3, uniform: [f64; 2]) -> Vec3 {
        warp::uniform_sphere(uniform).into()
    }

    fn pdf(&self, _outgoing: Vec3, _incident: Vec3) -> f64 {
        warp::uniform_sphere_pdf()
    }

    fn mean_cosine(&self) -> f64 {
        0.0
    }

    fn description(&self) -> String {
        "isotropic".to_owned()
    }
}
