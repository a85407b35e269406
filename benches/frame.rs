//! Criterion benches: a frame by resolution and divisions, by kind and number of sources; the exact method by tolerance;
//! packing; reading back against mapping. `cargo bench --bench frame`
#![allow(missing_docs)] // criterion's macros make undocumented functions
#![allow(clippy::unwrap_used)] // a bench that fails stops

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use energywave::internals::ViewPlane;
use energywave::internals::pack::{Anchor, Sources};
use energywave::papers::{DIVISIONS, RESOLUTIONS, Table, turned};
use energywave::scene::{Curve, Cylinder, Method, Sphere, Torus};
use energywave::{Device, Renderer, Scene};
use glam::DVec3;

fn renderer() -> Renderer {
    let choice = std::env::var("ENERGYWAVE_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    Renderer::new(&Device::select(&choice).unwrap()).unwrap()
}

/// The tables' cells, a new camera for every frame, the image mapped.
fn tables(criterion: &mut Criterion) {
    let mut renderer = renderer();
    for table in [Table::Torus, Table::Bezier] {
        let mut group = criterion.benchmark_group(table.field());
        for resolution in RESOLUTIONS {
            for divisions in DIVISIONS {
                let scene = table.scene(resolution, divisions);
                let samples = u64::from(resolution * resolution) * u64::from(divisions + 1);
                group.throughput(Throughput::Elements(samples));
                let name = BenchmarkId::new(resolution.to_string(), divisions);
                let mut frame = 0;
                group.bench_function(name, |bencher| {
                    bencher.iter(|| {
                        frame += 1;
                        renderer.render_mapped(&turned(&scene, frame)).unwrap()[0]
                    });
                });
            }
        }
    }
}

/// A scene of the tables' geometry, 128x128 with 64 divisions, with many sources inside a cube in place of its own.
fn crowd(kind: &str, count: u32) -> Scene {
    let mut scene = Table::Torus.scene(128, 64);
    scene.tori.clear();
    let mut random = fastrand::Rng::with_seed(1);
    let mut point = || DVec3::from([0; 3].map(|_| 2.0 * random.f64() - 1.0));
    for _ in 0..count {
        match kind {
            "spheres" => scene.spheres.push(Sphere {
                center: point(),
                ..Sphere::default()
            }),
            "cylinders" => scene.cylinders.push(Cylinder {
                point: point(),
                ..Cylinder::new(point())
            }),
            "tori" => scene.tori.push(Torus {
                center: point(),
                axis: point(),
                ..Torus::new(0.5)
            }),
            _ => scene.curves.push(Curve::new([point(), point(), point()])),
        }
    }
    scene
}

fn sources(criterion: &mut Criterion) {
    let mut renderer = renderer();
    for kind in ["spheres", "cylinders", "tori", "curves"] {
        let mut group = criterion.benchmark_group(kind);
        for count in [1, 16, 256] {
            let scene = crowd(kind, count);
            group.throughput(Throughput::Elements(u64::from(count)));
            group.bench_function(count.to_string(), |bencher| {
                bencher.iter(|| renderer.render_mapped(&scene).unwrap()[0]);
            });
        }
    }
}

/// The exact method at 512x512 by tolerance, and the paper's Simpson rule with 200 divisions beside it.
fn exact(criterion: &mut Criterion) {
    let mut renderer = renderer();
    let mut bench = |name: &str, mut scene: Scene| {
        let mut group = criterion.benchmark_group(format!("exact, {name}"));
        scene.image.width = 512;
        scene.image.height = 512;
        scene.integration.divisions = 200;
        group.throughput(Throughput::Elements(512 * 512));
        let mut frame = 0;
        let mut time = |name: String, scene: &Scene| {
            group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    frame += 1;
                    renderer.render_mapped(&turned(scene, frame)).unwrap()[0]
                });
            });
        };
        time("simpson 200".to_owned(), &scene);
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
            scene.integration.method = Method::exact(tolerance);
            time(format!("{tolerance:e}"), &scene);
        }
    };
    bench("sphere", crowd("spheres", 1));
    bench("cylinder", crowd("cylinders", 1));
    bench("torus", Table::Torus.scene(512, 200));
    bench("curve", Table::Bezier.scene(512, 200));
}

fn packing(criterion: &mut Criterion) {
    let scene = crowd("spheres", 4096);
    let plane = ViewPlane::new(&scene.camera, scene.image);
    criterion.bench_function("pack 4096 spheres", |bencher| {
        let anchor = Anchor::new(&scene, plane.eye, plane.ray_length, plane.ray_length);
        bencher.iter(|| black_box(Sources::new(&scene, &anchor)));
    });
}

fn read_back(criterion: &mut Criterion) {
    let mut renderer = renderer();
    let mut group = criterion.benchmark_group("a frame of 2 divisions at 512x512");
    let scene = Table::Torus.scene(512, 2);
    let mut target = vec![0.0; 4 * scene.image.pixels()];
    group.bench_function("read back", |bencher| {
        bencher.iter(|| renderer.render_into(&scene, &mut target).unwrap());
    });
    group.bench_function("mapped", |bencher| {
        bencher.iter(|| renderer.render_mapped(&scene).unwrap()[0]);
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(1));
    targets = tables, sources, exact, packing, read_back
}
criterion_main!(benches);
