//! What a scene says of its simulation, made ready for steps.

use glam::DVec3;

use super::random::{Purpose, units};
use super::solid::Solid;
use super::state::Name;
use crate::scene::{EmittedWave, Scene, Signs};

/// How forces act where a particle hits. Measured with the thesis' base values, and all particles in reach as
/// neighbours: as printed 1.3 % fly into a box; with both signs mended 73 % do, pushed by the beam behind them; with
/// what of the repulsion points inwards left out none does.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rule {
    /// What h (w.n) n is multiplied with.
    pub damper: f64,
    /// What the sum over neighbours, which points to them, is multiplied with.
    pub repulsion: f64,
    /// Whether nothing pushes a particle into what it hits.
    pub keeps_out: bool,
}

impl Rule {
    pub(super) const CORRECTED: Self = Self {
        damper: -1.0,
        repulsion: -1.0,
        keeps_out: true,
    };
    pub(super) const PRINTED: Self = Self {
        damper: 1.0,
        repulsion: 1.0,
        keeps_out: false,
    };
}

/// A wave with what follows from it.
#[derive(Debug, Clone)]
pub(super) struct Law {
    pub wave: EmittedWave,
    pub rule: Rule,
}

/// The laws of a simulation.
#[derive(Debug, Clone)]
pub(super) struct Laws {
    pub waves: Vec<Law>,
    pub solids: Vec<Solid>,
    /// How far before what they hit particles are put, world units: 0 where there is no mesh.
    pub clearance: f64,
    pub seed: u32,
    /// How long a frame lasts, seconds.
    pub frame: f64,
    /// Whether a step looks where it enters solids; without that fast particles pass through them.
    pub sweeps: bool,
}

/// What is drawn for a particle when it first hits something.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draw {
    pub is_circular: bool,
    pub is_continuous: bool,
    pub mixture: u16,
    /// Which control point, in [0,1).
    pub control: f64,
    /// Frames.
    pub lifetime: f64,
}

impl Laws {
    pub(super) fn new(scene: &Scene) -> Self {
        let settings = scene.simulation_settings();
        let law = |wave: &EmittedWave| Law {
            wave: wave.clone(),
            rule: match wave.signs {
                Signs::Printed => Rule::PRINTED,
                _ => Rule::CORRECTED,
            },
        };
        let solids: Vec<Solid> = scene.colliders.iter().map(Solid::new).collect();
        let clearances = solids.iter().map(Solid::clearance);
        Self {
            waves: scene.waves.iter().map(law).collect(),
            clearance: clearances.fold(0.0, f64::max),
            solids,
            seed: settings.seed,
            frame: settings.frame,
            sweeps: true,
        }
    }

    pub(super) fn law(&self, name: Name) -> &Law {
        &self.waves[name.wave as usize]
    }

    /// Returns the farthest that any particle repels others.
    pub(super) fn reach(&self) -> f64 {
        let reaches = self.waves.iter().map(|law| law.wave.reach);
        reaches.fold(0.0, f64::max)
    }

    pub(super) fn units(&self, name: Name, purpose: Purpose) -> [f64; 4] {
        units(self.seed, name.id, name.wave, purpose)
    }

    /// Returns the direction of a wave at a frame.
    pub(super) fn direction(&self, wave: &EmittedWave, frame: u32) -> DVec3 {
        wave.direction
            .at(self.seconds(frame))
            .normalize_or(DVec3::X)
    }

    /// Returns when a frame is, seconds.
    pub(super) fn seconds(&self, frame: u32) -> f64 {
        f64::from(frame) * self.frame
    }

    /// Returns where and when in a frame a particle of it is emitted: a point of the disc, evenly, and a part of the
    /// frame.
    pub(super) fn emission(&self, name: Name, frame: u32) -> (DVec3, f64) {
        let wave = &self.law(name).wave;
        let [square, turn, when, _] = self.units(name, Purpose::Emission);
        let (right, up) = across(self.direction(wave, frame));
        let radius = wave.radius * square.sqrt();
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
        let middle = wave.origin.at(self.seconds(frame));
        (middle + radius * (cos * right + sin * up), when)
    }

    /// Draws what becomes of a particle.
    pub(super) fn draw(&self, name: Name) -> Draw {
        let wave = &self.law(name).wave;
        let [circular, continuous, mixture, control] = self.units(name, Purpose::Pattern);
        let [_, life, ..] = self.units(name, Purpose::Motion);
        Draw {
            is_circular: circular < wave.circular,
            is_continuous: continuous < wave.continuous,
            mixture: chosen(mixture, wave.mixture.iter().map(|it| it.probability))
                .map_or(0, |index| index as u16 + 1),
            control,
            lifetime: around(wave.lifetime, wave.lifetime_range, life),
        }
    }

    /// Returns how fast a particle flies away, world units a frame.
    pub(super) fn speed(&self, name: Name, is_continuous: bool) -> f64 {
        let [unit, ..] = self.units(name, Purpose::Motion);
        let [value, range] = self.law(name).wave.acceleration.of(is_continuous);
        around(value, range, unit)
    }

    /// Returns the point that a particle flies to which hits something at a point and a frame: E, given along, right
    /// and up from where the wave's axis meets a solid.
    pub(super) fn target(&self, name: Name, control: f64, hit: DVec3, frame: u32) -> DVec3 {
        let wave = &self.law(name).wave;
        let points = || wave.control.iter().map(|it| it.probability);
        let all: f64 = points().sum();
        let index = chosen(control * all, points()).or_else(|| points().rposition(|it| it > 0.0));
        let Some(point) = index.and_then(|index| wave.control.get(index)) else {
            return hit;
        };
        let [x, y, z, _] = self.units(name, Purpose::Target);
        let scattered = point.range * (2.0 * DVec3::new(x, y, z) - 1.0);
        let place = point.position.at(self.seconds(frame)) + scattered;
        let along = self.direction(wave, frame);
        let (right, up) = across(along);
        let origin = wave.origin.at(self.seconds(frame));
        let entries = self.solids.iter();
        let entries = entries.filter_map(|solid| solid.entry(origin, along, f64::INFINITY));
        let meets = entries.map(|entry| entry.share).reduce(f64::min);
        // An axis that meets nothing ends beside the point.
        let length = meets.unwrap_or_else(|| (hit - origin).dot(along));
        origin + (length + place.x) * along + place.y * right + place.z * up
    }
}

/// Returns the directions to the right and up of one that is looked along.
pub(super) fn across(along: DVec3) -> (DVec3, DVec3) {
    let up = if along.z.abs() > 0.999 {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let right = along.cross(up).normalize();
    (right, right.cross(along))
}

/// Returns which of some probabilities a number falls into, one after another from 0 on.
fn chosen(mut number: f64, probabilities: impl Iterator<Item = f64>) -> Option<usize> {
    for (index, probability) in probabilities.enumerate() {
        if number < probability {
            return Some(index);
        }
        number -= probability;
    }
    None
}

fn around(value: f64, range: f64, unit: f64) -> f64 {
    value + range * (2.0 * unit - 1.0)
}
