//! Streams, warps, alias tables and Sobol' points.

use crate::sphere::{Cells, test_sampler};
use etendue::geometry::Vec3;
use etendue::sampling::{
    AliasError, AliasRows, AliasTable, CumulativeRows, PaddedSobol, Sobol, Stream, Streams, mix_seed, warp,
};
use etendue::stats::{Moments, chi_squared_test, critical_z, sidak_level, z_score};
use std::collections::HashSet;

/// Family-wise significance of the random tests of this file.
const SIGNIFICANCE: f64 = 1e-6;
const N_SAMPLES: u64 = 200_000;

// ---- streams

#[test]
fn a_stream_is_a_function_of_its_key() {
    let draw = |mut s: Stream| [s.bits(), s.bits(), s.bits()];
    let streams = Streams::new(17, "walks");
    assert_eq!(draw(streams.stream(3, 5)), draw(Streams::new(17, "walks").stream(3, 5)));
    let others = [
        streams.stream(4, 5),
        streams.stream(3, 6),
        Streams::new(18, "walks").stream(3, 5),
        Streams::new(17, "walkers").stream(3, 5),
        Streams::new(17, "").stream(3, 5),
        Stream::new(18, 3, 5),
        Stream::new(0, 0, 0),
    ];
    let mut seen = HashSet::from([draw(streams.stream(3, 5))]);
    assert!(others.into_iter().all(|s| seen.insert(draw(s))));
}

#[test]
fn the_first_numbers_never_change() {
    // Recorded from this implementation: results written with a seed must stay reproducible from version to version.
    let mut stream = Streams::new(1, "golden").stream(2, 3);
    assert_eq!([stream.bits(), stream.bits(), stream.bits()], GOLDEN_BITS);
}
const GOLDEN_BITS: [u64; 3] = [4_701_130_928_551_478_997, 7_882_025_688_999_159_581, 10_000_319_933_059_258_920];

#[test]
fn uniform_numbers_are_uniform_within_and_across_streams() {
    let n_cells = 64;
    let streams = Streams::new(29, "uniformity");
    let mut within = vec![0; n_cells];
    let mut across = vec![0; n_cells];
    let mut stream = streams.stream(0, 0);
    for k in 0..N_SAMPLES {
        within[(stream.uniform() * n_cells as f64) as usize] += 1;
        across[(streams.stream(1, k).uniform() * n_cells as f64) as usize] += 1;
    }
    let expected = vec![N_SAMPLES as f64 / n_cells as f64; n_cells];
    for counts in [within, across] {
        let p = chi_squared_test(&counts, &expected).unwrap().p_value;
        assert!(p > sidak_level(SIGNIFICANCE, 2), "p = {p:e}");
    }
}

/// Three numbers of one block: each uniform to its last digits, and together.
#[test]
fn three_numbers_of_a_block_are_uniform_together() {
    let n_cells = 12;
    let streams = Streams::new(30, "blocks of three");
    let (mut coarse, mut fine) = (vec![0; n_cells * n_cells * n_cells], vec![0; n_cells * n_cells * n_cells]);
    let mut stream = streams.stream(0, 0);
    for _ in 0..N_SAMPLES {
        let numbers = stream.uniform3();
        assert!(numbers.iter().all(|u| (0.0..1.0).contains(u)));
        let cell = |numbers: [f64; 3]| numbers.iter().fold(0, |cell, u| cell * n_cells + (u * n_cells as f64) as usize);
        coarse[cell(numbers)] += 1;
        // The last 21 of 42 digits.
        fine[cell(numbers.map(|u| (u * f64::from(1 << 21)).fract()))] += 1;
    }
    let expected = vec![N_SAMPLES as f64 / coarse.len() as f64; coarse.len()];
    for counts in [coarse, fine] {
        let p = chi_squared_test(&counts, &expected).unwrap().p_value;
        assert!(p > sidak_level(SIGNIFICANCE, 2), "p = {p:e}");
    }

    // Half a block that is left over is dropped: the next numbers are those of the next block.
    let (mut left_over, mut none) = (streams.stream(1, 1), streams.stream(1, 1));
    left_over.uniform();
    none.uniform2();
    assert_eq!(left_over.uniform3(), none.uniform3());
}

#[test]
fn neighbouring_streams_are_uncorrelated() {
    let moments = |first: fn(u64) -> (u32, u64), second: fn(u64) -> (u32, u64)| -> Moments {
        let streams = Streams::new(31, "correlation");
        (0..N_SAMPLES)
            .map(|k| {
                let draw = |(start, sample)| streams.stream(start, sample).uniform() - 0.5;
                draw(first(k)) * draw(second(k))
            })
            .collect()
    };
    for m in [moments(|k| (0, 2 * k), |k| (0, 2 * k + 1)), moments(|k| (k as u32, 0), |k| (k as u32, 1 << 40))] {
        let z = z_score(m.mean(), 0.0, m.variance_of_mean());
        assert!(z.abs() < critical_z(SIGNIFICANCE, 2), "z = {z}");
    }
}

// ---- warps

#[test]
fn directional_warps_follow_their_densities() {
    type Warp = (&'static str, fn([f64; 2]) -> [f64; 3], fn([f64; 3]) -> f64);
    let warps: [Warp; 6] = [
        ("cosine hemisphere", warp::cosine_hemisphere, warp::cosine_hemisphere_pdf),
        ("uniform hemisphere", warp::uniform_hemisphere, warp::uniform_hemisphere_pdf),
        ("uniform sphere", warp::uniform_sphere, |_| warp::uniform_sphere_pdf()),
        ("phong 0", |u| warp::phong_lobe(0.0, u), |d| warp::phong_lobe_pdf(0.0, d[2])),
        ("phong 3.5", |u| warp::phong_lobe(3.5, u), |d| warp::phong_lobe_pdf(3.5, d[2])),
        ("phong 80", |u| warp::phong_lobe(80.0, u), |d| warp::phong_lobe_pdf(80.0, d[2])),
    ];
    let cells = Cells { low: -1.0, n_rings: 20, n_sectors: 12 };
    for (name, sample, pdf) in warps {
        let unit = |d: [f64; 3]| {
            let d = Vec3::from(d);
            assert!((d.length() - 1.0).abs() < 4.0 * f64::EPSILON, "{name}: length {}", d.length());
            d
        };
        let test = test_sampler(cells, name, N_SAMPLES, |u| Some(unit(sample(u))), |d| pdf(d.to_array()));
        assert!(test.p_value > sidak_level(SIGNIFICANCE, warps.len()), "{name}: {test:?}");
    }
}

#[test]
fn a_wrong_density_is_found_out() {
    let cells = Cells { low: -1.0, n_rings: 20, n_sectors: 12 };
    let test = test_sampler(
        cells,
        "power",
        N_SAMPLES,
        |u| Some(warp::phong_lobe(1.1, u).into()),
        |d| warp::cosine_hemisphere_pdf(d.to_array()),
    );
    assert!(test.p_value < SIGNIFICANCE, "{test:?}");
}

#[test]
fn the_disk_is_covered_evenly() {
    // Rings of equal area and sectors of equal angle have equal probability.
    let (n_rings, n_sectors) = (10, 16);
    let mut counts = vec![0; n_rings * n_sectors];
    let streams = Streams::new(37, "disk");
    for k in 0..N_SAMPLES {
        let [x, y] = warp::disk(streams.stream(0, k).uniform2());
        assert!(warp::disk_pdf([x, y]) > 0.0 || x.hypot(y) < 1.0 + f64::EPSILON);
        let ring = ((x * x + y * y) * n_rings as f64) as usize;
        let turn = y.atan2(x).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
        counts[ring.min(n_rings - 1) * n_sectors + ((turn * n_sectors as f64) as usize).min(n_sectors - 1)] += 1;
    }
    let expected = vec![N_SAMPLES as f64 / counts.len() as f64; counts.len()];
    let test = chi_squared_test(&counts, &expected).unwrap();
    assert!(test.p_value > SIGNIFICANCE, "{test:?}");
}

#[test]
fn triangles_and_polygons_are_covered_evenly() {
    // A pentagon in a tilted plane, spanned by two vectors; count points on a grid of its coordinates.
    let (origin, right, up) = (Vec3::new(0.3, -2.0, 5.0), Vec3::new(1.0, 0.5, -0.25), Vec3::new(-0.2, 0.9, 1.3));
    let corners = [(0.0, 0.0), (1.0, 0.1), (1.2, 0.7), (0.5, 1.1), (-0.1, 0.6)];
    let at = |(a, b): (f64, f64)| origin + a * right + b * up;
    let polygon = warp::ConvexPolygon::new(corners.map(at));
    let triangle = [corners[0], corners[2], corners[3]];
    let triangle_vertices = triangle.map(|c| at(c).to_array());
    type Sampler<'a> = Box<dyn Fn([f64; 2]) -> [f64; 3] + 'a>;
    let cases: [(&str, &[(f64, f64)], Sampler, f64); 2] = [
        ("pentagon", &corners, Box::new(|u| polygon.sample(u)), polygon.pdf()),
        (
            "triangle",
            &triangle,
            Box::new(|u| warp::triangle(triangle_vertices, u)),
            warp::triangle_pdf(triangle_vertices),
        ),
    ];
    for (name, corners, sample, pdf) in cases {
        let n = 12;
        let (low, high) = ((-0.1, 0.0), (1.2, 1.1));
        let mut counts = vec![0; n * n];
        let streams = Streams::new(41, name);
        for k in 0..N_SAMPLES {
            let offset = Vec3::from(sample(streams.stream(0, k).uniform2())) - origin;
            let (a, b) = coordinates(offset, right, up);
            assert!((offset - a * right - b * up).length() < 1e-13, "{name}: point off the plane");
            let cell = |x: f64, low: f64, high: f64| (((x - low) / (high - low) * n as f64) as usize).min(n - 1);
            counts[cell(a, low.0, high.0) * n + cell(b, low.1, high.1)] += 1;
        }
        let size = ((high.0 - low.0) / n as f64, (high.1 - low.1) / n as f64);
        let expected: Vec<f64> = (0..n * n)
            .map(|k| {
                let corner = (low.0 + (k / n) as f64 * size.0, low.1 + (k % n) as f64 * size.1);
                let area = clipped_area(corners, corner, size) * right.cross(up).length();
                pdf * area * N_SAMPLES as f64
            })
            .collect();
        let test = chi_squared_test(&counts, &expected).unwrap();
        assert!(test.p_value > sidak_level(SIGNIFICANCE, 2), "{name}: {test:?}");
    }
}

/// (a, b) with offset = a right + b up.
fn coordinates(offset: Vec3, right: Vec3, up: Vec3) -> (f64, f64) {
    let normal = right.cross(up);
    let scale = normal.length_squared();
    (offset.cross(up).dot(normal) / scale, right.cross(offset).dot(normal) / scale)
}

/// Area of a convex polygon inside the axis-parallel rectangle at `corner`, by clipping (Sutherland & Hodgman).
fn clipped_area(polygon: &[(f64, f64)], corner: (f64, f64), size: (f64, f64)) -> f64 {
    let planes =
        [(1.0, 0.0, -corner.0), (-1.0, 0.0, corner.0 + size.0), (0.0, 1.0, -corner.1), (0.0, -1.0, corner.1 + size.1)];
    let mut points = polygon.to_vec();
    for (a, b, c) in planes {
        let side = |p: (f64, f64)| a * p.0 + b * p.1 + c;
        let mut inside = Vec::new();
        for (k, p) in points.iter().enumerate() {
            let q = points[(k + 1) % points.len()];
            let (sp, sq) = (side(*p), side(q));
            if sp >= 0.0 {
                inside.push(*p);
            }
            if sp * sq < 0.0 {
                let t = sp / (sp - sq);
                inside.push((p.0 + t * (q.0 - p.0), p.1 + t * (q.1 - p.1)));
            }
        }
        points = inside;
    }
    let n = points.len();
    (0..n).map(|k| (points[k], points[(k + 1) % n])).map(|(p, q)| 0.5 * (p.0 * q.1 - q.0 * p.1)).sum()
}

// ---- alias tables

/// Weights over twenty-four orders of magnitude, many of them zero.
fn ragged_weights(n: usize, seed: u64) -> Vec<f64> {
    let mut stream = Stream::new(seed, 0, 0);
    let mut weight = || if stream.uniform() < 0.3 { 0.0 } else { 10f64.powf(-24.0 * stream.uniform().powi(3)) };
    (0..n).map(|_| weight()).collect()
}

/// Sums pairs of the smallest, so that no rounding is larger than it must be.
fn sum_from_the_smallest(weights: &[f64]) -> f64 {
    let mut sums = weights.to_vec();
    while sums.len() > 1 {
        sums.sort_by(f64::total_cmp);
        sums = sums.chunks(2).map(|pair| pair.iter().sum()).collect();
    }
    sums[0]
}

/// What a probability may be off: a few roundings of numbers below 1.
const ALIAS_TOLERANCE: f64 = 1e-15;

#[test]
fn alias_tables_imply_their_weights() {
    for (seed, n) in [1, 2, 3, 17, 1000, 20_000].into_iter().enumerate() {
        let mut weights = ragged_weights(n, seed as u64);
        weights[n / 2] = 0.7 * n as f64;
        let sum = sum_from_the_smallest(&weights);
        let probabilities = AliasTable::new(&weights).unwrap().probabilities();
        for (p, w) in probabilities.iter().zip(&weights) {
            assert!((p - w / sum).abs() < ALIAS_TOLERANCE, "n = {n}: {p:e} against {:e}", w / sum);
            assert_eq!(*p == 0.0, *w == 0.0);
        }
    }
}

#[test]
fn alias_rows_imply_their_rows_and_what_is_missing() {
    let n = 700;
    let row = |i: usize, out: &mut [f64]| {
        out.copy_from_slice(&ragged_weights(n, i as u64));
        let scale = [1.0 - 1e-13, 0.5, 1e-9][i % 3] / sum_from_the_smallest(out);
        out.iter_mut().for_each(|w| *w *= scale);
    };
    let rows = AliasRows::new(n, n, row).unwrap();
    assert_eq!((rows.n_rows(), rows.n_columns()), (n, n));
    for i in 0..n {
        let mut weights = vec![0.0; n];
        row(i, &mut weights);
        for (p, w) in rows.probabilities(i).iter().zip(&weights) {
            assert!((p - w).abs() < ALIAS_TOLERANCE, "row {i}: {p:e} against {w:e}");
        }
    }
}

#[test]
fn alias_rows_sample_their_probabilities() {
    let weights = [0.05, 0.0, 0.3, 0.15, 0.2];
    let rows = AliasRows::new(3, 5, |i, out| {
        if i == 1 {
            out.copy_from_slice(&weights)
        }
    })
    .unwrap();
    let mut counts = [0; 6];
    let streams = Streams::new(43, "alias");
    for k in 0..N_SAMPLES {
        let uniform = streams.stream(0, k).uniform();
        counts[rows.sample(1, uniform).unwrap_or(5)] += 1;
        assert_eq!(rows.sample(0, uniform), None, "a row of zeros absorbs everything");
    }
    let expected = [0.05, 0.0, 0.3, 0.15, 0.2, 0.3].map(|p| p * N_SAMPLES as f64);
    let test = chi_squared_test(&counts, &expected).unwrap();
    assert!(test.p_value > SIGNIFICANCE, "{test:?}");
    assert_eq!(counts[1], 0);
}

#[test]
fn alias_tables_refuse_what_is_no_distribution() {
    assert_eq!(AliasTable::new(&[0.0, 0.0]), Err(AliasError::NoWeight { row: 0 }));
    assert_eq!(AliasTable::new(&[]), Err(AliasError::NoWeight { row: 0 }));
    assert_eq!(AliasTable::new(&[0.5, -0.25]), Err(AliasError::BadWeight { row: 0, column: 1, weight: -0.25 }));
    assert!(matches!(AliasTable::new(&[f64::NAN]), Err(AliasError::BadWeight { row: 0, column: 0, .. })));
    let too_much = AliasRows::new(4, 2, |i, out| out.fill(if i == 2 { 0.75 } else { 0.5 }));
    assert_eq!(too_much, Err(AliasError::SumAboveOne { row: 2, sum: 1.5 }));
    let rounding = AliasRows::new(1, 2, |_, out| out.fill(0.5 + 1e-13)).unwrap();
    assert!((0..1000).all(|k| rounding.sample(0, k as f64 / 1000.0).is_some()));
}

// ---- Sobol' points

/// How many of the 2ᵏ dyadic boxes of shape 2⁻ᵃ × 2⁻ᵇ hold exactly one of the first 2ᵏ points.
fn n_boxes_hit(points: &[[f64; 8]], dimensions: (usize, usize), shape: (u32, u32)) -> usize {
    let cell = |x: f64, digits: u32| (x * f64::from(1u32 << digits)) as u64;
    let boxes: HashSet<_> =
        points.iter().map(|p| (cell(p[dimensions.0], shape.0), cell(p[dimensions.1], shape.1))).collect();
    boxes.len()
}

#[test]
fn every_dimension_is_stratified_at_every_scale_and_offset() {
    let sobol = Sobol::<8>::new(47);
    for digits in [0, 1, 4, 10, 17] {
        for first in [0, 3u64 << digits, 5u64 << (digits + 30)] {
            let points: Vec<_> = (first..first + (1 << digits)).map(|k| sobol.point(k)).collect();
            for d in 0..8 {
                assert_eq!(n_boxes_hit(&points, (d, d), (digits, 0)), 1 << digits, "dimension {d}, {digits} digits");
            }
        }
    }
}

#[test]
fn the_first_two_dimensions_are_a_02_sequence() {
    for seed in 0..4 {
        let sobol = Sobol::<8>::new(seed);
        for digits in [2, 5, 10] {
            let points: Vec<_> = (0..1 << digits).map(|k| sobol.point(k)).collect();
            for a in 0..=digits {
                assert_eq!(n_boxes_hit(&points, (0, 1), (a, digits - a)), 1 << digits);
            }
        }
    }
}

#[test]
fn a_scrambled_point_is_uniform_over_seeds() {
    let n_cells = 32;
    for index in [0, 1, 12_345] {
        let mut counts = vec![0; n_cells * n_cells];
        for k in 0..N_SAMPLES {
            let [x, _, _, y] = Sobol::<4>::new(mix_seed(53, k)).point(index);
            counts[(x * n_cells as f64) as usize * n_cells + (y * n_cells as f64) as usize] += 1;
        }
        let expected = vec![N_SAMPLES as f64 / counts.len() as f64; counts.len()];
        let test = chi_squared_test(&counts, &expected).unwrap();
        assert!(test.p_value > sidak_level(SIGNIFICANCE, 3), "point {index}: {test:?}");
    }
}

/// The fine position of a point inside its stratum is what Owen's scrambling makes independent from stratum to stratum.
#[test]
fn positions_inside_strata_are_uncorrelated() {
    let digits = 6;
    let scale = f64::from(1u32 << digits);
    for distance in [1, 2, 7, 32] {
        let m: Moments = (0..20_000)
            .map(|k| {
                let sobol = Sobol::<1>::new(mix_seed(59, k));
                let mut inside = vec![0.0; 1 << digits];
                for i in 0..1 << digits {
                    let [x] = sobol.point(i);
                    inside[(x * scale) as usize] = (x * scale).fract() - 0.5;
                }
                inside[8] * inside[8 ^ distance]
            })
            .collect();
        let z = z_score(m.mean(), 0.0, m.variance_of_mean());
        assert!(z.abs() < critical_z(SIGNIFICANCE, 4), "distance {distance}: z = {z}");
    }
}

#[test]
fn scrambled_points_integrate_without_bias_and_at_a_higher_order() {
    // ∏ (1 + (x_d − ½) + (x_d² − ⅓)) has integral 1 in any dimension.
    let integrate = |seed: u64, n: u64| {
        let sobol = Sobol::<4>::new(mix_seed(61, seed));
        let f = |p: [f64; 4]| p.iter().map(|x| 1.0 + (x - 0.5) + (x * x - 1.0 / 3.0)).product::<f64>();
        (0..n).map(|k| f(sobol.point(k))).sum::<f64>() / n as f64
    };
    let sizes = [64u64, 256, 1024, 4096];
    let mut spreads = Vec::new();
    for n in sizes {
        let m: Moments = (0..400).map(|seed| integrate(seed, n)).collect();
        let z = z_score(m.mean(), 1.0, m.variance_of_mean());
        assert!(z.abs() < critical_z(SIGNIFICANCE, sizes.len()), "n = {n}: z = {z}");
        spreads.push(m.variance().sqrt());
    }
    // N^(−3/2) up to logarithms; Monte Carlo's −1/2 and an unscrambled net's −1 are both far off.
    let line = etendue::stats::fit_power_law(&sizes.map(|n| n as f64), &spreads).unwrap();
    assert!(line.slope < -1.25, "{line:?}");
}

/// The quality t of the first 2ᵐ points in two dimensions: every dyadic box of area 2^(t − m) holds its share, 2ᵗ points.
fn pair_quality(points: &[[f64; 32]], pair: (usize, usize), m: u32) -> u32 {
    let holds = |t: u32| {
        (0..=m - t).all(|a| {
            let mut counts = std::collections::HashMap::new();
            for p in points {
                let cell = |x: f64, digits: u32| (x * f64::from(1u32 << digits)) as u64;
                *counts.entry((cell(p[pair.0], a), cell(p[pair.1], m - t - a))).or_insert(0u32) += 1;
            }
            counts.values().all(|n| *n == 1 << t)
        })
    };
    (0..=m).find(|t| holds(*t)).expect("one box holds all")
}

/// Every one of 32 dimensions is stratified, and no two are alike: a wrong direction number would show as a pair far from a net. Neighbours, which
/// walks use together, are good ones.
#[test]
fn pairs_of_all_dimensions_are_nearly_nets() {
    let (m, sobol) = (10, Sobol::<32>::new(67));
    let points: Vec<[f64; 32]> = (0..1 << m).map(|k| sobol.point(k)).collect();
    let mut worst = 0;
    for a in 0..32 {
        let strata: HashSet<u64> = points.iter().map(|p| (p[a] * 1024.0) as u64).collect();
        assert_eq!(strata.len(), 1024, "dimension {a}");
        for b in 0..a {
            worst = worst.max(pair_quality(&points, (a, b), m));
        }
    }
    assert_eq!(worst, 6, "the worst quality of Joe and Kuo's pairs among 1024 points");
}

/// Padding keeps what walks rely on: every dimension is stratified over aligned blocks, pairs are (0, 2)-nets, different pairs are independent.
#[test]
fn padding_dimensions_are_pairs_of_nets() {
    let sobol = PaddedSobol::new(71);
    for first in [0, 3 << 8, 5 << 20] {
        for pair in [32, 34, 70] {
            let points: Vec<[f64; 2]> =
                (first..first + 256).map(|k| [0, 1].map(|d| sobol.coordinate(k, pair + d))).collect();
            for a in 0..=8u32 {
                let cell = |x: f64, digits: u32| (x * f64::from(1u32 << digits)) as u64;
                let boxes: HashSet<_> = points.iter().map(|p| (cell(p[0], a), cell(p[1], 8 - a))).collect();
                assert_eq!(boxes.len(), 256, "dimensions {pair} and {}, {a} digits", pair + 1);
            }
        }
    }
    let matches = Sobol::<32>::new(71).point(12_345);
    assert!((0..32).all(|d| sobol.coordinate(12_345, d) == matches[d]));

    // Products across pairs average to nothing more than chance leaves.
    let m: Moments = (0..N_SAMPLES)
        .map(|seed| {
            let sobol = PaddedSobol::new(mix_seed(73, seed));
            (sobol.coordinate(5, 32) - 0.5) * (sobol.coordinate(5, 34) - 0.5)
        })
        .collect();
    let z = z_score(m.mean(), 0.0, m.variance_of_mean());
    assert!(z.abs() < critical_z(SIGNIFICANCE, 1), "z = {z}");
}

#[test]
fn cumulative_rows_sample_their_probabilities_in_order() {
    let weights = [0.05, 0.0, 0.3, 0.15, 0.2];
    let rows = CumulativeRows::new(2, 5, |i, out| {
        if i == 1 {
            out.copy_from_slice(&weights)
        }
    });
    let expected = [
        (0.0, Some(0)),
        (0.049, Some(0)),
        (0.051, Some(2)),
        (0.34, Some(2)),
        (0.36, Some(3)),
        (0.69, Some(4)),
        (0.71, None),
    ];
    for (uniform, outcome) in expected {
        assert_eq!(rows.sample(1, uniform), outcome, "{uniform}");
        assert_eq!(rows.sample(0, uniform), None, "a row of zeros has no outcome");
    }
}
