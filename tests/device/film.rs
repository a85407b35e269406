//! A second engine adds its light to the wave's in one film, of every format: it knows no wave, only `cl/film.h` and
//! `cl/view.h`. Spoiled: where nobody says that light is added, the second engine's is all that is left.

use crate::common;
use crate::common::lane_widths;
use energywave::internals::pack;
use energywave::internals::{
    self, Argument, Compute, Film, FilmFormat, Pixel, Program, Wave, draw_wave,
};
use energywave::scene::{Method, Sampling};
use energywave::{RendererOptions, Scene};

/// Draws a gradient over the image's columns, an even green, and blue where rays rise or fall.
const ENGINE: &str = r#"
#include "film.h"
#include "view.h"

__kernel void paint(const View view, const FilmPart part, FILM_PARAMETER) {
    const uint begin = get_global_id(0) * LANES;
    if (begin >= part.count)
        return;
    const uint first = part.first + begin;
    const Screen screen = {&view, 0, 0.0f};
    const Ray ray = pixel_ray(&screen, first);
    const uintv column = ((uintv)(first) + LANE_NUMBERS) % view.width;
    const floatv gradient = 0.125f * to_floatv(column);
    const float3v light = {gradient, splat(0.5f), fabs(ray.span.z) * inverse(ray.length)};
    store_pixels(&part, begin, add3(gathered_light(&part, begin, pixels), light), FILM_ARGUMENT);
}
"#;

/// No multiple of any lane width or tile.
const WIDTH: u32 = 37;
const HEIGHT: u32 = 21;

/// Relative to 1 or to the pixel. The view's rays in float32; the wave's kernels for an image round in another order
/// (as in tests/host/host.rs); half floats have 11 binary digits.
const ROUNDING: f32 = 1e-6;
const OTHER_KERNEL: f32 = 2e-4;
const HALF_ROUNDING: f32 = 1.0 / 2048.0;

const FORMATS: [(FilmFormat, f32); 3] = [
    (FilmFormat::Floats, ROUNDING),
    (FilmFormat::Halves, HALF_ROUNDING + OTHER_KERNEL),
    (FilmFormat::Image { has_halves: false }, OTHER_KERNEL),
];

/// A ring and a point, by one of the ways to take pixels.
fn scene(method: Method) -> Scene {
    let mut scene = common::empty_scene(WIDTH, HEIGHT);
    scene.integration.method = method;
    let axis = [0.1, 0.2, 2.0];
    scene.tori.push(common::torus([0.1, 0.0, 0.0], axis, 0.9));
    scene.spheres.push(common::sphere([0.4, 0.3, 0.5], 1.5));
    scene
}

fn film(compute: &Compute, format: FilmFormat) -> Film {
    Film::in_format(compute, format, WIDTH, HEIGHT).unwrap()
}

fn read(compute: &Compute, film: &Film) -> Vec<Pixel> {
    let mut pixels = vec![[f32::NAN; 4]; (WIDTH * HEIGHT) as usize];
    film.read(compute, &mut pixels).unwrap();
    pixels
}

/// The second engine, built for a film's format.
fn engine(compute: &Compute, lanes: u32, format: FilmFormat) -> Program {
    let options = common::options(lanes, format.definitions());
    internals::build_text(compute, "paint.cl", ENGINE, &[], &options).unwrap()
}

#[allow(unsafe_code)]
fn paint(compute: &Compute, program: &Program, scene: &Scene, film: &mut Film) {
    let view = pack::view(&scene.view_plane(), scene);
    let arguments: [(&str, &dyn Argument); 1] = [("view", &view)];
    let size = (WIDTH, HEIGHT);
    // SAFETY: the engine stores the part's pixels, as many as the film has.
    unsafe { internals::run_on_film(compute, program, "paint", &arguments, film, size) }.unwrap();
}

/// What the second engine draws, in float64.
fn painted(scene: &Scene) -> Vec<[f64; 3]> {
    let plane = scene.view_plane();
    let places = (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |column| (column, row)));
    let light = |(column, row)| {
        let rise = plane.ray(column, row).span.normalize().z.abs();
        [0.125 * f64::from(column), 0.5, rise]
    };
    places.map(light).collect()
}

/// The largest difference of any channel from `wave + painted`, relative to that or to 1; alpha must be 1.
fn off(found: &[Pixel], wave: &[Pixel], painted: &[[f64; 3]]) -> f32 {
    assert!(found.iter().all(|pixel| pixel[3] == 1.0), "alpha is not 1");
    let pixels = found.iter().zip(wave).zip(painted);
    let errors = pixels.flat_map(|((found, wave), painted)| {
        [0, 1, 2].map(|channel| {
            let expected = f64::from(wave[channel]) + painted[channel];
            ((f64::from(found[channel]) - expected).abs() / expected.max(1.0)) as f32
        })
    });
    errors.fold(
        0.0,
        |worst, error| if error <= worst { worst } else { error },
    )
}

fn wave(compute: &Compute, options: &RendererOptions) -> Wave {
    Wave::new(compute, options).unwrap()
}

#[test]
fn every_pixel_is_the_sum_of_two_engines_light_in_every_format() {
    let compute = common::compute();
    // Every width by the rule whose kernels are soon compiled, and every method on the device's own.
    let simpson = Method::simpson(64);
    let widths = lane_widths().into_iter().map(|lanes| (lanes, simpson));
    let own = common::device().lanes;
    let methods = [Sampling::Pixels, Sampling::Tiles].map(|sampling| (own, common::by(sampling)));
    for (lanes, method) in widths.chain(methods) {
        let scene = scene(method);
        let painted = painted(&scene);
        let mut wave = wave(&compute, &common::options(lanes, ""));
        let mut alone = film(&compute, FilmFormat::Floats);
        draw_wave(&mut wave, &compute, &scene, &mut alone).unwrap();
        let alone = read(&compute, &alone);
        for (format, limit) in FORMATS {
            let what = format!("{lanes} lanes, {method:?}, {format:?}");
            let engine = engine(&compute, lanes, format);
            let mut film = film(&compute, format);
            // A frame after the first begins anew.
            for frame in 0..2 {
                film.add_to_what_is_there(false);
                film.leave_unfinished(true);
                draw_wave(&mut wave, &compute, &scene, &mut film).unwrap();
                film.leave_unfinished(false);
                film.add_to_what_is_there(true);
                paint(&compute, &engine, &scene, &mut film);
                let worst = off(&read(&compute, &film), &alone, &painted);
                assert!(worst <= limit, "{what}, frame {frame}: {worst:e}");
            }
            assert!(film.format() == format, "{what}: {:?}", film.format());
        }
    }
}

#[test]
fn the_wave_adds_to_what_another_engine_drew_before() {
    let (compute, lanes) = (common::compute(), common::device().lanes);
    let scene = scene(common::by(Sampling::Tiles));
    let painted = painted(&scene);
    let mut wave = wave(&compute, &common::options(lanes, ""));
    let mut alone = film(&compute, FilmFormat::Floats);
    draw_wave(&mut wave, &compute, &scene, &mut alone).unwrap();
    let alone = read(&compute, &alone);
    for (format, limit) in FORMATS {
        let mut film = film(&compute, format);
        film.reserve_band(&compute, alone.len(), 1).unwrap();
        film.leave_unfinished(true);
        paint(
            &compute,
            &engine(&compute, lanes, format),
            &scene,
            &mut film,
        );
        film.leave_unfinished(false);
        film.add_to_what_is_there(true);
        draw_wave(&mut wave, &compute, &scene, &mut film).unwrap();
        let worst = off(&read(&compute, &film), &alone, &painted);
        assert!(worst <= limit.max(OTHER_KERNEL), "{format:?}: {worst:e}");
    }
}

#[test]
fn without_adding_only_the_second_engines_light_is_left() {
    let (compute, lanes) = (common::compute(), common::device().lanes);
    let scene = scene(common::by(Sampling::Tiles));
    let painted = painted(&scene);
    let dark = vec![[0.0; 4]; painted.len()];
    let mut wave = wave(&compute, &common::options(lanes, ""));
    let mut alone = film(&compute, FilmFormat::Floats);
    draw_wave(&mut wave, &compute, &scene, &mut alone).unwrap();
    let alone = read(&compute, &alone);
    for (format, limit) in FORMATS {
        let mut film = film(&compute, format);
        film.leave_unfinished(true);
        draw_wave(&mut wave, &compute, &scene, &mut film).unwrap();
        film.leave_unfinished(false);
        paint(
            &compute,
            &engine(&compute, lanes, format),
            &scene,
            &mut film,
        );
        let pixels = read(&compute, &film);
        let (sum, only) = (
            off(&pixels, &alone, &painted),
            off(&pixels, &dark, &painted),
        );
        assert!(sum > 0.01, "{format:?}: the sum all the same");
        assert!(only <= limit, "{format:?}: {only:e}");
    }
}

#[test]
fn a_film_of_another_size_is_refused() {
    let compute = common::compute();
    let mut wave = wave(&compute, &common::options(common::device().lanes, ""));
    let mut larger = scene(common::by(Sampling::Pixels));
    larger.image.height += 1;
    for (format, _) in &FORMATS[1..] {
        let mut film = film(&compute, *format);
        let error = draw_wave(&mut wave, &compute, &larger, &mut film).unwrap_err();
        let words = error.to_string();
        assert!(
            words.contains("37x21") && words.contains("37x22"),
            "{words}"
        );
    }
}
