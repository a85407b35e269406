//! Reciprocals beside a rest: next to a core of 1/d what the strongest source gives is the square of a distance, which
//! cubic interpolation has; what the others give there is smooth, and apart.

use std::ops::ControlFlow;

use energywave::glam::DVec3;
use energywave::image::ImageSize;
use energywave::scene::{Camera, Layer, Measure, Profile, Sphere, Torus, Volume, VolumeShape};
use energywave::volume::{CellValue, Grid, Storage, Texture};
use energywave::{Device, ErrorKind, Renderer, RendererOptions, Scene};

use crate::common;
use crate::volumes::difference;

/// What 999 of 1000 rays are off at most, of 256^3 cells: the other eight pass a core at a tenth of a cell.
const MOST: f64 = 4e-3;

/// What float32 leaves of sums of two volumes, of the brightest.
const ERROR: f32 = 2e-4;

fn ring_and_point(eye: DVec3) -> Scene {
    let mut scene = Scene::new(Camera::new(eye, DVec3::ZERO));
    scene.camera.fov_y = 40.0;
    scene.image = ImageSize {
        width: 96,
        height: 96,
    };
    scene.integration.measure = Measure::Length;
    scene.tori.push(Torus {
        profile: Profile::Inverse,
        ..Torus::new(0.6)
    });
    scene.spheres.push(Sphere {
        center: DVec3::new(0.1, 0.2, 0.3),
        profile: Profile::Inverse,
        ..Sphere::default()
    });
    scene
}

fn baked(renderer: &mut Renderer, scene: &Scene, cells: u32, value: CellValue) -> Volume {
    let grid = Grid::new(DVec3::ZERO, DVec3::splat(2.0), cells).unwrap();
    let nothing = &mut |_: f32| ControlFlow::Continue(());
    let cells = renderer.bake(scene, grid, value, nothing).unwrap();
    let storage = scene.reciprocal();
    Volume::new(Texture::of(&cells, storage, scene.one_color()).unwrap())
}

#[test]
fn cubes_of_256_cells_show_rays_beside_cores_within_the_bar() {
    let mut renderer = Renderer::new(&common::device()).unwrap();
    let scene = ring_and_point(DVec3::X);
    assert_eq!(scene.reciprocal_cell_value(), CellValue::Apart);
    let apart = baked(&mut renderer, &scene, 256, CellValue::Apart);
    let together = baked(&mut renderer, &scene, 256, CellValue::Center);
    assert!(apart.texture.rest().is_some() && together.texture.rest().is_none());
    let grid = Grid::new(DVec3::ZERO, DVec3::splat(2.0), 256).unwrap();
    for eye in [[0.7, -3.2, 1.6], [2.5, -2.0, 1.0], [0.0, 0.001, 3.5]] {
        let scene = ring_and_point(DVec3::from(eye));
        let mut error = |drawn: &Volume| {
            let error = renderer.drawn_error(&scene, &grid, drawn).unwrap().unwrap();
            println!("from {eye:?}: {error:?}");
            error
        };
        let (one, other) = (error(&apart), error(&together));
        assert!(one.most < MOST && one.median < 2e-5, "{one:?}");
        assert!(
            other.most > 2.0 * MOST,
            "all in one does as well: {other:?}"
        );
    }
}

#[test]
fn what_is_apart_adds_up_by_rays_and_on_billboards() {
    let mut renderer = Renderer::new(&common::device()).unwrap();
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    let mut scene = ring_and_point(DVec3::new(0.7, -3.2, 1.6));
    scene.image = ImageSize {
        width: 31,
        height: 27,
    };
    scene.spheres[0].color = DVec3::new(0.2, 0.5, 1.0);
    let volume = baked(&mut renderer, &scene, 40, CellValue::Apart);
    let with = |rest: bool| {
        let mut drawn = Scene::new(scene.camera.clone());
        (drawn.image, drawn.integration.measure) = (scene.image, Measure::Length);
        let mut volume = volume.clone();
        if !rest {
            let (texture, storage) = (&volume.texture, Storage::Reciprocal { power: 2 });
            let values = texture.values().to_vec();
            volume.texture = Texture::new(texture.cells(), values, storage).unwrap();
        }
        drawn.volumes.push(volume);
        drawn
    };
    for shape in [VolumeShape::Volume, VolumeShape::Billboard] {
        let mut drawn = [true, false].map(&with);
        drawn.iter_mut().for_each(|it| it.volumes[0].shape = shape);
        let expected = reference.render(&drawn[0]).unwrap();
        let off = drawn.map(|it| difference(&renderer.render(&it).unwrap(), &expected));
        println!("{shape:?}: {off:?}");
        assert!(off[0] < 10.0 * ERROR && off[1] > 0.05, "{shape:?}: {off:?}");
    }
}

#[test]
fn a_kernel_that_parts_light_with_a_kink_is_found_out() {
    let spoiled = common::compiled_with(&RendererOptions::default(), "-D POWER_OF_REST=1");
    let mut renderer = Renderer::with_options(&common::device(), &spoiled).unwrap();
    let scene = ring_and_point(DVec3::X);
    let grid = Grid::new(DVec3::ZERO, DVec3::splat(2.0), 8).unwrap();
    let nothing = &mut |_: f32| ControlFlow::Continue(());
    let error = renderer.bake(&scene, grid, CellValue::Apart, nothing);
    assert_eq!(error.unwrap_err().kind(), ErrorKind::SelfTest);
}

#[test]
fn what_shares_a_core_or_takes_light_away_is_not_apart() {
    let scene = ring_and_point(DVec3::X);
    let mut dark = scene.clone();
    dark.spheres[0].coefficient = -1.0;
    let mut alone = scene.clone();
    alone.tori.pop();
    let mut layered = scene;
    layered.spheres[0].layers = vec![Layer::default(); 2];
    for other in [dark, alone, layered] {
        assert_eq!(other.reciprocal_cell_value(), CellValue::Center);
    }
}
