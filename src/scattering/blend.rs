//! Two surfaces mixed.

use super::choice::{Choice, choose};
use super::parameter::{Examination, ParameterError};
use super::{Brdf, Deltas};
use crate::geometry::Vec3;
use std::sync::Arc;

/// f = (1 − w) f₀ + w f₁, mirror-like terms and albedos likewise: Mitsuba 3's `blendbsdf` with a constant weight. What laws both keep, the
/// mixture keeps. Samples the smooth part of one of the two, by their weights.
#[derive(Clone, Debug)]
pub struct Blend {
    parts: [Arc<dyn Brdf>; 2],
    weight: f64,
}

impl Blend {
    /// `weight` is the share of the second.
    ///
    /// # Errors
    /// A weight outside [0, 1], different numbers of bands, or two surfaces that both let light through but bend it differently.
    pub fn new(parts: [Arc<dyn Brdf>; 2], weight: f64) -> Result<Self, ParameterError> {
        let examine = Examination("blendbsdf");
        examine.fractions("weight", &[weight])?;
        examine.bands("number of bands of the second", parts[1].n_bands(), parts[0].n_bands())?;
        if parts.iter().all(|part| part.is_transmissive()) {
            let [first, second] = [0, 1].map(|k| parts[k].relative_index());
            examine.within("relative index of the second", second, first..=first, "that of the first")?;
        }
        Ok(Self { parts, weight })
    }

    /// Chance that a sample of the smooth part is one of the first: by the weights of what is smooth in each.
    fn share(&self, outgoing: Vec3) -> f64 {
        let smooth = |k: usize| 1.0 - self.parts[k].mirror_share(outgoing);
        let [first, second] = [(1.0 - self.weight) * smooth(0), self.weight * smooth(1)];
        if first + second > 0.0 { first / (first + second) } else { 1.0 - self.weight }
    }

    fn mixed(&self, of: impl Fn(&dyn Brdf) -> f64) -> f64 {
        let [first, second] = &self.parts;
        (1.0 - self.weight) * of(&**first) + self.weight * of(&**second)
    }
}

impl Brdf for Blend {
    fn n_bands(&self) -> usize {
        self.parts[0].n_bands()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        self.mixed(|part| part.eval(band, incident, outgoing))
    }

    fn sample(&self, outgoing: Vec3, [u, v]: [f64; 2]) -> Option<Vec3> {
        let [first, second] = &self.parts;
        match choose(self.share(outgoing), u) {
            Choice::First(u) => first.sample(outgoing, [u, v]),
            Choice::Second(u) => second.sample(outgoing, [u, v]),
        }
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        let ([first, second], share) = (&self.parts, self.share(outgoing));
        share * first.pdf(outgoing, incident) + (1.0 - share) * second.pdf(outgoing, incident)
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        self.mixed(|part| part.albedo(band, outgoing))
    }

    fn deltas(&self, band: usize, outgoing: Vec3) -> Deltas {
        let shares = [1.0 - self.weight, self.weight];
        let parts = self.parts.iter().zip(shares).flat_map(|(part, share)| {
            let terms = part.deltas(band, outgoing);
            [0, 1].map(|k| terms.get(k).map(|term| (term.incident, share * term.weight))).into_iter().flatten()
        });
        parts.fold(Deltas::NONE, |sum, (incident, weight)| sum.with(incident, weight))
    }

    fn mirror_share(&self, outgoing: Vec3) -> f64 {
        self.mixed(|part| part.mirror_share(outgoing))
    }

    fn is_transmissive(&self) -> bool {
        self.parts.iter().any(|part| part.is_transmissive())
    }

    fn relative_index(&self) -> f64 {
        self.parts.iter().find(|part| part.is_transmissive()).map_or(1.0, |part| part.relative_index())
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        let [first, second] = &self.parts;
        format!("blendbsdf weight={:?} ({}) ({})", self.weight, first.description(), second.description())
    }
}
