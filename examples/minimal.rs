//! The shortest way to a picture: a ring of light, drawn into the folder given.
//!
//! `cargo run --release --example minimal -- FOLDER`

use std::path::PathBuf;

use energywave::scene::{Camera, Torus};
use energywave::{Device, Renderer, Scene};
use glam::DVec3;

fn main() -> energywave::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_default());
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 2.0), DVec3::ZERO));
    scene.tori.push(Torus {
        color: DVec3::new(0.15, 0.35, 1.0),
        coefficient: 0.01,
        ..Torus::new(0.9)
    });
    let radiance = Renderer::new(&Device::best()?)?.render(&scene)?;
    radiance.save(folder.join("ring.png"), &scene.display)
}
