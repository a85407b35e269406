//! Rays, and what is integrated along them, as the kernels read them.

use std::f64::consts::LOG2_E;

use bytemuck::Zeroable;
use glam::DVec3;

use super::layout::{Integrand, RayRecord, View};
use super::{fine, rest};
use crate::image::{DepthAlong, DepthImage};
use crate::scene::{Decay, Method, Ray, Scene, ViewPlane};
use crate::wave::Rule;

/// The share by which a depth must fall short of the projection plane to hide all of a ray for certain, in float32.
const MARGIN: f64 = 1e-5;

/// So many times as long as a ray is the direction of parallel ones: along it, pixels grow by less than float32 sees.
const OF_RAY: f64 = (1 << 25) as f64;

/// Packs the view plane, and what the scene's depths are measured along.
pub fn view(plane: &ViewPlane, scene: &Scene) -> View {
    view_behind(plane, scene, scene.depth.as_ref().map(DepthImage::along))
}

/// Packs the view plane, and what depths are measured along, whosever they are.
pub(in crate::wave) fn view_behind(
    plane: &ViewPlane,
    scene: &Scene,
    along: Option<DepthAlong>,
) -> View {
    let [first_pixel, column_step, row_step] =
        [plane.first_pixel, plane.column_step, plane.row_step].map(fine);
    let toward = fine(plane.forward * (OF_RAY * plane.ray_length));
    let near_plane = match along {
        _ if plane.is_parallel => plane.near,
        Some(DepthAlong::Axis | DepthAlong::Ndc | DepthAlong::Buffer) => plane.near,
        Some(DepthAlong::Ray) | None => 0.0,
    };
    View {
        first_pixel: first_pixel.value,
        column_step: column_step.value,
        row_step: row_step.value,
        first_pixel_rest: first_pixel.rest,
        column_step_rest: column_step.rest,
        row_step_rest: row_step.rest,
        toward: toward.value,
        toward_rest: toward.rest,
        ray_length: plane.ray_length as f32,
        near_plane: near_plane as f32,
        near_plane_rest: rest(near_plane),
        hides_all: (plane.near - MARGIN * plane.near.abs()) as f32,
        width: scene.image.width,
        height: scene.image.height,
        is_parallel: u32::from(plane.is_parallel),
        ..Zeroable::zeroed()
    }
}

/// Packs what is integrated, by a rule or by this many nodes.
pub fn integrand(scene: &Scene, rule: &Rule, node_count: u32) -> Integrand {
    let softening = scene.integration.softening;
    // What is the same everywhere is in every emission.
    let decay = scene.decay.filter(|decay| decay.power > 0);
    let strength = |decay: Decay| match decay.power {
        2 => decay.alpha / decay.beta,
        power => decay.alpha * decay.beta.powi(1 - power as i32),
    };
    let kappa = scene.absorption.map_or(0.0, |absorption| absorption.kappa);
    Integrand {
        softening2: (softening * softening) as f32,
        decay_strength: decay.map_or(1.0, strength) as f32,
        decay_beta: decay.map_or(0.0, |decay| decay.beta) as f32,
        decay_per_beta: decay.map_or(0.0, |decay| 1.0 / decay.beta) as f32,
        smooth_threshold: rule.smooth_threshold,
        kinked_threshold: rule.kinked_threshold,
        node_count,
        absorption: (kappa * LOG2_E) as f32,
        seed: match scene.integration.method {
            Method::Jittered { seed, .. } => seed,
            _ => 0,
        },
    }
}

/// Packs a ray, its origin seen from `origin`.
pub fn ray(ray: &Ray, origin: DVec3) -> RayRecord {
    let (origin, span) = (fine(ray.origin - origin), fine(ray.span));
    RayRecord {
        origin: origin.value,
        origin_rest: origin.rest,
        span: span.value,
        span_rest: span.rest,
    }
}
