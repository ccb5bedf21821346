//! Blocks of vectors in twice the digits.

use super::Block;

/// high + low, with |low| at most some ulp of |high|: what rounding took from a sum is carried along (Knuth 1969).
#[derive(Clone, Debug, PartialEq)]
pub struct Doubled {
    pub high: Block,
    pub low: Block,
}

impl From<Block> for Doubled {
    fn from(high: Block) -> Self {
        let low = Block::zeros(high.n_rows(), high.n_columns());
        Self { high, low }
    }
}

impl Doubled {
    /// self ← self + x.
    pub fn add(&mut self, x: &Block) {
        let pairs = self.high.values_mut().iter_mut().zip(self.low.values_mut()).zip(x.values());
        pairs.for_each(|((high, low), x)| add(high, low, *x));
    }

    /// One column ← that column + factor · x.
    pub fn add_scaled(&mut self, column: usize, factor: f64, x: &[f64]) {
        let pairs = self.high.column_mut(column).iter_mut().zip(self.low.column_mut(column)).zip(x);
        pairs.for_each(|((high, low), x)| add(high, low, factor * x));
    }
}

fn add(high: &mut f64, low: &mut f64, x: f64) {
    let (sum, lost) = two_sum(*high, x);
    (*high, *low) = two_sum(sum, *low + lost);
}

/// a + b as it is rounded, and what that took from it.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_small_is_not_forgotten() {
        let mut sum = Doubled::from(Block::from_fn(1, 1, |_, _| 1.0));
        let small = Block::from_fn(1, 1, |_, _| 1e-20);
        (0..1000).for_each(|_| sum.add(&small));
        assert_eq!(sum.high.get(0, 0), 1.0);
        // A thousand additions of an ulp of 1e-17 at most.
        assert!((sum.low.get(0, 0) - 1e-17).abs() < 1e-29, "{:e}", sum.low.get(0, 0));
    }
}
