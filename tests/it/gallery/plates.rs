//! The parallel plates' continuous values, computed once more.

use etendue::gallery::{self, Exact};
use std::f64::consts::PI;

/// Collocation points a direction: the error falls by (1 + √2)⁻² a point, below 1e-12 at 18.
const N_NODES: usize = 18;
/// The twelfth digit of the reference is rounded (at most 5e-12 relative); the solution here errs by less than 1e-12.
const TWELVE_DIGITS: f64 = 6e-12;

/// Nodes and weights of the Gauss–Legendre rule on [0, 1]: Newton's method on the Legendre polynomial.
fn gauss(n: usize) -> Vec<(f64, f64)> {
    let rule = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..100 {
            let (mut below, mut value) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (below, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * below) / k);
            }
            slope = n as f64 * (below - x * value) / (1.0 - x * x);
            x -= value / slope;
        }
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(rule).collect()
}

#[test]
fn nystrom_reproduces_the_reference() {
    let Some(Exact::Continuous(exact)) = (gallery::find("parallel-plates").unwrap().exact)() else { panic!() };
    let (gap, albedo) = (0.5, 0.8);
    let kernel = |a: [f64; 2], b: [f64; 2]| {
        let separation = (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + gap * gap;
        gap * gap / (PI * separation * separation)
    };
    let rule = gauss(N_NODES);
    let nodes: Vec<([f64; 2], f64)> =
        rule.iter().flat_map(|(x, wx)| rule.iter().map(move |(y, wy)| ([*x, *y], wx * wy))).collect();
    let gather = |at: [f64; 2], field: &[f64]| -> f64 {
        nodes.iter().zip(field).map(|((node, weight), b)| albedo * weight * kernel(at, *node) * b).sum()
    };

    // Bounce until nothing is left: the factor a bounce is albedo × the largest eigenvalue, about 0.35.
    let (mut first, mut second) = (vec![1.0; nodes.len()], vec![0.0; nodes.len()]);
    for _ in 0..40 {
        second = nodes.iter().map(|(at, _)| gather(*at, &first)).collect();
        first = nodes.iter().map(|(at, _)| 1.0 + gather(*at, &second)).collect();
    }

    // Carry the values to the points by the equation itself.
    assert_eq!(exact.points.len(), 8);
    for point in &exact.points {
        let at = [point.position[0], point.position[1]];
        let radiosity = if point.surface == "plate-1" { 1.0 + gather(at, &second) } else { gather(at, &first) };
        let error = PI * point.radiance[0] / radiosity - 1.0;
        assert!(error.abs() < TWELVE_DIGITS, "{point:?}: {error:e}");
    }
    for (mean, field) in exact.means.iter().zip([&first, &second]) {
        let expected: f64 = nodes.iter().zip(field).map(|((_, weight), b)| weight * b).sum();
        let error = PI * mean.radiance[0] / expected - 1.0;
        assert!(error.abs() < TWELVE_DIGITS, "{mean:?}: {error:e}");
    }
}

#[test]
fn one_patch_a_plate_follows_from_the_form_factor() {
    let Some(Exact::Continuous(exact)) = (gallery::find("parallel-plates").unwrap().exact)() else { panic!() };
    // F between aligned unit squares at a gap of 1/x, from the textbook's closed form.
    let x: f64 = 2.0;
    let s = 1.0 + x * x;
    let form_factor = 2.0 / (PI * x * x)
        * ((s * s / (1.0 + 2.0 * x * x)).ln() / 2.0 + 2.0 * x * s.sqrt() * (x / s.sqrt()).atan() - 2.0 * x * x.atan());
    let coupling = 0.8 * form_factor;
    let expected = [1.0 / (1.0 - coupling * coupling), coupling / (1.0 - coupling * coupling)];
    let single = exact.uniform_patches.iter().find(|u| u.n_per_side == 1).unwrap();
    for (mean, radiosity) in single.means.iter().zip(expected) {
        assert!((PI * mean.radiance[0] / radiosity - 1.0).abs() < TWELVE_DIGITS, "{mean:?} {radiosity}");
    }
}

#[test]
fn plates_face_each_other() {
    let scene = gallery::parallel_plates();
    let [first, second] = scene.surfaces() else { panic!() };
    let apart = second.polygons[0].centroid() - first.polygons[0].centroid();
    assert_eq!(apart.to_array(), [0.0, 0.0, 0.5]);
    assert_eq!(first.polygons[0].normal().to_array(), [0.0, 0.0, 1.0]);
    assert_eq!(second.polygons[0].normal().to_array(), [0.0, 0.0, -1.0]);
    assert_eq!((first.area(), second.area()), (1.0, 1.0));
    assert_eq!((scene.n_bands(), scene.bands()), (1, &["grey".to_string()][..]));
}
