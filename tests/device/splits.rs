//! A frame has the same bits however it is cut into launches: by pixels, by sources, by tiles, or by time. Spoiled: the
//! light of two halves of the sources, added up, has other bits.

use crate::common;
use energywave::image::DepthAlong;
use energywave::internals::{
    self, Compute, Film, FilmFormat, Pixel, Split, TILE_SHARES, Wave, draw_wave,
};
use energywave::scene::{Method, Sampling};
use energywave::verify::built_in_rays;
use energywave::{Renderer, Scene};

/// Two tiles wide and high; no multiple of any lane width.
const WIDTH: u32 = 101;
const HEIGHT: u32 = 67;

const WHOLE: Split = Split {
    pixels: u32::MAX,
    sources: u64::MAX,
    shares: u32::MAX,
};

const FORMATS: [FilmFormat; 3] = [
    FilmFormat::Floats,
    FilmFormat::Halves,
    FilmFormat::Image { has_halves: false },
];

/// One source a launch and more, single rows and more, single tiles and more; all at once.
fn splits() -> Vec<Split> {
    let sources = [1, 2, 3, 5, 7].map(|sources| Split { sources, ..WHOLE });
    let pixels = [1, WIDTH, 5 * WIDTH].map(|pixels| Split { pixels, ..WHOLE });
    // The first pass has four tiles, the last up to 256.
    let shares = [2, 3, 9, 64].map(|parts| Split {
        shares: TILE_SHARES.div_ceil(parts),
        ..WHOLE
    });
    let all = Split {
        pixels: 4 * WIDTH,
        sources: 2,
        shares: TILE_SHARES.div_ceil(5),
    };
    [&sources[..], &pixels, &shares, &[all]].concat()
}

fn methods() -> [Method; 3] {
    [
        Method::simpson(16),
        common::by(Sampling::Pixels),
        common::by(Sampling::Tiles),
    ]
}

/// Every pixel has its own random number.
const JITTERED: Method = Method::Jittered {
    divisions: 17,
    seed: 3,
};

/// Points and lines, whose kernels are soon compiled.
fn small_scene() -> Scene {
    let mut scene = common::empty_scene(WIDTH, HEIGHT);
    for k in 0..6 {
        let place = [0.4 - 0.3 * f64::from(k), 0.3, 0.1 * f64::from(k)];
        scene.spheres.push(common::sphere(place, 0.7));
    }
    for k in 0..3 {
        let direction = [1.0, 0.2, 0.3 * f64::from(k)];
        let point = [0.0, 0.6, 0.2];
        scene.cylinders.push(common::cylinder(point, direction));
    }
    scene
}

/// Every kind behind a wall with an edge.
fn full_scene() -> Scene {
    let mut scene = common::full_scene(WIDTH, HEIGHT);
    let wall = |column: u32, row: u32| match column + row {
        ..60 => 4.0 + 0.01 * f64::from(row),
        _ => f64::INFINITY,
    };
    scene.depth = Some(common::depths(&scene, DepthAlong::Ray, wall));
    scene
}

fn drawn(wave: &mut Wave, compute: &Compute, scene: &Scene, format: FilmFormat) -> Vec<Pixel> {
    let mut film = Film::in_format(compute, format, WIDTH, HEIGHT).unwrap();
    draw_wave(wave, compute, scene, &mut film).unwrap();
    let mut pixels = vec![[f32::NAN; 4]; (WIDTH * HEIGHT) as usize];
    film.read(compute, &mut pixels).unwrap();
    pixels
}

/// The bits of a frame cut in every way, and by time, against those of the whole.
fn same_bits_by_every_split(scene: &Scene, methods: &[Method], lanes: u32, formats: &[FilmFormat]) {
    let compute = common::compute();
    let mut wave = Wave::new(&compute, &common::options(lanes, "")).unwrap();
    for (method, format) in methods
        .iter()
        .flat_map(|method| formats.iter().map(move |format| (*method, *format)))
    {
        let mut scene = scene.clone();
        scene.integration.method = method;
        wave.force_split(Some(WHOLE));
        let whole = drawn(&mut wave, &compute, &scene, format);
        let launches = wave.launches();
        assert!(whole.iter().flatten().all(|value| value.is_finite()));
        assert!(whole.iter().any(|pixel| pixel[0] > 0.0 && pixel[0] != 1.0));
        wave.force_split(None);
        let by_time = drawn(&mut wave, &compute, &scene, format);
        assert!(by_time == whole, "{lanes} lanes, {method:?}, {format:?}");
        let mut most = 0;
        for split in splits() {
            wave.force_split(Some(split));
            let found = drawn(&mut wave, &compute, &scene, format);
            let same = found == whole;
            assert!(same, "{lanes} lanes, {method:?}, {format:?}, {split:?}");
            most = most.max(wave.launches());
        }
        assert!(most > 4 * launches, "{method:?}: {most} of {launches}");
    }
}

#[test]
fn a_frame_has_the_same_bits_however_it_is_cut() {
    let own = common::device().lanes;
    let widths = common::lane_widths().into_iter();
    for lanes in widths.filter(|lanes| [1, 4, 16, own].contains(lanes)) {
        let formats = match lanes == own {
            true => &FORMATS[..],
            false => &FORMATS[..1],
        };
        same_bits_by_every_split(&small_scene(), &methods(), lanes, formats);
    }
}

#[test]
fn a_frame_of_every_kind_with_depths_has_the_same_bits_however_it_is_cut() {
    let lanes = common::device().lanes;
    same_bits_by_every_split(&full_scene(), &methods(), lanes, &FORMATS[..1]);
}

#[test]
fn random_numbers_of_pixels_do_not_depend_on_how_a_frame_is_cut() {
    let lanes = common::device().lanes;
    same_bits_by_every_split(&small_scene(), &[JITTERED], lanes, &FORMATS[..1]);
}

#[test]
fn listed_rays_have_the_same_bits_however_they_are_cut() {
    let rays: Vec<_> = built_in_rays().unwrap().iter().map(|it| it.ray).collect();
    let mut renderer = common::renderer(common::device().lanes, "");
    for method in [Method::simpson(16), JITTERED, Method::default()] {
        let mut scene = small_scene();
        scene.integration.method = method;
        let traced = |renderer: &mut Renderer, split| {
            internals::force_split(renderer, Some(split));
            renderer.integrate(&scene, &rays).unwrap()
        };
        let whole = traced(&mut renderer, WHOLE);
        for split in splits() {
            let found = traced(&mut renderer, split);
            assert!(found == whole, "{method:?}, {split:?}");
        }
    }
}

#[test]
fn light_that_is_added_up_from_two_sums_has_other_bits() {
    let compute = common::compute();
    let options = common::options(common::device().lanes, "");
    let mut wave = Wave::new(&compute, &options).unwrap();
    for method in methods() {
        let mut scene = small_scene();
        scene.integration.method = method;
        let (mut first, mut second) = (scene.clone(), scene.clone());
        first.spheres.truncate(4);
        first.cylinders.truncate(0);
        second.spheres.drain(..4);
        let [whole, first, second] =
            [&scene, &first, &second].map(|it| drawn(&mut wave, &compute, it, FORMATS[0]));
        let pairs = first.iter().zip(&second);
        let sums = pairs.map(|(a, b)| [a[0] + b[0], a[1] + b[1], a[2] + b[2], 1.0]);
        let other = sums.zip(&whole).filter(|(sum, whole)| sum != *whole);
        let share = other.count() as f64 / whole.len() as f64;
        assert!(share > 0.1, "{method:?}: {share}");
    }
}
