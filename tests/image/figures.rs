//! Every scene of the repository by every method, in the form of the device: `.ci/gpu-form` runs these on drivers where
//! kernels have the form of a GPU.

use crate::common;
use energywave::scene::{Method, MethodKeys, Sampling};
use energywave::{Renderer, RendererOptions, reference};

/// Pixels a side.
const SIZE: u32 = 32;

fn by_tiles(keys: &MethodKeys) -> Method {
    exact(keys, Sampling::Tiles)
}

fn by_pixels(keys: &MethodKeys) -> Method {
    exact(keys, Sampling::Pixels)
}

fn exact(keys: &MethodKeys, sampling: Sampling) -> Method {
    Method::Exact {
        tolerance: keys.tolerance,
        sampling,
    }
}

/// Draws the figures by a method, and returns those that miss their tolerance.
fn that_miss(method: fn(&MethodKeys) -> Method, options: &RendererOptions) -> Vec<String> {
    let device = common::device();
    let (form, workers) = (device.form, device.tile_workers);
    println!(
        "device: {device}, form {form}, {} lanes, {workers} workers",
        device.lanes
    );
    let mut renderer = Renderer::with_options(&device, options).unwrap();
    let missing = |(name, scene): (String, _)| {
        let image = renderer.render(&scene).unwrap();
        let (truth, most) = match scene.integration.method {
            Method::Simpson { .. } => (common::simpson_reference(&scene), common::WORST_PIXEL),
            _ => {
                let truth = reference::render(&scene).unwrap();
                (truth, 10.0 * common::tolerance(&scene))
            }
        };
        // One pixel in a thousand may miss the tolerance: here that is the worst one.
        let found = common::difference(&image, &truth);
        println!("{name}, {:?}: {found:?}", scene.integration.method);
        let is_within = found.max <= most && found.rms <= 0.1 * most;
        (!is_within).then(|| format!("{name}: {found:?}"))
    };
    let figures = common::figures(SIZE, method).into_iter();
    figures.filter_map(missing).collect()
}

#[test]
fn every_figure_by_tiles_is_within_its_tolerance() {
    let missing = that_miss(by_tiles, &RendererOptions::default());
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn every_figure_by_pixels_is_within_its_tolerance() {
    let missing = that_miss(by_pixels, &RendererOptions::default());
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn every_figure_by_simpsons_rule_is_within_float32s_rounding() {
    let missing = that_miss(common::simpson_of, &RendererOptions::default());
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn every_figure_misses_its_tolerance_where_fields_are_spoiled() {
    let options = common::options(common::device().lanes, common::BROKEN_FIELDS);
    let missing = that_miss(common::simpson_of, &options).len();
    assert_eq!(missing, common::scene_files().len());
}
