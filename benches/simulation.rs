//! Criterion benches: a step of the simulation of waves that hit things, at 2410, 12050 and 100 000 particles. The beam
//! is the wider the more there are, so that as many are near each other.
//! `cargo bench --bench simulation`
#![allow(missing_docs)] // criterion's macros make undocumented functions
#![allow(clippy::unwrap_used)] // a bench that fails stops

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use energywave::Scene;
use energywave::glam::DVec3;
use energywave::particle::Simulation;
use energywave::scene::{Camera, Collider, EmittedWave};

/// Frames that a particle lives, 25 until it hits and 40 from then on.
const LIFE: f64 = 65.0;

/// Particles a frame for which the beam has the thesis' radius.
const RATE: f64 = 37.0;

/// Frames until as many particles die as are emitted.
const WARM_UP: u32 = 100;

fn scene(particles: u32) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(-120.0, -95.0, 50.0), DVec3::ZERO));
    let mut wave = EmittedWave::new(-50.0 * DVec3::X, DVec3::X);
    let rate = f64::from(particles) / LIFE;
    wave.rate = rate.into();
    wave.radius = 3.0 * (rate / RATE).sqrt();
    scene.waves.push(wave);
    let half = DVec3::new(8.0, 200.0, 200.0);
    scene
        .colliders
        .push(Collider::new_box(8.0 * DVec3::X, half));
    scene
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulation");
    for particles in [2410, 12_050, 100_000] {
        let mut simulation = Simulation::new(&scene(particles)).unwrap();
        let count = simulation.particles(WARM_UP).unwrap().len();
        println!("{count} particles");
        let mut frame = WARM_UP;
        group.bench_function(BenchmarkId::new("a step", particles), |bencher| {
            bencher.iter(|| {
                let contacts = simulation.contacts(frame..=frame).unwrap();
                frame += 1;
                black_box(contacts)
            });
        });
        group.bench_function(BenchmarkId::new("light", particles), |bencher| {
            bencher.iter(|| black_box(simulation.light(f64::from(frame)).unwrap()));
        });
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
