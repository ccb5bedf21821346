//! A perspective camera and its film.

use super::SceneError;
use crate::geometry::{Ray, Vec3};

/// A pinhole camera: a point, an orthonormal frame and the half-size of its film at distance one.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pub origin: Vec3,
    /// Unit vector along which the camera looks.
    pub forward: Vec3,
    /// Unit vector that appears pointing right in the picture.
    pub right: Vec3,
    /// Unit vector that appears pointing up in the picture.
    pub up: Vec3,
    /// Tangent of half the horizontal field of view.
    pub tangent_half_width: f64,
    /// Tangent of half the vertical field of view.
    pub tangent_half_height: f64,
    pub film: Film,
}

/// The pixel grid; pixel (0, 0) is at the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    pub width: usize,
    pub height: usize,
    pub filter: PixelFilter,
}

/// How a pixel weighs the light that arrives around its centre; lengths in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PixelFilter {
    Box {
        radius: f64,
    },
    Tent {
        radius: f64,
    },
    /// Truncated at 4 standard deviations and shifted to vanish there.
    Gaussian {
        standard_deviation: f64,
    },
    Mitchell {
        b: f64,
        c: f64,
    },
    CatmullRom,
    Lanczos {
        lobes: f64,
    },
}

impl Camera {
    /// A camera at `origin` looking at `target`, with the full field of view (radians) measured across the film's shorter side.
    pub fn look_at(origin: Vec3, target: Vec3, up: Vec3, field_of_view: f64, film: Film) -> Self {
        let forward = (target - origin).normalize();
        let right = forward.cross(up).normalize();
        let tangent = (0.5 * field_of_view).tan();
        let shorter = film.width.min(film.height) as f64;
        Self {
            origin,
            forward,
            right,
            up: right.cross(forward),
            tangent_half_width: tangent * film.width as f64 / shorter,
            tangent_half_height: tangent * film.height as f64 / shorter,
            film,
        }
    }

    /// The ray through film position (x, y) in pixels: (0, 0) is the top left corner, pixel centres lie at halves. The direction
    /// has unit length along `forward`.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let across = (2.0 * x / self.film.width as f64 - 1.0) * self.tangent_half_width;
        let along = (1.0 - 2.0 * y / self.film.height as f64) * self.tangent_half_height;
        Ray { origin: self.origin, direction: self.forward + across * self.right + along * self.up }
    }

    pub(super) fn check(&self) -> Result<(), SceneError> {
        let fail = |quantity, value, expected| Err(SceneError::Camera { quantity, value, expected });
        for (quantity, size) in [("film width", self.film.width), ("film height", self.film.height)] {
            if size == 0 {
                return fail(quantity, size as f64, "at least 1 pixel");
            }
        }
        for (quantity, tangent) in [
            ("tangent of half the horizontal field of view", self.tangent_half_width),
            ("tangent of half the vertical field of view", self.tangent_half_height),
        ] {
            if !(tangent.is_finite() && tangent > 0.0) {
                return fail(quantity, tangent, "finite and above zero");
            }
        }
        let frame = [self.forward, self.right, self.up];
        if let Some(v) = frame.iter().find(|v| (v.length() - 1.0).abs().is_nan() || (v.length() - 1.0).abs() > 1e-9) {
            return fail("length of a frame vector", v.length(), "1");
        }
        if let Some((quantity, value, expected)) = self.film.filter.invalid() {
            return fail(quantity, value, expected);
        }
        if !self.origin.is_finite() {
            return fail("origin", self.origin.max_element(), "finite");
        }
        Ok(())
    }
}
