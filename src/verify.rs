//! Checks a device against rays whose integrals are known: the file format of `tests/data/rays.json`.

use std::path::Path;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::ray::Ray;
use crate::reference;
use crate::renderer::Renderer;
use crate::scene::{Beam, Camera, Curve, Cylinder, Decay, Method, Profile, Scene, Sphere, Torus};

/// The rays that every copy of the crate carries.
const BUILT_IN: &str = include_str!("../tests/data/rays.json");

/// Divisions of the Simpson rule in the field `simpson_200`.
pub const DIVISIONS: u32 = 200;

/// Relative error allowed to a device's Simpson sum: float32 rounding of the distance at the sample next to the core.
pub const SIMPSON_LIMIT: f64 = 1e-4;

/// The same where the ray misses the core by at most [`CLOSE`]: there that one sample outweighs the others.
pub const SIMPSON_LIMIT_CLOSE: f64 = 1e-3;

/// A ray is close to a core below this distance, world units.
pub const CLOSE: f64 = 0.01;

/// A ray past one source of coefficient 1, and its integrals.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct KnownRay {
    /// Kind of the source.
    pub kind: String,
    /// S.
    pub start: DVec3,
    /// E.
    pub end: DVec3,
    /// Decay alpha.
    pub alpha: f64,
    /// Decay beta.
    pub beta: f64,
    /// The integral over s in `[0,1]`.
    pub exact: f64,
    /// Its composite Simpson sum with 200 divisions.
    pub simpson_200: f64,
    /// Centre of a sphere or torus, point of a cylinder, tip of a beam.
    #[serde(default)]
    pub center: DVec3,
    /// Direction of a cylinder or beam.
    #[serde(default)]
    pub direction: DVec3,
    /// How far behind its tip a beam fades.
    #[serde(default)]
    pub taper_length: f64,
    /// Axis of a torus.
    #[serde(default)]
    pub axis: DVec3,
    /// Radius of a torus.
    #[serde(default)]
    pub major_radius: f64,
    /// Control points of a curve.
    #[serde(default)]
    pub control_points: [DVec3; 3],
    /// Local-intensity series of a curve; empty: none.
    #[serde(default)]
    pub weights: Vec<f64>,
}

/// What a device made of a ray.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Place of the ray in its file, from 0.
    pub index: usize,
    /// Kind of the source.
    pub kind: String,
    /// The method checked.
    pub method: Method,
    /// Name of the device.
    pub device: String,
    /// The integral itself.
    pub exact: f64,
    /// What the method should give: the integral, or its Simpson sum.
    pub expected: f64,
    /// What the device gave.
    pub value: f64,
    /// `|value / expected - 1|`.
    pub relative_error: f64,
    /// The largest relative error allowed.
    pub limit: f64,
}

impl Row {
    /// Whether the value is within the limit; NaN is not.
    pub fn passes(&self) -> bool {
        self.relative_error <= self.limit
    }
}

/// The built-in rays.
///
/// # Errors
/// [`Error::Input`] never, unless the crate was changed.
pub fn built_in_rays() -> Result<Vec<KnownRay>> {
    parse(BUILT_IN, Path::new("tests/data/rays.json"))
}

/// Rays from a JSON file.
///
/// # Errors
/// [`Error::Input`] with line and column if the file cannot be read or understood.
pub fn rays_from_file(path: &Path) -> Result<Vec<KnownRay>> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::Input {
        path: path.to_owned(),
        reason: format!("cannot read: {error}"),
    })?;
    parse(&text, path)
}

fn parse(text: &str, path: &Path) -> Result<Vec<KnownRay>> {
    let fail = |reason: String| Error::Input {
        path: path.to_owned(),
        reason,
    };
    let rays: Vec<KnownRay> =
        serde_json::from_str(text).map_err(|error| fail(format!("not a list of rays: {error}")))?;
    for (index, ray) in rays.iter().enumerate() {
        if let Some(fault) = ray.ray().fault() {
            return Err(fail(format!("ray {index}: {fault}")));
        }
        if let Some(scene) = ray.scene() {
            scene
                .validate()
                .map_err(|error| fail(format!("ray {index}: {error}")))?;
        }
    }
    Ok(rays)
}

impl KnownRay {
    /// The scene of its one source; `None` for a kind that this version does not draw.
    pub fn scene(&self) -> Option<Scene> {
        let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO));
        scene.decay = Some(Decay {
            alpha: self.alpha,
            beta: self.beta,
        });
        scene.integration.divisions = DIVISIONS;
        match self.kind.as_str() {
            "sphere" => scene.spheres.push(Sphere {
                center: self.center,
                ..Sphere::default()
            }),
            "cylinder" => scene.cylinders.push(Cylinder {
                point: self.center,
                ..Cylinder::new(self.direction)
            }),
            "beam" => scene.beams.push(Beam {
                tip: self.center,
                ..Beam::new(self.direction)
            }),
            "sphere-inverse-square" => scene.spheres.push(Sphere {
                center: self.center,
                profile: Profile::InverseSquare,
                ..Sphere::default()
            }),
            "beam-inverse-square" => scene.beams.push(Beam {
                tip: self.center,
                taper_length: Some(self.taper_length),
                profile: Profile::InverseSquare,
                ..Beam::new(self.direction)
            }),
            "torus" => scene.tori.push(Torus {
                center: self.center,
                axis: self.axis,
                ..Torus::new(self.major_radius)
            }),
            "curve" | "curve-weighted" | "curve-straight" | "curve-cusp" => {
                scene.curves.push(Curve {
                    intensity: (!self.weights.is_empty()).then(|| self.weights.clone()),
                    ..Curve::new(self.control_points)
                });
            }
            _ => return None,
        }
        Some(scene)
    }

    /// The ray itself.
    pub fn ray(&self) -> Ray {
        Ray::between(self.start, self.end)
    }

    /// Least distance from the ray to the core, world units; 0 for a kind that this version does not draw.
    pub fn miss(&self) -> f64 {
        let Some(scene) = self.scene() else {
            return 0.0;
        };
        let ray = self.ray();
        let mut breaks = vec![0.0, 1.0];
        let sources = reference::sources(&scene);
        let distances = sources.iter().flat_map(|source| {
            source.field.breaks(&ray, &mut breaks);
            let within: Vec<f64> = breaks.iter().map(|s| s.clamp(0.0, 1.0)).collect();
            let distance = |s: f64| source.field.sample(ray.at(s)).distance2.sqrt();
            within.into_iter().map(distance).collect::<Vec<_>>()
        });
        distances.fold(f64::INFINITY, f64::min)
    }
}

/// Sends the rays of every kind that this version draws through a device, by a method it has.
///
/// # Errors
/// As [`Renderer::trace`].
pub fn verify(
    renderer: &mut Renderer,
    device: &str,
    rays: &[KnownRay],
    method: Method,
    tolerance: f64,
) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (index, ray) in rays.iter().enumerate() {
        let Some(mut scene) = ray.scene() else {
            continue;
        };
        scene.integration.method = method;
        scene.integration.tolerance = tolerance;
        let traced = renderer.trace(&scene, &[ray.ray()])?;
        let value = traced.first().map_or(f64::NAN, |radiance| radiance[0]);
        let (expected, limit) = match method {
            Method::Exact => (ray.exact, tolerance),
            Method::Simpson if ray.miss() > CLOSE => (ray.simpson_200, SIMPSON_LIMIT),
            Method::Simpson => (ray.simpson_200, SIMPSON_LIMIT_CLOSE),
        };
        rows.push(Row {
            index,
            kind: ray.kind.clone(),
            method,
            device: device.to_owned(),
            exact: ray.exact,
            expected,
            value,
            relative_error: relative_error(value, expected),
            limit,
        });
    }
    Ok(rows)
}

/// 0 where both are 0.
fn relative_error(value: f64, expected: f64) -> f64 {
    if value == expected {
        return 0.0;
    }
    ((value - expected) / expected).abs()
}
