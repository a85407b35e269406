//! Nothing is written behind an image, whatever its size and the lane width.
#![allow(clippy::unwrap_used)]

mod common;

use common::{full_scene, lane_widths};
use energywave::opencl::{Argument, DeviceBuffer, Program};
use energywave::pack::{self, Rule, Sources, layout};
use energywave::ray::ViewPlane;
use energywave::scene::Integration;
use half::f16;

/// Renders straight into a buffer with 64 marked pixels behind the image, or with `-D HALVES` into one of half floats; how
/// many marks are left. `kernel` is `render` or `tiles`.
fn marks_left(
    kernel: &str,
    lanes: u32,
    method: &str,
    extra: &str,
    (width, height): (u32, u32),
) -> usize {
    const MARKS: usize = 64;
    const MARK: [f32; 4] = [-1.0, -2.0, -3.0, -4.0];
    let scene = full_scene(width, height);
    let compute = common::compute();
    // What is stored does not depend on the kinds of source.
    let options = common::options(lanes, &format!("{method} {extra}"));
    let file = match kernel {
        "tiles" => "wave/tiles/tiles.cl",
        _ => "wave/render.cl",
    };
    let spheres = [true, false, false, false, false];
    let program = Program::build(&compute, &[file], spheres, &options).unwrap();
    let plane = ViewPlane::new(&scene.camera, scene.image);
    let packed = Sources::new(&scene, plane.eye, plane.ray_length, plane.ray_length);
    let nodes = pack::nodes(20, scene.decay);
    let part = layout::FilmPart {
        count: width * height,
        width,
        is_last: 1,
        ..bytemuck::Zeroable::zeroed()
    };
    let rule = Rule::of(&scene.integration, false);
    let integrand = pack::integrand(&scene, &rule, nodes.len() as u32);
    let launch = layout::Launch {
        begin: [0; layout::KIND_COUNT],
        end: [packed.spheres.len() as u32, 0, 0, 0, 0],
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
    let halves = upload(&compute, &vec![MARK.map(to_half); pixels + MARKS]);
    let has_halves = extra.contains("HALVES");
    let view = pack::view(&plane, &scene);
    // A single pass that lets nothing be interpolated.
    let pass = layout::TilePass {
        size: 8,
        inner: 2,
        is_last: 1,
        columns: width.div_ceil(8),
        tile_count: width.div_ceil(8) * height.div_ceil(8),
        word_count: 4,
        pixel_step: 1e-3,
        ..bytemuck::Zeroable::zeroed()
    };
    let lists: [&dyn Argument; 5] = [
        &upload(&compute, &nodes),
        &upload(&compute, &packed.spheres),
        &upload(&compute, &packed.spline_pieces),
        &upload(&compute, &[0_u32; 16]),
        &upload(&compute, &vec![5.0_f32; pixels]),
    ];
    let (places, light) = (
        upload(&compute, &[0_u32; 6]),
        upload(&compute, &[0.0_f32; 48]),
    );
    let mut arguments: Vec<&dyn Argument> = vec![&view, &part, &integrand, &launch];
    arguments.extend(lists);
    arguments.push(&output);
    if has_halves {
        arguments.push(&halves);
    }
    // More work-items than there is work, as padded work-groups have.
    let items = match kernel {
        "tiles" => {
            arguments.extend([&pass as &dyn Argument, &places, &light]);
            pass.tile_count as usize + 3
        }
        _ => pixels.div_ceil(lanes as usize) + 3,
    };
    program.run(&compute, kernel, &arguments, items, 1).unwrap();
    let mut read = vec![[0.0_f32; 4]; pixels + MARKS];
    if has_halves {
        let mut bits = vec![[0_u16; 4]; pixels + MARKS];
        halves.read(&compute, &mut bits).unwrap();
        read = bits
            .iter()
            .map(|p| p.map(|b| f16::from_bits(b).into()))
            .collect();
    } else {
        output.read(&compute, &mut read).unwrap();
    }
    assert!(
        read[..pixels].iter().all(|pixel| pixel[3] == 1.0),
        "a pixel is missing"
    );
    read[pixels..]
        .iter()
        .filter(|pixel| **pixel == MARK)
        .count()
}

fn to_half(value: f32) -> u16 {
    f16::from_f32(value).to_bits()
}

#[test]
fn nothing_is_written_behind_the_image() {
    let exact = Rule::of(&Integration::default(), false).definitions();
    let tiles = format!("{exact} -D PER_RAY= -D MOST_WORDS=4 -D TILE_WORKERS=1");
    for lanes in lane_widths() {
        for (kernel, method) in [("render", ""), ("render", &exact), ("tiles", &tiles)] {
            for size in [(1, 1), (13, 7), (16, 4), (31, 1)] {
                for film in ["", "-D HALVES"] {
                    let left = marks_left(kernel, lanes, method, film, size);
                    assert_eq!(left, 64, "{kernel}, {lanes} lanes, {size:?} {film}");
                }
            }
        }
    }
}

#[test]
fn a_store_of_all_lanes_is_noticed_behind_the_image() {
    let all_lanes = "-DLAST_LANES(left)=8u";
    for film in ["", "-D HALVES"] {
        let extra = format!("{all_lanes} {film}");
        assert_eq!(marks_left("render", 8, "", &extra, (13, 7)), 64 - 5);
    }
}
