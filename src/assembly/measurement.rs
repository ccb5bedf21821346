//! Measurement W: from outgoing radiance to pixels, by one exact last bounce.
//!
//! ```text
//! pixel = ⟨filter, emission seen⟩ + W L,      (W L)_p = Σ_samples filter · ∫ f_r(ω, view) L(ω) cosθ dω
//! ```
//!
//! The emission that a camera ray meets is read off the scene, not off its patch, and the light that arrives where it meets it is
//! gathered from the bundles: so the picture shows no patches, and its error falls an order faster than theirs (the Sloan
//! iterate). The hemisphere is gathered by rays uniform in étendue; where the lamps are a small part of the scene, they are
//! gathered by points on them instead, and the rays that meet them do not count.

use crate::basis::Bundles;
use crate::geometry::{Frame, Hit, Polygon, Ray, Tracer, Vec3};
use crate::linalg::Block;
use crate::sampling::{AliasTable, Kronecker, mix, warp};
use crate::scattering::Brdf;
use crate::scene::{Camera, FilterTable, Scene, Side};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How finely pixels are gathered: counts are the caller's choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gather {
    /// Camera rays a pixel, spread over its filter.
    pub samples: usize,
    /// Rays over the hemisphere, and points on lamps, at each place a camera ray meets.
    pub rays: usize,
    pub seed: u64,
}

/// Lamps are gathered by points on them where their étendue is below this share of all: above it, rays meet them often enough.
const LAMP_SHARE: f64 = 0.1;

/// W of a camera, unformed: m pixels × n bundles, applied without being stored.
pub struct Measurement<'a> {
    scene: &'a Scene,
    bundles: &'a Bundles,
    camera: &'a Camera,
    tracer: Tracer,
    gather: Gather,
    filter: FilterTable,
    /// Facets that emit, with a table to choose one by area; `None` where rays meet them often enough.
    lamps: Option<Lamps>,
}

struct Lamps {
    facets: Vec<usize>,
    by_area: AliasTable,
    area: f64,
}

/// A place that a camera ray has met.
struct Place<'a> {
    hit: Hit,
    position: Vec3,
    frame: Frame,
    brdf: &'a dyn Brdf,
    outgoing: Vec3,
}

impl<'a> Measurement<'a> {
    /// W of the scene's camera; `None` if it has none.
    pub fn new(scene: &'a Scene, bundles: &'a Bundles, gather: Gather) -> Option<Self> {
        let polygons: Vec<&Polygon> = (0..scene.facets().len()).map(|facet| scene.polygon(facet)).collect();
        let emits = |facet: &usize| scene.surface_of(*facet).emission.iter().any(|e| *e > 0.0);
        let facets: Vec<usize> = (0..polygons.len()).filter(emits).collect();
        let areas: Vec<f64> = facets.iter().map(|f| polygons[*f].area()).collect();
        let area: f64 = areas.iter().sum();
        let everything: f64 = polygons.iter().map(|p| p.area()).sum();
        let lamps = if area < LAMP_SHARE * everything {
            AliasTable::new(&areas).ok().map(|by_area| Lamps { facets, by_area, area })
        } else {
            None
        };
        let tracer = Tracer::new(&polygons);
        let camera = scene.camera()?;
        let filter = FilterTable::new(&camera.film.filter);
        Some(Self { scene, bundles, camera, tracer, gather, filter, lamps })
    }

    /// m.
    pub fn n_pixels(&self) -> usize {
        self.camera.film.width * self.camera.film.height
    }

    /// The camera that is measured by.
    pub fn camera(&self) -> &Camera {
        self.camera
    }

    /// The emission seen and W applied to each field: m × bands for the first, then one such block a field.
    ///
    /// Cost: samples × (1 + 2 rays) rays a pixel, whatever the number of fields. `progress` hears the finished share.
    pub fn apply(&self, fields: &[&Block], progress: &(dyn Fn(f64) + Sync)) -> Vec<Block> {
        let (n_bands, n_fields) = (self.scene.n_bands(), fields.len());
        let n = self.bundles.n_bundles();

        // Lay all fields and bands of one bundle side by side: a ray then reads one line of memory.
        let stride = n_fields * n_bands;
        let mut interleaved = vec![0.0; n * stride];
        for (f, field) in fields.iter().enumerate() {
            for band in 0..n_bands {
                for (i, value) in field.column(band).iter().enumerate() {
                    interleaved[i * stride + f * n_bands + band] = *value;
                }
            }
        }

        // Gather scan line by scan line.
        let (width, height) = (self.camera.film.width, self.camera.film.height);
        let done = AtomicUsize::new(0);
        let lines: Vec<Vec<f64>> = (0..height)
            .into_par_iter()
            .with_max_len(1)
            .map(|y| {
                let mut line = vec![0.0; width * (n_bands + stride)];
                for (x, pixel) in line.chunks_exact_mut(n_bands + stride).enumerate() {
                    let (seen, gathered) = pixel.split_at_mut(n_bands);
                    self.pixel(
                        x,
                        y,
                        |band, weight| seen[band] += weight,
                        |bundle, band, weight| {
                            let values = &interleaved[bundle * stride..][..stride];
                            for f in 0..n_fields {
                                gathered[f * n_bands + band] += weight * values[f * n_bands + band];
                            }
                        },
                    );
                }
                progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / height as f64);
                line
            })
            .collect();

        let value = |p: usize, slot: usize| lines[p / width][(p % width) * (n_bands + stride) + slot];
        (0..=n_fields)
            .map(|f| Block::from_fn(self.n_pixels(), n_bands, |p, band| value(p, f * n_bands + band)))
            .collect()
    }

    /// Measures one pixel: `seen(band, emission)` and `gathered(bundle, band, weight)`, an entry of W, each any number of times.
    pub fn pixel(
        &self,
        x: usize,
        y: usize,
        mut seen: impl FnMut(usize, f64),
        mut gathered: impl FnMut(usize, usize, f64),
    ) {
        let film = &self.camera.film;
        let key = mix(&[self.gather.seed, (y * film.width + x) as u64]);
        // Draw positions by the filter's magnitude: each then weighs by its sign alone. All pixels use the same ones, so that edges
        // come out even.
        let positions = Kronecker::<2>::new(self.gather.seed);
        let drawn: Vec<[(f64, f64); 2]> =
            (0..self.gather.samples).map(|s| positions.point(s).map(|u| self.filter.draw(u))).collect();
        for (s, [(dx, sx), (dy, sy)]) in drawn.into_iter().enumerate() {
            let weight = sx * sy * self.filter.weight().powi(2) / self.gather.samples as f64;
            let ray = self.camera.ray(x as f64 + 0.5 + dx, y as f64 + 0.5 + dy);
            let Some(hit) = self.tracer.closest(&ray, None) else { continue };
            let side = if hit.front { Side::Front } else { Side::Back };
            let surface = self.scene.surface_of(hit.polygon);
            for band in 0..self.scene.n_bands() {
                seen(band, weight * surface.emitted(side, band));
            }
            let Some(brdf) = surface.brdf(side) else { continue };
            let normal = self.scene.polygon(hit.polygon).normal();
            let frame = Frame::about(if hit.front { normal } else { -normal });
            let outgoing = frame.to_local(-ray.direction.normalize());
            let place = Place { hit, position: ray.at(hit.t), frame, brdf, outgoing };
            // All samples of the pixel share one sequence: together they spread as evenly as their whole number can.
            let sequence = s * self.gather.rays..(s + 1) * self.gather.rays;
            self.gather_hemisphere(&place, key, sequence.clone(), weight, &mut gathered);
            if let Some(lamps) = &self.lamps {
                self.gather_lamps(&place, lamps, key, sequence, weight, &mut gathered);
            }
        }
    }

    /// Rays uniform in étendue: the weight of each is π f_r.
    fn gather_hemisphere(
        &self,
        place: &Place,
        key: u64,
        sequence: Range<usize>,
        weight: f64,
        gathered: &mut impl FnMut(usize, usize, f64),
    ) {
        let directions = Kronecker::<2>::new(mix(&[key, 0]));
        for k in sequence {
            let local = Vec3::from(warp::cosine_hemisphere(directions.point(k)));
            let ray = Ray { origin: place.position, direction: place.frame.to_world(local) };
            let Some(hit) = self.tracer.closest(&ray, Some(place.hit.polygon)) else { continue };
            let by_points = self.lamps.is_some() && hit.front && self.emits(hit.polygon);
            if by_points {
                continue;
            }
            let side = if hit.front { Side::Front } else { Side::Back };
            let Some(bundle) = self.bundles.locate(hit.polygon, side, ray.at(hit.t), -ray.direction) else { continue };
            let share = weight * PI / self.gather.rays as f64;
            for band in 0..self.scene.n_bands() {
                gathered(bundle, band, share * place.brdf.eval(band, local, place.outgoing));
            }
        }
    }

    /// Points uniform on the lamps: the weight of each is f_r cosθ cosθ' / r² · area.
    fn gather_lamps(
        &self,
        place: &Place,
        lamps: &Lamps,
        key: u64,
        sequence: Range<usize>,
        weight: f64,
        gathered: &mut impl FnMut(usize, usize, f64),
    ) {
        let points = Kronecker::<3>::new(mix(&[key, 1]));
        for k in sequence {
            let [choice, u, v] = points.point(k);
            let facet = lamps.facets[lamps.by_area.sample(choice)];
            let polygon = self.scene.polygon(facet);
            let point = polygon.sample([u, v]);
            let line = point - place.position;
            let r_squared = line.length_squared();
            let direction = line / r_squared.sqrt();
            let local = place.frame.to_local(direction);
            let cosine = -polygon.normal().dot(direction);
            if local.z <= 0.0 || cosine <= 0.0 || facet == place.hit.polygon {
                continue;
            }
            if self.tracer.occluded(place.position, point, [place.hit.polygon, facet]) {
                continue;
            }
            let Some(bundle) = self.bundles.locate(facet, Side::Front, point, -direction) else { continue };
            let share = weight * local.z * cosine / r_squared * lamps.area / self.gather.rays as f64;
            for band in 0..self.scene.n_bands() {
                gathered(bundle, band, share * place.brdf.eval(band, local, place.outgoing));
            }
        }
    }

    fn emits(&self, facet: usize) -> bool {
        self.scene.surface_of(facet).emission.iter().any(|e| *e > 0.0)
    }
}
