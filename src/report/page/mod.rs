//! One self-contained page: no scripts, nothing fetched, figures and pictures inside.

mod albedo;
mod estimators;
mod markup;
mod matrices;
mod methods;
mod origin;
mod refinement;
mod verdict;

use super::Artifact;
use super::number::{count, significant, trimmed};
use super::picture::{PicturesOnPage, Shown};
use crate::study::StudyOutcome;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use markup::{escape, section};

/// A figure to be set into the page.
pub struct FigureOnPage {
    /// Name of its files, without ending.
    pub name: &'static str,
    pub svg: String,
}

/// All figures of a page.
pub struct FiguresOnPage {
    pub convergence: FigureOnPage,
    /// Where other albedos were looked at.
    pub albedos: Option<FigureOnPage>,
    pub truncation: FigureOnPage,
    pub monte_carlo: FigureOnPage,
    /// Where it was run.
    pub sequential: Option<FigureOnPage>,
    pub refinement: FigureOnPage,
}

const STYLE: &str = include_str!("style.css");

/// The page as HTML. `files` are offered for download.
pub fn page(
    outcome: &StudyOutcome,
    figures: &FiguresOnPage,
    shown: Option<&PicturesOnPage>,
    files: &[Artifact],
) -> String {
    let albedos = outcome.albedos.as_ref().zip(figures.albedos.as_ref());
    let title = escape(&outcome.scene);
    let body = [
        header(outcome),
        shown.map(|shown| pictures(outcome, shown)).unwrap_or_default(),
        methods::solvers(outcome, &figures.convergence),
        albedos.map(|(study, figure)| albedo::albedos(study, figure)).unwrap_or_default(),
        methods::truncation(outcome, &figures.truncation),
        estimators::estimators(outcome, &figures.monte_carlo, figures.sequential.as_ref()),
        refinement::refinement(outcome, &figures.refinement),
        matrices::matrices(outcome),
        origin::stages(outcome),
        origin::provenance(outcome),
        origin::downloads(files),
    ];
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"generator\" content=\"etendue {}\">\n<title>{title} · etendue</title>\n<style>\n{STYLE}</style>\n</head>\n\
         <body>\n<main>\n{}</main>\n</body>\n</html>\n",
        escape(&outcome.provenance.version),
        body.concat()
    )
}

/// The scene, the result in one sentence, and the size of the problem.
fn header(outcome: &StudyOutcome) -> String {
    let seconds: f64 = outcome.stages.iter().map(|(_, s)| s).sum();
    let facts = [
        (count(outcome.n_bundles as u64), "ray bundles"),
        (count(outcome.bands.len() as u64), "colour bands"),
        (trimmed(outcome.provenance.patch_size, 3), "patch size"),
        (super::number::seconds(seconds), "in all"),
    ];
    let facts = facts.iter().map(|(number, name)| format!("<li><b>{}</b> {}</li>", escape(number), escape(name)));
    let notes = outcome.tessellations.iter().map(|note| format!("<p class=\"note\">{}</p>\n", escape(note)));
    format!(
        "<header>\n<p class=\"kind\">A study of light transport as linear algebra, <i>L</i> = <i>E</i> + <i>K</i> <i>L</i></p>\n\
         <h1>{}</h1>\n<p class=\"result\">{}</p>\n<ul class=\"facts\">{}</ul>\n{}</header>\n",
        escape(&outcome.scene),
        escape(&verdict::sentence(outcome)),
        facts.collect::<String>(),
        notes.collect::<String>()
    )
}

/// The solved picture, and the strip of bounces under it.
fn pictures(outcome: &StudyOutcome, on_page: &PicturesOnPage) -> String {
    let solved = picture(&on_page.solved, &format!("{} from its camera, solved", outcome.scene));
    let strip =
        on_page.bounces.iter().map(|shown| picture(shown, &format!("{} after {}", outcome.scene, shown.caption)));
    let grey = if on_page.grey { ", the mean of all bands in grey" } else { "" };
    let lead = format!(
        "The solved light field from the scene's camera, and the partial sums E, E + K E, E + K E + K²E, … beneath it. \
         All pictures share one exposure (× {}{grey}); values above 0.8 roll off smoothly to white.",
        significant(on_page.exposure, 3)
    );
    let strip = if on_page.bounces.is_empty() {
        String::new()
    } else {
        format!("<div class=\"strip\">\n{}</div>\n", strip.collect::<String>())
    };
    section("picture", "What there is to see", &lead, &format!("<div class=\"solved\">{solved}</div>\n{strip}"))
}

fn picture(shown: &Shown, description: &str) -> String {
    format!(
        "<figure class=\"picture\"><img alt=\"{}\" src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
        escape(description),
        STANDARD.encode(&shown.png),
        escape(&shown.caption)
    )
}

/// A figure on a white card with its caption and its files.
fn figure(figure: &FigureOnPage, description: &str, caption: &str) -> String {
    // HTML knows SVG without being told its name space, and the page then mentions no address at all.
    let label = format!("<svg role=\"img\" aria-label=\"{}\" ", escape(description));
    let svg = figure.svg.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1).replacen("<svg ", &label, 1);
    let links = ["svg", "png", "csv"]
        .map(|ending| format!("<a href=\"{0}.{ending}\">{1}</a>", figure.name, ending.to_uppercase()));
    format!(
        "<figure class=\"card\">\n{svg}<figcaption>{} <span class=\"files\">{}</span></figcaption>\n</figure>\n",
        escape(caption),
        links.join(" ")
    )
}
