//! Criterion benches: a frame by resolution and divisions, by kind and number of sources; the exact method by
//! tolerance; packing; reading back against mapping. `cargo bench --bench frame`
#![allow(missing_docs)] // criterion's macros make undocumented functions
#![allow(clippy::unwrap_used)] // a bench that fails stops

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use energywave::image::ImageSize;
use energywave::internals::pack::{Anchor, SourceFacts, Sources};
use energywave::papers::{DIVISIONS, RESOLUTIONS, Table, turned};
use energywave::scene::{Curve, Cylinder, Method, Profile, Sphere, Torus};
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
                profile: Profile::Inverse,
                coefficient: 1.0,
                ..Sphere::default()
            }),
            "cylinders" => scene.cylinders.push(Cylinder {
                point: point(),
                profile: Profile::Inverse,
                coefficient: 1.0,
                ..Cylinder::new(point())
            }),
            "tori" => scene.tori.push(Torus {
                center: point(),
                axis: point(),
                profile: Profile::Inverse,
                coefficient: 1.0,
                ..Torus::new(0.5)
            }),
            _ => scene.curves.push(Curve {
                profile: Profile::Inverse,
                coefficient: 1.0,
                ..Curve::new([point(), point(), point()])
            }),
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
        scene.integration.method = Method::simpson(200);
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

/// What is done for every source of a scene, at 100 000 spheres: each on its own when something changed, and what a
/// frame takes besides its kernels when nothing did.
fn of_every_source(criterion: &mut Criterion) {
    const COUNT: u32 = 100_000;
    let mut scene = crowd("spheres", COUNT);
    scene.image = ImageSize {
        width: 128,
        height: 128,
    };
    let plane = scene.view_plane();
    let anchor = Anchor::new(&scene, plane.eye, plane.ray_length, plane.ray_length);
    let mut group = criterion.benchmark_group("100000 spheres");
    group.bench_function("validate", |bencher| {
        bencher.iter(|| scene.validate().unwrap());
    });
    group.bench_function("look for signs and profiles", |bencher| {
        bencher.iter(|| {
            let mut facts = SourceFacts::default();
            facts.update(black_box(&scene));
            facts
        });
    });
    let mut packed = Sources::new(&scene, &anchor);
    group.bench_function("pack", |bencher| {
        bencher.iter(|| packed.fill(black_box(&scene), &anchor));
    });
    let again = packed.clone();
    group.bench_function("compare packed lists", |bencher| {
        bencher.iter(|| black_box(&packed.spheres) == black_box(&again.spheres));
    });
    let mut renderer = renderer();
    scene.integration.method = Method::default();
    let mut besides_kernels = |scene: &Scene| {
        let begun = Instant::now();
        drop(renderer.render_mapped(scene).unwrap());
        begun.elapsed().saturating_sub(renderer.last_cost().kernel)
    };
    group.bench_function("a frame that did not change, besides kernels", |bencher| {
        bencher.iter_custom(|count| (0..count).map(|_| besides_kernels(&scene)).sum());
    });
    let mut other = scene.clone();
    other.spheres[0].coefficient *= 1.5;
    let mut turns = [&other, &scene].into_iter().cycle();
    group.bench_function(
        "a frame with a changed sphere, besides kernels",
        |bencher| {
            bencher.iter_custom(|count| {
                let frames = turns.by_ref().take(count as usize);
                frames.map(&mut besides_kernels).sum()
            });
        },
    );
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
    targets = tables, sources, exact, of_every_source, read_back
}
criterion_main!(benches);
