//! The speed table of Nito 2013 (table 4.3): a wave that hits a box, by particles and sprites. The thesis gives no size
//! of the picture; here it is 512x512, and once more 1920x1080.

use std::time::{Duration, Instant};

use glam::DVec3;

use super::{FRAMES_PER_TURN, Speed, measure_frames};
use crate::error::Result;
use crate::image::ImageSize;
use crate::particle::Simulation;
use crate::render::Renderer;
use crate::scene::{
    Antialias, Camera, Collider, EmittedWave, ParticleShape, Scene, SimulationSettings,
};

/// Frames that a particle lives: from the emitter to the box, and after that.
const LIFE: f64 = 25.0 + 40.0;

/// The first frame that is shown: as many particles go out as are emitted.
const FIRST: u32 = 120;

/// A cell of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell2013 {
    /// How many particles there are, about.
    pub particles: u32,
    /// Sprites of a particle that has hit the box.
    pub samples: u32,
    /// Frames a second that the thesis reports (NVIDIA GeForce 9800 GTX).
    pub paper_fps: f64,
    /// Pixels, which the thesis does not say.
    pub size: ImageSize,
}

/// The cells of the table, and its last case with more pixels.
pub const TABLE_2013: [Cell2013; 5] = [
    cell(1221, 1, 85.1),
    cell(2410, 1, 31.3),
    cell(1221, 5, 26.5),
    cell(2410, 5, 10.4),
    Cell2013 {
        size: ImageSize {
            width: 1920,
            height: 1080,
        },
        ..cell(2410, 5, 10.4)
    },
];

const fn cell(particles: u32, samples: u32, paper_fps: f64) -> Cell2013 {
    Cell2013 {
        particles,
        samples,
        paper_fps,
        size: ImageSize {
            width: 512,
            height: 512,
        },
    }
}

/// What was measured of a cell.
#[derive(Debug)]
pub struct Speed2013 {
    /// Of whole frames, each a step of the simulation.
    pub speed: Speed,
    /// How many particles there were in the first frame.
    pub particles: usize,
    /// How many balls and streaks were drawn there.
    pub elements: usize,
    /// Time of a step of the simulation, within a frame.
    pub simulation: Duration,
}

impl Cell2013 {
    /// Makes the cell's scene at a frame, with sprites or with streaks.
    #[must_use]
    pub fn scene(&self, shape: ParticleShape, frame: u32) -> Scene {
        let mut scene = Scene::new(Camera::new(
            DVec3::new(-120.0, -95.0, 50.0),
            -12.0 * DVec3::X,
        ));
        scene.image = self.size;
        scene.integration.antialias = Antialias::None;
        let mut wave = EmittedWave::new(DVec3::new(-50.0, 0.0, 0.0), DVec3::X);
        wave.rate = (f64::from(self.particles) / LIFE).into();
        wave.continuous = 0.0;
        wave.samples = self.samples;
        wave.shape = shape;
        wave.color = DVec3::new(0.25, 0.5, 1.0);
        scene.waves.push(wave);
        let half = DVec3::new(8.0, 22.0, 22.0);
        scene
            .colliders
            .push(Collider::new_box(8.0 * DVec3::X, half));
        scene.simulation = Some(SimulationSettings {
            time: Some(f64::from(frame)),
            ..SimulationSettings::default()
        });
        scene
    }

    /// Measures the cell.
    ///
    /// # Errors
    /// As [`measure`](super::measure).
    pub fn measure(
        &self,
        renderer: &mut Renderer,
        shape: ParticleShape,
        time: Duration,
    ) -> Result<Speed2013> {
        // One list of waves, so that one simulation serves all frames.
        let first = self.scene(shape, FIRST);
        let mut simulation = Simulation::new(&first)?;
        let elements = simulation.light(f64::from(FIRST))?.len();
        let particles = simulation.particles(FIRST)?.len();
        let begun = Instant::now();
        for frame in 1..=FRAMES_PER_TURN {
            simulation.light(f64::from(FIRST + frame))?;
        }
        let simulation = begun.elapsed() / FRAMES_PER_TURN;
        let at = |frame: u32| {
            let mut scene = first.clone();
            scene.simulation = self.scene(shape, FIRST + frame).simulation;
            scene
        };
        let scenes: Vec<Scene> = (0..FRAMES_PER_TURN).map(at).collect();
        Ok(Speed2013 {
            speed: measure_frames(renderer, &scenes, time)?,
            particles,
            elements,
            simulation,
        })
    }
}
