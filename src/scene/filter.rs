//! Pixel filters: how a pixel weighs the light around its centre.

use super::PixelFilter;
use std::f64::consts::PI;

impl PixelFilter {
    /// Half-width of the support, pixels.
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Box { radius } | Self::Tent { radius } => radius,
            Self::Gaussian { standard_deviation } => 4.0 * standard_deviation,
            Self::Mitchell { .. } | Self::CatmullRom => 2.0,
            Self::Lanczos { lobes } => lobes,
        }
    }

    /// The first parameter out of its range, with what it must be: positive widths, and cubics that are not mostly negative.
    pub(super) fn invalid(&self) -> Option<(&'static str, f64, &'static str)> {
        let width = |name, value: f64| {
            let fits = value.is_finite() && value > 0.0 && value <= 64.0;
            (!fits).then_some((name, value, "above 0 and at most 64 pixels"))
        };
        let share = |name, value: f64| (!(0.0..=1.0).contains(&value)).then_some((name, value, "within [0, 1]"));
        match *self {
            Self::Box { radius } | Self::Tent { radius } => width("filter radius", radius),
            Self::Gaussian { standard_deviation } => width("filter standard deviation", standard_deviation),
            Self::Lanczos { lobes } => width("filter lobes", lobes),
            Self::Mitchell { b, c } => share("filter parameter B", b).or_else(|| share("filter parameter C", c)),
            Self::CatmullRom => None,
        }
    }

    /// One-dimensional weight at distance x from the centre, not normalised; a pixel weighs by the product of both axes.
    ///
    /// Sources: Mitchell and Netravali (1988), eq. 8; Duchon (1979).
    pub fn eval(&self, x: f64) -> f64 {
        let x = x.abs();
        if x > self.radius() {
            return 0.0;
        }
        match *self {
            Self::Box { .. } => 1.0,
            Self::Tent { radius } => 1.0 - x / radius,
            Self::Gaussian { standard_deviation } => {
                let bell = |x: f64| (-0.5 * (x / standard_deviation).powi(2)).exp();
                bell(x) - bell(self.radius())
            }
            Self::Mitchell { b, c } => mitchell(x, b, c),
            Self::CatmullRom => mitchell(x, 0.0, 0.5),
            Self::Lanczos { lobes } => {
                let sinc = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
                sinc(x) * sinc(x / lobes)
            }
        }
    }
}

/// Draws offsets with density proportional to |filter|, by a table of its integral.
#[derive(Clone, Debug, PartialEq)]
pub struct FilterTable {
    filter: PixelFilter,
    /// ∫ |filter| from −radius up to each of the equidistant ends of cells, normalised to 1.
    cumulative: Vec<f64>,
    /// ∫ |filter| / ∫ filter.
    weight: f64,
}

impl FilterTable {
    /// Cells of the table: a gaussian is then drawn to 1e-6 of its width.
    const CELLS: usize = 1024;

    pub fn new(filter: &PixelFilter) -> Self {
        let centre = |k: usize| filter.radius() * (2.0 * (k as f64 + 0.5) / Self::CELLS as f64 - 1.0);
        let (mut sum, mut signed) = (0.0, 0.0);
        let mut cumulative: Vec<f64> = (0..Self::CELLS)
            .map(|k| {
                sum += filter.eval(centre(k)).abs();
                signed += filter.eval(centre(k));
                sum
            })
            .collect();
        cumulative.iter_mut().for_each(|c| *c /= sum);
        Self { filter: *filter, cumulative, weight: sum / signed }
    }

    /// What a sample of sign +1 weighs, so that the mean of weights is one: 1 for filters without negative lobes.
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// From a number uniform in [0, 1): an offset in pixels, and the sign of the filter there.
    pub fn draw(&self, uniform: f64) -> (f64, f64) {
        let k = self.cumulative.partition_point(|c| *c <= uniform).min(Self::CELLS - 1);
        let low = if k == 0 { 0.0 } else { self.cumulative[k - 1] };
        let within = ((uniform - low) / (self.cumulative[k] - low)).clamp(0.0, 1.0);
        let offset = self.filter.radius() * (2.0 * (k as f64 + within) / Self::CELLS as f64 - 1.0);
        (offset, if self.filter.eval(offset) < 0.0 { -1.0 } else { 1.0 })
    }
}

/// The two-parameter cubic on [0, 2].
fn mitchell(x: f64, b: f64, c: f64) -> f64 {
    let cubic = |k3: f64, k2: f64, k1: f64, k0: f64| (((k3 * x + k2) * x + k1) * x + k0) / 6.0;
    if x < 1.0 {
        cubic(12.0 - 9.0 * b - 6.0 * c, -18.0 + 12.0 * b + 6.0 * c, 0.0, 6.0 - 2.0 * b)
    } else {
        cubic(-b - 6.0 * c, 6.0 * b + 30.0 * c, -12.0 * b - 48.0 * c, 8.0 * b + 24.0 * c)
    }
}
