//! Direction numbers of Sobol's sequence: the generating matrix of every dimension, column by column.

/// Dimensions there are direction numbers for.
pub const N_SOBOL_DIMENSIONS: usize = 32;

/// Digits of an index and of a coordinate.
pub(super) const N_BITS: usize = 64;

/// (degree, inner coefficients of the primitive polynomial over GF(2), first direction numbers), from the second dimension on;
/// the values of Joe & Kuo 2008 (table new-joe-kuo-6), chosen there for good two-dimensional projections.
const POLYNOMIALS: [(usize, u64, [u64; 7]); N_SOBOL_DIMENSIONS - 1] = [
    (1, 0, [1, 0, 0, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0, 0, 0]),
    (4, 4, [1, 3, 5, 13, 0, 0, 0]),
    (5, 2, [1, 1, 5, 5, 17, 0, 0]),
    (5, 4, [1, 1, 5, 5, 5, 0, 0]),
    (5, 7, [1, 1, 7, 11, 19, 0, 0]),
    (5, 11, [1, 1, 5, 1, 1, 0, 0]),
    (5, 13, [1, 1, 1, 3, 11, 0, 0]),
    (5, 14, [1, 3, 5, 5, 31, 0, 0]),
    (6, 1, [1, 3, 3, 9, 7, 49, 0]),
    (6, 13, [1, 1, 1, 15, 21, 21, 0]),
    (6, 16, [1, 3, 1, 13, 27, 49, 0]),
    (6, 19, [1, 1, 1, 15, 7, 5, 0]),
    (6, 22, [1, 3, 1, 15, 13, 25, 0]),
    (6, 25, [1, 1, 5, 5, 19, 61, 0]),
    (7, 1, [1, 3, 7, 11, 23, 15, 103]),
    (7, 4, [1, 3, 7, 13, 13, 15, 69]),
    (7, 7, [1, 1, 3, 13, 7, 35, 63]),
    (7, 8, [1, 3, 5, 9, 1, 25, 53]),
    (7, 14, [1, 3, 1, 13, 9, 35, 107]),
    (7, 19, [1, 3, 1, 5, 27, 61, 31]),
    (7, 21, [1, 1, 5, 11, 19, 41, 61]),
    (7, 28, [1, 3, 5, 3, 3, 13, 69]),
    (7, 31, [1, 1, 7, 13, 1, 19, 1]),
    (7, 32, [1, 3, 7, 5, 13, 19, 59]),
    (7, 37, [1, 1, 3, 9, 25, 29, 41]),
    (7, 41, [1, 3, 5, 13, 23, 1, 55]),
    (7, 42, [1, 3, 7, 3, 13, 59, 17]),
];

/// Column k of dimension d's generating matrix, most significant digit first.
pub(super) static DIRECTIONS: [[u64; N_BITS]; N_SOBOL_DIMENSIONS] = directions();

/// The direction numbers by the recurrence of each primitive polynomial (Bratley & Fox 1988); the first dimension is van der Corput's.
const fn directions() -> [[u64; N_BITS]; N_SOBOL_DIMENSIONS] {
    let mut all = [[0; N_BITS]; N_SOBOL_DIMENSIONS];
    let mut k = 0;
    while k < N_BITS {
        all[0][k] = 1 << (N_BITS - 1 - k);
        k += 1;
    }
    let mut dimension = 1;
    while dimension < N_SOBOL_DIMENSIONS {
        let (degree, coefficients, first) = POLYNOMIALS[dimension - 1];
        let mut k = 0;
        while k < N_BITS {
            all[dimension][k] = if k < degree {
                first[k] << (N_BITS - 1 - k)
            } else {
                let mut v = all[dimension][k - degree] ^ (all[dimension][k - degree] >> degree);
                let mut j = 1;
                while j < degree {
                    if (coefficients >> (degree - 1 - j)) & 1 == 1 {
                        v ^= all[dimension][k - j];
                    }
                    j += 1;
                }
                v
            };
            k += 1;
        }
        dimension += 1;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generating_matrices_are_unit_upper_triangular() {
        for columns in &DIRECTIONS {
            for (k, column) in columns.iter().enumerate() {
                assert_eq!(column.trailing_zeros() as usize, N_BITS - 1 - k);
            }
        }
    }

    /// Powers of x modulo each polynomial run through all that is not zero before they come back to 1, and no two polynomials are the same.
    #[test]
    fn polynomials_are_primitive_and_distinct() {
        let mut seen = std::collections::HashSet::new();
        for (degree, coefficients, first) in POLYNOMIALS {
            let polynomial = 1 << degree | coefficients << 1 | 1;
            assert!(seen.insert(polynomial), "{polynomial:b} comes twice");
            let (mut power, mut order) = (1u64, 0);
            loop {
                power <<= 1;
                if power >> degree & 1 == 1 {
                    power ^= polynomial;
                }
                order += 1;
                if power == 1 || order > 1 << degree {
                    break;
                }
            }
            assert_eq!(order, (1 << degree) - 1, "{polynomial:b}");
            let fits = |(k, m): (usize, &u64)| m % 2 == 1 && *m < 2 << k;
            assert!(first[..degree].iter().enumerate().all(fits) && first[degree..].iter().all(|m| *m == 0));
        }
    }
}
