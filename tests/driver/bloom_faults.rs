//! Whatever call fails while a bloom is spread: an error, and the same renderer spreads the next one right, without an
//! object more.

use crate::common;
use crate::common::layer::{Layer, with_layer};
use energywave::image::Bloom;
use energywave::scene::Method;
use energywave::{RadianceImage, Renderer, Scene};

const OUT_OF_RESOURCES: i32 = -5;

/// A point of light whose frame takes few calls. From one to another radius everything changes that is uploaded.
fn scene(radius: f64) -> Scene {
    let mut scene = common::empty_scene(72, 40);
    scene.integration.method = Method::simpson(4);
    scene.spheres.push(common::sphere([0.0; 3], 1.0));
    scene.display.bloom = Some(Bloom {
        strength: 0.5,
        radius,
    });
    scene
}

/// A frame with its bloom, and the bloom of an image that is there.
fn draw(renderer: &mut Renderer, scene: &Scene) -> energywave::Result<[RadianceImage; 2]> {
    renderer.spread_bloom(true);
    let with = renderer.render(scene)?;
    let mut again = with.clone();
    renderer.bloom(&mut again, &scene.display.bloom.unwrap())?;
    Ok([with, again])
}

#[test]
fn the_next_bloom_is_right_whichever_call_failed() {
    with_layer(|| {
        let layer = Layer::new();
        let device = common::device();
        let scenes = [scene(0.02), scene(0.3)];
        let mut renderer = Renderer::new(&device).unwrap();
        let images = scenes
            .each_ref()
            .map(|scene| draw(&mut renderer, scene).unwrap());
        assert!(images[0] != images[1]);
        let live = layer.live();
        for (function, least) in [
            ("clEnqueueNDRangeKernel", 7),
            ("clSetKernelArg", 30),
            ("clEnqueueWriteBuffer", 2),
        ] {
            let mut faults = 0;
            for nth in 1.. {
                assert!(draw(&mut renderer, &scenes[0]).unwrap() == images[0]);
                layer.fail(function, nth, OUT_OF_RESOURCES);
                let outcome = draw(&mut renderer, &scenes[1]);
                if layer.disarm() == 0 {
                    assert!(outcome.unwrap() == images[1], "{function}, {nth}");
                    break;
                }
                let words = outcome.map(drop).unwrap_err().to_string();
                assert!(words.starts_with(&device.name), "{words}");
                assert!(
                    words.contains(function) && words.contains(", -5"),
                    "{words}"
                );
                let next = draw(&mut renderer, &scenes[1]).unwrap();
                assert!(next == images[1], "{function}, {nth}");
                assert_eq!(layer.live(), live, "{function}, {nth}");
                faults += 1;
            }
            assert!(faults >= least, "{function}: {faults} faults");
        }
    });
}

#[test]
fn a_first_bloom_without_memory_or_kernels_is_told_and_the_next_one_is_right() {
    with_layer(|| {
        let layer = Layer::new();
        let device = common::device();
        let scene = scene(0.3);
        let images = draw(&mut Renderer::new(&device).unwrap(), &scene).unwrap();
        let live = layer.live();
        for function in ["clCreateBuffer", "clBuildProgram", "clCreateKernel"] {
            let mut faults = 0;
            for nth in 1.. {
                let mut renderer = Renderer::new(&device).unwrap();
                layer.fail(function, nth, OUT_OF_RESOURCES);
                let outcome = draw(&mut renderer, &scene);
                if layer.disarm() == 0 {
                    break;
                }
                outcome.map(drop).unwrap_err();
                assert!(draw(&mut renderer, &scene).unwrap() == images);
                drop(renderer);
                assert_eq!(layer.live(), live, "{function}, {nth}");
                faults += 1;
            }
            assert!(faults >= 2, "{function}: {faults} faults");
        }
    });
}
