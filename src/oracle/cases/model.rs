//! A case's surfaces as a scene, and everything that is read off its assembled system: surface by surface, as cases state it.
//!
//! Cases speak of radiosity B = π L, exitance E and irradiance H, one number a surface; the system of bundles.

use super::error::CaseError;
use crate::assembly::{Exchange, Occlusion, System, assemble, point_factors};
use crate::basis::{Bundles, Resolution};
use crate::geometry::{Polygon, Vec3};
use crate::linalg::{Block, LinearOperator};
use crate::scattering::Lambert;
use crate::scene::{Scene, SceneDescription, Surface};
use crate::solver::{Lu, Solver};
use std::f64::consts::PI;
use std::sync::Arc;

/// No edge is longer: every polygon is one patch (a fan of triangles where it has five corners or more).
const WHOLE: f64 = 1e300;

/// Absolute error asked for of the form factors of partly visible pairs, where polygons are the geometry itself.
pub const EXACT: f64 = 1e-13;

/// One surface of a case: one-sided, diffuse, grey.
#[derive(Clone, Debug)]
pub struct Body {
    pub polygons: Vec<Polygon>,
    pub albedo: f64,
    /// Exitance E that the front emits, W m⁻².
    pub exitance: f64,
}

/// A point of a surface where radiosity is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    pub surface: usize,
    pub point: Vec3,
    pub normal: Vec3,
}

/// A scene, cut and assembled.
pub struct Model {
    scene: Scene,
    bundles: Bundles,
    pub system: System,
    /// Surface of every bundle.
    surface_of: Vec<usize>,
    areas: Vec<f64>,
}

impl Body {
    /// Black and cold: what form factors need.
    pub fn black(polygons: Vec<Polygon>) -> Self {
        Self { polygons, albedo: 0.0, exitance: 0.0 }
    }
}

/// Whether a scene lets light out. In closed ones the exchange is closed by symmetric scaling, which takes rounding out of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Walls {
    Open,
    Closed,
}

/// Accuracy of every exchange a case asks for: what exact polygons can reach.
fn settings(walls: Walls, occluded: f64) -> Exchange {
    Exchange {
        tolerance: 1e-14,
        occlusion: Occlusion::Exact { tolerance: occluded },
        // What escapes is not asked for: one ray a patch is the least there can be.
        sink_rays: 1,
        repair: walls == Walls::Closed,
        ..Exchange::default()
    }
}

impl Model {
    /// Builds the scene, cuts it and assembles it, form factors of partly visible pairs to the absolute error `occluded`. A scene must emit: where no body does, the first one emits 1.
    ///
    /// # Errors
    /// What scenes, bases and assembly refuse.
    pub fn new(mut bodies: Vec<Body>, walls: Walls, occluded: f64) -> Result<Self, CaseError> {
        if bodies.iter().all(|body| body.exitance == 0.0)
            && let Some(first) = bodies.first_mut()
        {
            first.exitance = 1.0;
        }
        let surfaces = bodies.into_iter().enumerate().map(|(k, body)| Surface {
            name: format!("surface-{k}"),
            polygons: body.polygons,
            front: Arc::new(Lambert::grey(body.albedo, 1)),
            back: None,
            emission: vec![body.exitance / PI],
            tessellation: None,
        });
        let description = SceneDescription {
            name: "case".to_string(),
            bands: vec!["grey".to_string()],
            surfaces: surfaces.collect(),
            camera: None,
        };
        let scene = Scene::new(description)?;
        let bundles = Bundles::new(&scene, Resolution { patch_size: WHOLE, n_directions: 1 })?;
        let system = assemble(&scene, &bundles, settings(walls, occluded))?;
        let surface = |bundle| {
            let patch = bundles.patch(bundles.element_of(bundle).0);
            patch.map_or(0, |patch| scene.facets()[patch.facet].surface)
        };
        let surface_of = (0..bundles.n_bundles()).map(surface).collect();
        let areas = scene.surfaces().iter().map(Surface::area).collect();
        Ok(Self { scene, bundles, system, surface_of, areas })
    }

    pub fn n_surfaces(&self) -> usize {
        self.scene.surfaces().len()
    }

    /// Area of every surface, m².
    pub fn areas(&self) -> &[f64] {
        &self.areas
    }

    /// Étendue that flows between every two surfaces, m² sr: T summed over their bundles.
    pub fn flows(&self) -> Vec<Vec<f64>> {
        let n = self.n_surfaces();
        let mut flows = vec![vec![0.0; n]; n];
        for i in 0..self.system.n_bundles() {
            let row = &mut flows[self.surface_of[i]];
            self.system.exchange().for_each_in_row(i, |j, t| row[self.surface_of[j]] += t);
        }
        flows
    }

    /// F_ij = T_ij / (π A_i), surface by surface.
    pub fn form_factors(&self) -> Vec<Vec<f64>> {
        let mut flows = self.flows();
        for (row, area) in flows.iter_mut().zip(&self.areas) {
            row.iter_mut().for_each(|flow| *flow /= PI * area);
        }
        flows
    }

    /// Absolute error of every form factor that the program itself estimates: quadrature, and three standard errors of what was
    /// not settled by geometry.
    pub fn form_factor_error(&self) -> f64 {
        let report = self.system.report();
        let quadrature = if report.quadrature_error.is_finite() { report.quadrature_error } else { 0.0 };
        let n = (self.system.n_bundles() as f64).sqrt();
        quadrature.max(f64::EPSILON) + 3.0 * n * report.visibility_error
    }

    /// Relative error of values that are extrapolated: what was estimated for partly visible pairs. Quadrature of the others is left
    /// out, its noise shows in the extrapolation itself.
    pub fn noise(&self) -> f64 {
        let n = (self.system.n_bundles() as f64).sqrt();
        64.0 * f64::EPSILON + 3.0 * n * self.system.report().visibility_error
    }

    /// True where something stands between some pair of patches.
    pub fn is_occluded(&self) -> bool {
        let report = self.system.report();
        report.n_clear < report.n_pairs
    }

    /// L of every bundle, W m⁻² sr⁻¹.
    ///
    /// # Errors
    /// A singular equation.
    pub fn radiance(&self) -> Result<Block, CaseError> {
        Ok(Lu.solve(self.system.equation(), &mut ())?.radiance)
    }

    /// Mean of a quantity over each surface, weighted by area.
    pub fn means(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.n_surfaces()];
        for ((value, mu), surface) in values.iter().zip(self.system.etendue()).zip(&self.surface_of) {
            sums[*surface] += value * mu;
        }
        sums.iter().zip(&self.areas).map(|(sum, area)| sum / (PI * area)).collect()
    }

    /// B = π L of every surface, its area mean.
    pub fn radiosity(&self, radiance: &Block) -> Vec<f64> {
        self.means(radiance.column(0)).iter().map(|mean| PI * mean).collect()
    }

    /// H of every surface, its area mean.
    pub fn irradiance(&self, radiance: &Block) -> Vec<f64> {
        self.means(self.system.irradiance(radiance).column(0))
    }

    /// B at points that face along these normals, from the solved field: E + albedo Σ F B (the Sloan iterate). Nothing may stand between.
    pub fn gathered(&self, radiance: &Block, at: &[Probe]) -> Vec<f64> {
        let value = |probe: &Probe| {
            let factors = point_factors(&self.bundles, probe.point, probe.normal);
            let incident: f64 = factors.iter().zip(radiance.column(0)).map(|(factor, l)| factor * PI * l).sum();
            let surface = &self.scene.surfaces()[probe.surface];
            let albedo = surface.front.lambertian().map_or(0.0, |albedos| albedos[0]);
            PI * surface.emission[0] + albedo * incident
        };
        at.iter().map(value).collect()
    }

    /// K x, for vectors of radiance.
    pub fn bounce(&self, x: &Block) -> Block {
        let mut y = Block::zeros(x.n_rows(), x.n_columns());
        self.system.transport().apply(x, &mut y);
        y
    }

    /// The largest eigenvalue of K by power iteration: K ≥ 0 has one that nothing exceeds. Right to rounding where the others are far
    /// smaller.
    pub fn spectral_radius(&self) -> f64 {
        let n = self.system.n_bundles();
        let mut x = Block::from_fn(n, 1, |_, _| 1.0);
        let mut radius = 0.0;
        for _ in 0..200 {
            let y = self.bounce(&x);
            let size = y.max_abs();
            if size == 0.0 {
                return 0.0;
            }
            let settled = (size - radius).abs() <= 1e-15 * size;
            radius = size;
            x = Block::from_fn(n, 1, |i, _| y.get(i, 0) / size);
            if settled {
                break;
            }
        }
        radius
    }

    /// E + K E + … + Kᵏ E as radiosity of every surface, for k = 0 … `last`.
    pub fn neumann_sums(&self, last: usize) -> Vec<Vec<f64>> {
        let mut term = self.system.emission().clone();
        let mut sum = term.clone();
        let mut sums = vec![self.radiosity(&sum)];
        for _ in 0..last {
            term = self.bounce(&term);
            sum.add_scaled(1.0, &term);
            sums.push(self.radiosity(&sum));
        }
        sums
    }
}
