//! The structs of `cl/view.h` and `cl/wave/types.h`, in the same order. A kind's own stands in its own file.

use crate::opencl::{DeviceStruct, FilmPart, StructLayout, by_value, device_struct};
use crate::scene::kinds::{KIND_COUNT, for_each_kind};

device_struct! {
    /// The pixel grid on the projection plane, and the length of the rays that begin there.
    View [160] {
        first_pixel: [f32; 4] = 0,
        column_step: [f32; 4] = 16,
        row_step: [f32; 4] = 32,
        first_pixel_rest: [f32; 4] = 48,
        column_step_rest: [f32; 4] = 64,
        row_step_rest: [f32; 4] = 80,
        toward: [f32; 4] = 96,
        toward_rest: [f32; 4] = 112,
        ray_length: f32 = 128,
        near_plane: f32 = 132,
        near_plane_rest: f32 = 136,
        hides_all: f32 = 140,
        width: u32 = 144,
        height: u32 = 148,
        is_parallel: u32 = 152,
        padding: u32 = 156,
    }
}

device_struct! {
    /// What is integrated along the rays, and how.
    Integrand [36] {
        softening2: f32 = 0,
        decay_strength: f32 = 4,
        decay_beta: f32 = 8,
        decay_per_beta: f32 = 12,
        smooth_threshold: f32 = 16,
        kinked_threshold: f32 = 20,
        node_count: u32 = 24,
        absorption: f32 = 28,
        seed: u32 = 32,
    }
}

device_struct! {
    /// How a source's field falls off.
    Falloff [16] {
        profile: u32 = 0,
        radius2: f32 = 4,
        reach2: f32 = 8,
        reach2_rest: f32 = 12,
    }
}

device_struct! {
    /// Which sources of each kind a launch takes, where their balls are, and where it counts.
    Launch [12 * KIND_COUNT + 4] {
        begin: [u32; KIND_COUNT] = 0,
        end: [u32; KIND_COUNT] = 4 * KIND_COUNT,
        first_ball: [u32; KIND_COUNT] = 8 * KIND_COUNT,
        first_count: u32 = 12 * KIND_COUNT,
    }
}

device_struct! {
    /// One pass over tiles of one size.
    TilePass [68] {
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
        from: u32 = 40,
        to: u32 = 44,
        pixel_step: f32 = 48,
        most_odd: f32 = 52,
        most_even: f32 = 56,
        most_error: f32 = 60,
        least_light: f32 = 64,
    }
}

device_struct! {
    /// A ray that is no pixel's.
    RayRecord [64] {
        origin: [f32; 4] = 0,
        origin_rest: [f32; 4] = 16,
        span: [f32; 4] = 32,
        span_rest: [f32; 4] = 48,
    }
}

device_struct! {
    /// Cells of a grid, some of its layers.
    Cells [64] {
        first: [f32; 4] = 0,
        step: f32 = 16,
        floor2: f32 = 20,
        share: f32 = 24,
        parts: u32 = 28,
        columns: u32 = 32,
        rows: u32 = 36,
        count: u32 = 40,
        stride: u32 = 44,
        plane: u32 = 48,
        channels: u32 = 52,
        padding0: u32 = 56,
        padding1: u32 = 60,
    }
}

device_struct! {
    /// A quadrature node.
    Node [8] {
        s: f32 = 0,
        weight: f32 = 4,
    }
}

by_value!(View, Integrand, Launch, TilePass, Cells);

macro_rules! list_structs {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// Every struct that crosses to the device.
        pub const STRUCTS: &[StructLayout] = &[
            View::LAYOUT,
            FilmPart::LAYOUT,
            Integrand::LAYOUT,
            Falloff::LAYOUT,
            Launch::LAYOUT,
            TilePass::LAYOUT,
            RayRecord::LAYOUT,
            Cells::LAYOUT,
            Node::LAYOUT,
            $(super::$kind::$Type::LAYOUT,)*
        ];
    };
}
for_each_kind!(list_structs);
