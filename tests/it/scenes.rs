//! Small scenes and their systems, shared by the tests of matrices and solvers.

use etendue::assembly::{Exchange, Occlusion, System, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery::{self, Entry};
use etendue::geometry::{Polygon, Vec3};
use etendue::scattering::Lambert;
use etendue::scene::{Scene, SceneDescription, Surface};
use std::sync::{Arc, LazyLock};

/// A scene of the gallery, cut coarsely and assembled.
pub struct Case {
    pub entry: &'static Entry,
    pub scene: Scene,
    pub bundles: Bundles,
    pub settings: Exchange,
    pub system: System,
}

impl Case {
    /// The case with its sampling left coarse: what is tested on it must hold at any number of rays.
    pub fn new(name: &str, patch_size: f64) -> Self {
        let settings = Exchange { occlusion: Occlusion::Sampled { rays: 24, sink_rays: 256 }, ..Exchange::default() };
        Self::with(name, patch_size, settings)
    }

    pub fn with(name: &str, patch_size: f64, settings: Exchange) -> Self {
        let entry = gallery::find(name).unwrap();
        let scene = (entry.build)();
        let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).unwrap();
        let system = assemble(&scene, &bundles, settings).unwrap();
        Self { entry, scene, bundles, settings, system }
    }
}

/// Every scene of the gallery at a resolution that makes a hundred to four hundred bundles.
pub fn coarse() -> &'static [Case] {
    static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| {
        let patch_size = |name| match name {
            "furnace-cube" => 0.25,
            "furnace-sphere" => 1.0,
            "cornell-box" => 0.5,
            "parallel-plates" => 0.125,
            "corner-box" => 0.25,
            "floating-block" => 0.25,
            "two-rooms" => 1.0,
            "maze" => 1.0,
            "spherical-crater" => 0.5,
            other => panic!("no coarse patch size for '{other}'"),
        };
        gallery::list().iter().map(|entry| Case::new(entry.name, patch_size(entry.name))).collect()
    });
    &CASES
}

/// One coarse case by name.
pub fn find(name: &str) -> &'static Case {
    coarse().iter().find(|case| case.entry.name == name).unwrap()
}

pub fn polygon(vertices: &[[f64; 3]]) -> Polygon {
    Polygon::new(vertices.iter().map(|v| Vec3::from_array(*v)).collect()).unwrap()
}

/// A scene of polygons, one surface each, all of albedo ½ and emission 1, with no camera.
pub fn scene_of(polygons: &[Polygon], are_two_sided: bool) -> Scene {
    let surface = |(k, polygon): (usize, &Polygon)| Surface {
        name: format!("polygon-{k}"),
        polygons: vec![polygon.clone()],
        front: Arc::new(Lambert::grey(0.5, 1)),
        back: are_two_sided.then(|| Arc::new(Lambert::grey(0.5, 1)) as _),
        emission: vec![1.0],
        tessellation: None,
    };
    Scene::new(SceneDescription {
        name: "polygons".to_string(),
        bands: vec!["grey".to_string()],
        surfaces: polygons.iter().enumerate().map(surface).collect(),
        camera: None,
    })
    .unwrap()
}
