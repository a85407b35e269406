//! Nothing is written behind an image, whatever its size and the lane width.
#![allow(clippy::unwrap_used)]

mod common;

use common::{ALL_KINDS, LANE_WIDTHS, full_scene};
use energywave::opencl::{DeviceBuffer, Program};
use energywave::pack::{self, Rule, Sources, layout};
use energywave::ray::ViewPlane;
use energywave::scene::Integration;

/// Renders straight into a buffer with 64 marked pixels behind the image; how many marks are left.
fn marks_left(lanes: u32, method: &str, extra: &str, width: u32, height: u32) -> usize {
    const MARKS: usize = 64;
    const MARK: [f32; 4] = [-1.0, -2.0, -3.0, -4.0];
    let scene = full_scene(width, height);
    let compute = common::compute();
    let options = common::options(lanes, &format!("{ALL_KINDS} {method} {extra}"));
    let program = Program::build(&compute, &["render.cl"], &options).unwrap();
    let plane = ViewPlane::new(&scene.camera, scene.image);
    let packed = Sources::new(&scene, plane.eye, plane.ray_length, plane.ray_length);
    let nodes = pack::nodes(20, scene.decay);
    let launch = layout::Launch {
        count: width * height,
        node_count: nodes.len() as u32,
        sphere_end: packed.spheres.len() as u32,
        torus_end: packed.tori.len() as u32,
        curve_end: packed.curves.len() as u32,
        ..bytemuck::Zeroable::zeroed()
    };
    fn upload<T: bytemuck::Pod>(
        compute: &energywave::opencl::Compute,
        values: &[T],
    ) -> DeviceBuffer<T> {
        let mut buffer = DeviceBuffer::new(compute, "list", values.len()).unwrap();
        buffer.write(compute, values).unwrap();
        buffer
    }
    let pixels = scene.image.pixels();
    let output = upload(&compute, &vec![MARK; pixels + MARKS]);
    let view = pack::view(&plane, &scene);
    program
        .run(
            &compute,
            "render",
            &[
                &view,
                &launch,
                &upload(&compute, &nodes),
                &upload(&compute, &packed.spheres),
                &upload(&compute, &packed.cylinders),
                &upload(&compute, &packed.tori),
                &upload(&compute, &packed.curves),
                &upload(&compute, &packed.spline_pieces),
                &output,
            ],
            // More work-items than pixels, as padded work-groups have.
            pixels.div_ceil(lanes as usize) + 3,
            1,
        )
        .unwrap();
    let mut read = vec![[0.0_f32; 4]; pixels + MARKS];
    output.read(&compute, &mut read).unwrap();
    assert!(
        read[..pixels].iter().all(|pixel| pixel[3] == 1.0),
        "a pixel is missing"
    );
    read[pixels..]
        .iter()
        .filter(|pixel| **pixel == MARK)
        .count()
}

#[test]
fn nothing_is_written_behind_the_image() {
    let exact = Rule::of(&Integration::default()).definitions();
    for lanes in LANE_WIDTHS {
        for method in ["", &exact] {
            for (width, height) in [(1, 1), (13, 7), (16, 4), (31, 1)] {
                assert_eq!(
                    marks_left(lanes, method, "", width, height),
                    64,
                    "{lanes} lanes, {width}x{height}"
                );
            }
        }
    }
}

#[test]
fn a_store_of_all_lanes_is_noticed_behind_the_image() {
    assert_eq!(marks_left(8, "", "-DLAST_LANES(left)=8u", 13, 7), 64 - 5);
}
