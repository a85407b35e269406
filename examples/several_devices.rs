//! One picture by all OpenCL devices at once: each draws some of its rows, more from frame to frame if it is faster
//! than the others. Writes `curve.png` into the folder given, and says which device drew which rows.
//!
//! `cargo run --release --example several_devices -- FOLDER`

use std::path::PathBuf;

use energywave::image::ImageSize;
use energywave::scene::{Camera, Curve};
use energywave::{Devices, Renderer, RendererOptions, Scene};
use glam::DVec3;

fn main() -> energywave::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_default());
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 2.0), DVec3::ZERO));
    scene.image = ImageSize {
        width: 480,
        height: 360,
    };
    scene.curves.push(Curve {
        color: DVec3::new(0.15, 1.0, 0.35),
        coefficient: 0.01,
        ..Curve::new([
            DVec3::new(-1.2, 0.0, -0.6),
            DVec3::new(0.0, 0.4, 1.6),
            DVec3::new(1.2, 0.0, -0.6),
        ])
    });

    let devices = Devices::discover().select_all("all")?;
    let mut renderer = Renderer::on_devices(&devices, &RendererOptions::default())?;
    for frame in 0..8 {
        renderer.render(&scene)?;
        for (device, rows) in devices.iter().zip(renderer.shares()) {
            println!("frame {frame}: rows {rows:?} by {device}");
        }
    }
    let radiance = renderer.render(&scene)?;
    radiance.save(folder.join("curve.png"), &scene.display)
}
