//! Volumes by rays whose steps are long where light changes little.

use energywave::glam::DVec3;
use energywave::image::RadianceImage;
use energywave::scene::{Volume, VolumeInterpolation, VolumeMethod};
use energywave::volume::{Storage, Texture};
use energywave::{ErrorKind, Renderer, RendererOptions};

use crate::common;
use crate::volumes::{reference, scene};

#[test]
fn a_kernel_with_wrong_points_of_long_steps_is_found_out() {
    let spoiled = common::compiled_with(&RendererOptions::default(), "-D FIRST_POINT=-0.5f");
    let mut renderer = Renderer::with_options(&common::device(), &spoiled).unwrap();
    let error = renderer
        .render(&scene(Storage::Emission))
        .map(drop)
        .unwrap_err();
    assert_eq!(error.kind(), ErrorKind::SelfTest, "{error}");
}

/// Makes light around a ring and a point; of emission, dark beyond a plane.
fn ring(cells: [u32; 3], storage: Storage, channels: u32) -> Texture {
    let plane: u32 = cells.iter().product();
    let light = |index: u32| {
        let (channel, place) = (index / plane, index % plane);
        let cell = [
            place % cells[0],
            place / cells[0] % cells[1],
            place / cells[0] / cells[1],
        ];
        let at = [0, 1, 2].map(|axis| (f64::from(cell[axis]) + 0.5) / f64::from(cells[axis]));
        let at = 2.0 * DVec3::from(at) - 1.0;
        let to_ring = (at.truncate().length() - 0.6).hypot(at.z - 0.05);
        let to_point = at.distance(DVec3::new(0.1, 0.2, 0.4));
        let light =
            1.0 / to_ring.hypot(0.06) + (1.0 + 0.3 * f64::from(channel)) / to_point.hypot(0.06);
        storage.stored(
            if storage == Storage::Emission && cell[1] >= cells[1] * 3 / 4 {
                0.0
            } else {
                light as f32
            },
        )
    };
    Texture::new(cells, (0..channels * plane).map(light).collect(), storage).unwrap()
}

/// Returns the median and the 90th of a hundred of the errors of pixels, of each pixel.
fn relative(one: &RadianceImage, other: &RadianceImage) -> [f32; 2] {
    let pairs = one
        .as_slice()
        .chunks_exact(4)
        .zip(other.as_slice().chunks_exact(4));
    let lit = pairs.filter(|(_, other)| other[0] > 0.0);
    let mut errors: Vec<f32> = lit
        .map(|(one, other)| ((one[0] - other[0]) / other[0]).abs())
        .collect();
    errors.sort_by(f32::total_cmp);
    [errors[errors.len() / 2], errors[errors.len() * 9 / 10]]
}

/// What long steps leave of a pixel's light: of half of the pixels, and of nine of ten.
const LEFT: [f32; 2] = [5e-4, 2e-3];

#[test]
fn long_steps_where_light_changes_little_leave_little() {
    let mut spoiled = common::renderer(1, "-D FIRST_POINT=-0.5f");
    let mut renderers = [
        Renderer::new(&common::device()).unwrap(),
        common::renderer(1, ""),
    ];
    for (storage, channels) in [
        (Storage::Emission, 3),
        (Storage::Reciprocal { power: 2 }, 1),
    ] {
        for interpolation in [VolumeInterpolation::Linear, VolumeInterpolation::Cubic] {
            let mut scene = scene(storage);
            let mut volume = Volume::new(ring([81, 90, 96], storage, channels));
            (volume.size, volume.interpolation) = (DVec3::new(1.7, 1.9, 2.0), interpolation);
            volume.rotation = DVec3::new(10.0, 20.0, 30.0);
            scene.volumes = vec![volume].into();
            scene.integration.volumes = VolumeMethod::Ray { step: 1.0 };
            let expected = reference(&scene);
            for renderer in &mut renderers {
                let off = relative(&renderer.render(&scene).unwrap(), &expected);
                println!("{storage:?}, {interpolation:?}: {off:?}");
                assert!(
                    off[0] < LEFT[0] && off[1] < LEFT[1],
                    "{storage:?}, {interpolation:?}: {off:?}"
                );
            }
            // Points elsewhere are seen: steps are long.
            let wrong = relative(&spoiled.render(&scene).unwrap(), &expected);
            println!("spoiled: {wrong:?}");
            assert!(
                wrong[0] > 2.0 * LEFT[0],
                "{storage:?}, {interpolation:?}: {wrong:?}"
            );
        }
    }
}
