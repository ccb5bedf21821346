//! The assembled equation of one scene at one resolution.

use super::exchange::{self, Exchange, ExchangeReport, RepairMethod};
use super::operators::AdjointTransport;
use super::{Laws, Orbits, Propagation, Transport};
use crate::basis::{Bundles, Element};
use crate::linalg::{Aggregation, Block, Diagonal, Equation, Hierarchy, LinearOperator, Matrix, SelfAdjoint, Unknown};
use crate::scene::Scene;
use std::f64::consts::PI;
use std::sync::Arc;
use thiserror::Error;

/// Everything that L = E + K L is made of. Immutable.
#[derive(Clone, Debug)]
pub struct System {
    exchange: Arc<Matrix>,
    exchange_error: Arc<Matrix>,
    etendue: Arc<[f64]>,
    sinks: Block,
    emission: Block,
    /// 1 − Σⱼ Kᵢⱼ of a closed system, by what is absorbed and what is lost.
    absorption: Option<Block>,
    transport: Transport,
    scattering_root: Diagonal,
    repair_scale: Vec<f64>,
    is_self_adjoint: bool,
    hierarchy: Arc<Hierarchy>,
    report: ExchangeReport,
}

/// Why a scene cannot be assembled in this basis.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum AssemblyError {
    #[error("surface '{surface}' is not diffuse ({brdf}): one bin of directions cannot hold it")]
    NotDiffuse { surface: String, brdf: String },
    #[error(
        "surface '{surface}' exchanges {fullness:.2} times its étendue near ({:.4}, {:.4}, {:.4}): another surface lies in its plane, \
         faces the same way and overlaps it\n  = move one of the two off the plane, or cut the hole out",
        .position[0], .position[1], .position[2]
    )]
    Overlap { surface: String, position: [f64; 3], fullness: f64 },
    #[error("element {element} is not a patch: media and emitting environments are not assembled in a surface basis")]
    NotAPatch { element: usize },
}

/// T, S, E of a scene. Cost O(n²) exchanges; memory [`System::memory_estimate`].
///
/// # Errors
/// A surface that the basis cannot represent.
pub fn assemble(scene: &Scene, bundles: &Bundles, settings: Exchange) -> Result<System, AssemblyError> {
    assemble_watched(scene, bundles, settings, &|_| ())
}

/// [`assemble`], telling `progress` the finished share in [0, 1], from any thread.
pub fn assemble_watched(
    scene: &Scene,
    bundles: &Bundles,
    settings: Exchange,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<System, AssemblyError> {
    let (albedo, emission) = materials(scene, bundles)?;
    let computed = exchange::compute(scene, bundles, settings, progress);
    let computed = computed.map_err(|exchange::Overfull { bundle, fullness }| {
        let patch = bundles.patch(bundles.element_of(bundle).0);
        let (surface, position) = patch.map_or((String::new(), [f64::NAN; 3]), |patch| {
            (scene.surface_of(patch.facet).name.clone(), patch.polygon.centroid().to_array())
        });
        AssemblyError::Overlap { surface, position, fullness }
    })?;
    let hierarchy = bundles.hierarchy(scene);
    Ok(System::new(albedo, emission, bundles.etendue().into(), hierarchy, computed))
}

/// [`assemble`] on orbits: an unknown for every orbit of bundles, and only the exchange of surfaces i and j where `wanted(i, j)` or
/// `wanted(j, i)`. Also the absolute error of the sum of every row of T, as estimated, m² sr.
///
/// Nothing is counted that leaves the scene, and closure is not repaired. Cost: one row of pairs an orbit.
///
/// # Errors
/// A surface that the basis cannot represent.
pub fn assemble_orbits(
    scene: &Scene,
    bundles: &Bundles,
    orbits: &Orbits,
    wanted: &(dyn Fn(usize, usize) -> bool + Sync),
    settings: Exchange,
) -> Result<(System, Vec<f64>), AssemblyError> {
    let (albedo, emission) = materials(scene, bundles)?;
    let (computed, error) = exchange::folded(scene, bundles, orbits, wanted, settings);
    let n = orbits.n_orbits();
    let fold = |block: &Block| Block::from_fn(n, block.n_columns(), |i, band| block.get(orbits.members(i)[0], band));
    let etendue = (0..n).map(|i| orbits.members(i).iter().map(|k| bundles.etendue()[*k]).sum()).collect();
    let hierarchy = Hierarchy::new([Aggregation::whole(n)]);
    Ok((System::new(fold(&albedo), fold(&emission), etendue, hierarchy, computed), error))
}

/// Albedo and emission of every bundle, n × bands each.
fn materials(scene: &Scene, bundles: &Bundles) -> Result<(Block, Block), AssemblyError> {
    let (n, n_bands) = (bundles.n_bundles(), scene.n_bands());
    let mut albedo = Block::zeros(n, n_bands);
    let mut emission = Block::zeros(n, n_bands);
    for (e, element) in bundles.elements().iter().enumerate() {
        let Element::Patch(patch) = element else { return Err(AssemblyError::NotAPatch { element: e }) };
        let surface = scene.surface_of(patch.facet);
        let Some(brdf) = surface.brdf(patch.side) else { continue };
        let Some(albedos) = brdf.lambertian() else {
            return Err(AssemblyError::NotDiffuse { surface: surface.name.clone(), brdf: brdf.description() });
        };
        for i in bundles.bundles_of(e) {
            for (band, a) in albedos.iter().enumerate() {
                albedo.set(i, band, *a);
                emission.set(i, band, surface.emitted(patch.side, band));
            }
        }
    }
    Ok((albedo, emission))
}

impl System {
    fn new(
        albedo: Block,
        emission: Block,
        etendue: Arc<[f64]>,
        hierarchy: Hierarchy,
        computed: exchange::Assembled,
    ) -> Self {
        let exchange::Assembled { exchange, error, sinks, repair_scale, report } = computed;
        let exchange = Arc::new(exchange);
        let root = Block::from_fn(albedo.n_rows(), albedo.n_columns(), |i, band| albedo.get(i, band).sqrt());
        let propagation = Propagation::new(exchange.clone(), etendue.clone());
        let is_closed = report.repair.is_some();
        let absorption = is_closed.then(|| absorption(&albedo, &sinks, &etendue));
        Self {
            exchange,
            exchange_error: Arc::new(error),
            etendue,
            sinks,
            emission,
            absorption,
            transport: Transport::new(Diagonal::new(albedo), propagation),
            scattering_root: Diagonal::new(root),
            repair_scale,
            is_self_adjoint: true,
            hierarchy: Arc::new(hierarchy),
            report,
        }
    }

    /// Bytes that assembly may take for n bundles, none of them hidden from another: T and its errors in full, the list of the upper
    /// triangle at 24 an entry and a third more for growing it, and the points of the quadrature, some 6000 a patch.
    pub fn memory_estimate(n_bundles: usize) -> u64 {
        let n = n_bundles as u64;
        n.saturating_mul(n).saturating_mul(8 + 8 + 12 + 4).saturating_add(n.saturating_mul(8192))
    }

    pub fn n_bundles(&self) -> usize {
        self.etendue.len()
    }

    pub fn n_bands(&self) -> usize {
        self.emission.n_columns()
    }

    /// T, m² sr.
    pub fn exchange(&self) -> &Matrix {
        &self.exchange
    }

    /// Absolute error of every Tᵢⱼ before repair, m² sr: the estimate where a partly visible pair was integrated, a standard error
    /// where it was sampled, zero where nothing stands between (see [`ExchangeReport::quadrature_error`] for those).
    pub fn exchange_error(&self) -> &Matrix {
        &self.exchange_error
    }

    /// μ, m² sr.
    pub fn etendue(&self) -> &[f64] {
        &self.etendue
    }

    /// n × 2: étendue that escapes into the environment, and that ends on black backs, m² sr.
    pub fn sinks(&self) -> &Block {
        &self.sinks
    }

    /// E, n × bands.
    pub fn emission(&self) -> &Block {
        &self.emission
    }

    /// Bundles gathered by where they are, finest groups first; see [`Bundles::hierarchy`].
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// K = S G, unformed; S and G are its parts.
    pub fn transport(&self) -> &Transport {
        &self.transport
    }

    /// How T was computed.
    pub fn report(&self) -> &ExchangeReport {
        &self.report
    }

    /// The same system with the closure repair undone: T ← D⁻¹ T D⁻¹. Copies T.
    pub fn without_repair(&self) -> Self {
        let inverse: Vec<f64> = self.repair_scale.iter().map(|d| 1.0 / d).collect();
        if inverse.is_empty() {
            return self.clone();
        }
        let mut exchange = (*self.exchange).clone();
        exchange.map_entries(|r, c, t| t * (inverse[r] * inverse[c]));
        let exchange = Arc::new(exchange);
        let propagation = Propagation::new(exchange.clone(), self.etendue.clone());
        let sinks = Block::from_fn(self.n_bundles(), 2, |i, sink| self.sinks.get(i, sink) * inverse[i]);
        Self {
            exchange,
            sinks,
            transport: Transport::new(self.transport.scattering().clone(), propagation),
            absorption: None,
            repair_scale: Vec::new(),
            report: ExchangeReport { repair: None, ..self.report },
            ..self.clone()
        }
    }

    /// The same scene with other albedos, n × bands in [0, 1], and the same T. Bundles keep their emission. Cost O(n): T is shared.
    ///
    /// # Panics
    /// If the albedos have another shape than the emission.
    pub fn with_albedo(&self, albedo: Block) -> Self {
        assert_eq!((albedo.n_rows(), albedo.n_columns()), (self.n_bundles(), self.n_bands()));
        let absorption = self.absorption.as_ref().map(|_| absorption(&albedo, &self.sinks, &self.etendue));
        let root = Block::from_fn(albedo.n_rows(), albedo.n_columns(), |i, band| albedo.get(i, band).sqrt());
        Self {
            absorption,
            transport: Transport::new(Diagonal::new(albedo), self.transport.propagation().clone()),
            scattering_root: Diagonal::new(root),
            ..self.clone()
        }
    }

    /// The unrepaired system closed by another method, and the sweeps it took. A system closed by rows is not self-adjoint. Copies T.
    pub fn repaired_by(&self, method: RepairMethod) -> (Self, usize) {
        let raw = self.without_repair();
        let (mut exchange, mut sinks) = ((*raw.exchange).clone(), raw.sinks.clone());
        let sweeps = exchange::repair_by(method, &mut exchange, &mut sinks, &raw.etendue);
        let exchange = Arc::new(exchange);
        // G of scaled rows is M⁻¹ D T: the T that is still symmetric over its own row sums.
        let propagation = match method {
            RepairMethod::Rows => {
                Propagation::new(raw.exchange.clone(), exchange::row_totals(&raw.exchange, &raw.sinks).into())
            }
            _ => Propagation::new(exchange.clone(), self.etendue.clone()),
        };
        let transport = Transport::new(self.transport.scattering().clone(), propagation);
        let is_self_adjoint = method != RepairMethod::Rows;
        (Self { exchange, sinks, transport, is_self_adjoint, ..raw }, sweeps)
    }

    /// The four laws, as they hold in the matrices. Cost O(entries).
    pub fn laws(&self) -> Laws {
        Laws::measure(self)
    }

    /// What a solver of radiance sees.
    pub fn equation(&self) -> Equation<'_> {
        Equation {
            transport: &self.transport,
            emission: &self.emission,
            absorption: self.absorption.as_ref(),
            self_adjoint: self.self_adjoint(Unknown::Radiance),
            hierarchy: Some(&self.hierarchy),
        }
    }

    /// The adjoint, whose solution is importance. One product.
    pub fn adjoint(&self) -> AdjointSystem<'_> {
        // What G S loses of a row: what the rows of G lose, and what is absorbed where they end.
        let absorption = self.absorption.as_ref().map(|_| {
            let albedo = self.transport.scattering().values();
            let absorbed = Block::from_fn(self.n_bundles(), self.n_bands(), |i, band| 1.0 - albedo.get(i, band));
            let mut absorption = Block::zeros(self.n_bundles(), self.n_bands());
            self.transport.propagation().apply(&absorbed, &mut absorption);
            for band in 0..self.n_bands() {
                let losses = (0..self.n_bundles()).map(|i| self.sinks.row(i).sum::<f64>() / self.etendue[i]);
                absorption.column_mut(band).iter_mut().zip(losses).for_each(|(a, lost)| *a += lost);
            }
            absorption
        });
        AdjointSystem { system: self, transport: AdjointTransport::new(self.transport.clone()), absorption }
    }

    fn self_adjoint(&self, unknown: Unknown) -> Option<SelfAdjoint<'_>> {
        self.is_self_adjoint.then(|| SelfAdjoint {
            etendue: &self.etendue,
            propagation: self.transport.propagation(),
            scattering_root: &self.scattering_root,
            unknown,
        })
    }

    /// Incident irradiance of every bundle from solved radiance, W m⁻²: H = π G L in the one bin of a hemisphere.
    pub fn irradiance(&self, radiance: &Block) -> Block {
        let mut incident = Block::zeros(radiance.n_rows(), radiance.n_columns());
        self.transport.propagation().apply(radiance, &mut incident);
        incident.values_mut().iter_mut().for_each(|v| *v *= PI);
        incident
    }
}

/// 1 − Σⱼ Kᵢⱼ of a closed system, n × bands: what is absorbed, and what of the rest is lost.
fn absorption(albedo: &Block, sinks: &Block, etendue: &[f64]) -> Block {
    Block::from_fn(albedo.n_rows(), albedo.n_columns(), |i, band| {
        let a = albedo.get(i, band);
        (1.0 - a) + a * (sinks.row(i).sum::<f64>() / etendue[i])
    })
}

/// A system looked at from the sensors: J = W + K* J with K* = G S.
pub struct AdjointSystem<'a> {
    system: &'a System,
    transport: AdjointTransport,
    absorption: Option<Block>,
}

impl AdjointSystem<'_> {
    /// What a solver of importance sees, for W as coefficients of radiance, n × bands: ⟨W, L⟩ = ⟨E, J⟩ in the étendue inner product.
    pub fn equation<'b>(&'b self, measurement: &'b Block) -> Equation<'b> {
        Equation {
            transport: &self.transport,
            emission: measurement,
            absorption: self.absorption.as_ref(),
            self_adjoint: self.system.self_adjoint(Unknown::Importance),
            hierarchy: Some(&self.system.hierarchy),
        }
    }
}
