//! A wave of particles (Nito 2013): how they are emitted, what happens to them where they hit something, and how they
//! are shown. Frames are those of the simulation.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::pattern::{check_rod, count, not_negative, probability, roundness, samples, within};
use super::{Acceleration, ControlPoint, Mixture, Varying};
use crate::scene::colors::read_color;
use crate::scene::values::{Checked, Fault, direction, finite, positive, vector};

/// A wave of particles, emitted from a disc in one direction. Where it hits a [`Collider`](super::Collider), each of
/// its particles joins one of eight patterns: circular or irregular, and continuous, granular, or a rod with round or
/// with sharp ends.
///
/// ```
/// use energywave::glam::DVec3;
/// use energywave::scene::{EmittedWave, ParticleShape};
///
/// let mut wave = EmittedWave::new(DVec3::new(-50.0, 0.0, 0.0), DVec3::X);
/// wave.continuous = 0.0; // none is a thread
/// wave.shape = ParticleShape::Sprites;
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct EmittedWave {
    /// The middle of the disc that it is emitted from.
    #[serde(default = "at_origin")]
    pub origin: Varying<DVec3>,
    /// Where it flies, of any length but zero.
    pub direction: Varying<DVec3>,
    /// Of the disc, world units, 0 or more.
    #[serde(default = "defaults::radius")]
    pub radius: f64,
    /// World units a frame, 0 or more.
    #[serde(default = "defaults::speed")]
    pub speed: f64,
    /// How many particles are emitted in a frame, 0 or more.
    #[serde(default = "defaults::rate")]
    pub rate: Varying<f64>,
    /// How long particles fly that hit nothing, frames, positive.
    #[serde(default = "defaults::flight")]
    pub flight: f64,
    /// alpha: the share of the particles that fly away around the point where they hit; the others fly to control
    /// points. 0 to 1.
    #[serde(default = "defaults::circular")]
    pub circular: f64,
    /// beta: the share of the particles that are threads of light from where they hit; the others are separate. 0 to 1.
    #[serde(default = "defaults::continuous")]
    pub continuous: f64,
    /// N: of how many sprites a separate particle is, 1 to 1024. 1: it is a grain; more: a rod.
    #[serde(default = "samples")]
    pub samples: u32,
    /// t: how thick the ends of a rod are, from sharp, above 0, to as thick as its middle, 1.
    #[serde(default = "roundness")]
    pub roundness: f64,
    /// u: how far the sprites of a rod are apart, world units, 0 or more.
    #[serde(default = "defaults::spacing")]
    pub spacing: f64,
    /// tau: how long a particle lives that has hit something, frames, positive.
    #[serde(default = "defaults::lifetime")]
    pub lifetime: f64,
    /// By how much that differs from particle to particle at most, frames; less than that.
    #[serde(default)]
    pub lifetime_range: f64,
    /// c: how fast the particles of the circular pattern fly away.
    #[serde(default)]
    pub acceleration: Acceleration,
    /// r: how much particles repel each other where they hit; against `spring` and `damper`. 0 or more.
    #[serde(default = "defaults::repulsion")]
    pub repulsion: f64,
    /// How far they do, world units, positive.
    #[serde(default = "defaults::reach")]
    pub reach: f64,
    /// k: how much a collider pushes a particle out for each world unit that it was to penetrate, 0 or more.
    #[serde(default = "defaults::spring")]
    pub spring: f64,
    /// h: how much it does for each unit of speed inwards, 0 or more.
    #[serde(default = "defaults::damper")]
    pub damper: f64,
    /// Which signs damper and repulsion have.
    #[serde(default)]
    pub signs: Signs,
    /// What a collider does to a particle of the circular pattern.
    #[serde(default)]
    pub response: Response,
    /// The points that particles of the irregular pattern fly to.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub control: Vec<ControlPoint>,
    /// Further shapes of separate particles: all patterns in one wave. Their probabilities add up to 1 at most.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mixture: Vec<Mixture>,
    /// S: the radius of a sprite, at which its light ends; world units, positive.
    #[serde(default = "defaults::size")]
    pub size: f64,
    /// M: of how many sprites a thread is, 1 to 1024.
    #[serde(default = "samples")]
    pub threads: u32,
    /// What threads and rods are made of.
    #[serde(rename = "draw", default)]
    pub shape: ParticleShape,
    /// What the light of a sprite is multiplied with, 0 or more.
    #[serde(default = "defaults::coefficient")]
    pub coefficient: f64,
    /// Linear RGB; in files also `"#rrggbb"`, sRGB.
    #[serde(default = "defaults::color", deserialize_with = "read_color")]
    pub color: DVec3,
}

// What is read of `[[wave]]`.
keys! { pub(in crate::scene) WAVE_KEYS;
    origin: VECTOR, WORLD, Value("[0, 0, 0]"), "the middle of the disc that it is emitted from";
    direction: VECTOR, NONE, Required, "where it flies, of any length but zero";
    radius: NOT_NEGATIVE, WORLD, Value("3"), "of the disc";
    speed: NOT_NEGATIVE, "world units a frame", Value("2"), "how fast it flies";
    rate: NOT_NEGATIVE, "1/frame", Value("20"), "how many particles are emitted in a frame";
    flight: POSITIVE, "frames", Value("200"), "how long particles fly that hit nothing";
    circular: from_to(0.0, 1.0), NONE, Value("1"), "alpha: which share flies away around; the rest to control points";
    continuous: from_to(0.0, 1.0), NONE, Value("0.3"), "beta: which share is threads; the rest is grains or rods";
    samples: Whole(1, MOST_SPRITES), NONE, Value("12"), "N: 1: separate particles are grains; more: rods of so many";
    roundness: above_to(0.0, 1.0), NONE, Value("0.5"), "t: 1: rods with round ends; less: with sharp ones";
    spacing: NOT_NEGATIVE, WORLD, Value("0.4"), "u: how far the sprites of a rod are apart";
    lifetime: POSITIVE, "frames", Value("40"), "tau: how long particles live that have hit something";
    lifetime_range: NOT_NEGATIVE, "frames", Value("0"), "by how much that differs at most";
    acceleration: Table("acceleration"), NONE, Otherwise("see there"), "c: how fast they fly away around";
    repulsion: NOT_NEGATIVE, NONE, Value("4"), "r: how much particles repel each other where they hit";
    reach: POSITIVE, WORLD, Value("3"), "how far they do";
    spring: NOT_NEGATIVE, NONE, Value("1"), "k: how much a collider pushes out by depth";
    damper: NOT_NEGATIVE, NONE, Value("0.8"), "h: how much it does by speed";
    signs: Word(&["corrected", "printed"]), NONE, Value("\"corrected\""),
        "of damper and repulsion, as in 2013 or mended";
    response: Word(&["replace", "accelerate"]), NONE, Value("\"replace\""),
        "particles get a new speed where they hit, or are pushed out by and by";
    control: Tables("control"), NONE, Otherwise("none"),
        "the points of the irregular pattern; with circular < 1 needed";
    mixture: Tables("mixture"), NONE, Otherwise("none"), "further shapes of separate particles in the same wave";
    size: POSITIVE, WORLD, Value("1.2"), "S: the radius of a sprite";
    threads: Whole(1, MOST_SPRITES), NONE, Value("12"), "M: of how many sprites a thread is";
    draw: Word(&["streaks", "sprites"]), NONE, Value("\"streaks\""), "what threads and rods are made of";
    coefficient: NOT_NEGATIVE, NONE, Value("1"), "what the light of a sprite is multiplied with";
    color: Color, "linear RGB", Value("[1, 1, 1]"), "the colour";
}

/// Which signs the forces have where a particle hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Signs {
    /// The damper works against the motion, particles repel each other, and none is pushed into what it hits.
    #[default]
    Corrected,
    /// As the thesis prints them: the damper works with the motion, and particles attract each other.
    Printed,
}

/// What a collider does to a particle of the circular pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Response {
    /// It puts the particle onto its surface and gives it a new velocity.
    #[default]
    Replace,
    /// It accelerates the particle as long as that is within it.
    Accelerate,
}

/// What threads and rods are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum ParticleShape {
    /// A streak each, with the light of the sprites.
    #[default]
    Streaks,
    /// Balls in a row, as in the thesis.
    Sprites,
}

fn at_origin() -> Varying<DVec3> {
    DVec3::ZERO.into()
}

/// What holds where a key is left out: the base values of the thesis, table 4.2, and values that give its figures.
mod defaults {
    use super::{DVec3, Varying};

    macro_rules! defaults {
        ($($name:ident: $value:expr;)*) => {
            $(pub fn $name() -> f64 {
                $value
            })*
        };
    }
    defaults! {
        radius: 3.0;
        speed: 2.0;
        flight: 200.0;
        circular: 1.0;
        continuous: 0.3;
        spacing: 0.4;
        lifetime: 40.0;
        repulsion: 4.0;
        reach: 3.0;
        spring: 1.0;
        damper: 0.8;
        size: 1.2;
        coefficient: 1.0;
    }

    pub fn rate() -> Varying<f64> {
        20.0.into()
    }

    pub fn color() -> DVec3 {
        DVec3::ONE
    }
}

impl EmittedWave {
    /// Makes a wave with the base values of the thesis.
    #[must_use]
    pub fn new(origin: impl Into<Varying<DVec3>>, direction: impl Into<Varying<DVec3>>) -> Self {
        Self {
            origin: origin.into(),
            direction: direction.into(),
            radius: defaults::radius(),
            speed: defaults::speed(),
            rate: defaults::rate(),
            flight: defaults::flight(),
            circular: defaults::circular(),
            continuous: defaults::continuous(),
            samples: samples(),
            roundness: roundness(),
            spacing: defaults::spacing(),
            lifetime: defaults::lifetime(),
            lifetime_range: 0.0,
            acceleration: Acceleration::default(),
            repulsion: defaults::repulsion(),
            reach: defaults::reach(),
            spring: defaults::spring(),
            damper: defaults::damper(),
            signs: Signs::default(),
            response: Response::default(),
            control: Vec::new(),
            mixture: Vec::new(),
            size: defaults::size(),
            threads: samples(),
            shape: ParticleShape::default(),
            coefficient: defaults::coefficient(),
            color: defaults::color(),
        }
    }

    /// Returns the greatest number of particles that it emits in a frame, as far as its keys say.
    pub(crate) fn most_rate(&self) -> f64 {
        match &self.rate {
            Varying::Constant(rate) => *rate,
            Varying::Track(track) => (0..track.values.len())
                .filter_map(|index| match &track.values[index] {
                    crate::scene::TrackValue::Number(rate) => Some(*rate),
                    crate::scene::TrackValue::List(_) => None,
                })
                .fold(0.0, f64::max),
            Varying::Parts(_) => 0.0,
        }
    }

    pub(super) fn check(&self) -> Checked {
        self.origin.check("origin", &|_| Ok(()))?;
        self.direction
            .check("direction", &|it| direction("direction", it))?;
        not_negative("radius", self.radius)?;
        not_negative("speed", self.speed)?;
        self.rate.check("rate", &|it| not_negative("rate", it))?;
        positive("flight", self.flight)?;
        probability("circular", self.circular)?;
        probability("continuous", self.continuous)?;
        check_rod(self.samples, self.roundness)?;
        not_negative("spacing", self.spacing)?;
        positive("lifetime", self.lifetime)?;
        within(
            "lifetime",
            self.lifetime,
            "lifetime_range",
            self.lifetime_range,
        )?;
        self.acceleration.check()?;
        not_negative("repulsion", self.repulsion)?;
        positive("reach", self.reach)?;
        not_negative("spring", self.spring)?;
        not_negative("damper", self.damper)?;
        self.check_control()?;
        self.check_mixture()?;
        positive("size", self.size)?;
        count("threads", self.threads)?;
        not_negative("coefficient", self.coefficient)?;
        vector("color", self.color)
    }

    fn check_control(&self) -> Checked {
        for (index, point) in self.control.iter().enumerate() {
            point
                .check()
                .map_err(|fault| fault.within(&format!("control[{index}]")))?;
        }
        if self.circular >= 1.0 {
            return Ok(());
        }
        if self.control.is_empty() {
            let message = "with circular below 1 some particles fly to control points, and there are none: add \
                control = [{ position = [-40.0, 50.0, 10.0] }], or circular = 1.0";
            return Err(Fault::new("control", message));
        }
        if self.control.iter().all(|point| point.probability == 0.0) {
            let message = "the probabilities of all control points are 0, so that none can be chosen: raise one";
            return Err(Fault::new("control", message));
        }
        Ok(())
    }

    fn check_mixture(&self) -> Checked {
        for (index, mixture) in self.mixture.iter().enumerate() {
            mixture
                .check()
                .map_err(|fault| fault.within(&format!("mixture[{index}]")))?;
        }
        let sum: f64 = self.mixture.iter().map(|it| it.probability).sum();
        finite("mixture", sum)?;
        match sum <= 1.0 + 1e-9 {
            true => Ok(()),
            false => Err(Fault::new(
                "mixture",
                format!("the probabilities add up to {sum}, more than 1"),
            )),
        }
    }
}
