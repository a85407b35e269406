//! The structs of `cl/types.h`, in the same order. Sizes and offsets are asserted here at compile time, sizes again in
//! `types.h` at every program build, and every field by name in `tests/layout.rs`.
#![allow(missing_docs)] // cl/types.h, which this mirrors, says what each field holds

use bytemuck::{Pod, Zeroable};

/// Name, size and fields of a struct that crosses to the device.
#[derive(Debug, Clone, Copy)]
pub struct StructLayout {
    /// Its name.
    pub name: &'static str,
    /// Its size, bytes.
    pub size: usize,
    /// Name, offset and size of every field, bytes.
    pub fields: &'static [(&'static str, usize, usize)],
}

macro_rules! device_structs {
    ($($(#[$meta:meta])* $name:ident [$size:literal] { $($field:ident: $type:ty = $offset:literal),* $(,)? })*) => {
        $(
            $(#[$meta])*
            #[repr(C, align(4))]
            #[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
            pub struct $name { $(pub $field: $type),* }
            const _: () = assert!(size_of::<$name>() == $size);
            $(const _: () = assert!(std::mem::offset_of!($name, $field) == $offset);)*
        )*
        /// Every struct, as `cl/types.h` has it.
        pub const STRUCTS: &[StructLayout] = &[$(StructLayout {
            name: stringify!($name),
            size: $size,
            fields: &[$((stringify!($field), $offset, size_of::<$type>())),*],
        }),*];
    };
}

device_structs! {
    /// The pixel grid on the projection plane.
    View [80] {
        first_pixel: [f32; 4] = 0,
        column_step: [f32; 4] = 16,
        row_step: [f32; 4] = 32,
        ray_length: f32 = 48,
        softening2: f32 = 52,
        decay_strength: f32 = 56,
        decay_beta: f32 = 60,
        threshold: f32 = 64,
        width: u32 = 68,
        padding_0: u32 = 72,
        padding_1: u32 = 76,
    }
    /// One launch.
    Launch [64] {
        first: u32 = 0,
        count: u32 = 4,
        slot: u32 = 8,
        accumulate: u32 = 12,
        node_count: u32 = 16,
        sphere_begin: u32 = 20,
        sphere_end: u32 = 24,
        cylinder_begin: u32 = 28,
        cylinder_end: u32 = 32,
        torus_begin: u32 = 36,
        torus_end: u32 = 40,
        curve_begin: u32 = 44,
        curve_end: u32 = 48,
        padding_0: u32 = 52,
        padding_1: u32 = 56,
        padding_2: u32 = 60,
    }
    /// A ray that is no pixel's.
    RayRecord [32] {
        origin: [f32; 4] = 0,
        span: [f32; 4] = 16,
    }
    /// A quadrature node.
    Node [8] {
        s: f32 = 0,
        weight: f32 = 4,
    }
    /// A point of light.
    Sphere [32] {
        center: [f32; 4] = 0,
        emission: [f32; 4] = 16,
    }
    /// A line of light.
    Cylinder [48] {
        point: [f32; 4] = 0,
        direction: [f32; 4] = 16,
        emission: [f32; 4] = 32,
    }
    /// A ring of light.
    Torus [64] {
        center: [f32; 4] = 0,
        axis: [f32; 4] = 16,
        emission: [f32; 4] = 32,
        major_radius: f32 = 48,
        padding_0: f32 = 52,
        padding_1: f32 = 56,
        padding_2: f32 = 60,
    }
    /// A quadratic curve of light.
    Curve [112] {
        middle: [f32; 4] = 0,
        along: [f32; 4] = 16,
        across: [f32; 4] = 32,
        normal: [f32; 4] = 48,
        emission: [f32; 4] = 64,
        velocity_along: f32 = 80,
        velocity_across: f32 = 84,
        bend: f32 = 88,
        vertex: f32 = 92,
        is_straight: u32 = 96,
        spline_begin: u32 = 100,
        spline_count: u32 = 104,
        padding: u32 = 108,
    }
    /// One piece of a quadratic B-spline.
    SplinePiece [16] {
        c0: f32 = 0,
        c1: f32 = 4,
        c2: f32 = 8,
        padding: f32 = 12,
    }
}
