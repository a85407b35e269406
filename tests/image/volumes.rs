//! Volumes: rays through them get the integral that the reference takes, however cells are stored and interpolated;
//! slices approach it as they grow more; and what is turned looks another.

use energywave::glam::DVec3;
use energywave::image::{DepthAlong, DepthImage, ImageSize, RadianceImage};
use energywave::scene::{
    Antialias, Camera, Decay, Sphere, Volume, VolumeInterpolation, VolumeMethod, VolumeShape,
};
use energywave::volume::{Storage, Texture};
use energywave::{Device, ErrorKind, Renderer, RendererOptions, Scene};

use crate::common;

/// Of the brightest: what middles of short pieces leave of an integral through kinks at every cell.
const ERROR: f32 = 2e-4;

/// Of the brightest: what so many slices leave.
const ERROR_OF_SLICES: f32 = 1e-3;

const CELLS: [u32; 3] = [20, 24, 18];

/// Makes a cloud that is dark at the box's faces, RGB; as reciprocals it is the inverse of a distance to a point.
fn texture(storage: Storage) -> Texture {
    let plane: u32 = CELLS.iter().product();
    let value = |index: u32| {
        let (channel, place) = (index / plane, index % plane);
        let cell = [
            place % CELLS[0],
            place / CELLS[0] % CELLS[1],
            place / CELLS[0] / CELLS[1],
        ];
        let at = [0, 1, 2].map(|axis| (f64::from(cell[axis]) + 0.5) / f64::from(CELLS[axis]));
        let at = 2.0 * DVec3::from(at) - 1.0;
        let away2 = (at - DVec3::new(0.1, -0.05, 0.2)).length_squared();
        let light = match storage {
            Storage::Emission => {
                let lobe = (-9.0 * away2).exp() * (1.0 + 0.5 * (9.0 * at.x).sin());
                let rim = at.abs().max_element();
                lobe * (1.0 - rim.powi(4)) * (1.0 - 0.2 * f64::from(channel))
            }
            _ => 1.0 / away2.sqrt(),
        };
        storage.stored(light as f32)
    };
    Texture::new(CELLS, (0..3 * plane).map(value).collect(), storage).unwrap()
}

pub fn scene(storage: Storage) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.4, -4.0, 1.2), DVec3::ZERO));
    scene.image = ImageSize {
        width: 45,
        height: 37,
    };
    scene.integration.volumes = VolumeMethod::Ray { step: 0.1 };
    let mut volume = Volume::new(texture(storage));
    volume.size = DVec3::new(1.6, 2.0, 1.4);
    volume.rotation = DVec3::new(-20.0, 35.0, 70.0);
    volume.color = DVec3::new(0.9, 0.7, 0.5);
    scene.volumes.push(volume);
    scene
}

pub fn reference(scene: &Scene) -> RadianceImage {
    Renderer::new(&Device::reference())
        .unwrap()
        .render(scene)
        .unwrap()
}

/// Returns the greatest difference of any pixel, and the greatest light.
pub fn difference(one: &RadianceImage, other: &RadianceImage) -> f32 {
    let pairs = one.as_slice().iter().zip(other.as_slice());
    let worst = pairs
        .map(|(one, other)| (one - other).abs())
        .fold(0.0, f32::max);
    let colors = other
        .as_slice()
        .chunks_exact(4)
        .flat_map(|pixel| &pixel[..3]);
    worst / colors.fold(0.0_f32, |most, it| most.max(*it))
}

#[test]
fn rays_get_the_integral_of_what_is_interpolated() {
    let mut renderers = [
        Renderer::new(&common::device()).unwrap(),
        common::renderer(1, ""),
    ];
    for storage in [Storage::Emission, Storage::Reciprocal { power: 2 }] {
        for interpolation in [VolumeInterpolation::Linear, VolumeInterpolation::Cubic] {
            let mut scene = scene(storage);
            scene.volumes[0].interpolation = interpolation;
            if interpolation == VolumeInterpolation::Cubic {
                scene.decay = Some(Decay::new(0.5, 0.2));
                let depths =
                    (0..45 * 37).map(|pixel| if pixel % 45 < 20 { 4.1 } else { f32::INFINITY });
                let depth = DepthImage::new(scene.image, DepthAlong::Ray, depths.collect());
                scene.depth = Some(depth.unwrap());
            }
            let expected = reference(&scene);
            for renderer in &mut renderers {
                let error = difference(&renderer.render(&scene).unwrap(), &expected);
                println!("{storage:?}, {interpolation:?}: {error:.1e}");
                assert!(error < ERROR, "{storage:?}, {interpolation:?}: {error}");
            }
            // A scene that is turned a little is another.
            scene.volumes[0].rotation.x += 1.0;
            let other = renderers[0].render(&scene).unwrap();
            assert!(difference(&other, &expected) > ERROR);
        }
    }
}

#[test]
fn texels_of_images_give_what_cells_in_buffers_do() {
    let with = |options: RendererOptions| {
        let mut options = options;
        options.volume_images = Some(true);
        Renderer::with_options(&common::device(), &options).unwrap()
    };
    let mut buffers = Renderer::new(&common::device()).unwrap();
    // These show that they are right before they draw; those that read the next cell show that they are not.
    let mut images = [
        with(RendererOptions::default()),
        with(common::options(1, "")),
    ];
    let spoiled = common::compiled_with(&RendererOptions::default(), "-D NEXT_TEXEL=1");
    let error = with(spoiled).render(&scene(Storage::Emission)).map(drop);
    assert_eq!(error.unwrap_err().kind(), ErrorKind::SelfTest);
    for (cells, storage) in [
        (CELLS, Storage::Emission),
        (CELLS, Storage::Reciprocal { power: 2 }),
        ([5, 1, 3], Storage::Emission),
    ] {
        for interpolation in [VolumeInterpolation::Linear, VolumeInterpolation::Cubic] {
            let mut scene = scene(storage);
            if cells != CELLS {
                let values = (0..45).map(|it| (it * 7 % 11 + 1) as f32).collect();
                scene.volumes[0].texture = Texture::new(cells, values, storage).unwrap();
            }
            scene.volumes[0].interpolation = interpolation;
            let expected = [buffers.render(&scene).unwrap(), reference(&scene)];
            for renderer in &mut images {
                let found = renderer.render(&scene).unwrap();
                let off = [0, 1].map(|it| difference(&found, &expected[it]));
                println!("{cells:?}, {storage:?}, {interpolation:?}: {off:?}");
                assert!(
                    off[0] < 1e-5 && off[1] < 5.0 * ERROR,
                    "{storage:?}, {interpolation:?}: {off:?}"
                );
            }
        }
    }
}

#[test]
fn slices_approach_the_integral_as_they_grow_more() {
    let mut renderer = Renderer::new(&common::device()).unwrap();
    let mut scene = scene(Storage::Emission);
    let expected = reference(&scene);
    let mut errors = Vec::new();
    for count in [8, 32, 256, 1024] {
        scene.integration.volumes = VolumeMethod::Slices { count };
        errors.push(difference(&renderer.render(&scene).unwrap(), &expected));
    }
    println!("{errors:?}");
    assert!(errors[3] < ERROR_OF_SLICES, "{errors:?}");
    assert!(
        errors[0] > 10.0 * ERROR_OF_SLICES,
        "few slices pass, too: {errors:?}"
    );
}

#[test]
fn a_kernel_that_sums_beside_the_middles_is_found_out() {
    let spoiled = common::compiled_with(&RendererOptions::default(), "-D MIDDLE=0.9f");
    let mut renderer = Renderer::with_options(&common::device(), &spoiled).unwrap();
    let error = renderer
        .render(&scene(Storage::Emission))
        .map(drop)
        .unwrap_err();
    assert_eq!(error.kind(), ErrorKind::SelfTest, "{error}");
    assert!(
        error.to_string().contains("the light of a volume"),
        "{error}"
    );
}

#[test]
fn a_volume_of_ones_gives_the_length_of_each_ray_in_its_box() {
    let mut renderer = Renderer::new(&common::device()).unwrap();
    let mut scene = scene(Storage::Emission);
    let mut volume =
        Volume::new(Texture::new([3, 2, 5], vec![1.0; 30], Storage::Emission).unwrap());
    (volume.size, volume.rotation) = (DVec3::new(1.0, 0.5, 1.5), DVec3::new(10.0, 0.0, 25.0));
    scene.volumes = vec![volume.clone()].into();
    let image = renderer.render(&scene).unwrap();
    let plane = scene.view_plane();
    let light: f32 = image.as_slice().chunks_exact(4).map(|pixel| pixel[0]).sum();
    let inside = |point: DVec3| {
        let turn = |angle: f64| energywave::glam::DQuat::from_rotation_z(angle.to_radians());
        let place = turn(-25.0) * point;
        let place = energywave::glam::DQuat::from_rotation_x(-10.0_f64.to_radians()) * place;
        (place.abs().cmple(0.5 * volume.size)).all()
    };
    let mut expected = 0.0;
    for pixel in 0..45 * 37 {
        let ray = plane.ray(pixel % 45, pixel / 45);
        let lit = (0..2000).filter(|k| inside(ray.at((f64::from(*k) + 0.5) / 2000.0)));
        expected += ray.span.length() * lit.count() as f64 / 2000.0;
    }
    println!("{light} {expected}");
    assert!((f64::from(light) - expected).abs() < 1e-3 * expected);
}

#[test]
fn grids_of_few_cells_are_read_within_their_edges() {
    let mut renderers = [
        Renderer::new(&common::device()).unwrap(),
        common::renderer(1, ""),
    ];
    for cells in [
        [1, 1, 1],
        [1, 2, 3],
        [2, 1, 4],
        [3, 5, 1],
        [4, 3, 2],
        [70, 2, 3],
    ] {
        for interpolation in [VolumeInterpolation::Linear, VolumeInterpolation::Cubic] {
            let count: u32 = cells.iter().product();
            let values = (0..count).map(|it| (it * 7 % 11 + 1) as f32).collect();
            let mut scene = scene(Storage::Emission);
            scene.image = ImageSize {
                width: 17,
                height: 13,
            };
            let mut volume = Volume::new(Texture::new(cells, values, Storage::Emission).unwrap());
            (volume.size, volume.interpolation) = (DVec3::new(1.6, 2.0, 1.4), interpolation);
            scene.volumes = vec![volume].into();
            scene.integration.volumes = VolumeMethod::Ray { step: 0.01 };
            let expected = reference(&scene);
            for renderer in &mut renderers {
                let error = difference(&renderer.render(&scene).unwrap(), &expected);
                println!("{cells:?}, {interpolation:?}: {error:.1e}");
                assert!(error < ERROR, "{cells:?}, {interpolation:?}: {error}");
            }
            scene.volumes[0].rotation.x += 5.0;
            let other = renderers[0].render(&scene).unwrap();
            assert!(
                difference(&other, &expected) > ERROR,
                "a turned one is the same"
            );
        }
    }
}

/// Makes a beam along z, as figure 5.4 of Sakai 2006 turns it, seen from -y.
fn turned(degrees: f64, shape: VolumeShape) -> Scene {
    let cells = [12_u32, 12, 36];
    let value = |index: u32| {
        let at = [index % 12, index / 12 % 12, index / 144];
        let [x, y, z] =
            [0, 1, 2].map(|axis| (f64::from(at[axis]) + 0.5) / f64::from(cells[axis]) * 2.0 - 1.0);
        ((-6.0 * (x * x + y * y)).exp() * (1.0 - z.powi(8)) * (1.0 + 0.3 * z)) as f32
    };
    let values = (0..12 * 12 * 36).map(value).collect();
    let mut volume = Volume::new(Texture::new(cells, values, Storage::Emission).unwrap());
    (volume.rotation.x, volume.shape) = (degrees, shape);
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -8.0, 0.0), DVec3::ZERO));
    scene.image = ImageSize {
        width: 45,
        height: 37,
    };
    scene.camera.fov_y = 20.0;
    scene.volumes.push(volume);
    scene
}

#[test]
fn a_volume_that_is_turned_grows_brighter_and_a_billboard_does_not() {
    let mut renderer = Renderer::new(&common::device()).unwrap();
    let mut draw = |degrees: f64, shape| renderer.render(&turned(degrees, shape)).unwrap();
    let brightest = |image: &RadianceImage| {
        let lights = image.as_slice().chunks_exact(4).map(|it| it[0]);
        lights.fold(0.0, f32::max)
    };
    let front = draw(0.0, VolumeShape::Volume);
    let plate = draw(0.0, VolumeShape::Billboard);
    let expected = reference(&turned(0.0, VolumeShape::Billboard));
    let error = difference(&plate, &expected);
    println!(
        "against the reference {error:.1e}, the volume from the front {:.1e}",
        difference(&plate, &front)
    );
    assert!(error < ERROR, "{error}");
    // From the front they look alike, but for perspective.
    assert!(difference(&plate, &front) < 0.1);
    let mut last = brightest(&front);
    for degrees in [-20.0, -40.0, -60.0] {
        let volume = draw(degrees, VolumeShape::Volume);
        assert_eq!(draw(degrees, VolumeShape::Billboard), plate, "{degrees}");
        let gain = brightest(&volume) / brightest(&plate);
        println!("{degrees} degrees: the volume is {gain:.2} times as bright as the billboard");
        assert!(
            brightest(&volume) > 1.02 * last && difference(&volume, &front) > 0.3,
            "{degrees}: {gain}"
        );
        last = brightest(&volume);
    }
    assert!(last > 1.5 * brightest(&plate));
}

#[test]
fn single_rays_are_given_the_light_of_volumes() {
    let mut renderers = [
        Renderer::new(&common::device()).unwrap(),
        Renderer::new(&Device::reference()).unwrap(),
    ];
    for shape in [VolumeShape::Volume, VolumeShape::Billboard] {
        let mut scene = scene(Storage::Emission);
        scene.decay = Some(Decay::new(0.5, 0.2));
        scene.volumes[0].shape = shape;
        scene.spheres.push(Sphere {
            radius: 0.5,
            coefficient: 0.02,
            ..Sphere::default()
        });
        scene.integration.antialias = Antialias::None;
        let shown = renderers[0].render(&scene).unwrap();
        let plane = scene.view_plane();
        let pixels: Vec<u32> = (0..45 * 37).step_by(17).collect();
        let brightest = shown
            .as_slice()
            .iter()
            .fold(0.0_f32, |most, it| most.max(*it));
        for renderer in &mut renderers {
            let worst = [0, 1].map(|aside| {
                let rays = pixels.iter().map(|it| plane.ray(it % 45 + aside, it / 45));
                let lights = renderer
                    .integrate(&scene, &rays.collect::<Vec<_>>())
                    .unwrap();
                let pairs = lights.iter().zip(&pixels);
                let off = pairs.map(|(light, pixel)| {
                    let pixel = &shown.as_slice()[4 * *pixel as usize..][..3];
                    let off = |(light, shown): (&f64, &f32)| (*light as f32 - shown).abs();
                    light.iter().zip(pixel).map(off).fold(0.0, f32::max)
                });
                off.fold(0.0, f32::max) / brightest
            });
            println!("{shape:?}: {worst:?}");
            assert!(worst[0] < ERROR && worst[1] > ERROR, "{shape:?}: {worst:?}");
        }
    }
}
