//! The structs of `cl/metaball/types.h`, in the same order, and what packs a scene's surfaces into them.

use glam::DVec3;

use crate::opencl::{DeviceStruct, StructLayout, by_value, device_struct};
use crate::scene::{MetaballKernel, MetaballMethod, MetaballShading, Metaballs};

device_struct! {
    /// The grid of rays, which may be finer than the pixels.
    Sight [112] {
        right: [f32; 4] = 0,
        down: [f32; 4] = 16,
        forward: [f32; 4] = 32,
        first_x: f32 = 48,
        first_y: f32 = 52,
        step_x: f32 = 56,
        step_y: f32 = 60,
        width: u32 = 64,
        height: u32 = 68,
        across: u32 = 72,
        unit: u32 = 76,
        is_parallel: u32 = 80,
        is_along_axis: u32 = 84,
        has_depth: u32 = 88,
        depth_step: u32 = 92,
        span_columns: u32 = 96,
        square: u32 = 100,
        skew_x: f32 = 104,
        padding0: u32 = 108,

    }
}

device_struct! {
    /// A surface, and where its particles and cells are in the lists of all surfaces.
    Surface [112] {
        origin: [f32; 4] = 0,
        origin_rest: [f32; 4] = 16,
        color: [f32; 4] = 32,
        radius: f32 = 48,
        threshold: f32 = 52,
        first_z: f32 = 56,
        thickness: f32 = 60,
        slab_count: u32 = 64,
        reach: u32 = 68,
        first_slab: u32 = 72,
        first_point: u32 = 76,
        point_count: u32 = 80,
        is_smooth: u32 = 84,
        has_normals: u32 = 88,
        samples: u32 = 92,
        refinements: u32 = 96,
        interval: f32 = 100,
        first_square: u32 = 104,
        wider: f32 = 108,
    }
}

device_struct! {
    /// A slab of depths: a grid of cells.
    Slab [24] {
        first_cell: u32 = 0,
        columns: u32 = 4,
        rows: u32 = 8,
        inverse_width: f32 = 12,
        beside_x: f32 = 16,
        beside_y: f32 = 20,
    }
}

device_struct! {
    /// A particle as it is given.
    Point [32] {
        place: [f32; 4] = 0,
        rest: [f32; 4] = 16,
    }
}

device_struct! {
    /// A particle in its cell.
    Particle [32] {
        x: f32 = 0,
        y: f32 = 4,
        z: f32 = 8,
        radius: f32 = 12,
        inverse_radius: f32 = 16,
        weight: f32 = 20,
        growth: f32 = 24,
        padding: u32 = 28,
    }
}

by_value!(Sight);

/// Every struct of the metaballs that crosses to the device.
pub const STRUCTS: &[StructLayout] = &[
    Sight::LAYOUT,
    Surface::LAYOUT,
    Slab::LAYOUT,
    Point::LAYOUT,
    Particle::LAYOUT,
];

/// The cube's front half reaches so many radii from a ray through its corner.
const CORNER: f64 = std::f64::consts::SQRT_2;

/// Returns how far from a ray a particle matters to it, in radii.
pub(super) fn wider(metaballs: &Metaballs) -> f64 {
    match metaballs.method {
        MetaballMethod::Exact => 1.0,
        MetaballMethod::Sampling(_) => CORNER,
    }
}

/// Packs what a surface says of itself.
pub(super) fn surface(metaballs: &Metaballs) -> Surface {
    let sampling = match metaballs.method {
        MetaballMethod::Exact => None,
        MetaballMethod::Sampling(sampling) => Some(sampling),
    };
    let interval = sampling.and_then(|it| it.interval);
    Surface {
        color: vector(metaballs.color),
        radius: (wider(metaballs) * metaballs.greatest_radius()) as f32,
        threshold: metaballs.threshold as f32,
        is_smooth: u32::from(metaballs.kernel == MetaballKernel::Smooth),
        has_normals: u32::from(metaballs.shading == MetaballShading::Normals),
        samples: sampling.map_or(0, |it| it.samples),
        refinements: sampling.map_or(0, |it| it.refinements),
        interval: interval.unwrap_or(metaballs.radius / 8.0) as f32,
        wider: wider(metaballs) as f32,
        ..bytemuck::Zeroable::zeroed()
    }
}

/// Returns where the positions of a surface's particles are given from: the middle of the box around them.
pub(super) fn middle(metaballs: &Metaballs) -> DVec3 {
    let (low, high) = metaballs.points.bounds();
    0.5 * (low + high)
}

/// Adds the particles of a surface, seen from their middle.
pub(super) fn add_points(metaballs: &Metaballs, points: &mut Vec<Point>) {
    let (list, middle) = (&metaballs.points, middle(metaballs));
    let of = |position: &DVec3, radius: f64, weight: f64| {
        let (mut place, mut rest) = fine(position - middle);
        (place[3], rest[3]) = (radius as f32, weight as f32);
        Point { place, rest }
    };
    match list.sizes() {
        Some(sizes) => {
            let sized = list.positions().iter().zip(sizes);
            points.extend(sized.map(|(position, size)| of(position, size.radius, size.weight)));
        }
        None => {
            let positions = list.positions().iter();
            points.extend(positions.map(|position| of(position, metaballs.radius, 1.0)));
        }
    }
}

/// Returns a vector in float32, and what that leaves of it.
pub(super) fn fine(v: DVec3) -> ([f32; 4], [f32; 4]) {
    (vector(v), vector(v - v.as_vec3().as_dvec3()))
}

pub(super) fn vector(v: DVec3) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, 0.0]
}
