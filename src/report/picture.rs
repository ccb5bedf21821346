//! The solved scene as files, and the same after 0, 1, 2, … bounces.

use super::figure::strip;
use super::{Artifact, ReportError};
use crate::image::{Image, choose_exposure, encode_exr, encode_png};
use crate::study::Pictures;

/// A picture for the page.
pub struct Shown {
    pub caption: String,
    pub png: Vec<u8>,
}

/// What the page shows: all with the exposure of the solved picture.
pub struct PicturesOnPage {
    pub solved: Shown,
    pub bounces: Vec<Shown>,
    pub exposure: f64,
    /// True if the bands are not the three of a screen, so that their mean is shown in grey.
    pub grey: bool,
}

/// The files of the pictures, and what the page shows of them.
pub fn pictures(pictures: &Pictures) -> Result<(PicturesOnPage, Vec<Artifact>), ReportError> {
    // Expose everything as the solved scene.
    let solved = displayable(&pictures.solved);
    let bounces: Vec<Image> = pictures.bounces.iter().map(displayable).collect();
    let exposure = choose_exposure(&solved);

    // Encode for the page.
    let show =
        |caption: String, image: &Image| Ok::<_, ReportError>(Shown { caption, png: encode_png(image, exposure)? });
    let on_page = PicturesOnPage {
        solved: show("solved: all bounces".into(), &solved)?,
        bounces: bounces.iter().enumerate().map(|(k, image)| show(caption(k), image)).collect::<Result<_, _>>()?,
        exposure,
        grey: pictures.solved.channels.len() != 3,
    };

    // Encode for programs, and the strip for people.
    let mut files = vec![
        Artifact { name: "solved.exr".into(), bytes: encode_exr(&pictures.solved)? },
        Artifact { name: "solved.png".into(), bytes: on_page.solved.png.clone() },
    ];
    if !bounces.is_empty() {
        let captioned: Vec<(String, &Image)> =
            bounces.iter().enumerate().map(|(k, image)| (caption(k), image)).collect();
        files.push(Artifact { name: "bounces.png".into(), bytes: strip(&captioned, exposure)? });
    }
    for (k, image) in pictures.bounces.iter().enumerate() {
        files.push(Artifact { name: format!("bounce-{k}.exr"), bytes: encode_exr(image)? });
    }
    Ok((on_page, files))
}

fn caption(bounces: usize) -> String {
    match bounces {
        1 => "1 bounce".into(),
        k => format!("{k} bounces"),
    }
}

/// Red, green and blue as they are; any other number of bands as their mean, in grey.
fn displayable(image: &Image) -> Image {
    let n = image.channels.len();
    if n == 3 {
        return image.clone();
    }
    let means = image.values.chunks(n.max(1)).flat_map(|bands| [bands.iter().sum::<f64>() / n as f64; 3]);
    let channels = ["R", "G", "B"].map(String::from).to_vec();
    Image { width: image.width, height: image.height, channels, values: means.collect() }
}
