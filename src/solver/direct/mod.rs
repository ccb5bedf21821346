//! Methods that factor I − K, or what it is made of.

mod cholesky;
mod factored;
mod gth;
mod low_rank;
mod lu;
mod single;
mod sparse;
mod what_if;

pub use cholesky::Cholesky;
pub use factored::Factored;
pub use gth::Gth;
pub use low_rank::LowRank;
pub use lu::{Lu, LuNalgebra};
pub use single::SingleLu;
pub use sparse::{SparseCholesky, SparseLu};
pub use what_if::RowChange;
