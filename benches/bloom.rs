//! Criterion benches: the bloom of a picture on the host, and on the device, where a film has it already.
//! `cargo bench --bench bloom`
#![allow(missing_docs)] // criterion's macros make undocumented functions
#![allow(clippy::unwrap_used)] // a bench that fails stops

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use energywave::RadianceImage;
use energywave::image::{Bloom, ImageSize};
use energywave::internals::{Compute, Film, Spreader, discover};

const SIZES: [(u32, u32); 3] = [(640, 360), (1920, 1080), (3840, 2160)];

/// A picture of sparks on a wide glow.
fn picture(size: ImageSize) -> RadianceImage {
    let mut image = RadianceImage::new(size).unwrap();
    let mut random = fastrand::Rng::with_seed(1);
    for pixel in image.as_mut_slice().chunks_exact_mut(4) {
        let light = if random.u32(0..1000) == 0 { 90.0 } else { 0.1 };
        pixel.copy_from_slice(&[light, 0.5 * light, random.f32(), 1.0]);
    }
    image
}

fn compute() -> Compute {
    let choice = std::env::var("ENERGYWAVE_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    let name = energywave::Device::select(&choice).unwrap().name;
    let found = discover().devices;
    Compute::new(found.iter().find(|device| device.name == name).unwrap()).unwrap()
}

fn blooms(criterion: &mut Criterion) {
    let compute = compute();
    let mut spreader = Spreader::new(&Default::default());
    let bloom = Bloom::new(0.2);
    let mut group = criterion.benchmark_group("bloom");
    for (width, height) in SIZES {
        let size = ImageSize { width, height };
        let image = picture(size);
        group.throughput(Throughput::Elements(size.pixels() as u64));
        let name = format!("{width}x{height}");
        group.bench_function(BenchmarkId::new("host", &name), |bencher| {
            bencher.iter(|| black_box(&image).bloomed(&bloom).unwrap());
        });
        let mut film = Film::new();
        let (pixels, _) = image.as_slice().as_chunks::<4>();
        film.write(&compute, pixels).unwrap();
        // The same film again and again: light that is spread already takes as long.
        let mut least = (Duration::MAX, Duration::MAX);
        group.bench_function(BenchmarkId::new("device", &name), |bencher| {
            bencher.iter(|| {
                let begun = Instant::now();
                spreader.spread(&compute, &mut film, size, &bloom).unwrap();
                let cost = spreader.settle(&compute).unwrap();
                least = (least.0.min(begun.elapsed()), least.1.min(cost.kernel));
            });
        });
        if least.0 < Duration::MAX {
            println!("least time: {:?}, in kernels {:?}", least.0, least.1);
        }
    }
}

criterion_group!(benches, blooms);
criterion_main!(benches);
