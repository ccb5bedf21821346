//! A ray in the coordinates of the boxes: f32, centred on the scene, whose polygons lie within 1 of the origin.

use super::shape::power_of_two_below;
use crate::geometry::{Ray, Vec3};

/// Growth of a block's doubt with the coordinates of scene and origin, over the scene's size: more than f64 rounds off, and so much
/// that no polygon is called met without a doubt where [`Probe`](super::shape::Probe) calls the ray grazing.
const NOISE: f64 = 2e-3;

/// Coordinates over the scene's size above which boxes may miss what the ray meets, for they are grown by no more than some fifty
/// f32 roundings.
const FARTHEST: f64 = 1e8;

/// The coordinates of the boxes.
#[derive(Clone, Copy)]
pub(super) struct Local {
    pub centre: Vec3,
    /// A power of two: scaling rounds nothing off.
    pub scale: f64,
    /// Largest coordinate of the centre there.
    offset: f64,
}

/// A ray there: at parameter t · speed − entry of a direction whose largest component is in [1, 2).
pub(super) struct LocalRay {
    pub origin: [f32; 3],
    pub direction: [f32; 3],
    pub t_max: f32,
    /// At least R |d| (see [`super::block`]), and what f64 rounds off before.
    pub doubt: f32,
    entry: f64,
    speed: f64,
}

/// What boxes can say of a ray.
pub(super) enum Reach {
    /// It meets none of the scene.
    Nothing,
    /// It may meet what lies in the boxes along this ray.
    Boxes(LocalRay),
    /// It starts, or the scene lies, too far from the origin for boxes to tell; or it is too long or too short.
    Anything,
}

impl Local {
    /// Coordinates for a scene within `radius` of `centre`.
    pub fn new(centre: Vec3, radius: f64) -> Self {
        let mut scale = 1.0 / power_of_two_below(radius);
        if radius * scale > 1.0 {
            scale *= 0.5;
        }
        Self { centre, scale, offset: centre.abs().max_element() * scale }
    }

    pub fn point(&self, p: Vec3) -> Vec3 {
        (p - self.centre) * self.scale
    }

    /// The ray, 0 < t ≤ t_max, moved up to the scene where it starts far outside.
    #[inline(always)]
    pub fn ray(&self, ray: &Ray, t_max: f64) -> Reach {
        let largest = ray.direction.abs().max_element();
        if !ray.direction.is_finite() || largest == 0.0 {
            return Reach::Nothing;
        }
        let power = power_of_two_below(largest);
        let direction = ray.direction * reciprocal(power);
        let length_squared = direction.length_squared();
        let mut start = self.point(ray.origin);
        let coordinates = self.offset + start.abs().max_element();
        let speed = power * self.scale;
        if !((0.0..=FARTHEST).contains(&coordinates) && speed.is_normal() && (1e-300..1e300).contains(&largest)) {
            return Reach::Anything;
        }

        // Everything lies within 1 of the origin: start at most 1.5 before the point next to it.
        let mut entry = 0.0;
        if start.length_squared() > 4.0 {
            entry = ((-start.dot(direction) - 1.5 * length_squared.sqrt()) / length_squared).max(0.0);
            start += entry * direction;
            if start.length_squared() > 8.0 {
                return Reach::Nothing;
            }
        }
        // Bound R and |d| without roots, by √x ≤ (x/c + c)/2: |d| is between 1 and √12.
        let reach = (0.5 * start.length_squared() + 1.5) as f32;
        let length = (0.25 * length_squared + 1.0) as f32;
        let mut t_max = (t_max * speed - entry) as f32;
        if t_max <= 0.0 {
            return Reach::Nothing;
        }
        if t_max * length > 2.0 * reach {
            t_max = 2.0 * reach / length;
        }
        Reach::Boxes(LocalRay {
            origin: start.as_vec3().to_array(),
            direction: direction.as_vec3().to_array(),
            t_max,
            doubt: reach * length * (1.0 + NOISE * coordinates) as f32,
            entry,
            speed,
        })
    }
}

impl LocalRay {
    /// f32 at or above the parameter for t.
    #[inline]
    pub fn parameter(&self, t: f64) -> f32 {
        round_up((t * self.speed - self.entry) as f32)
    }
}

/// 1/x for a power of two, but for the largest.
fn reciprocal(power: f64) -> f64 {
    f64::from_bits(0x7fe0_0000_0000_0000_u64.wrapping_sub(power.to_bits()))
}

/// A little above t, so that the boxes of equal hits are still looked at.
#[inline]
pub(super) fn round_up(t: f32) -> f32 {
    t * (1.0 + 1e-6)
}
