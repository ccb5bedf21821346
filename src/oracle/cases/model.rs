//! A case's surfaces as a scene, and everything that is read off its assembled system: surface by surface, as cases state it.
//!
//! Cases speak of radiosity B = π L, exitance E and irradiance H, one number a surface; the system of bundles.

use super::error::CaseError;
use crate::assembly::{Exchange, Occlusion, Orbits, System, assemble, assemble_orbits, point_factors};
use crate::basis::{Bundles, Resolution};
use crate::geometry::{Affine3, Polygon, Vec3};
use crate::linalg::{Block, LinearOperator};
use crate::scattering::Lambert;
use crate::scene::{Scene, SceneDescription, Surface};
use crate::solver::{Lu, Solver};
use std::f64::consts::PI;
use std::sync::Arc;

/// No edge is longer: every polygon is one patch (a fan of triangles where it has five corners or more).
pub const WHOLE: f64 = 1e300;

/// Absolute error asked for of the form factors of partly visible pairs, where polygons are the geometry itself.
pub const EXACT: f64 = 1e-13;

/// One surface of a case: one-sided, diffuse, grey.
#[derive(Clone, Debug)]
pub struct Body {
    pub polygons: Vec<Polygon>,
    pub albedo: f64,
    /// Exitance E that the front emits, W m⁻².
    pub exitance: f64,
    /// False where it only stands in the way.
    pub exchanges: bool,
}

/// Bodies, isometries that may map them onto themselves, and steps that may carry their patches into others: what is the same all around is
/// computed once, and so is what is the same all along.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    pub bodies: Vec<Body>,
    pub symmetries: Vec<Affine3>,
    pub steps: Vec<Vec3>,
}

/// A point of a surface where radiosity is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    pub surface: usize,
    pub point: Vec3,
    pub normal: Vec3,
}

/// A scene, cut and assembled. Its unknowns are bundles, or orbits of them.
pub struct Model {
    scene: Scene,
    bundles: Bundles,
    pub system: System,
    /// Unknown of every bundle.
    unknown_of: Vec<Option<usize>>,
    /// Surface of every unknown.
    surface_of: Vec<usize>,
    areas: Vec<f64>,
    /// Absolute error of the sum of a row of form factors, the worst unknown's; `None` where it was not summed.
    row_error: Option<f64>,
}

impl Body {
    /// Black and cold: what form factors need.
    pub fn black(polygons: Vec<Polygon>) -> Self {
        Self { polygons, albedo: 0.0, exitance: 0.0, exchanges: true }
    }

    /// What only stands in the way of others.
    pub fn occluder(polygons: Vec<Polygon>) -> Self {
        Self { exchanges: false, ..Self::black(polygons) }
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
        repair: walls == Walls::Closed,
        ..Exchange::default()
    }
}

/// The scene of some bodies, and its bundles. A scene must emit: where no body does, the first one emits 1.
fn cut(mut bodies: Vec<Body>, patch_size: f64) -> Result<(Scene, Bundles), CaseError> {
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
    let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 })?;
    Ok((scene, bundles))
}

fn surface_of(scene: &Scene, bundles: &Bundles, bundle: usize) -> usize {
    let patch = bundles.patch(bundles.element_of(bundle).0);
    patch.map_or(0, |patch| scene.facets()[patch.facet].surface)
}

impl Model {
    /// Builds the scene, cuts it and assembles it in full, form factors of partly visible pairs to the absolute error `occluded`.
    ///
    /// # Errors
    /// What scenes, bases and assembly refuse.
    pub fn new(bodies: Vec<Body>, walls: Walls, occluded: f64) -> Result<Self, CaseError> {
        let (scene, bundles) = cut(bodies, WHOLE)?;
        let system = assemble(&scene, &bundles, settings(walls, occluded))?;
        let surface_of = (0..bundles.n_bundles()).map(|bundle| surface_of(&scene, &bundles, bundle)).collect();
        let unknown_of = (0..bundles.n_bundles()).map(Some).collect();
        let areas = scene.surfaces().iter().map(Surface::area).collect();
        Ok(Self { scene, bundles, system, unknown_of, surface_of, areas, row_error: None })
    }

    /// The same with an unknown for all that is alike, in patches of this size, and with the exchange of those surfaces only that are `wanted`,
    /// named either way round. Rows of form factors have an absolute error of `accuracy` or some of it.
    ///
    /// # Errors
    /// What scenes, bases and assembly refuse.
    pub fn folded(
        shape: Shape,
        patch_size: f64,
        wanted: impl Fn(usize, usize) -> bool + Sync,
        accuracy: f64,
    ) -> Result<Self, CaseError> {
        let exchanges: Vec<bool> = shape.bodies.iter().map(|body| body.exchanges).collect();
        let (scene, bundles) = cut(shape.bodies, patch_size)?;
        let orbits = Orbits::new(&scene, &bundles, |surface| exchanges[surface], &shape.symmetries);
        let orbits = orbits.in_rows(&scene, &bundles, &shape.steps);
        let settings = Exchange {
            tolerance: 1e-3 * accuracy,
            occlusion: Occlusion::Exact { tolerance: accuracy },
            repair: false,
            ..Exchange::default()
        };
        let (system, errors) = assemble_orbits(&scene, &bundles, &orbits, &wanted, settings)?;
        let surface_of = (0..orbits.n_orbits()).map(|k| surface_of(&scene, &bundles, orbits.members(k)[0])).collect();
        let unknown_of = (0..bundles.n_bundles()).map(|bundle| orbits.orbit_of(bundle)).collect();
        let areas = scene.surfaces().iter().map(Surface::area).collect();
        let row_error = errors.iter().zip(system.etendue()).map(|(error, mu)| error / mu).fold(0.0, f64::max);
        Ok(Self { scene, bundles, system, unknown_of, surface_of, areas, row_error: Some(row_error) })
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

    /// Absolute error of form factors between surfaces: of a row's sum where that is known.
    pub fn noise(&self) -> f64 {
        self.row_error.unwrap_or_else(|| self.form_factor_error())
    }

    /// Absolute error of radiosities: an error δ of the rows of F changes B = E + albedo F B by at most δ max B / (1 − max albedo).
    pub fn radiosity_noise(&self, radiance: &Block) -> f64 {
        let albedo = self.system.transport().scattering().values().max_abs();
        self.noise() * PI * radiance.max_abs() / (1.0 - albedo).max(f64::EPSILON)
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
            let radiance = |bundle: usize| self.unknown_of[bundle].map_or(0.0, |unknown| radiance.get(unknown, 0));
            let incident: f64 = factors.iter().enumerate().map(|(k, factor)| factor * PI * radiance(k)).sum();
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
