//! Single rays against a closed mesh: each goes from a place within through an edge, or a corner, to one outside, and
//! something must hide the one from the other.

use energywave::internals::{self, Argument, DeviceBuffer, Tree, UploadedTree};
use fastrand::Rng;
use glam::{DVec3, Vec3};

use crate::common;
use crate::common::meshes::ball;

const TEXT: &str = r#"
#include "mesh/trace.h"
__kernel void count_lost(TREE_PARAMETERS, __global const float4 *from, __global const float4 *to, const uint count,
                         __global uint *lost) {
    const uint item = get_global_id(0);
    uint sum = 0u;
    for (uint ray = item * 256u; ray < min(count, (item + 1u) * 256u); ++ray)
        sum += is_hidden(TREE_ARGUMENTS, from[ray].xyz, to[ray].xyz) ? 0u : 1u;
    lost[item] = sum;
}
"#;

/// Returns how many of such rays meet nothing.
#[allow(unsafe_code)]
fn lost(rays: &[(Vec3, Vec3)], tree: &Tree, more: &str) -> u32 {
    let compute = common::compute();
    let options = common::options(1, more);
    let program = internals::build_mesh_text(&compute, "count_lost.cl", TEXT, &options).unwrap();
    let upload = |get: fn(&(Vec3, Vec3)) -> Vec3| {
        let values: Vec<[f32; 4]> = rays.iter().map(|ray| get(ray).extend(0.0).into()).collect();
        let mut buffer = DeviceBuffer::new(&compute, "places", values.len()).unwrap();
        buffer.write(&compute, &values).unwrap();
        buffer
    };
    let (from, to) = (upload(|ray| ray.0), upload(|ray| ray.1));
    let items = rays.len().div_ceil(256);
    let mut found = DeviceBuffer::<u32>::new(&compute, "counts", items).unwrap();
    found.write(&compute, &vec![u32::MAX; items]).unwrap();
    let mut there = UploadedTree::new();
    there.upload(&compute, tree).unwrap();
    let count = rays.len() as u32;
    let own: [(&str, &dyn Argument); 4] = [
        ("from", &from),
        ("to", &to),
        ("count", &count),
        ("lost", &found),
    ];
    let arguments = [&there.arguments()[..], &own[..]].concat();
    // SAFETY: each work-item takes 256 rays, of which there are `count`, and counts them in a place of its own.
    unsafe { internals::run(&compute, &program, "count_lost", &arguments, items, 1) }.unwrap();
    let mut counts = vec![0; items];
    found.read(&compute, &mut counts).unwrap();
    counts.iter().sum()
}

fn anywhere(random: &mut Rng) -> DVec3 {
    DVec3::from([0; 3].map(|_| 2.0 * random.f64() - 1.0))
}

#[test]
fn no_ray_slips_through_an_edge_or_a_corner() {
    let mut random = Rng::with_seed(51);
    let mut mesh = ball(40);
    mesh.scale = 3.0;
    mesh.translate = DVec3::new(7.0, -2.0, 1.0);
    let tree = Tree::new(std::slice::from_ref(&mesh)).unwrap();
    let rays = (0..1_000_000).map(|number| {
        let triangle = &tree.triangles[random.usize(0..tree.triangles.len())];
        let a = Vec3::new(triangle.a_x, triangle.a_y, triangle.a_z);
        let b = Vec3::new(triangle.b_x, triangle.b_y, triangle.b_z);
        let on = match number % 4 {
            0 => a,
            1 => 0.5 * (a + b),
            _ => a.lerp(b, random.f32()),
        };
        // Some from the middle, along the axes and the planes between them.
        let from = match number % 3 {
            0 => Vec3::ZERO,
            _ => 0.9 * anywhere(&mut random).as_vec3(),
        };
        (from, from + (1.5 + random.f32()) * (on - from))
    });
    let rays: Vec<(Vec3, Vec3)> = rays.collect();
    assert_eq!(lost(&rays, &tree, ""), 0);
    let open = lost(&rays, &tree, "-DOPEN_EDGES");
    assert!(open > 1000, "edges that belong to no triangle lose {open}");
    let fused = lost(&rays, &tree, "-DFUSED_EDGES");
    assert!(fused > 0, "fused edges lose none");
}
