//! The bloom of a picture on the device is that of the host, at sizes with borders of every kind, in the form of a CPU
//! and in that of a GPU, and no light is lost. Spoiled: another weight of the middle.

use crate::common::{self, lane_widths};
use energywave::image::{Bloom, DepthAlong, DepthImage, ImageSize};
use energywave::internals::{Compute, DeviceForm, Film, FilmFormat, Spreader, discover};
use energywave::{Device, RadianceImage, Renderer, RendererOptions, Scene};

/// Relative to what the host finds: float32, summed in another order.
const ROUNDING: f32 = 2e-6;

/// Half floats have 11 binary digits.
const HALF_ROUNDING: f32 = 1.0 / 2048.0;

/// Of the sum of all light, as a share of it.
const LOST: f64 = 1e-5;

const SIZES: [(u32, u32); 8] = [
    (1, 1),
    (1, 7),
    (2, 3),
    (5, 1),
    (63, 41),
    (640, 360),
    (777, 130), // more than one piece a row
    (333, 2),
];

/// Another weight of the column at the middle, in the fast halving alone.
const SPOILED: &str = "-D MIDDLE_WEIGHT=0.38f";

fn compute(form: DeviceForm) -> Compute {
    let name = common::device().name;
    let mut found = discover().devices;
    found.retain(|device| device.name == name);
    let mut device = found.swap_remove(0);
    device.form = form;
    Compute::new(&device).unwrap()
}

/// Sparks in the corners and within, on a wide glow, of any alpha.
fn picture(width: u32, height: u32) -> RadianceImage {
    let size = ImageSize { width, height };
    let mut image = RadianceImage::new(size).unwrap();
    let last = size.pixels() - 1;
    for (index, pixel) in image.as_mut_slice().chunks_exact_mut(4).enumerate() {
        let spark = if index % 31 == 5 { 90.0 } else { 0.0 };
        let corner = if index == 0 || index == last {
            2e3
        } else {
            0.0
        };
        let alpha = [1.0, 0.5, 0.0][index % 3];
        let glow = 0.01 * (index % 13) as f32;
        pixel.copy_from_slice(&[glow + corner, spark, 0.5 + corner, alpha]);
    }
    image
}

fn pixels(image: &RadianceImage) -> &[[f32; 4]] {
    image.as_slice().as_chunks().0
}

/// What the device makes of it, twice by what is kept from picture to picture.
struct Spread {
    compute: Compute,
    spreader: Spreader,
}

impl Spread {
    fn new(form: DeviceForm, options: &RendererOptions) -> Self {
        Self {
            compute: compute(form),
            spreader: Spreader::new(options),
        }
    }

    fn of(&mut self, image: &RadianceImage, bloom: &Bloom, format: FilmFormat) -> Vec<[f32; 4]> {
        let Self { compute, spreader } = self;
        let ImageSize { width, height } = image.size();
        let mut film = Film::in_format(compute, format, width, height).unwrap();
        film.write(compute, pixels(image)).unwrap();
        spreader
            .spread(compute, &mut film, image.size(), bloom)
            .unwrap();
        let mut found = vec![[f32::NAN; 4]; image.size().pixels()];
        film.read(compute, &mut found).unwrap();
        assert!(spreader.settle(compute).unwrap().launches >= 2);
        found
    }
}

/// The largest difference of any channel, relative to the host's; NaN where both are not finite counts as equal.
fn off(found: &[[f32; 4]], expected: &RadianceImage) -> f32 {
    let pairs = found.as_flattened().iter().zip(expected.as_slice());
    let errors = pairs.map(|(found, expected)| match expected.is_finite() {
        true => (found - expected).abs() / expected.abs().max(1e-3),
        false if found.to_bits() == expected.to_bits() => 0.0,
        false => f32::INFINITY,
    });
    errors.fold(0.0, |worst, it| if it <= worst { worst } else { it })
}

fn bloom(radius: f64) -> Bloom {
    Bloom {
        strength: 0.7,
        radius,
    }
}

#[test]
fn the_device_spreads_light_as_the_host_does_and_loses_none() {
    for form in [DeviceForm::Cpu, DeviceForm::Gpu] {
        let mut spread = Spread::new(form, &common::options(common::device().lanes, ""));
        for (width, height) in SIZES {
            let image = picture(width, height);
            for radius in [1e-9, 0.01, 0.3] {
                let expected = image.bloomed(&bloom(radius)).unwrap();
                let found = spread.of(&image, &bloom(radius), FilmFormat::Floats);
                let what = format!("{form:?}, {width}x{height}, radius {radius}");
                let worst = off(&found, &expected);
                assert!(worst <= ROUNDING, "{what}: {worst:e}");
                for channel in 0..3 {
                    let sum = |pixels: &[[f32; 4]]| -> f64 {
                        pixels.iter().map(|pixel| f64::from(pixel[channel])).sum()
                    };
                    let (before, after) = (sum(pixels(&image)), sum(&found));
                    let lost = (after - before).abs() / before.max(1e-9);
                    assert!(lost <= LOST, "{what}: {before} became {after}");
                }
                let alphas = found.iter().zip(pixels(&image));
                assert!(alphas.into_iter().all(|(a, b)| a[3] == b[3]), "{what}");
            }
        }
    }
}

#[test]
fn another_weight_is_noticed_and_refused_at_the_first_use() {
    let image = picture(63, 41);
    let expected = image.bloomed(&bloom(0.3)).unwrap();
    let own = common::device().lanes;
    let mut spread = Spread::new(DeviceForm::Cpu, &common::options(own, SPOILED));
    let worst = off(
        &spread.of(&image, &bloom(0.3), FilmFormat::Floats),
        &expected,
    );
    assert!(worst > 100.0 * ROUNDING, "{worst:e}");
    // As users have it, it does not get so far.
    let mut options = common::options(own, SPOILED);
    options.skips_self_test = false;
    let mut spread = Spread::new(DeviceForm::Cpu, &options);
    let mut film = Film::new();
    film.write(&spread.compute, pixels(&image)).unwrap();
    let Spread { compute, spreader } = &mut spread;
    let error = spreader
        .spread(compute, &mut film, image.size(), &bloom(0.3))
        .unwrap_err();
    assert_eq!(error.kind(), energywave::ErrorKind::SelfTest, "{error}");
    assert!(error.to_string().contains("bloom"), "{error}");
}

#[test]
fn light_without_end_stays_where_it_is_and_spoils_nothing() {
    let mut image = picture(63, 41);
    for (index, value) in [
        (0, f32::INFINITY),
        (400, f32::NAN),
        (1201, f32::NEG_INFINITY),
        (2000 * 4 + 3, f32::NAN), // an alpha
        (63 * 41 * 4 - 2, f32::INFINITY),
    ] {
        image.as_mut_slice()[index] = value;
    }
    let expected = image.bloomed(&bloom(0.3)).unwrap();
    for form in [DeviceForm::Cpu, DeviceForm::Gpu] {
        let mut spread = Spread::new(form, &common::options(common::device().lanes, ""));
        let found = spread.of(&image, &bloom(0.3), FilmFormat::Floats);
        let worst = off(&found, &expected);
        assert!(worst <= ROUNDING, "{form:?}: {worst:e}");
        let lost = found.as_flattened().iter().filter(|it| !it.is_finite());
        assert_eq!(lost.count(), 5, "{form:?}");
    }
}

#[test]
fn films_of_every_format_get_it_on_every_lane_width() {
    let image = picture(63, 41);
    let expected = image.bloomed(&bloom(0.1)).unwrap();
    let own = common::device().lanes;
    let widths = lane_widths().into_iter();
    let floats = widths.map(|lanes| (lanes, FilmFormat::Floats, ROUNDING));
    let others = [
        (own, FilmFormat::Halves, HALF_ROUNDING),
        (own, FilmFormat::Image { has_halves: false }, ROUNDING),
    ];
    for (lanes, format, limit) in floats.chain(others) {
        let mut spread = Spread::new(DeviceForm::Cpu, &common::options(lanes, ""));
        let found = spread.of(&image, &bloom(0.1), format);
        let worst = off(&found, &expected);
        assert!(worst <= limit, "{lanes} lanes, {format:?}: {worst:e}");
        let is_rounded = format == FilmFormat::Halves;
        assert_eq!(worst > 1e-5, is_rounded, "{format:?}: {worst:e}");
    }
}

/// A ring and a point with a bloom.
fn scene() -> Scene {
    let mut scene = common::empty_scene(99, 70);
    scene
        .tori
        .push(common::torus([0.1, 0.0, 0.0], [0.1, 0.2, 2.0], 0.9));
    scene.spheres.push(common::sphere([0.4, 0.3, 0.5], 1.5));
    scene.display.bloom = Some(Bloom::new(0.4));
    scene
}

/// What every way to render gives by a renderer that was told to spread the bloom.
fn rendered(renderer: &mut Renderer, scene: &Scene) -> Vec<(&'static str, Vec<f32>)> {
    let image = renderer.render(scene).unwrap();
    assert_eq!(image.bloom(), scene.display.bloom);
    let mut into = vec![0.0; 4 * scene.image.pixels()];
    renderer.render_into(scene, &mut into).unwrap();
    let mapped = renderer.render_mapped(scene).unwrap().to_vec();
    vec![
        ("render", image.as_slice().to_vec()),
        ("render_into", into),
        ("render_mapped", mapped),
    ]
}

#[test]
fn a_renderer_spreads_the_bloom_of_its_scene_where_it_is_told_to() {
    let scene = scene();
    let (bloom, size) = (scene.display.bloom.unwrap(), scene.image);
    let device = common::device();
    let options = RendererOptions::default();
    let several = [device.clone(), device.clone()];
    for mut renderer in [
        Renderer::new(&device).unwrap(),
        Renderer::on_devices(&several, &options).unwrap(),
        Renderer::new(&Device::reference()).unwrap(),
    ] {
        let before = renderer.render(&scene).unwrap();
        assert_eq!(before.bloom(), None);
        let cost = renderer.last_cost().launches;
        let expected = before.bloomed(&bloom).unwrap();
        renderer.spread_bloom(true);
        for (way, found) in rendered(&mut renderer, &scene) {
            let worst = off(found.as_chunks().0, &expected);
            assert!(worst <= ROUNDING, "{way}: {worst:e}");
        }
        assert!(cost == 1 || renderer.last_cost().launches >= cost + 2);
        // Afterwards, too.
        let mut image = before.clone();
        renderer.bloom(&mut image, &bloom).unwrap();
        assert!(off(pixels(&image), &expected) <= ROUNDING);
        // No display spreads it again.
        assert_eq!(image.bloom(), Some(bloom));
        let mut without = scene.display.clone();
        without.bloom = None;
        assert_eq!(image.tone_map(&scene.display), image.tone_map(&without));
        assert_ne!(before.tone_map(&scene.display), before.tone_map(&without));
        let mut rows = vec![0.0; 4 * size.pixels()];
        let stride = 4 * size.width as usize;
        let error = renderer
            .render_rows(&scene, 0..9, &mut rows, stride)
            .unwrap_err();
        assert!(error.to_string().contains("Renderer::bloom"), "{error}");
        renderer.spread_bloom(false);
        assert_eq!(renderer.render(&scene).unwrap(), before);
        renderer
            .render_rows(&scene, 0..9, &mut rows, stride)
            .unwrap();
    }
}

#[test]
fn a_bloom_is_of_all_that_is_seen_where_depths_are_finer_than_pixels() {
    let mut scene = scene();
    let (width, height) = (2 * scene.image.width, 2 * scene.image.height);
    let size = ImageSize { width, height };
    let depth = |index: usize| match index % width as usize {
        0..98 => 3.0,
        _ => f32::INFINITY,
    };
    let depths = (0..size.pixels()).map(depth).collect();
    scene.depth = Some(DepthImage::new(size, DepthAlong::Ray, depths).unwrap());
    let bloom = scene.display.bloom.unwrap();
    let mut renderer = Renderer::new(&common::device()).unwrap();
    let before = renderer.render(&scene).unwrap();
    let expected = before.bloomed(&bloom).unwrap();
    assert!(off(pixels(&before), &expected) > 0.01);
    renderer.spread_bloom(true);
    for (way, found) in rendered(&mut renderer, &scene) {
        let worst = off(found.as_chunks().0, &expected);
        assert!(worst <= ROUNDING, "{way}: {worst:e}");
    }
}
