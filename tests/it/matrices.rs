//! Matrix files: what is written reads back to the same bits, and what is no matrix is refused.

use etendue::linalg::format::{MatrixFileCode, MatrixFormat, Place, read_matrix};
use etendue::linalg::{Dense, LinearOperator, Matrix, Sparse};
use proptest::prelude::*;
use std::path::PathBuf;

/// More than any file here may take.
const PLENTY: u64 = 1 << 24;

fn file(folder: &tempfile::TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Reads bytes as a file of this ending.
fn read(ending: &str, bytes: &[u8], limit: u64) -> Result<Vec<Matrix>, etendue::linalg::format::MatrixFileError> {
    let folder = tempfile::tempdir().unwrap();
    read_matrix(&file(&folder, &format!("K.{ending}"), bytes), limit)
}

/// Numbers that are hard to print.
fn awkward() -> Dense {
    let hard = [0.1, 1.0 / 3.0, 5e-324, f64::MAX, -0.0, 1e-17, 123_456_789.123_456_79, -2.5];
    Dense::from_fn(4, 6, |r, c| hard[(3 * r + c) % hard.len()] * if (r + c) % 3 == 0 { 0.0 } else { 1.0 })
}

fn bits(matrix: &Matrix) -> Vec<u64> {
    let mut row = vec![0.0; matrix.n_columns()];
    (0..matrix.n_rows())
        .flat_map(|r| {
            matrix.row(0, r, &mut row);
            // Where nothing is stored, zero has no sign.
            row.iter().map(|v| (v + 0.0).to_bits()).collect::<Vec<_>>()
        })
        .collect()
}

#[test]
fn what_is_written_reads_back_to_the_same_bits() {
    let dense = Matrix::Dense(awkward());
    let sparse = Matrix::Sparse(Sparse::from_operator(&awkward(), 0));
    for format in MatrixFormat::ALL {
        for matrix in [&dense, &sparse] {
            let back = read(format.extension(), &format.write(&[matrix]), PLENTY).unwrap();
            assert_eq!((back.len(), bits(&back[0])), (1, bits(matrix)), "{format}");
        }
    }
    let other = Matrix::Dense(Dense::from_fn(4, 6, |r, c| (r * c) as f64));
    let back = read("rmx", &MatrixFormat::Radiance.write(&[&dense, &other]), PLENTY).unwrap();
    assert_eq!([bits(&back[0]), bits(&back[1])], [bits(&dense), bits(&other)]);
}

#[test]
fn matrix_market_of_every_kind_is_understood() {
    let read = |text: &str| bits(&read("mtx", text.as_bytes(), PLENTY).unwrap()[0]);
    let of = |rows: [[f64; 2]; 2]| bits(&Matrix::Dense(Dense::from_fn(2, 2, |r, c| rows[r][c])));
    let general = "%%MatrixMarket matrix coordinate real general\n% a remark\n\n2 2 3\n2 1 4\n1 1 1e0\n 1 2 -.5 \n";
    assert_eq!(read(general), of([[1.0, -0.5], [4.0, 0.0]]));
    let symmetric = "%%MatrixMarket MATRIX Coordinate Integer Symmetric\n2 2 2\n1 1 3\n2 1 7\n";
    assert_eq!(read(symmetric), of([[3.0, 7.0], [7.0, 0.0]]));
    let skew = "%%MatrixMarket matrix array real skew-symmetric\n2 2\n2.5\n";
    assert_eq!(read(skew), of([[0.0, -2.5], [2.5, 0.0]]));
    let pattern = "%%MatrixMarket matrix coordinate pattern general\n2 2 1\n1 2\n";
    assert_eq!(read(pattern), of([[0.0, 1.0], [0.0, 0.0]]));
    // Arrays go column by column.
    let array = "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n";
    assert_eq!(read(array), of([[1.0, 3.0], [2.0, 4.0]]));
}

#[test]
fn refusals_say_where_and_what() {
    let cases: [(&str, MatrixFileCode, Option<(usize, usize)>); 9] = [
        ("hello\n", MatrixFileCode::Malformed, Some((1, 1))),
        ("%%MatrixMarket matrix array complex general\n1 1\n1\n", MatrixFileCode::Malformed, Some((1, 1))),
        ("%%MatrixMarket matrix array real general\n2 x\n", MatrixFileCode::InvalidNumber, Some((2, 3))),
        ("%%MatrixMarket matrix coordinate real general\n2 2 1\n3 1 1\n", MatrixFileCode::OutOfRange, Some((3, 1))),
        ("%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1 1 1\n", MatrixFileCode::Malformed, Some((3, 7))),
        ("%%MatrixMarket matrix array real general\n1 1\nnan\n", MatrixFileCode::InvalidNumber, None),
        ("%%MatrixMarket matrix array real general\n1 2\n1\n", MatrixFileCode::Truncated, Some((4, 1))),
        ("%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n1 1 2\n", MatrixFileCode::Malformed, None),
        ("%%MatrixMarket matrix array real symmetric\n1 2\n1\n", MatrixFileCode::WrongShape, None),
    ];
    for (text, code, place) in cases {
        let error = read("mtx", text.as_bytes(), PLENTY).unwrap_err();
        assert_eq!(error.code, code, "{text}: {error}");
        let expected = place.map_or(Place::File, |(line, column)| Place::Text { line, column });
        assert_eq!(error.place, expected, "{text}: {error}");
    }
    let error = read("csv", b"1,2", PLENTY).unwrap_err();
    assert_eq!(error.code, MatrixFileCode::UnknownFormat);
    assert!(error.to_string().contains(".mtx, .npz, .rmx"), "{error}");
}

#[test]
fn nothing_is_held_beyond_the_limit() {
    // A few bytes that announce much: refused before anything is stored.
    for text in [
        "%%MatrixMarket matrix coordinate real general\n4000000000 4 0\n".to_string(),
        "%%MatrixMarket matrix array real general\n100000 100000\n1\n".to_string(),
        "%%MatrixMarket matrix coordinate real general\n4 4 9000000000\n1 1 1\n".to_string(),
    ] {
        let code = read("mtx", text.as_bytes(), PLENTY).unwrap_err().code;
        assert!([MatrixFileCode::TooLarge, MatrixFileCode::Truncated].contains(&code), "{text}: {code}");
    }
    let header = b"#?RADIANCE\nNROWS=1000000\nNCOLS=1000000\nFORMAT=double\n\n";
    assert_eq!(read("rmx", header, PLENTY).unwrap_err().code, MatrixFileCode::Truncated);

    // A limit below what a file takes, and at it.
    let matrix = Matrix::Dense(awkward());
    for format in MatrixFormat::ALL {
        let bytes = format.write(&[&matrix]);
        let code = read(format.extension(), &bytes, bytes.len() as u64).unwrap_err().code;
        assert_eq!(code, MatrixFileCode::TooLarge, "{format}");
        assert!(read(format.extension(), &bytes, 8 * bytes.len() as u64).is_ok(), "{format}");
    }
}

proptest! {
    // Enough to meet every byte of every header some times.
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn damaged_files_are_refused_or_read_and_never_panic(
        which in 0..6usize, cut in 0.0..1.0f64, at in 0.0..1.0f64, byte in any::<u8>(), is_cut in any::<bool>()
    ) {
        let format = MatrixFormat::ALL[which % 3];
        let matrix = match which / 3 {
            0 => Matrix::Dense(awkward()),
            _ => Matrix::Sparse(Sparse::from_operator(&awkward(), 0)),
        };
        let mut bytes = format.write(&[&matrix]);
        let place = |share: f64, n: usize| ((share * n as f64) as usize).min(n - 1);
        let n = bytes.len();
        bytes[place(at, n)] = byte;
        if is_cut {
            bytes.truncate(place(cut, n));
        }
        if let Ok(read) = read(format.extension(), &bytes, PLENTY) {
            for matrix in read {
                let mut row = vec![0.0; matrix.n_columns()];
                for r in 0..matrix.n_rows() {
                    matrix.row(0, r, &mut row);
                    prop_assert!(row.iter().all(|v| v.is_finite()));
                }
            }
        }
    }
}
