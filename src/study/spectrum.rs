//! How fast light dies away in a scene: the spectrum of its K, and the bounces that this asks for.

use crate::assembly::System;
use crate::linalg::Block;
use crate::solver::SolveError;
use crate::solver::spectrum::{
    Eigen, TruncationBound, all_singular_values, condition, effective_rank, leading_eigenpairs,
    leading_singular_values, spectral_radius,
};
use serde::Serialize;

/// Up to so many unknowns all singular values are computed, from the matrix in full.
const FULL_UP_TO: usize = 1000;

/// Errors for which bounces and ranks are counted.
const TOLERANCES: [f64; 3] = [1e-3, 1e-6, 1e-12];

/// Products for the bounds of the spectral radius.
const RADIUS_PRODUCTS: usize = 200;

/// What the spectrum of one system says.
#[derive(Clone, Debug, Serialize)]
pub struct SpectrumOutcome {
    pub n_bundles: usize,
    pub bands: Vec<BandSpectrum>,
    /// Products with K or K*, all bands at once.
    pub products: usize,
}

/// One band.
#[derive(Clone, Debug, Serialize)]
pub struct BandSpectrum {
    pub band: String,
    /// low ≤ ρ(K) ≤ high, by Collatz and Wielandt.
    pub radius: [f64; 2],
    /// Real and imaginary parts, largest magnitude first.
    pub eigenvalues: Vec<[f64; 2]>,
    /// Of K in the norm of étendue, largest first.
    pub singular_values: Vec<f64>,
    /// Of I − K in that norm; absent where the matrix is too large to be decomposed.
    pub condition: Option<f64>,
    /// How many singular values exceed a tolerance times the first; likewise.
    pub effective_rank: Option<Vec<Counted>>,
    /// Bounces after which the Neumann series lacks no more than a tolerance, relative to the brightest emission; absent where nothing
    /// bounds them.
    pub bounces: Vec<Bounces>,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct Counted {
    pub tolerance: f64,
    pub count: usize,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct Bounces {
    pub tolerance: f64,
    /// From what every row absorbs, without a product.
    pub by_absorption: Option<usize>,
    /// From the Perron vector.
    pub by_spectrum: Option<usize>,
}

/// Bounds, eigenvalues, singular values and bounces of every band. `n_pairs` of the leading ones.
///
/// # Errors
/// Products that are not finite.
pub fn spectrum(
    system: &System,
    bands: &[String],
    n_pairs: usize,
    tolerance: f64,
    progress: &dyn Fn(f64),
) -> Result<SpectrumOutcome, SolveError> {
    let equation = system.equation();
    let n = system.n_bundles();
    let n_pairs = n_pairs.min(n);
    let settings = Eigen { n_pairs, tolerance, dimension: (3 * n_pairs + 8).min(n), n_products: 100 * (n_pairs + 4) };
    let radius = spectral_radius(equation, tolerance, RADIUS_PRODUCTS);
    progress(0.2);
    let pairs = leading_eigenpairs(equation, settings)?;
    progress(0.4);
    let singular = leading_singular_values(equation, settings)?;
    progress(0.6);

    // Bound what bounces leave out by the Perron vector, lifted a little so that it is dark nowhere.
    let perron = radius.as_ref().map(|radius| {
        let lifted = |i: usize, band: usize| {
            let vector = &radius.bands[band].vector;
            vector[i] + 1e-3 * vector.iter().copied().fold(0.0, f64::max)
        };
        Block::from_fn(n, system.n_bands(), lifted)
    });
    let by_spectrum = perron.map_or(vec![None; system.n_bands()], |x| TruncationBound::by_vector(equation, &x));

    let mut found = Vec::new();
    for (band, name) in bands.iter().enumerate() {
        let all = if n <= FULL_UP_TO { Some(all_singular_values(equation, band)?) } else { None };
        let rank = |values: &Vec<f64>| {
            TOLERANCES.map(|tolerance| Counted { tolerance, count: effective_rank(values, tolerance) }).to_vec()
        };
        let by_absorption = TruncationBound::by_absorption(equation, band);
        let bounces = |tolerance| Bounces {
            tolerance,
            by_absorption: by_absorption.map(|bound| bound.bounces_needed(tolerance)),
            by_spectrum: by_spectrum[band].map(|bound| bound.bounces_needed(tolerance)),
        };
        found.push(BandSpectrum {
            band: name.clone(),
            radius: radius
                .as_ref()
                .map_or([0.0, f64::INFINITY], |radius| [radius.bands[band].low, radius.bands[band].high]),
            eigenvalues: pairs.bands[band].iter().map(|pair| [pair.re, pair.im]).collect(),
            singular_values: singular.bands[band].clone(),
            condition: all.as_ref().map(|[_, of_equation]| condition(of_equation)),
            effective_rank: all.as_ref().map(|[of_transport, _]| rank(of_transport)),
            bounces: TOLERANCES.map(bounces).to_vec(),
        });
        progress(0.6 + 0.4 * (band + 1) as f64 / bands.len() as f64);
    }
    let products = radius.map_or(0, |radius| radius.n_applies) + pairs.n_applies + 2 * singular.n_applies;
    Ok(SpectrumOutcome { n_bundles: n, bands: found, products })
}
