//! Stored matrices: full and sparse, the same numbers whichever way they are read.

use etendue::linalg::{
    Block, CholeskyFactor, Dense, FactorError, LinearOperator, LuFactor, Matrix, NalgebraLu, Sparse, max_abs,
};
use etendue::sampling::Stream;

/// n products of rounded numbers of order one, summed in two orders.
fn sum_rounding(n: usize) -> f64 {
    2.0 * n as f64 * f64::EPSILON
}

fn random_block(stream: &mut Stream, n_rows: usize, n_columns: usize) -> Block {
    Block::from_fn(n_rows, n_columns, |_, _| 2.0 * stream.uniform() - 1.0)
}

/// A share of the entries is not zero.
fn random_dense(stream: &mut Stream, n_rows: usize, n_columns: usize, share: f64) -> Dense {
    Dense::from_fn(n_rows, n_columns, |_, _| if stream.uniform() < share { 2.0 * stream.uniform() - 1.0 } else { 0.0 })
}

/// Sizes around the lanes and tasks that products are cut into.
const SIZES: [(usize, usize); 6] = [(1, 1), (7, 9), (16, 8), (17, 33), (64, 65), (130, 71)];

#[test]
fn products_are_sums_over_rows_and_columns() {
    let mut stream = Stream::new(0x6f70_6572, 0, 0);
    for (n_rows, n_columns) in SIZES {
        for share in [0.1, 1.0] {
            let dense = random_dense(&mut stream, n_rows, n_columns, share);
            let sparse = Sparse::from_operator(&dense, 0);
            assert_eq!(Dense::from_operator(&sparse, 0), dense);
            // One to six bands: columns are taken four at a time.
            for n_bands in [1, 2, 3, 4, 6] {
                let (x, z) =
                    (random_block(&mut stream, n_columns, n_bands), random_block(&mut stream, n_rows, n_bands));
                for operator in [&dense as &dyn LinearOperator, &sparse] {
                    let (mut ax, mut atz) =
                        (Block::zeros(n_rows, n_bands), random_block(&mut stream, n_columns, n_bands));
                    operator.apply(&x, &mut ax);
                    operator.apply_transpose(&z, &mut atz);
                    for band in 0..n_bands {
                        for r in 0..n_rows {
                            let expected: f64 = (0..n_columns).map(|c| dense.get(r, c) * x.get(c, band)).sum();
                            assert!((ax.get(r, band) - expected).abs() <= sum_rounding(n_columns));
                        }
                        for c in 0..n_columns {
                            let expected: f64 = (0..n_rows).map(|r| dense.get(r, c) * z.get(r, band)).sum();
                            assert!((atz.get(c, band) - expected).abs() <= sum_rounding(n_rows));
                        }
                    }
                }
            }
            let (mut row, mut column) = (vec![f64::NAN; n_columns], vec![f64::NAN; n_rows]);
            for c in 0..n_columns {
                sparse.column(0, c, &mut column);
                assert!((0..n_rows).all(|r| column[r] == dense.get(r, c)));
            }
            for r in 0..n_rows {
                sparse.row(0, r, &mut row);
                assert_eq!(row, dense.row_slice(r));
            }
        }
    }
}

#[test]
fn symmetric_matrices_hold_the_same_bits_twice_and_choose_their_form() {
    let mut stream = Stream::new(0x7379_6d6d, 0, 0);
    for n in [1, 5, 63, 64, 130] {
        for share in [0.02, 0.9] {
            let mut entry = |c: usize| (stream.uniform() < share).then(|| (c as u32, stream.uniform()));
            let upper: Vec<Vec<(u32, f64)>> = (0..n).map(|r| (r..n).filter_map(&mut entry).collect()).collect();
            let mut matrix = Matrix::symmetric(&upper);
            assert!(n < 10 || matches!(matrix, Matrix::Sparse(_)) == (share < 0.1));
            let scale: Vec<f64> = (0..n).map(|_| 0.5 + stream.uniform()).collect();
            let (mut row, mut column) = (vec![0.0; n], vec![0.0; n]);
            for is_scaled in [false, true] {
                for r in 0..n {
                    matrix.row(0, r, &mut row);
                    matrix.column(0, r, &mut column);
                    assert!(row.iter().zip(&column).all(|(a, b)| a.to_bits() == b.to_bits()));
                    for (c, v) in &upper[r] {
                        let c = *c as usize;
                        assert_eq!(row[c], if is_scaled { v * (scale[r] * scale[c]) } else { *v });
                    }
                    let mut visited = vec![0.0; n];
                    matrix.for_each_in_row(r, |c, v| visited[c] += v);
                    assert_eq!(visited, row);
                }
                if !is_scaled {
                    matrix.map_entries(|r, c, v| v * (scale[r] * scale[c]));
                }
            }
        }
    }
}

#[test]
fn factorizations_solve_and_refuse_by_number() {
    let mut stream = Stream::new(0x6661_6374, 0, 0);
    for n in [1, 2, 30, 131] {
        // Diagonally dominant, so that the condition is a few units: errors are some n ulp.
        let b = random_dense(&mut stream, n, n, 1.0);
        let symmetric =
            Dense::from_fn(n, n, |r, c| b.get(r, c) + b.get(c, r) + if r == c { 4.0 * n as f64 } else { 0.0 });
        let x = random_block(&mut stream, n, 3);
        let mut right = Block::zeros(n, 3);
        symmetric.apply(&x, &mut right);
        let (mut lu, mut nalgebra, mut cholesky) = (right.clone(), right.clone(), right.clone());
        LuFactor::new(&symmetric).unwrap().solve(&mut lu);
        NalgebraLu::new(&symmetric).unwrap().solve(&mut nalgebra);
        CholeskyFactor::new(&symmetric).unwrap().solve(&mut cholesky);
        for found in [lu, nalgebra, cholesky] {
            assert!(etendue::compare::relative_max(&found, &x) < 10.0 * sum_rounding(n + 10));
        }
    }

    let rank_one = Dense::from_fn(3, 3, |r, c| ((r + 1) * (c + 1)) as f64);
    for error in [LuFactor::new(&rank_one).err(), NalgebraLu::new(&rank_one).err()] {
        assert!(matches!(error, Some(FactorError::Singular { size: 3, value: 0.0, .. })), "{error:?}");
    }
    assert!(matches!(CholeskyFactor::new(&rank_one), Err(FactorError::NotPositiveDefinite { pivot: 1, size: 3 })));
    let mut broken = rank_one;
    broken.row_mut(2)[1] = f64::NAN;
    let error = LuFactor::new(&broken).err();
    assert!(matches!(error, Some(FactorError::NotFinite { row: 2, column: 1, .. })), "{error:?}");
}

#[test]
fn the_largest_magnitude_notices_what_is_not_a_number() {
    assert_eq!(max_abs(&[]), 0.0);
    assert_eq!(max_abs(&[1.0, -3.0, 2.0]), 3.0);
    for place in 0..3 {
        let mut values = [1.0, 2.0, 3.0];
        values[place] = f64::NAN;
        assert!(max_abs(&values).is_nan());
    }
}
