//! Volumes in float64: the integral of what is interpolated between cells, by adaptive quadrature of each part of a ray
//! that is about a cell long, and Lagrange's and Hermite's form of the polynomials. Slices are drawn as the integral
//! that they approach.

use glam::DVec3;

use super::Integrand;
use super::quadrature::integrate;
use crate::scene::{Ray, Scene, Volume, VolumeInterpolation};
use crate::threads;
use crate::volume::Storage;

/// The relative error of each integral: volumes have kinks at every cell.
const ERROR: f64 = 1e-7;

/// All volumes of a scene.
#[derive(Debug)]
pub(super) struct Volumes {
    list: Vec<Volume>,
    integrand: Integrand,
}

impl Volumes {
    pub(super) fn new(scene: &Scene, integrand: Integrand) -> Self {
        Self {
            list: Volume::all_as_seen(&scene.volumes, &scene.view_plane()),
            integrand,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Returns the linear RGB along a ray, over s in [0, end].
    pub(super) fn light(&self, ray: &Ray, end: f64) -> DVec3 {
        let of = |volume: &Volume| {
            let light = [0, 1, 2].map(|channel| self.integral(volume, channel, ray, end));
            volume.emission() * DVec3::from(light)
        };
        self.list.iter().map(of).sum()
    }

    fn integral(&self, volume: &Volume, channel: usize, ray: &Ray, end: f64) -> f64 {
        let inward = volume.axes().transpose();
        let (from, span) = (inward * (ray.origin - volume.center), inward * ray.span);
        let (mut low, mut high) = (0.0_f64, end);
        for axis in 0..3 {
            let half = 0.5 * volume.size[axis];
            let faces = [-half, half].map(|face| (face - from[axis]) / span[axis]);
            match span[axis] == 0.0 {
                true if from[axis].abs() > half => return 0.0,
                true => {}
                false => {
                    low = low.max(faces[0].min(faces[1]));
                    high = high.min(faces[0].max(faces[1]));
                }
            }
        }
        if low >= high {
            return 0.0;
        }
        let per_cell = DVec3::from(volume.texture.cells().map(f64::from)) / volume.size;
        let parts = ((high - low) * (span * per_cell).length()).ceil().max(1.0);
        let mut breaks: Vec<f64> = (0..=parts as u32)
            .map(|part| low + (high - low) * f64::from(part) / parts)
            .collect();
        let at = |s: f64| {
            let place = (from + s * span + 0.5 * volume.size) * per_cell - 0.5;
            let is_in = s >= low && s <= high;
            let light = if is_in {
                emission(volume, channel, place)
            } else {
                0.0
            };
            light * self.integrand.fading(ray, s)
        };
        integrate(at, &mut breaks, high, ERROR).value
    }
}

/// Returns the emission at a place, counted in cells from the middle of the first.
fn emission(volume: &Volume, channel: usize, place: DVec3) -> f64 {
    let texture = &volume.texture;
    let cells = texture.cells();
    let channel = channel.min(texture.channels() as usize - 1);
    let plane: usize = cells.iter().map(|it| *it as usize).product();
    let values = &texture.values()[channel * plane..][..plane];
    let first = place.floor();
    let value = |offset: [i64; 3]| {
        let at = |axis: usize| {
            (first[axis] as i64 + offset[axis]).clamp(0, i64::from(cells[axis]) - 1) as usize
        };
        f64::from(values[(at(2) * cells[1] as usize + at(1)) * cells[0] as usize + at(0)])
    };
    let share = place - first;
    let line = |y: i64, z: i64| between(volume.interpolation, share.x, |x| value([x, y, z]));
    let sheet = |z: i64| between(volume.interpolation, share.y, |y| line(y, z));
    let stored = between(volume.interpolation, share.z, sheet);
    match texture.storage() {
        Storage::Emission => stored.max(0.0),
        Storage::Reciprocal { power } => {
            let stored = stored.abs().max(f64::from(texture.floor()));
            stored.powf(-1.0 / f64::from(power))
        }
    }
}

/// Interpolates between what is at 0 and at 1; a cubic has the slopes of the chords from -1 to 1 and from 0 to 2.
fn between(interpolation: VolumeInterpolation, share: f64, at: impl Fn(i64) -> f64) -> f64 {
    let (from, to) = (at(0), at(1));
    if interpolation == VolumeInterpolation::Linear {
        return from + share * (to - from);
    }
    let slopes = [0.5 * (to - at(-1)), 0.5 * (at(2) - from)];
    let chord = to - from;
    let bend = slopes[0] + slopes[1] - 2.0 * chord;
    from + share * (slopes[0] + share * (chord - slopes[0] - bend + share * bend))
}

/// Returns the light of volumes along each ray, over the parameter or the length as the scene's measure says.
pub(crate) fn volume_light(scene: &Scene, rays: &[Ray]) -> Vec<DVec3> {
    let volumes = Volumes::new(scene, Integrand::of(scene));
    let mut lights = vec![DVec3::ZERO; rays.len()];
    threads::for_each_chunk(&mut lights, 1, |index, light| {
        let ray = &rays[index];
        let scale = scene.integration.scale(ray.span.length());
        light.fill(volumes.light(ray, 1.0) * scale);
    });
    lights
}
