//! The errors of volumes, against the integrals of the fields that they were baked from: a ring and a point in a cube
//! of side 2, 96x96 rays, by cells, by what they store, by how they are interpolated; those of slices (Sakai 2006)
//! by their number, with a plot. Prints Markdown, and writes the plot beside the records.
//! `cargo bench --bench volume_errors [-- CELLS]`
#![allow(clippy::unwrap_used)] // a bench that fails stops

mod common;

use std::ops::ControlFlow;

use energywave::glam::DVec3;
use energywave::image::ImageSize;
use energywave::scene::{
    Camera, Measure, Profile, Sphere, Torus, Volume, VolumeInterpolation, VolumeMethod,
};
use energywave::volume::{Grid, Storage, Texture};
use energywave::{Renderer, Scene};
use plotters::prelude::*;

const SLICES: [u32; 9] = [4, 8, 16, 32, 64, 128, 256, 512, 1024];

fn scene(profile: Profile) -> Scene {
    let mut camera = Camera::new(DVec3::new(0.7, -3.2, 1.6), DVec3::ZERO);
    camera.fov_y = 40.0;
    let mut scene = Scene::new(camera);
    scene.image = ImageSize {
        width: 96,
        height: 96,
    };
    scene.integration.measure = Measure::Length;
    scene.tori.push(Torus {
        profile,
        ..Torus::new(0.6)
    });
    scene.spheres.push(Sphere {
        center: DVec3::new(0.1, 0.2, 0.3),
        profile,
        ..Sphere::default()
    });
    scene
}

fn grid(cells: u32) -> Grid {
    Grid::new(DVec3::ZERO, DVec3::splat(2.0), cells).unwrap()
}

fn row(renderer: &mut Renderer, profile: Profile, cells: u32) {
    let scene = scene(profile);
    let grid = grid(cells);
    let progress = &mut |_: f32| ControlFlow::Continue(());
    let volume = renderer
        .bake(&scene, grid, scene.reciprocal_cell_value(), progress)
        .unwrap();
    for storage in [Storage::Emission, scene.reciprocal()] {
        let texture = Texture::of(&volume, storage, scene.one_color()).unwrap();
        for interpolation in [VolumeInterpolation::Linear, VolumeInterpolation::Cubic] {
            let mut drawn = Volume::new(texture.clone());
            drawn.interpolation = interpolation;
            let error = renderer
                .drawn_error(&scene, &grid, &drawn)
                .unwrap()
                .unwrap();
            println!(
                "| {profile:?} | {storage:?} | {interpolation:?} | {cells} | {:.0e} | {:.0e} | {:.0e} | {:.0e} | {} |",
                error.median, error.many, error.most, error.worst, error.rays
            );
        }
    }
}

/// Returns the greatest error of any pixel, of the brightest, for each number of slices.
fn slices(renderer: &mut Renderer) -> Vec<(f64, f64)> {
    let cells = 48_u32;
    let cloud = |index: u32| {
        let at = [index % cells, index / cells % cells, index / cells / cells];
        let at = DVec3::from(at.map(|it| (f64::from(it) + 0.5) / f64::from(cells) * 2.0 - 1.0));
        let rim = at.abs().max_element();
        ((-9.0 * at.length_squared()).exp()
            * (1.0 + 0.5 * (9.0 * at.x).sin())
            * (1.0 - rim.powi(4))) as f32
    };
    let values = (0..cells.pow(3)).map(cloud).collect();
    let texture = Texture::new([cells; 3], values, Storage::Emission).unwrap();
    let mut scene = Scene::new(scene(Profile::Inverse).camera);
    scene.image = ImageSize {
        width: 96,
        height: 96,
    };
    scene.integration.measure = Measure::Length;
    scene.volumes.push(Volume::new(texture));
    scene.integration.volumes = VolumeMethod::Ray { step: 0.05 };
    let exact = renderer.render(&scene).unwrap();
    let most = exact
        .as_slice()
        .chunks_exact(4)
        .map(|it| it[0])
        .fold(0.0, f32::max);
    let error = |count| {
        scene.integration.volumes = VolumeMethod::Slices { count };
        let drawn = renderer.render(&scene).unwrap();
        let pairs = drawn.as_slice().iter().zip(exact.as_slice());
        let worst = pairs
            .map(|(one, other)| (one - other).abs())
            .fold(0.0, f32::max);
        (f64::from(count), f64::from(worst / most))
    };
    SLICES.map(error).to_vec()
}

fn plot(path: &str, points: &[(f64, f64)]) {
    let root = SVGBackend::new(path, (640, 420)).into_drawing_area();
    root.fill(&WHITE).unwrap();
    let mut chart = ChartBuilder::on(&root)
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(70)
        .caption(
            "A cloud of 48 x 48 x 48 cells by slices",
            ("sans-serif", 18),
        )
        .build_cartesian_2d((4.0..1024.0).log_scale(), (1e-7..1.0).log_scale())
        .unwrap();
    chart
        .configure_mesh()
        .x_desc("slices")
        .y_desc("worst pixel's error, of the brightest")
        .x_label_formatter(&|it| format!("{it:.0}"))
        .y_label_formatter(&|it| format!("{it:.0e}"))
        .light_line_style(TRANSPARENT)
        .draw()
        .unwrap();
    let blue = RGBColor(0x1f, 0x5f, 0xbf);
    let line = LineSeries::new(points.iter().copied(), blue.stroke_width(2)).point_size(4);
    chart.draw_series(line).unwrap();
    root.present().unwrap();
}

fn main() {
    let (device, mut renderer) = common::device();
    println!(
        "{}",
        common::header(&device, "cargo bench --bench volume_errors")
    );
    let points = slices(&mut renderer);
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/benches/results/2026-11-27-slices.svg"
    );
    plot(path, &points);
    println!("| slices | error |\n|---|---|");
    for (count, error) in points {
        println!("| {count} | {error:.0e} |");
    }
    let only: Option<u32> = std::env::args().skip(1).find_map(|it| it.parse().ok());
    println!(
        "\n| profile | cells hold | interpolation | cells | median | 99 % | 99.9 % | worst | rays |\n\
         |---|---|---|---|---|---|---|---|---|"
    );
    for cells in [64, 128, 256]
        .into_iter()
        .filter(|it| only.is_none_or(|only| only == *it))
    {
        row(&mut renderer, Profile::Inverse, cells);
        if cells == 256 {
            row(&mut renderer, Profile::InverseSquare, cells);
        }
    }
}
