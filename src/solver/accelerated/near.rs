//! What the strongest entries of K do on their own: patches that share an edge, which no coarse space sees.
//!
//! ```text
//! z = r + N r + N² r + N³ r ≈ (I − N)⁻¹ r,      Nᵢⱼ = Kᵢⱼ where (wᵢ/wⱼ)^½ Kᵢⱼ is above 4/n, else 0
//! ```
//!
//! Along a concave edge the pairs of patches that touch exchange as much on any mesh, so that a tile of patches never stands for them.
//! N is as self-adjoint as K, and 1 + λ + λ² + λ³ > 0 for |λ| < 1, so that z is fit to precondition conjugate gradients.

/// An entry is strong from so many times 1/n on: what a row would hold if it went everywhere alike.
pub(super) const STRONG: f64 = 4.0;

/// Powers of N in the series.
const N_POWERS: usize = 3;

/// N of one band, row by row.
pub(super) struct Near {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Near {
    /// From the rows' strong entries.
    pub fn from_rows(rows: &[Vec<(u32, f64)>]) -> Self {
        let starts = std::iter::once(0).chain(rows.iter().scan(0, |end, row| {
            *end += row.len();
            Some(*end)
        }));
        let entries = || rows.iter().flatten();
        Self {
            starts: starts.collect(),
            columns: entries().map(|e| e.0).collect(),
            values: entries().map(|e| e.1).collect(),
        }
    }

    /// Entries that [`Near::apply`] reads.
    pub fn n_read(&self) -> usize {
        N_POWERS * self.values.len()
    }

    /// z ← r + N r + N² r + N³ r, by Horner's scheme; `scratch` is room to work in.
    pub fn apply(&self, r: &[f64], scratch: &mut [f64], z: &mut [f64]) {
        z.copy_from_slice(r);
        for _ in 0..N_POWERS {
            scratch.copy_from_slice(z);
            for (i, (z, r)) in z.iter_mut().zip(r).enumerate() {
                let row = self.starts[i]..self.starts[i + 1];
                let gathered: f64 = self.columns[row.clone()]
                    .iter()
                    .zip(&self.values[row])
                    .map(|(j, k)| k * scratch[*j as usize])
                    .sum();
                *z = r + gathered;
            }
        }
    }
}
