//! What happens to a particle where it hits something (Nito 2013, chapter 3, mended):
//!
//! ```text
//! D = k z n - h (w.n) n                 penalty: z the depth that the step was to reach, w the velocity, n outwards
//! R = -r sum of (Q - P) / |Q - P|^2     repulsion of all particles Q in reach, without what of it points inwards; P
//!                                       and Q are where the step would end
//! A = c (D + R) / |D + R|               circular: the new velocity, or an acceleration
//! v = (E - H) / tau                     irregular: from H to its control point E, where it dies
//! ```

use glam::DVec3;

use super::Contact;
use super::laws::{Law, Laws};
use super::neighbours::Neighbours;
use super::state::{Body, Phase, State};
use crate::scene::Response;

/// Shorter sums of forces have no direction.
const NO_FORCE: f64 = 1e-150;

/// Rounds in which inward parts are taken off where several surfaces meet.
const ROUNDS: u32 = 8;

/// A particle that hits a solid, or is within it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// Of the particle.
    pub index: usize,
    pub solid: usize,
    /// Where it enters, H.
    pub point: DVec3,
    /// Where it is put, which is there or a little before.
    pub place: DVec3,
    /// Outwards there.
    pub normal: DVec3,
    /// Where its step was to end.
    pub end: DVec3,
    /// Frames.
    pub time: f64,
    /// Whether it hits it in this step.
    pub is_new: bool,
}

impl Laws {
    /// Gives a particle that hits something its velocity.
    pub(super) fn respond(
        &self,
        state: &mut State,
        touch: &Touch,
        neighbours: &Neighbours,
        see: &mut impl FnMut(Contact),
    ) {
        let mut body = state.bodies[touch.index];
        let impact = &mut state.impacts[touch.index];
        let law = self.law(body.name);
        let is_first = body.phase == Phase::Flying;
        let mut control = 0.0;
        if touch.is_new {
            see(self.contact(&body, touch, is_first));
            body.hit = touch.solid as u32 + 1;
            (impact.point, impact.normal) = (touch.point, touch.normal);
        }
        if is_first {
            let drawn = self.draw(body.name);
            body.is_continuous = drawn.is_continuous;
            body.mixture = drawn.mixture;
            body.until = f64::from(state.frame + 1) + drawn.lifetime;
            body.phase = match drawn.is_circular {
                true => Phase::Circular,
                false => Phase::Irregular,
            };
            impact.lifetime = drawn.lifetime;
            control = drawn.control;
        }
        if body.phase == Phase::Irregular {
            let target = self.target(body.name, control, touch.point, state.frame);
            body.position = touch.point;
            body.velocity = (target - touch.point) / impact.lifetime;
        } else {
            let pull = match law.wave.repulsion > 0.0 {
                true => neighbours.pull(touch.end, law.wave.reach),
                false => DVec3::ZERO,
            };
            let push = self.speed(body.name, body.is_continuous)
                * self.away(law, touch, body.velocity, pull);
            match law.wave.response {
                Response::Accelerate => {
                    body.phase = Phase::Within;
                    body.velocity += push;
                }
                _ => (body.position, body.velocity) = (touch.place, push),
            }
        }
        state.bodies[touch.index] = body;
    }

    fn contact(&self, body: &Body, touch: &Touch, is_first: bool) -> Contact {
        Contact {
            time: touch.time * self.frame,
            frame: touch.time,
            point: touch.point,
            normal: touch.normal + DVec3::ZERO, // no -0.0 is told
            speed: body.velocity.length(),
            wave: body.name.wave as usize,
            particle: body.name.id,
            collider: touch.solid,
            is_first,
        }
    }

    /// Returns the direction of D + R, of length 1.
    fn away(&self, law: &Law, touch: &Touch, velocity: DVec3, pull: DVec3) -> DVec3 {
        let (wave, rule) = (&law.wave, law.rule);
        let penalty = |normal: DVec3| {
            let depth = (touch.point - touch.end).dot(normal).max(0.0);
            (wave.spring * depth + rule.damper * wave.damper * velocity.dot(normal)) * normal
        };
        let mut normals = vec![touch.normal];
        let mut push = penalty(touch.normal);
        for (index, solid) in self.solids.iter().enumerate().filter(|_| touch.is_new) {
            // Where it touches several at once, all push.
            let (front, known) = (
                (index == touch.solid).then_some(touch.normal),
                normals.len(),
            );
            solid.faces(touch.point, velocity, front, &mut normals);
            let pushing = normals[known..]
                .iter()
                .filter(|it| velocity.dot(**it) < 0.0);
            push += pushing.map(|normal| penalty(*normal)).sum::<DVec3>();
        }
        let repulsion = rule.repulsion * wave.repulsion * pull;
        let middle = || normals.iter().sum::<DVec3>().normalize_or(touch.normal);
        if !rule.keeps_out {
            return direction(push + repulsion).unwrap_or_else(middle);
        }
        let sum = push + outward(repulsion, &normals).unwrap_or(DVec3::ZERO);
        let sum = outward(sum, &normals).and_then(direction);
        sum.unwrap_or_else(middle)
    }
}

fn direction(force: DVec3) -> Option<DVec3> {
    (force.length() > NO_FORCE).then(|| force.normalize())
}

/// Takes off a force what points into surfaces; `None` where nothing remains.
fn outward(mut force: DVec3, normals: &[DVec3]) -> Option<DVec3> {
    for _ in 0..ROUNDS {
        let mut is_outward = true;
        for normal in normals {
            let inward = force.dot(*normal);
            if inward < 0.0 {
                force -= inward * *normal;
                is_outward = false;
            }
        }
        if is_outward {
            return Some(force);
        }
        if normals.len() == 1 {
            return Some(force - force.dot(normals[0]).min(0.0) * normals[0]);
        }
    }
    None
}
