//! Criterion benches: the tree of a million triangles, and the rays of a picture of 512x512 pixels through it, seen
//! from another place each time: hills, whose triangles are about as large as pixels, and a ball.
//! `cargo bench --bench mesh`
#![allow(missing_docs)] // criterion's macros make undocumented functions
#![allow(clippy::unwrap_used)] // a bench that fails stops

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use energywave::glam::DVec3;
use energywave::internals::Tree;
use energywave::scene::{Antialias, Camera, Mesh, TriangleList};
use energywave::{Device, Renderer, Scene};

/// Squares along a side: two triangles each.
const SQUARES: u32 = 708;

fn grid(place: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let count = SQUARES + 1;
    let share = |number: u32| f64::from(number) / f64::from(SQUARES);
    let corners = (0..count * count).map(|at| place(share(at % count), share(at / count)));
    let squares = (0..SQUARES * SQUARES).map(|at| at / SQUARES * count + at % SQUARES);
    let triangles = squares.flat_map(|at| {
        [
            [at, at + 1, at + count],
            [at + 1, at + count + 1, at + count],
        ]
    });
    Mesh::new(TriangleList::new(corners.collect(), triangles.collect()).unwrap())
}

fn hills() -> Mesh {
    grid(|x, y| {
        let (x, y) = (8.0 * x - 4.0, 8.0 * y - 4.0);
        let large = (1.3 * x).sin() * (1.1 * y + 0.4).cos();
        DVec3::new(
            x,
            y,
            large + 0.15 * (7.0 * x + 2.0 * y).sin() * (9.0 * y).cos(),
        )
    })
}

fn ball() -> Mesh {
    grid(|x, y| {
        let (turn, down) = (TAU * x, PI * y);
        3.0 * DVec3::new(down.sin() * turn.cos(), down.sin() * turn.sin(), down.cos())
    })
}

fn meshes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("mesh");
    group.sample_size(10);
    for (name, mesh) in [("hills", hills()), ("ball", ball())] {
        let tree = Tree::new(std::slice::from_ref(&mesh)).unwrap();
        println!(
            "{} triangles, {} boxes",
            tree.triangles.len(),
            tree.nodes.len()
        );
        group.bench_function(BenchmarkId::new("tree", name), |bencher| {
            bencher.iter(|| black_box(Tree::new(std::slice::from_ref(&mesh)).unwrap()));
        });
        for (rays, antialias) in [
            ("1 ray", Antialias::None),
            ("16 rays", Antialias::Footprint),
        ] {
            let mut scene = Scene::new(Camera::new(DVec3::new(1.0, -8.0, 4.0), DVec3::ZERO));
            scene.integration.antialias = antialias;
            scene.meshes.push(mesh.clone());
            let mut renderer = Renderer::new(&Device::select("cpu").unwrap()).unwrap();
            renderer.render(&scene).unwrap();
            let mut turn: f64 = 0.0;
            group.bench_function(
                BenchmarkId::new(format!("kernels, {rays}"), name),
                |bencher| {
                    bencher.iter_custom(|count| {
                        let mut sum = Duration::ZERO;
                        for _ in 0..count {
                            turn += 0.1;
                            scene.camera.eye = DVec3::new(8.0 * turn.sin(), -8.0 * turn.cos(), 4.0);
                            renderer.render(&scene).unwrap();
                            sum += renderer.last_cost().kernel;
                        }
                        sum
                    });
                },
            );
        }
    }
    group.finish();
}

criterion_group!(benches, meshes);
criterion_main!(benches);
