//! The scene: what glows, who looks, and how the light is summed. Plain data, buildable in code, readable from TOML or
//! JSON ([`Scene::from_file`]), checked once ([`Scene::validate`]).
//!
//! All vectors are world space, right-handed; lengths in world units; angles in degrees; colours linear RGB.

mod locate;
mod read;
mod sources;
mod validate;

use glam::DVec3;
use serde::{Deserialize, Serialize};

pub use sources::{Beam, Curve, Cylinder, Profile, Sphere, Torus};

use crate::image::DepthImage;

/// A complete scene: camera, image size, the way of integrating, what hides the light, and the sources of light.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Who looks, and along which rays.
    pub camera: Camera,
    /// Size of the image.
    pub image: ImageSize,
    /// How light fades along a ray; `None`: it does not (zeta = 1).
    pub decay: Option<Decay>,
    /// How the integral along a ray is computed.
    pub integration: Integration,
    /// How radiance becomes an 8-bit picture.
    pub display: Display,
    /// How far each pixel's ray sees, of the size of the image; `None`: nothing hides the light.
    pub depth: Option<DepthImage>,
    /// Points of light.
    pub spheres: Vec<Sphere>,
    /// Infinite lines of light.
    pub cylinders: Vec<Cylinder>,
    /// Half-lines of light.
    pub beams: Vec<Beam>,
    /// Rings of light.
    pub tori: Vec<Torus>,
    /// Quadratic curves of light.
    pub curves: Vec<Curve>,
}

impl Scene {
    /// A scene without sources, which is black: 512x512 pixels, no decay, everything else at its default.
    pub fn new(camera: Camera) -> Self {
        Self {
            camera,
            image: ImageSize::default(),
            decay: None,
            integration: Integration::default(),
            display: Display::default(),
            depth: None,
            spheres: Vec::new(),
            cylinders: Vec::new(),
            beams: Vec::new(),
            tori: Vec::new(),
            curves: Vec::new(),
        }
    }

    /// Number of sources of all kinds.
    pub fn source_count(&self) -> usize {
        let open = self.spheres.len() + self.cylinders.len() + self.beams.len();
        open + self.tori.len() + self.curves.len()
    }

    /// Where a device takes this scene's integrals, see [`Sampling`].
    pub fn sampling(&self) -> Sampling {
        match self.integration.method {
            Method::Simpson => Sampling::Pixels,
            Method::Exact if self.has_light_of_both_signs() => Sampling::Pixels,
            Method::Exact => self.integration.sampling.unwrap_or(Sampling::Tiles),
        }
    }

    fn has_light_of_both_signs(&self) -> bool {
        let spheres = self.spheres.iter().map(|s| (s.coefficient, s.color));
        let cylinders = self.cylinders.iter().map(|c| (c.coefficient, c.color));
        let beams = self.beams.iter().flat_map(|beam| {
            let parts = [beam.coefficient, beam.cap(), beam.sphere_coefficient];
            parts.map(|coefficient| (coefficient, beam.color))
        });
        let tori = self.tori.iter().map(|t| (t.coefficient, t.color));
        let curves = self.curves.iter().flat_map(|curve| {
            let weights = curve.intensity.as_deref().unwrap_or(&[1.0]);
            let light = |weight| (curve.coefficient * weight, curve.color);
            weights.iter().map(light)
        });
        let open = spheres.chain(cylinders).chain(beams);
        let lights = open.chain(tori).chain(curves);
        let (low, high) = lights.fold((DVec3::ZERO, DVec3::ZERO), |(low, high), (k, color)| {
            (low.min(k * color), high.max(k * color))
        });
        low.cmplt(DVec3::ZERO).any() && high.cmpgt(DVec3::ZERO).any()
    }
}

/// A pinhole camera and the length of its rays.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Position of the eye.
    #[serde(deserialize_with = "read::vector")]
    pub eye: DVec3,
    /// The point looked at, in the middle of the image.
    #[serde(deserialize_with = "read::vector")]
    pub target: DVec3,
    /// The direction that is up in the image; need not be perpendicular to the view.
    #[serde(default = "plus_z", deserialize_with = "read::vector")]
    pub up: DVec3,
    /// Full vertical angle of view, degrees.
    #[serde(default = "default_fov_y")]
    pub fov_y: f64,
    /// Distance from the eye to the projection plane, where the rays begin.
    #[serde(default = "one")]
    pub near: f64,
    /// Length of every ray, `|E - S|`; `None`: 5 times the distance from the projection plane to the target.
    #[serde(default)]
    pub ray_length: Option<f64>,
}

impl Camera {
    /// A camera at `eye` that looks at `target`: +z up, 45 degrees, projection plane at 1.
    pub fn new(eye: DVec3, target: DVec3) -> Self {
        Self {
            eye,
            target,
            up: plus_z(),
            fov_y: default_fov_y(),
            near: one(),
            ray_length: None,
        }
    }

    /// Length of every ray, `|E - S|`, world units.
    pub fn ray_length(&self) -> f64 {
        let beyond_plane = self.eye.distance(self.target) - self.near;
        self.ray_length.unwrap_or(5.0 * beyond_plane)
    }
}

/// Size of an image in pixels, at most [`ImageSize::LIMIT`] each way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImageSize {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl ImageSize {
    /// The largest width and the largest height.
    pub const LIMIT: u32 = 16384;

    /// Number of pixels.
    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }
}

impl Default for ImageSize {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
        }
    }
}

/// Decay with distance, `zeta(s) = alpha / (s + beta)^2` (Watanabe, Abe, Konno 2015, eq. 21), over s in `[0,1]`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Decay {
    /// Strength; positive.
    pub alpha: f64,
    /// Offset; positive.
    pub beta: f64,
}

impl Decay {
    /// `zeta(s)`.
    pub fn at(self, s: f64) -> f64 {
        self.alpha / ((s + self.beta) * (s + self.beta))
    }
}

/// How the integral along a ray is computed.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Integration {
    /// The quadrature.
    pub method: Method,
    /// Simpson: number of equal divisions, even, 2 to 65536.
    pub divisions: u32,
    /// Exact: relative error aimed at.
    pub tolerance: f64,
    /// Exact: where integrals are taken; `None`: tiles.
    pub sampling: Option<Sampling>,
    /// Over what the integral runs.
    pub measure: Measure,
    /// Softening radius epsilon: the squared distance to every core grows by its square.
    pub softening: f64,
}

impl Default for Integration {
    fn default() -> Self {
        Self {
            method: Method::Exact,
            divisions: 200,
            tolerance: 1e-3,
            sampling: None,
            measure: Measure::Parameter,
            softening: 0.0,
        }
    }
}

/// A quadrature.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Composite Simpson rule with equal divisions (2015, eq. 23), beads at the core included.
    Simpson,
    /// The integral itself, to a stated relative error.
    Exact,
}

/// Where integrals are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Sampling {
    /// At every pixel.
    Pixels,
    /// Of each source, at every pixel near its core; elsewhere at a few pixels of a tile, the others interpolated within
    /// the tolerance. Every pixel is taken all the same where sources of opposite signs cancel, whose errors do not, and
    /// on the built-in reference.
    Tiles,
}

/// Over what the integral runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Measure {
    /// The ray's parameter s in `[0,1]` (2015).
    Parameter,
    /// Length in world units: `|E - S|` times as much (2010, 2006).
    Length,
}

/// How linear radiance becomes an 8-bit picture.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Display {
    /// Exposure in stops: radiance times `2^exposure`.
    pub exposure: f64,
    /// The curve that brings radiance into `[0,1]`.
    pub tone_map: ToneMap,
}

impl Default for Display {
    fn default() -> Self {
        Self {
            exposure: 0.0,
            tone_map: ToneMap::Exponential,
        }
    }
}

/// A tone-mapping curve, applied to each channel `L` of exposed radiance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ToneMap {
    /// `min(L, 1)`.
    Clamp,
    /// `1 - exp(-L)`.
    Exponential,
    /// `L / (1 + L)` (Reinhard et al. 2002).
    Reinhard,
    /// The rational fit to the ACES filmic curve by Narkowicz 2015.
    Aces,
}

fn one() -> f64 {
    1.0
}

fn default_fov_y() -> f64 {
    45.0
}

fn plus_z() -> DVec3 {
    DVec3::Z
}

fn white() -> DVec3 {
    DVec3::ONE
}
