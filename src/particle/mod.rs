//! The simulation of waves that hit things (Nito 2013): on the host, in float64, on one thread, with random numbers
//! that are functions of the particle and no library's sines, so that it is the same on every machine, to the bit.
//!
//! A [`Simulation`] gives, for every frame, the light of all particles ([`LightElement`]) and where they hit something
//! ([`Contact`]). The renderer draws that light.

mod facets;
mod force;
mod history;
mod laws;
mod light;
mod neighbours;
mod random;
mod solid;
mod state;
mod step;
#[cfg(test)]
mod tests;

use std::ops::RangeInclusive;

use glam::DVec3;

use crate::error::{Error, Result, SceneError};
use crate::memory;
pub use crate::scene::LightElement;
use crate::scene::{Collider, EmittedWave, LAST_FRAME, List, Scene};
use history::History;
use laws::Laws;
use light::Shown;
pub(crate) use solid::Solid;
use state::{BYTES, Body, Phase, State};

/// States that are held at once: that of a frame, that of the one after, and one that is kept.
const STATES: f64 = 3.0;

/// Waves of particles, at every frame.
///
/// ```
/// use energywave::glam::DVec3;
/// use energywave::particle::Simulation;
/// use energywave::scene::{Camera, Collider, EmittedWave, Scene};
///
/// # fn main() -> energywave::Result<()> {
/// let mut scene = Scene::new(Camera::new(DVec3::new(-120.0, -95.0, 50.0), DVec3::ZERO));
/// scene.waves.push(EmittedWave::new(DVec3::new(-50.0, 0.0, 0.0), DVec3::X));
/// scene.colliders.push(Collider::new_box(DVec3::X * 8.0, DVec3::new(8.0, 22.0, 22.0)));
/// let mut simulation = Simulation::new(&scene)?;
/// assert_eq!(simulation.particles(30)?.len(), 600);
/// assert!(!simulation.light(69.5)?.is_empty());
/// let first = simulation.contacts(0..=40)?[0];
/// assert!(first.point.x.abs() < 1e-9 && first.normal == -DVec3::X && first.speed == 2.0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Simulation {
    waves: List<EmittedWave>,
    colliders: List<Collider>,
    laws: Laws,
    history: History,
    /// The state after one that is shown.
    next: Option<Box<(State, step::Scratch)>>,
    /// So much light there is about.
    shone: usize,
}

/// A particle at a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Particle {
    /// The index of its wave.
    pub wave: usize,
    /// Its number among those of its wave, from 0 on, in the order of their emission.
    pub id: u32,
    /// World space.
    pub position: DVec3,
    /// World units a frame.
    pub velocity: DVec3,
    /// Where it hit something last; `None`: it has hit nothing.
    pub hit: Option<DVec3>,
    /// Whether it flies to a control point.
    pub is_irregular: bool,
    /// How much of its life is left, from 1 to 0: that of its light.
    pub left: f64,
}

/// A particle that hits a collider.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "json", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Contact {
    /// When, seconds since the simulation began.
    pub time: f64,
    /// The same in frames, with the part of the frame.
    pub frame: f64,
    /// Where, world space.
    pub point: DVec3,
    /// The collider's, outwards, of length 1.
    pub normal: DVec3,
    /// How fast the particle was, world units a frame.
    pub speed: f64,
    /// The index of its wave.
    pub wave: usize,
    /// Its number among those of its wave.
    pub particle: u32,
    /// The index of the collider.
    pub collider: usize,
    /// Whether the particle has hit nothing before.
    pub is_first: bool,
}

impl Simulation {
    /// Makes the simulation of a scene.
    ///
    /// # Errors
    /// [`Error::Scene`] if a value of the scene is wrong, or its particles do not fit into the memory.
    pub fn new(scene: &Scene) -> Result<Self> {
        scene.validate()?;
        check_memory(scene)?;
        let laws = Laws::new(scene);
        let history = History::new(laws.waves.len());
        Ok(Self {
            waves: scene.waves.clone(),
            colliders: scene.colliders.clone(),
            laws,
            history,
            next: None,
            shone: 0,
        })
    }

    /// Returns whether it is that of a scene, whatever frame this shows: of one that moves the same simulation then
    /// serves all times.
    #[must_use]
    pub fn is_of(&self, scene: &Scene) -> bool {
        let settings = scene.simulation_settings();
        (settings.seed, settings.frame) == (self.laws.seed, self.laws.frame)
            && is_same(&self.waves, &scene.waves)
            && is_same(&self.colliders, &scene.colliders)
    }

    /// Returns the light of all particles at a frame, or between two: there each is on the straight way from one to the
    /// other. The particles of a wave are in the order of their emission.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if it is no frame, 0 to 1e6; [`Error::Scene`] if more than 2^32 particles of a wave came
    /// before it.
    pub fn light(&mut self, frame: f64) -> Result<Vec<LightElement>> {
        let mut elements = Vec::with_capacity(self.shone);
        self.show(frame, |laws, shown| laws.shine(shown, &mut elements))?;
        self.shone = elements.len() + elements.len() / 8;
        Ok(elements)
    }

    /// Returns all particles at a frame, in the order of their emission.
    ///
    /// # Errors
    /// As [`Simulation::light`].
    pub fn particles(&mut self, frame: u32) -> Result<Vec<Particle>> {
        let mut particles = Vec::new();
        self.show(f64::from(frame), |_, shown| {
            let body = &shown.body;
            particles.push(Particle {
                wave: body.name.wave as usize,
                id: body.name.id,
                position: body.position,
                velocity: body.velocity,
                hit: (body.phase != Phase::Flying).then_some(shown.impact.point),
                is_irregular: body.phase == Phase::Irregular,
                left: shown.left,
            });
        })?;
        Ok(particles)
    }

    /// Returns all contacts in some frames, both ends included: those from the first on, until the frame after the
    /// last. They are in the order of the frames, of one frame in that of the particles' emission.
    ///
    /// # Errors
    /// As [`Simulation::light`].
    pub fn contacts(&mut self, frames: RangeInclusive<u32>) -> Result<Vec<Contact>> {
        let (first, last) = (*frames.start(), frames.end().saturating_add(1));
        self.check_frame(f64::from(last) - 1.0)?;
        let mut contacts = Vec::new();
        let mut see = |contact| contacts.push(contact);
        self.history.contacts(&self.laws, first, last, &mut see);
        Ok(contacts)
    }

    fn check_frame(&self, frame: f64) -> Result<()> {
        if !(0.0..=LAST_FRAME).contains(&frame) {
            return Err(Error::Unsupported(format!(
                "frames of a simulation are counted from 0 to {LAST_FRAME}; found {frame}"
            )));
        }
        for (index, law) in self.laws.waves.iter().enumerate() {
            let count = law.wave.most_rate() * (frame + 1.0);
            if count > f64::from(u32::MAX) {
                let message = format!(
                    "{count:.1e} particles until frame {frame}; there are at most 2^32: give a smaller rate"
                );
                return Err(SceneError::value(format!("wave[{index}].rate"), message).into());
            }
        }
        Ok(())
    }

    /// Shows all particles as they are at a frame, or between two.
    fn show(&mut self, frame: f64, mut show: impl FnMut(&Laws, &Shown)) -> Result<()> {
        self.check_frame(frame)?;
        let (whole, share) = (frame.floor(), frame.fract());
        let Self {
            laws,
            history,
            next,
            ..
        } = self;
        let before = history.at(laws, whole as u32);
        if share == 0.0 {
            for (body, impact) in before.alive() {
                show(laws, &Shown::new(*body, *impact, frame));
            }
            return Ok(());
        }
        let next = next.get_or_insert_default();
        let (after, scratch) = next.as_mut();
        after.clone_from(before);
        laws.step(after, scratch, &mut |_| {});
        between(laws, before, after, share, &mut show);
        Ok(())
    }
}

/// Shows particles between two frames. Both states have them in the order of their emission.
fn between(
    laws: &Laws,
    before: &State,
    after: &State,
    share: f64,
    show: &mut impl FnMut(&Laws, &Shown),
) {
    let begin = f64::from(before.frame);
    let moment = begin + share;
    let mut later = after.alive().map(|(body, _)| body).peekable();
    for (body, impact) in before.alive() {
        let position = match later.next_if(|it| it.name == body.name) {
            Some(later) => body.position.lerp(later.position, share),
            // It is over before the next frame, perhaps before this moment.
            None if body.until < moment => continue,
            None => body.position + share * body.velocity,
        };
        let body = Body { position, ..*body };
        show(laws, &Shown::new(body, *impact, moment));
    }
    // What remains is emitted on the way; it may have hit something at the next frame, not yet here.
    for body in later {
        let (origin, when) = laws.emission(body.name, before.frame);
        if when <= share {
            let position = origin.lerp(body.position, (share - when) / (1.0 - when));
            let phase = Phase::Flying;
            let body = Body {
                position,
                phase,
                ..*body
            };
            show(laws, &Shown::new(body, state::Impact::NONE, moment));
        }
    }
}

fn is_same<T: PartialEq>(one: &List<T>, other: &List<T>) -> bool {
    one.revision() == other.revision() || one == other
}

/// Checks that the particles that live at once fit into the memory.
fn check_memory(scene: &Scene) -> Result<()> {
    let alive = |wave: &EmittedWave| {
        wave.most_rate() * (wave.flight + wave.lifetime + wave.lifetime_range + 1.0)
    };
    let all: f64 = scene.waves.iter().map(alive).sum();
    let needed = all * BYTES as f64 * STATES;
    let Some(shortage) = memory::shortage(needed as u64) else {
        return Ok(());
    };
    let most = (0..scene.waves.len())
        .max_by(|a, b| alive(&scene.waves[*a]).total_cmp(&alive(&scene.waves[*b])));
    let message = format!(
        "up to {all:.1e} particles live at once: {shortage}; give a smaller rate, flight or lifetime"
    );
    let key = format!("wave[{}].rate", most.unwrap_or(0));
    Err(SceneError::value(key, message).into())
}
