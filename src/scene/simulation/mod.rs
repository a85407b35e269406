//! What is simulated: waves of particles and what they hit (Nito 2013). Its frames are the thesis': all speeds,
//! lifetimes and rates are per frame, and a step of the simulation is one.

mod collider;
mod pattern;
mod varying;
mod wave;

use serde::{Deserialize, Serialize};

use super::values::{Checked, Fault, finite, positive};
use super::{List, Scene};
use crate::error::SceneError;

#[cfg(feature = "files")]
pub(super) use collider::GRAY;
pub use collider::{Collider, ColliderShape};
#[cfg(feature = "files")]
pub(crate) use pattern::MOST_SPRITES;
#[cfg(feature = "files")]
pub(super) use pattern::{ACCELERATION_KEYS, CONTROL_KEYS, MIXTURE_KEYS};
pub use pattern::{Acceleration, ControlPoint, Mixture};
#[cfg(feature = "files")]
pub(super) use varying::KEPT_TRACK;
pub use varying::{Varied, Varying};
#[cfg(feature = "files")]
pub(super) use wave::WAVE_KEYS;
pub use wave::{EmittedWave, ParticleShape, Response, Signs};

/// How waves are simulated, and when they are shown.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct SimulationSettings {
    /// How long a frame of the simulation, which is a step of it, lasts; seconds, positive.
    pub frame: f64,
    /// Which random numbers.
    pub seed: u32,
    /// Which frame is shown, 0 or more, also between two; `None`: of a scene that is read from a file that of its time,
    /// else the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
}

// What is read of `[simulation]`.
keys! { pub(in crate::scene) SIMULATION_KEYS;
    frame: POSITIVE, "seconds", Otherwise("1/60"), "how long a frame of the simulation lasts";
    seed: WHOLE, NONE, Value("1"), "which random numbers";
    time: from_to(0.0, LAST_FRAME), "frames", Otherwise("that of the scene's time"), "which frame is shown";
}

/// The last frame that can be asked for.
pub(crate) const LAST_FRAME: f64 = 1e6;

/// Particles of one wave; they are counted in 32 bits.
const MOST_PARTICLES: f64 = 4_294_967_296.0;

impl Default for SimulationSettings {
    fn default() -> Self {
        Self {
            frame: 1.0 / 60.0,
            seed: 1,
            time: None,
        }
    }
}

impl SimulationSettings {
    fn check(&self) -> Checked {
        positive("frame", self.frame)?;
        let time = self.time.unwrap_or(0.0);
        finite("time", time)?;
        if (0.0..=LAST_FRAME).contains(&time) {
            return Ok(());
        }
        let message = format!("frames are counted from 0 to {LAST_FRAME}; found {time}");
        Err(Fault::new("time", message))
    }
}

impl Scene {
    /// Returns how its waves are simulated: what it says, else the defaults.
    #[must_use]
    pub fn simulation_settings(&self) -> SimulationSettings {
        self.simulation.unwrap_or_default()
    }

    /// Checks all that is simulated.
    pub(super) fn check_simulation(&self) -> std::result::Result<(), SceneError> {
        let settings = self.simulation_settings();
        settings.check().map_err(|fault| fault.of("simulation"))?;
        check_all("wave", &self.waves, EmittedWave::check)?;
        check_all("collider", &self.colliders, Collider::check)?;
        self.check_insides()?;
        let time = settings.time.unwrap_or(0.0);
        for (index, wave) in self.waves.iter().enumerate() {
            let count = wave.most_rate() * (time + 1.0);
            if count > MOST_PARTICLES {
                let message = format!(
                    "{count:.1e} particles until frame {time}; there are at most 2^32: give a smaller rate"
                );
                return Err(Fault::new("rate", message).of(&format!("wave[{index}]")));
            }
        }
        Ok(())
    }
}

impl Scene {
    /// Refuses waves that are pushed out of what has no inside.
    fn check_insides(&self) -> std::result::Result<(), SceneError> {
        let is_pushed = |wave: &EmittedWave| wave.response == Response::Accelerate;
        let is_open = |collider: &Collider| match &collider.shape {
            ColliderShape::Mesh(mesh) => !mesh.triangles.is_closed(),
            _ => false,
        };
        let Some(wave) = self.waves.iter().position(is_pushed) else {
            return Ok(());
        };
        let Some(collider) = self.colliders.iter().position(is_open) else {
            return Ok(());
        };
        let message = format!(
            "\"accelerate\" pushes particles out of what they have entered, and the mesh of collider[{collider}] \
             is open and has no inside: close it, or write response = \"replace\""
        );
        Err(Fault::new("response", message).of(&format!("wave[{wave}]")))
    }
}

fn check_all<T>(
    table: &str,
    list: &List<T>,
    check: impl Fn(&T) -> Checked,
) -> std::result::Result<(), SceneError> {
    for (index, item) in list.iter().enumerate() {
        check(item).map_err(|fault| fault.of(&format!("{table}[{index}]")))?;
    }
    Ok(())
}
