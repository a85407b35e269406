//! Motion blur: the mean of the light while a shutter is open, against the mean of 256 frames.

use std::ops::{ControlFlow, Range};

use energywave::image::{Bloom, DepthAlong, DepthImage, ImageSize};
use energywave::scene::AnimatedScene;
use energywave::{Device, Error, RadianceImage, Renderer, Scene};

use crate::common::{device, difference};

/// What 99.9 % of the pixels may be off by, of the mean of 256 frames: the scenes' tolerance of 1e-3, of the tiles of
/// single frames as much, and what 256 frames miss themselves.
const CLOSE: f64 = 5e-3;

/// What a frame at the middle is off by at least.
const FAR: f64 = 0.05;

/// A beam that crosses 14 pixels and turns, a camera that flies, and dashes and spokes that spin by 15 degrees.
const SCENES: [&str; 3] = [
    "[camera]\neye = [0, -4, 1]\ntarget = [0, 0, 0]\n[[segment]]\nradius = 0.02\ncolor = [0.2, 0.5, 1.3]\n\
     coefficient = 0.02\nfrom = [-1.5, 0, { times = [0, 1], values = [-1, 30] }]\n\
     to = [1.5, 0, { times = [0, 1], values = [-0.6, 45] }]\n",
    "[camera]\neye = { times = [0, 1], values = [[0, -4, 1], [40, 20, 1]] }\ntarget = [0, 0, 0]\n[[torus]]\n\
     major_radius = 0.9\nradius = 0.02\ncolor = [1.3, 0.5, 0.2]\n[[sphere]]\ncenter = [0.5, 0.5, 0.2]\nradius = 0.05\n",
    "[camera]\neye = [0, -3, 2]\ntarget = [0, 0, 0]\n[[group]]\nrotate = { axis = [0, 0, 1], angle = \
     { times = [0, 1], values = [0, 720] } }\n[[group.torus]]\nmajor_radius = 1\nradius = 0.03\ndashes = { count = 5, fill = 0.5 }\n\
     [[group.group]]\nrepeat = { count = 3, axis = [0, 0, 1] }\n[[group.group.segment]]\nfrom = [0.3, 0, 0]\n\
     to = [0.7, 0, 0]\nradius = 0.02\n",
];

pub fn scene(text: &str) -> AnimatedScene {
    AnimatedScene::from_toml(format!(
        "[image]\nwidth = 64\nheight = 48\n[time]\nshutter = 0.5\n{text}"
    ))
    .unwrap()
}

/// The mean of frames at the middles of equal times.
pub fn mean(
    renderer: &mut Renderer,
    scene: &AnimatedScene,
    times: &Range<f64>,
    count: u32,
) -> RadianceImage {
    let mut sum = Vec::new();
    let mut image = RadianceImage::new(scene.at(times.start).unwrap().image).unwrap();
    for frame in 0..count {
        let share = (f64::from(frame) + 0.5) / f64::from(count);
        let time = times.start + share * (times.end - times.start);
        renderer
            .render_into(&scene.at(time).unwrap(), image.as_mut_slice())
            .unwrap();
        sum.resize(image.as_slice().len(), 0.0);
        for (sum, light) in sum.iter_mut().zip(image.as_slice()) {
            *sum += f64::from(*light) / f64::from(count);
        }
    }
    for (light, sum) in image.as_mut_slice().iter_mut().zip(sum) {
        *light = sum as f32;
    }
    image
}

#[test]
fn motion_blur_is_the_mean_of_256_frames_and_one_frame_is_not() {
    let mut renderer = Renderer::new(&device()).unwrap();
    for text in SCENES {
        let scene = scene(text);
        let times = scene.open_at(0.0, 24.0);
        let expected = mean(&mut renderer, &scene, &times, 256);
        let blurred = renderer.render_shutter(&scene, times.clone()).unwrap();
        let moments = renderer.last_moments();
        let found = difference(&blurred, &expected);
        assert!(found.p999 <= CLOSE, "{moments} moments: {found:?}\n{text}");
        assert!(blurred.as_slice().chunks(4).all(|pixel| pixel[3] == 1.0));
        for (count, least) in [(1, FAR), (3, CLOSE)] {
            let few = difference(&mean(&mut renderer, &scene, &times, count), &expected);
            assert!(few.p999 > least, "{count} frames: {few:?}\n{text}");
        }
    }
}

#[test]
fn the_reference_blurs_as_the_device_does() {
    // Thick enough to be seen by rays: at so few pixels the footprints of thin cores differ more.
    let text = SCENES[0].replace("0.02\ncolor", "0.2\ncolor");
    let scene = scene(&format!("{text}[integration]\nantialias = \"none\"\n"));
    let times = scene.open_at(0.0, 24.0);
    let small = |time| {
        scene.at_with(time, |scene, _| {
            (scene.image.width, scene.image.height) = (24, 20);
            Ok(())
        })
    };
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    let mut renderer = Renderer::new(&device()).unwrap();
    let expected = reference.render_mean(times.clone(), small).unwrap();
    let blurred = renderer.render_mean(times.clone(), small).unwrap();
    let found = difference(&blurred, &expected);
    assert!(found.max <= CLOSE, "{found:?}");
    let sharp = difference(&renderer.render(&small(0.01).unwrap()).unwrap(), &expected);
    assert!(sharp.p999 > FAR, "{sharp:?}");
}

#[test]
fn where_nothing_moves_a_blurred_frame_is_the_frame_to_the_bit() {
    let mut renderer = Renderer::new(&device()).unwrap();
    let still = "[camera]\neye = [0, -4, 1]\ntarget = [0, 0, 0]\n[[sphere]]\nradius = 0.05\n";
    let rests = |keys: &str| format!("{still}coefficient = {{ {keys} }}\n");
    for (text, from, moments) in [
        (still.to_owned(), 0.0, 1),
        (rests("times = [0, 1], values = [1, 2]"), 3.0, 1),
        (
            rests("times = [0, 1], values = [1, 2], interpolation = \"step\""),
            0.9,
            1,
        ),
        (rests("times = [0, 1], values = [1, 2]"), 0.9, 7),
    ] {
        let scene = scene(&text);
        let times = scene.open_at(from, 10.0);
        let blurred = renderer.render_shutter(&scene, times).unwrap();
        let cost = renderer.last_cost();
        assert_eq!(renderer.last_moments(), moments, "{text}");
        let frame = renderer.render(&scene.at(from).unwrap()).unwrap();
        assert_eq!(blurred == frame, moments == 1, "{text}");
        assert_eq!(
            cost.integrals >= 6 * renderer.last_cost().integrals,
            moments > 1
        );
        // A closed shutter.
        let closed = scene.with_shutter(0.0);
        let times = closed.open_at(from, 10.0);
        assert!(renderer.render_shutter(&closed, times).unwrap() == frame);
    }
}

#[test]
fn light_that_jumps_is_met_and_drawn_only_twice_a_level() {
    let mut renderer = Renderer::new(&device()).unwrap();
    let scene = scene(
        "[camera]\neye = [0, -4, 1]\ntarget = [0, 0, 0]\n[[sphere]]\nradius = 0.05\n\
         coefficient = { times = [0, 0.3], values = [1, 3], interpolation = \"step\" }\n",
    );
    let blurred = renderer.render_shutter(&scene, 0.0..1.0).unwrap();
    let (moments, cost) = (renderer.last_moments(), renderer.last_cost());
    let mut expected = renderer.render(&scene.at(0.0).unwrap()).unwrap();
    let one = renderer.last_cost();
    for light in expected.as_mut_slice() {
        *light *= 0.3 + 3.0 * 0.7;
    }
    let found = difference(&blurred, &expected);
    assert!(found.max < 2e-3, "{moments} moments: {found:?}");
    assert!(moments >= 255, "{moments}");
    assert!(
        cost.integrals <= 20 * one.integrals,
        "{cost:?}, once {one:?}"
    );
}

#[test]
fn a_bloom_is_that_of_the_mean_and_fine_depths_are_blurred_too() {
    let mut renderer = Renderer::new(&device()).unwrap();
    let scene = scene(SCENES[0]);
    let times = scene.open_at(0.0, 240.0);
    let bloom = Bloom::new(0.4);
    let changed = |time, change: &dyn Fn(&mut Scene)| {
        scene.at_with(time, |scene, _| {
            change(scene);
            Ok(())
        })
    };
    let mut expected = renderer.render_shutter(&scene, times.clone()).unwrap();
    let plain = expected.clone();
    renderer.bloom(&mut expected, &bloom).unwrap();
    renderer.spread_bloom(true);
    let blooms = |time| changed(time, &|scene| scene.display.bloom = Some(bloom));
    let blurred = renderer.render_mean(times.clone(), blooms).unwrap();
    assert!(blurred == expected && blurred != plain);
    assert_eq!(blurred.bloom(), Some(bloom));
    // Every other column of four of a pixel is before everything.
    let fine = ImageSize {
        width: 4 * 64,
        height: 4 * 48,
    };
    let values = (0..fine.pixels()).map(|k| if k % 2 == 0 { 0.5 } else { f32::INFINITY });
    let depth = DepthImage::new(fine, DepthAlong::Ray, values.collect()).unwrap();
    let hidden = |time| changed(time, &|scene| scene.depth = Some(depth.clone()));
    let near = renderer.render_mean(times, hidden).unwrap();
    let mut half = plain;
    for light in half.as_mut_slice() {
        *light *= 0.5;
    }
    let found = difference(&near, &half);
    assert!(found.p999 <= CLOSE, "{found:?}");
}

#[test]
fn a_blurred_frame_tells_its_progress_can_be_stopped_and_refuses_what_is_no_mean() {
    let mut renderer = Renderer::new(&device()).unwrap();
    let scene = scene(SCENES[2]);
    let mut at = |time| scene.at(time);
    let (mut last, mut count) = (0.0, 0);
    let mut hear = |share: f32| {
        assert!((last..=1.0).contains(&share), "{share} after {last}");
        (last, count) = (share, count + 1);
        ControlFlow::Continue(())
    };
    renderer
        .render_mean_with_progress(0.0..0.02, &mut at, &mut hear)
        .unwrap();
    assert!(count > 7 && last > 0.9, "{count}, {last}");
    let stop = &mut |share: f32| match share > 0.3 {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let stopped = renderer.render_mean_with_progress(0.0..0.02, &mut at, stop);
    assert!(matches!(stopped, Err(Error::Interrupted)));
    for times in [0.0..f64::NAN, f64::NEG_INFINITY..0.0] {
        let error = renderer.render_shutter(&scene, times).unwrap_err();
        assert!(error.to_string().contains("finite"), "{error}");
    }
    let grows = |time| {
        scene.at_with(time, |scene, _| {
            scene.image.width += (400.0 * time) as u32;
            Ok(())
        })
    };
    let error = renderer
        .render_mean(0.0..0.02, grows)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("64x48 and, at 0.01 s, 68x48 pixels"),
        "{error}"
    );
}
