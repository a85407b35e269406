//! The state of a simulation at a frame.

use glam::DVec3;

/// What a particle does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Phase {
    /// It has hit nothing.
    Flying,
    /// It flies away around the point that it hit.
    Circular,
    /// It flies to its control point.
    Irregular,
    /// It is being accelerated within the solid that it hit.
    Within,
    /// It is over, and waits to be dropped with others.
    Over,
}

/// Which particle it is: its number among those of its wave, and its wave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Name {
    pub id: u32,
    pub wave: u32,
}

/// What of a particle changes in every step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Body {
    pub position: DVec3,
    /// World units a frame.
    pub velocity: DVec3,
    /// The last moment of its life, or of its flight, frames.
    pub until: f64,
    pub name: Name,
    /// 1 + the solid that it hit last, which it does not hit again on its way from there; 0: none.
    pub hit: u32,
    pub phase: Phase,
    pub is_continuous: bool,
    /// 1 + which of the wave's mixture it is of; 0: of none.
    pub mixture: u16,
}

/// What of a particle changes where it hits something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Impact {
    /// Where.
    pub point: DVec3,
    /// Outwards.
    pub normal: DVec3,
    /// How long the particle lives since it first hit something, frames.
    pub lifetime: f64,
}

impl Impact {
    pub(super) const NONE: Self = Self {
        point: DVec3::ZERO,
        normal: DVec3::Z,
        lifetime: 1.0,
    };
}

/// How far a wave has been emitted.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Emitted {
    /// The part of a particle that is left over.
    pub rest: f64,
    /// How many there were.
    pub count: u64,
}

/// All that the next step depends on.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct State {
    pub frame: u32,
    /// In the order in which they were emitted; some may be over.
    pub bodies: Vec<Body>,
    /// One for each of them.
    pub impacts: Vec<Impact>,
    /// How many of them are over.
    pub over: usize,
    /// One for each wave.
    pub emitted: Vec<Emitted>,
}

impl State {
    pub(super) fn new(waves: usize) -> Self {
        Self {
            emitted: vec![Emitted::default(); waves],
            ..Self::default()
        }
    }

    /// Returns all particles that are not over.
    pub(super) fn alive(&self) -> impl Iterator<Item = (&Body, &Impact)> {
        let all = self.bodies.iter().zip(&self.impacts);
        all.filter(|(body, _)| body.phase != Phase::Over)
    }

    /// Drops those that are over if they are a quarter: dropping some moves all behind them.
    pub(super) fn drop_over(&mut self) {
        if 4 * self.over < self.bodies.len() || self.over == 0 {
            return;
        }
        let mut kept = 0;
        for index in 0..self.bodies.len() {
            if self.bodies[index].phase != Phase::Over {
                self.bodies[kept] = self.bodies[index];
                self.impacts[kept] = self.impacts[index];
                kept += 1;
            }
        }
        self.bodies.truncate(kept);
        self.impacts.truncate(kept);
        self.over = 0;
    }

    /// Returns how much memory its particles take.
    pub(super) fn bytes(&self) -> usize {
        self.bodies.len() * BYTES
    }
}

/// Memory that a particle takes.
pub(super) const BYTES: usize = size_of::<Body>() + size_of::<Impact>();
