//! Checks a device against rays whose integrals are known: the file format of `tests/data/rays.json`.

use std::path::Path;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::reference;
use crate::render::Renderer;
use crate::scene::{
    Beam, BeamEnd, Camera, Curve, Cylinder, Decay, Measure, Method, Profile, Ray, Scene, Sphere,
    Torus,
};

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

/// A ray whose integral is known.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct KnownRay {
    /// Kind of the source; `scene` for a whole scene.
    pub kind: String,
    /// The ray itself.
    pub ray: Ray,
    /// What glows along it; `None` for a kind that this version does not draw.
    pub scene: Option<Scene>,
    /// The integral of the scene's green light.
    pub exact: f64,
    /// Its composite Simpson sum with 200 divisions, if it is known.
    pub simpson_200: Option<f64>,
}

/// A ray as a file describes it: past a whole scene, or past one source of coefficient 1.
#[derive(Deserialize)]
struct RayRecord {
    start: DVec3,
    end: DVec3,
    exact: f64,
    #[serde(default)]
    simpson_200: Option<f64>,
    /// As in a JSON scene file; the camera may be absent.
    #[serde(default)]
    scene: Option<serde_json::Value>,
    #[serde(default)]
    kind: Option<String>,
    #[serde(default)]
    alpha: Option<f64>,
    #[serde(default)]
    beta: Option<f64>,
    /// Centre of a sphere or torus, point of a cylinder, tip of a beam.
    #[serde(default)]
    center: DVec3,
    /// Direction of a cylinder or beam.
    #[serde(default)]
    direction: DVec3,
    /// How far behind its tip a beam fades.
    #[serde(default)]
    taper_length: f64,
    /// Axis of a torus.
    #[serde(default)]
    axis: DVec3,
    #[serde(default)]
    major_radius: f64,
    #[serde(default)]
    control_points: [DVec3; 3],
    /// Local-intensity series of a curve; empty: none.
    #[serde(default)]
    weights: Vec<f64>,
}

/// What a device made of a ray.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Row {
    /// Place of the ray in its file, from 0.
    pub index: usize,
    /// Kind of the source.
    pub kind: String,
    /// Name of the method checked: `simpson` or `exact`.
    pub method: &'static str,
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
    /// Returns whether the value is within the limit; NaN is not.
    pub fn passes(&self) -> bool {
        self.relative_error <= self.limit
    }
}

/// Returns the built-in rays.
///
/// # Errors
/// [`Error::Input`] never, unless the crate was changed.
pub fn built_in_rays() -> Result<Vec<KnownRay>> {
    parse(BUILT_IN, Path::new("tests/data/rays.json"))
}

/// Reads rays from a JSON file.
///
/// # Errors
/// [`Error::Input`] with line and column if the file cannot be read or understood.
pub fn rays_from_file(path: &Path) -> Result<Vec<KnownRay>> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Error::input(path, format!("cannot read: {error}")).caused_by(error))?;
    parse(&text, path)
}

fn parse(text: &str, path: &Path) -> Result<Vec<KnownRay>> {
    let fail = |reason: String| Error::input(path, reason);
    let records: Vec<RayRecord> = serde_json::from_str(text)
        .map_err(|error| fail(format!("not a list of rays: {error}")).caused_by(error))?;
    let known = records.into_iter().enumerate().map(|(index, record)| {
        record
            .known()
            .map_err(|fault| fail(format!("ray {index}: {fault}")))
    });
    known.collect()
}

impl RayRecord {
    fn known(self) -> std::result::Result<KnownRay, String> {
        let ray = Ray::between(self.start, self.end);
        if let Some(fault) = ray.fault() {
            return Err(fault);
        }
        let (kind, scene) = match (&self.scene, &self.kind) {
            (Some(scene), _) => ("scene".to_owned(), Some(whole_scene(scene.clone())?)),
            (None, Some(kind)) => (kind.clone(), self.scene_of(kind)?),
            (None, None) => return Err("neither a kind nor a scene".to_owned()),
        };
        if let Some(scene) = &scene {
            scene.validate().map_err(|error| error.to_string())?;
        }
        Ok(KnownRay {
            kind,
            ray,
            scene,
            exact: self.exact,
            simpson_200: self.simpson_200,
        })
    }

    /// Returns the scene of one source; `None` for a kind that this version does not draw.
    fn scene_of(&self, kind: &str) -> std::result::Result<Option<Scene>, String> {
        let (Some(alpha), Some(beta)) = (self.alpha, self.beta) else {
            return Err("alpha or beta is missing".to_owned());
        };
        let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO));
        scene.decay = Some(Decay::new(alpha, beta));
        scene.integration.measure = Measure::Parameter;
        match kind {
            "sphere" => scene.spheres.push(Sphere {
                center: self.center,
                profile: Profile::Inverse,
                coefficient: 1.0,
                ..Sphere::default()
            }),
            "cylinder" => scene.cylinders.push(Cylinder {
                point: self.center,
                profile: Profile::Inverse,
                coefficient: 1.0,
                ..Cylinder::new(self.direction)
            }),
            "beam" => scene.beams.push(Beam {
                tip: self.center,
                profile: Profile::Inverse,
                coefficient: 1.0,
                ..Beam::new(self.direction)
            }),
            "sphere-inverse-square" => scene.spheres.push(Sphere {
                center: self.center,
                profile: Profile::InverseSquare,
                coefficient: 1.0,
                ..Sphere::default()
            }),
            "beam-inverse-square" => scene.beams.push(Beam {
                tip: self.center,
                end: BeamEnd::Taper(self.taper_length),
                profile: Profile::InverseSquare,
                coefficient: 1.0,
                ..Beam::new(self.direction)
            }),
            "torus" => scene.tori.push(Torus {
                center: self.center,
                axis: self.axis,
                profile: Profile::Inverse,
                coefficient: 1.0,
                ..Torus::new(self.major_radius)
            }),
            "curve" | "curve-weighted" | "curve-straight" | "curve-cusp" => {
                scene.curves.push(Curve {
                    intensity: (!self.weights.is_empty()).then(|| self.weights.clone()),
                    profile: Profile::Inverse,
                    coefficient: 1.0,
                    ..Curve::new(self.control_points)
                });
            }
            _ => return Ok(None),
        }
        Ok(Some(scene))
    }
}

/// Reads a scene as in a JSON scene file, of which the camera plays no part.
fn whole_scene(mut scene: serde_json::Value) -> std::result::Result<Scene, String> {
    if let Some(tables) = scene.as_object_mut()
        && !tables.contains_key("camera")
    {
        let anywhere = serde_json::json!({"eye": [0.0, -4.0, 0.0], "target": [0.0, 0.0, 0.0]});
        tables.insert("camera".to_owned(), anywhere);
    }
    Scene::from_json(&scene.to_string()).map_err(|error| error.to_string())
}

impl KnownRay {
    /// Finds the least distance from the ray to a core, world units; 0 for a kind that this version does not draw.
    #[must_use]
    pub fn miss(&self) -> f64 {
        let Some(scene) = &self.scene else {
            return 0.0;
        };
        let mut breaks = vec![0.0, 1.0];
        let sources = reference::sources(scene);
        let distances = sources.iter().flat_map(|source| {
            source.field.breaks(&self.ray, &mut breaks);
            let within: Vec<f64> = breaks.iter().map(|s| s.clamp(0.0, 1.0)).collect();
            let distance = |s: f64| source.field.sample(self.ray.at(s)).distance2.sqrt();
            within.into_iter().map(distance).collect::<Vec<_>>()
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    /// Returns what a method should give, and the largest relative error allowed; `None` if that is not known.
    fn expected(&self, method: Method) -> Option<(f64, f64)> {
        match method {
            Method::Exact { tolerance, .. } => Some((self.exact, tolerance)),
            Method::Simpson { .. } => {
                let limit = match self.miss() > CLOSE {
                    true => SIMPSON_LIMIT,
                    false => SIMPSON_LIMIT_CLOSE,
                };
                Some((self.simpson_200?, limit))
            }
            Method::Jittered { .. } => None,
        }
    }
}

/// Sends the rays of every kind that this version draws through a device, by a method whose value is known: `exact`, or
/// `simpson` with [`DIVISIONS`] divisions.
///
/// # Errors
/// As [`Renderer::integrate`].
pub fn verify(
    renderer: &mut Renderer,
    device: &str,
    rays: &[KnownRay],
    method: Method,
) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (index, ray) in rays.iter().enumerate() {
        let (Some(scene), Some((expected, limit))) = (&ray.scene, ray.expected(method)) else {
            continue;
        };
        let mut scene = scene.clone();
        scene.integration.method = method;
        let integrals = renderer.integrate(&scene, &[ray.ray])?;
        let value = integrals.first().map_or(f64::NAN, |[_, green, _]| *green);
        rows.push(Row {
            index,
            kind: ray.kind.clone(),
            method: method.name(),
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

/// Returns the relative error, 0 where both are 0.
fn relative_error(value: f64, expected: f64) -> f64 {
    if value == expected {
        return 0.0;
    }
    ((value - expected) / expected).abs()
}
