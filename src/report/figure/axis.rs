//! Where a number lies along an axis, and which numbers are written beside it.

use crate::report::number::{count, power_of_ten, scientific, significant, trimmed};

/// Positive numbers below this are drawn at the foot of a logarithmic axis: far below what rounding leaves of 1.
pub const SMALLEST_SHOWN: f64 = 1e-17;

/// The most labels along one axis.
const MOST_LABELS: i32 = 9;

/// One axis: a map from numbers to [0, 1] and its marks.
#[derive(Clone, Debug)]
pub struct Axis {
    logarithmic: bool,
    /// Whether numbers fall along the axis.
    reversed: bool,
    /// In the drawn coordinate: the number itself or its decimal logarithm.
    low: f64,
    high: f64,
    /// Numbers with a label and a rule across the panel.
    pub labels: Vec<(f64, String)>,
    /// Numbers with a short tick only.
    pub ticks: Vec<f64>,
}

impl Axis {
    /// Whole decades around the values; what is not finite or below 10⁻¹⁷ is not counted. Without any value: 10⁻¹⁷ to 1.
    pub fn log_decades(values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = log_extent(values).map_or((-17.0, 0.0), |(low, high)| (low.floor(), high.ceil()));
        Self::log_between(low, if high > low { high } else { low + 1.0 })
    }

    /// The values with a margin of some percent on either side, marked at decades, and at 2 and 5 where decades are few.
    pub fn log_tight(values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = log_extent(values).unwrap_or((0.0, 1.0));
        // 2 and 5 lie 0.4 decades apart: with 0.7 there is always something to label.
        let margin = (0.06 * (high - low)).max(0.5 * (0.7 - (high - low)));
        Self::log_between(low - margin, high + margin)
    }

    /// From 0 to the largest value, marked at multiples of 1, 2 or 5.
    pub fn linear_from_zero(values: impl IntoIterator<Item = f64>) -> Self {
        let high = values.into_iter().filter(|v| v.is_finite()).fold(0.0, f64::max);
        // Keep clear of the ends of f64, where a step or a margin would under- or overflow.
        let high = if high > 1e-300 { high.min(1e300) } else { 1.0 };
        let step = nice_step(high / 6.0);
        let labels = (0..=(high / step + 1e-9).floor() as u32).map(|k| f64::from(k) * step);
        let labels = labels.map(|v| (v, if step >= 1.0 { count(v as u64) } else { trimmed(v, 2) })).collect();
        Self { logarithmic: false, reversed: false, low: 0.0, high: 1.03 * high, labels, ticks: Vec::new() }
    }

    /// Between two numbers of either sign, marked at multiples of 1, 2 or 5.
    pub fn linear_between(low: f64, high: f64) -> Self {
        let step = nice_step((high - low) / 6.0);
        let multiples = (low / step).ceil() as i64..=(high / step).floor() as i64;
        let name = |v: f64| if v < 0.0 { format!("−{}", trimmed(-v, 2)) } else { trimmed(v, 2) };
        let labels = multiples.map(|k| k as f64 * step).map(|v| (v, name(v))).collect();
        Self { logarithmic: false, reversed: false, low, high, labels, ticks: Vec::new() }
    }

    fn log_between(low: f64, high: f64) -> Self {
        let (first, last) = ((low - 1e-9).ceil() as i32, (high + 1e-9).floor() as i32);
        let every = ((last - first) / MOST_LABELS + 1).max(1);
        let plain = first >= -2 && last <= 4 && low > -2.5;

        // Label decades, counted from the top where 1 and the round powers are.
        let name = |k: i32| if plain { plain_decade(k) } else { power_of_ten(k) };
        let mut labels: Vec<(f64, String)> =
            (first..=last).filter(|k| (last - k) % every == 0).map(|k| (10_f64.powi(k), name(k))).collect();

        // Tick the decades without a label, or the digits 2 to 9 where there is room for them.
        let inside = |v: &f64| (low..=high).contains(&v.log10());
        let ticks = if every > 1 {
            (first..=last).map(|k| 10_f64.powi(k)).collect()
        } else if high - low <= 6.0 {
            (first - 1..=last)
                .flat_map(|k| (2..10).map(move |d| f64::from(d) * 10_f64.powi(k)))
                .filter(inside)
                .collect()
        } else {
            Vec::new()
        };

        // Label 2 and 5 too where fewer than two decades are in sight.
        if labels.len() < 2 {
            let digits = (first - 1..=last).flat_map(|k| [2, 5].map(|d| f64::from(d) * 10_f64.powi(k)));
            labels.extend(digits.filter(inside).map(|v| (v, if plain { significant(v, 1) } else { scientific(v, 1) })));
            labels.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        Self { logarithmic: true, reversed: false, low, high, labels, ticks }
    }

    /// Marks these numbers, and no others.
    pub fn with_labels(self, labels: Vec<(f64, String)>) -> Self {
        Self { labels, ticks: Vec::new(), ..self }
    }

    /// A logarithmic axis that ends at this number, which must be above where it begins.
    pub fn up_to(self, high: f64) -> Self {
        let (low, high) = (self.low, high.log10());
        if high > low && high.is_finite() { Self::log_between(low, high) } else { self }
    }

    /// The same, the largest number first.
    pub fn reversed(self) -> Self {
        Self { reversed: !self.reversed, ..self }
    }

    /// Where `value` lies between the two ends, 0 to 1; clamped there. `None` for NaN and infinities.
    pub fn fraction(&self, value: f64) -> Option<f64> {
        if !value.is_finite() {
            return None;
        }
        let drawn = if self.logarithmic { value.max(1e-300).log10() } else { value };
        let fraction = ((drawn - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        Some(if self.reversed { 1.0 - fraction } else { fraction })
    }

    /// The two ends, the smaller first.
    pub fn ends(&self) -> (f64, f64) {
        if self.logarithmic { (10_f64.powf(self.low), 10_f64.powf(self.high)) } else { (self.low, self.high) }
    }

    /// Whether `value` had to be moved to be drawn.
    pub fn clips(&self, value: f64) -> bool {
        self.logarithmic && value < SMALLEST_SHOWN
    }
}

fn log_extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    let shown = values.into_iter().filter(|v| v.is_finite() && *v >= SMALLEST_SHOWN).map(f64::log10);
    shown.fold(None, |extent, v| match extent {
        None => Some((v, v)),
        Some((low, high)) => Some((v.min(low), v.max(high))),
    })
}

fn plain_decade(exponent: i32) -> String {
    if exponent < 0 { significant(10_f64.powi(exponent), 1) } else { count(10_u64.pow(exponent as u32)) }
}

/// The smallest of 1, 2, 5 times a power of ten that is at least `step`.
fn nice_step(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|d| d * decade)
        .find(|nice| *nice >= step * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_axes_mark_decades() {
        let axis = Axis::log_decades([3e-13, 0.0, f64::NAN, 0.7]);
        assert!((axis.fraction(1e-13).unwrap(), axis.fraction(1.0).unwrap()) == (0.0, 1.0));
        assert!(axis.labels.len() <= 10 && axis.labels.iter().any(|(v, name)| *v == 1.0 && name == "1"));
        assert!(axis.clips(0.0) && axis.clips(1e-18) && !axis.clips(1e-16));
        assert_eq!(axis.fraction(0.0), Some(0.0));
        assert_eq!(axis.fraction(f64::NAN), None);
    }

    #[test]
    fn a_reversed_axis_begins_with_the_largest_and_one_may_end_where_it_is_told() {
        let axis = Axis::log_decades([1e-3, 1.0]).reversed();
        assert!((axis.fraction(1.0).unwrap(), axis.fraction(1e-3).unwrap()) == (0.0, 1.0));
        assert_eq!(Axis::log_tight([2.0, 50.0]).up_to(1000.0).fraction(1000.0), Some(1.0));
        // What would end before it begins stays as it is.
        assert_eq!(Axis::log_decades([10.0, 100.0]).up_to(1.0).fraction(100.0), Some(1.0));
    }

    #[test]
    fn axes_without_data_still_have_two_ends() {
        for axis in [
            Axis::log_decades([]),
            Axis::log_tight([f64::NAN]),
            Axis::linear_from_zero([]),
            Axis::log_tight([0.25]),
            Axis::linear_from_zero([5e-324]),
        ] {
            let (low, high) = axis.ends();
            assert!(low < high && !axis.labels.is_empty(), "{axis:?}");
        }
    }

    #[test]
    fn linear_axes_step_by_one_two_or_five() {
        let names: Vec<String> = Axis::linear_from_zero([57.0]).labels.into_iter().map(|(_, name)| name).collect();
        assert_eq!(names, ["0", "10", "20", "30", "40", "50"]);
    }
}
