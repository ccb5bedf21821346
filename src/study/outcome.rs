//! What a study records. Plain data; `report` turns it into figures and a page.

use super::{Approach, Duality, Provenance};
use crate::image::Image;
use serde::Serialize;

/// Everything one run of `study SCENE` measured.
///
/// Two truths are named throughout: *discrete* is (I − K)⁻¹E of the assembled K, *continuous* is the scene's own.
#[derive(Clone, Debug, Serialize)]
pub struct StudyOutcome {
    pub scene: String,
    pub provenance: Provenance,
    pub n_bundles: usize,
    pub bands: Vec<String>,
    /// One sentence for every curved shape that was replaced by polygons.
    pub tessellations: Vec<String>,
    pub exchange: ExchangeSummary,
    pub laws: LawsMeasured,
    /// Every way of closing T, the one in use first.
    pub repairs: Vec<RepairRun>,
    /// Name of the solver whose answer is the discrete truth below.
    pub reference_solver: String,
    pub solvers: Vec<SolverRun>,
    /// ⟨W, L⟩ and ⟨E, J⟩ of one sensor, by the reference; every run of `solvers` has its own difference of the two.
    pub duality: Duality,
    /// The same scene at other albedos; absent where none were asked for.
    pub albedos: Option<AlbedoStudy>,
    /// Truncated Neumann series after 0, 1, 2, … bounces, against the discrete truth.
    pub truncation: Vec<Truncation>,
    pub estimators: Vec<EstimatorRun>,
    /// Where it was asked for.
    pub sequential: Option<SequentialRun>,
    pub refinement: Refinement,
    /// Wall seconds by stage, in order.
    pub stages: Vec<(String, f64)>,
    #[serde(skip)]
    pub pictures: Option<Pictures>,
}

/// How the exchange T came about, and how good it was before its repair.
#[derive(Clone, Debug, Serialize)]
pub struct ExchangeSummary {
    /// Pairs of patches, facing each other or not, that whole clusters settled at once.
    pub n_by_clusters: usize,
    /// Pairs of patches facing each other.
    pub n_pairs: usize,
    /// Of these: computed by quadrature alone, no ray needed.
    pub n_unoccluded: usize,
    /// Of these: what is blocked integrated exactly.
    pub n_integrated: usize,
    /// Of these: visibility sampled by rays.
    pub n_sampled: usize,
    /// Of these: proved hidden.
    pub n_hidden: usize,
    /// Worst quadrature error estimate over all pairs, relative to the pair's T.
    pub quadrature_error: f64,
    /// Root mean square over bundles of the error of a row sum that partly visible pairs leave, relative to μ.
    pub visibility_error: f64,
    /// max |Σⱼ Tᵢⱼ + sinksᵢ − μᵢ| / μᵢ before the symmetric repair.
    pub closure_before_repair: f64,
    /// Sweeps of symmetric (Sinkhorn) scaling.
    pub repair_sweeps: usize,
    /// max |Lrepaired − Lraw| / max |L|, what the repair changed; NaN where the unrepaired matrix creates light.
    pub repair_change: f64,
    /// Fraction of all étendue that ends in the environment.
    pub escaped: f64,
}

/// Worst relative violation of each law in the assembled matrices; 0 is perfect.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LawsMeasured {
    pub reciprocity: f64,
    pub closure: f64,
    pub positivity: f64,
    pub conservation: f64,
}

/// One way of closing T, and what it does to the laws and to the answer.
#[derive(Clone, Debug, Serialize)]
pub struct RepairRun {
    pub method: String,
    /// Sweeps over T, or steps of conjugate gradients.
    pub sweeps: usize,
    pub laws: LawsMeasured,
    /// max |L − Lraw| / max |L|; NaN where the unrepaired matrix creates light.
    pub change: f64,
    /// max |L − Lused| / max |L|, from the answer of the repair in use.
    pub from_reference: f64,
}

/// One deterministic method.
#[derive(Clone, Debug, Serialize)]
pub struct SolverRun {
    pub solver: String,
    /// "direct" or "iterative".
    pub kind: String,
    pub family: Family,
    /// Why it stopped, as one word: "direct", "converged", "budget", "stagnated", "refused".
    pub stop: String,
    /// What it said where it refused the equation; its other numbers are not numbers then.
    pub refusal: Option<String>,
    pub n_applies: usize,
    pub n_adjoint_applies: usize,
    /// Work in units of one product with K (entries touched / entries of K): Gauss–Seidel and Southwell touch entries, not products.
    pub products: f64,
    pub seconds: f64,
    /// ‖E + K L − L‖∞ / ‖E‖∞, recomputed from the answer.
    pub true_residual: f64,
    /// ‖L − L_ref‖∞ / ‖L_ref‖∞ against the discrete truth.
    pub error: f64,
    /// A bound on ‖L − (I − K)⁻¹E‖∞ / ‖L‖∞ that trusts no solver; `None` where the absorption is too small for one.
    pub error_bound: Option<f64>,
    /// Importance by the same method; absent where it refused either equation.
    pub adjoint: Option<AdjointRun>,
    /// Empty for direct methods.
    pub history: Vec<HistoryPoint>,
}

/// What a method rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// Factors of I − K.
    Direct,
    /// Sweeps and fixed polynomials.
    Stationary,
    /// The best of all polynomials.
    Krylov,
    /// A coarse space, or factors of something near I − K.
    Accelerated,
}

/// One method on the adjoint equation J = W + K* J.
#[derive(Clone, Debug, Serialize)]
pub struct AdjointRun {
    pub stop: String,
    pub products: f64,
    pub seconds: f64,
    /// |⟨W, L⟩ − ⟨E, J⟩| / |⟨W, L⟩| of this method's own L and J, the worst band.
    pub difference: f64,
}

/// One iteration.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct HistoryPoint {
    /// Work so far, in products with K.
    pub products: f64,
    /// Wall seconds so far, those of looking at the iterates not counted.
    pub seconds: f64,
    /// ‖E + K L − L‖∞ / ‖E‖∞.
    pub residual: f64,
    /// ‖L − L_ref‖∞ / ‖L_ref‖∞.
    pub error: f64,
    /// The same as the spectrum of K foretold it; absent where no theory of the method is at hand.
    pub predicted: Option<f64>,
}

/// One scene with all that reflects at one albedo after another, by every method.
#[derive(Clone, Debug, Serialize)]
pub struct AlbedoStudy {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// Products after which a method is stopped.
    pub budget: f64,
    /// The method without subtraction whose answers are the truth.
    pub reference_solver: String,
    /// Darkest first.
    pub levels: Vec<AlbedoLevel>,
}

/// Every surface that is not black at one albedo.
#[derive(Clone, Debug, Serialize)]
pub struct AlbedoLevel {
    pub albedo: f64,
    /// Without histories.
    pub runs: Vec<SolverRun>,
}

/// The Neumann series cut after `bounces` bounces.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Truncation {
    pub bounces: usize,
    /// ‖L − Σ_{k ≤ bounces} KᵏE‖∞ / ‖L‖∞.
    pub error: f64,
    /// The bound ‖K^{bounces+1} E‖∞ / (1 − ‖K‖∞) / ‖L‖∞, known without L but for the scale.
    pub bound: f64,
}

/// One random method at growing sample counts.
#[derive(Clone, Debug, Serialize)]
pub struct EstimatorRun {
    pub estimator: String,
    pub approach: Approach,
    /// "discrete" for walks on the matrix, "continuous" for light paths: which truth it estimates.
    pub truth: String,
    /// What it said where it refused the scene; its other numbers are not numbers then.
    pub refusal: Option<String>,
    pub points: Vec<SamplePoint>,
    /// Largest difference from the discrete solution over its own standard error, at the largest sample count, over bundles pooled until each
    /// comparison is normal.
    pub worst_z: f64,
    /// Of the t that `worst_z` is where the error bars rest on few batches; absent where it is normal.
    pub n_degrees_of_freedom: Option<f64>,
    /// How many z-scores were looked at; 0 where the samples are too few for any.
    pub n_comparisons: usize,
    /// Probability of a |z| this large somewhere, were the two equal (Šidák-corrected).
    pub p_value: f64,
    /// Fitted slope of log error against log samples; −1/2 is Monte Carlo.
    pub slope: f64,
    /// Fitted slope of log error against log seconds.
    pub seconds_slope: f64,
    /// 1 / (relative variance × seconds), s⁻¹, at the largest sample count.
    pub efficiency: f64,
    /// Samples a bundle for a relative standard error of 1 %: as predicted where it was, else from what was measured.
    pub samples_for_percent: f64,
    /// Measured variance against the predicted one; absent where none was predicted or the samples are too few to tell.
    pub variance: Option<VarianceAgreement>,
    /// Why the variance of a walk was not predicted.
    pub prediction_refusal: Option<String>,
    /// Of continuous methods: how far from the matrix, and whether by what the mesh leaves.
    pub mesh: Option<MeshAgreement>,
    /// Drawing samples, prediction and comparison not counted.
    pub seconds: f64,
}

/// An estimator's error at one sample count.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SamplePoint {
    pub samples_per_bundle: u64,
    /// Étendue-weighted root mean square difference from the discrete truth, relative to its root mean square.
    pub error: f64,
    /// The same, as the estimator's own measured standard errors have it.
    pub standard_error: f64,
    /// The same, as the linear system of its variance foretold before any sample was drawn.
    pub predicted: Option<f64>,
    /// Steps of walks, or rays, so far.
    pub steps: u64,
    /// Wall seconds of drawing so far.
    pub seconds: f64,
}

/// The étendue-weighted mean variance of a sample, over the predicted one.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct VarianceAgreement {
    pub ratio: f64,
    /// Of the ratio, were the prediction true.
    pub standard_error: f64,
    /// Probability of a ratio at least this far out.
    pub p_value: f64,
}

/// A continuous method against the finest matrix, by surfaces' mean reflected radiance.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MeshAgreement {
    /// Area-weighted root mean square difference, relative, as in [`Refinement`].
    pub difference: f64,
    /// Its statistical part.
    pub noise: f64,
    /// True if every surface's mean that can be compared, at least one, differs by the discretisation error that the refinement estimates,
    /// within statistical error. False where there is one mesh only.
    pub agrees: bool,
    /// Largest |t| of the difference from the reference path tracer's means, which knows no mesh either; absent for that one, and for points
    /// on emitters alone, whose variance need not exist.
    pub worst_t: Option<f64>,
    /// Probability of one so large, were the two equal (Šidák-corrected).
    pub p_value: Option<f64>,
}

/// Sequential Monte Carlo: its answer is corrected stage by stage, and its error falls exponentially.
#[derive(Clone, Debug, Serialize)]
pub struct SequentialRun {
    pub estimator: String,
    pub refusal: Option<String>,
    /// Walks a bundle and stage.
    pub n_walks: u64,
    /// Why it stopped, as one word: "converged", "budget", "stalled", "refused".
    pub stop: String,
    pub stages: Vec<SequentialPoint>,
    /// What a stage multiplies the error by: fitted until rounding. NaN for fewer than two stages.
    pub factor: f64,
    pub seconds: f64,
}

/// After one stage.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SequentialPoint {
    pub products: usize,
    /// Steps of walks so far.
    pub steps: u64,
    pub seconds: f64,
    /// ‖E + K L − L‖∞ / ‖E‖∞.
    pub residual: f64,
    /// Étendue-weighted root mean square difference from the discrete truth, relative to its root mean square.
    pub error: f64,
}

/// The same scene at finer and finer patches, held against the path tracer's continuous truth.
#[derive(Clone, Debug, Serialize)]
pub struct Refinement {
    /// Coarsest first.
    pub levels: Vec<RefinementLevel>,
    /// Observed order p of error ~ patch_size^p, fitted over the levels.
    pub observed_order: f64,
    /// Standard error of the order.
    pub order_standard_error: f64,
    /// Discretisation error of the finest level's mean reflected radiance, relative: the larger of what the levels extrapolate to
    /// and what was measured beyond noise. NaN where there is one mesh only.
    pub finest_error: f64,
    /// True if every surface's mean at the finest level that can be compared, at least one, agrees with the path tracer within
    /// discretisation plus statistical error.
    pub agrees: bool,
    pub surfaces: Vec<SurfaceMean>,
}

#[derive(Clone, Debug, Serialize)]
pub struct RefinementLevel {
    pub patch_size: f64,
    pub n_bundles: usize,
    /// Area-weighted root mean square difference of the surfaces' mean reflected radiance from the path tracer's, relative.
    pub error: f64,
    /// The statistical part of `error`: what the path tracer's own noise contributes.
    pub noise: f64,
}

/// One surface and band at the finest level.
#[derive(Clone, Debug, Serialize)]
pub struct SurfaceMean {
    pub surface: String,
    pub band: String,
    /// Mean outgoing radiance from the matrix.
    pub matrix: f64,
    /// Mean outgoing radiance from the path tracer.
    pub path_tracer: f64,
    pub standard_error: f64,
    /// Estimated discretisation error of `matrix`.
    pub discretisation_error: f64,
    /// False where so few paths have found light that their mean and its standard error mean nothing.
    pub is_comparable: bool,
}

/// The solved scene from its camera, linear radiance.
#[derive(Clone, Debug)]
pub struct Pictures {
    pub solved: Image,
    /// After 0, 1, 2, … bounces, cumulative: entry k is E + … + KᵏE.
    pub bounces: Vec<Image>,
}
