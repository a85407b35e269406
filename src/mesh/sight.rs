//! The grid of rays as the kernels of meshes need it.

use glam::{DMat3, DVec3};

use super::pack::{MeshLight, MeshSight, vector};
use super::tree::Tree;
use crate::image::DepthAlong;
use crate::scene::{AMBIENT, LAMP, Scene, Sun, ViewPlane};

/// Boxes are so much wider, of the distance of what is farthest from the eye: rounding a place and turning it to the
/// axes of the picture moves it by less.
const WIDER: f64 = 1e-6;

/// Returns the grid of so many rays across a pixel, before a tree.
pub(super) fn sight(scene: &Scene, tree: &Tree, across: u32) -> MeshSight {
    let (grid, plane) = scene.ray_grid(across);
    let axes = axes(&plane);
    let inverse = axes.inverse().transpose();
    // Also where rows and columns lean, as those of matrices may.
    let first = axes.inverse() * plane.first_pixel;
    let scale = if plane.is_parallel {
        1.0
    } else {
        1.0 / first.z
    };
    let eye = plane.eye - tree.origin;
    let farthest = (eye - tree.low).abs().max((eye - tree.high).abs());
    let depth = scene.depth.as_ref();
    let is_along_axis = depth.is_some_and(|it| it.along() != DepthAlong::Ray);
    MeshSight {
        eye: vector(eye),
        eye_rest: vector(eye - eye.as_vec3().as_dvec3()),
        right: vector(axes.x_axis),
        down: vector(axes.y_axis),
        forward: vector(axes.z_axis),
        to_right: vector(inverse.x_axis),
        to_down: vector(inverse.y_axis),
        to_forward: vector(inverse.z_axis),
        first_x: (scale * first.x) as f32,
        first_y: (scale * first.y) as f32,
        step_x: (scale * plane.column_step.length()) as f32,
        step_y: (scale * plane.row_step.length()) as f32,
        width: grid.width,
        height: grid.height,
        across,
        is_parallel: u32::from(plane.is_parallel),
        has_depth: u32::from(depth.is_some()),
        is_along_axis: u32::from(is_along_axis && !plane.is_parallel),
        depth_step: depth.map_or(1, |depth| grid.width / depth.size().width.max(1)),
        axis_length: (first.z / plane.near) as f32,
        margin: (WIDER * farthest.length()) as f32,
        ..bytemuck::Zeroable::zeroed()
    }
}

/// Returns the axes of the picture: along rows, along columns, along the view.
fn axes(plane: &ViewPlane) -> DMat3 {
    DMat3::from_cols(
        plane.column_step.normalize(),
        plane.row_step.normalize(),
        plane.forward,
    )
}

/// Returns the light on meshes, but for what waves cast: the scene's, else that on metaballs.
pub(super) fn light(scene: &Scene) -> MeshLight {
    if let Some(lighting) = &scene.lighting {
        let sun = lighting.sun.unwrap_or(Sun {
            direction: DVec3::Z,
            color: DVec3::ZERO,
        });
        return MeshLight {
            lamp: vector(sun.direction.normalize()),
            ambient: vector(lighting.ambient),
            sun: vector(sun.color),
        };
    }
    let lamp = axes(&scene.view_plane()) * LAMP;
    MeshLight {
        lamp: vector(lamp.normalize()),
        ambient: vector(DVec3::splat(AMBIENT)),
        sun: vector(DVec3::splat(1.0 - AMBIENT)),
    }
}
