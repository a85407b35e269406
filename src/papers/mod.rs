//! The papers' speed tables (Watanabe, Abe, Konno 2015, Tables 2 and 3; Abe, Watanabe 2010), and the speed of any
//! scene: whole frames, the image in host memory at the end of each, a new camera for every frame.

mod crowd;
#[cfg(feature = "files")]
mod figures;
mod occluders;
mod table_2006;
mod table_2008;
mod table_2010;
mod table_2013;
mod times;

use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use glam::{DMat4, DQuat, DVec3};

pub use crowd::{crowd, depths_of_boxes};
#[cfg(feature = "files")]
pub use figures::Figure;
pub use occluders::tetrahedra;
pub use table_2006::{Cell2006, Method2006, beam_2006, table_2006};
pub use table_2008::{Cell2008, PARTICLES_2008, Speed2008, methods_2008, table_2008};
pub use table_2010::{Cell2010, PAPER_CPU_FPS, TABLE_2010, camera_2010, single_threaded_fps};
pub use table_2013::{Cell2013, Speed2013, TABLE_2013};
pub use times::Times;

use crate::cost::{CrowdCost, FrameCost};
use crate::error::{Error, Result};
use crate::image::{Difference, ImageSize, RadianceImage, compare};
use crate::opencl::RendererOptions;
use crate::render::{Device, Renderer};
use crate::scene::{Camera, Curve, Decay, Measure, Method, Profile, Scene, Torus};

/// Camera positions of one turn around the scene.
pub const FRAMES_PER_TURN: u32 = 64;

/// Resolutions and divisions of the tables' rows and columns.
pub const RESOLUTIONS: [u32; 3] = [128, 256, 512];
/// See [`RESOLUTIONS`].
pub const DIVISIONS: [u32; 3] = [64, 128, 256];

/// The field of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Table {
    /// Table 2: a torus, R = 0.9, t = 5.1.
    Torus,
    /// Table 3: a Bezier curve, b = 5.0.
    Bezier,
}

impl Table {
    /// Returns the paper's number of the table.
    pub fn number(self) -> u32 {
        match self {
            Self::Torus => 2,
            Self::Bezier => 3,
        }
    }

    /// Returns the name of the field.
    pub fn field(self) -> &'static str {
        match self {
            Self::Torus => "torus",
            Self::Bezier => "bezier",
        }
    }

    /// Returns the frames a second that the paper reports (AMD FirePro D500), rows as [`RESOLUTIONS`], columns as
    /// [`DIVISIONS`].
    pub fn paper_fps(self) -> [[f64; 3]; 3] {
        match self {
            Self::Torus => [
                [384.61, 168.63, 62.35],
                [116.69, 46.49, 16.85],
                [31.23, 13.49, 5.21],
            ],
            Self::Bezier => [
                [116.69, 60.17, 28.94],
                [34.64, 17.16, 8.31],
                [9.00, 4.40, 2.15],
            ],
        }
    }

    /// Makes a cell's scene: eye 4 from the centre, projection plane at 1 with half-size 0.375, rays of 12, alpha =
    /// beta = 0.1.
    pub fn scene(self, resolution: u32, divisions: u32) -> Scene {
        let (azimuth, elevation) = (30_f64.to_radians(), 35_f64.to_radians());
        let toward_eye = DVec3::new(
            elevation.cos() * azimuth.cos(),
            elevation.cos() * azimuth.sin(),
            elevation.sin(),
        );
        let mut camera = Camera::new(4.0 * toward_eye, DVec3::ZERO);
        camera.fov_y = 2.0 * 0.375_f64.atan().to_degrees();
        camera.ray_length = Some(12.0);
        let mut scene = Scene::new(camera);
        scene.image = ImageSize {
            width: resolution,
            height: resolution,
        };
        scene.decay = Some(Decay::new(0.1, 0.1));
        scene.integration.method = Method::Simpson { divisions };
        scene.integration.measure = Measure::Parameter;
        match self {
            Self::Torus => scene.tori.push(Torus {
                profile: Profile::Inverse,
                coefficient: 5.1,
                ..Torus::new(0.9)
            }),
            Self::Bezier => scene.curves.push(Curve {
                profile: Profile::Inverse,
                coefficient: 5.0,
                ..Curve::new([
                    DVec3::new(-1.2, -0.2, 0.1),
                    DVec3::new(-0.6, 1.1, -0.3),
                    DVec3::new(0.0, 0.0, 0.1),
                ])
            }),
        }
        scene
    }
}

/// Returns the scene seen from frame `frame` of a turn of [`FRAMES_PER_TURN`] around the target, about the camera's up
/// vector; by matrices around the world's origin, about z.
pub fn turned(scene: &Scene, frame: u32) -> Scene {
    let mut turned = scene.clone();
    let camera = &mut turned.camera;
    let angle = TAU * f64::from(frame % FRAMES_PER_TURN) / f64::from(FRAMES_PER_TURN);
    if let Some(matrices) = &mut camera.matrices {
        matrices.view *= DMat4::from_rotation_z(-angle);
        return turned;
    }
    let turn = DQuat::from_axis_angle(camera.up.normalize(), angle);
    camera.eye = camera.target + turn * (camera.eye - camera.target);
    turned
}

/// Speed of a scene on a device.
#[derive(Debug, Clone)]
pub struct Speed {
    /// Frames a second, by the median time of a whole frame.
    pub fps: f64,
    /// What whole frames took.
    pub times: Times,
    /// Median time that the device worked on kernels, a frame.
    pub kernel: Duration,
    /// What the last frame cost.
    pub cost: FrameCost,
    /// Number of the last frame in its turn, see [`turned`].
    pub frame: u32,
    /// The last frame.
    pub image: RadianceImage,
}

/// Renders frame after frame for at least `time`, and at least three, after a warm-up.
///
/// # Errors
/// As [`Renderer::render_mapped`].
pub fn measure(renderer: &mut Renderer, scene: &Scene, time: Duration) -> Result<Speed> {
    let scenes: Vec<Scene> = (0..FRAMES_PER_TURN)
        .map(|frame| turned(scene, frame))
        .collect();
    measure_frames(renderer, &scenes, time)
}

/// Measures frames one after the other, and again from the first on.
fn measure_frames(renderer: &mut Renderer, scenes: &[Scene], time: Duration) -> Result<Speed> {
    for scene in scenes {
        scene.validate()?;
    }
    let size = scenes
        .first()
        .map_or(ImageSize::default(), |scene| scene.image);
    let mut image = RadianceImage::new(size)?;
    let begun = Instant::now();
    // The first frame compiles; the next ones find their pace.
    for scene in scenes.iter().cycle().take(8) {
        renderer.render_mapped(scene)?;
        if begun.elapsed() > time {
            break;
        }
    }
    let mut frames = Vec::new();
    let mut kernels = Vec::new();
    let (mut last, mut cost) = (0, FrameCost::default());
    let begun = Instant::now();
    while begun.elapsed() < time || frames.len() < 3 {
        last = frames.len() % scenes.len();
        let frame_begun = Instant::now();
        renderer.render_mapped(&scenes[last])?;
        frames.push(frame_begun.elapsed());
        cost = renderer.last_cost();
        kernels.push(cost.kernel);
    }
    image
        .as_mut_slice()
        .copy_from_slice(&renderer.render_mapped(&scenes[last])?);
    let times = Times::of(frames)?;
    Ok(Speed {
        fps: times.fps(),
        times,
        kernel: Times::of(kernels)?.median,
        cost,
        frame: last as u32,
        image,
    })
}

/// Frames whose cost [`exact_cost`] takes the mean of.
const COUNTED_FRAMES: u32 = 4;

/// Returns what a frame of the method `exact` costs, by kernels that count their nodes: the mean over four cameras of a
/// turn, so that scenes can be compared whatever the device's speed. Closed forms take no nodes; a ray counts the nodes
/// of all rays that are side by side with it in one vector.
///
/// # Errors
/// As [`Renderer::render`].
pub fn exact_cost(device: &Device, scene: &Scene) -> Result<FrameCost> {
    let options = RendererOptions {
        counts_samples: true,
        skips_self_test: true, // those that draw have passed it
        ..RendererOptions::default()
    };
    let mut renderer = Renderer::with_options(device, &options)?;
    let mut sum = FrameCost::default();
    for frame in 0..COUNTED_FRAMES {
        let scene = turned(scene, frame * FRAMES_PER_TURN / COUNTED_FRAMES);
        renderer.render_mapped(&scene)?;
        let cost = renderer.last_cost();
        sum.integrals += cost.integrals;
        sum.samples += cost.samples;
        sum.kernel += cost.kernel;
        sum.meshes += cost.meshes;
        sum.launches += cost.launches;
    }
    Ok(FrameCost {
        integrals: sum.integrals / u64::from(COUNTED_FRAMES),
        samples: sum.samples / u64::from(COUNTED_FRAMES),
        kernel: sum.kernel / COUNTED_FRAMES,
        meshes: sum.meshes / COUNTED_FRAMES,
        crowds: CrowdCost::default(),
        launches: sum.launches / COUNTED_FRAMES,
    })
}

/// A way to integrate, how far it is from the truth, and how fast.
#[derive(Debug, Clone)]
pub struct Accuracy {
    /// The method.
    pub method: Method,
    /// Relative difference from the float64 reference, linear radiance.
    pub difference: Difference,
    /// Frames a second, as [`measure`] has them.
    pub fps: f64,
    /// What whole frames took.
    pub times: Times,
}

/// Compares Simpson's rule with 64, 128, 200, 256 and 1024 divisions and the method `exact` at 1e-2, 1e-3 and 1e-4 with
/// `truth`, the scene's image by [`crate::reference::render`].
///
/// # Errors
/// As [`Renderer::render`].
pub fn accuracies(
    renderer: &mut Renderer,
    scene: &Scene,
    truth: &RadianceImage,
    time: Duration,
) -> Result<Vec<Accuracy>> {
    let simpson = [64, 128, 200, 256, 1024].map(Method::simpson);
    let exact = [1e-2, 1e-3, 1e-4].map(|tolerance| Method::Exact {
        tolerance,
        sampling: scene.integration.method.sampling_or_default(),
    });
    let mut rows = Vec::new();
    for method in simpson.into_iter().chain(exact) {
        let mut scene = scene.clone();
        scene.integration.method = method;
        let image = renderer.render(&scene)?;
        let difference = compare(&image, truth)
            .ok_or_else(|| Error::Unsupported("the truth has another size".to_owned()))?;
        let speed = measure(renderer, &scene, time)?;
        rows.push(Accuracy {
            method,
            difference,
            fps: speed.fps,
            times: speed.times,
        });
    }
    Ok(rows)
}
