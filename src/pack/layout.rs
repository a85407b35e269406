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
    View [144] {
        first_pixel: [f32; 4] = 0,
        column_step: [f32; 4] = 16,
        row_step: [f32; 4] = 32,
        first_pixel_rest: [f32; 4] = 48,
        column_step_rest: [f32; 4] = 64,
        row_step_rest: [f32; 4] = 80,
        ray_length: f32 = 96,
        softening2: f32 = 100,
        decay_strength: f32 = 104,
        decay_beta: f32 = 108,
        decay_per_beta: f32 = 112,
        torus_threshold: f32 = 116,
        curve_threshold: f32 = 120,
        width: u32 = 124,
        height: u32 = 128,
        near_plane: f32 = 132,
        near_plane_rest: f32 = 136,
        hides_all: f32 = 140,
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
        beam_begin: u32 = 52,
        beam_end: u32 = 56,
        is_last: u32 = 60,
    }
    /// One pass over tiles of one size.
    TilePass [56] {
        size: u32 = 0,
        inner: u32 = 4,
        parent_inner: u32 = 8,
        level: u32 = 12,
        is_last: u32 = 16,
        columns: u32 = 20,
        tile_count: u32 = 24,
        read_from: u32 = 28,
        write_to: u32 = 32,
        word_count: u32 = 36,
        pixel_step: f32 = 40,
        most_odd: f32 = 44,
        most_even: f32 = 48,
        most_error: f32 = 52,
    }
    /// A ray that is no pixel's.
    RayRecord [64] {
        origin: [f32; 4] = 0,
        origin_rest: [f32; 4] = 16,
        span: [f32; 4] = 32,
        span_rest: [f32; 4] = 48,
    }
    /// A quadrature node.
    Node [8] {
        s: f32 = 0,
        weight: f32 = 4,
    }
    /// A point of light.
    Sphere [64] {
        center: [f32; 4] = 0,
        center_rest: [f32; 4] = 16,
        emission: [f32; 4] = 32,
        is_square: u32 = 48,
        padding_0: u32 = 52,
        padding_1: u32 = 56,
        padding_2: u32 = 60,
    }
    /// A line of light.
    Cylinder [96] {
        point: [f32; 4] = 0,
        point_rest: [f32; 4] = 16,
        direction: [f32; 4] = 32,
        direction_rest: [f32; 4] = 48,
        emission: [f32; 4] = 64,
        is_square: u32 = 80,
        padding_0: u32 = 84,
        padding_1: u32 = 88,
        padding_2: u32 = 92,
    }
    /// A half-line of light.
    Beam [144] {
        tip: [f32; 4] = 0,
        tip_rest: [f32; 4] = 16,
        point: [f32; 4] = 32,
        point_rest: [f32; 4] = 48,
        direction: [f32; 4] = 64,
        direction_rest: [f32; 4] = 80,
        emission: [f32; 4] = 96,
        line: f32 = 112,
        cap: f32 = 116,
        sphere: f32 = 120,
        per_taper: f32 = 124,
        per_taper_rest: f32 = 128,
        is_square: u32 = 132,
        padding_0: u32 = 136,
        padding_1: u32 = 140,
    }
    /// A ring of light.
    Torus [96] {
        center: [f32; 4] = 0,
        center_rest: [f32; 4] = 16,
        axis: [f32; 4] = 32,
        axis_rest: [f32; 4] = 48,
        emission: [f32; 4] = 64,
        major_radius: f32 = 80,
        major_radius_rest: f32 = 84,
        is_square: u32 = 88,
        padding: u32 = 92,
    }
    /// A quadratic curve of light.
    Curve [192] {
        middle: [f32; 4] = 0,
        middle_rest: [f32; 4] = 16,
        velocity: [f32; 4] = 32,
        velocity_rest: [f32; 4] = 48,
        second: [f32; 4] = 64,
        second_rest: [f32; 4] = 80,
        along: [f32; 4] = 96,
        across: [f32; 4] = 112,
        normal: [f32; 4] = 128,
        emission: [f32; 4] = 144,
        velocity_along: f32 = 160,
        velocity_across: f32 = 164,
        bend: f32 = 168,
        vertex: f32 = 172,
        is_straight: u32 = 176,
        spline_begin: u32 = 180,
        spline_count: u32 = 184,
        is_square: u32 = 188,
    }
    /// One piece of a quadratic B-spline.
    SplinePiece [16] {
        c0: f32 = 0,
        c1: f32 = 4,
        c2: f32 = 8,
        padding: f32 = 12,
    }
}
