//! Multigrid of the second kind: the two-grid method, its coarse equation answered by a coarser one, and so on.
//!
//! ```text
//! z = r + N r + N² r + N³ r,      L ← L + z + P (I − K₁)⁻¹ Pᵀ W (r − (I − K) z)  about,      Kₗ₊₁ = (Pᵀ D P)⁻¹ Pᵀ D Kₗ P
//! ```
//!
//! Transport smooths, so that one bounce a level is all the smoothing there is, and what a coarse correction leaves is of the size of the
//! patches: an iteration takes the more off the residual the finer the mesh, whatever is absorbed. The first coarse levels are those of the
//! patch hierarchy, 2 × 2 patches and on; the last, of n^⅔ groups or fewer, is eliminated. The first correction begins there and adds a
//! cycle on every level (nested iteration), which leaves an error of the size of the mesh's own.
//!
//! Needs coarse equations that are not singular, as those of K ≥ 0 with some absorption; a hierarchy, or it is Perron deflation. Every
//! entry of K is read once to set up, which also gives the first bounce; then one product an iteration, a pass over the n × m matrix K P with
//! m some n/4, and a cycle: v (m² + v (m/4)² + …) entries where every level asks the next v times. Source: Brakhage (1960); Atkinson
//! (1976), §5.3; Hackbusch (1981), "Die schnelle Auflösung der Fredholmschen Integralgleichung zweiter Art"; Hackbusch (1985), §16.

use super::super::monitor::Monitor;
use super::super::{Attempt, Observer, SolveError, Solver};
use super::coarse::Wanted;
use super::two_grid::{Smoother, cheap_to_eliminate, iterate};
use crate::linalg::{Aggregation, Equation};

/// Cycles until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multigrid {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// How often a level asks the next one: 1 is the V-cycle, 2 the W-cycle.
    pub n_visits: usize,
}

impl Solver for Multigrid {
    fn name(&self) -> &'static str {
        "multigrid"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let n = equation.n_unknowns();
        let whole = [Aggregation::whole(n)];
        let levels = match equation.hierarchy {
            Some(hierarchy) if !hierarchy.levels().is_empty() => hierarchy.levels(),
            _ => &whole,
        };
        // Go down to the first level that is cheap to eliminate.
        let last = levels.iter().position(|level| level.n_groups() <= cheap_to_eliminate(n));
        let levels = &levels[..last.map_or(levels.len(), |last| last + 1)];
        let wanted = Wanted::Levels { coarser: &levels[1..], n_visits: self.n_visits };
        iterate(monitor, self.name(), equation, levels[0].clone(), wanted, Smoother::Near)
    }
}
