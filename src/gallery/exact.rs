//! What is known about a scene's answer, and about which of the two truths.

use crate::scene::Scene;
use std::f64::consts::PI;

/// A known answer. *Discrete* truth is (I − K)⁻¹E of an assembled K, *continuous* truth is the scene's own.
#[derive(Clone, Debug, PartialEq)]
pub enum Exact {
    /// Every bundle has this radiance, one value a band. Discrete on any mesh whose K obeys closure, and continuous.
    Uniform { radiance: Vec<f64> },
    /// Σ (1 − albedo) × irradiance × area over all sides equals this, W in each band. Discrete on any mesh whose K
    /// obeys closure, and continuous. One number a band: it shows that no light was lost, and nothing about where
    /// it went.
    AbsorbedPower { power: Vec<f64> },
    /// Values of the continuous truth, which the discrete one approaches under refinement.
    Continuous(Continuous),
}

/// Outgoing radiance of the continuous scene, wherever it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Continuous {
    /// Values at points.
    pub points: Vec<PointRadiance>,
    /// Area means over whole surfaces.
    pub means: Vec<MeanRadiance>,
    /// Area means of the *discrete* truth on n × n equal patches a polygon, with exact form factors; may be empty.
    pub uniform_patches: Vec<UniformPatches>,
    /// Bound on the relative error of the numbers above, for the shapes they were derived for.
    pub relative_uncertainty: f64,
    /// First-order estimate of the relative change that comes from polygons standing for a curved shape; 0 where the
    /// scene's polygons are the shape itself. Refining patches does not reduce it, refining the tessellation does.
    pub tessellation_error: f64,
}

/// Outgoing radiance at a point of a front.
#[derive(Clone, Debug, PartialEq)]
pub struct PointRadiance {
    pub surface: &'static str,
    /// A point of one of the surface's polygons.
    pub position: [f64; 3],
    /// W m⁻² sr⁻¹, one value a band.
    pub radiance: Vec<f64>,
}

/// Area mean of the outgoing radiance of a front.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanRadiance {
    pub surface: &'static str,
    /// W m⁻² sr⁻¹, one value a band.
    pub radiance: Vec<f64>,
}

/// Means of the discrete truth on one uniform mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct UniformPatches {
    /// Every quadrilateral is cut into n_per_side × n_per_side equal patches.
    pub n_per_side: usize,
    pub means: Vec<MeanRadiance>,
}

impl Exact {
    /// True where the answer holds for the discrete system on any mesh, to rounding; false where it is a limit.
    pub fn holds_on_any_mesh(&self) -> bool {
        match self {
            Exact::Uniform { .. } | Exact::AbsorbedPower { .. } => true,
            Exact::Continuous(_) => false,
        }
    }
}

/// Power that leaves all emitters: Φ = Σ π × emitted radiance × area, W, one value a band. O(polygons).
pub fn emitted_power(scene: &Scene) -> Vec<f64> {
    let power_of = |band: usize| scene.surfaces().iter().map(move |s| PI * s.emission[band] * s.area()).sum();
    (0..scene.n_bands()).map(power_of).collect()
}
