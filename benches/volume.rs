//! The speed of volumes: frames of a texture of 256^3 cells, float32, at 512x512 by rays, however cells are stored and
//! interpolated, and the bake of one from twenty sources. On a machine that others use, the time of the processor says
//! more than that of the clock; it is that of all cores, divided by their number.
//! `cargo bench --bench volume`
#![allow(clippy::unwrap_used)] // a bench that fails stops

mod common;

use std::ops::ControlFlow;
use std::time::Instant;

use energywave::glam::DVec3;
use energywave::image::ImageSize;
use energywave::scene::{
    Camera, Measure, Profile, Segment, Sphere, Torus, Volume, VolumeInterpolation, VolumeMethod,
};
use energywave::volume::{CellValue, Grid, Storage, Texture};
use energywave::{Renderer, Scene};

const CELLS: u32 = 256;

/// Frames that are timed, after one that is not.
const FRAMES: u32 = 3;

/// What was spent, of the clock and of each core, s.
struct Spent {
    clock: f64,
    core: f64,
}

/// Returns what the process has used of all cores, s; 0 where `/proc` is not there.
fn used() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace();
    // Behind the name: the 12th and the 13th, in hundredths.
    let ticks: f64 = fields
        .skip(11)
        .take(2)
        .filter_map(|it| it.parse::<f64>().ok())
        .sum();
    ticks / 100.0
}

fn spent(cores: u32, mut work: impl FnMut()) -> Spent {
    let (begun, before) = (Instant::now(), used());
    work();
    Spent {
        clock: begun.elapsed().as_secs_f64(),
        core: (used() - before) / f64::from(cores),
    }
}

fn camera(turn: f64) -> Camera {
    let mut camera = Camera::new(
        DVec3::new(3.3 * turn.sin(), -3.3 * turn.cos(), 1.6),
        DVec3::ZERO,
    );
    camera.fov_y = 40.0;
    camera
}

/// A ring and a point, which fall off with the distance.
fn ring_and_point() -> Scene {
    let mut scene = Scene::new(camera(0.2));
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

/// Twenty sources of three kinds and of several colours.
fn twenty_sources() -> Scene {
    let mut scene = Scene::new(camera(0.2));
    for number in 0..20 {
        let turn = f64::from(number);
        let place = 0.7 * DVec3::new(turn.sin(), turn.cos(), (1.7 * turn).sin());
        let color = DVec3::new(1.0, 0.5, 0.2 + 0.04 * turn);
        match number % 3 {
            0 => scene.spheres.push(Sphere {
                center: place,
                radius: 0.05,
                color,
                ..Sphere::default()
            }),
            1 => scene.segments.push(Segment {
                radius: 0.05,
                color,
                ..Segment::new(place, -0.3 * place)
            }),
            _ => scene.tori.push(Torus {
                center: 0.5 * place,
                radius: 0.05,
                color,
                ..Torus::new(0.3)
            }),
        }
    }
    scene
}

fn bake(renderer: &mut Renderer, scene: &Scene, value: CellValue) -> energywave::volume::Volume {
    let grid = Grid::new(DVec3::ZERO, DVec3::splat(2.0), CELLS).unwrap();
    let progress = &mut |_: f32| ControlFlow::Continue(());
    renderer.bake(scene, grid, value, progress).unwrap()
}

fn main() {
    let (device, mut renderer) = common::device();
    let cores = device.compute_units.max(1);
    println!("{}", common::header(&device, "cargo bench --bench volume"));
    let scene = twenty_sources();
    bake(&mut renderer, &scene, CellValue::Center);
    let took = spent(cores, || {
        drop(bake(&mut renderer, &scene, CellValue::Center))
    });
    println!(
        "bake of {CELLS}^3 cells from 20 sources: {:.2} s, {:.2} s of each core\n",
        took.clock, took.core
    );
    let scene = ring_and_point();
    let volume = bake(&mut renderer, &scene, CellValue::Center);
    println!(
        "| 512x512 from {CELLS}^3 cells | channels | ms | ms of each core | FPS of the cores |\n\
         |---|---|---|---|---|"
    );
    let table = Table {
        only: std::env::args().skip(1).find(|it| !it.starts_with('-')),
        cores,
    };
    for (color, channels) in [(scene.one_color(), 1), (None, 3)] {
        for storage in [Storage::Emission, Storage::Reciprocal { power: 2 }] {
            let mut texture = Texture::of(&volume, storage, color).unwrap();
            if channels == 3 {
                texture = tinted(&texture);
            }
            for interpolation in [VolumeInterpolation::Linear, VolumeInterpolation::Cubic] {
                let name = format!("{storage:?}, {interpolation:?}");
                table.row(&mut renderer, &name, &texture, interpolation);
            }
        }
    }
    let apart = bake(&mut renderer, &scene, CellValue::Apart);
    let texture = Texture::of(&apart, scene.reciprocal(), scene.one_color()).unwrap();
    let name = "Reciprocal beside a rest, Cubic";
    table.row(&mut renderer, name, &texture, VolumeInterpolation::Cubic);
}

/// Which rows are printed, and of how many cores.
struct Table {
    only: Option<String>,
    cores: u32,
}

impl Table {
    fn row(
        &self,
        renderer: &mut Renderer,
        name: &str,
        texture: &Texture,
        interpolation: VolumeInterpolation,
    ) {
        let channels = texture.channels();
        let label = format!("{name} {channels}");
        let is_other = |only: &String| !label.contains(only.as_str());
        if self.only.as_ref().is_some_and(is_other) {
            return;
        }
        let took = frames(renderer, self.cores, texture, interpolation);
        let (clock, core) = (1e3 * took.clock, 1e3 * took.core);
        println!(
            "| {name} | {channels} | {clock:.0} | {core:.0} | {:.1} |",
            1e3 / core
        );
    }
}

/// Makes the same with three channels that differ.
fn tinted(texture: &Texture) -> Texture {
    let count = texture.values().len() / texture.channels() as usize;
    let one = &texture.values()[..count];
    let values = [1.0, 0.9, 0.8]
        .iter()
        .flat_map(|share| one.iter().map(move |it| share * it));
    let made = Texture::new(texture.cells(), values.collect(), texture.storage()).unwrap();
    made.placed(DVec3::ZERO, DVec3::splat(2.0))
}

/// Returns what a frame takes, each seen from another place.
fn frames(
    renderer: &mut Renderer,
    cores: u32,
    texture: &Texture,
    interpolation: VolumeInterpolation,
) -> Spent {
    let mut scene = Scene::new(camera(0.0));
    scene.image = ImageSize {
        width: 512,
        height: 512,
    };
    scene.integration.measure = Measure::Length;
    scene.integration.volumes = VolumeMethod::Ray { step: 1.0 };
    let mut volume = Volume::new(texture.clone());
    volume.interpolation = interpolation;
    scene.volumes.push(volume);
    renderer.render(&scene).unwrap();
    let took = spent(cores, || {
        for turn in 1..=FRAMES {
            scene.camera = camera(0.1 * f64::from(turn));
            renderer.render(&scene).unwrap();
        }
    });
    Spent {
        clock: took.clock / f64::from(FRAMES),
        core: took.core / f64::from(FRAMES),
    }
}
