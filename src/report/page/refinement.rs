//! The matrix against the scene itself.

use super::markup::{Column, Table, section};
use super::verdict::percent;
use super::{FigureOnPage, figure};
use crate::report::number::{count, significant, with_error};
use crate::study::StudyOutcome;

/// Refinement figure and the means of every surface at the finest level.
pub fn refinement(outcome: &StudyOutcome, on_page: &FigureOnPage) -> String {
    use Column::{Numbers, Words};
    let study = &outcome.refinement;
    let mut table = Table::new(&[
        ("surface", Words),
        ("band", Words),
        ("matrix", Numbers),
        ("path tracer", Numbers),
        ("difference", Numbers),
        ("discretisation error", Numbers),
    ]);
    let mut above = "";
    for mean in &study.surfaces {
        // Name a surface once.
        let surface = if mean.surface == above { "" } else { &mean.surface };
        above = &mean.surface;
        table.row(&[
            surface,
            &mean.band,
            &significant(mean.matrix, 5),
            &with_error(mean.path_tracer, mean.standard_error),
            &if mean.is_comparable {
                percent((mean.matrix - mean.path_tracer) / mean.path_tracer)
            } else {
                "too few paths".into()
            },
            &significant(mean.discretisation_error, 2),
        ]);
    }
    let n_dark = study.surfaces.iter().filter(|mean| !mean.is_comparable).count();
    let left_out = match n_dark {
        0 => String::new(),
        n => format!(" Of {} means {} rest on too few paths to be compared.", study.surfaces.len(), count(n as u64)),
    };
    let agreement = if study.agrees { "agrees" } else { "does not agree" };
    let order = if study.observed_order.is_finite() {
        format!(", at observed order {}", with_error(study.observed_order, study.order_standard_error))
    } else {
        "; how fast, the path tracer's noise hides".to_string()
    };
    let lead = format!(
        "Finer patches bring the discrete truth to the continuous one{order}. At the finest level every surface's mean {agreement} \
         with the path tracer's within discretisation plus statistical error.{left_out}"
    );
    let shown = figure(
        on_page,
        "Difference of the surface means from the path tracer against patch size, both logarithmic, with the fitted order",
        "Area-weighted root mean square difference of the surfaces' mean reflected radiance from the path tracer's, relative; whiskers and the shaded floor are \
         the path tracer's own noise.",
    );
    let means = if study.surfaces.is_empty() {
        String::new()
    } else {
        table.html("Mean outgoing radiance of every surface at the finest level, W m⁻² sr⁻¹.")
    };
    section("refinement", "From the matrix to the scene", &lead, &(shown + &means))
}
