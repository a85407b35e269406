//! Pixels that are means over their squares, against the means of 16x16 rays a pixel.

use crate::common::{self, CURVE_SHAPES, device, far_beyond_target, renderer, sampled};
use energywave::image::{ClipRange, ImageSize, RadianceImage};
use energywave::scene::{
    Antialias, Beam, Camera, Curve, Cylinder, LightPath, Measure, Method, PathShape, Profile,
    Sampling, Segment, Sphere, Torus,
};
use energywave::{Scene, reference};
use glam::dcamera as camera;
use glam::{DMat4, DVec3};

/// Width and height, and rays a side of a pixel.
const SIZE: u32 = 120;
const RAYS: u32 = 16;

/// How far a mean may be off, and how many pixels may be farther.
const MOST_ERROR: f64 = 1e-2;
const MOST_WRONG: f64 = 1e-3;

fn empty(size: u32) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.3, -3.5, 2.0), DVec3::ZERO));
    scene.camera.ray_length = Some(far_beyond_target(&scene.camera));
    (scene.image.width, scene.image.height) = (size, size);
    scene
}

/// A scene of one source of each kind that a device draws by a way of its own.
fn scenes(profile: Profile, radius: f64, reach: Option<f64>) -> Vec<(&'static str, Scene)> {
    macro_rules! scene {
        ($list:ident, $source:expr) => {{
            let mut scene = empty(SIZE);
            let mut source = $source;
            (source.profile, source.radius, source.reach) = (profile, radius, reach);
            scene.$list.push(source);
            (stringify!($list), scene)
        }};
    }
    let [from, control, to] = CURVE_SHAPES[0].map(DVec3::from);
    let right = DVec3::new(1.0, 0.3, 0.35);
    vec![
        scene!(
            spheres,
            Sphere {
                center: DVec3::new(0.2, 0.3, 0.1),
                ..Sphere::default()
            }
        ),
        scene!(
            cylinders,
            Cylinder {
                point: DVec3::new(0.0, 0.0, 0.1),
                ..Cylinder::new(right)
            }
        ),
        scene!(
            beams,
            Beam {
                tip: DVec3::new(-0.5, 0.0, 0.2),
                ..Beam::new(right)
            }
        ),
        scene!(
            segments,
            Segment::new(DVec3::new(-0.6, 0.0, -0.3), DVec3::new(0.5, 0.4, 0.6))
        ),
        scene!(
            tori,
            Torus {
                axis: DVec3::new(0.2, -1.0, 0.6),
                ..Torus::new(0.8)
            }
        ),
        scene!(curves, Curve::new([from, control, to])),
        scene!(
            paths,
            LightPath {
                shape: PathShape::Quadratic,
                ..LightPath::new(vec![from, control, to])
            }
        ),
    ]
}

/// Returns the means of many rays.
fn means(scene: &Scene) -> RadianceImage {
    let mut fine = scene.clone();
    let size = scene.image;
    fine.image = ImageSize {
        width: RAYS * size.width,
        height: RAYS * size.height,
    };
    fine.integration.antialias = Antialias::None;
    fine.integration.method = Method::exact(1e-3);
    let rays = renderer(device().lanes, "").render(&fine).unwrap();
    let mut image = RadianceImage::new(size).unwrap();
    let share = 1.0 / (RAYS * RAYS) as f32;
    for (i, light) in rays.as_slice().chunks(4).enumerate() {
        let (column, row) = (i as u32 % fine.image.width, i as u32 / fine.image.width);
        let pixel = (row / RAYS * size.width + column / RAYS) as usize;
        for (sum, value) in image.as_mut_slice()[4 * pixel..].iter_mut().zip(light) {
            *sum += share * value;
        }
    }
    image
}

/// Light below this share of the brightest is measured by it; where light ends 256 rays tell little of a pixel of which
/// a corner is lit.
const LEAST_LIGHT: f32 = 1e-6;
const LEAST_BEFORE_END: f32 = 1e-3;

/// Returns the share of pixels that are off by more than is allowed.
fn wrong(image: &RadianceImage, truth: &RadianceImage, least: f32) -> f64 {
    let brightest = truth
        .as_slice()
        .chunks(4)
        .map(|pixel| pixel[1])
        .fold(0.0, f32::max);
    let pixels = image.as_slice().chunks(4).zip(truth.as_slice().chunks(4));
    let is_wrong = |(found, expected): (&[f32], &[f32])| {
        let error = f64::from((found[1] - expected[1]).abs());
        error.is_nan() || error > MOST_ERROR * f64::from(expected[1].max(least * brightest))
    };
    let count = pixels.filter(|pair| is_wrong(*pair)).count();
    count as f64 / image.size().pixels() as f64
}

#[test]
fn pixels_are_the_means_of_many_rays() {
    // A tenth of a pixel thick, but for 1/q, whose mean is finite without.
    let thin = 0.003;
    // One profile with every kind, the others with a point, a line that ends and a ring: each pair is two programs.
    let few = &["spheres", "segments", "tori"];
    let shapes: [(Profile, f64, Option<f64>, &[&str]); 7] = [
        (Profile::Inverse, 0.0, None, few),
        (Profile::InverseSquare, thin, None, &[]),
        (Profile::InverseCube, 4.0 * thin, None, few),
        (Profile::Inverse, 4.0 * thin, Some(0.3), &["segments"]),
        (
            Profile::InverseSquare,
            4.0 * thin,
            Some(0.25),
            &["spheres", "segments"],
        ),
        (Profile::InverseCube, 5.0 * thin, Some(0.2), &["tori"]),
        (Profile::Gaussian, 15.0 * thin, None, &["tori"]),
    ];
    let mut renderer = renderer(device().lanes, "");
    for (profile, radius, reach, kinds) in shapes {
        let all = scenes(profile, radius, reach).into_iter();
        let some = all.filter(|(name, _)| kinds.is_empty() || kinds.contains(name));
        for (name, scene) in some {
            let least = match (reach, profile) {
                (None, Profile::Gaussian) | (Some(_), _) => LEAST_BEFORE_END,
                _ => LEAST_LIGHT,
            };
            let truth = means(&scene);
            // By pixels, and along one ray, for one profile: every scene is a program each time.
            let is_plain = profile == Profile::InverseSquare;
            for sampling in [Sampling::Tiles, Sampling::Pixels] {
                if sampling == Sampling::Pixels && !is_plain {
                    continue;
                }
                let image = renderer.render(&sampled(&scene, sampling)).unwrap();
                let share = wrong(&image, &truth, least);
                assert!(
                    share <= MOST_WRONG,
                    "{name} {profile:?} {sampling:?}: {share}"
                );
            }
            if name == "spheres" || !is_plain {
                continue; // of the point too few pixels
            }
            let mut one_ray = scene.clone();
            one_ray.integration.antialias = Antialias::None;
            let share = wrong(&renderer.render(&one_ray).unwrap(), &truth, least);
            assert!(
                share > 5.0 * MOST_WRONG,
                "{name} {profile:?}: one ray is no worse: {share}"
            );
        }
    }
}

/// The middle of the scene as a camera sees it whose rays are all parallel, its pixels about as large.
fn by_parallel_rays(scene: &Scene) -> Scene {
    let view = camera::rh::view::look_at_mat4(scene.camera.eye, DVec3::ZERO, DVec3::Z);
    let side = 1.2;
    let projection = DMat4::from_diagonal((1.0 / side, 1.0 / side, -0.1, 1.0).into());
    let mut scene = scene.clone();
    let ray_length = scene.camera.ray_length;
    (scene.image.width, scene.image.height) = (3 * SIZE / 4, 3 * SIZE / 4);
    scene.camera = Camera::from_clip(view, projection, ClipRange::ZeroToOne);
    scene.camera.ray_length = ray_length;
    assert!(scene.view_plane().is_parallel);
    scene
}

#[test]
fn pixels_of_parallel_rays_are_their_means_too() {
    let mut renderer = renderer(device().lanes, "");
    // A point, a line that ends, a circle and a curve: how rays spread is the same for all others.
    let kinds = ["spheres", "beams", "tori", "curves"];
    let all = scenes(Profile::InverseSquare, 0.003, None).into_iter();
    for (name, scene) in all.filter(|(name, _)| kinds.contains(name)) {
        let parallel = by_parallel_rays(&scene);
        let truth = means(&parallel);
        for sampling in [Sampling::Pixels, Sampling::Tiles] {
            let image = renderer.render(&sampled(&parallel, sampling)).unwrap();
            let share = wrong(&image, &truth, LEAST_LIGHT);
            assert!(share <= MOST_WRONG, "{name} {sampling:?}: {share}");
        }
        let mut converging = scene.clone();
        converging.image = parallel.image;
        let converging = renderer.render(&converging).unwrap();
        assert!(
            wrong(&converging, &truth, LEAST_LIGHT) > 0.5,
            "{name}: as if from an eye"
        );
        if name == "spheres" {
            continue; // too few pixels
        }
        let mut one_ray = parallel.clone();
        one_ray.integration.antialias = Antialias::None;
        let share = wrong(&renderer.render(&one_ray).unwrap(), &truth, LEAST_LIGHT);
        assert!(
            share > 5.0 * MOST_WRONG,
            "{name}: one ray is no worse: {share}"
        );
    }
}

#[test]
fn pixels_are_cut_where_a_core_bends_or_another_part_of_it_is_near() {
    let mut scene = empty(64);
    scene.camera.eye = DVec3::new(0.0, -4.0, 2.0);
    let mut ring = Torus::new(0.7);
    (ring.axis, ring.radius) = (DVec3::new(0.2, 0.5, 1.0), 0.015);
    ring.profile = Profile::InverseSquare;
    scene.tori.push(ring);
    scene.paths.push(LightPath {
        shape: PathShape::Spline,
        profile: Profile::InverseSquare,
        radius: 0.02,
        ..LightPath::new(vec![
            DVec3::new(-0.8, 0.0, 0.5),
            DVec3::new(0.6, 0.1, 0.45),
            DVec3::new(-0.6, 0.0, 0.3),
            DVec3::new(0.7, 0.3, -0.2),
            DVec3::new(-0.2, 0.0, -0.5),
        ])
    });
    let truth = means(&scene);
    let share = |options: &str| {
        let image = renderer(device().lanes, options).render(&scene).unwrap();
        wrong(&image, &truth, LEAST_LIGHT)
    };
    // What is left are the two or three pixels of each bend.
    let (cut, whole) = (share(""), share("-D HALVED_FROM=1e9f"));
    assert!(cut < 6e-3 && whole > 4.0 * cut, "{cut} {whole}");
}

#[test]
fn the_reference_takes_means_of_its_own() {
    for (name, mut scene) in scenes(Profile::InverseSquare, 0.02, None) {
        (scene.image.width, scene.image.height) = (32, 32);
        scene.integration.method = Method::exact(1e-4);
        let found = renderer(device().lanes, "").render(&scene).unwrap();
        let expected = reference::render(&scene).unwrap();
        // Where so few pixels see much of a core it is not straight, and its end neither a line nor a point.
        let difference = common::difference(&found, &expected);
        let bent = if name == "spheres" { 0.0 } else { 0.05 };
        let share = wrong(&found, &expected, LEAST_LIGHT);
        assert!(
            share <= bent && difference.max < 0.2,
            "{name}: {share} {difference:?}"
        );
        let mut one_ray = scene.clone();
        one_ray.integration.antialias = Antialias::None;
        let difference = common::difference(&reference::render(&one_ray).unwrap(), &expected);
        assert!(difference.max > 0.05, "{name}: {difference:?}");
    }
}

/// A beam that moves by tenths of a pixel across the image's columns.
fn moving_beam(antialias: Antialias) -> Vec<RadianceImage> {
    let mut scene = empty(48);
    scene.camera = Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO);
    scene.integration.measure = Measure::Length;
    scene.integration.antialias = antialias;
    let pixel = 2.0 * 4.0 * (22.5_f64).to_radians().tan() / 48.0;
    let mut renderer = renderer(device().lanes, "");
    (0..10)
        .map(|tenth| {
            let tip = DVec3::new(-5.0, 0.0, 0.1 * pixel * f64::from(tenth));
            let mut beam = Beam::new(DVec3::X);
            beam.tip = tip;
            beam.profile = Profile::InverseSquare;
            scene.beams = vec![beam].into();
            renderer.render(&scene).unwrap()
        })
        .collect()
}

/// Returns the largest share of the least, of what each image has.
fn spread(images: &[RadianceImage], of: impl Fn(&[f32]) -> f32) -> f32 {
    let column = |image: &RadianceImage| -> Vec<f32> {
        (0..48)
            .map(|row| image.pixel(24, row).unwrap()[1])
            .collect()
    };
    let values: Vec<f32> = images.iter().map(|image| of(&column(image))).collect();
    let most = values.iter().copied().fold(0.0, f32::max);
    most / values.iter().copied().fold(f32::INFINITY, f32::min)
}

#[test]
fn a_beam_that_moves_by_tenths_of_a_pixel_does_not_flicker() {
    let brightest = |column: &[f32]| column.iter().copied().fold(0.0, f32::max);
    let sum = |column: &[f32]| column.iter().sum::<f32>();
    let means = moving_beam(Antialias::Footprint);
    assert!(
        spread(&means, brightest) < 2.5,
        "{}",
        spread(&means, brightest)
    );
    assert!(spread(&means, sum) < 1.01, "{}", spread(&means, sum));
    let rays = moving_beam(Antialias::None);
    assert!(spread(&rays, brightest) > 6.0 && spread(&rays, sum) > 2.0);
}

#[test]
fn slanted_lines_have_no_beads() {
    let mut scene = empty(64);
    scene.camera = Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO);
    let mut line = Cylinder::new(DVec3::new(1.0, 0.0, 0.13));
    line.profile = Profile::InverseSquare;
    scene.cylinders.push(line);
    let mut renderer = renderer(device().lanes, "");
    // The brightest pixel of a column and both its neighbours hold nearly all of the core's light.
    let mut beads = |antialias: Antialias| {
        scene.integration.antialias = antialias;
        let image = renderer.render(&scene).unwrap();
        let along = (8..56).map(|column| {
            let light = |row: u32| image.pixel(column, row).unwrap()[1];
            let row = (1..63)
                .max_by(|a, b| light(*a).total_cmp(&light(*b)))
                .unwrap();
            light(row - 1) + light(row) + light(row + 1)
        });
        let along: Vec<f32> = along.collect();
        let most = along.iter().copied().fold(0.0, f32::max);
        most / along.iter().copied().fold(f32::INFINITY, f32::min)
    };
    let of_means = beads(Antialias::Footprint);
    assert!(of_means < 1.15, "{of_means}");
    assert!(beads(Antialias::None) > 2.0);
}

/// By how much of itself all light of a core without a radius may change where its rays are led away from it: its mean
/// is that of one a sixty-fourth of a pixel thick.
const MOST_CHANGE_OF_BARE: f64 = 0.1;

/// By how much of itself all light of a beam that is seen in the middle of the picture changes, where the rays of a
/// column of pixels meet it exactly.
fn change_where_met(options: &str) -> f64 {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenes/2006-figure-5-3-40.toml"
    );
    let mut scene = Scene::from_file(file).unwrap();
    scene.beams[0].radius = 0.0;
    (scene.image.width, scene.image.height) = (128, 128);
    scene.integration.antialias = Antialias::Footprint;
    let mut renderer = renderer(device().lanes, options);
    let mut light = |right: f64| {
        scene.camera.jitter.x = right;
        let image = renderer.render(&sampled(&scene, Sampling::Pixels)).unwrap();
        let pixels = image.as_slice().iter();
        pixels.map(|value| f64::from(*value)).sum::<f64>()
    };
    let (beside, met) = (light(0.4), light(0.5));
    (met / beside - 1.0).abs()
}

#[test]
fn a_line_that_rays_meet_exactly_is_as_bright_as_one_beside_them() {
    let change = change_where_met("");
    assert!(change < MOST_CHANGE_OF_BARE, "{change}");
    let spoiled = change_where_met("-D ALONG_ROUNDED=0.0f");
    assert!(spoiled > 1.0, "{spoiled}");
}
