//! Every BRDF × every law.

use super::cubature::{about_the_mirror, over_directions, over_facets};
use super::{BRDFS, direction_of_cosine, index_at, outgoing_directions};
use crate::sphere::{Cells, test_sampler};
use etendue::geometry::Vec3;
use etendue::sampling::{Streams, warp};
use etendue::scattering::{Brdf, Deltas};
use etendue::stats::sidak_level;

/// Family-wise significance of the random tests of this file.
const SIGNIFICANCE: f64 = 1e-6;
/// A few roundings of a product of ten factors.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// What the surfaces' own quadratures may leave.
const QUADRATURE: f64 = 1e-9;

#[test]
fn brdfs_are_positive_and_reciprocal_to_the_bit() {
    for brdf in BRDFS.iter() {
        let name = brdf.description();
        let mut stream = Streams::new(79, "pairs").stream(0, 0);
        let mut n_crossing = 0;
        for _ in 0..2000 {
            let [a, b] = [0, 1].map(|_| Vec3::from(warp::uniform_sphere(stream.uniform2())));
            let crosses = a.z * b.z < 0.0;
            for band in 0..brdf.n_bands() {
                let (f, reversed) = (brdf.eval(band, a, b), brdf.eval(band, b, a));
                assert!(f >= 0.0 && f.is_finite(), "{name}: {f}");
                if crosses && brdf.is_transmissive() {
                    // Étendue n² cosθ dω is what both ways share; n² is rounded once each way.
                    let [there, back] = [f * index_at(&**brdf, b).powi(2), reversed * index_at(&**brdf, a).powi(2)];
                    assert!((there - back).abs() <= ROUNDING * there, "{name}: {there} against {back}");
                    n_crossing += usize::from(f > 0.0);
                } else {
                    assert_eq!(f.to_bits(), reversed.to_bits(), "{name}");
                }
                if !brdf.is_transmissive() && (a.z <= 0.0 || b.z <= 0.0) {
                    assert_eq!(f, 0.0, "{name} below the surface");
                }
            }
        }
        let mirror = brdf.deltas(0, Vec3::Z).len() > 1;
        assert!(!brdf.is_transmissive() || mirror || n_crossing > 100, "{name}: {n_crossing}");
    }
}

#[test]
fn mirror_like_terms_are_reciprocal_and_refract_as_snell_says() {
    let mut n_found = [0; 3];
    for brdf in BRDFS.iter() {
        let name = brdf.description();
        let mut stream = Streams::new(97, "mirrors").stream(0, 0);
        for _ in 0..300 {
            let outgoing = Vec3::from(warp::uniform_sphere(stream.uniform2()));
            let terms = brdf.deltas(0, outgoing);
            n_found[terms.len()] += 1;
            assert!(terms.is_empty() || outgoing.z > 0.0 || brdf.is_transmissive());
            for (k, term) in terms.iter().enumerate() {
                assert!((term.incident.length() - 1.0).abs() < 1e-15 && (0.0..=1.0).contains(&term.weight));

                // n sinθ is the same, and the plane of incidence too.
                let [n, m] = [outgoing, term.incident].map(|direction| index_at(&**brdf, direction));
                let across = n * outgoing.truncate() + m * term.incident.truncate();
                assert!(across.length() < 1e-14, "{name}: {across:?}");

                // Other bands have the same directions in the same order.
                for band in 1..brdf.n_bands() {
                    assert_eq!(brdf.deltas(band, outgoing)[k].incident, term.incident);
                }

                // Backwards: Fresnel's reflectance is steep at grazing, and a direction is rounded.
                let back = brdf.deltas(0, term.incident);
                let back = back.iter().find(|other| (other.incident - outgoing).length() < 1e-7).expect("a way back");
                let steep = 1e-15 / (outgoing.z.abs().min(term.incident.z.abs())).powi(2);
                assert!((back.weight - term.weight).abs() < steep, "{name}: {} against {}", back.weight, term.weight);
            }
        }
    }
    assert!(n_found.iter().all(|n| *n > 300), "{n_found:?}");
}

#[test]
fn mirror_shares_tell_what_is_smooth() {
    for brdf in BRDFS.iter() {
        let name = brdf.description();
        let mut stream = Streams::new(101, "shares").stream(0, 0);
        for _ in 0..200 {
            let [a, b] = [0, 1].map(|_| Vec3::from(warp::uniform_sphere(stream.uniform2())));
            let share = brdf.mirror_share(a);
            assert_eq!(share == 0.0, brdf.deltas(0, a).is_empty(), "{name}: {share}");
            assert!((0.0..=1.0).contains(&share) && (share < 1.0 || brdf.eval(0, b, a) == 0.0), "{name}: {share}");
            assert!(share < 1.0 || brdf.sample(a, stream.uniform2()).is_none(), "{name}");
        }
    }
}

#[test]
fn albedo_is_the_integral_of_the_brdf() {
    // Asked of the adaptive cubature, and what 64 × 512 nodes of the rule about the mirror leave.
    const TOLERANCE: f64 = 1e-9;
    // Slivers of cells along the rim of what facets mirror, which hold no node of either of the cubature's rules.
    const SLIVERS: f64 = 1e-7;
    for brdf in BRDFS.iter() {
        let name = brdf.description();
        for (k, outgoing) in outgoing_directions(&**brdf).into_iter().enumerate() {
            // Quadratures are costly: bands take turns.
            let band = k % brdf.n_bands();
            let albedo = brdf.albedo(band, outgoing);
            let f = |incident: Vec3| brdf.eval(band, incident, outgoing) * incident.z.abs();
            let ((smooth, error), allowed) = if name.starts_with("phong") {
                ((about_the_mirror(&**brdf, band, outgoing), 0.0), TOLERANCE)
            } else if name.starts_with("roughdielectric") {
                (over_facets(&**brdf, band, outgoing, TOLERANCE, 5_000), SLIVERS)
            } else {
                (over_directions(brdf.is_transmissive(), TOLERANCE, 20_000, f), TOLERANCE)
            };
            let integral = smooth + brdf.deltas(band, outgoing).weight();
            assert!((0.0..=1.0 + 64.0 * f64::EPSILON).contains(&albedo), "{name}: {albedo}");
            assert!(
                (albedo - integral).abs() < error + allowed && error < 1e-6,
                "{name} at cosine {}: {albedo} against {integral} ± {error:e}",
                outgoing.z
            );
        }
    }
}

#[test]
fn samplers_follow_their_densities() {
    let cells = Cells { low: -1.0, n_rings: 40, n_sectors: 24 };
    // What the rules of 960 cells may leave together.
    const CELLS: f64 = 1e-7;
    let n = BRDFS.iter().map(|brdf| outgoing_directions(&**brdf).len()).sum();
    for brdf in BRDFS.iter().filter(|brdf| is_smooth(&***brdf)) {
        for outgoing in outgoing_directions(&**brdf) {
            let name = brdf.description();
            let pdf = |incident| brdf.pdf(outgoing, incident);
            let total: f64 = cells.integrate(12, pdf).iter().sum();
            if total == 0.0 {
                assert!(brdf.sample(outgoing, [0.3, 0.7]).is_none(), "{name}");
                continue;
            }
            assert!(total <= 1.0 + CELLS, "{name} at cosine {}: the density integrates to {total}", outgoing.z);
            let test = test_sampler(cells, &name, 50_000, |u| brdf.sample(outgoing, u), pdf);
            assert!(test.p_value > sidak_level(SIGNIFICANCE, n), "{name} at cosine {}: {test:?}", outgoing.z);
        }
    }
}

/// A density must be above zero wherever light is scattered, and its samples where the surface knows light.
#[test]
fn samplers_reach_all_that_is_scattered() {
    for brdf in BRDFS.iter() {
        let name = brdf.description();
        let mut stream = Streams::new(83, "reach").stream(0, 0);
        for _ in 0..2000 {
            let [a, b] = [0, 1].map(|_| Vec3::from(warp::uniform_sphere(stream.uniform2())));
            assert!(brdf.eval(0, a, b) == 0.0 || brdf.pdf(b, a) > 0.0, "{name}");
            match brdf.sample(b, stream.uniform2()) {
                Some(incident) => {
                    assert!((incident.length() - 1.0).abs() < 1e-15, "{name}: {incident:?}");
                    assert!(brdf.is_transmissive() || (b.z > 0.0 && incident.z >= 0.0), "{name}: {incident:?}");
                    assert!(incident.z == 0.0 || brdf.pdf(b, incident) > 0.0, "{name}: {incident:?}");
                }
                None => assert!(brdf.lambertian().is_none() || b.z <= 0.0),
            }
        }
    }
}

/// As a direction sinks to the horizon nothing overflows, and no albedo leaves [0, 1].
#[test]
fn grazing_light_is_finite() {
    for brdf in BRDFS.iter() {
        let name = brdf.description();
        for cosine in [1e-3, 1e-6, 1e-12, 1e-30] {
            let low = direction_of_cosine(cosine);
            let others = [Vec3::Z, direction_of_cosine(0.5), Vec3::new(-low.x, -low.y, low.z), low];
            let sides = if brdf.is_transmissive() { vec![1.0, -1.0] } else { vec![1.0] };
            for (other, side) in others.into_iter().flat_map(|other| sides.iter().map(move |side| (other, *side))) {
                let incident = Vec3::new(other.x, other.y, side * other.z);
                let [there, back] = [brdf.eval(0, incident, low), brdf.eval(0, low, incident)];
                let [pdf, reverse] = [brdf.pdf(low, incident), brdf.pdf(incident, low)];
                let all = [there, back, pdf, reverse];
                assert!(all.iter().all(|f| f.is_finite() && *f >= 0.0), "{name} at {cosine:e}, {other:?}: {all:?}");
            }
            for side in sides {
                let outgoing = Vec3::new(low.x, low.y, side * low.z);
                let albedo = brdf.albedo(0, outgoing);
                assert!((0.0..=1.0 + QUADRATURE).contains(&albedo), "{name} at {cosine:e}: {albedo}");
                let sample = brdf.sample(outgoing, [0.3, 0.6]);
                assert!(sample.is_none_or(|incident| (incident.length() - 1.0).abs() < 1e-15), "{name}: {sample:?}");
            }
        }
    }
}

#[test]
fn descriptions_tell_surfaces_apart() {
    let names: std::collections::BTreeSet<String> = BRDFS.iter().map(|brdf| brdf.description()).collect();
    assert_eq!(names.len(), BRDFS.len());
    assert!(BRDFS[0].deltas(0, Vec3::Z) == Deltas::NONE && BRDFS[0].relative_index() == 1.0);
}

/// Whether there is anything but mirrors.
fn is_smooth(brdf: &dyn Brdf) -> bool {
    brdf.sample(Vec3::Z, [0.25, 0.5]).is_some() || brdf.sample(Vec3::Z, [0.75, 0.5]).is_some()
}
