//! What it costs to draw into a host's memory instead of our own: 3840x2160 pixels into a buffer and images of a host,
//! and into our own buffer, mapped, in turn. Ratios to the time of the kernels on our own buffer.
//!
//! `cargo bench --bench sharing`
#![allow(clippy::unwrap_used)] // a bench that fails stops
#![allow(unsafe_code)] // hosts call OpenCL

#[allow(dead_code, clippy::panic)] // tests use more of it
#[path = "../tests/common/host.rs"]
mod host;

use std::time::{Duration, Instant};

use energywave::papers::Table;
use energywave::scene::{Method, Sampling};
use energywave::{Device, HostTarget, Renderer, Scene};
use host::Host;
use opencl3::memory::{CL_FLOAT, CL_HALF_FLOAT, CL_MEM_READ_WRITE};

const ROUNDS: usize = 15;

/// The device to measure: `ENERGYWAVE_DEVICE`, else a CPU.
fn device() -> Device {
    let choice = std::env::var("ENERGYWAVE_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    Device::select(&choice).unwrap()
}

fn enqueued(renderer: &mut Renderer, scene: &Scene, target: HostTarget) -> Duration {
    let begun = Instant::now();
    // SAFETY: the target lives, and the frame is waited for.
    unsafe { renderer.enqueue(scene, target, &[]) }
        .unwrap()
        .wait()
        .unwrap();
    begun.elapsed()
}

fn mapped(renderer: &mut Renderer, scene: &Scene) -> [Duration; 2] {
    let begun = Instant::now();
    drop(renderer.render_mapped(scene).unwrap());
    [renderer.last_cost().kernel, begun.elapsed()]
}

fn median(times: &mut [Duration]) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64() * 1e3
}

fn measure(name: &str, scene: &Scene) {
    let host = Host::new(0);
    let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
    let buffer = host.buffer(CL_MEM_READ_WRITE, scene.image);
    let image = host.image(scene.image, CL_FLOAT);
    let half = host.image(scene.image, CL_HALF_FLOAT);
    let targets: [HostTarget; 3] = [(&buffer).into(), (&image).into(), (&half).into()];
    let mut times: [Vec<Duration>; 5] = Default::default();
    for round in 0..ROUNDS + 2 {
        let own = mapped(&mut renderer, scene);
        let shared = targets.map(|target| enqueued(&mut renderer, scene, target));
        // The first frames compile, and find their pace.
        if round >= 2 {
            let all = own.into_iter().chain(shared);
            times
                .iter_mut()
                .zip(all)
                .for_each(|(list, time)| list.push(time));
        }
    }
    let [kernel, whole, buffer, image, half] = times.map(|mut list| median(&mut list));
    let percent = |time: f64| 100.0 * (time / kernel - 1.0);
    println!(
        "{name:<22} kernels {kernel:8.2} ms | mapped {:+5.1} % | host's buffer {:+5.1} % | \
         float image {:+5.1} % | half image {:+5.1} %",
        percent(whole),
        percent(buffer),
        percent(image),
        percent(half)
    );
}

fn main() {
    for table in [Table::Torus, Table::Bezier] {
        let mut scene = table.scene(512, 200);
        (scene.image.width, scene.image.height) = (3840, 2160);
        measure(&format!("{table:?}, Simpson 200"), &scene);
        for sampling in [Sampling::Pixels, Sampling::Tiles] {
            scene.integration.method = Method::Exact {
                tolerance: 1e-3,
                sampling,
            };
            measure(&format!("{table:?}, exact, {sampling:?}"), &scene);
        }
    }
}
