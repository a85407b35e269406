//! Meshes in float64, by another method than the kernels': in halves of halves (`src/scene/mesh/halves.rs`).

use std::f64::consts::PI;

use glam::DVec3;

use super::irradiance::Caster;

use crate::error::Result;
use crate::image::{DepthAlong, DepthImage};
use crate::scene::{AMBIENT, Halves, LAMP, Mesh, Scene, SeenSurfaces, ViewPlane};
use crate::threads;

/// A ray still sees what its length, in float32, ends before by this share.
const ROUNDING: f64 = 1e-6;

/// How near to an end of a way nothing hides it, as a share of the size of all meshes.
const MARGIN: f64 = 1e-7;

/// What hides light from surfaces: the triangles of all meshes.
#[derive(Debug)]
pub(super) struct Hiding {
    halves: Halves,
    /// What is nearer to an end of a way hides nothing of it, world units.
    pub margin: f64,
    /// Farther than any two places of the meshes are apart.
    pub beyond: f64,
}

impl Hiding {
    /// Makes that of meshes; `None` of none.
    pub(super) fn new(meshes: &[Mesh]) -> Option<Self> {
        let halves = (!meshes.is_empty()).then(|| Halves::new(meshes))?;
        let (low, high) = halves.bounds();
        let size = low.distance(high);
        Some(Self {
            halves,
            margin: MARGIN * size,
            beyond: 2.0 * size,
        })
    }

    /// Returns whether something is between two places.
    pub(super) fn hides(&self, from: DVec3, to: DVec3) -> bool {
        let length = from.distance(to);
        let direction = (to - from) / length;
        let met = nearest(&self.halves, from, direction);
        met.length > self.margin && met.length < length - self.margin
    }
}

/// What a ray meets of meshes.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshRay {
    /// From where depths begin, world units; infinite: nothing.
    pub length: f64,
    /// Of the triangle's plane, towards the eye, of length 1.
    pub normal: DVec3,
    /// Whose triangle it is.
    pub mesh: usize,
}

impl MeshRay {
    const NONE: Self = Self {
        length: f64::INFINITY,
        normal: DVec3::ZERO,
        mesh: 0,
    };
}

/// Returns what a ray meets first.
fn nearest(halves: &Halves, origin: DVec3, direction: DVec3) -> MeshRay {
    let met = halves.nearest(origin, direction);
    met.map_or(MeshRay::NONE, |(length, triangle)| {
        let normal = triangle.normal();
        let away = normal.dot(direction) > 0.0;
        MeshRay {
            length,
            normal: if away { -normal } else { normal },
            mesh: triangle.mesh,
        }
    })
}

/// Traces the rays of a grid, so many across a pixel, to the meshes of a scene; by rows from the top left.
#[doc(hidden)]
#[must_use]
pub fn mesh_rays(scene: &Scene, across: u32) -> Vec<MeshRay> {
    let (grid, plane) = scene.ray_grid(across);
    let halves = Halves::new(&scene.meshes);
    let width = grid.width as usize;
    let mut rays = vec![MeshRay::NONE; grid.pixels()];
    threads::for_each_chunk(&mut rays, width, |row, rays| {
        for (column, ray) in rays.iter_mut().enumerate() {
            let (from, direction, _) = line(&plane, column, row);
            *ray = nearest(&halves, from, direction);
        }
    });
    rays
}

/// Returns where depths along a ray begin, its direction, and how far along it the plane is.
fn line(plane: &ViewPlane, column: usize, row: usize) -> (DVec3, DVec3, f64) {
    let ray = plane.ray(column as u32, row as u32);
    let direction = ray.span.normalize();
    let to_plane = plane.before_plane(ray.origin - plane.eye);
    (ray.origin - to_plane * direction, direction, to_plane)
}

/// What rays meet of the meshes of a scene.
#[derive(Debug)]
pub(crate) struct TracedMeshes {
    /// How far each ray goes to them, or to the scene's depths.
    pub depth: DepthImage,
    rays: Vec<MeshRay>,
}

impl TracedMeshes {
    /// Traces the rays of a valid scene's picture.
    pub(crate) fn new(scene: &Scene) -> Result<Self> {
        let across = scene.rays_across();
        let (grid, plane) = scene.ray_grid(across);
        let mut rays = mesh_rays(scene, across);
        let width = grid.width as usize;
        let mut lengths = Vec::with_capacity(rays.len());
        for (index, ray) in rays.iter_mut().enumerate() {
            let (column, row) = (index % width, index / width);
            let given = scene.depth.as_ref().map_or(f64::INFINITY, |depth| {
                let step = width / depth.size().width as usize;
                let value =
                    depth.as_slice()[row / step * depth.size().width as usize + column / step];
                plane.distance(value, depth.along(), line(&plane, column, row).2)
            });
            if ray.length >= given {
                *ray = MeshRay::NONE;
            }
            lengths.push(ray.length.min(given) as f32);
        }
        Ok(Self {
            depth: DepthImage::new(grid, DepthAlong::Ray, lengths)?,
            rays,
        })
    }

    /// Returns the mean radiance of each pixel's rays that come so far, RGBA by rows: ambient, and by Lambert's law
    /// that of the lamp that lights metaballs.
    pub(crate) fn light(&self, scene: &Scene, ends: &DepthImage) -> Vec<f32> {
        let across = (ends.size().width / scene.image.width) as usize;
        let (_, plane) = scene.ray_grid(across as u32);
        let caster = scene
            .lighting
            .map(|lighting| (lighting, Caster::new(scene, lighting)));
        let lamp = LAMP.x * plane.column_step.normalize()
            + LAMP.y * plane.row_step.normalize()
            + LAMP.z * plane.forward;
        let lamp = lamp.normalize();
        let share = 1.0 / (across * across) as f64;
        let width = scene.image.width as usize;
        let radiance = |index: usize| {
            let ray = &self.rays[index];
            let end = f64::from(ends.as_slice()[index]);
            if !ray.length.is_finite() || ray.length > end * (1.0 + ROUNDING) {
                return DVec3::ZERO;
            }
            let albedo = scene.meshes[ray.mesh].albedo;
            let Some((lighting, caster)) = &caster else {
                let facing = ray.normal.dot(lamp).max(0.0);
                return albedo * (AMBIENT + (1.0 - AMBIENT) * facing);
            };
            let (from, direction, _) =
                line(&plane, index % (width * across), index / (width * across));
            let place = from + ray.length * direction;
            let mut light = lighting.ambient + caster.irradiance(place, ray.normal) / PI;
            if let Some(sun) = &lighting.sun {
                let to_sun = sun.direction.normalize();
                let facing = ray.normal.dot(to_sun).max(0.0);
                if facing > 0.0 && caster.sees(place, ray.normal, to_sun) {
                    light += facing * sun.color;
                }
            }
            albedo * light
        };
        let mut light = vec![0.0_f32; 4 * scene.image.pixels()];
        for (index, pixel) in light.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let (column, row) = (index % width * across, index / width * across);
            let parts = (0..across * across).map(|part| {
                radiance((row + part / across) * width * across + column + part % across)
            });
            let [red, green, blue] = (share * parts.sum::<DVec3>()).as_vec3().to_array();
            *pixel = [red, green, blue, 1.0];
        }
        light
    }
}

/// Finds meshes along the rays of a picture, and behind them what `see_behind` finds of all other surfaces.
pub(crate) fn see_meshes(
    scene: &Scene,
    see_behind: impl FnOnce(&Scene) -> Result<SeenSurfaces>,
) -> Result<SeenSurfaces> {
    let traced = TracedMeshes::new(scene)?;
    let mut seen = see_behind(&scene.behind_meshes(&traced.depth))?;
    let light = traced.light(scene, &seen.depth);
    seen.brighten(&light);
    Ok(seen)
}
