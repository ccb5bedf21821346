//! What a side does to light, made ready for paths.

use crate::geometry::Vec3;
use crate::sampling::warp;
use crate::scattering::Brdf;
use std::f64::consts::FRAC_1_PI;

/// f_r of one side. Diffuse sides are told apart once, and not asked band by band at every vertex.
///
/// Directions are local, and point away from the surface. f_r is symmetric in them, so the same functions serve paths from a sensor and
/// paths from a light; `given` is the direction that the path has come from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Reflection<'a> {
    /// The albedo in every band.
    Diffuse(&'a [f64]),
    Other(&'a dyn Brdf),
}

/// Where a path goes next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    pub direction: Vec3,
    /// With respect to solid angle, sr⁻¹.
    pub density: f64,
}

impl<'a> Reflection<'a> {
    pub fn new(brdf: &'a dyn Brdf) -> Self {
        brdf.lambertian().map_or(Self::Other(brdf), Self::Diffuse)
    }

    /// True for a surface that reflects a direction into finitely many others, which no drawn point ever lies in. None does yet; whoever
    /// connects vertices asks here, and here alone.
    #[inline]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Diffuse(_) | Self::Other(_) => false,
        }
    }

    /// values ← values · f_r · scale, band by band.
    #[inline]
    pub fn scale(&self, given: Vec3, direction: Vec3, scale: f64, values: &mut [f64]) {
        match self {
            Self::Diffuse(albedo) => {
                let seen = if given.z > 0.0 && direction.z > 0.0 { scale * FRAC_1_PI } else { 0.0 };
                values.iter_mut().zip(*albedo).for_each(|(value, albedo)| *value *= albedo * seen);
            }
            Self::Other(brdf) => {
                let turned = values.iter_mut().enumerate();
                turned.for_each(|(band, value)| *value *= brdf.eval(band, direction, given) * scale);
            }
        }
    }

    /// Density of [`Reflection::turn`], sr⁻¹.
    #[inline]
    pub fn density(&self, given: Vec3, direction: Vec3) -> f64 {
        match self {
            Self::Diffuse(_) if given.z > 0.0 => warp::cosine_hemisphere_pdf(direction.to_array()),
            Self::Diffuse(_) => 0.0,
            Self::Other(brdf) => brdf.pdf(given, direction),
        }
    }

    /// Draws where the path goes next, and multiplies what it carries by f_r cosθ / density; `None` where it is absorbed.
    #[inline]
    pub fn turn(&self, given: Vec3, uniform: [f64; 2], throughput: &mut [f64]) -> Option<Turn> {
        match self {
            Self::Diffuse(albedo) => {
                if given.z <= 0.0 {
                    return None;
                }
                let direction = warp::cosine_hemisphere(uniform);
                throughput.iter_mut().zip(*albedo).for_each(|(carried, albedo)| *carried *= albedo);
                Some(Turn { direction: direction.into(), density: warp::cosine_hemisphere_pdf(direction) })
            }
            Self::Other(brdf) => {
                let direction = brdf.sample(given, uniform)?;
                let density = brdf.pdf(given, direction);
                let scale = direction.z / density;
                if !scale.is_finite() {
                    return None;
                }
                self.scale(given, direction, scale, throughput);
                Some(Turn { direction, density })
            }
        }
    }

    /// values ← values · albedo: what becomes of light from the given direction in all directions together.
    #[inline]
    pub fn absorb(&self, given: Vec3, values: &mut [f64]) {
        match self {
            Self::Diffuse(albedo) => values.iter_mut().zip(*albedo).for_each(|(value, albedo)| *value *= albedo),
            Self::Other(brdf) => {
                values.iter_mut().enumerate().for_each(|(band, value)| *value *= brdf.albedo(band, given));
            }
        }
    }
}
