//! Bins of directions: every partition × every law.

use etendue::basis::{Directions, DirectionsError};
use etendue::geometry::Vec3;
use etendue::sampling::{Streams, warp};
use etendue::stats::{chi_squared_test, sidak_level};
use std::f64::consts::PI;

/// Family-wise significance of the random test.
const SIGNIFICANCE: f64 = 1e-6;
/// A few ulp of π, for sums of up to some thousand terms.
const SUM: f64 = 1e-13;

fn partitions() -> Vec<Directions> {
    let mut all = vec![
        Directions::whole(),
        Directions::klems(),
        Directions::klems_half(),
        Directions::klems_quarter(),
        Directions::tregenza(),
    ];
    all.extend([1, 2, 4].map(|n| Directions::reinhart(n).unwrap()));
    all.extend([(1, 2), (8, 1), (4, 12), (9, 2)].map(|(rings, sectors)| Directions::polar(rings, sectors).unwrap()));
    all.extend((1..=40).chain([100, 145, 1000]).map(|n| Directions::equal_etendue(n).unwrap()));
    all.extend([1, 2, 3, 8, 16].map(|n| Directions::shirley_chiu(n).unwrap()));
    all
}

#[test]
fn published_partitions_have_their_counts() {
    let counts = |d: Directions| d.n_bins();
    assert_eq!(counts(Directions::klems()), 145);
    assert_eq!(counts(Directions::klems_half()), 73);
    assert_eq!(counts(Directions::klems_quarter()), 41);
    assert_eq!(counts(Directions::tregenza()), 145);
    assert_eq!([2, 4].map(|n| counts(Directions::reinhart(n).unwrap())), [577, 2305]);
    for n in 1..500 {
        assert_eq!(counts(Directions::equal_etendue(n).unwrap()), n);
    }
}

#[test]
fn projected_solid_angles_sum_to_pi() {
    for directions in partitions() {
        let all: Vec<f64> = (0..directions.n_bins()).map(|bin| directions.projected_solid_angle(bin)).collect();
        assert!(all.iter().all(|omega| *omega > 0.0), "{directions}");
        assert!((all.iter().sum::<f64>() / PI - 1.0).abs() <= SUM, "{directions}");
    }
}

/// What is drawn from a bin lies in it, and what lies opposite lies in the mirrored bin, which weighs the same.
#[test]
fn mirrors_permute_the_bins() {
    for directions in partitions() {
        let mut stream = Streams::new(3, "bins").stream(0, 0);
        for bin in 0..directions.n_bins() {
            let mirrored = directions.mirrored(bin);
            assert_eq!(directions.mirrored(mirrored), bin, "{directions}");
            let [here, there] = [bin, mirrored].map(|bin| directions.projected_solid_angle(bin));
            assert_eq!(here.to_bits(), there.to_bits(), "{directions}");
            for _ in 0..8 {
                let w = directions.sample(bin, stream.uniform2());
                assert!((w.length() - 1.0).abs() < 1e-14 && w.z >= 0.0);
                assert_eq!(directions.locate(w), bin, "{directions}: {w}");
                assert_eq!(directions.locate(Vec3::new(-w.x, -w.y, w.z)), mirrored, "{directions}: {w}");
            }
        }
    }
}

/// Directions with density cosθ/π fall into each bin in proportion to its projected solid angle.
#[test]
fn bins_hold_the_share_that_they_say() {
    const N: usize = 100_000;
    let all = partitions();
    let level = sidak_level(SIGNIFICANCE, all.len());
    for (k, directions) in all.iter().enumerate().filter(|(_, d)| d.n_bins() > 1) {
        let mut stream = Streams::new(4, "shares").stream(k as u32, 0);
        let mut counts = vec![0; directions.n_bins()];
        for _ in 0..N {
            counts[directions.locate(warp::cosine_hemisphere(stream.uniform2()).into())] += 1;
        }
        let expected: Vec<f64> =
            (0..counts.len()).map(|bin| N as f64 * directions.projected_solid_angle(bin) / PI).collect();
        let test = chi_squared_test(&counts, &expected).unwrap();
        assert!(test.p_value > level, "{directions}: {test:?}");
    }
}

#[test]
fn counts_that_make_no_partition_are_refused() {
    let limit = Directions::LIMIT;
    assert_eq!(Directions::equal_etendue(0), Err(DirectionsError::Count { found: 0, limit }));
    assert_eq!(Directions::polar(3, 5), Err(DirectionsError::OddSectors { found: 5 }));
    assert!(Directions::shirley_chiu(usize::MAX).is_err() && Directions::reinhart(usize::MAX).is_err());
    assert!(Directions::reinhart(0).is_err());
}
