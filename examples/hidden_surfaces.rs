//! Depth from a host: two tetrahedra, ray-cast here as a game engine would draw them, hide a beam (Abe, Watanabe 2010,
//! figures 15-18). Draws `hidden-surfaces.png` into the folder given, and `hidden-surfaces-depth.exr`, which a scene
//! file may name.
//!
//! `cargo run --release --example hidden_surfaces -- FOLDER`

use std::path::PathBuf;

use energywave::image::{Display, Exposure, ImageSize, ToneMap};
use energywave::papers::{camera_2010, tetrahedra};
use energywave::scene::{Beam, Measure, Profile};
use energywave::{Device, Renderer, Scene};
use glam::DVec3;

fn main() -> energywave::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_default());
    let mut scene = Scene::new(camera_2010());
    scene.image = ImageSize {
        width: 256,
        height: 256,
    };
    scene.integration.measure = Measure::Length;
    scene.beams.push(Beam {
        tip: DVec3::new(0.0, 0.0, 70.0),
        coefficient: 30.0,
        sphere_coefficient: 60.0,
        color: DVec3::new(0.3, 0.6, 1.0),
        profile: Profile::Inverse,
        ..Beam::new(DVec3::X)
    });
    scene.display = Display {
        exposure: Exposure::Stops(-9.6),
        tone_map: ToneMap::Aces,
        ..Display::default()
    };

    // A host has these distances from its own depth buffer: `DepthImage::new(size, along, values)`.
    let depth = tetrahedra(&scene.camera, scene.image)?;
    depth.save(folder.join("hidden-surfaces-depth.exr"))?;

    // Clones of a depth image share its values; a renderer uploads them once.
    scene.depth = Some(depth);
    let radiance = Renderer::new(&Device::best()?)?.render(&scene)?;
    radiance.save(folder.join("hidden-surfaces.png"), &scene.display)
}
