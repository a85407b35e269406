//! Whatever call to OpenCL fails, in any frame: an error says what and what to do, nothing panics, hangs or leaks, and
//! the same renderer draws the next frame right.

use crate::common;
use crate::common::layer::{Layer, with_layer};
use energywave::Ray;
use energywave::image::DepthAlong;
use energywave::scene::{Method, Sampling};
use energywave::{Device, Error, Renderer, Scene};
use glam::DVec3;

const OUT_OF_MEMORY: i32 = -4;
const OUT_OF_RESOURCES: i32 = -5;
const BUILD_FAILURE: i32 = -11;
const WAIT_LIST: i32 = -14;
const INVALID_QUEUE: i32 = -36;

/// How a frame reaches the host.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    Image,
    Rows,
    Mapped,
    Rays,
}

const WAYS: [Way; 4] = [Way::Image, Way::Rows, Way::Mapped, Way::Rays];

/// Of the first frames by each film: their buffers and kernels are those of all.
const FIRST_WAYS: [Way; 3] = [Way::Image, Way::Rays, Way::Mapped];

fn draw(renderer: &mut Renderer, scene: &Scene, way: Way) -> energywave::Result<Vec<f32>> {
    match way {
        Way::Image => Ok(renderer.render(scene)?.as_slice().to_vec()),
        Way::Rows => {
            let (row, rows) = (4 * scene.image.width as usize, scene.image.height as usize);
            let mut target = vec![0.0; rows * (row + 4)];
            renderer.render_rows(scene, 0..rows as u32, &mut target, row + 4)?;
            let rows = target.chunks(row + 4).map(|values| &values[..row]);
            Ok(rows.collect::<Vec<_>>().concat())
        }
        Way::Mapped => Ok(renderer.render_mapped(scene)?.to_vec()),
        Way::Rays => {
            let ends = [-0.4, 0.1, 0.5].map(|x| DVec3::new(x, 3.0, -1.0 - x));
            let rays = ends.map(|end| Ray::between(DVec3::new(0.2, -3.0, 1.0), end));
            let values = renderer.integrate(scene, &rays)?;
            Ok(values.as_flattened().iter().map(|v| *v as f32).collect())
        }
    }
}

/// A frame with a source of most kinds and with depths. From one to another `step` everything changes that is uploaded.
fn frame(method: Method, step: u32) -> Scene {
    let mut scene = common::empty_scene(72, 40);
    scene.integration.method = match method {
        Method::Simpson { divisions } => Method::simpson(divisions + 2 * step),
        other => other,
    };
    let shift = 0.1 * f64::from(step);
    scene.spheres.push(common::sphere([shift, 0.3, 0.5], 1.5));
    let right = [1.0, 0.15, 0.3];
    scene
        .beams
        .push(common::beam([-0.3, shift, 0.4], right, None));
    let axis = [0.1, 0.2, 2.0];
    scene.tori.push(common::torus([0.1, shift, 0.0], axis, 0.9));
    let points = [[-1.2, -0.2, shift], [-0.6, 1.1, -0.3], [0.0, 0.0, 0.1]];
    let series = vec![1.0, 0.2 + shift, 0.6, 1.0];
    scene.curves.push(common::curve(points, Some(series)));
    let depth = |column, _| 4.0 + shift + 0.02 * f64::from(column);
    scene.depth = Some(common::depths(&scene, DepthAlong::Ray, depth));
    scene
}

/// Two frames that follow each other, by tiles, by pixels, by Simpson's rule.
fn films() -> [[Scene; 2]; 3] {
    [
        common::by(Sampling::Tiles),
        common::by(Sampling::Pixels),
        Method::simpson(20),
    ]
    .map(|method| [0, 1].map(|step| frame(method, step)))
}

/// An error says on which device, in which of these calls, with what code, and what to do.
#[track_caller]
fn expect(error: &Error, device: &Device, calls: &[&str], code: i32) {
    let words = error.to_string();
    assert!(words.starts_with(&device.name), "{words}");
    assert!(
        calls.iter().any(|call| words.contains(call)),
        "{words}\n{calls:?}"
    );
    assert!(words.contains(&format!(", {code}")), "{words}");
    let advice = [
        "choose another device",
        "try again",
        "smaller",
        "POCL_CACHE_DIR",
    ];
    assert!(
        advice.iter().any(|advice| words.contains(advice)),
        "{words}"
    );
}

/// Lets the n-th call of a function fail in a frame, for every n until the frame passes, by every film and way: each
/// time an error in one of these `calls`, and after it the image from before, and as many objects.
fn fail_every_call(function: &str, code: i32, calls: &[&str]) {
    fail_every(Layer::fail, function, code, calls, films());
}

/// Likewise, by a fault of this kind.
fn fail_every(
    fail: fn(&Layer, &str, u64, i32),
    function: &str,
    code: i32,
    calls: &[&str],
    films: [[Scene; 2]; 3],
) {
    let layer = Layer::new();
    let device = common::device();
    let mut renderer = Renderer::new(&device).unwrap();
    let mut faults = 0;
    for ([first, second], way) in films.iter().flat_map(|f| WAYS.map(|way| (f, way))) {
        let mut draw = |scene| draw(&mut renderer, scene, way);
        let images = [first, second].map(|scene| draw(scene).unwrap());
        assert!(images[0] != images[1]);
        let live = layer.live();
        for nth in 1.. {
            assert!(draw(first).unwrap() == images[0], "{way:?}, {nth}");
            fail(&layer, function, nth, code);
            let outcome = draw(second);
            if layer.disarm() == 0 {
                assert!(outcome.unwrap() == images[1], "{way:?}, {nth}");
                break;
            }
            let error = outcome.map(drop).unwrap_err();
            expect(&error, &device, calls, code);
            assert!(draw(second).unwrap() == images[1], "{way:?}, {nth}");
            assert_eq!(layer.live(), live, "{way:?}, {nth}");
            faults += 1;
        }
    }
    assert!(faults > 0, "no frame calls {function}");
    println!("{function}: {faults} faults");
    Renderer::new(&device).unwrap();
}

/// Lets the n-th call of a function fail in the first frame of a renderer, for every n until it passes: each time an
/// error that is `right`; the same renderer then draws the frame, and leaves nothing behind.
fn fail_first_frames(function: &str, code: i32, right: impl Fn(&Error, u64)) {
    let layer = Layer::new();
    let device = common::device();
    let before = layer.live();
    for ([scene, _], way) in films().iter().zip(FIRST_WAYS) {
        let image = draw(&mut Renderer::new(&device).unwrap(), scene, way).unwrap();
        for nth in 1.. {
            let mut renderer = Renderer::new(&device).unwrap();
            layer.fail(function, nth, code);
            let outcome = draw(&mut renderer, scene, way);
            if layer.disarm() == 0 {
                assert!(nth > 1, "no frame calls {function}");
                break;
            }
            let error = outcome.map(drop).unwrap_err();
            expect(&error, &device, &[""], code);
            right(&error, nth);
            assert!(
                draw(&mut renderer, scene, way).unwrap() == image,
                "{way:?}, {nth}"
            );
            drop(renderer);
            assert_eq!(layer.live(), before, "{way:?}, {nth}");
        }
    }
}

#[test]
fn the_layer_sees_the_calls_and_an_armed_fault_reaches_a_frame() {
    with_layer(|| {
        let layer = Layer::new();
        let device = common::device();
        let [tiles, _, _] = films();
        let before = layer.live();
        let mut renderer = Renderer::new(&device).unwrap();
        let launches = || layer.calls("clEnqueueNDRangeKernel");
        let begun = (launches(), layer.calls("clEnqueue*"));
        let image = draw(&mut renderer, &tiles[0], Way::Image).unwrap();
        let passes = launches() - begun.0;
        assert!(passes >= 4, "{passes}");
        assert!(layer.calls("clEnqueue*") - begun.1 > passes);
        let live = layer.live();
        assert!(live.contexts == 1 && live.queues == 1 && live.kernels == 1 && live.buffers > 8);

        layer.fail("clEnqueueNDRangeKernel", 2, OUT_OF_RESOURCES);
        let outcome = draw(&mut renderer, &tiles[0], Way::Image);
        assert_eq!(layer.disarm(), 1);
        let calls = ["clEnqueueNDRangeKernel"];
        expect(
            &outcome.map(drop).unwrap_err(),
            &device,
            &calls,
            OUT_OF_RESOURCES,
        );
        assert_eq!(launches(), begun.0 + passes + 2);
        let again = draw(&mut renderer, &tiles[0], Way::Image).unwrap();
        assert!(again == image);
        drop(renderer);
        assert_eq!(layer.live(), before);
    });
}

#[test]
fn a_refused_context_or_queue_is_an_error() {
    with_layer(|| {
        let layer = Layer::new();
        let device = common::device();
        let before = layer.live();
        for call in ["clCreateContext", "clCreateCommandQueue"] {
            layer.fail(call, 1, OUT_OF_RESOURCES);
            let error = Renderer::new(&device).unwrap_err();
            assert_eq!(layer.disarm(), 1);
            expect(&error, &device, &[call], OUT_OF_RESOURCES);
            assert_eq!(layer.live(), before);
            Renderer::new(&device).unwrap();
        }
    });
}

#[test]
fn a_failed_build_is_an_error_and_the_next_frame_builds_again() {
    with_layer(|| {
        let is_build = |error: &Error, _| {
            assert!(matches!(error, Error::Build { .. }), "{error}");
        };
        fail_first_frames("clBuildProgram", BUILD_FAILURE, is_build);
        for call in ["clCreateProgramWithSource", "clCreateKernel"] {
            let is_named = |error: &Error, _| assert!(error.to_string().contains(call), "{error}");
            fail_first_frames(call, OUT_OF_RESOURCES, is_named);
        }
    });
}

#[test]
fn a_refused_buffer_is_named() {
    with_layer(|| {
        let is_named = |error: &Error, _| {
            assert!(matches!(error, Error::OutOfMemory(_)), "{error}");
            let words = error.to_string();
            let contents = ["the image", "the list of", "the depth image", "the counts"];
            assert!(contents.iter().any(|name| words.contains(name)), "{words}");
        };
        fail_first_frames("clCreateBuffer", OUT_OF_MEMORY, is_named);
    });
}

#[test]
fn a_refused_launch_or_argument_is_an_error_and_the_next_frame_is_right() {
    with_layer(|| {
        for call in ["clEnqueueNDRangeKernel", "clSetKernelArg"] {
            fail_every_call(call, OUT_OF_RESOURCES, &[call]);
        }
    });
}

#[test]
fn a_failed_copy_or_mapping_is_an_error_and_the_next_frame_is_right() {
    with_layer(|| {
        for call in [
            "clEnqueueWriteBuffer",
            "clEnqueueReadBuffer",
            "clEnqueueReadBufferRect",
            "clEnqueueMapBuffer",
        ] {
            fail_every_call(call, OUT_OF_MEMORY, &[call]);
        }
    });
}

#[test]
fn work_that_failed_is_an_error_and_the_next_frame_is_right() {
    with_layer(|| {
        // An error names the command that was waited for.
        let waits = [
            "clWaitForEvents",
            "clEnqueueWriteBuffer",
            "clEnqueueReadBuffer",
        ];
        fail_every_call("clWaitForEvents", WAIT_LIST, &waits);
        for command in ["clEnqueueNDRangeKernel", "clEnqueueReadBuffer"] {
            fail_every(Layer::fail_work, command, WAIT_LIST, &waits, films());
        }
        // Tiles that stay open would be counted on from old numbers, and the lists are not that long: only a lost
        // device leaves such a copy out, and that runs no kernel after it. So by tiles there is but a source that is
        // smooth everywhere.
        let mut films = films();
        for (step, scene) in films[0].iter_mut().enumerate() {
            scene.spheres[0].center.y += 300.0;
            scene.spheres[0].coefficient += step as f64;
            (scene.beams, scene.tori, scene.curves) = Default::default();
        }
        let command = "clEnqueueWriteBuffer";
        fail_every(Layer::fail_work, command, WAIT_LIST, &waits, films);
        let call = "clGetEventProfilingInfo";
        fail_every_call(call, OUT_OF_RESOURCES, &[call]);
    });
}

#[test]
fn a_mapping_that_could_not_be_ended_is_not_drawn_into() {
    with_layer(|| {
        let layer = Layer::new();
        let [[scene, _], _, _] = films();
        let mut renderer = Renderer::new(&common::device()).unwrap();
        let image = draw(&mut renderer, &scene, Way::Mapped).unwrap();
        for way in WAYS {
            let expected = draw(&mut renderer, &scene, way).unwrap();
            let live = layer.live();
            layer.fail("clEnqueueUnmapMemObject", 1, OUT_OF_RESOURCES);
            assert!(draw(&mut renderer, &scene, Way::Mapped).unwrap() == image);
            assert_eq!(layer.disarm(), 1);
            let buffers = layer.calls("clCreateBuffer");
            assert!(draw(&mut renderer, &scene, way).unwrap() == expected);
            assert_eq!(
                layer.calls("clCreateBuffer"),
                buffers + 1,
                "OpenCL leaves open what happens to a mapped buffer"
            );
            assert_eq!(layer.live(), live);
        }
    });
}

/// Codes of calls on a device that is lost, one after another.
fn lost_code(nth: u64) -> i32 {
    [OUT_OF_RESOURCES, WAIT_LIST, INVALID_QUEUE][nth as usize % 3]
}

#[test]
fn a_device_lost_at_any_call_is_an_error_and_the_renderer_goes_on_when_it_is_back() {
    with_layer(|| {
        let layer = Layer::new();
        let device = common::device();
        let mut renderer = Renderer::new(&device).unwrap();
        for ([first, second], way) in films().iter().flat_map(|f| WAYS.map(|way| (f, way))) {
            let mut draw = |scene| draw(&mut renderer, scene, way);
            draw(first).unwrap();
            let begun = layer.calls("*");
            let image = draw(second).unwrap();
            let (calls, live) = (layer.calls("*") - begun, layer.live());
            for nth in 1..=calls {
                draw(first).unwrap();
                let code = lost_code(nth);
                layer.lose_device(nth, code);
                match draw(second) {
                    Ok(whole) => assert!(whole == image, "{way:?}, {nth}"),
                    Err(error) => expect(&error, &device, &["cl"], code),
                }
                expect(&draw(second).map(drop).unwrap_err(), &device, &["cl"], code);
                layer.disarm();
                assert!(draw(second).unwrap() == image, "{way:?}, {nth}");
                assert_eq!(layer.live(), live, "{way:?}, {nth}");
            }
        }
    });
}

#[test]
fn a_renderer_may_be_dropped_on_a_lost_device() {
    with_layer(|| {
        let layer = Layer::new();
        let device = common::device();
        let before = layer.live();
        for ([scene, _], way) in films().iter().zip(FIRST_WAYS) {
            let begun = layer.calls("*");
            let image = draw(&mut Renderer::new(&device).unwrap(), scene, way).unwrap();
            for nth in (1..layer.calls("*") - begun).step_by(11) {
                layer.lose_device(nth, lost_code(nth));
                match Renderer::new(&device) {
                    Ok(mut renderer) => drop(draw(&mut renderer, scene, way)),
                    Err(error) => expect(&error, &device, &["cl"], lost_code(nth)),
                }
                Renderer::new(&device).unwrap_err();
                layer.disarm();
                assert_eq!(layer.live(), before, "{way:?}, {nth}");
            }
            let mut renderer = Renderer::new(&device).unwrap();
            assert!(draw(&mut renderer, scene, way).unwrap() == image);
            let mapped = renderer.render_mapped(scene).unwrap();
            layer.lose_device(1, INVALID_QUEUE);
            drop(mapped);
            drop(renderer);
            layer.disarm();
            assert_eq!(layer.live(), before);
        }
    });
}
