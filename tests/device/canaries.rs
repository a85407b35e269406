//! Nothing is written behind an image, whatever its size and the lane width.

use crate::common;
use crate::common::{full_scene, lane_widths};
use energywave::internals::pack::{self, Anchor, Sources, layout};
use energywave::internals::{
    self, Argument, Compute, DeviceBuffer, FilmPart, KINDS, Rule, TILE_SHARES,
};
use half::f16;

/// Renders straight into a buffer with 64 marked pixels behind the image, or with `-D HALVES` into one of half floats;
/// how many marks are left. `kernel` is `render` or `tiles`.
#[allow(unsafe_code)]
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
        "tiles" => "#include \"wave/tiles/tiles.cl\"\n",
        _ => "#include \"wave/render.cl\"\n",
    };
    let program = internals::build_text(&compute, kernel, file, &["sphere"], &options).unwrap();
    let plane = scene.view_plane();
    let anchor = Anchor::new(&scene, plane.eye, plane.ray_length, plane.ray_length);
    let packed = Sources::new(&scene, &anchor);
    let node = |k| layout::Node {
        s: k as f32 / 20.0,
        weight: 0.05,
    };
    let nodes: Vec<_> = (0..=20).map(node).collect();
    let part = FilmPart {
        count: width * height,
        width,
        is_last: 1,
        ..bytemuck::Zeroable::zeroed()
    };
    let rule = Rule::of(1e-3, false, false);
    let integrand = pack::integrand(&scene, &rule, nodes.len() as u32);
    let launch = layout::Launch {
        begin: [0; KINDS.len()],
        end: packed.counts().map(|count| count as u32),
        first_ball: [0; KINDS.len()],
        first_count: 0,
    };
    fn upload<T: bytemuck::Pod>(compute: &Compute, values: &[T]) -> DeviceBuffer<T> {
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
        to: TILE_SHARES,
        pixel_step: 1e-3,
        ..bytemuck::Zeroable::zeroed()
    };
    let (nodes, spheres) = (upload(&compute, &nodes), upload(&compute, &packed.spheres));
    let (pieces, counts) = (
        upload(&compute, &packed.rows.list),
        upload(&compute, &[0_u32; 16]),
    );
    let depths = upload(&compute, &vec![5.0_f32; pixels]);
    let (places, light) = (
        upload(&compute, &[0_u32; 6]),
        upload(&compute, &[0.0_f32; 48]),
    );
    let mut arguments: Vec<(&str, &dyn Argument)> = vec![
        ("view", &view),
        ("part", &part),
        ("integrand", &integrand),
        ("launch", &launch),
        ("nodes", &nodes),
        ("sphere_list", &spheres),
        ("rows", &pieces),
        ("counts", &counts),
        ("depths", &depths),
        ("pixels", &output),
    ];
    if has_halves {
        arguments.push(("image", &halves));
    }
    // More work-items than there is work, as padded work-groups have.
    let items = match kernel {
        "tiles" => {
            arguments.extend([
                ("pass", &pass as &dyn Argument),
                ("open_tiles", &places),
                ("open_light", &light),
            ]);
            pass.tile_count as usize + 3
        }
        _ => pixels.div_ceil(lanes as usize) + 3,
    };
    // SAFETY: behind the image there is memory for what kernels may write by mistake.
    unsafe { internals::run(&compute, &program, kernel, &arguments, items, 1) }.unwrap();
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
    let exact = Rule::of(1e-3, false, false).definitions();
    let tiles = format!(
        "{exact} -D PER_RAY=CALL -D MOST_WORDS=4 -D TILE_WORKERS=1 -D TILE_SHARES={TILE_SHARES}u"
    );
    for lanes in lane_widths() {
        for (kernel, method) in [("render", ""), ("tiles", &tiles)] {
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
