//! Figures worth a paper: each takes plain data, fills a sheet, and becomes SVG and PNG through the same strokes.

mod albedos;
mod axis;
mod convergence;
mod families;
mod monte_carlo;
mod paint;
mod palette;
mod panel;
mod refinement;
mod sequential;
mod sheet;
mod spectrum;
mod strip;
mod truncation;

pub use albedos::albedos;
pub use convergence::convergence;
pub use monte_carlo::monte_carlo;
pub use paint::{to_png, to_svg};
pub use refinement::refinement;
pub use sequential::sequential;
pub use sheet::Sheet;
pub use spectrum::spectrum;
pub use strip::strip;
pub use truncation::truncation;
