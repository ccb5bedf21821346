//! Room to work in that operators keep between products.

use super::Block;
use std::sync::Mutex;

/// A block that is allocated at the first use. Clones start empty, and equal each other.
#[derive(Debug, Default)]
pub struct Scratch(Mutex<Block>);

impl Scratch {
    /// Calls `work` with a block of this shape, its contents arbitrary. Two calls at once do not wait for each other: the second allocates.
    pub fn with<R>(&self, n_rows: usize, n_columns: usize, work: impl FnOnce(&mut Block) -> R) -> R {
        let Ok(mut kept) = self.0.try_lock() else { return work(&mut Block::zeros(n_rows, n_columns)) };
        if (kept.n_rows(), kept.n_columns()) != (n_rows, n_columns) {
            *kept = Block::zeros(n_rows, n_columns);
        }
        work(&mut kept)
    }
}

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for Scratch {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
