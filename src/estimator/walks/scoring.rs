//! When a walk scores, and how much.

/// Bundles that absorb less than a tenth of the walks score every visit.
const LAST_EVENT_LIMIT: f64 = 0.9;

/// Bundles that survive less than a tenth of the walks score every visit.
const SURVIVAL_LIMIT: f64 = 0.1;

/// When a walk scores. With p the probability of surviving a bundle, a visit is worth what a visit brings on average, e:
///
/// | | where it is absorbed, α | where it survives, β |
/// |---|---|---|
/// | collision | e | e |
/// | absorption (last event) | e / (1 − p) | 0 |
/// | survival | 0 | e / p |
/// | expected value | as collision, with the next bundle's e in expectation | |
///
/// and (1 − p) α + p β = e throughout. Bundles with p > 0.9 end few walks or none, and would score α rarely and hugely, or never; those with
/// p < 0.1 likewise β: they score every visit.
///
/// Source: Forsythe & Leibler 1950 (absorption); Wasow 1952 (collision); Spanier & Gelbard 1969, §2.6 (expected values); Bekaert 1999, §4.3
/// (survival).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scoring {
    /// At every visit.
    Collision,
    /// Where it is absorbed.
    Absorption,
    /// Where it is not absorbed.
    Survival,
    /// At every visit, what the next visit would score on average: a row of K E in place of one entry of E.
    ExpectedValue,
}

impl Scoring {
    pub const ALL: [Self; 4] = [Self::Collision, Self::Absorption, Self::Survival, Self::ExpectedValue];

    /// (α, β) for a visit that is worth 1.
    pub(super) fn shares(self, survival: f64) -> (f64, f64) {
        match self {
            Self::Absorption if survival <= LAST_EVENT_LIMIT => (1.0 / (1.0 - survival), 0.0),
            Self::Survival if survival >= SURVIVAL_LIMIT => (0.0, 1.0 / survival),
            _ => (1.0, 1.0),
        }
    }

    /// The bounce that the first bundle's visit scores.
    pub(super) fn first_bounce(self) -> usize {
        usize::from(self == Self::ExpectedValue)
    }
}
