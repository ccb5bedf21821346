//! Every BRDF × every law, and each against exact values.

mod cubature;
mod facets;
mod laws;
mod lobes;
mod tables;
mod values;

use etendue::geometry::Vec3;
use etendue::sampling::warp;
use etendue::scattering::{
    Base, Blend, BlinnPhong, Brdf, Chandrasekhar, CompensatedConductor, Conductor, Dielectric, DiffuseTransmission,
    Distribution, Glass, Lambert, LommelSeeliger, Masking, Metal, Microfacets, Phong, Plastic, RoughConductor,
    RoughDielectric, RoughPlastic, ThinDielectric, Ward,
};
use std::sync::{Arc, LazyLock};

/// One of each surface, of two bands.
static BRDFS: LazyLock<Vec<Arc<dyn Brdf>>> = LazyLock::new(brdfs);

fn brdfs() -> Vec<Arc<dyn Brdf>> {
    let mut all: Vec<Arc<dyn Brdf>> = vec![
        Arc::new(Lambert::new(vec![1.0, 0.3])),
        Arc::new(Lambert::black(2)),
        Arc::new(LommelSeeliger::new(vec![1.0, 0.6]).unwrap()),
        Arc::new(Chandrasekhar::new(vec![1.0, 0.9]).unwrap()),
        Arc::new(Ward::new(vec![0.2, 0.1], vec![0.8, 0.3], [0.4, 0.2]).unwrap()),
        Arc::new(Ward::new(vec![0.0, 0.0], vec![1.0, 0.0], [0.15, 0.15]).unwrap()),
        Arc::new(Plastic::new(base(false), vec![1.0, 1.0]).unwrap()),
        Arc::new(Plastic::new(base(true), vec![1.0, 0.5]).unwrap()),
        Arc::new(Conductor::mirror(vec![1.0, 0.7]).unwrap()),
        Arc::new(Conductor::new(metal())),
        Arc::new(Dielectric::new(Glass::bk7(2))),
        Arc::new(Dielectric::new(Glass::new(1.0, 1.33, vec![1.0, 0.5], vec![1.0, 0.8]).unwrap())),
        Arc::new(ThinDielectric::new(Glass::bk7(2))),
        Arc::new(DiffuseTransmission::new(vec![0.5, 0.2], vec![0.5, 0.7]).unwrap()),
    ];
    for exponent in [0.0, 1.0, 5.0, 17.5, 100.0] {
        all.push(Arc::new(Phong::new(vec![1.0, 0.25], exponent).unwrap()));
    }
    for exponent in [0.0, 3.0, 60.0] {
        all.push(Arc::new(BlinnPhong::new(vec![1.0, 0.25], exponent).unwrap()));
    }
    for (k, facets) in microfacets().into_iter().enumerate() {
        let metal = if k % 3 == 0 { Metal::ideal(vec![1.0, 0.4]).unwrap() } else { metal() };
        all.push(Arc::new(RoughConductor::new(metal, facets)));
    }
    let rough = |distribution, masking, alpha| Microfacets::new(distribution, masking, alpha).unwrap();
    let (ggx, beckmann) = (Distribution::Ggx, Distribution::Beckmann);
    for facets in [rough(ggx, Masking::Separable, [0.3; 2]), rough(beckmann, Masking::Correlated, [0.3; 2])] {
        all.push(Arc::new(RoughPlastic::new(base(true), facets, vec![1.0, 0.5]).unwrap()));
        all.push(Arc::new(CompensatedConductor::new(metal(), facets).unwrap()));
    }
    for facets in [rough(ggx, Masking::Correlated, [0.3, 0.15]), rough(beckmann, Masking::Separable, [0.4; 2])] {
        all.push(Arc::new(RoughDielectric::new(Glass::bk7(2), facets).unwrap()));
        let bubble = Glass::new(1.0, 1.8, vec![1.0, 0.5], vec![1.0, 0.8]).unwrap();
        all.push(Arc::new(RoughDielectric::new(bubble, facets).unwrap()));
    }
    let pick = |k: usize| all[k].clone();
    let blends = [[pick(0), pick(9)], [pick(10), pick(6)], [pick(4), pick(13)]];
    all.extend(blends.into_iter().map(|parts| -> Arc<dyn Brdf> { Arc::new(Blend::new(parts, 0.3).unwrap()) }));
    all
}

fn microfacets() -> Vec<Microfacets> {
    let mut all = Vec::new();
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for masking in [Masking::Correlated, Masking::Separable] {
            for alpha in [[0.15, 0.15], [0.6, 0.25]] {
                all.push(Microfacets::new(distribution, masking, alpha).unwrap());
            }
        }
    }
    all
}

fn base(nonlinear: bool) -> Base {
    Base::new(vec![1.0, 0.4], 1.49, 1.0, nonlinear).unwrap()
}

fn metal() -> Metal {
    Metal::new(vec![0.2, 1.1], vec![3.9, 2.1], vec![1.0, 0.9]).unwrap()
}

fn direction(degrees: f64, turn: f64) -> Vec3 {
    warp::around_z(degrees.to_radians().cos(), turn).into()
}

fn direction_of_cosine(cosine: f64) -> Vec3 {
    warp::around_z(cosine, 0.1).into()
}

/// Directions from the normal to grazing, on every side on which the surface knows light.
fn outgoing_directions(brdf: &dyn Brdf) -> Vec<Vec3> {
    let angles = [0.0, 20.0, 45.0, 70.0, 85.0, 89.5];
    let above = angles.iter().enumerate().map(|(k, t)| direction(*t, 0.05 + 0.17 * k as f64));
    let below = [175.0, 130.0, 115.0, 93.0].iter().enumerate().map(|(k, t)| direction(*t, 0.11 + 0.23 * k as f64));
    if brdf.is_transmissive() { above.chain(below).collect() } else { above.collect() }
}

/// Refractive index, in units of that above, where a direction lies.
fn index_at(brdf: &dyn Brdf, direction: Vec3) -> f64 {
    if direction.z > 0.0 { 1.0 } else { brdf.relative_index() }
}
