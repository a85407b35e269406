//! A host's depths cost no memory and no copy to the host once they are there; what does not fit is refused before
//! anything is enqueued; whatever call fails, the next frame is right.
#![allow(unsafe_code)] // hosts call OpenCL

use crate::common;
use crate::common::host::Host;
use crate::common::layer::{Layer, with_layer};
use energywave::image::{ClipDepth, ClipRange, DepthAlong, DepthImage, ImageSize};
use energywave::{Error, HostDepth, HostDepthMemory, HostTarget, Renderer, Scene};
use glam::DMat4;
use opencl3::event::Event;
use opencl3::memory::{
    Buffer, CL_BGRA, CL_FLOAT, CL_HALF_FLOAT, CL_MEM_READ_ONLY, CL_MEM_READ_WRITE,
    CL_MEM_WRITE_ONLY, CL_R, CL_RGBA, CL_UNORM_INT8, ClMem,
};

const OUT_OF_RESOURCES: i32 = -5;

/// Calls by which depths come to a frame.
const CALLS: [&str; 4] = [
    "clEnqueueCopyImageToBuffer",
    "clSetKernelArg",
    "clEnqueueNDRangeKernel",
    "clGetEventInfo",
];

fn scene() -> Scene {
    let mut scene = common::empty_scene(40, 30);
    scene.integration.method = common::by(energywave::scene::Sampling::Pixels);
    scene.spheres.push(common::sphere([0.0, 0.3, 0.5], 1.5));
    scene
}

/// A slope that begins so far away.
fn values(size: ImageSize, begin: f32) -> Vec<f32> {
    let value = |pixel: usize| begin + 0.02 * (pixel % 40) as f32;
    (0..size.pixels()).map(value).collect()
}

fn behind(
    renderer: &mut Renderer,
    scene: &Scene,
    target: &Buffer<f32>,
    depth: &HostDepth,
) -> energywave::Result<Event> {
    // SAFETY: the tests keep target and depths until they have waited.
    unsafe { renderer.enqueue_behind(scene, target.into(), depth, &[]) }
}

fn expected(renderer: &mut Renderer, scene: &Scene, values: &[f32]) -> Vec<f32> {
    let mut scene = scene.clone();
    let depth = DepthImage::new(scene.image, DepthAlong::Ray, values.to_vec());
    scene.depth = Some(depth.unwrap());
    renderer.render(&scene).unwrap().as_slice().to_vec()
}

/// The slope as an image of RGBA.
fn image_of(host: &Host, size: ImageSize, begin: f32) -> opencl3::memory::Image {
    let values = values(size, begin);
    let pixels = values.iter().flat_map(|value| [*value, 9.0, 9.0, 9.0]);
    let bytes: Vec<u8> = pixels.flat_map(f32::to_le_bytes).collect();
    host.image_with(size, CL_RGBA, CL_FLOAT, &bytes)
}

#[test]
fn frames_after_the_first_allocate_nothing_and_read_nothing_back() {
    with_layer(|| {
        let layer = Layer::new();
        let host = Host::new(0);
        let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
        let scene = scene();
        let size = scene.image;
        let target = host.buffer(CL_MEM_READ_WRITE, size);
        let begins = [3.0, 3.2, 3.4];
        let pictures = begins.map(|begin| expected(&mut renderer, &scene, &values(size, begin)));
        assert!(pictures[0] != pictures[1]);
        let buffers = begins.map(|begin| host.floats(&values(size, begin)));
        let images = begins.map(|begin| image_of(&host, size, begin));
        for is_image in [false, true] {
            let depths = [0, 1, 2].map(|frame| match is_image {
                true => HostDepth::new(&images[frame], DepthAlong::Ray),
                false => HostDepth::new(&buffers[frame], DepthAlong::Ray),
            });
            let first = behind(&mut renderer, &scene, &target, &depths[2]).unwrap();
            first.wait().unwrap();
            let before = (
                layer.live().buffers,
                layer.calls("clCreate*"),
                layer.calls("clEnqueueRead*"),
                layer.calls("clEnqueueMap*"),
            );
            let drawn: Vec<_> = (0..9)
                .map(|frame| behind(&mut renderer, &scene, &target, &depths[frame % 2]).unwrap())
                .collect();
            let after = (
                layer.live().buffers,
                layer.calls("clCreate*"),
                layer.calls("clEnqueueRead*"),
                layer.calls("clEnqueueMap*"),
            );
            assert_eq!(before, after, "{is_image}");
            let last = host.read((&target).into(), size, &[&drawn[8]]);
            assert!(last == pictures[0], "{is_image}");
            let next = behind(&mut renderer, &scene, &target, &depths[1]).unwrap();
            let next = host.read((&target).into(), size, &[&next]);
            assert!(next == pictures[1], "{is_image}");
        }
        // A larger picture is what takes more memory: the count sees it.
        let before = layer.calls("clCreateBuffer");
        let mut larger = scene.clone();
        larger.image.height += 10;
        let target = host.buffer(CL_MEM_READ_WRITE, larger.image);
        let buffer = host.floats(&values(larger.image, 3.0));
        let before_frame = layer.calls("clCreateBuffer");
        assert!(before_frame > before);
        let depth = HostDepth::new(&buffer, DepthAlong::Ray);
        let event = behind(&mut renderer, &larger, &target, &depth).unwrap();
        event.wait().unwrap();
        assert!(layer.calls("clCreateBuffer") > before_frame);
    });
}

#[test]
fn a_call_that_fails_is_an_error_and_the_next_frame_is_right() {
    with_layer(|| {
        let layer = Layer::new();
        let host = Host::new(0);
        let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
        let scene = scene();
        let target = host.buffer(CL_MEM_READ_WRITE, scene.image);
        let pictures = [3.0, 3.4].map(|begin| {
            let values = values(scene.image, begin);
            expected(&mut renderer, &scene, &values)
        });
        let images = [3.0, 3.4].map(|begin| image_of(&host, scene.image, begin));
        let depths = images
            .each_ref()
            .map(|image| HostDepth::new(image, DepthAlong::Ray));
        for call in CALLS {
            for nth in 1.. {
                let event = behind(&mut renderer, &scene, &target, &depths[0]).unwrap();
                assert!(host.read((&target).into(), scene.image, &[&event]) == pictures[0]);
                layer.fail(call, nth, OUT_OF_RESOURCES);
                let outcome = behind(&mut renderer, &scene, &target, &depths[1]);
                if layer.disarm() == 0 {
                    assert!(nth > 1, "{call}: never");
                    break;
                }
                // What only asks how earlier frames went is no reason to draw nothing.
                match outcome {
                    Ok(event) => assert!(call.starts_with("clGet") && event.wait().is_ok()),
                    Err(error) => {
                        let words = error.to_string();
                        assert!(words.contains(call) && words.contains(", -5)"), "{words}");
                    }
                }
                let event = behind(&mut renderer, &scene, &target, &depths[1]).unwrap();
                let found = host.read((&target).into(), scene.image, &[&event]);
                assert!(found == pictures[1], "{call}, {nth}");
            }
        }
        assert_eq!(layer.finishes(host.queue.get()), 0);
    });
}

#[test]
fn what_does_not_fit_is_refused_before_anything_is_enqueued() {
    with_layer(|| {
        let layer = Layer::new();
        let (host, other) = (Host::new(0), Host::new(0));
        let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
        let scene = scene();
        let size = scene.image;
        let (mut wider, mut fewer) = (size, size);
        (wider.width, fewer.height) = (41, 29);
        let null = std::ptr::null_mut();
        let target = host.buffer(CL_MEM_READ_WRITE, size);
        let good = host.floats(&values(size, 3.0));
        let (short, foreign) = (
            host.floats(&values(fewer, 3.0)),
            other.floats(&values(size, 3.0)),
        );
        let write_only = host.buffer(CL_MEM_WRITE_ONLY, size);
        let image = |flags, size, order, kind| host.image_of(flags, size, order, kind);
        let read = CL_MEM_READ_ONLY;
        let images = [
            image(read, wider, CL_R, CL_FLOAT),
            image(read, size, CL_RGBA, CL_UNORM_INT8),
            image(read, size, CL_BGRA, CL_UNORM_INT8),
            image(CL_MEM_WRITE_ONLY, size, CL_RGBA, CL_HALF_FLOAT),
            other.image_of(read, size, CL_RGBA, CL_FLOAT),
        ];
        let within = |offset, row_pitch| HostDepthMemory::Buffer {
            buffer: good.get(),
            offset,
            row_pitch,
        };
        let formats =
            "depths are CL_R, CL_DEPTH or CL_RGBA of CL_FLOAT, CL_HALF_FLOAT or CL_UNORM_INT16";
        let refused: [(HostDepthMemory, String); 15] = [
            (HostDepthMemory::Image(null), "the host's depth image: null".into()),
            (
                HostDepthMemory::Buffer { buffer: null, offset: 0, row_pitch: 0 },
                "the host's depth buffer: null".into(),
            ),
            (
                (&short).into(),
                "depth buffer: 4640 bytes; 40x30 float32 values from byte 0 on in rows of 160 bytes need 4800".into(),
            ),
            (within(4, 0), "from byte 4 on in rows of 160 bytes need 4804".into()),
            (within(0, 164), "in rows of 164 bytes need 4916".into()),
            (within(0, 156), "a row pitch of 156 bytes; 40 float32 values need 160, 0 stands for that".into()),
            (within(2, 0), "an offset of 2 and a row pitch of 0 bytes; both are multiples of 4".into()),
            (within(0, usize::MAX - 3), "need more than there is".into()),
            ((&foreign).into(), "depth buffer: it belongs to another context".into()),
            ((&write_only).into(), "depth buffer: kernels may not read it (CL_MEM_WRITE_ONLY)".into()),
            ((&target).into(), "depth buffer: the frame is drawn into the same memory".into()),
            (
                HostDepthMemory::Image(good.get()),
                "depth image: it is another kind of memory object".into(),
            ),
            ((&images[0]).into(), "depth image: 41x30 pixels, the scene has 40x30".into()),
            (
                (&images[1]).into(),
                format!("depth image: channels of CL_RGBA and CL_UNORM_INT8; {formats}"),
            ),
            (
                (&images[2]).into(),
                format!("depth image: channels of CL_BGRA and CL_UNORM_INT8; {formats}"),
            ),
        ];
        let before = layer.calls("clEnqueue*");
        let mut refuse = |scene: &Scene, depth: &HostDepth, words: &str| {
            let error = behind(&mut renderer, scene, &target, depth)
                .map(drop)
                .unwrap_err();
            assert!(matches!(error, Error::Host { .. }), "{error:?}");
            assert!(
                error.to_string().contains(words),
                "{error}\nhas not: {words}"
            );
        };
        for (memory, words) in &refused {
            refuse(&scene, &HostDepth::new(*memory, DepthAlong::Ray), words);
        }
        for (image, words) in [
            (
                &images[3],
                "depth image: kernels may not read it (CL_MEM_WRITE_ONLY)",
            ),
            (&images[4], "depth image: it belongs to another context"),
        ] {
            refuse(&scene, &HostDepth::new(image, DepthAlong::Ray), words);
        }
        let mut with_depth = scene.clone();
        with_depth.depth = Some(DepthImage::new(size, DepthAlong::Ray, values(size, 3.0)).unwrap());
        let fine = HostDepth::new(&good, DepthAlong::Ray);
        refuse(
            &with_depth,
            &fine,
            "the host's depth: the scene has a depth of its own",
        );
        let ndc = HostDepth::new(&good, DepthAlong::Ndc);
        refuse(
            &scene,
            &ndc,
            "depth: depths of clip space are no lengths; HostDepth::from_clip",
        );
        let matrix = DMat4::from_diagonal((0.1, 0.1, -0.01, 1.0).into());
        let clip = ClipDepth::new(matrix, Some(ClipRange::ZeroToOne)).unwrap();
        let length = HostDepth::from_clip(&good, DepthAlong::Axis, &clip);
        refuse(
            &scene,
            &length,
            "depth: lengths have no projection; set `clip` to None",
        );
        for scale in [0.0, f64::NAN, f64::INFINITY] {
            let mut scaled = fine;
            scaled.scale = scale;
            let words = format!("depth: a scale of {scale}; it must be a number but 0");
            refuse(&scene, &scaled, &words);
        }
        assert_eq!(layer.calls("clEnqueue*"), before);

        let event = behind(&mut renderer, &scene, &target, &fine).unwrap();
        assert!(layer.calls("clEnqueue*") > before);
        let found = host.read(HostTarget::from(&target), size, &[&event]);
        assert!(found == expected(&mut renderer, &scene, &values(size, 3.0)));
        let mut own = Renderer::new(&common::device()).unwrap();
        let error = behind(&mut own, &scene, &target, &fine)
            .map(drop)
            .unwrap_err();
        assert!(error.to_string().contains("made without one"), "{error}");
    });
}
