//! Scenes of metaballs, and how far what a device finds of them is from float64.

use energywave::image::ImageSize;
use energywave::internals::{SurfaceRay, see_surfaces, surface_rays};
use energywave::scene::{Antialias, Camera, Lattice, MetaballShading, Metaballs, PointList};
use energywave::{Renderer, Scene};
use glam::DVec3;

/// The radius of 2008.
pub const H: f64 = 0.61;

/// A ray may meet the surface or not where the field comes so close to the threshold: what float32 sums lose.
pub const CLOSE: f64 = 1e-5;

/// Shares of the radius that 99 % of the lengths, and all, may be off: what float32 leaves of fields and lengths.
pub const MOST_LENGTHS: f64 = 1e-4;
pub const ALL_LENGTHS: f64 = 1e-3;

/// Degrees that 99 % of the normals may be off, which are those of places that far off.
pub const MOST_NORMALS: f64 = 0.1;

/// A scene of surfaces alone: their normals as colours, one ray a pixel.
pub fn scene_of(camera: Camera, surfaces: impl IntoIterator<Item = Metaballs>) -> Scene {
    let mut scene = Scene::new(camera);
    scene.image = ImageSize {
        width: 128,
        height: 128,
    };
    scene.integration.antialias = Antialias::None;
    for mut surface in surfaces {
        surface.shading = MetaballShading::Normals;
        scene.metaballs.push(surface);
    }
    scene
}

/// Twelve by twelve particles in layers, seen from near.
pub fn block(spacing: f64, jitter: f64) -> Scene {
    let lattice = Lattice {
        columns: [12, 12],
        jitter,
        seed: 1,
        ..Lattice::new(12 * 12 * 8, spacing)
    };
    let points = PointList::lattice(&lattice).unwrap();
    let eye = 12.0 * spacing * DVec3::new(0.35, -1.05, 0.8);
    scene_of(Camera::new(eye, DVec3::ZERO), [Metaballs::new(points, H)])
}

/// The scenes of every spacing, by name.
pub fn blocks() -> Vec<(&'static str, Scene)> {
    vec![
        ("solid", block(0.305, 0.0)),
        ("pits", block(0.4, 0.0)),
        ("jittered", block(0.45, 0.25)),
        ("beads", block(0.5, 0.0)),
        ("balls", block(0.61, 0.0)),
    ]
}

/// Errors of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Rays that meet the surface.
    pub hits: usize,
    /// Rays that meet it on the device or in float64 alone, though the field is not close to the threshold.
    pub strays: usize,
    /// Shares of the radius.
    pub lengths: (f64, f64),
    /// Degrees, of 99 %.
    pub normals: f64,
}

impl Errors {
    pub fn are_small(&self) -> bool {
        let (most, all) = self.lengths;
        self.strays == 0 && most < MOST_LENGTHS && all < ALL_LENGTHS && self.normals < MOST_NORMALS
    }
}

/// Returns the value that 99 % are no greater than.
fn most_of(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() * 99 / 100).copied().unwrap_or(0.0)
}

/// Compares the single surface of a scene with float64.
pub fn errors(renderer: &mut Renderer, scene: &Scene, truth: &[SurfaceRay]) -> Errors {
    let (found, light) = see_surfaces(renderer, scene).unwrap();
    assert_eq!(found.len(), truth.len());
    let metaballs = &scene.metaballs[0];
    let (mut hits, mut strays) = (0, 0);
    let (mut lengths, mut normals) = (Vec::new(), Vec::new());
    let pixels = light.as_chunks::<4>().0;
    for ((&found, pixel), ray) in found.iter().zip(pixels).zip(truth) {
        match (found.is_finite(), ray.length.is_finite()) {
            (false, false) => {}
            (true, true) => {
                hits += 1;
                let error = (f64::from(found) - ray.length).abs() / metaballs.greatest_radius();
                let grazes = (ray.most - metaballs.threshold).abs() < CLOSE;
                if grazes && error > ALL_LENGTHS {
                    continue; // one sees the hump, the other what is behind it
                }
                lengths.push(error);
                let normal =
                    DVec3::new(pixel[0].into(), pixel[1].into(), pixel[2].into()) * 2.0 - 1.0;
                normals.push(normal.angle_between(ray.normal).to_degrees());
            }
            _ if (ray.most - metaballs.threshold).abs() < CLOSE => {}
            _ => strays += 1,
        }
    }
    Errors {
        hits,
        strays,
        lengths: (
            most_of(lengths.clone()),
            lengths.into_iter().fold(0.0, f64::max),
        ),
        normals: most_of(normals),
    }
}

pub fn truth(scene: &Scene) -> Vec<SurfaceRay> {
    surface_rays(scene, &scene.metaballs[0], 1)
}

#[track_caller]
pub fn expect_true(name: &str, renderer: &mut Renderer, scene: &Scene) -> Errors {
    let errors = errors(renderer, scene, &truth(scene));
    println!("{name}: {errors:?}");
    assert!(errors.are_small(), "{name}: {errors:?}");
    errors
}
