//! The leading eigenvalues of K in the complex plane, inside the circle that bounds them, and how they and the singular values fall.

use super::axis::Axis;
use super::palette::{Look, look};
use super::panel::{NORMAL, Panel, SMALL};
use super::sheet::{Anchor, GREY, INK, Sheet, Stroke};
use crate::report::number::significant;
use crate::study::BandSpectrum;
use std::f64::consts::TAU;

const WIDTH: u32 = 920;
const SIDE: f64 = 320.0;
const LEFT: f64 = 56.0;
const TOP: f64 = 48.0;
const FOOT: f64 = 52.0;
const BETWEEN: f64 = 70.0;
const KEY: f64 = 150.0;

/// Points of a circle.
const N_POINTS: usize = 240;

/// Eigenvalues that lie on one line are drawn as bars across it, the bands one above the other.
const BAR: f64 = 9.0;

/// Numbers along the list that have a label of their own.
const MOST_NUMBERS: usize = 12;

/// Eigenvalues of every band with the circle of its spectral radius and the unit circle; beside them magnitudes in order.
pub fn spectrum(bands: &[BandSpectrum]) -> Sheet {
    let mut sheet = Sheet::new(WIDTH, (TOP + SIDE + FOOT) as u32);
    draw_plane(&mut sheet, bands);
    draw_magnitudes(&mut sheet, bands);
    draw_key(&mut sheet, bands);
    sheet
}

fn draw_plane(sheet: &mut Sheet, bands: &[BandSpectrum]) {
    let axis = || Axis::linear_between(-1.05, 1.05);
    let panel = Panel { left: LEFT, top: TOP, right: LEFT + SIDE, bottom: TOP + SIDE, x: axis(), y: axis() };
    // On the real line one band would hide another: there bars stand above each other.
    let are_real = bands.iter().flat_map(|band| &band.eigenvalues).all(|[_, im]| *im == 0.0);
    let x_name =
        if are_real && bands.len() > 1 { "real part; all are real, a row of bars a band" } else { "real part" };
    panel.draw_axes(sheet, x_name, "Eigenvalues of K: imaginary part", true);
    let circle = |radius: f64| {
        (0..=N_POINTS).map(move |k| {
            let (sine, cosine) = (TAU * k as f64 / N_POINTS as f64).sin_cos();
            (radius * cosine, radius * sine)
        })
    };
    panel.line(sheet, circle(1.0), Stroke::solid(GREY, 0.75));
    if let Some((x, y)) = panel.place(0.5_f64.sqrt(), 0.5_f64.sqrt()) {
        sheet.words((x + 4.0, y - 6.0), "|λ| = 1", SMALL, GREY, Anchor::Start);
    }
    for (i, band) in bands.iter().enumerate() {
        if band.radius[1].is_finite() {
            panel.line(sheet, circle(band.radius[1]), look(i).dashed());
        }
    }

    if are_real {
        let middle = 0.5 * (bands.len() as f64 - 1.0);
        for (i, band) in bands.iter().enumerate() {
            let shift = BAR * (i as f64 - middle);
            for (x, y) in band.eigenvalues.iter().filter_map(|[re, im]| panel.place(*re, *im)) {
                let ends = [y + shift - 0.42 * BAR, y + shift + 0.42 * BAR];
                sheet.line(ends.map(|y| (x, y)).to_vec(), Stroke::solid(look(i).colour, 2.0));
            }
        }
        return;
    }
    // All are marked, the largest on top.
    for (i, band) in bands.iter().enumerate() {
        for [re, im] in band.eigenvalues.iter().rev() {
            panel.place(*re, *im).into_iter().for_each(|at| look(i).marker(sheet, at));
        }
    }
}

/// |λₖ| with markers, empty where λₖ is below zero, and σₖ as thin lines.
fn draw_magnitudes(sheet: &mut Sheet, bands: &[BandSpectrum]) {
    let magnitudes =
        |band: &BandSpectrum| -> Vec<f64> { band.eigenvalues.iter().map(|[re, im]| re.hypot(*im)).collect() };
    let n = bands.iter().map(|band| band.eigenvalues.len().max(band.singular_values.len())).max().unwrap_or(0);
    let all = bands.iter().flat_map(|band| magnitudes(band).into_iter().chain(band.singular_values.iter().copied()));
    let every = n.div_ceil(MOST_NUMBERS).max(1);
    let labels = (1..=n).filter(|k| (k - 1) % every == 0).map(|k| (k as f64, k.to_string())).collect();
    let panel = Panel {
        left: LEFT + SIDE + BETWEEN,
        top: TOP,
        right: f64::from(WIDTH) - KEY - 24.0,
        bottom: TOP + SIDE,
        x: Axis::linear_between(0.5, n.max(1) as f64 + 0.5).with_labels(labels),
        y: Axis::linear_from_zero(all),
    };
    panel.draw_axes(sheet, "number k, largest first", "Magnitudes", true);
    if n == 0 {
        panel.note_empty(sheet, "none was found");
    }
    let numbered = |values: &[f64]| values.iter().enumerate().map(|(k, v)| (k as f64 + 1.0, *v)).collect::<Vec<_>>();
    for (i, band) in bands.iter().enumerate() {
        panel.line(sheet, numbered(&band.singular_values), thin(look(i)));
    }
    for (i, band) in bands.iter().enumerate() {
        panel.line(sheet, numbered(&magnitudes(band)), look(i).stroke());
    }
    for (i, band) in bands.iter().enumerate() {
        for ((k, magnitude), [re, _]) in numbered(&magnitudes(band)).into_iter().zip(&band.eigenvalues) {
            let Some(at) = panel.place(k, magnitude) else { continue };
            look(i).signed_marker(sheet, at, *re < 0.0);
        }
    }
}

/// How singular values are drawn.
fn thin(look: Look) -> Stroke {
    Stroke::dashed(look.colour, 1.0, (1.5, 2.5))
}

/// Names the bands and their radii, and what is what.
fn draw_key(sheet: &mut Sheet, bands: &[BandSpectrum]) {
    let key = f64::from(WIDTH) - KEY;
    let row = (0.55 * SIDE / bands.len().max(1) as f64).min(44.0);
    for (i, band) in bands.iter().enumerate() {
        let y = TOP + 10.0 + row * i as f64;
        sheet.line(vec![(key, y), (key + 24.0, y)], look(i).stroke());
        look(i).marker(sheet, (key + 12.0, y));
        sheet.words((key + 32.0, y), band.band.as_str(), NORMAL, INK, Anchor::Start);
        if row > 30.0 {
            let radius = format!("ρ(K) = {}", significant(band.radius[1], 5));
            sheet.words((key + 32.0, y + 15.0), radius, SMALL, GREY, Anchor::Start);
        }
    }
    let y = TOP + SIDE - 66.0;
    let black = look(0).in_colour(INK);
    black.signed_marker(sheet, (key + 12.0, y), false);
    sheet.words((key + 32.0, y), "|λₖ|", NORMAL, INK, Anchor::Start);
    black.signed_marker(sheet, (key + 12.0, y + 22.0), true);
    sheet.words((key + 32.0, y + 22.0), "|λₖ|, λₖ < 0", NORMAL, INK, Anchor::Start);
    sheet.line(vec![(key, y + 44.0), (key + 24.0, y + 44.0)], thin(black));
    sheet.words((key + 32.0, y + 44.0), "σₖ, étendue norm", NORMAL, INK, Anchor::Start);
    sheet.line(vec![(key, y + 66.0), (key + 24.0, y + 66.0)], black.dashed());
    sheet.words((key + 32.0, y + 66.0), "|λ| = ρ(K)", NORMAL, INK, Anchor::Start);
}
