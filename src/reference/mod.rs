//! The truth in float64, by another method than the kernels': adaptive quadrature on the pieces between the points
//! where a ray comes closest to a core. Also the built-in device `reference`, which needs no OpenCL.
//!
//! [`render_simpson`] is the paper's composite rule in float64, to check the kernels' Simpson sums.

mod emission;
mod field;
mod footprint;
mod irradiance;
mod mesh;
mod particles;
mod points;
mod quadrature;
mod surface;
mod volumes;

use std::ops::{ControlFlow, Range};
use std::slice;

use glam::DVec3;

pub(crate) use emission::Emitter;
#[doc(hidden)]
pub use field::{CurveField, Field, Sample, Source, b_spline, sources};
pub use irradiance::irradiance;
pub(crate) use mesh::see_meshes;
#[doc(hidden)]
pub use mesh::{MeshRay, mesh_rays};
pub(crate) use particles::particle_light;
#[doc(hidden)]
pub use points::{light_of_points, light_of_points_up_to};
#[doc(hidden)]
pub use quadrature::integrate;
pub(crate) use surface::see_surfaces;
#[doc(hidden)]
pub use surface::{SurfaceRay, surface_rays};
pub(crate) use volumes::volume_light;

use particles::Particles;
use volumes::Volumes;

use crate::error::{Error, Result};
use crate::image::RadianceImage;
use crate::scene::{
    Absorption, CORE_FLOOR, Decay, DepthLayers, Falloff, Integration, Method, Profile, Ray,
    Reduction, Scene, ViewPlane,
};
use crate::threads;

/// Relative error that [`exact`] aims at.
pub const RELATIVE_ERROR: f64 = 1e-10;

/// Beyond so many standard deviations nothing is left of a Gaussian.
const GAUSSIAN_END: f64 = 9.0;

/// How exactly edges of light are found, as a share of the ray; light begins there with the square of what is missing.
const EDGE_WIDTH: f64 = 1e-6;

/// Where absorption has left some of the light, and where little, in lengths over which it falls by the factor e.
const ABSORBED: [f64; 4] = [1.0, 4.0, 16.0, 64.0];

/// What is integrated along a ray besides the field.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrand {
    /// Decay; `None`: zeta = 1.
    pub decay: Option<Decay>,
    /// Absorption; `None`: there is none.
    pub absorption: Option<Absorption>,
    /// Softening radius, world units.
    pub softening: f64,
}

impl Integrand {
    fn of(scene: &Scene) -> Self {
        Self {
            decay: scene.decay,
            absorption: scene.absorption,
            softening: scene.integration.softening,
        }
    }

    /// Returns `psi(L(s)) zeta(s)` for one source of emission 1.
    pub fn at(&self, source: &Source, ray: &Ray, s: f64) -> f64 {
        self.field(source, ray, s) * self.fading(ray, s)
    }

    fn field(&self, source: &Source, ray: &Ray, s: f64) -> f64 {
        let floor2 = CORE_FLOOR * CORE_FLOOR * ray.span.length_squared();
        let radius = source.falloff.radius;
        let softening2 = radius * radius + self.softening * self.softening;
        source
            .field
            .light(ray.at(s), &source.falloff, softening2, floor2)
    }

    /// Returns what decay and absorption leave of the light.
    fn fading(&self, ray: &Ray, s: f64) -> f64 {
        let zeta = self.decay.map_or(1.0, |decay| decay.at(s));
        let length = s * ray.span.length();
        let left = self
            .absorption
            .map_or(1.0, |absorption| absorption.at(length));
        zeta * left
    }

    /// Adds breaks to where a ray comes into the light: from there on it may be absorbed at once.
    fn add_depths(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        let kappa = self.absorption.map_or(0.0, |absorption| absorption.kappa);
        let depth = 1.0 / (kappa * ray.span.length());
        if depth >= 1.0 {
            return;
        }
        breaks.push(0.0);
        for begin in 0..breaks.len() {
            let begin = breaks[begin];
            breaks.extend(ABSORBED.map(|depths| begin + depths * depth));
        }
    }
}

/// Integrates a source's field times the decay over s in `[0,end]`, to [`RELATIVE_ERROR`].
#[doc(hidden)]
pub fn exact(source: &Source, ray: &Ray, integrand: &Integrand, end: f64) -> f64 {
    let at = |s| integrand.at(source, ray, s);
    adaptive(at, slice::from_ref(source), ray, integrand, end)
}

/// Integrates what is summed of some sources' fields.
fn adaptive(
    at: impl Fn(f64) -> f64,
    sources: &[Source],
    ray: &Ray,
    integrand: &Integrand,
    end: f64,
) -> f64 {
    let mut breaks = Vec::with_capacity(16);
    for source in sources {
        source.field.breaks(ray, &mut breaks);
        add_edges(source, ray, &mut breaks);
    }
    integrand.add_depths(ray, &mut breaks);
    integrate(at, &mut breaks, end, RELATIVE_ERROR).value
}

/// Adds a break wherever the ray comes to or leaves the light of a source that ends at a distance: no node may be near.
fn add_edges(source: &Source, ray: &Ray, breaks: &mut Vec<f64>) {
    let Falloff {
        profile,
        radius,
        reach,
    } = source.falloff;
    let width = (profile == Profile::Gaussian).then_some(GAUSSIAN_END * radius);
    let Some(end) = [width, reach].into_iter().flatten().min_by(f64::total_cmp) else {
        return;
    };
    // Along a ray the distance changes by no more than the way.
    let length = ray.span.length();
    let mut open = vec![(0.0, 1.0)];
    while let Some((from, to)) = open.pop() {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let to_edge = source.field.sample(ray.at(middle)).distance2.sqrt() - end;
        if to_edge.abs() > 1.001 * half * length {
            continue;
        }
        if half < EDGE_WIDTH {
            breaks.push(middle);
        } else {
            open.extend([(from, middle), (middle, to)]);
        }
    }
}

/// Takes the same integral by the composite Simpson rule with an even number of equal divisions (2015, eq. 23).
#[doc(hidden)]
pub fn simpson(source: &Source, ray: &Ray, integrand: &Integrand, end: f64, divisions: u32) -> f64 {
    simpson_sum(|s| integrand.at(source, ray, s), end, divisions)
}

fn simpson_sum(integrand: impl Fn(f64) -> f64, end: f64, divisions: u32) -> f64 {
    simpson_nodes(divisions)
        .map(|(s, weight)| end * weight * integrand(end * s))
        .sum()
}

/// Takes the same integral by one sample in each of equal strata, at the same random place in all of them (Cook 1986).
fn jittered(integrand: impl Fn(f64) -> f64, end: f64, divisions: u32, random: f64) -> f64 {
    let length = end / f64::from(divisions);
    let sample = |k: u32| length * integrand(length * (f64::from(k) + random));
    (0..divisions).map(sample).sum()
}

/// Returns the random number, in `[0,1)`, of a pixel or ray: that of the devices, `cl/random.h`.
fn random(number: u32, seed: u32) -> f64 {
    let hash = |value: u32| {
        let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    };
    f64::from(hash(hash(number).wrapping_add(seed)) >> 8) / f64::from(1 << 24)
}

/// Gives parameter and weight of each of the `divisions + 1` samples of the composite Simpson rule over `[0,1]`.
fn simpson_nodes(divisions: u32) -> impl Iterator<Item = (f64, f64)> {
    let n = f64::from(divisions);
    (0..=divisions).map(move |k| {
        let factor = match k {
            0 => 1.0,
            k if k == divisions => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        (f64::from(k) / n, factor / (3.0 * n))
    })
}

/// Renders the scene's linear radiance in float64, every integral to [`RELATIVE_ERROR`], whatever the scene's method.
/// Where pixels are means over their squares ([`crate::scene::Antialias`]), those next to cores are means of many rays,
/// within about 1e-3 where a core is a thirtieth of a pixel thick at least. Waves and colliders are left out; a
/// [`Renderer`](crate::Renderer) on the reference draws them, too. Runs on all cores.
///
/// # Errors
/// [`Error::Scene`] if the scene is not valid, [`Error::OutOfMemory`] if the image is too large for memory.
pub fn render(scene: &Scene) -> Result<RadianceImage> {
    render_image(scene, Method::default())
}

/// Renders the scene's linear radiance by the float64 Simpson rule, whatever the scene's method.
///
/// # Errors
/// As [`render`].
pub fn render_simpson(scene: &Scene, divisions: u32) -> Result<RadianceImage> {
    render_image(scene, Method::Simpson { divisions })
}

fn render_image(scene: &Scene, method: Method) -> Result<RadianceImage> {
    scene.validate()?;
    if scene.has_points() {
        return render_image(&scene.with_points_apart(), method);
    }
    if scene.metaballs.is_empty() && scene.meshes.is_empty() {
        return render_light(scene, method);
    }
    let seen = match scene.meshes.is_empty() {
        true => see_surfaces(scene)?,
        false => see_meshes(scene, see_surfaces)?,
    };
    let mut image = render_light(&seen.left_of(scene), method)?;
    let stride = 4 * scene.image.width as usize;
    seen.add(scene, 0..scene.image.height, (image.as_mut_slice(), stride));
    Ok(image)
}

/// Renders a scene without surfaces.
fn render_light(scene: &Scene, method: Method) -> Result<RadianceImage> {
    let mut image = RadianceImage::new(scene.image)?;
    let nothing = &mut |_: f32| ControlFlow::Continue(());
    let rows = 0..scene.image.height;
    match DepthLayers::of(scene, None)? {
        None => render_rows(scene, method, rows, image.as_mut_slice(), nothing)?,
        Some(layers) => {
            let stride = 4 * scene.image.width as usize;
            let target = (image.as_mut_slice(), stride);
            layers.draw(scene, rows.clone(), target, &mut |scene, target, _, _| {
                render_rows(scene, method, rows.clone(), target, nothing)
            })?;
        }
    }
    Ok(image)
}

/// Renders some rows of a validated scene, whose depths are as many as its pixels, into `target`, RGBA by rows, in
/// bands between which `progress` may stop the work.
pub(crate) fn render_rows(
    scene: &Scene,
    method: Method,
    rows: Range<u32>,
    target: &mut [f32],
    progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
) -> Result<()> {
    let plane = scene.view_plane();
    let tracer = Tracer::new(scene, method);
    let band_len = tracer.band_len();
    let first = rows.start as usize * scene.image.width as usize;
    let band_count = target.len().div_ceil(4 * band_len);
    for (band, pixels) in target.chunks_mut(4 * band_len).enumerate() {
        threads::for_each_chunk(pixels, 4, |i, pixel| {
            let index = first + band * band_len + i;
            let light =
                tracer.pixel(scene, &plane, index) + tracer.of_particles(scene, &plane, index);
            let light = light.as_vec3();
            pixel.copy_from_slice(&[light.x, light.y, light.z, 1.0]);
        });
        if progress((band + 1) as f32 / band_count as f32).is_break() {
            return Err(Error::Interrupted);
        }
    }
    Ok(())
}

/// A scene ready to be integrated along rays.
pub(crate) struct Tracer {
    sources: Vec<Source>,
    particles: Particles,
    volumes: Volumes,
    integrand: Integrand,
    method: Method,
    integration: Integration,
}

impl Tracer {
    pub(crate) fn new(scene: &Scene, method: Method) -> Self {
        let integrand = Integrand::of(scene);
        Self {
            sources: sources(scene),
            particles: Particles::new(scene, integrand),
            volumes: Volumes::new(scene, integrand),
            integrand,
            method,
            integration: scene.integration,
        }
    }

    /// Returns the linear RGB of a pixel, counted by rows from the top left.
    pub(crate) fn pixel(&self, scene: &Scene, plane: &ViewPlane, index: usize) -> DVec3 {
        self.view(scene, plane, index).light()
    }

    /// Returns whether a pixel is a mean over its square, and not what the ray through its centre gets.
    pub(crate) fn is_mean(&self, scene: &Scene, plane: &ViewPlane, index: usize) -> bool {
        self.view(scene, plane, index).is_mean()
    }

    /// Returns the linear RGB along a ray, over s in `[0,end]`; `number` is that of its pixel, or in its list.
    pub(crate) fn radiance(&self, ray: &Ray, end: f64, number: u32) -> DVec3 {
        self.radiance_of(&self.integrand, ray, end, number)
    }

    fn radiance_of(&self, integrand: &Integrand, ray: &Ray, end: f64, number: u32) -> DVec3 {
        // Parts of a light add up before its root is taken.
        let parts = match self.integration.reduction {
            Reduction::Sum => 1,
            Reduction::Rms => self.sources.len().max(1),
        };
        let lights = self.sources.chunks(parts);
        let light = lights.map(|parts| self.light(parts, integrand, ray, end, number));
        light.sum::<DVec3>() * self.integration.scale(ray.span.length())
    }

    /// Returns the light of parts of one emission, over s.
    fn light(
        &self,
        parts: &[Source],
        integrand: &Integrand,
        ray: &Ray,
        end: f64,
        number: u32,
    ) -> DVec3 {
        let reduction = self.integration.reduction;
        let at = |s: f64| {
            let fields = parts.iter().map(|part| integrand.field(part, ray, s));
            reduction.summand(fields.sum()) * integrand.fading(ray, s)
        };
        let integral = match self.method {
            Method::Exact { .. } => adaptive(at, parts, ray, integrand, end),
            Method::Simpson { divisions } => simpson_sum(at, end, divisions),
            Method::Jittered { divisions, seed } => {
                jittered(at, end, divisions, random(number, seed))
            }
        };
        let emission = parts.first().map_or(DVec3::ZERO, |part| part.emission);
        emission * reduction.of(integral)
    }

    /// Returns the light of particles and volumes along the ray through the middle of a pixel, whatever the method.
    fn of_particles(&self, scene: &Scene, plane: &ViewPlane, index: usize) -> DVec3 {
        if self.particles.len() + self.volumes.len() == 0 {
            return DVec3::ZERO;
        }
        let width = scene.image.width as usize;
        let ray = plane.ray((index % width) as u32, (index / width) as u32);
        let end = scene.depth.as_ref().map_or(1.0, |depth| {
            plane.end(&ray, depth.as_slice()[index], depth.along())
        });
        (self.particles.light(&ray, end) + self.volumes.light(&ray, end))
            * self.integration.scale(ray.span.length())
    }

    /// Returns how many pixels take some tenths of a second, at 50 ns a sample.
    fn band_len(&self) -> usize {
        let samples = self
            .method
            .samples()
            .map_or(500, |samples| samples as usize);
        let count = self.sources.len() + self.particles.len() + 16 * self.volumes.len();
        (10_000_000 / (samples * count.max(1))).clamp(16, 16384)
    }
}
