//! The leading eigenvalues of K in the complex plane, inside the circle that bounds them.

use super::axis::Axis;
use super::palette::look;
use super::panel::{NORMAL, Panel, SMALL};
use super::sheet::{Anchor, GREY, INK, Sheet, Stroke};
use crate::report::number::significant;
use crate::study::BandSpectrum;
use std::f64::consts::TAU;

const SIDE: u32 = 470;
const KEY: u32 = 170;
const LEFT: f64 = 56.0;
const TOP: f64 = 48.0;
const FOOT: f64 = 50.0;

/// Points of a circle.
const N_POINTS: usize = 240;

/// Eigenvalues of every band, the circle of its spectral radius, and the unit circle.
pub fn spectrum(bands: &[BandSpectrum]) -> Sheet {
    let mut sheet = Sheet::new(SIDE + KEY, SIDE);
    let side = f64::from(SIDE) - TOP - FOOT;
    let axis = || Axis::linear_between(-1.05, 1.05);
    let panel = Panel { left: LEFT, top: TOP, right: LEFT + side, bottom: TOP + side, x: axis(), y: axis() };
    panel.draw_axes(&mut sheet, "real part", "Eigenvalues of K: imaginary part", true);
    let circle = |radius: f64| {
        (0..=N_POINTS).map(move |k| {
            let (sine, cosine) = (TAU * k as f64 / N_POINTS as f64).sin_cos();
            (radius * cosine, radius * sine)
        })
    };
    panel.line(&mut sheet, circle(1.0), Stroke::solid(GREY, 0.75));
    for (i, band) in bands.iter().enumerate() {
        if band.radius[1].is_finite() {
            panel.line(&mut sheet, circle(band.radius[1]), look(i).dashed());
        }
    }
    // All eigenvalues are marked, the largest on top.
    for (i, band) in bands.iter().enumerate() {
        for [re, im] in band.eigenvalues.iter().rev() {
            panel.place(*re, *im).into_iter().for_each(|at| look(i).marker(&mut sheet, at));
        }
    }

    // Name the bands and their radii.
    let key = LEFT + side + 20.0;
    for (i, band) in bands.iter().enumerate() {
        let y = TOP + 10.0 + 44.0 * i as f64;
        sheet.line(vec![(key, y), (key + 24.0, y)], look(i).dashed());
        look(i).marker(&mut sheet, (key + 12.0, y));
        sheet.words((key + 32.0, y), band.band.as_str(), NORMAL, INK, Anchor::Start);
        let radius = format!("radius {}", significant(band.radius[1], 5));
        sheet.words((key + 32.0, y + 15.0), radius, SMALL, GREY, Anchor::Start);
    }
    sheet
}
