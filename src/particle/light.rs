//! What a simulation gives off: balls and streaks of light (Nito 2013, chapter 3.4).
//!
//! ```text
//! thread   M sprites, T_i = P0 + (P1 - P0) (i - 1)/(M - 1), from where it hit to the particle, S to 0.2 S
//! rod      N sprites, U_j = Q + (-1)^j u (j - 1) d, d the direction of flight, S_j = S (N - (j - 1)(1 - t))/N
//! grain    one sprite, as is a particle that has hit nothing
//! ```
//!
//! A ball holds the light 2 pi h^3/15 of the profile (1 - r/h)^2, a streak whose radius goes straight from a to b on
//! its way of length l that of its two half balls, and pi l (a^2 + a b + b^2)/18: a streak gets what its sprites have.

use std::f64::consts::PI;

use glam::DVec3;

use super::laws::Laws;
use super::state::{Body, Impact, Phase};
use crate::scene::{EmittedWave, LightElement, ParticleShape};

/// The last sprite of a thread is so much smaller than the first.
const THREAD_END: f64 = 0.2;

/// A particle as it is shown.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shown {
    pub body: Body,
    pub impact: Impact,
    /// How much of its life is left, from 1 to 0.
    pub left: f64,
}

impl Shown {
    /// Shows a particle as it is at a moment, frames.
    pub(super) fn new(body: Body, impact: Impact, moment: f64) -> Self {
        let left = match body.phase {
            Phase::Flying => 1.0,
            _ => ((body.until - moment) / impact.lifetime).clamp(0.0, 1.0),
        };
        Self { body, impact, left }
    }
}

impl Laws {
    /// Adds what a particle gives off.
    pub(super) fn shine(&self, shown: &Shown, elements: &mut Vec<LightElement>) {
        let wave = &self.law(shown.body.name).wave;
        let light = shown.left * wave.coefficient * wave.color;
        let body = &shown.body;
        match body.phase {
            Phase::Flying => elements.push(LightElement::Ball {
                center: body.position,
                radius: wave.size,
                light,
            }),
            _ if body.is_continuous => thread(wave, shown, light, elements),
            _ => rod(wave, shown, light, elements),
        }
    }
}

fn thread(wave: &EmittedWave, shown: &Shown, light: DVec3, elements: &mut Vec<LightElement>) {
    let (from, to) = (shown.impact.point, shown.body.position);
    let steps = f64::from(wave.threads.max(2) - 1);
    let sprite = |index: u32| {
        let share = f64::from(index) / steps;
        (share, wave.size * (1.0 + (THREAD_END - 1.0) * share))
    };
    let sprites = (0..wave.threads).map(sprite);
    match wave.shape {
        ParticleShape::Sprites => {
            elements.extend(sprites.map(|(share, radius)| LightElement::Ball {
                center: from + share * (to - from),
                radius,
                light,
            }));
        }
        _ => {
            let end = THREAD_END * wave.size;
            let radii = [wave.size, 0.5 * (wave.size + end), end];
            let sprites = sprites.map(|(_, radius)| radius);
            elements.push(streak([from, to], radii, light, sprites));
        }
    }
}

fn rod(wave: &EmittedWave, shown: &Shown, light: DVec3, elements: &mut Vec<LightElement>) {
    let mixed = shown.body.mixture.checked_sub(1);
    let (samples, roundness) = match mixed.and_then(|index| wave.mixture.get(index as usize)) {
        Some(mixed) => (mixed.samples, mixed.roundness),
        None => (wave.samples, wave.roundness),
    };
    let middle = shown.body.position;
    // What stands still lies along the surface's normal.
    let along = shown
        .body
        .velocity
        .try_normalize()
        .unwrap_or(shown.impact.normal);
    let count = f64::from(samples);
    let radius = |index: u32| wave.size * (count - f64::from(index) * (1.0 - roundness)) / count;
    let place = |index: u32| {
        let side = if index.is_multiple_of(2) { -1.0 } else { 1.0 }; // (-1)^j
        middle + side * f64::from(index) * wave.spacing * along
    };
    let last = samples - 1;
    match wave.shape {
        _ if samples == 1 => elements.push(LightElement::Ball {
            center: middle,
            radius: wave.size,
            light,
        }),
        ParticleShape::Sprites => elements.extend((0..samples).map(|index| LightElement::Ball {
            center: place(index),
            radius: radius(index),
            light,
        })),
        _ => {
            let half = f64::from(last) * wave.spacing * along;
            let radii = [radius(last), wave.size, radius(last)];
            let ends = [middle - half, middle + half];
            elements.push(streak(ends, radii, light, (0..samples).map(radius)));
        }
    }
}

/// Makes a streak that holds the light of sprites of these radii.
fn streak(
    ends: [DVec3; 2],
    radii: [f64; 3],
    light: DVec3,
    sprites: impl Iterator<Item = f64>,
) -> LightElement {
    let held: f64 = sprites.map(|radius| 2.0 * ball(radius)).sum();
    let length = (ends[1] - ends[0]).length();
    let [a, b, c] = radii;
    let part = |a: f64, b: f64| PI * 0.5 * length * (a * a + a * b + b * b) / 18.0;
    let own = ball(a) + ball(c) + part(a, b) + part(b, c);
    LightElement::Streak {
        ends,
        radii,
        light: light * (held / own),
    }
}

/// Returns the light of half a ball.
fn ball(radius: f64) -> f64 {
    PI * radius.powi(3) / 15.0
}
