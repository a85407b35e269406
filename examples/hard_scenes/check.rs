//! Holds images of a hard scene to the promise, and knows the limits that are documented.

use energywave::internals::{Integrand, Source, ViewPlane, exact, integrate, sources};
use energywave::scene::{BeamEnd, Measure, Method, Ray, Sampling};
use energywave::{RadianceImage, Renderer, Result, Scene, reference};
use glam::DVec3;

use super::scenes::HardScene;
use ties::tied_sources;

#[path = "ties.rs"] // this file belongs to a test too
mod ties;

/// What no float32 device can undercut: for 99.9 % of the pixels, and for the worst.
const MOST_PIXELS: f64 = 2e-5;
const WORST_PIXEL: f64 = 2e-4;

/// Errors are relative to a pixel's light, and where sources cancel, to no less than this share of what they would add
/// up to if all were positive.
const CANCELLED: f64 = 1.0 / 30.0;

/// How far a ray may be off, as a share of a scene's scale: where positions have float32's digits only, and where the
/// reference's own decide, on which side of a plane a ray runs.
const OF_FLOAT32: f64 = 1e-7;
const OF_FLOAT64: f64 = 3e-14;

/// By how much the end of a ray may be off, as a share of its length.
const OF_END: f64 = 1e-7;

/// How black a dark stretch of a curve is, as a share of what the brightest weight everywhere would give.
const OF_WEIGHTS: f64 = 3e-7;

/// How well the range of lights is known that ties allow, as a share of them.
const OF_TIES: f64 = 1e-6;

/// How an image compares with the float64 reference.
#[derive(Debug, Clone)]
pub struct Found {
    pub sampling: Sampling,
    pub tolerance: f64,
    /// Errors relative to the light: the worst, and 99.9 % are within the other.
    pub max: f64,
    pub p999: f64,
    /// Column and row of the worst pixel, its drawn light and that expected.
    pub worst: (u32, u32),
    pub values: (f32, f32),
    /// Pixels beyond the tolerance, and beyond ten times as much.
    pub beyond: (usize, usize),
    /// Whether the promise is kept.
    pub meets: bool,
    /// Whether it is but for rays so close to a jump of the light that rounding decides what they see.
    pub is_limit: bool,
}

/// A scene with what its images are held against.
pub struct Checked<'a> {
    hard: &'a HardScene,
    expected: RadianceImage,
    /// The light of the scene with every light positive.
    light: RadianceImage,
}

impl<'a> Checked<'a> {
    /// Takes the reference of a scene.
    pub fn new(hard: &'a HardScene) -> Result<Self> {
        let expected = reference::render(&hard.scene)?;
        let light = match with_positive_light(&hard.scene) {
            Some(scene) => reference::render(&scene)?,
            None => expected.clone(),
        };
        Ok(Self {
            hard,
            expected,
            light,
        })
    }

    /// Draws the scene and compares.
    pub fn draw(
        &self,
        renderer: &mut Renderer,
        sampling: Sampling,
        tolerance: f64,
    ) -> Result<Found> {
        let mut scene = self.hard.scene.clone();
        scene.integration.method = Method::Exact {
            tolerance,
            sampling,
        };
        let image = renderer.render(&scene)?;
        let mut errors = self.errors(&image);
        let mut found = self.found(&image, &errors, sampling, tolerance);
        if !found.meets {
            self.excuse(&image, &mut errors, tolerance.max(MOST_PIXELS));
            found.is_limit = self.found(&image, &errors, sampling, tolerance).meets;
        }
        Ok(found)
    }

    /// Returns every pixel's error, of its worst channel; two zeros agree.
    fn errors(&self, image: &RadianceImage) -> Vec<f64> {
        let error = |index: usize| {
            let at = |image: &RadianceImage| f64::from(image.as_slice()[index]);
            let (drawn, expected) = (at(image), at(&self.expected));
            let light = expected.abs().max(CANCELLED * at(&self.light).abs());
            let error = (drawn - expected).abs() / light;
            match () {
                () if drawn == expected => 0.0,
                () if error.is_nan() => f64::INFINITY,
                () => error,
            }
        };
        let pixels = 0..image.size().pixels();
        let channels = |pixel| (4 * pixel..4 * pixel + 3).map(error);
        pixels
            .map(|pixel| channels(pixel).fold(0.0, f64::max))
            .collect()
    }

    fn found(
        &self,
        image: &RadianceImage,
        errors: &[f64],
        sampling: Sampling,
        tolerance: f64,
    ) -> Found {
        let most = tolerance.max(MOST_PIXELS);
        let worst_allowed = (10.0 * tolerance).max(WORST_PIXEL);
        let worst = (0..errors.len()).max_by(|a, b| errors[*a].total_cmp(&errors[*b]));
        let worst = worst.unwrap_or_default();
        let mut sorted = errors.to_vec();
        sorted.sort_by(f64::total_cmp);
        let within = (0.999 * sorted.len() as f64).ceil() as usize;
        let (max, p999) = (errors[worst], sorted[within.clamp(1, sorted.len()) - 1]);
        let beyond = |limit: f64| errors.iter().filter(|error| **error > limit).count();
        let width = image.size().width;
        Found {
            sampling,
            tolerance,
            max,
            p999,
            worst: (worst as u32 % width, worst as u32 / width),
            values: (
                image.as_slice()[4 * worst],
                self.expected.as_slice()[4 * worst],
            ),
            beyond: (beyond(most), beyond(worst_allowed)),
            meets: p999 <= most && max <= worst_allowed,
            is_limit: false,
        }
    }

    /// Takes away the errors of pixels whose light is that of a ray so close beside theirs that rounding does not tell
    /// them apart.
    fn excuse(&self, image: &RadianceImage, errors: &mut [f64], tolerance: f64) {
        let share = match self.hard.is_sharp() {
            true if self.hard.is_exact => 0.0,
            true => OF_FLOAT64,
            false => OF_FLOAT32,
        };
        let wrong: Vec<usize> = (0..errors.len())
            .filter(|i| errors[*i] > tolerance)
            .collect();
        if wrong.len() > errors.len() / 4 {
            return;
        }
        let tracer = Tracer::new(&self.hard.scene);
        let even = with_even_weights(&self.hard.scene);
        let even = even.as_ref().map(Tracer::new);
        for index in wrong {
            let (mut low, mut high) = tracer.range(index, share * self.hard.scale);
            if let Some((darkest, brightest)) = tracer.range_of_ties(index) {
                (low, high) = (low.min(darkest), high.max(brightest));
            }
            let dark = even
                .as_ref()
                .map_or(0.0, |even| OF_WEIGHTS * even.light(index));
            let slack = dark + tolerance * f64::from(self.light.as_slice()[4 * index]).abs();
            let drawn = f64::from(image.as_slice()[4 * index]);
            if low - slack <= drawn && drawn <= high + slack {
                errors[index] = 0.0;
            }
        }
    }
}

/// Returns the scene with every light positive, where it has lights of both signs.
fn with_positive_light(scene: &Scene) -> Option<Scene> {
    let mut positive = scene.clone();
    for sphere in positive.spheres.iter_mut() {
        sphere.coefficient = sphere.coefficient.abs();
    }
    for cylinder in positive.cylinders.iter_mut() {
        cylinder.coefficient = cylinder.coefficient.abs();
    }
    for beam in positive.beams.iter_mut() {
        beam.coefficient = beam.coefficient.abs();
        beam.sphere_coefficient = beam.sphere_coefficient.abs();
        if let BeamEnd::Cap(Some(cap)) = &mut beam.end {
            *cap = cap.abs();
        }
    }
    for torus in positive.tori.iter_mut() {
        torus.coefficient = torus.coefficient.abs();
    }
    for curve in positive.curves.iter_mut() {
        curve.coefficient = curve.coefficient.abs();
        let weights = curve.intensity.iter_mut().flatten();
        weights.for_each(|weight| *weight = weight.abs());
    }
    for segment in positive.segments.iter_mut() {
        segment.coefficient = segment.coefficient.abs();
    }
    (positive != *scene).then_some(positive)
}

/// Returns the scene with curves as bright everywhere as at their brightest weight; `None` if no curve has weights.
fn with_even_weights(scene: &Scene) -> Option<Scene> {
    let mut even = scene.clone();
    for curve in even.curves.iter_mut() {
        let weights = curve.intensity.take();
        let most = weights.map(|weights| weights.into_iter().fold(0.0_f64, |a, b| a.max(b.abs())));
        curve.coefficient = curve.coefficient.abs() * most.unwrap_or(1.0);
    }
    (even != *scene).then_some(even)
}

/// Integrates along rays beside those of an image, in float64.
struct Tracer<'a> {
    scene: &'a Scene,
    plane: ViewPlane,
    sources: Vec<Source>,
    /// The same as dark and as bright as rounding may see them; `None` if that makes no difference.
    ties: Option<[Vec<Source>; 2]>,
    integrand: Integrand,
}

impl<'a> Tracer<'a> {
    fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            plane: scene.view_plane(),
            sources: sources(scene),
            ties: tied_sources(scene, false)
                .zip(tied_sources(scene, true))
                .map(<[_; 2]>::from),
            integrand: Integrand {
                decay: scene.decay,
                absorption: scene.absorption,
                softening: scene.integration.softening,
            },
        }
    }

    /// Returns the ray of a pixel, and where depths end it.
    fn ray(&self, index: usize) -> (Ray, f64) {
        let width = self.scene.image.width as usize;
        let ray = self
            .plane
            .ray((index % width) as u32, (index / width) as u32);
        let end = self.scene.depth.as_ref().map_or(1.0, |depth| {
            self.plane.end(&ray, depth.as_slice()[index], depth.along())
        });
        (ray, end)
    }

    /// Returns the light of a pixel, of its first channel.
    fn light(&self, index: usize) -> f64 {
        let (ray, end) = self.ray(index);
        self.radiance(&ray, end).x
    }

    /// Returns the least and the greatest light of a pixel, of its first channel, whose ray is moved aside by so much,
    /// or ends where rounding has it.
    fn range(&self, index: usize, reach: f64) -> (f64, f64) {
        let (ray, end) = self.ray(index);
        let right = self.plane.column_step.normalize();
        let down = self.plane.row_step.normalize();
        let sooner = self.radiance(&ray, end * (1.0 - OF_END)).x;
        let later = self.radiance(&ray, end * (1.0 + OF_END)).x;
        let (mut low, mut high) = (sooner.min(later), sooner.max(later));
        let steps = if reach > 0.0 { 16 } else { 0 };
        for step in 0..steps {
            let angle = f64::from(step % 8) * std::f64::consts::FRAC_PI_4;
            let shift = reach * (right * angle.cos() + down * angle.sin());
            let shift = if step < 8 { shift } else { 0.1 * shift };
            let moved = Ray {
                origin: ray.origin + shift,
                span: ray.span,
            };
            let light = self.radiance(&moved, end).x;
            (low, high) = (low.min(light), high.max(light));
        }
        (low, high)
    }

    /// Returns the least and the greatest light of a pixel, of its first channel, whichever of a curve's points
    /// rounding takes for the nearest.
    fn range_of_ties(&self, index: usize) -> Option<(f64, f64)> {
        let [darkest, brightest] = self.ties.as_ref()?;
        let (ray, end) = self.ray(index);
        let light = |sources: &[Source]| {
            let light = |source: &Source| {
                let mut breaks = Vec::new();
                source.field.breaks(&ray, &mut breaks);
                let integrand = |s| self.integrand.at(source, &ray, s);
                source.emission.x * integrate(integrand, &mut breaks, end, OF_TIES).value
            };
            sources.iter().map(light).sum::<f64>() * self.measure(&ray)
        };
        Some((light(darkest), light(brightest)))
    }

    fn radiance(&self, ray: &Ray, end: f64) -> DVec3 {
        let light = |source: &Source| source.emission * exact(source, ray, &self.integrand, end);
        self.sources.iter().map(light).sum::<DVec3>() * self.measure(ray)
    }

    /// Returns what the integral over the parameter is multiplied by.
    fn measure(&self, ray: &Ray) -> f64 {
        match self.scene.integration.measure {
            Measure::Length => ray.span.length(),
            _ => 1.0,
        }
    }
}
