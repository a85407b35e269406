//! The structs of `cl/mesh/types.h`, in the same order.

use glam::DVec3;

use crate::opencl::{DeviceStruct, StructLayout, by_value, device_struct};

device_struct! {
    /// A box of the tree, and what is in it.
    TreeNode [32] {
        low_x: f32 = 0,
        low_y: f32 = 4,
        low_z: f32 = 8,
        first: u32 = 12,
        high_x: f32 = 16,
        high_y: f32 = 20,
        high_z: f32 = 24,
        count: u32 = 28,
    }
}

device_struct! {
    /// A triangle, in the order of the tree.
    MeshTriangle [48] {
        a_x: f32 = 0,
        a_y: f32 = 4,
        a_z: f32 = 8,
        mesh: u32 = 12,
        b_x: f32 = 16,
        b_y: f32 = 20,
        b_z: f32 = 24,
        normal: u32 = 28,
        c_x: f32 = 32,
        c_y: f32 = 36,
        c_z: f32 = 40,
        padding: u32 = 44,
    }
}

device_struct! {
    /// The grid of rays, which may be finer than the pixels.
    MeshSight [192] {
        eye: [f32; 4] = 0,
        eye_rest: [f32; 4] = 16,
        right: [f32; 4] = 32,
        down: [f32; 4] = 48,
        forward: [f32; 4] = 64,
        to_right: [f32; 4] = 80,
        to_down: [f32; 4] = 96,
        to_forward: [f32; 4] = 112,
        first_x: f32 = 128,
        first_y: f32 = 132,
        step_x: f32 = 136,
        step_y: f32 = 140,
        width: u32 = 144,
        height: u32 = 148,
        across: u32 = 152,
        is_parallel: u32 = 156,
        has_depth: u32 = 160,
        is_along_axis: u32 = 164,
        depth_step: u32 = 168,
        axis_length: f32 = 172,
        margin: f32 = 176,
        padding0: u32 = 180,
        padding1: u32 = 184,
        padding2: u32 = 188,
    }
}

device_struct! {
    /// The light on meshes.
    MeshLight [48] {
        lamp: [f32; 4] = 0,
        ambient: [f32; 4] = 16,
        sun: [f32; 4] = 32,
    }
}

by_value!(MeshSight, MeshLight);

/// Every struct of meshes that crosses to the device.
pub const STRUCTS: &[StructLayout] = &[
    TreeNode::LAYOUT,
    MeshTriangle::LAYOUT,
    MeshSight::LAYOUT,
    MeshLight::LAYOUT,
];

/// Returns the sizes of the structs of the tree, for programs of other engines that look into it.
pub(crate) fn definitions() -> String {
    let sizes = STRUCTS.iter();
    let sizes = sizes.map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size));
    sizes.collect()
}

/// Returns a vector of length 1 in 32 bits (octahedral: Meyer et al. 2010), within 1e-4.
pub(super) fn packed_normal(normal: DVec3) -> u32 {
    let flat = normal / normal.abs().element_sum();
    let fold = (-flat.z).max(0.0);
    // What points back is folded over the edges of the square.
    let folded = [flat.x, flat.y].map(|it| it + fold.copysign(it));
    let [x, y] = folded.map(|it| ((0.5 + 0.5 * it) * 65535.0).round().clamp(0.0, 65535.0) as u32);
    x | y << 16
}

pub(super) fn vector(v: DVec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}
