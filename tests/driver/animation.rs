//! Frames of a scene that moves: after the first ones nothing is made on the device.

use std::ops::ControlFlow;

use crate::common;
use crate::common::layer::{Layer, with_layer};
use energywave::scene::AnimatedScene;
use energywave::{RadianceImage, Renderer};

/// A ring that grows, turns and flickers before a camera that comes closer.
const SCENE: &str = "[camera]\neye = { times = [0, 9], values = [[0, -4, 2], [0, -3, 2]] }\ntarget = [0, 0, 0]\n\
    [image]\nwidth = 48\nheight = 32\n[display]\nexposure = 0\nbloom = { strength = 0.2 }\n[[group]]\n\
    rotate = { axis = [0, 0, 1], angle = { times = [0, 1], values = [0, 360], loop = \"repeat\" } }\n\
    [[group.torus]]\nmajor_radius = { times = [0, 9], values = [0.5, 1.5] }\n\
    layers = [{ radius = 0.1, reach = 1.0, peak = { value = 2, noise = { amplitude = 1, frequency = 9 } } }]\n";

#[test]
fn frames_after_the_first_make_nothing_on_the_device_and_compile_nothing() {
    with_layer(|| {
        let layer = Layer::new();
        let scene = AnimatedScene::from_toml(SCENE).unwrap();
        let mut renderer = Renderer::new(&common::device()).unwrap();
        renderer.spread_bloom(true);
        let mut image = RadianceImage::new(scene.at(0.0).unwrap().image).unwrap();
        let mut draw = |frame: u32| {
            let scene = scene.at(f64::from(frame) / 30.0).unwrap();
            let go_on = &mut |_: f32| ControlFlow::Continue(());
            renderer.render_over(&scene, &mut image, go_on).unwrap();
            image.as_slice().to_vec()
        };
        let made = || ["clCreate*", "clBuild*"].map(|call| layer.calls(call));
        let before = made();
        let first = draw(0);
        draw(1);
        let (after, live) = (made(), layer.live());
        assert!(
            after[0] > before[0] && after[1] > before[1],
            "the first frame makes all: {before:?} {after:?}"
        );
        for frame in 2..100 {
            draw(frame);
        }
        assert_eq!(made(), after);
        assert_eq!(layer.live(), live);
        assert_ne!(draw(100), first);
    });
}
