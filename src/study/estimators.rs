//! The roster of random methods: one name each, and what a study must know of it.
//!
//! Sequential Monte Carlo is named here and run elsewhere: its answer is no mean of samples.

use super::StudyError;
use crate::assembly::System;
use crate::basis::Bundles;
use crate::estimator::{
    Bidirectional, Estimator, EstimatorError, GuidedWalk, Heuristic, LightTracer, MatrixWalk, OracleError, Order,
    PathTracer, Prediction, QuasiWalk, Sampling, Scoring, ShootingWalk, StochasticJacobi,
};
use crate::linalg::{Block, Equation, max_abs};
use crate::scene::Scene;
use crate::solver::{Gmres, Lu, SolveError, Solver};
use serde::Serialize;

/// The random method whose answer stands for the continuous truth: it runs whether asked for or not, as a direct solver does.
pub const REFERENCE: &str = "path-tracer";

/// Corrections by walks on the residual, see [`Sequential`](crate::estimator::Sequential).
pub(super) const SEQUENTIAL: &str = "sequential-walk";

/// Points on emitters alone: where an emitter touches what it lights, the variance is infinite, and no error bar holds.
pub const UNBOUNDED: &str = "path-tracer-emitters";

/// What a random method does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Approach {
    /// Walks on the matrix from the bundle that they score.
    Gathering,
    /// Particles on the matrix from what emits, which score every bundle they come by.
    Shooting,
    /// Walks on the matrix that are more even than independent ones, or know where to go.
    Guided,
    /// Light paths in the scene itself.
    Paths,
}

/// All names and what they do, in the order of every table.
const ROSTER: [(&str, Approach); 18] = [
    ("collision-walk", Approach::Gathering),
    ("absorption-walk", Approach::Gathering),
    ("survival-walk", Approach::Gathering),
    ("expected-value-walk", Approach::Gathering),
    ("collision-shooting", Approach::Shooting),
    ("absorption-shooting", Approach::Shooting),
    ("survival-shooting", Approach::Shooting),
    ("stochastic-jacobi", Approach::Shooting),
    ("quasi-walk", Approach::Guided),
    ("guided-walk", Approach::Guided),
    (SEQUENTIAL, Approach::Guided),
    (REFERENCE, Approach::Paths),
    ("path-tracer-power", Approach::Paths),
    ("path-tracer-directions", Approach::Paths),
    (UNBOUNDED, Approach::Paths),
    ("light-tracer", Approach::Paths),
    ("bidirectional", Approach::Paths),
    ("bidirectional-power", Approach::Paths),
];

/// Unknowns above which what needs one right-hand side for each is not predicted.
pub(super) const MOST_DIAGONAL: usize = 2500;

/// On the residual of the equations of moments: far below what any number of samples can tell.
const MOMENT_TOLERANCE: f64 = 1e-10;

/// Replicates of a scrambled sequence: what its error bar rests on.
pub(super) const REPLICATES: u64 = 16;

/// Samples that a bidirectional path counts for: it casts many times the rays.
const BIDIRECTIONAL_COST: u64 = 4;

/// Names of all random methods, in the order of every table.
pub fn estimator_names() -> impl Iterator<Item = &'static str> {
    ROSTER.iter().map(|(name, _)| *name)
}

/// The methods asked for, in the order of every table; `all` stands for all. The reference is among them, asked for or not.
///
/// # Errors
/// A name that nothing has.
pub fn choose_estimators(asked: &[String]) -> Result<Vec<String>, StudyError> {
    let known: Vec<&str> = estimator_names().collect();
    if let Some(name) = asked.iter().find(|name| *name != "all" && !known.contains(&name.as_str())) {
        return Err(StudyError::UnknownEstimator { name: name.clone(), known: known.join(", ") });
    }
    let is_asked = |name: &str| name == REFERENCE || asked.iter().any(|word| word == name || word == "all");
    Ok(known.into_iter().filter(|name| is_asked(name)).map(String::from).collect())
}

impl Approach {
    /// What the method of this name does.
    pub(super) fn of(name: &str) -> Self {
        ROSTER.iter().find(|(known, _)| *known == name).map_or(Self::Paths, |(_, approach)| *approach)
    }
}

/// One scene, its matrix and its solution, from which every method is made.
pub(super) struct Roster<'a> {
    pub scene: &'a Scene,
    pub bundles: &'a Bundles,
    pub system: &'a System,
    /// The discrete truth.
    pub truth: &'a Block,
    /// The tables that all walks share, or why there are none.
    walk: Result<MatrixWalk, EstimatorError>,
}

/// One method, ready to be sampled.
pub(super) enum Member<'a> {
    Gathering(MatrixWalk),
    Shooting(ShootingWalk),
    Jacobi(StochasticJacobi),
    Quasi(QuasiWalk),
    Guided(GuidedWalk),
    Paths(PathTracer<'a>),
    Photons(LightTracer<'a>),
    Pairs(Bidirectional<'a>),
}

impl<'a> Roster<'a> {
    /// Builds the tables of walks: O(n²).
    pub fn new(scene: &'a Scene, bundles: &'a Bundles, system: &'a System, truth: &'a Block) -> Self {
        Self { scene, bundles, system, truth, walk: MatrixWalk::collision(system) }
    }

    /// The walks of collision scoring.
    pub fn walk(&self) -> Result<&MatrixWalk, EstimatorError> {
        self.walk.as_ref().map_err(Clone::clone)
    }

    /// The method of this name; any that is none of the others is a path tracer.
    ///
    /// # Errors
    /// What the method refuses.
    pub fn member(&self, name: &str) -> Result<Member<'a>, EstimatorError> {
        let gathering = |scoring| self.walk().map(|walk| Member::Gathering(walk.with_scoring(scoring)));
        let shooting = |scoring| self.walk().and_then(|walk| walk.shooting(scoring)).map(Member::Shooting);
        let tracer = || PathTracer::new(self.scene, self.bundles);
        let pairs = || Bidirectional::new(self.scene, self.bundles);
        match name {
            "collision-walk" => gathering(Scoring::Collision),
            "absorption-walk" => gathering(Scoring::Absorption),
            "survival-walk" => gathering(Scoring::Survival),
            "expected-value-walk" => gathering(Scoring::ExpectedValue),
            "collision-shooting" => shooting(Scoring::Collision),
            "absorption-shooting" => shooting(Scoring::Absorption),
            "survival-shooting" => shooting(Scoring::Survival),
            "stochastic-jacobi" => self.walk()?.stochastic_jacobi(self.bundles.n_bundles() as u64).map(Member::Jacobi),
            "quasi-walk" => Ok(Member::Quasi(self.walk()?.quasi(1))),
            "guided-walk" => GuidedWalk::gathering(self.system, self.truth).map(Member::Guided),
            "path-tracer-power" => Ok(Member::Paths(tracer()?.with_sampling(Sampling::Both(Heuristic::Power)))),
            "path-tracer-directions" => Ok(Member::Paths(tracer()?.with_sampling(Sampling::Directions))),
            UNBOUNDED => Ok(Member::Paths(tracer()?.with_sampling(Sampling::Emitters))),
            "light-tracer" => LightTracer::new(self.scene, self.bundles).map(Member::Photons),
            "bidirectional" => pairs().map(Member::Pairs),
            "bidirectional-power" => Ok(Member::Pairs(pairs()?.with_heuristic(Heuristic::Power))),
            _ => tracer().map(Member::Paths),
        }
    }

    /// Probability of surviving each bundle: its albedo in its brightest band.
    fn survival(&self) -> Vec<f64> {
        let albedo = self.system.transport().scattering().values();
        (0..albedo.n_rows()).map(|i| albedo.row(i).fold(0.0, f64::max)).collect()
    }

    /// The most that one sample scores a hit, a band each: radiance where bundles are starts, flux where one start serves all.
    pub fn largest_scores(&self, member: &Member<'_>) -> Vec<f64> {
        // Last events are worth more the rarer they are.
        let worth =
            |share: &dyn Fn(f64) -> Option<f64>| self.survival().into_iter().filter_map(share).fold(1.0, f64::max);
        let factor = |scoring| match scoring {
            Scoring::Absorption => worth(&|p| (p <= 0.9).then(|| 1.0 / (1.0 - p))),
            Scoring::Survival => worth(&|p| (p >= 0.1).then(|| 1.0 / p)),
            Scoring::Collision | Scoring::ExpectedValue => 1.0,
        };
        let factor = match member {
            Member::Gathering(walk) => factor(walk.scoring()),
            Member::Shooting(walk) => factor(walk.scoring()),
            _ => 1.0,
        };
        if member.is_joint() {
            let emission = self.system.emission();
            let power = |(i, mu): (usize, &f64)| mu * emission.row(i).fold(0.0, f64::max);
            let all: f64 = self.system.etendue().iter().enumerate().map(power).sum();
            return vec![factor * all; emission.n_columns()];
        }
        // The brightest bundle: all bounces together outshine the lamp, and no score is much above that.
        self.truth.columns().map(|column| factor * max_abs(column)).collect()
    }

    /// What the error bars of a method will be, before it is sampled; `None` where no equation tells.
    ///
    /// # Errors
    /// What stands in the way, in words.
    pub fn predict(&self, member: &Member<'_>) -> Option<Result<Prediction, String>> {
        let words = |error: OracleError<SolveError>| error.to_string();
        match member {
            Member::Gathering(walk) => Some(walk.predict(Order::Fourth, self.truth, by_krylov).map_err(words)),
            Member::Guided(walk) => Some(walk.predict(Order::Variance, self.truth, by_factors).map_err(words)),
            Member::Shooting(walk) => {
                let n = self.bundles.n_bundles();
                let scores_once = walk.scoring() == Scoring::Absorption && self.survival().iter().all(|p| *p <= 0.9);
                if n > MOST_DIAGONAL && !scores_once {
                    return Some(Err(format!(
                        "its variance takes a right-hand side for each of {n} bundles, the most is {MOST_DIAGONAL}"
                    )));
                }
                Some(walk.predict(Order::Variance, by_factors).map_err(words))
            }
            _ => None,
        }
    }
}

/// Every row of a moment's matrix sums below 1, so that a few products suffice.
fn by_krylov(equation: Equation<'_>) -> Result<Block, SolveError> {
    let gmres = Gmres { tolerance: MOMENT_TOLERANCE, restart: 40, preconditioner: None };
    gmres.solve(equation, &mut ()).map(|solution| solution.radiance)
}

/// For many right-hand sides, and rows that may sum above 1.
fn by_factors(equation: Equation<'_>) -> Result<Block, SolveError> {
    Lu.solve(equation, &mut ()).map(|solution| solution.radiance)
}

impl Member<'_> {
    pub fn estimator(&self) -> &dyn Estimator {
        match self {
            Self::Gathering(it) => it,
            Self::Shooting(it) => it,
            Self::Jacobi(it) => it,
            Self::Quasi(it) => it,
            Self::Guided(it) => it,
            Self::Paths(it) => it,
            Self::Photons(it) => it,
            Self::Pairs(it) => it,
        }
    }

    /// True if one sample scores many bundles, so that their errors depend on one another.
    pub fn is_joint(&self) -> bool {
        matches!(self, Self::Shooting(_) | Self::Jacobi(_) | Self::Photons(_))
    }

    /// Samples of the estimator that count as one a bundle: particles serve all bundles at once, and a run of stochastic Jacobi begins with
    /// one for each.
    pub fn samples_a_bundle(&self) -> u64 {
        match self {
            Self::Shooting(_) | Self::Photons(_) => self.estimator().n_bundles() as u64,
            _ => 1,
        }
    }

    /// Particles, walks or paths of so many samples a bundle, for the pooling of comparisons.
    pub fn n_particles(&self, samples: u64) -> u64 {
        if self.is_joint() { samples.saturating_mul(self.estimator().n_bundles() as u64) } else { samples }
    }

    /// The most samples a bundle, of these for walks and these for paths.
    pub fn most(&self, walks: u64, paths: u64) -> u64 {
        match self {
            Self::Paths(_) | Self::Photons(_) => paths,
            Self::Pairs(_) => (paths / BIDIRECTIONAL_COST).max(4),
            // As many points a replicate as make up the same number of walks.
            Self::Quasi(_) => (walks / REPLICATES).max(2) * REPLICATES,
            _ => walks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::{Exchange, assemble};
    use crate::basis::Resolution;
    use crate::gallery;
    use std::collections::BTreeSet;

    #[test]
    fn every_name_stands_for_the_method_that_bears_it() {
        let scene = gallery::furnace_cube(&[0.5], &[1.0]).expect("a furnace is valid");
        let bundles = Bundles::new(&scene, Resolution { patch_size: 1.0, n_directions: 1 }).expect("a cube can be cut");
        let system = assemble(&scene, &bundles, Exchange::default()).expect("and assembled");
        let truth = by_factors(system.equation()).expect("and solved");
        let roster = Roster::new(&scene, &bundles, &system, &truth);
        for name in estimator_names().filter(|name| *name != SEQUENTIAL) {
            let member = roster.member(name).expect("a furnace refuses nothing");
            assert_eq!(member.estimator().name(), name);
            let is_in_the_scene = Approach::of(name) == Approach::Paths;
            assert_eq!(member.estimator().truth().to_string() == "continuous", is_in_the_scene, "{name}");
        }
        assert_eq!(estimator_names().collect::<BTreeSet<_>>().len(), ROSTER.len());
    }

    #[test]
    fn what_is_chosen_is_in_order_and_the_reference_is_among_it() {
        let words = |list: &[&str]| list.iter().map(|word| word.to_string()).collect::<Vec<_>>();
        let chosen = choose_estimators(&words(&["light-tracer", "collision-walk", "light-tracer"]));
        assert_eq!(chosen, Ok(words(&["collision-walk", REFERENCE, "light-tracer"])));
        assert_eq!(choose_estimators(&words(&["all"])).map(|all| all.len()), Ok(ROSTER.len()));
        let unknown = choose_estimators(&words(&["path-tracer", "patch-tracer"]));
        assert!(matches!(unknown, Err(StudyError::UnknownEstimator { name, .. }) if name == "patch-tracer"));
    }
}
