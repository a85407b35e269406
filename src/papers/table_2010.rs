//! The speed table of Abe, Watanabe 2010: a sphere and a beam in closed form, with and without hidden surfaces.

use std::time::{Duration, Instant};

use glam::DVec3;

use super::occluders::tetrahedra;
use crate::error::{Error, Result};
use crate::image::ImageSize;
use crate::reference;
use crate::scene::{Antialias, Beam, BeamEnd, Camera, Measure, Profile, Scene};

/// A cell of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell2010 {
    /// Width and height, pixels.
    pub resolution: u32,
    /// Whether surfaces hide light.
    pub has_depth: bool,
    /// Frames a second that the paper reports (NVIDIA GeForce 9600 GT).
    pub paper_fps: f64,
}

const fn cell(resolution: u32, has_depth: bool, paper_fps: f64) -> Cell2010 {
    Cell2010 {
        resolution,
        has_depth,
        paper_fps,
    }
}

/// The table.
pub const TABLE_2010: [Cell2010; 4] = [
    cell(256, false, 115.0),
    cell(256, true, 105.0),
    cell(512, false, 31.0),
    cell(512, true, 27.0),
];

/// Frames a second that the paper reports without a GPU, beside its last cell.
pub const PAPER_CPU_FPS: f64 = 1.0;

/// Returns a camera that sees the beam straight from the side, through a plane of side 1; rays end 500 from the eye.
/// Its place is not given in the paper: here both tetrahedra are in view, and the waves of figures 15-18 go from before
/// to behind both.
pub fn camera_2010() -> Camera {
    let mut camera = Camera::new(DVec3::new(0.0, 0.0, 350.0), DVec3::ZERO);
    camera.up = DVec3::Y;
    camera.fov_y = 2.0 * 0.5_f64.atan().to_degrees();
    camera.ray_length = Some(499.0);
    camera
}

impl Cell2010 {
    /// Makes the cell's scene: a = 60, b = 30, the wave between the two tetrahedra of figures 15-18.
    ///
    /// # Errors
    /// As [`tetrahedra`].
    pub fn scene(&self) -> Result<Scene> {
        let camera = camera_2010();
        let mut scene = Scene::new(camera);
        scene.image = ImageSize {
            width: self.resolution,
            height: self.resolution,
        };
        scene.integration.measure = Measure::Length;
        scene.integration.antialias = Antialias::None;
        scene.beams.push(Beam {
            tip: DVec3::new(0.0, 0.0, 70.0),
            coefficient: 30.0,
            end: BeamEnd::Cap(Some(60.0)),
            sphere_coefficient: 60.0,
            profile: Profile::Inverse,
            ..Beam::new(DVec3::X)
        });
        if self.has_depth {
            scene.depth = Some(tetrahedra(&scene.camera, scene.image)?);
        }
        Ok(scene)
    }
}

/// Measures the frames a second of the float64 reference on a single thread, by one frame.
///
/// # Errors
/// As [`reference::render`].
pub fn single_threaded_fps(scene: &Scene) -> Result<f64> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .map_err(|error| Error::Unsupported(format!("no thread for the reference: {error}")))?;
    let begun = Instant::now();
    pool.install(|| reference::render(scene))?;
    Ok(1.0 / begun.elapsed().max(Duration::from_nanos(1)).as_secs_f64())
}
