//! What is made of a scene before its light is drawn: waves of particles become the light that they give off at the
//! scene's moment, and visible colliders surfaces, traced in float64 on the host.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;

use super::{Renderer, RendererBackend};
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::particle::{Simulation, Solid};
use crate::reference;
use crate::scene::{
    AMBIENT, Camera, Collider, ColliderShape, LAMP, List, Scene, SeenSurfaces, ViewPlane,
};
use crate::threads;

/// Beyond every ray, world units.
const FAR: f64 = 1e12;

/// A ray still sees a collider that its length, in float32, ends before by this share.
const ROUNDING: f64 = 1e-6;

/// What is kept from frame to frame.
#[derive(Debug, Default)]
pub(super) struct Stage {
    simulation: Option<Simulation>,
    traced: Option<Traced>,
}

/// Colliders that are seen, and the lengths of rays before them.
#[derive(Debug)]
struct Traced {
    of: TracedScene,
    depth: DepthImage,
    /// Without other surfaces.
    light: Arc<Vec<f32>>,
    /// Columns and rows of pixels beside which there is none.
    lit: [Range<usize>; 2],
}

/// What lengths depend on.
#[derive(Debug, Clone, PartialEq)]
struct TracedScene {
    camera: Camera,
    image: ImageSize,
    across: u32,
    colliders: List<Collider>,
    depth: Option<DepthImage>,
}

/// A collider that is seen.
struct Seen {
    solid: Solid,
    color: DVec3,
}

impl Scene {
    /// Returns whether there are surfaces that hide light.
    pub(super) fn has_surfaces(&self) -> bool {
        let has_listed = !self.metaballs.is_empty() || !self.meshes.is_empty();
        has_listed || self.colliders.iter().any(|collider| collider.visible)
    }

    /// Returns whether a frame is put together on the host.
    pub(super) fn has_stage(&self) -> bool {
        !self.waves.is_empty() || self.has_surfaces() || self.has_points()
    }
}

impl Renderer {
    /// Returns a scene with the light of its waves at its moment in their place, and colliders that are seen meshes
    /// among its meshes; `None`: it has neither.
    pub(super) fn simulated(&mut self, scene: &Scene) -> Result<Option<Scene>> {
        let simulated = self.simulated_waves(scene)?;
        let given = simulated.as_ref().unwrap_or(scene);
        let simulated = with_meshes(given).or(simulated);
        if !scene.has_points() {
            return Ok(simulated);
        }
        let given = simulated.as_ref().unwrap_or(scene);
        let has_crowds = !matches!(self.backend, RendererBackend::Reference { .. });
        Ok(given.with_crowds(has_crowds).or(simulated))
    }

    /// Returns a scene with the light of its waves at its moment in their place; `None`: it has none.
    pub(super) fn simulated_waves(&mut self, scene: &Scene) -> Result<Option<Scene>> {
        if scene.waves.is_empty() {
            return Ok(None);
        }
        let mut simulation = match self.stage.simulation.take() {
            Some(simulation) if simulation.is_of(scene) => simulation,
            _ => Simulation::new(scene)?,
        };
        let frame = scene.simulation_settings().time.unwrap_or(0.0);
        let light = simulation.light(frame);
        self.stage.simulation = Some(simulation);
        let mut light = light?;
        light.extend_from_slice(&scene.light_elements);
        Ok(Some(Scene {
            waves: List::new(),
            light_elements: light.into(),
            ..scene.clone()
        }))
    }

    /// Finds all surfaces along the rays of a valid scene: meshes, then what lies before them of all others.
    pub(crate) fn see_all_surfaces(&mut self, scene: &Scene) -> Result<SeenSurfaces> {
        if scene.meshes.is_empty() {
            return self.see_other_surfaces(scene);
        }
        let Some(device) = self.mesh_device() else {
            return reference::see_meshes(scene, |behind| self.see_behind_meshes(behind));
        };
        let (depth, cost) = device.trace_meshes(scene)?;
        self.cost_before = self.cost_before.then(cost);
        let mut seen = self.see_behind_meshes(&scene.behind_meshes(&depth))?;
        if let Some(device) = self.mesh_device() {
            let (light, cost) = device.shade_meshes(scene, &seen.depth)?;
            self.cost_before = self.cost_before.then(cost);
            seen.brighten(&light);
        }
        Ok(seen)
    }

    /// Finds the other surfaces of a scene whose rays meshes have ended.
    fn see_behind_meshes(&mut self, scene: &Scene) -> Result<SeenSurfaces> {
        match (scene.has_surfaces(), &scene.depth) {
            (false, Some(depth)) => Ok(SeenSurfaces::dark(scene, depth.clone())),
            _ => self.see_other_surfaces(scene),
        }
    }

    /// Finds colliders along the rays of a valid scene, and metaballs before them.
    fn see_other_surfaces(&mut self, scene: &Scene) -> Result<SeenSurfaces> {
        let see = |renderer: &mut Self, scene: &Scene| {
            let (seen, cost) = renderer.see_surfaces(scene)?;
            renderer.cost_before = renderer.cost_before.then(cost);
            Ok(seen)
        };
        if !scene.colliders.iter().any(|collider| collider.visible) {
            return see(self, scene);
        }
        let traced = match self.stage.traced.take() {
            Some(traced) if traced.of == TracedScene::of(scene) => traced,
            _ => Traced::new(scene)?,
        };
        let depth = traced.depth.clone();
        let seen = match scene.metaballs.is_empty() {
            true => Ok(SeenSurfaces {
                depth,
                light: Arc::clone(&traced.light),
                lit: Some(traced.lit.clone()),
            }),
            false => {
                let behind = Scene {
                    depth: Some(depth),
                    ..scene.clone()
                };
                see(self, &behind).map(|mut seen| {
                    seen.brighten(&shade(scene, &seen.depth, &visible(scene)));
                    seen
                })
            }
        };
        self.stage.traced = Some(traced);
        seen
    }
}

impl TracedScene {
    fn of(scene: &Scene) -> Self {
        Self {
            camera: scene.camera.clone(),
            image: scene.image,
            across: scene.rays_across(),
            colliders: scene.colliders.clone(),
            depth: scene.depth.clone(),
        }
    }
}

impl Traced {
    fn new(scene: &Scene) -> Result<Self> {
        let of = TracedScene::of(scene);
        let colliders = visible(scene);
        let (grid, plane) = scene.ray_grid(of.across);
        let window = window(scene, &plane, grid);
        let mut lengths = vec![0.0_f32; grid.pixels()];
        let width = grid.width as usize;
        threads::for_each_chunk(&mut lengths, width, |row, lengths| {
            let may_hit = window[1].contains(&row);
            for (column, length) in lengths.iter_mut().enumerate() {
                let may_hit = may_hit && window[0].contains(&column);
                if !may_hit && scene.depth.is_none() {
                    *length = f32::INFINITY;
                    continue;
                }
                let (from, direction, to_plane) = ray(&plane, column, row);
                let given = given(scene, &plane, grid, (column, row), to_plane);
                let hit = match may_hit {
                    true => nearest(&colliders, from, direction).map_or(given, |(hit, ..)| hit),
                    false => given,
                };
                *length = hit.min(given) as f32;
            }
        });
        let depth = DepthImage::new(grid, DepthAlong::Ray, lengths)?;
        let light = shade(scene, &depth, &colliders).into();
        let across = grid.width as usize / scene.image.width.max(1) as usize;
        let lit = window.map(|rays| rays.start / across..rays.end.div_ceil(across));
        Ok(Self {
            of,
            depth,
            light,
            lit,
        })
    }
}

/// Returns a scene whose colliders that are seen meshes are meshes; `None`: there are none.
fn with_meshes(scene: &Scene) -> Option<Scene> {
    let (meshes, others): (Vec<&Collider>, Vec<&Collider>) =
        scene.colliders.iter().partition(|it| it.is_seen_mesh());
    let seen = meshes.into_iter().filter_map(Collider::seen_mesh);
    let meshes: List<_> = scene.meshes.iter().cloned().chain(seen).collect();
    (meshes.len() > scene.meshes.len()).then(|| Scene {
        meshes,
        colliders: others.into_iter().cloned().collect(),
        ..scene.clone()
    })
}

fn visible(scene: &Scene) -> Vec<Seen> {
    let visible = scene.colliders.iter().filter(|collider| collider.visible);
    let seen = visible.map(|collider| Seen {
        solid: Solid::new(collider),
        color: collider.color,
    });
    seen.collect()
}

/// Returns the columns and rows of a grid of rays in which colliders may be seen.
fn window(scene: &Scene, plane: &ViewPlane, grid: ImageSize) -> [Range<usize>; 2] {
    let all = [0..grid.width as usize, 0..grid.height as usize];
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for collider in scene.colliders.iter().filter(|collider| collider.visible) {
        let (center, half) = match collider.shape {
            // Turned, a box lies within the ball around it.
            ColliderShape::Box {
                center,
                half,
                rotation,
            } => match rotation {
                None => (center, half),
                Some(_) => (center, DVec3::splat(half.length())),
            },
            ColliderShape::Sphere { center, radius } => (center, DVec3::splat(radius)),
            ColliderShape::Plane { .. } | ColliderShape::Mesh(_) => return all,
        };
        for corner in 0..8_u32 {
            let side = |axis: u32| f64::from(corner >> axis & 1) * 2.0 - 1.0;
            let way = center + half * DVec3::new(side(0), side(1), side(2)) - plane.eye;
            let z = way.dot(plane.forward);
            if z <= 1e-3 * half.length() {
                return all;
            }
            let scale = if plane.is_parallel {
                1.0
            } else {
                plane.near / z
            };
            let on_plane = scale * (way - z * plane.forward)
                - (plane.first_pixel - plane.first_pixel.dot(plane.forward) * plane.forward);
            for (axis, step) in [plane.column_step, plane.row_step].into_iter().enumerate() {
                let place = on_plane.dot(step) / step.length_squared();
                (low[axis], high[axis]) = (low[axis].min(place), high[axis].max(place));
            }
        }
    }
    let mut axis = 0;
    all.map(|all| {
        let last = all.end as f64;
        let begin = (low[axis] - 1.0).clamp(0.0, last) as usize;
        let end = (high[axis] + 2.0).clamp(0.0, last) as usize;
        axis += 1;
        begin..end
    })
}

/// Returns where lengths along a ray begin, its direction, and how far along it the plane is.
fn ray(plane: &ViewPlane, column: usize, row: usize) -> (DVec3, DVec3, f64) {
    let ray = plane.ray(column as u32, row as u32);
    let direction = ray.span.normalize();
    let to_plane = plane.before_plane(ray.origin - plane.eye);
    (ray.origin - to_plane * direction, direction, to_plane)
}

/// Returns the length at which the scene's own depths end a ray.
fn given(
    scene: &Scene,
    plane: &ViewPlane,
    grid: ImageSize,
    (column, row): (usize, usize),
    to_plane: f64,
) -> f64 {
    let Some(depth) = &scene.depth else {
        return f64::INFINITY;
    };
    let size = depth.size();
    let step = (grid.width / size.width.max(1)).max(1) as usize;
    let value = depth.as_slice()[row / step * size.width as usize + column / step];
    plane.distance(value, depth.along(), to_plane)
}

/// Returns how far the nearest collider is, its normal and its colour.
fn nearest(colliders: &[Seen], from: DVec3, direction: DVec3) -> Option<(f64, DVec3, DVec3)> {
    let hits = colliders.iter().filter_map(|seen| {
        let entry = seen.solid.entry(from, direction, FAR)?;
        Some((entry.share, entry.normal, seen.color))
    });
    hits.min_by(|one, other| one.0.total_cmp(&other.0))
}

/// Returns the mean light of colliders in each pixel, RGBA by rows, of rays that come so far: ambient, and by Lambert's
/// law that of the lamp that lights metaballs.
fn shade(scene: &Scene, depth: &DepthImage, colliders: &[Seen]) -> Vec<f32> {
    let across = depth.size().width / scene.image.width;
    let (grid, plane) = scene.ray_grid(across);
    let [columns, rows] = window(scene, &plane, grid);
    let lamp = LAMP.x * plane.column_step.normalize()
        + LAMP.y * plane.row_step.normalize()
        + LAMP.z * plane.forward;
    let lamp = lamp.normalize();
    let lengths = Arc::clone(depth.shared_values());
    let (across, grid_width) = (across as usize, depth.size().width as usize);
    let share = 1.0 / (across * across) as f64;
    let width = scene.image.width as usize;
    let mut light = vec![0.0_f32; 4 * scene.image.pixels()];
    threads::for_each_chunk(&mut light, 4 * width, |row, light| {
        for (column, pixel) in light.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let mut sum = DVec3::ZERO;
            for part in 0..across * across {
                let place = (
                    across * column + part % across,
                    across * row + part / across,
                );
                if !(columns.contains(&place.0) && rows.contains(&place.1)) {
                    continue;
                }
                let (from, direction, _) = ray(&plane, place.0, place.1);
                let seen = f64::from(lengths[place.1 * grid_width + place.0]);
                match nearest(colliders, from, direction) {
                    Some((hit, normal, color)) if hit <= seen * (1.0 + ROUNDING) => {
                        let facing = normal.dot(lamp).max(0.0);
                        sum += color * (AMBIENT + (1.0 - AMBIENT) * facing);
                    }
                    _ => {}
                }
            }
            let mean = (share * sum).as_vec3();
            *pixel = [mean.x, mean.y, mean.z, 1.0];
        }
    });
    light
}
