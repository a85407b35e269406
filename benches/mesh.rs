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
use energywave::scene::{
    Antialias, Beam, Camera, Curve, Lighting, Mesh, Segment, Sphere, Torus, TriangleList,
};
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

/// Makes a scene of ten sources of five kinds, whose glow ends next to them.
fn ten_sources() -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(1.0, -8.0, 4.0), DVec3::ZERO));
    for x in [-2.0, 0.25] {
        let at = |right, back, up| DVec3::new(x + right, back, up);
        scene.spheres.push(Sphere {
            center: at(0.0, 0.5, 1.0),
            ..Sphere::default()
        });
        scene
            .segments
            .push(Segment::new(at(0.45, 0.6, 0.1), at(0.45, 0.8, 2.0)));
        scene.tori.push(Torus {
            center: at(0.9, 0.2, 1.0),
            axis: DVec3::new(0.12, -0.2, 1.0),
            ..Torus::new(0.5)
        });
        let controls = [at(1.35, 0.0, 0.3), at(1.35, 1.0, 1.5), at(1.85, 0.0, 2.0)];
        scene.curves.push(Curve::new(controls));
        scene.beams.push(Beam {
            tip: at(1.8, 1.0, 1.0),
            ..Beam::new(DVec3::new(0.0, 0.2, 1.0))
        });
    }
    scene
}

/// Returns how long the kernels of meshes take for so many frames, each seen from another place.
fn turns(renderer: &mut Renderer, scene: &mut Scene, count: u64) -> Duration {
    let mut sum = Duration::ZERO;
    for turn in 0..count {
        let turn = 0.1 * turn as f64;
        scene.camera.eye = DVec3::new(8.0 * turn.sin(), -8.0 * turn.cos(), 4.0);
        renderer.render(scene).unwrap();
        sum += renderer.last_cost().meshes;
    }
    sum
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
        let lit = Some(Lighting::default());
        for (rays, antialias, lighting) in [
            ("1 ray", Antialias::None, None),
            ("16 rays", Antialias::Footprint, None),
            ("1 ray, lit by ten sources", Antialias::None, lit),
            ("16 rays, lit by ten sources", Antialias::Footprint, lit),
        ] {
            let mut scene = ten_sources();
            scene.integration.antialias = antialias;
            scene.lighting = lighting;
            scene.meshes.push(mesh.clone());
            let name = BenchmarkId::new(format!("kernels, {rays}"), name);
            let mut renderer = Renderer::new(&Device::select("cpu").unwrap()).unwrap();
            renderer.render(&scene).unwrap();
            group.bench_function(name, |bencher| {
                bencher.iter_custom(|count| turns(&mut renderer, &mut scene, count))
            });
        }
    }
    group.finish();
}

criterion_group!(benches, meshes);
criterion_main!(benches);
